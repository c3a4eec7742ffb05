//! Units of FRFs by the modes of a tool.

use truecut_scenario::identification::MotionKind;

use crate::identify::tool::{ToolMode, doubt_of_units};

/// A mode of `n_per_um` and a frequency, Hz, as it is measured on an arm of 25 kg whose units are
/// `times` too large in the response.
fn measured(n_per_um: f64, hz: f64, times: f64) -> ToolMode {
    let omega = std::f64::consts::TAU * hz;
    let (arm_kg, participation) = (25.0, times * omega.powi(2) / (1e6 * n_per_um));
    let mass_kg = arm_kg / (1.0 + participation * arm_kg);
    let held = (1.0 - mass_kg / arm_kg).sqrt();
    ToolMode {
        frequency_hz: hz * held,
        damping_ratio: 0.03 * held,
        stiffness_n_per_m: (omega * held).powi(2) * mass_kg,
        direction: [1.0, 0.0, 0.0],
        measured_hz: hz,
        off_its_line: 0.0,
    }
}

fn doubt(modes: &[(f64, f64)], times: f64, kind: MotionKind) -> Option<String> {
    let modes = modes.iter().map(|(k, hz)| measured(*k, *hz, times));
    doubt_of_units(&modes.collect::<Vec<_>>(), kind)
}

#[test]
fn a_unit_of_the_response_that_is_wrong_is_named() {
    let tool = [(9.0, 905.0), (14.0, 1310.0)];
    let cases = [
        (1e6, MotionKind::Displacement, "um taken for m"),
        (
            1e3,
            MotionKind::Velocity,
            "mm/s taken for m/s, um/s taken for mm/s, or forces in kN taken for N",
        ),
        (1e6, MotionKind::Acceleration, "um/s^2 taken for m/s^2"),
        (
            1e-3,
            MotionKind::Displacement,
            "m taken for mm, mm taken for um, or forces in N taken for kN",
        ),
        (1e-6, MotionKind::Displacement, "m taken for um"),
    ];
    for (times, kind, meaning) in cases {
        let told = doubt(&tool, times, kind).unwrap();
        assert!(
            told.contains("the softest tool mode, at 905.0 Hz, has "),
            "{told}"
        );
        assert!(
            told.ends_with(&format!("It looks like {meaning}")),
            "{told}"
        );
    }
    let told = doubt(&tool, 1e6, MotionKind::Displacement).unwrap();
    assert!(
        told.contains("has 9.0e-6 N/µm and 2.8e-7 kg as it was measured"),
        "{told}"
    );
}

/// Of slender mills, of heavy spindles on an arm's wrist, of heads, and beside a mode that hardly
/// moves the tip.
#[test]
fn modes_as_machines_have_them_are_believed() {
    let real: [&[(f64, f64)]; 6] = [
        &[(0.1, 1670.0)],
        &[(0.9, 6500.0)],
        &[(0.4, 25.0), (2.0, 60.0)],
        &[(9.0, 905.0), (20_000.0, 700.0)],
        &[(41.0, 950.0), (68.5, 1150.0)],
        &[(900.0, 1400.0)],
    ];
    for modes in real {
        let told = doubt(modes, 1.0, MotionKind::Displacement);
        assert_eq!(told, None, "{modes:?}");
    }
    assert_eq!(doubt_of_units(&[], MotionKind::Displacement), None);
}
