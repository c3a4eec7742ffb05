//! Branches by shortest travel, and what is reported of a path that the arm cannot follow.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{BranchOptions, FrameId, Robot};
use truecut_plan::SingularityLimits;
use truecut_plan::program::{
    FindingKind, Motion, PathPoint, Program, ProgramError, ProgramErrorKind, Tool, TravelOptions,
    shortest_travel,
};

use crate::assets;

fn robot() -> Robot {
    assets::robot("irb6600_175_255")
}

fn point(x: f64, y: f64, z: f64, rotation: UnitQuaternion<f64>) -> PathPoint {
    PathPoint {
        base_from_tool: Isometry3::from_parts(Translation3::new(x, y, z), rotation),
        motion: Motion::Linear {
            speed_m_per_s: 0.05,
        },
        turntable_rad: None,
    }
}

fn down() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(PI, 0.0, 0.0)
}

fn travel(points: &[PathPoint], options: &TravelOptions) -> Result<Vec<Vec<f64>>, ProgramError> {
    let robot = robot();
    let tool = robot.frames.flange_from_tool;
    shortest_travel(&robot, &tool, &Isometry3::identity(), points, None, options)
}

fn length(path: &[Vec<f64>]) -> f64 {
    let legs = path.windows(2).map(|pair| {
        let squares = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).powi(2));
        squares.sum::<f64>().sqrt()
    });
    legs.sum()
}

/// All sequences of postures are tried from the start nearest to the middle of the ranges; joint
/// moves, so that none is forbidden.
#[test]
fn verify_travel_is_the_shortest_of_all_sequences() {
    let mut points = vec![
        point(1.4, 0.6, 1.0, down()),
        point(
            1.2,
            -0.9,
            1.1,
            UnitQuaternion::from_euler_angles(2.6, 0.3, 2.8),
        ),
        point(
            0.9,
            1.2,
            0.9,
            UnitQuaternion::from_euler_angles(-2.6, 0.4, -2.9),
        ),
    ];
    for point in &mut points {
        point.motion = Motion::Joint { share: 0.5 };
    }
    let robot = robot();
    let options = TravelOptions::default();
    let found = travel(&points, &options).unwrap();
    let solver = robot.ik_solver(&BranchOptions::default());
    let geometry = solver.geometry().unwrap();
    let limits = SingularityLimits::default();
    let all: Vec<Vec<Vec<f64>>> = points
        .iter()
        .map(|point| {
            let mut all = solver.within_limits(&point.base_from_tool, FrameId::Tool);
            all.retain(|q| {
                let distance = geometry.singularity_distance(q);
                distance.wrist_rad >= limits.wrist_rad
                    && distance.elbow_rad >= limits.elbow_rad
                    && distance.shoulder_m >= limits.shoulder_m
            });
            all
        })
        .collect();
    assert!(all.iter().all(|postures| postures.len() >= 4));
    let middle = |q: &Vec<f64>| {
        let joints = robot.chain.joints.iter().zip(q);
        let each = joints.map(|(joint, q)| {
            let limits = joint.limits.unwrap();
            let (middle, half) = (limits.lower + limits.upper, limits.upper - limits.lower);
            ((2.0 * q - middle) / half).powi(2)
        });
        each.sum::<f64>()
    };
    let starts = all[0].iter();
    let rest = starts
        .min_by(|a, b| middle(a).total_cmp(&middle(b)))
        .unwrap();
    assert_eq!(&found[0], rest);
    let mut best = f64::INFINITY;
    for b in &all[1] {
        for c in &all[2] {
            best = best.min(length(&[rest.clone(), b.clone(), c.clone()]));
        }
    }
    assert!(
        (length(&found) - best).abs() < 1e-9,
        "{} {best}",
        length(&found)
    );
}

/// Joint 6 winds up along the path: the start that is nearest to zero would run into its limit, and
/// the one chosen does not.
#[test]
fn the_start_leaves_room_for_the_turn_to_come() {
    let points: Vec<PathPoint> = (0..60)
        .map(|i| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.1 * f64::from(i));
            point(
                1.5,
                0.0,
                0.9,
                turn * UnitQuaternion::from_euler_angles(PI, 0.35, 0.0),
            )
        })
        .collect();
    let path = travel(&points, &TravelOptions::default()).unwrap();
    let robot = robot();
    for (i, q) in path.iter().enumerate() {
        robot.check_posture(q).unwrap();
        let tool = robot.world_from_frame(q, FrameId::Tool);
        let wanted = points[i].base_from_tool;
        assert!((tool.translation.vector - wanted.translation.vector).norm() < 1e-8);
        assert!(tool.rotation.angle_to(&wanted.rotation) < 1e-8);
    }
    let widest = path
        .windows(2)
        .flat_map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).abs()))
        .fold(0.0, f64::max);
    assert!(widest < 0.5, "{widest}");
    let wound = path[59][5] - path[0][5];
    assert!(wound.abs() > 4.0, "{wound}");
}

