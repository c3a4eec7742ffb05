//! When, within a step, a straight edge comes into the stock through a face or leaves it.
//!
//! Its force jumps there, or falls to nothing over the short way between the tip's crossing and
//! that of the chip's root. Taken at the middles of a step's parts the impulse of that step would
//! be off by up to half a part of the jump: an error of first order, of one sign or the other from
//! tooth to tooth. Edges on a helix cross height by height, each with a small part of the force.

use super::{CutState, Milling};
use crate::process::ToolState;

/// Halvings that find a crossing, to a millionth of a step.
const HALVINGS: usize = 20;

impl Milling {
    /// Bounds of the stretches of a step over which no edge crosses a face, rising, from -1/2 to
    /// 1/2 of the step.
    pub(super) fn stretches(&self, state: &ToolState) -> Vec<f64> {
        let mut bounds = vec![-0.5, 0.5];
        let cutter = &self.setup.parameters.cutter;
        if cutter.lag_rad_per_m() == 0.0 {
            let at = |ahead: f64| self.cut_state(state, ahead * self.step_s);
            for tooth in 0..cutter.teeth {
                self.add_crossings(tooth, &at, &mut bounds);
            }
            bounds.sort_by(f64::total_cmp);
        }
        bounds
    }

    fn add_crossings(&self, tooth: usize, at: &impl Fn(f64) -> CutState, bounds: &mut Vec<f64>) {
        let ends = |ahead: f64| self.cut.ends_in_stock(tooth, &at(ahead));
        let (start, end) = (bounds[0], bounds[1]);
        let (before, after) = (ends(start), ends(end));
        for one in 0..2 {
            if before[one] != after[one] {
                bounds.push(crossing(|ahead| ends(ahead)[one], start, end));
            }
        }
    }
}

/// Where a condition changes between two places at which it differs.
fn crossing(holds: impl Fn(f64) -> bool, mut low: f64, mut high: f64) -> f64 {
    let at_low = holds(low);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) == at_low {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}
