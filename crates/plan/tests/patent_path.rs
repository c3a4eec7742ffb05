//! The planner on the published path: 0.3 m from P1 = (1.050, −1.450, 0.870) m to P2 = (1.350,
//! −1.450, 0.870) m, tool down, slot in 45 steel with four teeth, 0.3 mm deep.

use crate::milling_arm::robot;
use crate::support::slot;
use nalgebra::{Isometry3, Vector3};
use truecut_arm::{BranchOptions, Elbow, FrameId, Robot, Shoulder};
use truecut_core::chatter::DirectionalMatrix;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_plan::motion::branch::BranchWish;
use truecut_plan::motion::straight::{PathStart, StraightPath, TurnKnot};
use truecut_plan::{
    Criterion, Cut, Family, LEAST_DECAY, Plan, PlanError, Planner, PlannerOptions, ToolPath, assess,
};

const P1_M: [f64; 3] = [1.050, -1.450, 0.870];
const P2_M: [f64; 3] = [1.350, -1.450, 0.870];

fn path(points: &[[f64; 3]]) -> ToolPath {
    let points: Vec<_> = points.iter().map(|p| Vector3::from(*p)).collect();
    ToolPath::new(&points, -Vector3::z_axis(), Vector3::x()).expect("a path")
}

fn steel(axial_depth_m: f64, rpm: f64) -> Cut {
    let steel = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT);
    slot(&steel, axial_depth_m, rpm)
}

const FAMILY: Family = Family {
    shoulder: Shoulder::Front,
    elbow: Elbow::Upper,
};
const FRONT_UPPER: BranchWish = BranchWish {
    shoulder: Some(FAMILY.shoulder),
    elbow: Some(FAMILY.elbow),
    wrist: None,
};

fn front_upper() -> PlannerOptions {
    PlannerOptions {
        branch: FRONT_UPPER,
        ..PlannerOptions::default()
    }
}

fn station_count(planner: &Planner<'_>) -> usize {
    planner.reach().columns.len()
}

/// Margins of mode coupling at a station by angle, degrees.
fn margins(planner: &Planner<'_>, station: usize) -> Vec<(i32, f64)> {
    let map = planner
        .map(Criterion::ModeCoupling, FAMILY, station_count(planner))
        .expect("modes");
    let row = map.angles_rad.iter().zip(&map.assessments[station]);
    let found = row.filter_map(|(angle, found)| Some((angle, found.as_ref()?.margin)));
    found
        .map(|(angle, margin)| (angle.to_degrees().round() as i32, margin))
        .collect()
}

/// Stable redundancy angles in steel at both ends, in ten-degree steps
/// (`docs/physics/stability.md`, An arm), and nothing else within reach. There every mode has ζ =
/// 0.02, here the arm has its own damping (0.018 to 0.03 in the modes that matter); where that
/// changes the sign, the limit must be within 2 % of the depth.
#[test]
fn verify_stable_angles_at_both_ends() {
    let (robot, path, cut) = (robot(), path(&[P1_M, P2_M]), steel(0.3e-3, 2400.0));
    let options = PlannerOptions {
        angle_step_rad: 10_f64.to_radians(),
        ..front_upper()
    };
    let planner = Planner::new(&robot, &path, &cut, &options).expect("in reach");
    let last = planner.reach().columns.len() - 1;
    for (station, first, stable) in [
        (0, 10, [10..=60, 190..=240]),
        (last, 20, [20..=70, 200..=240]),
    ] {
        let found = margins(&planner, station);
        let angles: Vec<i32> = found.iter().map(|(angle, _)| *angle).collect();
        assert_eq!(angles, (first..=240).step_by(10).collect::<Vec<_>>());
        for (angle, margin) in found {
            let printed = stable.iter().any(|range| range.contains(&angle));
            let agrees = (margin >= 0.0) == printed;
            assert!(agrees || margin.abs() < 0.02, "{angle} deg: {margin}");
        }
    }
}

fn assert_follows(robot: &Robot, path: &ToolPath, plan: &Plan) {
    for point in &plan.points {
        let asked = path.pose(point.along_m, point.angle_rad).expect("square");
        let found = robot.world_from_frame(&point.posture, FrameId::Tool);
        let apart = found.translation.vector - asked.translation.vector;
        assert!(apart.norm() < 1e-9 && found.rotation.angle_to(&asked.rotation) < 1e-9);
        robot.check_posture(&point.posture).expect("within limits");
    }
    let step = plan.largest_step_rad();
    assert!(step < 0.2, "{step}");
}

