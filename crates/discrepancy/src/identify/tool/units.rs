//! What speaks against the units of FRFs: a factor on all of them leaves frequencies and damping as
//! they are, and shows in the stiffness of the tool's modes alone.

use std::f64::consts::TAU;

use truecut_recording::significant;
use truecut_scenario::identification::MotionKind;

use super::ToolMode;

/// What a tool tip swings on, N/m: an end mill of 3 mm that stands out by 40 mm has 1e5, heads of
/// machining centres some 1e8. Ten times that, since a heavy spindle on a light arm swings against
/// it and looks as many times stiffer.
const STIFFNESS_N_PER_M: [f64; 2] = [3e4, 3e9];
/// By which mass it swings, kg: that end mill by 1 g, shorter ones of its kind by half of it.
const LEAST_KG: f64 = 1e-4;
/// The usual, by which one unit is told from another that would do as well, N/m.
const USUAL_N_PER_M: f64 = 1e7;
/// Lengths by powers of a thousand below the metre.
const SMALLER: [&str; 3] = ["mm", "um", "nm"];

/// That the most compliant of the modes, which lead the FRFs, is softer, lighter or stiffer than
/// any, and the unit that was probably meant.
pub fn doubt_of_units(modes: &[ToolMode], kind: MotionKind) -> Option<String> {
    let measured = modes.iter().map(|mode| (mode, as_measured(mode)));
    let (mode, stiffness) = measured.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mass_per_stiffness = (TAU * mode.measured_hz).powi(-2);
    let [least, most] = STIFFNESS_N_PER_M;
    let is_usual = |stiffness: f64| {
        (least..=most).contains(&stiffness) && stiffness * mass_per_stiffness >= LEAST_KG
    };
    if is_usual(stiffness) {
        return None;
    }
    let off = |power: i32| (stiffness * 1e3_f64.powi(power) / USUAL_N_PER_M).ln().abs();
    let powers = (-3..=3).filter(|power| is_usual(stiffness * 1e3_f64.powi(*power)));
    let power = powers.min_by(|a, b| off(*a).total_cmp(&off(*b)));
    let meaning = power.map_or_else(String::new, |power| {
        format!(" It looks like {}", meaning(power, kind))
    });
    Some(format!(
        "the softest tool mode, at {} Hz, has {} N/µm and {} kg as it was measured, and what a tool tip swings on \
         has {} to {} N/µm and {LEAST_KG} kg at least: is a unit of the FRFs wrong (that of the response or of the \
         force, or a scale)?{meaning}",
        significant(mode.measured_hz, 4),
        significant(1e-6 * stiffness, 2),
        significant(stiffness * mass_per_stiffness, 2),
        least / 1e6,
        most / 1e6,
    ))
}

/// ω'²/φ², N/m, which holds no mass of the arm's model: φ² = (1 − m/M)/m, and 1 − m/M = (ω/ω')².
fn as_measured(mode: &ToolMode) -> f64 {
    mode.stiffness_n_per_m * (mode.measured_hz / mode.frequency_hz).powi(4)
}

/// What makes a mode look softer by so many powers of a thousand (stiffer, of a negative power).
fn meaning(power: i32, kind: MotionKind) -> String {
    let per = match kind {
        MotionKind::Displacement => "",
        MotionKind::Velocity => "/s",
        MotionKind::Acceleration => "/s^2",
    };
    let taken = |small: &str, large: &str| match power > 0 {
        true => format!("{small}{per} taken for {large}{per}"),
        false => format!("{large}{per} taken for {small}{per}"),
    };
    let steps = power.unsigned_abs() as usize;
    let response = taken(SMALLER[steps - 1], "m");
    if steps > 1 {
        return response;
    }
    let forces = match power > 0 {
        true => "forces in kN taken for N",
        false => "forces in N taken for kN",
    };
    format!("{response}, {}, or {forces}", taken("um", "mm"))
}
