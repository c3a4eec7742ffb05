//! A wheel in precession over the sample raster, moved by an HP20.

use nalgebra::{Isometry3, Vector2, Vector3};
use truecut_arm::{ArmBranch, BranchOptions, Elbow, FrameId, Robot, Shoulder, Wrist, tool_pose};
use truecut_core::wheel::precession::{Boundary, ChordExtent, EdgeRule, PrecessionWheel};
use truecut_plan::motion::joints::joint_speeds;
use truecut_plan::precession::{
    ArmOnFace, ArmPlan, PrecessionLimits, PrecessionOptions, PrecessionPlan, PrecessionPlanError,
    PrecessionPoint, PrecessionTask,
};

use crate::assets;

const EXACT: EdgeRule = EdgeRule::Exact(ChordExtent::Clipped);

const LIMITS: PrecessionLimits = PrecessionLimits {
    rate_rad_s: 4.0,
    acceleration_rad_s2: 40.0,
    feed_acceleration_m_s2: 0.5,
};

fn wheel() -> PrecessionWheel {
    let tilt_rad = 20f64.to_radians();
    PrecessionWheel::new(20e-3, 0.6e-3, tilt_rad, 100.0).expect("good")
}

fn block() -> Boundary {
    Boundary::rectangle(0.1, 0.06).expect("closed")
}

/// Serpentine of 16 lines along x, 4 mm apart: 1660 mm.
fn raster() -> Vec<Vector2<f64>> {
    let line = |k: usize| {
        let ends = [0.0, 0.1].map(|x| Vector2::new(x, 4e-3 * k as f64));
        if k.is_multiple_of(2) {
            ends
        } else {
            [ends[1], ends[0]]
        }
    };
    (0..16).flat_map(line).collect()
}

/// What the plan does to the edges, looked at ten times in each interval: samples with an edge in
/// the patch, those of them with inward velocity, and the mean inward share of the chord.
fn inward(wheel: &PrecessionWheel, plan: &PrecessionPlan) -> (usize, usize, f64) {
    let (boundary, mut zone, mut bad, mut share) = (block(), 0, 0, 0.0);
    for pair in plan.points.windows(2) {
        for k in 0..10 {
            let at = f64::from(k) / 10.0;
            let point = pair[0].point_m.lerp(&pair[1].point_m, at);
            let angle = pair[0].angle_rad + at * (pair[1].angle_rad - pair[0].angle_rad);
            let motion = wheel.edge_motion(&boundary, &point, angle);
            zone += usize::from(motion.edges > 0);
            bad += usize::from(motion.least_outward_m_per_s < 0.0);
            share += motion.inward_share;
        }
    }
    (zone, bad, share / zone as f64)
}

fn hp20() -> Robot {
    assets::robot("hp20")
}

fn task<'a>(
    wheel: &'a PrecessionWheel,
    boundary: &'a Boundary,
    rule: EdgeRule,
    path_m: &'a [Vector2<f64>],
) -> PrecessionTask<'a> {
    PrecessionTask {
        wheel,
        boundary,
        rule,
        path_m,
        feed_m_per_s: 20e-3,
        turn_rad_s: 1.5,
        start_rad: 0.0,
    }
}

/// The sample raster, the block level in front of the arm.
/// Largest speed of each joint over its limit.
fn speed_shares(robot: &Robot, found: &ArmPlan) -> Vec<f64> {
    let mut most = vec![0.0_f64; robot.dof()];
    let pairs = found.plan.points.windows(2).zip(found.postures.windows(2));
    for (points, postures) in pairs {
        let taken_s = points[1].time_s - points[0].time_s;
        for one in joint_speeds(robot, &postures[0], &postures[1], taken_s) {
            most[one.joint] = most[one.joint].max(one.share());
        }
    }
    most
}

