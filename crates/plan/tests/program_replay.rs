//! Programs run through between their points, and the parts that they are made of.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Isometry3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{BranchOptions, FrameId, Robot};
use truecut_plan::program::{
    FindingKind, Motion, PathPoint, Program, ReplayOptions, Tool, TravelOptions,
};
use truecut_plan::surface_path::{
    Segment, Speeds, SurfacePathError, Symmetry, TaughtPoints, parts_of, program_of,
};

use crate::assets;

fn pose(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    let down = UnitQuaternion::from_euler_angles(PI, 0.0, 0.0);
    Isometry3::from_parts(Translation3::new(x, y, z), down)
}

fn program(robot: &Robot, poses: &[Isometry3<f64>], speed_m_per_s: f64) -> Program {
    let points: Vec<PathPoint> = (poses.iter())
        .map(|pose| PathPoint {
            base_from_tool: *pose,
            motion: Motion::Linear { speed_m_per_s },
            turntable_rad: None,
        })
        .collect();
    let (tool, world) = (Tool::of(robot, "wheel", 1), Isometry3::identity());
    // Far points: what lies between is what is looked at.
    let options = TravelOptions {
        largest_step: PI,
        ..TravelOptions::default()
    };
    Program::along(robot, "RUN", tool, world, &points, &options).expect("a program")
}

/// Along a line the joints turn at J⁻¹ (v, 0), taken here at a thousand places; the tool stays on
/// the line all the way.
#[test]
fn verify_joint_speeds_on_a_line_are_those_of_the_jacobian() {
    let robot = assets::robot("hp20");
    let (from, to) = (pose(0.9, -0.3, 0.4), pose(1.1, 0.4, 0.5));
    let way = to.translation.vector - from.translation.vector;
    let speed_m_per_s = 0.25;
    let program = program(&robot, &[from, to], speed_m_per_s);
    let replay = program.replay(&robot, &ReplayOptions::default());
    assert!(replay.findings.is_empty(), "{:?}", replay.findings);
    let last = replay.rows.last().expect("rows");
    assert!((last.time_s - way.norm() / speed_m_per_s).abs() < 1e-12);
    let mut expected: f64 = 0.0;
    for row in &replay.rows {
        let aside = row.world_from_tool.translation.vector - from.translation.vector;
        let off = aside - way * (aside.dot(&way) / way.norm_squared());
        let reached = robot.world_from_frame(&row.posture, FrameId::Tool);
        let apart = reached.translation.vector - row.world_from_tool.translation.vector;
        assert!(off.norm() < 1e-12 && apart.norm() < 1e-9);
        let jacobian = robot.jacobian(&row.posture, FrameId::Tool);
        let square = DMatrix::from_fn(6, 6, |r, c| jacobian[(r, c)]);
        let v = way.normalize() * speed_m_per_s;
        let twist = DVector::from_column_slice(&[v.x, v.y, v.z, 0.0, 0.0, 0.0]);
        let speeds = square.lu().solve(&twist).expect("not singular");
        for (joint, speed) in robot.chain.joints.iter().zip(speeds.iter()) {
            let limit = joint.limits.expect("limits").velocity;
            expected = expected.max(speed.abs() / limit);
        }
    }
    // Speeds are means over steps of 1 mm; the fastest place is at an end, where a mean falls short
    // by half a step's change.
    let (share, ..) = replay.fastest.expect("moves");
    assert!((share / expected - 1.0).abs() < 2e-3, "{share} {expected}");
}

/// Ends within reach, the middle inside the arm's own column.
#[test]
fn a_line_through_the_column_is_found_between_its_points() {
    let robot = assets::robot("irb6600_175_255");
    let program = program(&robot, &[pose(1.4, -1.2, 0.9), pose(-0.1, 1.6, 0.9)], 0.05);
    let inspected = program.inspect(&robot, &ReplayOptions::default().singularity);
    let place = |kind: &FindingKind| matches!(kind, FindingKind::TooFast { .. });
    assert!(inspected.iter().all(|f| place(&f.kind)), "{inspected:?}");
    let replay = program.replay(&robot, &ReplayOptions::default());
    assert!(
        replay.findings.iter().any(|finding| matches!(
            finding.kind,
            FindingKind::NearSingularity { .. }
                | FindingKind::LeavesReach { .. }
                | FindingKind::OtherPosture { .. }
        )),
        "{:?}",
        replay.findings
    );
}

