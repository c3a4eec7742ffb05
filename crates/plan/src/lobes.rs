//! Stability diagrams: limit depth over spindle speed.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use truecut_core::chatter::TipMode;
use truecut_core::chatter::averaged::{Crossing, mode_coupling_limit, zero_order_limit};
use truecut_core::chatter::semi_discretisation::{Multiplier, SemiDiscretisation};

use crate::assess::diagram_steps;
use crate::criterion::Cut;

/// Relative width to which a limit is narrowed.
const NARROWED: f64 = 1e-3;

/// The part of the plane that is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LobeRequest {
    /// Slowest and fastest spindle speed, rad/s.
    pub spindle_rad_s: [f64; 2],
    /// Deepest cut, m.
    pub deepest_m: f64,
    /// Number of speeds, two at least, and of depths, one at least.
    pub speeds: usize,
    pub depths: usize,
}

/// A stability diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobes {
    /// Evenly from the slowest to the fastest.
    pub spindle_rad_s: Vec<f64>,
    /// Even steps up to the deepest; the first is one step deep.
    pub depth_m: Vec<f64>,
    /// Magnitude of the dominant multiplier over a tooth period, by speed, then depth; stable below 1.
    pub multiplier: Vec<Vec<f64>>,
    /// First depth at each speed at which the cut is unstable, by semi-discretisation; none down to
    /// the deepest. An unstable island thinner than a step of the depths may be missed.
    pub limit: Vec<Option<Crossing>>,
    /// The same to zero order, whatever its depth.
    pub zero_order: Vec<Option<Crossing>>,
    /// Mode coupling, teeth meeting the nominal surface: the same at all speeds.
    pub mode_coupling: Option<Crossing>,
}

/// The diagram of modes (milling frame) in a cut; its own depth and spindle speed are not asked
/// for. `progress` is told the part done.
pub fn lobes(
    modes: &[TipMode],
    cut: &Cut,
    request: &LobeRequest,
    progress: &(dyn Fn(f64) + Sync),
) -> Lobes {
    let (speeds, depths) = (request.speeds.max(2), request.depths.max(1));
    let [slow, fast] = request.spindle_rad_s;
    let speed = |i: usize| slow + (fast - slow) * i as f64 / (speeds - 1) as f64;
    let spindle_rad_s: Vec<f64> = (0..speeds).map(speed).collect();
    let depth = |j: usize| request.deepest_m * j as f64 / depths as f64;
    let depth_m: Vec<f64> = (1..=depths).map(depth).collect();
    let done = AtomicUsize::new(0);
    let columns: Vec<SpeedColumn> = (spindle_rad_s.par_iter())
        .map(|speed| {
            let column = SpeedColumn::at(modes, cut, *speed, &depth_m);
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(count as f64 / speeds as f64);
            column
        })
        .collect();
    Lobes {
        multiplier: columns.iter().map(|c| c.multiplier.clone()).collect(),
        limit: columns.iter().map(|c| c.limit).collect(),
        zero_order: columns.iter().map(|c| c.zero_order).collect(),
        mode_coupling: mode_coupling_limit(modes, &cut.directional().average_pa()),
        spindle_rad_s,
        depth_m,
    }
}

/// One speed of a diagram.
struct SpeedColumn {
    multiplier: Vec<f64>,
    limit: Option<Crossing>,
    zero_order: Option<Crossing>,
}

impl SpeedColumn {
    fn at(modes: &[TipMode], cut: &Cut, spindle_rad_s: f64, depth_m: &[f64]) -> Self {
        let directional = cut.directional();
        let period_s = cut.nominal.cutter.tooth_period_s(spindle_rad_s);
        let prepared = SpectralElements::new(modes, &directional);
        let found: Vec<Multiplier> = depth_m
            .iter()
            .map(|depth| prepared.multiplier(period_s, *depth))
            .collect();
        let unstable = found.iter().position(|m| !m.is_stable());
        let limit = unstable.map(|j| {
            let shallower = j.checked_sub(1).map_or(0.0, |before| depth_m[before]);
            narrowed(
                &prepared,
                modes,
                period_s,
                (shallower, depth_m[j]),
                found[j],
            )
        });
        Self {
            multiplier: found.iter().map(Multiplier::magnitude).collect(),
            limit,
            zero_order: zero_order_limit(modes, &directional.average_pa(), period_s),
        }
    }
}

/// The limit between a stable and an unstable depth.
fn narrowed(
    prepared: &SemiDiscretisation,
    modes: &[TipMode],
    period_s: f64,
    (mut low, mut high): (f64, f64),
    mut multiplier: Multiplier,
) -> Crossing {
    while high - low > NARROWED * high {
        let middle = 0.5 * (low + high);
        let found = prepared.multiplier(period_s, middle);
        if found.is_stable() {
            low = middle;
        } else {
            (high, multiplier) = (middle, found);
        }
    }
    Crossing {
        depth_m: high,
        frequency_hz: chatter_hz(&multiplier, modes, period_s),
    }
}

/// Of the frequencies of a multiplier the one that the tool answers most, Hz.
fn chatter_hz(multiplier: &Multiplier, modes: &[TipMode], period_s: f64) -> f64 {
    let natural = modes.iter().map(|m| m.natural_frequency_rad_s);
    let highest = natural.fold(0.0, f64::max) * 1.5;
    let answer = |f: f64| -> f64 {
        let of_mode = |m: &TipMode| {
            let own = m.natural_frequency_rad_s;
            let rest = (own * own - f * f).hypot(2.0 * m.damping_ratio * own * f);
            m.shape_per_sqrt_kg.norm_squared() / rest
        };
        modes.iter().map(of_mode).sum()
    };
    let frequencies = multiplier.frequencies_rad_s(period_s, highest);
    let strongest = frequencies
        .into_iter()
        .max_by(|a, b| answer(*a).total_cmp(&answer(*b)));
    strongest.unwrap_or(0.0) / std::f64::consts::TAU
}