fn with_arm(robot: &Robot, rule: EdgeRule) -> Result<ArmPlan, PrecessionPlanError> {
    let (wheel, boundary, path) = (wheel(), block(), raster());
    let solver = robot.ik_solver(&BranchOptions::default());
    let world_from_face = Isometry3::translation(1.0, -0.03, 0.4);
    let above = Vector3::new(1.0, -0.03, 0.42);
    let upright = tool_pose(&above, &-Vector3::z_axis(), &Vector3::x(), 0.0).expect("square");
    let geometry = *solver.geometry().expect("ortho-parallel");
    let front = ArmBranch {
        shoulder: Shoulder::Front,
        elbow: Elbow::Upper,
        wrist: Wrist::Positive,
    };
    let start = (solver.within_limits(&upright, FrameId::Tool).into_iter())
        .filter(|q| geometry.branch(q) == front)
        .min_by(|a, b| a[5].abs().total_cmp(&b[5].abs()))
        .expect("within reach");
    let arm = ArmOnFace {
        robot,
        solver: &solver,
        world_from_face,
        zero_direction: Vector3::x(),
        start: &start,
    };
    let task = task(&wheel, &boundary, rule, &path);
    task.plan_for_arm(&arm, &LIMITS, &PrecessionOptions::default())
}

fn plan(wheel: &PrecessionWheel, rule: EdgeRule, limits: &PrecessionLimits) -> PrecessionPlan {
    let (boundary, path) = (block(), raster());
    let task = task(wheel, &boundary, rule, &path);
    let options = PrecessionOptions::default();
    task.plan(limits, &options).expect("a trajectory")
}

/// With the exact rule nothing moves inward anywhere, corners included, and every axis of the arm,
/// the angle's rate and its acceleration stay within their limits. Rounding alone is left to the
/// limits.
#[test]
fn verify_exact_rule_with_look_ahead_on_the_raster() {
    let robot = hp20();
    let found = with_arm(&robot, EXACT).expect("a plan");
    let plan = &found.plan;
    let (zone, bad, share) = inward(&wheel(), plan);
    println!(
        "{} points, {:.2} s instead of {:.2} s, deviation {:.1} deg rms, {:.3} rad/s, {:.2} rad/s2, joints {:.3?}",
        plan.points.len(),
        plan.duration_s(),
        plan.asked_s,
        plan.deviation_rms_rad().to_degrees(),
        fastest_rad_s(plan),
        hardest_rad_s2(plan),
        speed_shares(&robot, &found)
    );
    println!(
        "inward: {bad} of {zone}, share {share}; {:#?}",
        plan.reductions
    );
    assert!(zone > 20_000);
    assert_eq!((bad, share), (0, 0.0));
    assert!(fastest_rad_s(plan) <= LIMITS.rate_rad_s * (1.0 + 1e-9));
    assert!(hardest_rad_s2(plan) <= LIMITS.acceleration_rad_s2 * (1.0 + 1e-6));
    assert!(
        speed_shares(&robot, &found)
            .iter()
            .all(|share| *share > 0.0 && *share <= 1.0)
    );
    // The postures carry the wheel: its centre above the point, its axis leaning towards the angle.
    // Inverse kinematics are exact to 1e-10.
    assert_eq!(found.postures.len(), plan.points.len());
    for (p, q) in plan.points.iter().zip(&found.postures).step_by(50) {
        let tool = robot.world_from_frame(q, FrameId::Tool);
        let centre = Vector3::new(1.0 + p.point_m.x, -0.03 + p.point_m.y, 0.4 + 19.4e-3);
        assert!((tool.translation.vector - centre).norm() < 1e-9);
        assert!((tool * Vector3::z() + wheel().axis(p.angle_rad)).norm() < 1e-9);
    }
}

/// What the rules are worth with the same look-ahead: without one most points rub inward, the
/// source's ε = 0 leaves a third of the chord, the exact rule nothing. Whoever plans holds its own
/// rates.
#[test]
fn the_source_s_rule_leaves_inward_motion_that_the_exact_one_does_not() {
    let shares = [
        EdgeRule::None,
        EdgeRule::Paper { epsilon: 0.0 },
        EdgeRule::Paper { epsilon: 0.2 },
        EXACT,
    ]
    .map(|rule| {
        let plan = plan(&wheel(), rule, &LIMITS);
        let (_, _, share) = inward(&wheel(), &plan);
        assert!(fastest_rad_s(&plan) <= LIMITS.rate_rad_s * (1.0 + 1e-9));
        share
    });
    assert!(shares[0] > 0.5 && shares[1] < 0.7 * shares[0] && shares[2] < shares[1]);
    assert!(shares[2] > 0.1 && shares[3] == 0.0);
}

