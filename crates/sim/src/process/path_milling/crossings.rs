//! When, within a step, a straight edge comes into the stock or leaves it: its force jumps there.

use super::PathMilling;
use crate::process::milling::crossing;
pub(super) use crate::process::milling::{END, START};
use truecut_core::cutting::milling::layered::cut::ToolPlace;

impl PathMilling {
    /// Moments of a step at which an edge crosses the stock's outline, rising, as parts of it from
    /// its middle. Edges on a helix cross height by height.
    pub(super) fn crossings(&self, at: impl Fn(f64) -> ToolPlace) -> Vec<f64> {
        let mut found = Vec::new();
        let cutter = &self.setup.spec.cutter;
        if cutter.lag_rad_per_m() != 0.0 {
            return found;
        }
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