/// The plan by mode coupling: stable everywhere, mid-interval at each midpoint, ends of intervals
/// no further apart than asked, on the path, without jumps. A constant 120 degrees is unstable
/// everywhere by the same criterion, and stable by the published rule.
#[test]
fn a_plan_is_stable_continuous_and_in_the_middle() {
    let (robot, path, cut) = (robot(), path(&[P1_M, P2_M]), steel(0.3e-3, 2400.0));
    let planner = Planner::new(&robot, &path, &cut, &front_upper()).expect("in reach");
    let plan = planner.plan(Criterion::ModeCoupling).expect("a plan");
    assert_follows(&robot, &path, &plan);
    assert!(plan.weakest().assessment.is_stable());
    let frame = path.world_from_milling(0);
    for segment in &plan.segments {
        let at = segment.midpoint_m();
        let point = plan.points.iter().find(|p| (p.along_m - at).abs() < 1e-9);
        let point = point.expect("midpoints are stations");
        assert!((point.angle_rad - segment.interval.middle_rad()).abs() < 1e-12);
        let ends = [segment.interval.from_rad, segment.interval.to_rad];
        for (end, outwards) in ends.into_iter().zip([-1.0, 1.0]) {
            let stable_at = |angle: f64| {
                let pose = path.pose(at, angle).expect("square");
                let solver = robot.ik_solver(&BranchOptions::default());
                let q = solver.nearest(&pose, FrameId::Tool, &point.posture).ok()?;
                let found = assess(
                    Criterion::ModeCoupling,
                    &robot,
                    &q,
                    &frame,
                    &cut,
                    LEAST_DECAY,
                );
                Some(found.expect("modes").is_stable())
            };
            assert_eq!(stable_at(end - outwards * 1e-3), Some(true));
            assert_ne!(stable_at(end + outwards * 2e-3), Some(true));
        }
    }
    for pair in plan.segments.windows(2) {
        let [a, b] = [pair[0].interval, pair[1].interval];
        assert!((a.from_rad - b.from_rad).abs() < 10_f64.to_radians());
        assert!((a.to_rad - b.to_rad).abs() < 10_f64.to_radians());
    }

    let constant = StraightPath {
        start: Some(PathStart {
            point_m: P1_M,
            tool_axis: [0.0, 0.0, -1.0],
            zero_direction: [1.0, 0.0, 0.0],
            turn: vec![TurnKnot {
                at_m: 0.0,
                redundancy_rad: 120_f64.to_radians(),
            }],
            shoulder: Some(Shoulder::Front),
            elbow: Some(Elbow::Upper),
            wrist: None,
        }),
        direction: [1.0, 0.0, 0.0],
        length_m: 0.3,
    };
    let solved = constant.solve(&robot, &[0.0; 6]).expect("in reach");
    let constant = |criterion| {
        let posture = |at_m| solved.posture(at_m);
        planner.at_postures(criterion, &|_| 120_f64.to_radians(), &posture)
    };
    let chatters = constant(Criterion::ModeCoupling).expect("in reach");
    assert_follows(&robot, &path, &chatters);
    assert!(chatters.points.iter().all(|p| p.assessment.margin < -0.4));
    let rule = constant(Criterion::Anisotropy).expect("in reach");
    assert!(rule.points.iter().all(|p| p.assessment.margin > 6.0));
}

/// With regeneration the same path can be planned at 600 rpm and at 2400 rpm, where nothing
/// chatters; at 300 rpm nothing is stable, and the error says by how much the best angle fails.
#[test]
fn regeneration_decides_by_the_spindle_speed() {
    let (robot, path) = (robot(), path(&[P1_M, P2_M]));
    let plan = |rpm: f64| {
        let cut = steel(0.3e-3, rpm);
        let planner = Planner::new(&robot, &path, &cut, &coarse()).expect("in reach");
        planner.plan(Criterion::Regenerative)
    };
    let slow = plan(600.0).expect("a plan");
    assert_follows(&robot, &path, &slow);
    assert!(slow.weakest().assessment.is_stable());
    let width = |plan: &Plan| plan.segments[0].interval.width_rad().to_degrees();
    let fast = plan(2400.0).expect("a plan");
    assert!(
        width(&slow) < 100.0 && width(&fast) > 200.0,
        "{} {}",
        width(&slow),
        width(&fast)
    );
    let error = plan(300.0).expect_err("nothing is stable");
    let PlanError::NoStableAngle {
        angle_deg,
        assessment,
        along_m,
        ..
    } = &error
    else {
        panic!("{error}");
    };
    assert!((-0.2..0.0).contains(&assessment.margin) && path.length_m() > *along_m);
    let text = error.to_string();
    let told = format!(
        "the least bad, {angle_deg:.1} deg, is stable to {:.4} mm",
        assessment.value * 1e3
    );
    assert!(
        text.contains(&told) && text.contains("0.3000 mm are asked"),
        "{text}"
    );
}