/// A program whose second posture lies on another branch than the first, which no line joins.
#[test]
fn a_line_to_another_branch_is_told() {
    let robot = assets::robot("hp20");
    let ends = [pose(0.9, 0.0, 0.4), pose(0.92, 0.0, 0.4)];
    let mut program = program(&robot, &ends, 0.05);
    let solver = robot.ik_solver(&BranchOptions::default());
    let all = solver.within_limits(&ends[1], FrameId::Tool);
    let apart = |q: &Vec<f64>| {
        let each = q.iter().zip(&program.moves[0].posture);
        each.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let other = all.into_iter().max_by(|a, b| apart(a).total_cmp(&apart(b)));
    program.moves[1].posture = other.expect("branches");
    let replay = program.replay(&robot, &ReplayOptions::default());
    let told = replay.findings.iter().map(ToString::to_string);
    let told: Vec<String> = told.collect();
    assert!(
        told.iter()
            .any(|t| t.contains("the line leads to another one")),
        "{told:?}"
    );
}

/// A turntable brings every copy to the first one's place; an arm goes to each, and cannot carry
/// taught postures there.
#[test]
fn copies_come_by_turntable_or_the_arm_goes_there() {
    let robot = assets::robot("hp20");
    let line = Segment::Planned(vec![pose(0.9, 0.0, 0.4), pose(0.92, 0.0, 0.4)]);
    let symmetry = |turntable| Symmetry {
        count: 3,
        centre_m: Vector3::new(0.8, 0.0, 0.0),
        axis: Vector3::z_axis(),
        turntable,
    };
    let start = robot.default_posture();
    let taught = TaughtPoints {
        postures: vec![start.clone()],
    };
    let with_taught = [line.clone(), Segment::Taught(taught)];
    let turned = parts_of(&with_taught, Some(&symmetry(true))).expect("parts");
    assert_eq!(turned.len(), 6);
    let refused = parts_of(&with_taught, Some(&symmetry(false)));
    assert!(matches!(refused, Err(SurfacePathError::TaughtTurned)));
    let head = Program {
        name: "COPIES".to_owned(),
        comment: String::new(),
        tool: Tool::of(&robot, "wheel", 1),
        world_from_base: Isometry3::identity(),
        moves: Vec::new(),
        spindle: Vec::new(),
        notes: Vec::new(),
    };
    let speeds = Speeds {
        feed_m_per_s: 0.02,
        joint_share: 0.3,
    };
    let options = TravelOptions::default();
    for turntable in [true, false] {
        let parts =
            parts_of(std::slice::from_ref(&line), Some(&symmetry(turntable))).expect("parts");
        let program = program_of(&robot, head.clone(), &parts, &start, speeds, &options);
        let moves = program.expect("a program").moves;
        assert_eq!(moves.len(), 6);
        for (copy, pair) in moves.chunks(2).enumerate() {
            let angle = std::f64::consts::TAU * copy as f64 / 3.0;
            let expected = turntable.then_some(-angle);
            assert_eq!(pair[0].turntable_rad, expected);
            assert!(matches!(pair[0].motion, Motion::Joint { share } if share == 0.3));
            assert!(matches!(pair[1].motion, Motion::Linear { .. }));
            let place = pair[0].base_from_tool.translation.vector;
            let reach_m = 0.1;
            let at = if turntable { 0.0 } else { angle };
            let expected = Vector3::new(0.8 + reach_m * at.cos(), reach_m * at.sin(), 0.4);
            assert!((place - expected).norm() < 1e-12, "{place}");
        }
    }
}