/// Without a rule the angle is the steady turn, but for the grid (half a step of an eighth of a
/// degree) and the ends, where the mean reaches beyond the path by half a window.
#[test]
fn without_a_rule_the_angle_turns_steadily() {
    let plan = plan(&wheel(), EdgeRule::None, &LIMITS);
    assert!(plan.reductions.is_empty());
    assert!((plan.duration_s() - 83.0).abs() < 1e-9);
    let inner = plan
        .points
        .iter()
        .filter(|p| p.time_s > 0.2 && p.time_s < 82.8);
    let worst = inner.map(|p| p.deviation_rad.abs()).fold(0.0, f64::max);
    assert!(worst <= 0.0625_f64.to_radians() + 1e-9, "{worst}");
    let ends = plan
        .points
        .iter()
        .map(|p| p.deviation_rad.abs())
        .fold(0.0, f64::max);
    // A quarter of the window times the turn's rate.
    assert!(ends <= 1.5 * 0.2 / 8.0 + 0.0011, "{ends}");
}

/// A patch of 0.9 of the lever leaves less in corners than a slow axis can follow at full feed: it
/// costs feed, not edges. What is lost is what the reductions say.
#[test]
fn a_slow_axis_lowers_the_feed() {
    let tilt_rad = 20f64.to_radians();
    let wheel = PrecessionWheel::new(20e-3, 1e-3, tilt_rad, 100.0).expect("good");
    let slow = PrecessionLimits {
        rate_rad_s: 1.0,
        acceleration_rad_s2: 4.0,
        feed_acceleration_m_s2: 0.5,
    };
    let (fast, slow_plan) = (plan(&wheel, EXACT, &LIMITS), plan(&wheel, EXACT, &slow));
    assert!(slow_plan.duration_s() > fast.duration_s() + 0.5);
    assert_eq!(inward(&wheel, &slow_plan).1, 0);
    assert!(fastest_rad_s(&slow_plan) <= 1.0 + 1e-9);
    assert!(hardest_rad_s2(&slow_plan) <= 4.0 * (1.0 + 1e-6));
    let lost: f64 = slow_plan.reductions.iter().map(|r| r.lost_s).sum();
    assert!((lost - (slow_plan.duration_s() - slow_plan.asked_s)).abs() < 1e-9);
    // Speeding up and slowing down: v dv/ds within the feed's acceleration.
    let feeds: Vec<(f64, f64)> = (slow_plan.points.windows(2))
        .map(|w| {
            let length = w[1].along_m - w[0].along_m;
            let middle = 0.5 * (w[0].along_m + w[1].along_m);
            (middle, length / (w[1].time_s - w[0].time_s))
        })
        .collect();
    for pair in feeds.windows(2) {
        let gained = 0.5 * (pair[1].1.powi(2) - pair[0].1.powi(2)).abs();
        assert!(gained <= 0.5 * (pair[1].0 - pair[0].0) * (1.0 + 1e-6));
    }
}

/// Joints at 0.4 of their speeds hold the angle back where they must, and none exceeds its limit.
/// The feed needs no lowering for it.
#[test]
fn slow_joints_hold_the_angle_back() {
    let mut robot = hp20();
    for joint in &mut robot.chain.joints {
        let limits = joint.limits.as_mut().expect("limited");
        limits.velocity *= 0.4;
    }
    let slow = with_arm(&robot, EXACT).expect("a plan");
    assert!(fastest_rad_s(&slow.plan) <= LIMITS.rate_rad_s * (1.0 + 1e-9));
    let shares = speed_shares(&robot, &slow);
    assert!(shares.iter().all(|share| *share <= 1.0));
    assert!(shares[3] > 0.9, "{shares:?}");
    assert_eq!(inward(&wheel(), &slow.plan).1, 0);
    assert!(slow.plan.reductions.is_empty());
}

