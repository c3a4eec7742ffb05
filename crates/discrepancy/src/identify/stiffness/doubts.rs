//! What speaks against the table or its units rather than against a stiffness.

use std::f64::consts::TAU;

use truecut_recording::{Unit, significant};
use truecut_scenario::identification::{StiffnessQuantity, StiffnessSpec};

use super::{Status, StiffnessReport};
use crate::identify::IdentifyError;
use crate::identify::readings::Readings;

/// A component of which more than this part is left is not explained.
const UNEXPLAINED: f64 = 0.5;
/// Components in which so small a part of the largest is measured say little.
const SMALL: f64 = 0.1;
/// And what is left may be noise up to so many times what is stated.
const NOISE: f64 = 3.0;
/// Joints by which angles are judged at least: one alone may hardly move.
const LEAST_JOINTS: usize = 2;
/// Units of force that are mistaken for newtons, and of length for the one given: by how much an
/// arm looks softer then, and what is mistaken where it looks stiffer by as much.
const UNITS: [(f64, &str, &str); 5] = [
    (
        4.448_222,
        "forces in lbf taken for N",
        "forces in N taken for lbf",
    ),
    (
        9.806_65,
        "forces in kg (kgf) taken for N",
        "forces in N taken for kg (kgf)",
    ),
    (
        25.4,
        "displacements in mm taken for inches",
        "displacements in inches taken for mm",
    ),
    (
        1e3,
        "forces in kN taken for N, or displacements in um for mm, or in mm for m",
        "forces in N taken for kN, or displacements in mm for um, or in m for mm",
    ),
    (
        1e6,
        "displacements in um taken for m",
        "displacements in m taken for um",
    ),
];
/// The same where nothing but rotations is measured.
const OF_ROTATIONS: (f64, &str, &str) = (
    360.0 / TAU,
    "rotations in deg taken for rad",
    "rotations in rad taken for deg",
);
/// A factor is near a unit's within this ratio: stiffnesses of a robot's file are often estimates.
const NEAR: f64 = 1.6;
/// Ratios of all joints to the file's values are one factor if they differ by no more than this
/// power of it: a file of guesses is off by one factor here and by another there.
const COMMON: f64 = 1.0 / 3.0;
/// If all stiffnesses are off by more than this factor, the cause is another (units, axes).
const ABSURD: f64 = 30.0;

/// The units that make an arm look so many times softer, if any are near.
fn units_near(times: f64, only_rotations: bool) -> Option<&'static str> {
    let far = |factor: f64| (times / factor).ln().abs();
    let of_rotations = only_rotations.then_some(OF_ROTATIONS);
    let tried = UNITS.into_iter().chain(of_rotations);
    let tried =
        tried.flat_map(|(factor, softer, stiffer)| [(factor, softer), (1.0 / factor, stiffer)]);
    let (factor, meaning) = tried.min_by(|a, b| far(a.0).total_cmp(&far(b.0)))?;
    (far(factor) < NEAR.ln()).then_some(meaning)
}

/// That all stiffnesses found are off those of the robot's file by one factor, as they are where a
/// unit is wrong.
pub(super) fn of_units(report: &StiffnessReport) -> Option<String> {
    let mut ratios: Vec<f64> = (report.joints.iter())
        .filter_map(|joint| Some(joint.value? / joint.nominal?))
        .collect();
    ratios.sort_by(f64::total_cmp);
    let (least, most) = (*ratios.first()?, *ratios.last()?);
    let middle = ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64;
    let is_common = ratios.len() >= LEAST_JOINTS && (most / least).ln() < COMMON * middle.abs();
    let only_rotations = report.components.iter().all(|one| one.unit == "rad");
    let meaning = units_near((-middle).exp(), only_rotations).filter(|_| is_common);
    let is_absurd = least > ABSURD || most < 1.0 / ABSURD;
    (is_absurd || meaning.is_some()).then(|| {
        let range = match ratios.len() {
            1 => String::new(),
            _ => format!(" ({} to {})", significant(least, 2), significant(most, 2)),
        };
        let so = meaning.map_or_else(String::new, |meaning| format!(" It looks like {meaning}"));
        format!(
            "every identified stiffness is about {} times that of the robot's file{range}: is a unit wrong?{so}",
            significant(middle.exp(), 2)
        )
    })
}

/// That the stiffnesses found do not explain what was measured, so that none of them agrees with
/// anything.
pub(super) fn of_explanation(report: &StiffnessReport) -> Option<String> {
    let contradictory = |one: &&super::JointStiffness| one.status == Status::Contradictory;
    if let Some(joint) = report.joints.iter().find(contradictory) {
        return Some(format!(
            "joint `{}` contradicts the table, so that the others are no finding either",
            joint.name
        ));
    }
    let largest = |unit: &str| {
        let own = report.components.iter().filter(|one| one.unit == unit);
        own.map(|one| one.measured_rms).fold(0.0, f64::max)
    };
    let bad = report.components.iter().find(|one| {
        let counts = one.measured_rms > SMALL * largest(one.unit);
        let is_noise = one
            .noise
            .is_some_and(|noise| one.residual_rms < NOISE * noise);
        counts && !is_noise && one.residual_rms > UNEXPLAINED * one.measured_rms
    })?;
    Some(format!(
        "{} % of {} is left unexplained: postures, loads and displacements do not belong together as they stand (units \
         of angles, axes of loads, order of columns), and no stiffness is confirmed or refuted",
        significant(100.0 * bad.residual_rms / bad.measured_rms, 2),
        bad.channel
    ))
}

/// That angles said to be degrees look like radians.
pub(super) fn of_angles(readings: &Readings, spec: &StiffnessSpec) -> Option<String> {
    let in_degrees: Vec<usize> = (spec.columns.iter())
        .filter(|column| column.unit.unit == Unit::Radian && column.unit.symbol != "rad")
        .filter_map(|column| match column.quantity {
            StiffnessQuantity::Joint(joint) => Some(joint),
            _ => None,
        })
        .collect();
    let degrees = |joint: usize| {
        let postures = readings.loadings.iter();
        postures.map(move |loading| loading.command[joint].to_degrees().abs())
    };
    let largest = in_degrees.iter().flat_map(|joint| degrees(*joint));
    let largest = largest.fold(0.0, f64::max);
    let is_told = in_degrees.len() >= LEAST_JOINTS && readings.postures > 1;
    (is_told && largest > 0.0 && largest < TAU).then(|| {
        format!(
            "no joint is commanded to more than {} deg in any posture: are the angles of the table in rad?",
            significant(largest, 3)
        )
    })
}

/// Loads under which the arm finds no rest, with what their size compares to.
pub(super) fn of_no_rest(error: IdentifyError, times_predicted: Option<f64>) -> IdentifyError {
    let Some(times) = times_predicted.filter(|times| *times > 0.0) else {
        return error;
    };
    let near = units_near(times, false);
    let meaning = near.map_or(String::new(), |meaning| format!(" ({meaning}?)"));
    IdentifyError {
        message: format!(
            "{} The displacements are {} times those that the robot's file gives under these loads{meaning}",
            error.message,
            significant(times, 3)
        ),
        ..error
    }
}
