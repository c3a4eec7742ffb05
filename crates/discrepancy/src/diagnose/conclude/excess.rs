//! What is left beyond the noise, where that is known.

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
    most.map(|(_, excess)| excess)
}