/// A joint that the feed alone keeps at nearly half its limit leaves the angle too little for the
/// corners at full feed; one that the least feed is too much for is named.
#[test]
fn a_slow_joint_lowers_the_feed() {
    let mut robot = hp20();
    let mut limit_first = |rad_s: f64| {
        let limits = robot.chain.joints[0].limits.as_mut().expect("limited");
        limits.velocity = rad_s;
        robot.clone()
    };
    let slowed = limit_first(0.05);
    let slow = with_arm(&slowed, EXACT).expect("a plan");
    let shares = speed_shares(&slowed, &slow);
    assert!(shares.iter().all(|share| *share <= 1.0));
    assert!(shares[0] > 0.9, "{shares:?}");
    assert_eq!(inward(&wheel(), &slow.plan).1, 0);
    assert!(!slow.plan.reductions.is_empty());
    let refused = with_arm(&limit_first(1e-5), EdgeRule::None).expect_err("too slow");
    let refused = refused.to_string();
    assert!(
        refused.contains("joint \"joint_1\"") && refused.contains("0.200 mm/s"),
        "{refused}"
    );
}

#[test]
fn what_cannot_be_planned_is_refused() {
    let (wheel, path) = (wheel(), raster());
    let narrow = Boundary::rectangle(0.1, 8e-3).expect("closed");
    let boundary = block();
    let good = PrecessionTask {
        wheel: &wheel,
        boundary: &boundary,
        rule: EXACT,
        path_m: &path,
        feed_m_per_s: 20e-3,
        turn_rad_s: 1.5,
        start_rad: 0.0,
    };
    let refused = |task: PrecessionTask<'_>, limits: &PrecessionLimits, options| {
        let error = task.plan(limits, &options).expect_err("refused");
        error.to_string()
    };
    let usual = PrecessionOptions::default();
    let between = [Vector2::new(0.01, 4e-3), Vector2::new(0.05, 4e-3)];
    let narrow = PrecessionTask {
        boundary: &narrow,
        path_m: &between,
        ..good
    };
    let narrow = refused(narrow, &LIMITS, usual);
    assert!(
        narrow.contains("0.00 mm from the path's start") && narrow.contains("9.724 mm apart"),
        "{narrow}"
    );
    let still = [between[0], between[0]];
    let still = refused(
        PrecessionTask {
            path_m: &still,
            ..good
        },
        &LIMITS,
        usual,
    );
    assert!(still.contains("2 points"), "{still}");
    let no_feed = refused(
        PrecessionTask {
            feed_m_per_s: 0.0,
            ..good
        },
        &LIMITS,
        usual,
    );
    assert!(no_feed.contains("the feed (m/s) is 0"), "{no_feed}");
    let coarse = PrecessionOptions { angles: 4, ..usual };
    assert!(refused(good, &LIMITS, coarse).contains("16 to 16384"));
    let lame = PrecessionLimits {
        rate_rad_s: 0.02,
        acceleration_rad_s2: 0.01,
        ..LIMITS
    };
    let proud = PrecessionOptions {
        least_feed_share: 0.5,
        ..usual
    };
    let lame = refused(good, &lame, proud);
    assert!(lame.contains("10.000 mm/s"), "{lame}");
}

/// Middle of each interval in time, and rate of the angle in it.
fn rates(plan: &PrecessionPlan) -> Vec<(f64, f64)> {
    let rate = |w: &[PrecessionPoint]| {
        let taken = w[1].time_s - w[0].time_s;
        let middle = 0.5 * (w[0].time_s + w[1].time_s);
        (middle, (w[1].angle_rad - w[0].angle_rad) / taken)
    };
    plan.points.windows(2).map(rate).collect()
}

/// Largest rate of the angle between two points, rad/s.
fn fastest_rad_s(plan: &PrecessionPlan) -> f64 {
    let rates = rates(plan).into_iter();
    rates.map(|(_, rate)| rate.abs()).fold(0.0, f64::max)
}

/// Largest change of that rate from one interval to the next, per time between their middles,
/// rad/s².
fn hardest_rad_s2(plan: &PrecessionPlan) -> f64 {
    let rates = rates(plan);
    let changes = rates.windows(2).map(|w| {
        let ((before_s, before), (after_s, after)) = (w[0], w[1]);
        ((after - before) / (after_s - before_s)).abs()
    });
    changes.fold(0.0, f64::max)
}
