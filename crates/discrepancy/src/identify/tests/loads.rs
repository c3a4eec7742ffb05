//! Stiffness from loads.

use std::path::Path;

use nalgebra::Vector6;
use truecut_recording::measured::{Column, Table};
use truecut_scenario::Identification;
use truecut_scenario::identification::FrameId;
use truecut_sim::elastic::ElasticArm;

use super::normal;
use crate::identify::readings::{Readings, readings};
use crate::identify::stiffness::{Status, StiffnessReport, identify};

/// The arm of two joints, its shoulder 10 % stiffer and its elbow 20 % softer than its file says.
const STIFFNESS: [f64; 2] = [132.0e3, 24.0e3];

fn file(robot: &str, further: &str) -> Identification {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/identification/test.toml");
    let text = format!(
        "name = \"test\"\n[robot]\nurdf = \
         \"../../assets/robots/{robot}/robot.urdf\"\n[stiffness]\nfile = \"t.csv\"\n{further}"
    );
    Identification::from_str(&path, &text).unwrap()
}

fn planar(zero: &str, noise: f64) -> Identification {
    let mut text = format!("zero = \"{zero}\"\n");
    for (column, unit) in [
        ("joint1.command", "rad"),
        ("joint2.command", "rad"),
        ("force_x", "N"),
        ("force_z", "N"),
    ] {
        text += &format!(
            "[[stiffness.column]]\ncolumn = \"{column}\"\nchannel = \"{column}\"\nunit = \
             \"{unit}\"\n"
        );
    }
    for column in ["displacement_x", "displacement_z"] {
        text += &format!(
            "[[stiffness.column]]\ncolumn = \"{column}\"\nchannel = \"{column}\"\nunit = \
             \"m\"\nnoise = {noise}\n"
        );
    }
    file("arm_2r", &text)
}

/// Three postures, each under six forces.
fn table(arm: &ElasticArm, zero: f64, mut noise: impl FnMut() -> f64) -> Table {
    let names = [
        "joint1.command",
        "joint2.command",
        "force_x",
        "force_z",
        "displacement_x",
        "displacement_z",
    ];
    let mut table = Table {
        source: "t.csv".into(),
        columns: names
            .map(|name| Column {
                name: name.into(),
                values: Vec::new(),
            })
            .to_vec(),
        ..Table::default()
    };
    for (p, posture) in [[-0.7, 1.0], [0.2, 0.9], [-1.2, 1.8]].iter().enumerate() {
        for (x, z) in [
            (200.0, 0.0),
            (-200.0, 0.0),
            (0.0, 200.0),
            (0.0, -200.0),
            (100.0, 0.0),
            (0.0, 0.0),
        ] {
            let wrench = Vector6::new(x, 0.0, z, 0.0, 0.0, 0.0);
            let moved = arm
                .deflection(posture, FrameId::Tool, FrameId::Tool, wrench)
                .unwrap()
                .motion;
            let reading = |value: f64, noise: f64| value + noise + zero * (p as f64 + 1.0);
            let row = [
                posture[0],
                posture[1],
                x,
                z,
                reading(moved.x, noise()),
                reading(moved.z, noise()),
            ];
            for (column, value) in table.columns.iter_mut().zip(row) {
                column.values.push(value);
            }
        }
    }
    table
}

fn run(file: &Identification, table: &Table) -> StiffnessReport {
    let arm = ElasticArm::load(&file.robot).unwrap();
    let spec = file.stiffness.as_ref().unwrap();
    let rows: Readings = readings(table, spec, &arm).unwrap();
    identify(&rows, spec, &arm).unwrap()
}

fn true_arm(file: &Identification) -> ElasticArm {
    ElasticArm::load(&file.robot)
        .unwrap()
        .with_stiffness(&STIFFNESS)
}

#[test]
fn verify_exact_readings_give_the_stiffness_back_under_gravity() {
    for (zero, offset) in [("unloaded", 0.0), ("unknown", 0.013)] {
        let file = planar(zero, 1e-5);
        let report = run(&file, &table(&true_arm(&file), offset, || 0.0));
        for (joint, expected) in report.joints.iter().zip(STIFFNESS) {
            let value = joint.value.unwrap();
            assert!(
                (value / expected - 1.0).abs() < 1e-7,
                "{zero}: {} {value}",
                joint.name
            );
            assert_eq!(joint.agrees, Some(false));
        }
    }
}

/// A force across the stretched arm, by hand: the tool is displaced by F (L²/K₁ + l²/K₂).
#[test]
fn verify_the_stretched_arm_gives_way_by_the_lever_rule() {
    let mut file = planar("unloaded", 1e-5);
    file.robot.gravity = false;
    let arm = true_arm(&file);
    let wrench = Vector6::new(0.0, 0.0, 1e-3, 0.0, 0.0, 0.0);
    let moved = arm
        .deflection(&[0.0, 0.0], FrameId::Tool, FrameId::Tool, wrench)
        .unwrap();
    let expected = 1e-3 * (1.4_f64.powi(2) / STIFFNESS[0] + 0.7_f64.powi(2) / STIFFNESS[1]);
    assert!(
        (moved.motion.z / expected - 1.0).abs() < 1e-6,
        "{} {expected}",
        moved.motion.z
    );
}

