//! Probability of being stable where stiffnesses are uncertain, against 10 000 plain draws.

use std::f64::consts::TAU;

use nalgebra::Matrix3;
use rayon::prelude::*;
use truecut::plan::spread::{LimitOf, Spread, Variant};
use truecut::plan::{Criterion, Cut, Planner, PlannerOptions, modes_in_cut};
use truecut_arm::Robot;
use truecut_core::chatter::TipMode;
use truecut_core::chatter::averaged::zero_order_limit;
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_scenario::Scenario;
use truecut_sim::stability::{Draws, MillingStudy};

use crate::support::repository;

const DRAWS: usize = 10_000;
/// Standard deviation of each joint's stiffness, relative.
const SIGMA: f64 = 0.15;
const SEED: u64 = 20_261_124;
/// Largest difference of a probability.
const APART: f64 = 0.03;

/// The shipped path at an angle (deg) and a depth (mm), the stiffness of every joint uncertain.
fn scenario(angle_deg: f64, depth_mm: f64) -> Scenario {
    let at = repository().join("scenarios/milling/path_600.toml");
    let mut text = std::fs::read_to_string(&at).expect("a shipped scenario");
    for joint in 1..=6 {
        text += &format!("\n[[robot.joint]]\nname = \"joint_{joint}\"\nstiffness_factor = 1.0\n");
    }
    for index in 0..6 {
        text += &format!(
            "\n[[uncertain]]\nkey = \"robot.joint.{index}.stiffness_factor\"\nrelative = {SIGMA}\n"
        );
    }
    let path = "process.milling.path.redundancy_deg".to_owned();
    let depth = "process.milling.axial_depth_mm".to_owned();
    let overrides = [
        (path, format!("{angle_deg:?}")),
        (depth, format!("{depth_mm:?}")),
    ];
    Scenario::from_str(&at, &text, &overrides).unwrap_or_else(|error| panic!("{error:?}"))
}

/// Six standard normal numbers of the `index`th draw: splitmix64 and Box and Muller's rule.
fn normal(index: usize) -> [f64; 6] {
    let mut state = SEED.wrapping_add((index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15 ^ 0xABCD));
    let mut uniform = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    std::array::from_fn(|_| (-2.0 * (1.0 - uniform()).ln()).sqrt() * (TAU * uniform()).cos())
}

/// What is said of the modes of every draw, by scaling the stiffnesses of the robot itself.
fn plain<T: Send>(
    study: &MillingStudy,
    posture: &[f64],
    axes: &Matrix3<f64>,
    of: impl Fn(&[TipMode]) -> T + Sync,
) -> Vec<T> {
    let drawn = (0..DRAWS).into_par_iter().map(|index| {
        let mut robot: Robot = (*study.robot).clone();
        for (joint, z) in robot.chain.joints.iter_mut().zip(normal(index)) {
            let stiffness = &mut joint.transmission.stiffness;
            *stiffness = stiffness.map(|k| k * (1.0 + SIGMA * z));
        }
        let modes = modes_in_cut(&robot, posture, axes, &study.cut.attached);
        of(&modes.expect("modes"))
    });
    drawn.collect()
}

fn part<T>(all: &[T], holds: impl Fn(&T) -> bool) -> f64 {
    all.iter().filter(|one| holds(one)).count() as f64 / all.len() as f64
}

fn sets(scenario: &Scenario) -> Vec<Vec<Variant>> {
    let draws = Draws::of(scenario).unwrap_or_else(|error| panic!("{error}"));
    draws.expect("something is uncertain").sets
}

