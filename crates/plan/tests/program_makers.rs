//! Flags of programs against positions that makers' controllers recorded or showed, as published.

use std::path::Path;

use nalgebra::Isometry3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use truecut_arm::{OpwGeometry, Robot};
use truecut_plan::program::{Frames, Program, Settings, Tool, dialect_of, krl, read_text};

/// An arm of six axes: for each its place in the one before (m) and its direction; the flange lies
/// ahead of the last by a length (m), with these turns about x, y, z (rad).
fn arm(folder: &Path, axes: [([f64; 3], [i8; 3]); 6], ahead_m: f64, rpy: &str) -> Robot {
    let mut urdf = String::from("<robot name=\"arm\"><link name=\"l0\"/>");
    for (k, ([x, y, z], [i, j, l])) in axes.iter().enumerate() {
        let (own, before) = (k + 1, k);
        urdf.push_str(&format!(
            "<link name=\"l{own}\"/><joint name=\"j{own}\" type=\"revolute\"><parent link=\"l{before}\"/>\
             <child link=\"l{own}\"/><origin xyz=\"{x} {y} {z}\"/><axis xyz=\"{i} {j} {l}\"/>\
             <limit lower=\"-6.2\" upper=\"6.2\" velocity=\"3\" effort=\"1000\"/></joint>"
        ));
    }
    urdf.push_str(&format!(
        "<link name=\"flange\"/><joint name=\"end\" type=\"fixed\"><parent link=\"l6\"/><child link=\"flange\"/>\
         <origin xyz=\"{ahead_m} 0 0\" rpy=\"{rpy}\"/></joint></robot>"
    ));
    let file = folder.join("arm.urdf");
    std::fs::write(&file, urdf).expect("a file");
    Robot::load_kinematics(&file, None, None).expect("an arm")
}

fn read(robot: &Robot, file: &Path, text: &str) -> Program {
    std::fs::write(file, text).expect("a program");
    let frames = Frames {
        tool: Tool::of(robot, "tool", 1),
        world_from_base: Isometry3::identity(),
    };
    let dialect = dialect_of(file).expect("a dialect");
    let read = dialect.read(file, &read_text, robot, &frames, &Settings::default());
    read.unwrap_or_else(|error| panic!("{error}"))
}

/// One pose of an R-2000iB/165F and the joints that its controller shows for NUT and for FUT, by
/// onerobotics.com, "The perils of six-axis robots" (2013). Its J3 is measured against the
/// horizontal. Lengths: 312, 1075, 225 and 1280 mm; what stands at the flange follows from the
/// joints given, 270 mm.
#[test]
fn verify_flip_and_no_flip_are_the_postures_that_a_controller_shows() {
    let folder = tempfile::tempdir().expect("a folder");
    let axes = [
        ([0.0, 0.0, 0.0], [0, 0, 1]),
        ([0.312, 0.0, 0.0], [0, 1, 0]),
        ([0.0, 0.0, 1.075], [0, -1, 0]),
        ([0.0, 0.0, 0.225], [-1, 0, 0]),
        ([1.28, 0.0, 0.0], [0, -1, 0]),
        ([0.0, 0.0, 0.0], [-1, 0, 0]),
    ];
    let rpy = "3.141592653589793 -1.5707963267948966 0";
    let robot = arm(folder.path(), axes, 0.27, rpy);
    for (letter, wrist_deg) in [
        ("N", [77.661, -51.975, -79.273]),
        ("F", [-102.339, 51.975, 100.727]),
    ] {
        let text = format!(
            "/PROG SHOWN\n/MN\n1: UFRAME_NUM=0 ;\n2: UTOOL_NUM=1 ;\n3:J P[1] 10% FINE ;\n/POS\nP[1]{{\n\
             GP1:\nUF : 0, UT : 1, CONFIG : '{letter} U T, 0, 0, 0',\n\
             X = 1500.000 mm, Y = .000 mm, Z = 360.000 mm,\n\
             W = 135.000 deg, P = -45.000 deg, R = .000 deg\n}};\n/END\n"
        );
        let program = read(&robot, &folder.path().join("shown.ls"), &text);
        let (j2_deg, j3_deg) = (-5.284, -36.250);
        let wanted = [&[7.962, j2_deg, j3_deg + j2_deg][..], &wrist_deg].concat();
        for (joint, (found, wanted)) in program.moves[0].posture.iter().zip(&wanted).enumerate() {
            let found_deg = found.to_degrees();
            let off = found_deg - wanted;
            println!(
                "{letter} J{}: {found_deg:.3}, shown {wanted:.3} deg",
                joint + 1
            );
            assert!(off.abs() < 2e-3, "{letter} J{}: {found_deg}", joint + 1);
        }
    }
}

/// Status and turn that KR C controllers recorded, as published in programs. The turn has the signs
/// of all axes; postures drawn with these signs, the elbow up and the wrist in front, have the
/// status (its bit of 16 is that of an absolutely calibrated arm).
#[test]
fn verify_status_and_turn_go_together_as_controllers_recorded_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let axes = [
        ([0.0, 0.0, 0.675], [0, 0, -1]),
        ([0.35, 0.0, 0.0], [0, 1, 0]),
        ([1.15, 0.0, 0.0], [0, 1, 0]),
        ([0.0, 0.0, 0.041], [-1, 0, 0]),
        ([1.2, 0.0, 0.0], [0, 1, 0]),
        ([0.0, 0.0, 0.0], [-1, 0, 0]),
    ];
    let robot = arm(folder.path(), axes, 0.215, "0 1.5707963267948966 0");
    let geometry = OpwGeometry::of(&robot).expect("ortho-parallel");
    let mut random = ChaCha8Rng::seed_from_u64(3003);
    let mut draw = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
    let recorded = [
        (2, 2),
        (2, 3),
        (2, 34),
        (2, 35),
        (2, 42),
        (6, 26),
        (6, 27),
        (6, 50),
        (18, 10),
        (18, 34),
        (22, 18),
        (22, 27),
        (22, 50),
    ];
    for (status, turn) in recorded {
        for _ in 0..50 {
            let sizes_deg = [
                draw(5.0, 60.0),
                draw(50.0, 110.0),
                draw(60.0, 120.0),
                draw(5.0, 80.0),
                draw(20.0, 80.0),
                draw(5.0, 150.0),
            ];
            let mut q = sizes_deg.map(f64::to_radians);
            for (axis, value) in q.iter_mut().enumerate() {
                if turn >> axis & 1 == 1 {
                    *value = -*value;
                }
            }
            let found = krl::StatusTurn::of(&geometry, &q);
            let wanted = krl::StatusTurn {
                status: status & 7,
                turn: Some(turn),
            };
            assert_eq!(found, wanted, "S {status}, T {turn}: {q:?}");
        }
    }
}
