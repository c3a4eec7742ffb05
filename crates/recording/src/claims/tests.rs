use super::*;
use crate::recording::{ChannelSpec, Scalar};
use crate::reducer::Reducer;
use crate::window::Window;

fn recording(values: Vec<f64>) -> Recording {
    let header = Header {
        channels: vec![ChannelSpec::new("tool.displacement_y", Unit::Metre, "")],
        ..Header::default()
    };
    let time_s = (0..values.len()).map(|row| row as f64 * 0.1).collect();
    Recording {
        header,
        time_s,
        columns: vec![values],
        ..Recording::default()
    }
}

fn claim(unit: &str, min: Option<f64>, max: Option<f64>) -> ClaimSpec {
    let unit = UserUnit::parse(unit).unwrap();
    let metric = MetricSpec::Reduced {
        reducer: Reducer::Peak,
        channels: vec!["tool.displacement_y".into()],
        window: Window::ALL,
    };
    let si = |bound: Option<f64>| bound.map(|bound| bound * unit.si_factor);
    let (min, max) = (si(min), si(max));
    ClaimSpec {
        name: "stays near".into(),
        metric,
        unit,
        min,
        max,
        reason: "Ra".into(),
        relative_to: None,
    }
}

#[test]
fn bounds_include_their_ends() {
    let recording = recording(vec![0.0, -0.25, 0.125]);
    let holds = |min, max| {
        claim("m", min, max)
            .evaluate(&recording, None)
            .unwrap()
            .holds
    };
    assert!(holds(None, Some(0.25)) && holds(Some(0.25), None) && holds(Some(0.2), Some(0.3)));
    assert!(!holds(None, Some(0.2499)) && !holds(Some(0.2501), None));
}

#[test]
fn the_result_is_si_and_shown_in_the_claims_unit() {
    let result = claim("um", None, Some(50.0))
        .evaluate(&recording(vec![0.0, 1.9e-5]), None)
        .unwrap();
    assert_eq!(result.value, Some(1.9e-5));
    assert_eq!(result.shown, "19.00 um, at most 50.00 um");
    assert_eq!(result.metric, "peak(tool.displacement_y)");
}

#[test]
fn nan_never_holds() {
    for bad in [
        vec![f64::NAN; 3],
        vec![0.0, f64::NAN, 0.0],
        vec![f64::INFINITY, 0.0],
        vec![],
    ] {
        for (min, max) in [(None, Some(1e9)), (Some(-1e9), None)] {
            let result = claim("m", min, max)
                .evaluate(&recording(bad.clone()), None)
                .unwrap();
            assert!(
                !result.holds && result.value.is_none(),
                "{bad:?}: {result:?}"
            );
        }
    }
    let result = claim("m", None, Some(1.0))
        .evaluate(&recording(vec![0.0, f64::NAN]), None)
        .unwrap();
    assert_eq!(
        result.note.as_deref(),
        Some("the channel is NaN from 0.100000 s")
    );
}

/// A depth without limit is above any bound, and below none.
#[test]
fn an_infinite_scalar_is_a_value() {
    let mut recording = recording(vec![0.0]);
    recording.scalars = vec![Scalar::new("depth", Unit::Metre, f64::INFINITY, "")];
    let judged = |min, max| {
        let mut claim = claim("m", min, max);
        claim.metric = MetricSpec::Scalar {
            name: "depth".into(),
        };
        claim.evaluate(&recording, None).unwrap()
    };
    let deep = judged(Some(2e-3), None);
    assert!(deep.holds, "{deep:?}");
    assert_eq!(deep.shown, "infinite, at least 0.002000 m");
    let json = serde_json::to_value(&deep).unwrap();
    assert!(json["value"].is_null());
    assert_eq!(json["value_status"], "infinite");
    assert!(!judged(None, Some(2e-3)).holds);
}

#[test]
fn a_diverged_run_holds_nothing() {
    let mut recording = recording(vec![0.0, 0.1]);
    recording.outcome = Outcome::Diverged {
        time_s: 0.1,
        quantity: "energy".into(),
        value: 2.0,
        limit: 1.0,
        rule: "energy must not grow".into(),
    };
    let result = claim("m", None, Some(1.0))
        .evaluate(&recording, None)
        .unwrap();
    assert!(!result.holds);
    assert!(result.note.unwrap().contains("diverged at 0.1000 s"));
}

#[test]
fn a_ratio_to_another_run() {
    let mut claim = claim("1", Some(3.0), None);
    claim.relative_to = Some(RunReference {
        scenario: None,
        overrides: vec![("process.chamfer.spindle_rpm".into(), "300".into())],
    });
    let (fast, slow) = (recording(vec![0.0, 3.5]), recording(vec![0.0, 1.0]));
    let result = claim.evaluate(&fast, Some(&slow)).unwrap();
    assert_eq!(
        (result.value, result.holds, result.unit),
        (Some(3.5), true, Unit::One)
    );
    assert!(
        result
            .metric
            .ends_with("relative to this scenario with process.chamfer.spindle_rpm = 300")
    );

    let still = claim
        .evaluate(&fast, Some(&recording(vec![0.0, 0.0])))
        .unwrap();
    assert!(!still.holds, "a ratio to nothing is no number");
    assert_eq!(
        still.note.as_deref(),
        Some("the reference run's value is 0 m")
    );
    assert!(
        claim
            .evaluate(&fast, None)
            .unwrap_err()
            .to_string()
            .contains("is needed to judge it")
    );
}

#[test]
fn a_claim_that_cannot_be_judged_says_why() {
    let header = recording(vec![0.0]).header;
    let message = |claim: ClaimSpec| claim.check(&header).unwrap_err().to_string();
    assert_eq!(
        message(claim("m", None, None)),
        "claim \"stays near\": a claim needs min, max or both"
    );
    assert_eq!(
        message(claim("mm", Some(2.0), Some(1.0))),
        "claim \"stays near\": min 2.000 mm is above max 1.000 mm"
    );
    assert!(message(claim("N", None, Some(1.0))).contains(
        "unit \"N\" does not fit peak(tool.displacement_y); accepted: m, cm, mm, um, µm, μm, nm"
    ));
    assert!(message(claim("m", Some(f64::NAN), None)).ends_with("a bound is not a number"));
}

#[test]
fn a_scalars_unit_is_checked_when_it_is_known() {
    let mut recording = recording(vec![0.0]);
    recording.scalars = vec![Scalar::new(
        "chamfer.width_spread",
        Unit::Metre,
        f64::NAN,
        "",
    )];
    let mut claim = claim("N", None, Some(1.0));
    claim.metric = MetricSpec::Scalar {
        name: "chamfer.width_spread".into(),
    };
    claim.check(&recording.header).unwrap();
    assert!(claim.evaluate(&recording, None).is_err());
    claim.unit = UserUnit::parse("mm").unwrap();
    let result = claim.evaluate(&recording, None).unwrap();
    assert!(!result.holds);
    assert_eq!(result.note.as_deref(), Some("the run gave no value"));
}