/// Four teeth in a slot: the zero-order limit, which has a closed form, is exact. Depths are drawn
/// about the limits' quartiles.
#[test]
fn verify_probability_below_the_limits_of_a_diagram() {
    for (angle_deg, speed, quantile) in [(30.0, 600.0, 0.75), (60.0, 450.0, 0.3)] {
        let study = MillingStudy::of(&scenario(angle_deg, 0.3)).expect("a study");
        let posture = study.postures().expect("postures").posture(0.0);
        let axes = study.path.world_from_milling(0);
        let average = study.cut.directional().average_pa();
        let spindle_rad_s = speed * TAU / 60.0;
        let period_s = study.cut.nominal.cutter.tooth_period_s(spindle_rad_s);
        let limit = |modes: &[TipMode]| {
            let limit = zero_order_limit(modes, &average, period_s);
            limit.map_or(f64::INFINITY, |limit| limit.depth_m)
        };
        let mut limits = plain(&study, &posture, &axes, limit);
        limits.sort_by(f64::total_cmp);
        let at = |part: f64| limits[(part * DRAWS as f64) as usize];
        let depth_m = at(quantile);
        let cut = scenario(angle_deg, depth_m * 1e3);
        let of = LimitOf {
            posture: &posture,
            world_from_milling: axes,
            regeneration: true,
        };
        let found = of.at_speed(&sets(&cut), spindle_rad_s, 3.0 * depth_m);
        let found = found.expect("a spread");
        let expected = part(&limits, |limit| *limit > depth_m);
        assert!((0.2..=0.8).contains(&expected), "{angle_deg}: {expected}");
        near(&found, expected, &format!("{angle_deg} deg, {speed} rpm"));
        for (ours, below) in found.quantiles.into_iter().zip([0.05, 0.5, 0.95]) {
            let theirs = part(&limits, |limit| *limit < ours);
            assert!((theirs - below).abs() < APART, "{ours}: {theirs} {below}");
        }
    }
}

/// Regeneration with the floor, at postures where it allows about the cut's depth: stable is what
/// no depth down to the cut's makes grow, and decays as fast as is asked.
#[test]
fn verify_probability_that_a_posture_is_stable() {
    let scenario = scenario(90.0, 0.3);
    let study = MillingStudy::of(&scenario).expect("a study");
    let path = study.postures().expect("postures");
    let options = PlannerOptions::default();
    let planner = Planner::new(&study.robot, &study.path, &study.cut, &options).expect("a planner");
    let angle = |_: f64| 90_f64.to_radians();
    let posture = |at_m: f64| path.posture(at_m);
    let plan = planner.at_postures(Criterion::Regenerative, &angle, &posture);
    let plan = plan.expect("a plan");
    let found = planner.spread_along(&plan, &sets(&scenario), 2, &|_| ());
    let found = found.expect("spreads");
    assert!((0.2..=0.8).contains(&found[0].1.stable.value), "{found:?}");
    for (along_m, spread) in found {
        let axes = study.path.world_from_milling(0);
        let answers = plain(&study, &posture(along_m), &axes, |modes| {
            is_stable(modes, &study.cut, options.least_decay)
        });
        near(
            &spread,
            part(&answers, |stable| *stable),
            &format!("{along_m} m"),
        );
    }
}

fn is_stable(modes: &[TipMode], cut: &Cut, least_decay: f64) -> bool {
    let elements = SpectralElements::new(modes, &cut.directional()).with_floor(&cut.nominal);
    let (period_s, depth_m) = (cut.tooth_period_s(), cut.nominal.axial_depth_m);
    let at = elements.at(period_s);
    let growth = |part: f64| at.multiplier(part * depth_m).growth_per_s(period_s);
    let own = modes
        .iter()
        .map(|m| m.damping_ratio * m.natural_frequency_rad_s);
    let least_per_s = least_decay * own.fold(f64::INFINITY, f64::min);
    growth(1.0) <= -least_per_s && growth(0.5) < 0.0
}

fn near(found: &Spread, expected: f64, about: &str) {
    let (ours, error) = (found.stable.value, found.stable.standard_error);
    println!("{about}: {ours:.4} ({error:.4}), 10 000 draws {expected:.4}");
    assert!(
        (ours - expected).abs() < APART,
        "{about}: {ours} {expected}"
    );
    assert!(error < 0.015, "{about}: {error}");
}