/// At 720 rpm the floor lets the two intervals of angles that decay well grow together halfway: the
/// middle of what is taken follows step by step, the arm does not jump, and no angle is taken that
/// decays less than half as fast as the best.
#[test]
fn a_plan_does_not_jump_where_intervals_grow_together() {
    let (robot, path, cut) = (robot(), path(&[P1_M, P2_M]), steel(0.3e-3, 720.0));
    let planner = Planner::new(&robot, &path, &cut, &front_upper()).expect("in reach");
    let plan = planner.plan(Criterion::Regenerative).expect("a plan");
    assert_follows(&robot, &path, &plan);
    let widths: Vec<f64> = plan
        .segments
        .iter()
        .map(|s| s.interval.width_rad())
        .collect();
    assert!(
        widths[0] < 1.8 && widths[widths.len() - 1] > 2.6,
        "{widths:?}"
    );
    for pair in plan.segments.windows(2) {
        let [a, b] = [pair[0].interval, pair[1].interval];
        for shift in [a.from_rad - b.from_rad, a.to_rad - b.to_rad] {
            assert!(shift.abs() < 10.001_f64.to_radians(), "{shift}");
        }
    }
    let map = planner
        .map(Criterion::Regenerative, FAMILY, station_count(&planner))
        .expect("modes");
    for segment in &plan.segments {
        let station = planner.reach().nearest_column(segment.midpoint_m());
        let point = &plan.points[station];
        let all = map.assessments[station].iter().flatten();
        let best = all.filter_map(|a| a.decay_per_s()).fold(0.0, f64::max);
        let found = point.assessment.decay_per_s().expect("a decay");
        assert!(
            point.assessment.is_stable() && found >= 0.5 * best,
            "{found} {best}"
        );
    }
}

/// Wide steps, for criteria that take their time.
fn coarse() -> PlannerOptions {
    PlannerOptions {
        angle_step_rad: 12_f64.to_radians(),
        segment_m: 0.1,
        halvings: 1,
        ..front_upper()
    }
}

/// A corner: the arm stays on one branch, the feed turns, and both directions are stable at the
/// corner.
#[test]
fn a_path_with_a_corner_is_planned_as_a_whole() {
    let points = [P1_M, [1.2, -1.45, 0.87], [1.2, -1.30, 0.87]];
    let (robot, path) = (robot(), path(&points));
    let half = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::down(0.5, 1.0).expect("half"));
    let mut cut = steel(0.3e-3, 2400.0);
    cut.nominal.engagement = half.engagement;
    let planner = Planner::new(&robot, &path, &cut, &front_upper()).expect("in reach");
    let plan = planner.plan(Criterion::ModeCoupling).expect("a plan");
    assert_follows(&robot, &path, &plan);
    let corner = plan
        .points
        .iter()
        .find(|p| (p.along_m - 0.15).abs() < 1e-9)
        .expect("a station");
    let on_leg = |leg: usize| {
        let frame = path.world_from_milling(leg);
        assess(
            Criterion::ModeCoupling,
            &robot,
            &corner.posture,
            &frame,
            &cut,
            LEAST_DECAY,
        )
        .expect("modes")
    };
    let worse = on_leg(0).margin.min(on_leg(1).margin);
    assert!(
        (on_leg(0).margin - on_leg(1).margin).abs() > 0.01,
        "feed directions differ"
    );
    assert!(worse > 0.0 && (corner.assessment.margin - worse).abs() < 1e-12);
}

/// A spindle along axis 6: the redundancy angle turns joint 6 and nothing else, every criterion is
/// blind to it (`docs/physics/stability.md`, An arm).
#[test]
fn verify_a_spindle_along_axis_6_makes_the_angle_irrelevant() {
    let mut robot = robot();
    robot.frames.flange_from_tool = Isometry3::translation(0.0, 0.0, 0.3);
    let (path, cut) = (path(&[P1_M, [1.10, -1.45, 0.87]]), steel(0.3e-3, 2400.0));
    let planner = Planner::new(&robot, &path, &cut, &coarse()).expect("in reach");
    for criterion in [
        Criterion::Anisotropy,
        Criterion::Flutter,
        Criterion::ModeCoupling,
    ] {
        let map = planner.map(criterion, FAMILY, 5).expect("modes");
        for row in &map.assessments {
            let values: Vec<f64> = row.iter().flatten().map(|a| a.value).collect();
            assert_eq!(
                values.len(),
                map.angles_rad.len(),
                "joint 6 turns all the way"
            );
            let same = values.iter().all(|v| (v / values[0] - 1.0).abs() < 1e-6);
            assert!(same, "{criterion}: {values:?}");
        }
    }
}
