//! The posture study of a milling arm against independently computed numbers: planar and 6-DoF
//! mode-coupling limits over the redundancy angle, and the regenerative limits that contradict
//! them. Numbers: `docs/physics/stability.md`, An arm, computed anew by
//! `tests/reference/postures.py`.
//!
//! The spindle stands across the flange (tool z = flange x, tool y = flange y, tip at (0.25, 0,
//! 0.18) m in the flange), the tool points down at P1 = (1.050, −1.450, 0.870) m or P2 = (1.350,
//! −1.450, 0.870) m, its x axis at the redundancy angle θr. Front shoulder, upper elbow, one wrist
//! by continuity. Inertia is the reference model's, not the asset's 0.82 of it; ζ = 0.02 in every
//! mode; no gravity.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use crate::milling_arm::robot;
use nalgebra::{Isometry3, Matrix2, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, IkOptions, Load, Robot, planar_principal, translational};
use truecut_core::chatter::averaged::{
    mode_coupling_limit, rightmost_per_s, zero_order_limit, zero_order_limit_within,
};
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::planar::coalescence_limit_m;
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{DirectionalMatrix, TipMode};
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::nominal::NominalCut;

const P1_M: [f64; 3] = [1.050, -1.450, 0.870];
const P2_M: [f64; 3] = [1.350, -1.450, 0.870];
/// Joint angles at P1, θr = 20°, degrees.
const START_DEG: [f64; 6] = [-43.1717, 33.4476, 5.1977, -72.4716, 110.6398, 131.8613];

/// A matrix B of a cut whose feed stands at an angle (rad) from the x axis.
fn turned_pa(matrix_pa: &Matrix3<f64>, feed_rad: f64) -> Matrix3<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), feed_rad).into_inner();
    turn * matrix_pa * turn.transpose()
}

fn pose(point_m: [f64; 3], axes: &Matrix3<f64>) -> Isometry3<f64> {
    let rotation = Rotation3::from_matrix_unchecked(*axes);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    Isometry3::from_parts(
        Translation3::new(point_m[0], point_m[1], point_m[2]),
        rotation,
    )
}

/// Tool down at a point with redundancy angle θr.
fn target(point_m: [f64; 3], angle_deg: f64) -> Isometry3<f64> {
    let (s, c) = angle_deg.to_radians().sin_cos();
    let axes = Matrix3::new(c, s, 0.0, s, -c, 0.0, 0.0, 0.0, -1.0);
    pose(point_m, &axes)
}

/// Postures at a point for θr = 10°, 20°, … 240°, by continuity from θr = 20° at P1. Position
/// limits are set aside: they bind one of the two wrists only, and both give the same mechanics.
fn postures(robot: &Robot, point_m: [f64; 3]) -> BTreeMap<i32, Vec<f64>> {
    let mut free = robot.clone();
    free.chain.joints.iter_mut().for_each(|j| j.limits = None);
    let follow = |seed: &[f64], point_m, angle_deg: f64| {
        let goal = target(point_m, angle_deg);
        free.inverse_kinematics(&goal, FrameId::Tool, seed, &IkOptions::default())
            .unwrap_or_else(|e| panic!("{angle_deg} deg: {e}"))
    };
    let mut start = START_DEG.map(f64::to_radians).to_vec();
    for i in 0..=20 {
        let share = f64::from(i) / 20.0;
        let between = std::array::from_fn(|k| P1_M[k] + (point_m[k] - P1_M[k]) * share);
        start = follow(&start, between, 20.0);
    }
    let mut found = BTreeMap::new();
    let mut q = start.clone();
    for angle in (20..=240).step_by(2) {
        q = follow(&q, point_m, f64::from(angle));
        found.insert(angle, q.clone());
    }
    if point_m == P1_M {
        found.insert(10, follow(&start, point_m, 10.0));
    }
    found.retain(|angle, _| angle % 10 == 0);
    found
}

