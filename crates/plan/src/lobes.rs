//! Stability diagrams: limit depth over spindle speed.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use truecut_core::chatter::averaged::{Crossing, mode_coupling_limit, zero_order_limit};
use truecut_core::chatter::limit::{FirstLimit, narrowed};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{Multiplier, TipMode};

use crate::criterion::Cut;
use crate::error::PlanError;

/// Relative width to which a limit is narrowed.
const NARROWED: f64 = 1e-4;

/// The part of the plane that is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LobeRequest {
    /// Slowest and fastest spindle speed, rad/s.
    pub spindle_rad_s: [f64; 2],
    /// Deepest cut, m.
    pub deepest_m: f64,
    /// Number of speeds and of depths, one at least; a single speed is the slowest.
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
    /// Magnitude of the dominant multiplier over a tooth period, by speed, then depth; stable below
    /// 1. NaN where it is not known ([`Self::known_to`]).
    pub multiplier: Vec<Vec<f64>>,
    /// First depth at each speed at which the cut is unstable, by spectral elements; none down to
    /// the deepest. An unstable island thinner than a step of the depths may be missed.
    pub limit: Vec<Option<Crossing>>,
    /// By how much the discretisation in time puts each limit wrong, m, estimated from a finer one.
    pub limit_error_m: Vec<Option<f64>>,
    /// The same to zero order, whatever its depth.
    pub zero_order: Vec<Option<Crossing>>,
    /// Mode coupling, teeth meeting the nominal surface: the same at all speeds, but with worn
    /// flanks that of the cut's own.
    pub mode_coupling: Option<Crossing>,
}

/// The diagram of a cut, whose own depth and spindle speed are not asked for. `modes` gives those
/// at a spindle speed (rad/s) in the milling frame; `progress` is told the part done.
///
/// # Errors
/// Those of `modes`.
pub fn lobes(
    modes: &(dyn Fn(f64) -> Result<Vec<TipMode>, PlanError> + Sync),
    cut: &Cut,
    request: &LobeRequest,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Lobes, PlanError> {
    let (speeds, depths) = (request.speeds.max(1), request.depths.max(1));
    let [slow, fast] = request.spindle_rad_s;
    let speed = |i: usize| slow + (fast - slow) * i as f64 / (speeds - 1).max(1) as f64;
    let spindle_rad_s: Vec<f64> = (0..speeds).map(speed).collect();
    let depth = |j: usize| request.deepest_m * j as f64 / depths as f64;
    let depth_m: Vec<f64> = (1..=depths).map(depth).collect();
    let done = AtomicUsize::new(0);
    let columns: Vec<SpeedColumn> = (spindle_rad_s.par_iter())
        .map(|speed| {
            let column = SpeedColumn::at(&modes(*speed)?, cut, *speed, &depth_m);
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(count as f64 / speeds as f64);
            Ok(column)
        })
        .collect::<Result<_, PlanError>>()?;
    Ok(Lobes {
        multiplier: columns.iter().map(|c| c.multiplier.clone()).collect(),
        limit: columns.iter().map(|c| c.limit.map(|l| l.0)).collect(),
        limit_error_m: columns.iter().map(|c| c.limit.map(|l| l.1)).collect(),
        zero_order: columns.iter().map(|c| c.zero_order).collect(),
        mode_coupling: mode_coupling_limit(&modes(cut.spindle_rad_s)?, cut.averaged()),
        spindle_rad_s,
        depth_m,
    })
}

impl Lobes {
    /// The diagram without limits at speeds above one, rad/s: none are known there.
    #[must_use]
    pub fn known_to(mut self, spindle_rad_s: f64) -> Self {
        let known = |speed: &f64| *speed <= spindle_rad_s;
        let first = self.spindle_rad_s.iter().position(|speed| !known(speed));
        for i in first.unwrap_or(self.spindle_rad_s.len())..self.spindle_rad_s.len() {
            self.multiplier[i].fill(f64::NAN);
            self.limit[i] = None;
            self.limit_error_m[i] = None;
            self.zero_order[i] = None;
        }
        self
    }

    /// The largest estimated error of a limit, as a part of it; 0 without limits.
    pub fn largest_error(&self) -> f64 {
        let parts = (self.limit.iter().flatten())
            .zip(self.limit_error_m.iter().flatten())
            .map(|(limit, error_m)| error_m / limit.depth_m);
        parts.fold(0.0, f64::max)
    }
}

/// One speed of a diagram.
struct SpeedColumn {
    multiplier: Vec<f64>,
    /// With its estimated error in m.
    limit: Option<(Crossing, f64)>,
    zero_order: Option<Crossing>,
}

impl SpeedColumn {
    fn at(modes: &[TipMode], cut: &Cut, spindle_rad_s: f64, depth_m: &[f64]) -> Self {
        let directional = cut.directional();
        let period_s = cut.nominal.cutter.tooth_period_s(spindle_rad_s);
        let elements = SpectralElements::new(modes, &directional);
        let at = elements.at(period_s);
        let found: Vec<Multiplier> = depth_m.iter().map(|depth| at.multiplier(*depth)).collect();
        let unstable = found.iter().position(|m| !m.is_stable());
        let limit = unstable.map(|j| {
            let stable_m = j.checked_sub(1).map_or(0.0, |before| depth_m[before]);
            let unstable = FirstLimit {
                depth_m: depth_m[j],
                error_m: 0.0,
                multiplier: found[j],
            };
            let limit = narrowed(&at, stable_m, unstable, NARROWED, 0.0);
            let crossing = Crossing {
                depth_m: limit.depth_m,
                frequency_hz: at.chatter_hz(limit.depth_m),
            };
            (crossing, limit.error_m)
        });
        Self {
            multiplier: found.iter().map(Multiplier::magnitude).collect(),
            limit,
            zero_order: zero_order_limit(modes, directional.averaged(period_s), period_s),
        }
    }
}
