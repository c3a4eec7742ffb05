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
/// Units of force that are mistaken for newtons, and of length for the one given, N or 1.
const UNITS: [(f64, &str); 4] = [
    (9.806_65, "forces in kg (kgf) taken for N"),
    (4.448_222, "forces in lbf taken for N"),
    (
        1e3,
        "forces in kN taken for N, or displacements in um for mm, or in mm for m",
    ),
    (1e6, "displacements in um taken for m"),
];
/// A factor is near a unit's within this ratio: stiffnesses of a robot's file are often estimates.
const NEAR: f64 = 1.6;

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
    let near = UNITS.iter().find(|(factor, _)| {
        let ratio = times / factor;
        (1.0 / NEAR..NEAR).contains(&ratio)
    });
    let meaning = near.map_or(String::new(), |(_, meaning)| format!(" ({meaning}?)"));
    IdentifyError {
        message: format!(
            "{} The displacements are {} times those that the robot's file gives under these loads{meaning}",
            error.message,
            significant(times, 3)
        ),
        ..error
    }
}