/// Modes at the tool with ζ = 0.02, world axes.
fn modes(robot: &Robot, q: &[f64]) -> Vec<TipMode> {
    let mut modes = robot
        .tip_modes(q, FrameId::Tool, None)
        .expect("stiffness given");
    modes.iter_mut().for_each(|m| m.damping_ratio = 0.02);
    modes
}

fn half_slot() -> Engagement {
    Engagement {
        entry_rad: FRAC_PI_2,
        exit_rad: std::f64::consts::PI,
    }
}

fn aluminium(engagement: Engagement) -> DirectionalMatrix {
    DirectionalMatrix::planar(2, 767e6, 0.22, engagement)
}

fn steel(engagement: Engagement) -> DirectionalMatrix {
    DirectionalMatrix::planar(4, 2e9, 0.3, engagement)
}

fn assert_close(what: &str, value: f64, expected: f64, relative: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(
        error <= relative,
        "{what}: {value} instead of {expected}, {error:.2e} off (allowed {relative:.0e})"
    );
}

/// The two postures for which joint angles are printed, to their digits.
#[test]
fn verify_printed_postures() {
    let found = postures(&robot(), P1_M);
    let printed = [
        (20, START_DEG),
        (
            120,
            [-52.5034, 9.8275, 38.4479, -170.0007, 48.7107, 173.3639],
        ),
    ];
    for (angle, expected_deg) in printed {
        for (q, expected) in found[&angle].iter().zip(expected_deg) {
            let off = (q.to_degrees() - expected + 180.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < 1e-4, "{angle}: {q} instead of {expected} deg");
        }
    }
}

/// One row of the map: θr, k_min and k_max (N/µm), f1 and f2 (Hz), planar limit (mm), 6-DoF limit
/// (mm) and its frequency (Hz), half-slot limits with feed along X and Y (mm).
type Row = (i32, [f64; 2], [f64; 2], f64, [f64; 2], [f64; 2]);

const MAP: [Row; 5] = [
    (
        20,
        [0.615, 1.535],
        [6.50, 9.74],
        1.20,
        [2.27, 9.4],
        [8.68, 3.81],
    ),
    (
        60,
        [0.571, 1.963],
        [7.14, 9.95],
        1.82,
        [1.66, 9.4],
        [6.50, 2.79],
    ),
    (
        120,
        [0.596, 2.217],
        [7.87, 9.61],
        2.11,
        [0.77, 9.0],
        [3.03, 1.31],
    ),
    (
        160,
        [0.553, 2.588],
        [7.61, 9.84],
        2.65,
        [1.14, 9.1],
        [4.39, 1.98],
    ),
    (
        220,
        [0.615, 1.529],
        [6.68, 9.83],
        1.19,
        [2.06, 9.4],
        [7.98, 3.66],
    ),
];

