//! Paths that cannot be followed: where, and why.

use std::path::Path;

use crate::support::slot;
use nalgebra::Vector3;
use truecut_arm::{Elbow, FrameId, Robot, Shoulder};
use truecut_core::chatter::DirectionalMatrix;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_plan::motion::branch::BranchWish;
use truecut_plan::{Criterion, Cut, PlanError, Planner, PlannerOptions, ToolPath};

/// The asset as it is: spindle along axis 6, tip 0.3 m beyond the flange.
fn robot() -> Robot {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/robots/irb6600_175_255/robot.urdf");
    Robot::load(&urdf, None, None).expect("the asset loads")
}

fn cut(axial_depth_m: f64) -> Cut {
    let steel = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT);
    slot(&steel, axial_depth_m, 2400.0)
}

fn line(from: [f64; 3], to: [f64; 3]) -> ToolPath {
    let points = [from, to].map(Vector3::from);
    ToolPath::new(&points, -Vector3::z_axis(), Vector3::x()).expect("a path")
}

/// Of the arm with its shoulder in front and its elbow up.
fn refusal(path: &ToolPath) -> PlanError {
    let options = PlannerOptions {
        angle_step_rad: 0.2,
        branch: BranchWish {
            shoulder: Some(Shoulder::Front),
            elbow: Some(Elbow::Upper),
            wrist: None,
        },
        ..PlannerOptions::default()
    };
    let robot = robot();
    let refused = Planner::new(&robot, path, &cut(0.3e-3), &options).err();
    refused.expect("cannot be followed")
}

/// Tool down, the wrist centre stands 0.5 m above the tip. It comes as far as upper arm and forearm
/// reach from the shoulder, √(1.142² + 0.2²) + 1.075 m, and no joint limit is in the way there. The
/// path must leave where that sphere ends, found to 0.1 mm; the elbow singularity, 5 degrees before
/// the stretched arm, comes first.
#[test]
fn verify_the_place_where_a_path_leaves_the_reach() {
    let path = line([1.2, 0.0, 0.8], [2.6, 0.0, 0.8]);
    let PlanError::Singular { kind, along_m, .. } = refusal(&path) else {
        panic!("{}", refusal(&path));
    };
    assert_eq!(kind, "elbow");
    let forearm = 1.142_f64.hypot(0.2);
    // 5 degrees before it is stretched, the law of cosines gives the distance from shoulder to
    // wrist.
    let bent =
        1.075_f64.powi(2) + forearm.powi(2) + 2.0 * 1.075 * forearm * 5_f64.to_radians().cos();
    let height: f64 = 0.8 + 0.5 - 0.780;
    let expected = 0.320 + (bent - height * height).sqrt() - 1.2;
    assert!(
        (along_m - expected).abs() < 2e-4,
        "{along_m} instead of {expected}"
    );

    // Further than stretched from the start: out of reach at once.
    let beyond = refusal(&line([2.8, 0.0, 0.8], [2.9, 0.0, 0.8]));
    let PlanError::OutOfReach { along_m, .. } = beyond else {
        panic!("{beyond}");
    };
    assert_eq!(along_m, 0.0);
    assert!(
        beyond
            .to_string()
            .contains("leaves the arm's reach 0.0 mm from its start")
    );
}

