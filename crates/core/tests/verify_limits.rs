//! Limits of stability against cuts drawn from a seed: one to three modes in any direction, two to
//! five teeth, immersions from 5 to 90 %, up and down, up to seven cycles of the fastest mode a
//! tooth period. The limits in `limits.csv` come from `tests/reference/limits.py`, another method
//! (first-order semi-discretisation, dense, extrapolated), which states its own uncertainty.

use nalgebra::Vector3;
use truecut_core::chatter::limit::{FirstLimit, LimitSearch, first_limit, narrowed};
use truecut_core::chatter::spectral_elements::{Resolution, SpectralElements};
use truecut_core::chatter::{DirectionalMatrix, TipMode};
use truecut_core::cutting::milling::engagement::Engagement;

struct Case {
    elements: SpectralElements,
    tooth_period_s: f64,
    limit_m: f64,
    uncertainty: f64,
}

fn cases() -> Vec<Case> {
    let lines = include_str!("limits.csv").lines().skip(1);
    lines.map(case).collect()
}

fn case(line: &str) -> Case {
    let fields: Vec<&str> = line.split(',').collect();
    let number = |i: usize| -> f64 { fields[i].parse().expect("a number") };
    let modes = fields[8].split(';').map(|mode| {
        let x: Vec<f64> = (mode.split(' ').map(|x| x.parse().expect("a number"))).collect();
        TipMode {
            natural_frequency_rad_s: x[0],
            damping_ratio: x[1],
            shape_per_sqrt_kg: Vector3::new(x[2], x[3], 0.0),
        }
    });
    let engagement = Engagement {
        entry_rad: number(4),
        exit_rad: number(5),
    };
    let process = DirectionalMatrix::planar(number(1) as usize, number(2), number(3), engagement);
    Case {
        elements: SpectralElements::new(&modes.collect::<Vec<_>>(), &process),
        tooth_period_s: number(0),
        limit_m: number(6),
        uncertainty: number(7),
    }
}

/// The first limit within 0.05 % of the reference, where that is itself so certain, and the
/// estimated error below 0.1 %.
#[test]
fn verify_first_limits_of_cuts_drawn_at_random() {
    let cases = cases();
    assert!(cases.len() >= 30, "{} cases", cases.len());
    for (i, case) in cases.iter().enumerate() {
        let search = LimitSearch {
            relative_width: 1e-6,
            ..LimitSearch::to_depth(1.1 * case.limit_m)
        };
        let found = first_limit(&case.elements, case.tooth_period_s, &search).expect("a limit");
        let apart = (found.depth_m / case.limit_m - 1.0).abs();
        let allowed = 5e-4_f64.max(2.0 * case.uncertainty);
        assert!(
            apart < allowed,
            "{i}: {apart:.1e} of {allowed:.1e} {found:?}"
        );
        assert!(found.error_m < 1e-3 * found.depth_m, "{i}: {found:?}");
    }
}

/// Too coarse on purpose, four nodes for two cycles: what is estimated is within a factor of two of
/// the true error wherever that exceeds 0.05 %.
#[test]
fn verify_estimated_error_is_the_true_one() {
    let coarse = Resolution {
        nodes: 4,
        elements_per_cycle: 0.5,
    };
    let mut counted = 0;
    for (i, case) in cases().iter().enumerate() {
        let fine = (case.elements).resolved(case.tooth_period_s, Resolution::FINER);
        let at = case.elements.resolved(case.tooth_period_s, coarse);
        let [low, high] = [0.9, 1.1].map(|part| part * case.limit_m);
        let bracketed = |at: &truecut_core::chatter::spectral_elements::AtSpeed<'_>| {
            let unstable = FirstLimit {
                depth_m: high,
                error_m: 0.0,
                multiplier: at.multiplier(high),
            };
            let crosses = at.multiplier(low).is_stable() && !unstable.multiplier.is_stable();
            crosses.then(|| narrowed(at, low, unstable, 1e-7, 0.0))
        };
        let (Some(here), Some(truth)) = (bracketed(&at), bracketed(&fine)) else {
            continue;
        };
        let true_m = (here.depth_m - truth.depth_m).abs();
        if true_m > 5e-4 * truth.depth_m {
            counted += 1;
            let ratio = here.error_m / true_m;
            assert!((0.5..2.0).contains(&ratio), "{i}: {here:?} {truth:?}");
        }
    }
    assert!(counted >= 10, "{counted} errors worth speaking of");
}