/// Planar and 6-DoF limits at P1 for aluminium with two teeth, slot and half slot. Tolerance 2 %;
/// frequencies, printed to two digits, half a unit of the last.
#[test]
fn verify_posture_map() {
    let robot = robot();
    let found = postures(&robot, P1_M);
    for (angle, [k_min, k_max], f, planar_mm, [limit_mm, chatter_hz], half_mm) in MAP {
        let q = &found[&angle];
        let what = |name: &str| format!("{angle} deg, {name}");
        let compliance = robot
            .cartesian_compliance(q, FrameId::Tool, &Load::none())
            .expect("stiffness given");
        let c_tt = translational(&compliance);
        let plane = planar_principal(&c_tt, &Vector3::x_axis(), &Vector3::y_axis());
        assert_close(&what("k_min"), plane.k_min_n_per_m, k_min * 1e6, 2e-3);
        assert_close(&what("k_max"), plane.k_max_n_per_m, k_max * 1e6, 2e-3);

        let modes = modes(&robot, q);
        for (mode, expected_hz) in modes.iter().zip(f) {
            let hz = mode.natural_frequency_rad_s / std::f64::consts::TAU;
            assert!((hz - expected_hz).abs() <= 5.1e-3, "{}: {hz}", what("f"));
        }

        // Undamped slot: a = 2 (k_max − k_min)/(N K_t).
        let planar = 2.0 * (plane.k_max_n_per_m - plane.k_min_n_per_m) / (2.0 * 767e6);
        assert_close(&what("planar"), planar * 1e3, planar_mm, 0.02);
        let slot = aluminium(Engagement::SLOT).average_pa();
        let stiffness: Matrix2<f64> = c_tt
            .fixed_view::<2, 2>(0, 0)
            .into_owned()
            .try_inverse()
            .expect("compliant");
        let block = slot.fixed_view::<2, 2>(0, 0).into_owned();
        let coalescence = coalescence_limit_m(&stiffness, &block).expect("skew");
        assert_close(&what("coalescence"), coalescence, planar, 1e-9);

        let limit = mode_coupling_limit(&modes, &slot).expect("a limit");
        assert_close(&what("6-DoF"), limit.depth_m * 1e3, limit_mm, 0.02);
        assert!(
            (limit.frequency_hz - chatter_hz).abs() <= 0.051,
            "{}: {} Hz",
            what("6-DoF"),
            limit.frequency_hz
        );
        let half = aluminium(half_slot()).average_pa();
        for (feed_rad, expected) in [0.0, FRAC_PI_2].into_iter().zip(half_mm) {
            let b = turned_pa(&half, feed_rad);
            let limit = mode_coupling_limit(&modes, &b).expect("a limit");
            assert_close(&what("half slot"), limit.depth_m * 1e3, expected, 0.02);
        }
    }
}

/// 6-DoF slot limits, too, do not depend on the feed direction.
#[test]
fn verify_slot_limit_of_the_arm_is_independent_of_the_feed_direction() {
    let robot = robot();
    let modes = modes(&robot, &postures(&robot, P1_M)[&120]);
    let slot = aluminium(Engagement::SLOT).average_pa();
    let limits = (0..36).map(|i| {
        let b = turned_pa(&slot, f64::from(i) * 0.1745);
        mode_coupling_limit(&modes, &b).expect("a limit").depth_m
    });
    let limits: Vec<f64> = limits.collect();
    for limit in &limits {
        assert_close("limit", *limit, limits[0], 1e-6);
    }
}

fn stable_angles(robot: &Robot, point_m: [f64; 3], process: &[Matrix3<f64>]) -> Vec<i32> {
    let stable = |q: &Vec<f64>| {
        let modes = modes(robot, q);
        let right = |b| rightmost_per_s(&modes, b, 0.3e-3).expect("modes").re;
        process.iter().all(|b| right(b) < 0.0)
    };
    let postures = postures(robot, point_m);
    let stable = postures.iter().filter(|(_, q)| stable(q));
    stable.map(|(angle, _)| *angle).collect()
}

fn range(from: i32, to: i32) -> impl Iterator<Item = i32> {
    (from..=to).step_by(10)
}

/// 45 steel, four teeth, 0.3 mm: stable redundancy angles in ten-degree steps, and what half a slot
/// changes.
#[test]
fn verify_stable_angles_in_steel() {
    let robot = robot();
    let slot = [steel(Engagement::SLOT).average_pa()];
    let p1: Vec<i32> = range(10, 60).chain(range(190, 240)).collect();
    assert_eq!(stable_angles(&robot, P1_M, &slot), p1);
    let p2: Vec<i32> = range(20, 70).chain(range(200, 240)).collect();
    assert_eq!(stable_angles(&robot, P2_M, &slot), p2);

    let half = steel(half_slot()).average_pa();
    let worst = [half, turned_pa(&half, FRAC_PI_2)];
    let p1: Vec<i32> = range(10, 90).chain(range(160, 240)).collect();
    assert_eq!(stable_angles(&robot, P1_M, &worst), p1);
    let p2: Vec<i32> = range(20, 240).collect();
    assert_eq!(stable_angles(&robot, P2_M, &worst), p2);
}

