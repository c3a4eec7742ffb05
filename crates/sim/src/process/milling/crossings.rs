//! When, within a step, a straight edge comes into the stock through a face or leaves it.
//!
//! Its force jumps there, or falls to nothing over the short way between the tip's crossing and
//! that of the chip's root. Taken at the middles of a step's parts the impulse of that step would
//! be off by up to half a part of the jump: an error of first order, of one sign or the other from
//! tooth to tooth. Edges on a helix cross height by height, each with a small part of the force.

use super::Milling;
use crate::process::ToolState;

/// Of a step, as parts of it from its middle.
pub(in crate::process) const START: f64 = -0.5;
pub(in crate::process) const END: f64 = 0.5;
/// Halvings that find a crossing, to a millionth of a step.
const HALVINGS: usize = 20;

impl Milling {
    /// Moments of a step at which an edge crosses a face, rising, as parts of it from its middle.
    pub(super) fn crossings(&self, state: &ToolState) -> Vec<f64> {
        let mut found = Vec::new();
        let cutter = &self.setup.parameters.cutter;
        if cutter.lag_rad_per_m() != 0.0 {
            return found;
        }
        let at = |ahead: f64| self.cut_state(state, ahead * self.step_s);
        let [first, last] = [at(START), at(END)];
        for tooth in 0..cutter.teeth {
            let before = self.cut.ends_in_stock(tooth, &first);
            let after = self.cut.ends_in_stock(tooth, &last);
            for end in (0..2).filter(|end| before[*end] != after[*end]) {
                let is_in = |ahead| self.cut.ends_in_stock(tooth, &at(ahead))[end];
                found.push(crossing(is_in, before[end]));
            }
        }
        found.sort_by(f64::total_cmp);
        found
    }
}

/// Where a condition changes that holds at the end of a step if it does not at its start.
pub(in crate::process) fn crossing(holds: impl Fn(f64) -> bool, at_start: bool) -> f64 {
    let (mut low, mut high) = (START, END);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) == at_start {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}
