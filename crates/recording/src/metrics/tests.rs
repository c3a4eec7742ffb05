use super::*;
use crate::recording::Scalar;

fn recording() -> Recording {
    let time_s: Vec<f64> = (0..=4000).map(|row| f64::from(row) * 1e-3).collect();
    let channels = vec![
        ChannelSpec::new("tool.displacement_y", Unit::Metre, ""),
        ChannelSpec::new("tool.displacement_z", Unit::Metre, ""),
        ChannelSpec::new("foot.sliding", Unit::One, ""),
    ];
    let y = time_s
        .iter()
        .map(|t| 1e-5 * t * (std::f64::consts::TAU * 5.0 * t).cos())
        .collect();
    let z = time_s
        .iter()
        .map(|t| 1e-5 * t * (std::f64::consts::TAU * 5.0 * t).sin())
        .collect();
    let sliding = time_s
        .iter()
        .map(|&t| f64::from(u8::from(t >= 2.6)))
        .collect();
    Recording {
        header: Header {
            channels,
            ..Header::default()
        },
        time_s,
        columns: vec![y, z, sliding],
        scalars: vec![Scalar::new("chamfer.width_spread", Unit::Metre, 1.9e-5, "")],
        ..Recording::default()
    }
}

fn reduced(reducer: Reducer, channels: &[&str], window: Window) -> MetricSpec {
    MetricSpec::Reduced {
        reducer,
        channels: channels.iter().map(|&name| name.to_owned()).collect(),
        window,
    }
}

#[test]
fn verify_metrics_of_a_growing_circle() {
    let recording = recording();
    let yz = ["tool.displacement_y", "tool.displacement_z"];
    let value = |spec: &MetricSpec| spec.evaluate(&recording).unwrap();

    let norm = value(&reduced(Reducer::PeakNorm, &yz, Window::ALL));
    assert!((norm.value - 4e-5).abs() < 1e-18 && norm.unit == Unit::Metre);
    let half = Window {
        to_fraction: Some(0.5),
        ..Window::ALL
    };
    assert!((value(&reduced(Reducer::PeakNorm, &yz, half)).value - 2e-5).abs() < 1e-18);

    let started = value(&reduced(
        Reducer::FirstTimeAbove {
            threshold: 0.5,
            hold_s: 0.003,
        },
        &["foot.sliding"],
        Window::ALL,
    ));
    assert!((started.value - 2.6).abs() < 1e-12 && started.unit == Unit::Second);
    let line = value(&reduced(
        Reducer::SpectralLine {
            band_hz: [1.0, 20.0],
        },
        &yz[..1],
        Window::ALL,
    ));
    assert!(
        (line.value - 5.0).abs() < 0.01 && line.unit == Unit::Hertz,
        "{line:?}"
    );
    assert_eq!(
        value(&MetricSpec::Scalar {
            name: "chamfer.width_spread".into()
        })
        .value,
        1.9e-5
    );
}

#[test]
fn an_unknown_channel_names_the_nearest() {
    let error = reduced(Reducer::Peak, &["tool.displacment_y"], Window::ALL)
        .check(&recording().header)
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "unknown channel \"tool.displacment_y\"; did you mean \"tool.displacement_y\"?"
    );
    let error = MetricSpec::Scalar {
        name: "chamfer.spread".into(),
    }
    .evaluate(&recording())
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "unknown scalar \"chamfer.spread\"; did you mean \"chamfer.width_spread\"?"
    );
}

#[test]
fn channels_must_fit_the_reducer() {
    let header = recording().header;
    let two = ["tool.displacement_y", "foot.sliding"];
    assert_eq!(
        reduced(Reducer::Peak, &two, Window::ALL)
            .check(&header)
            .unwrap_err()
            .to_string(),
        "metric \"peak\" takes one channel, 2 given"
    );
    assert_eq!(
        reduced(Reducer::PeakNorm, &two, Window::ALL)
            .check(&header)
            .unwrap_err()
            .to_string(),
        "channels of one metric must share a unit: \"tool.displacement_y\" is in m, \"foot.sliding\" in 1"
    );
    assert!(
        reduced(Reducer::PeakNorm, &[], Window::ALL)
            .check(&header)
            .is_err()
    );
}

#[test]
fn nan_and_empty_windows_give_a_note_instead_of_a_value() {
    let mut recording = recording();
    recording.columns[0][1500] = f64::NAN;
    let spec = |window| reduced(Reducer::Peak, &["tool.displacement_y"], window);
    let metric = spec(Window::ALL).evaluate(&recording).unwrap();
    assert!(metric.value.is_nan());
    assert_eq!(
        metric.note.as_deref(),
        Some("the channel is NaN from 1.50000 s")
    );
    let before = spec(Window {
        to_s: Some(1.0),
        ..Window::ALL
    })
    .evaluate(&recording)
    .unwrap();
    assert!(before.value.is_finite() && before.note.is_none());
    let after = spec(Window {
        from_s: Some(9.0),
        ..Window::ALL
    })
    .evaluate(&recording)
    .unwrap();
    assert_eq!(
        after.note.as_deref(),
        Some("the recording has no rows in the window")
    );
}

#[test]
fn a_metric_reads_like_its_rule() {
    let window = Window {
        from_s: Some(1.0),
        to_fraction: Some(0.5),
        ..Window::ALL
    };
    let spec = reduced(
        Reducer::SpectralLine {
            band_hz: [1.0, 20.0],
        },
        &["tool.displacement_y"],
        window,
    );
    assert_eq!(
        spec.to_string(),
        "spectral_line(tool.displacement_y, 1–20 Hz) from 1 s to 50 %"
    );
}