#[test]
fn what_stops_a_path_is_named_with_point_and_joint() {
    let options = TravelOptions::default();
    let near = point(1.5, 0.0, 0.9, down());
    let far = travel(&[near, point(4.0, 0.0, 0.9, down())], &options).unwrap_err();
    assert!(
        matches!(
            far.kind(),
            ProgramErrorKind::OutOfReach { path_point: 1, .. }
        ),
        "{far}"
    );

    // The tool pointing back at the base from the front: the wrist would have to bend beyond its
    // 120°.
    let back = point(
        1.6,
        0.0,
        1.6,
        UnitQuaternion::from_euler_angles(0.0, -PI / 2.0, 0.0),
    );
    let limits = travel(&[near, near, back], &options).unwrap_err();
    let ProgramErrorKind::OutsideLimits {
        path_point: 2,
        joint,
        excess_deg,
    } = limits.kind()
    else {
        panic!("{limits}");
    };
    assert!(joint.starts_with("joint_") && *excess_deg > 0.1, "{limits}");

    // Axis 6 along axis 4.
    let robot = robot();
    let straight = robot.world_from_frame(&[0.2, 0.8, 0.1, 0.0, 0.01, 0.0], FrameId::Tool);
    let mut singular = near;
    singular.base_from_tool = straight;
    let strict = TravelOptions {
        singularity: SingularityLimits {
            shoulder_m: 10.0,
            ..SingularityLimits::default()
        },
        ..options
    };
    let error = travel(&[near, singular], &strict).unwrap_err();
    assert!(
        matches!(error.kind(), ProgramErrorKind::Singular { path_point: 0, kind: "shoulder", joint, .. } if joint == "joint_1"),
        "{error}"
    );
    let error = travel(&[singular], &options).unwrap_err();
    assert!(
        matches!(error.kind(), ProgramErrorKind::Singular { path_point: 0, kind: "wrist", joint, .. } if joint == "joint_5"),
        "{error}"
    );

    // Half a turn of the tool about its axis from one point to the next.
    let half = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 3.0);
    let tilted = UnitQuaternion::from_euler_angles(PI, 0.35, 0.0);
    let two = [
        point(1.5, 0.0, 0.9, tilted),
        point(1.5, 0.0, 0.9, half * tilted),
    ];
    let error = travel(&two, &options).unwrap_err();
    let ProgramErrorKind::Jump {
        path_point: 1,
        joint,
        jump_deg,
        largest_deg,
        turn_deg,
    } = error.kind()
    else {
        panic!("{error}");
    };
    assert!(
        *jump_deg > *largest_deg && joint.starts_with("joint_"),
        "{error}"
    );
    assert!((turn_deg - 3.0_f64.to_degrees()).abs() < 1e-9, "{error}");
    // A joint move may.
    let mut allowed = two;
    allowed[1].motion = Motion::Joint { share: 1.0 };
    assert_eq!(travel(&allowed, &options).unwrap().len(), 2);
}

#[test]
fn inspection_reports_speed_limits_and_singularities() {
    let robot = robot();
    let tilt = |angle: f64| UnitQuaternion::from_euler_angles(PI, angle, 0.0);
    // 1 mm with 0.1 rad of tilt at 50 mm/s: 0.02 s, so that some joint turns at 5 rad/s.
    let points = [
        point(1.5, 0.0, 0.9, tilt(0.3)),
        point(1.501, 0.0, 0.9, tilt(0.4)),
        point(1.502, 0.0, 0.9, tilt(0.4)),
    ];
    let tool = Tool::of(&robot, "wheel", 1);
    let options = TravelOptions::default();
    let base = Isometry3::identity();
    let mut program = Program::along(&robot, "FAST", tool, base, &points, &options).unwrap();
    let limits = SingularityLimits::default();
    let findings = program.inspect(&robot, &limits);
    assert!(!findings.is_empty());
    for finding in &findings {
        assert_eq!(finding.path_point, 1, "{finding}");
        let FindingKind::TooFast {
            speed_rad_per_s,
            limit_rad_per_s,
        } = finding.kind
        else {
            panic!("{finding}");
        };
        let joint = robot
            .chain
            .joints
            .iter()
            .position(|j| j.name == finding.joint)
            .unwrap();
        let step = program.moves[1].posture[joint] - program.moves[0].posture[joint];
        assert!((speed_rad_per_s - step.abs() / 0.02).abs() < 1e-6 * speed_rad_per_s);
        assert!(speed_rad_per_s > limit_rad_per_s);
    }
    // A tenth of the speed is within every limit.
    for step in &mut program.moves {
        step.motion = Motion::Linear {
            speed_m_per_s: 0.005,
        };
    }
    assert_eq!(program.inspect(&robot, &limits), []);

    program.moves[2].posture[4] = 0.02;
    program.moves[2].posture[1] = 2.0;
    program.moves[2].motion = Motion::Joint { share: 1.0 };
    let texts: Vec<String> = program
        .inspect(&robot, &limits)
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(
        texts[0].contains("path point 2: joint \"joint_2\" stands 34.592 deg beyond"),
        "{texts:?}"
    );
    assert!(
        texts[1].contains("joint \"joint_5\" is 1.15 deg from the singularity of the wrist"),
        "{texts:?}"
    );
}