/// Under the elbow, forearm straight down, axes 4 and 6 are in line. A path that crosses that place
/// is refused from 5 degrees on this side of it, the angle by which the forearm leans.
#[test]
fn verify_the_place_of_a_wrist_singularity() {
    let robot = robot();
    let q = [0.0, 50_f64.to_radians(), 40_f64.to_radians(), 0.0, 0.0, 0.0];
    let tip = robot.world_from_frame(&q, FrameId::Tool).translation.vector;
    let path = line([tip.x - 0.15, 0.0, tip.z], [tip.x + 0.15, 0.0, tip.z]);
    let error = refusal(&path);
    let PlanError::Singular {
        kind,
        along_m,
        distance,
        ..
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!(*kind, "wrist");
    // Where it begins, the distance asked for is just missed.
    assert!(
        distance.starts_with("4.99") || distance.starts_with("5.00"),
        "{distance}"
    );
    assert!(*along_m > 0.01 && *along_m < 0.15, "{along_m}");
    let text = error.to_string();
    assert!(
        text.contains("wrist singularity") && text.contains("at least 5.00 deg"),
        "{text}"
    );
}

/// Behind its back the arm would need more of joint 1 than it has.
#[test]
fn joint_limits_are_named() {
    let mut robot = robot();
    let limits = robot.chain.joints[0]
        .limits
        .as_mut()
        .expect("the asset has limits");
    (limits.lower, limits.upper) = (-0.5, 0.5);
    let path = line([1.5, 0.3, 0.8], [1.5, 1.2, 0.8]);
    let options = PlannerOptions {
        angle_step_rad: 0.2,
        ..PlannerOptions::default()
    };
    let refused = Planner::new(&robot, &path, &cut(0.3e-3), &options).err();
    let Some(PlanError::OutsideLimits { along_m, joint, .. }) = refused else {
        panic!("{refused:?}");
    };
    // The wrist centre is above the tip: joint 1 points at it, tan 0.5 = y/1.5.
    let expected = 1.5 * 0.5_f64.tan() - 0.3;
    assert!(
        (along_m - expected).abs() < 2e-4,
        "{along_m} instead of {expected}"
    );
    assert_eq!(joint, robot.chain.joints[0].name);
}

/// A cut too deep for every posture: the least bad angle and what it lacks.
#[test]
fn no_stable_angle_says_what_is_missing() {
    let robot = robot();
    let path = line([1.2, 0.0, 0.9], [1.3, 0.0, 0.9]);
    let (deep, options) = (cut(20e-3), PlannerOptions::default());
    let planner = Planner::new(&robot, &path, &deep, &options).expect("in reach");
    let error = planner.plan(Criterion::ModeCoupling).expect_err("too deep");
    let PlanError::NoStableAngle {
        assessment, needed, ..
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!(*needed, 20e-3);
    assert!((assessment.margin - (assessment.value / 20e-3 - 1.0)).abs() < 1e-12);
    let short = format!("{:.1} % short", -100.0 * assessment.margin);
    assert!(error.to_string().contains(&short), "{error}");
    // The rule that knows no depth does not mind.
    assert!(planner.plan(Criterion::Anisotropy).is_ok());
}

#[test]
fn other_arms_are_refused() {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/ur10e/robot.urdf");
    let robot = Robot::load(&urdf, None, None).expect("the asset loads");
    let path = line([0.5, 0.2, 0.3], [0.6, 0.2, 0.3]);
    let refused = Planner::new(&robot, &path, &cut(0.3e-3), &PlannerOptions::default()).err();
    assert!(
        matches!(refused, Some(PlanError::NotOrthoParallel)),
        "{refused:?}"
    );
}

/// A coordinate that no workpiece has is told with its bound; just within it, it is read.
#[test]
fn a_part_beyond_all_reach_is_refused_with_its_bound() {
    use truecut_arm::MeshData;
    use truecut_plan::surface::part::{Part, PartOptions};
    let options = PartOptions {
        unit_m: 1e-3,
        crease_rad: 0.5,
        weld_m: None,
    };
    let triangle_at = |far_m: f64| {
        let corner = |x: f64, y: f64| Vector3::new(far_m + x, y, 0.0) * 1e3;
        let data = MeshData {
            vertices: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)],
            triangles: vec![[0, 1, 2]],
            against_stated_normal: Vec::new(),
        };
        Part::of(data, &options, &|_| {})
    };
    assert!(triangle_at(9.9e4).is_ok());
    assert!(triangle_at(-9.9e4).is_ok());
    for far_m in [1.01e5, -1.01e5, 1e32] {
        let error = triangle_at(far_m).expect_err("far").to_string();
        assert!(error.contains("a coordinate (m)"), "{error}");
        assert!(error.contains("at most 1e5"), "{error}");
    }
}
