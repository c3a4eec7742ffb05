//! Texts of a diagnosis.

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
