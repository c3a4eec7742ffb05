//! What is left beyond the noise, where that is known, or where most of it can be foretold.

use crate::diagnose::ceiling::Bound;
use crate::diagnose::fit::Fit;
use crate::diagnose::floor::{Floor, left_beyond};
use crate::diagnose::problem::Problem;
use crate::diagnose::validate::rms;
use crate::model::Columns;

/// From this ratio of the variance left to that of the noise on, most of what is left is no noise.
const PREVAILS: f64 = 2.0;

/// Where the noise is known and what is left is clearly above it.
pub(super) struct Excess {
    /// Part of the discrepancy that it is.
    pub fraction: f64,
    /// It is more than the noise is, and no small part of what there was to be explained.
    pub prevails: bool,
    pub text: String,
}

/// What is left beyond the floor, on the rows that were fitted or on those that were not: the
/// channel in which it is most.
pub(super) fn excess(
    problem: &Problem,
    before: &Columns,
    last: &Fit,
    bound: &Bound,
    floors: &[Option<Floor>],
) -> Option<Excess> {
    let nominal = problem.data.residual(before);
    let mut most: Option<(f64, Excess)> = None;
    for rows in [&problem.split.development, &problem.split.test] {
        let beyond = left_beyond(floors, &last.residual, rows);
        let squares = rms(&nominal, rows);
        for (c, beyond) in beyond.iter().enumerate() {
            let (Some(beyond), Some(floor)) = (beyond, &floors[c]) else {
                continue;
            };
            if most.as_ref().is_some_and(|most| most.0 >= beyond.ratio) {
                continue;
            }
            let discrepancy = squares[c].powi(2) - floor.rms.powi(2);
            let text = format!(
                "what is left of `{}` is {} times the noise ({})",
                problem.model.channels()[c].name,
                truecut_recording::significant(beyond.ratio.sqrt(), 3),
                floor.source.description()
            );
            let fraction = (beyond.variance / discrepancy.max(beyond.variance)).min(1.0);
            // By its size, not by its square.
            let is_large = fraction.sqrt() > problem.options.unknown_above;
            let excess = Excess {
                fraction,
                prevails: beyond.ratio > PREVAILS && is_large,
                text,
            };
            most = Some((beyond.ratio, excess));
        }
    }
    let known = most.map(|(_, excess)| excess);
    let Some((c, fraction)) = foretold(problem, before, last, bound, floors) else {
        return known;
    };
    let foretold = Excess {
        fraction,
        prevails: true,
        text: format!(
            "most of what is left of `{}` can be foretold",
            problem.model.channels()[c].name
        ),
    };
    Some(match known {
        Some(excess) if excess.prevails => excess,
        _ => foretold,
    })
}

/// The channel whose noise is not known, and of which most that is left can be foretold from
/// signals, and the part of the discrepancy that this is: the noise is at most the rest, and what
/// is beyond it counts as where noise is known.
fn foretold(
    problem: &Problem,
    before: &Columns,
    last: &Fit,
    bound: &Bound,
    floors: &[Option<Floor>],
) -> Option<(usize, f64)> {
    let rows = &problem.split.development;
    let nominal = rms(&problem.data.residual(before), rows);
    let left = rms(&last.residual, rows);
    let channels = (0..left.len()).filter(|&c| floors[c].is_none() && !bound.in_time[c]);
    let fractions = channels.filter_map(|c| {
        let part = bound.foretold[c];
        let [noise, variance] = [1.0 - part, part].map(|part| part * left[c].powi(2));
        let discrepancy = nominal[c].powi(2) - noise;
        let fraction = (variance / discrepancy.max(variance)).min(1.0);
        let is_large = fraction.sqrt() > problem.options.unknown_above;
        (noise + variance > PREVAILS * noise && is_large).then_some((c, fraction))
    });
    fractions.max_by(|a, b| a.1.total_cmp(&b.1))
}