#[test]
fn verify_intervals_hold_the_truth_as_often_as_they_say() {
    for (zero, offset) in [("unloaded", 0.0), ("unknown", 0.02)] {
        let file = planar(zero, 2e-5);
        let arm = true_arm(&file);
        let (mut held, mut all, mut over) = (0, 0, 0.0);
        for seed in 0..300 {
            let mut draw = normal(seed);
            let report = run(&file, &table(&arm, offset, || 2e-5 * draw()));
            over += report.residual_over_noise.unwrap() / 300.0;
            for (joint, expected) in report.joints.iter().zip(STIFFNESS) {
                all += 1;
                held += i32::from((joint.low.unwrap()..joint.high.unwrap()).contains(&expected));
            }
        }
        let share = f64::from(held) / f64::from(all);
        // Standard deviation of a rate of 95 % over 600 draws: 0.9 percentage points.
        assert!((0.923..0.977).contains(&share), "{zero}: {share}");
        assert!(
            (over - 1.0).abs() < 0.02,
            "{zero}: residual over noise {over}"
        );
    }
}

#[test]
fn a_joint_that_only_noise_moves_has_a_lower_bound() {
    let file = planar("unloaded", 1e-3);
    let mut draw = normal(5);
    let report = run(&file, &table(&true_arm(&file), 0.0, || 3e-3 * draw()));
    let shoulder = &report.joints[0];
    assert_eq!(shoulder.status, Status::LowerBound);
    assert!(shoulder.value.is_none() && shoulder.low.unwrap() < STIFFNESS[0]);
}

#[test]
fn a_single_posture_and_direction_cannot_tell_two_joints_apart() {
    let file = planar("unloaded", 1e-4);
    let mut draw = normal(8);
    let mut table = table(&true_arm(&file), 0.0, || 0.0);
    // One posture, pushed up and down, measured in one direction; the information in the posture's
    // change under load is far below the noise.
    for column in &mut table.columns {
        column.values = (column.values[2..4].iter().copied().cycle().take(8)).collect();
        match column.name.as_str() {
            "displacement_x" => column.values.fill(f64::NAN),
            "displacement_z" => column.values.iter_mut().for_each(|z| *z += 1e-4 * draw()),
            _ => {}
        }
    }
    let report = run(&file, &table);
    assert_eq!(report.joints.len(), 2);
    for (joint, other) in report.joints.iter().zip(["elbow", "shoulder"]) {
        let vague = [Status::NotSeparable, Status::LowerBound].contains(&joint.status);
        assert!(vague && joint.value.is_none(), "{joint:?}");
        assert_eq!(joint.confused_with, [other]);
    }
}

#[test]
fn a_slip_of_the_unit_and_an_outlier_are_named() {
    let file = planar("unloaded", 1e-5);
    let mut draw = normal(3);
    let mut readings = table(&true_arm(&file), 0.0, || 1e-5 * draw());
    readings.columns[4].values[7] += 2e-3;
    let report = run(&file, &readings);
    assert_eq!(report.outliers[0].place, "row 8");
    assert!(
        report
            .notes
            .iter()
            .any(|note| note.contains("times the stated noise"))
    );
    let mut readings = table(&true_arm(&file), 0.0, || 0.0);
    let told = run(&file, &readings).notes;
    assert!(!told.iter().any(|note| note.contains("unit")), "{told:?}");
    for column in &mut readings.columns[4..] {
        column.values.iter_mut().for_each(|value| *value /= 1e3);
    }
    let report = run(&file, &readings);
    assert!(
        report
            .notes
            .iter()
            .any(|note| note.contains("is a unit wrong?")),
        "{:?}",
        report.notes
    );
    for column in &mut readings.columns[4..] {
        column.values.iter_mut().for_each(|value| *value *= -1e3);
    }
    let report = run(&file, &readings);
    assert!(
        report
            .joints
            .iter()
            .all(|joint| joint.status == Status::Contradictory)
    );
}

/// Forces in kgf or lbf read as N make every joint softer by one factor, far below what is absurd;
/// the values stay. Joints that are off by different factors are a robot's file of guesses.
#[test]
fn a_common_factor_of_units_in_use_is_told_with_its_unit() {
    let file = planar("unloaded", 1e-5);
    for (newtons, words) in [
        (9.806_65, "forces in kg (kgf) taken for N"),
        (4.448_222, "forces in lbf taken for N"),
        (1.0 / 9.806_65, "forces in N taken for kg (kgf)"),
    ] {
        let mut readings = table(&true_arm(&file), 0.0, || 0.0);
        for column in &mut readings.columns[2..4] {
            column.values.iter_mut().for_each(|value| *value /= newtons);
        }
        let report = run(&file, &readings);
        let told = report.notes.iter().find(|note| note.contains(words));
        assert!(
            told.is_some_and(|note| note.contains("is a unit wrong?")),
            "{words}: {:?}",
            report.notes
        );
        assert!(report.joints.iter().all(|joint| joint.value.is_some()));
    }
    let guessed = ElasticArm::load(&file.robot).unwrap();
    let guessed = guessed.with_stiffness(&[120.0e3 / 20.0, 30.0e3 / 5.0]);
    let report = run(&file, &table(&guessed, 0.0, || 0.0));
    assert!(
        !report.notes.iter().any(|note| note.contains("unit")),
        "{:?}",
        report.notes
    );
}