/// The contradiction at θr = 120°: 0.142 mm by mode coupling; with regeneration to zero order,
/// chatter frequencies of 3 to 60 Hz, from 0.035 mm at 150 rpm to 2.79 mm at 2400 rpm. Half a unit
/// of the last digit is 1.4 % of the first.
#[test]
fn verify_regenerative_limits_contradict_mode_coupling() {
    let robot = robot();
    let modes = modes(&robot, &postures(&robot, P1_M)[&120]);
    let slot = steel(Engagement::SLOT).average_pa();
    let coupling = mode_coupling_limit(&modes, &slot).expect("a limit");
    assert_close("mode coupling", coupling.depth_m * 1e3, 0.142, 0.02);
    let range = (3.0 * std::f64::consts::TAU, 60.0 * std::f64::consts::TAU);
    for (rpm, expected_mm) in [
        (150.0, 0.035),
        (300.0, 0.071),
        (600.0, 0.119),
        (1000.0, 0.49),
        (2400.0, 2.79),
    ] {
        let limit =
            zero_order_limit_within(&modes, &slot, 60.0 / (rpm * 4.0), range).expect("a limit");
        assert_close(
            &format!("{rpm} rpm"),
            limit.depth_m * 1e3,
            expected_mm,
            0.02,
        );
    }
}

/// Four teeth in a slot: sin² and cos² of neighbouring teeth make the directional matrix constant,
/// zero order is exact, and 6-DoF semi-discretisation must give the same limits. The scan of the
/// latter ends 1e-4 wide; what is left is its step.
#[test]
fn verify_zero_order_is_exact_for_four_teeth_in_a_slot() {
    let robot = robot();
    let postures = postures(&robot, P1_M);
    let process = steel(Engagement::SLOT);
    for (angle, rpm) in [(120, 300.0), (120, 1000.0), (120, 2400.0), (20, 2400.0)] {
        let modes = modes(&robot, &postures[&angle]);
        let period_s = 15.0 / rpm;
        let zero = zero_order_limit(&modes, &process.average_pa(), period_s).expect("a limit");
        let sdm = SpectralElements::new(&modes, &process);
        let search = LimitSearch::to_depth(2.0 * zero.depth_m);
        let limit = first_limit(&sdm, period_s, &search).expect("a limit");
        assert_close(
            &format!("{angle} deg, {rpm} rpm"),
            limit.depth_m,
            zero.depth_m,
            1e-3,
        );
        let highest = 2.0 * std::f64::consts::TAU * zero.frequency_hz;
        let frequencies = limit.multiplier.frequencies_rad_s(period_s, highest);
        let chatter = zero.frequency_hz * std::f64::consts::TAU;
        assert!(
            frequencies.iter().any(|f| (f / chatter - 1.0).abs() < 1e-3),
            "{angle} deg, {rpm} rpm: {} Hz",
            zero.frequency_hz
        );
    }
}

/// What mode coupling keeps with regeneration is the floor's feedback. In steel at 0.4 mm per
/// revolution it is too weak to make the arm flutter at P1, at any redundancy angle and in any feed
/// direction; ten times the feed is not.
#[test]
fn the_floor_alone_makes_no_posture_flutter() {
    let robot = robot();
    let floor = |feed_per_tooth_m: f64| {
        let cut = NominalCut {
            cutter: Cutter::straight(8e-3, 4),
            coefficients: steel(Engagement::SLOT).coefficients,
            engagement: Engagement::SLOT,
            axial_depth_m: 0.3e-3,
            feed_per_tooth_m,
        };
        cut.floor_feedback_n_per_m()
    };
    let worst = |feed_per_tooth_m: f64| {
        let feedback = floor(feed_per_tooth_m);
        let rightmost = postures(&robot, P1_M).into_values().flat_map(|q| {
            let modes = modes(&robot, &q);
            (0..36).map(move |i| {
                let turned = turned_pa(&feedback, f64::from(i) * 0.1745);
                rightmost_per_s(&modes, &turned, 1.0).expect("modes").re
            })
        });
        rightmost.fold(f64::NEG_INFINITY, f64::max)
    };
    assert!(worst(0.1e-3) < -0.7, "{}", worst(0.1e-3));
    assert!(worst(1e-3) > 0.0, "{}", worst(1e-3));
}
