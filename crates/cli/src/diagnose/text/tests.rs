//! Texts of a diagnosis.

use truecut_discrepancy::diagnose::{ChannelErrors, Evidence, UnknownCurve};
use truecut_recording::Unit;

use super::*;

fn parameter(value: f64, width: Option<f64>, unit: Unit) -> Parameter {
    Parameter {
        value,
        low: width.map(|width| value - width),
        high: width.map(|width| value + width),
        unit: unit.to_string(),
    }
}

#[test]
fn estimates_carry_their_unit_and_factors_none() {
    let cubic = parameter(2.5e7, Some(1e6), Unit::NewtonMetrePerCubicRadian);
    assert_eq!(estimate(&cubic), "2.500e7 (2.400e7 to 2.600e7) N m/rad^3");
    let tilt = parameter(5e-7, None, Unit::RadianPerNewtonMetre);
    assert_eq!(
        estimate(&tilt),
        "5.000e-7 rad/(N m) (not bounded by the data)"
    );
    let factor = parameter(1.25, Some(0.25), Unit::One);
    assert_eq!(estimate(&factor), "1.250 (1.000 to 1.500)");
    assert_eq!(with_unit("0.300", "1"), "0.300");
}

/// A finding is not rounded away: a clock that is 0.03 % fast, a gap known to a thousandth.
#[test]
fn estimates_show_their_interval_and_how_far_they_are_from_one() {
    let shown = |value, width, unit| estimate(&parameter(value, width, unit));
    assert_eq!(
        shown(1.00033, Some(4e-5), Unit::One),
        "1.000330 (1.000290 to 1.000370)"
    );
    // not bounded, or wider than what it is off by
    assert_eq!(
        shown(1.00033, None, Unit::One),
        "1.00033 (not bounded by the data)"
    );
    assert_eq!(
        shown(1.00033, Some(5e-4), Unit::One),
        "1.00033 (0.99983 to 1.00083)"
    );
    assert_eq!(
        shown(0.0011965, Some(2.5e-6), Unit::Radian),
        "0.0011965 (0.0011940 to 0.0011990) rad"
    );
    assert_eq!(
        shown(0.0, Some(0.5), Unit::NewtonMetre),
        "0 (-0.5000 to 0.5000) N m"
    );
}

#[test]
fn an_explanation_is_behind_by_what_put_it_there() {
    let other = Alternative {
        causes: Vec::new(),
        angle_deg: 23.0,
        behind_t: -0.3,
        criterion_difference: 2.0 * 20_f64.ln(),
    };
    let diagnosis = Diagnosis {
        runner_up: Some(other),
        ..Diagnosis::default()
    };
    let rows = alternative_rows(&diagnosis);
    assert_eq!(rows[0][1], "odds 20 : 1 against it, 23° apart");
}

#[test]
fn nominal_values_are_told_in_the_unit_of_their_key() {
    let nominal = Nominal {
        key: "process.chamfer.depth_mm".into(),
        before: 1e-3,
        after: parameter(1.25e-3, Some(2.5e-4), Unit::Metre),
    };
    let (before, after) = in_unit_of_key(&nominal);
    assert!((before - 1.0).abs() < 1e-12);
    assert_eq!(estimate(&after), "1.250 (1.000 to 1.500) mm");
}

fn errors(refitted: f64, after: f64) -> ChannelErrors {
    ChannelErrors {
        before: refitted,
        refitted,
        after,
        noise_floor: after,
        noise_source: NoiseSource::Bound,
        noise_without_memory: 0.0,
        unit: "N m".into(),
    }
}

/// Where noise is bounded well below what is left, that is not "may be all noise".
#[test]
fn what_is_left_far_beyond_a_bound_is_no_noise() {
    let told = |noise_floor: f64| {
        let errors = ChannelErrors {
            noise_floor,
            noise_without_memory: 1.0,
            ..errors(22.3, 20.0)
        };
        unbounded(&Diagnosis {
            channels: [("joint3.drive_torque".to_owned(), errors)].into(),
            ..Diagnosis::default()
        })
    };
    assert!(
        told(20.0).contains("may be all noise, or 20"),
        "{}",
        told(20.0)
    );
    let bounded = told(1.5);
    assert!(
        bounded.contains("is at most 1.50 N m: what is left is 13 to 20"),
        "{bounded}"
    );
}

/// Most of what stands out of the noise is left, and most of what one sees has gone: that is no
/// small part.
#[test]
fn what_takes_most_of_a_channel_away_is_no_small_part() {
    let told = |after: f64| {
        let diagnosis = Diagnosis {
            verdict: Verdict::UnknownCause,
            causes: vec![Cause {
                kind: "joint_coulomb".into(),
                target: Some("joint1".into()),
                parameters: std::collections::BTreeMap::new(),
                evidence: Evidence {
                    likelihood_gain: 50.0,
                    log10_odds: 9.0,
                    validation_t: 5.0,
                    practical_gain: 0.5,
                },
            }],
            unexplained_fraction: 0.82,
            channels: [("joint1.drive_torque".to_owned(), errors(22.3, after))].into(),
            ..Diagnosis::default()
        };
        headline(&diagnosis)
    };
    assert!(
        told(1.6).starts_with("CAUSE NAMED, BUT NOT ALL OF IT"),
        "{}",
        told(1.6)
    );
    assert!(told(21.0).contains("A SMALL PART"), "{}", told(21.0));
}

/// What is left beside a curve is not what the effects known do not explain.
#[test]
fn what_is_left_beside_a_curve_says_so() {
    let curve = UnknownCurve {
        kind: "joint_friction_by_speed".into(),
        target: "joint1".into(),
        x: vec![0.0],
        x_unit: "rad/s".into(),
        value: vec![0.0],
        low: vec![None],
        high: vec![None],
        unit: "N m".into(),
        log10_odds: 9.0,
    };
    let mut diagnosis = Diagnosis::default();
    assert!(unexplained(&diagnosis).starts_with("nothing of the discrepancy"));
    diagnosis.curve = Some(curve);
    assert!(unexplained(&diagnosis).starts_with("beside causes and curve: nothing"));
}
