//! Arms of seven joints along paths: continuous across stops, from block to block, in programs and
//! as they are led; within limits from the start.

use std::path::Path;

use nalgebra::Isometry3;
use truecut_arm::{FrameId, Robot};
use truecut_plan::cam::{Attitude, CamPath, CamPoint};
use truecut_plan::motion::led::LedTask;
use truecut_plan::motion::straight::{PathStart, StraightPath, TurnKnot};
use truecut_plan::program::{Program, ReplayOptions, Start};

use crate::cam_run;
use crate::seven_axes::{CORNERS_M, SEEDS, distance, drawn, least_singular_value, off};

const FEED_M_PER_S: f64 = 0.02;
const INTERVAL_S: f64 = 5e-3;

/// Lines at one attitude from where the arm stands, with a stop at each end.
fn program(robot: &Robot, start: &[f64]) -> Program {
    let from = robot.world_from_frame(start, FrameId::Tool);
    let point = |(i, [x, y, z]): (usize, [f64; 3])| {
        let pose = from * Isometry3::translation(x, y, z);
        CamPoint {
            line: i + 2,
            place_m: pose.translation.vector,
            attitude: Attitude::Whole(pose.rotation),
            feed_m_per_s: Some(FEED_M_PER_S),
            stops: true,
        }
    };
    let path = CamPath {
        points: CORNERS_M.into_iter().enumerate().map(point).collect(),
        ..CamPath::default()
    };
    let (near, world) = (Start::Near(start), Isometry3::identity());
    cam_run::follow(near, robot, &path, Path::new("stops.csv"), world).expect("it can be followed")
}

/// A program begins in the posture given, and run through it arrives in the postures of its points.
#[test]
fn a_program_of_seven_joints_leads_from_posture_to_posture() {
    for seed in SEEDS {
        let (robot, start) = drawn(seed);
        let program = program(&robot, &start);
        assert!(distance(&program.moves[0].posture, &start) < 1e-4);
        let replay = program.replay(&robot, &ReplayOptions::default());
        let findings: Vec<String> = replay.findings.iter().map(ToString::to_string).collect();
        assert!(findings.is_empty(), "seed {seed}: {findings:?}");
        for step in &program.moves {
            let reached = robot.world_from_frame(&step.posture, FrameId::Tool);
            assert!(off(&reached, &step.base_from_tool) < 1e-9);
        }
    }
}

/// From knot to knot no joint moves by more than the tool's way over the Jacobian's least singular
/// value, across stops too: with joints to spare there is no way shorter than the least.
#[test]
fn verify_an_arm_of_seven_joints_is_led_across_stops_without_a_jump() {
    for seed in SEEDS {
        let (robot, start) = drawn(seed);
        let program = program(&robot, &start);
        let task = LedTask {
            robot: &robot,
            program: &program,
            joint_share: 1.0,
            interval_s: INTERVAL_S,
            longest_s: 1e4,
        };
        let led = task.solve().expect("it can be led");
        let way_m = FEED_M_PER_S * INTERVAL_S;
        for (k, pair) in led.knots.windows(2).enumerate() {
            let most = 1.1 * way_m / least_singular_value(&robot, &pair[1]) + 1e-7;
            let step = distance(&pair[0], &pair[1]);
            assert!(step < most, "seed {seed}, knot {k}: {step} {most}");
        }
        for (step, reached_s) in program.moves.iter().zip(&led.reached_s) {
            let knot = &led.knots[(reached_s / INTERVAL_S).round() as usize];
            let reached = robot.world_from_frame(knot, FrameId::Tool);
            assert!(off(&reached, &step.base_from_tool) < 1e-8, "seed {seed}");
            // What the program says is where the arm is, to how finely each looks at the lines.
            assert!(distance(knot, &step.posture) < 5e-3, "seed {seed}");
        }
        // No line is slowed for postures that are not on it.
        assert_eq!(led.slowed, None);
    }
}

/// The posture given stands at the start of the path, but a joint is beyond its limits there: with
/// the tool at rest the arm gets it within.
#[test]
fn a_straight_path_of_seven_joints_begins_within_the_limits() {
    for seed in SEEDS {
        let (mut robot, posture) = drawn(seed);
        let pose = robot.world_from_frame(&posture, FrameId::Tool);
        let limits = robot.chain.joints[2].limits.as_mut().expect("limits");
        (limits.lower, limits.upper) = (posture[2] + 0.35, posture[2] + 0.9);
        let axes = pose.rotation.to_rotation_matrix();
        let column = |k: usize| -> [f64; 3] { axes.matrix().column(k).into_owned().into() };
        let path = StraightPath {
            start: Some(PathStart {
                point_m: pose.translation.vector.into(),
                tool_axis: column(2),
                zero_direction: column(0),
                turn: vec![TurnKnot {
                    at_m: 0.0,
                    redundancy_rad: 0.0,
                }],
                shoulder: None,
                elbow: None,
                wrist: None,
            }),
            direction: [1.0, 0.0, 0.0],
            length_m: 0.02,
        };
        let solved = path.solve(&robot, &posture).expect("within the limits");
        for (k, q) in solved.knots.iter().enumerate() {
            assert!(robot.check_posture(q).is_ok(), "seed {seed}: {q:?}");
            let way_m = k as f64 * solved.spacing_m;
            let wanted = Isometry3::translation(way_m, 0.0, 0.0) * pose;
            let reached = robot.world_from_frame(q, FrameId::Tool);
            assert!(off(&reached, &wanted) < 1e-8, "seed {seed}");
        }
    }
}
