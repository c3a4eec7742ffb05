//! Stability diagrams against published limits.

use std::f64::consts::TAU;
use std::sync::Mutex;

use nalgebra::Vector3;
use truecut_core::chatter::{AttachedModes, DirectionalMatrix, TipMode};
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::nominal::NominalCut;
use truecut_plan::Cut;
use truecut_plan::lobes::{LobeRequest, lobes};

fn rpm(rpm: f64) -> f64 {
    rpm * TAU / 60.0
}

fn cut(teeth: usize, tangential_pa: f64, ratio: f64, engagement: Engagement) -> Cut {
    let process = DirectionalMatrix::planar(teeth, tangential_pa, ratio, engagement);
    Cut {
        nominal: NominalCut {
            cutter: Cutter::straight(5e-3, teeth),
            coefficients: process.coefficients,
            engagement,
            axial_depth_m: 1e-3,
            feed_per_tooth_m: 0.1e-3,
        },
        spindle_rad_s: rpm(10_000.0),
        attached: AttachedModes::default(),
    }
}

/// `docs/physics/stability.md`, benchmark 2, half up-milling, x and y modes: zero order 1.087,
/// 1.095, 1.340, 4.03 mm and semi-discretisation 1.10, 1.10, 1.366, 4.29 mm at 5000, 8000, 10000,
/// 12000 rpm; printed to three digits, met within 2 %. The chatter frequency is that of a mode,
/// above its natural frequency by 15 % at most.
#[test]
fn verify_published_limits_in_a_diagram() {
    let modes = [
        TipMode::of_stiffness(TAU * 603.0, 0.039, 5.59e6, &Vector3::x()),
        TipMode::of_stiffness(TAU * 666.0, 0.035, 5.715e6, &Vector3::y()),
    ];
    let half = Engagement::up(0.5, 1.0).expect("half");
    let request = LobeRequest {
        spindle_rad_s: [rpm(5000.0), rpm(12_000.0)],
        deepest_m: 5e-3,
        speeds: 8,
        depths: 60,
    };
    let told = Mutex::new(Vec::new());
    let found = lobes(
        &|_| Ok(modes.to_vec()),
        &cut(3, 6e8, 0.07, half),
        &request,
        &|part| {
            told.lock().expect("one at a time").push(part);
        },
    )
    .expect("modes");
    let close = |value: f64, expected: f64| {
        assert!(
            (value / expected - 1.0).abs() < 0.02,
            "{value} instead of {expected}"
        );
    };
    for (i, zero_mm, limit_mm) in [
        (0, 1.087, 1.10),
        (3, 1.095, 1.10),
        (5, 1.340, 1.366),
        (7, 4.03, 4.29),
    ] {
        close(found.zero_order[i].expect("a limit").depth_m * 1e3, zero_mm);
        let limit = found.limit[i].expect("a limit");
        close(limit.depth_m * 1e3, limit_mm);
        assert!(
            (600.0..1.15 * 666.0).contains(&limit.frequency_hz),
            "{limit:?}"
        );
    }
    // The field and the limit agree: below it all stable, the first depth beyond it unstable.
    for (column, limit) in found.multiplier.iter().zip(&found.limit) {
        let limit = limit.expect("a limit").depth_m;
        for (m, depth) in column.iter().zip(&found.depth_m) {
            if *depth < limit * (1.0 - 1e-3) {
                assert!(*m < 1.0);
            }
        }
        let beyond = found
            .depth_m
            .iter()
            .position(|d| *d >= limit)
            .expect("deep enough");
        assert!(column[beyond] >= 1.0);
    }
    let told = told.into_inner().expect("unlocked");
    assert_eq!(told.len(), 8);
    assert!(told.contains(&1.0));
}

/// One mode, straight 2-tooth slot: no mode coupling, and no limit where the deepest cut is
/// shallower than any.
#[test]
fn what_is_stable_has_no_limit() {
    let one = [TipMode::of_mass(TAU * 922.0, 0.011, 0.03993, &Vector3::x())];
    let request = LobeRequest {
        spindle_rad_s: [rpm(5000.0), rpm(6000.0)],
        deepest_m: 0.1e-3,
        speeds: 3,
        depths: 4,
    };
    let found = lobes(
        &|_| Ok(one.to_vec()),
        &cut(2, 6e8, 1.0 / 3.0, Engagement::SLOT),
        &request,
        &|_| {},
    )
    .expect("modes");
    assert!(found.limit.iter().all(Option::is_none));
    assert!(found.multiplier.iter().flatten().all(|m| *m < 1.0));
    assert!(found.mode_coupling.is_none_or(|c| c.depth_m > 1e-3));
}
