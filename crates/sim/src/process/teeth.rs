//! The force of teeth, averaged over a step.
//!
//! Where a straight edge comes into the stock through a face or leaves it, its force jumps, or
//! falls to nothing over the short way between the tip's crossing and that of the chip's root.
//! Taken at the middles of a step's parts alone the impulse of that step would be off by up to
//! half a part of the jump: an error of first order, of one sign or the other from tooth to tooth.
//! So the step is parted there. Edges on a helix cross height by height, each with a small part of
//! the force.

use truecut_core::cutting::milling::cut::MillingLoads;
use truecut_core::cutting::milling::cutter::Cutter;

/// Ends of a step, as parts of it from its middle.
const START: f64 = -0.5;
const END: f64 = 0.5;
/// Parts of a step at whose middles the force is taken; stretches between crossings have their own.
const PARTS: usize = 4;
/// Halvings that find a crossing, to a millionth of a step.
const HALVINGS: usize = 20;

/// Force and moment on the tool, averaged over a step. `at` says where the tool is at a moment (a
/// part of the step from its middle), `ends` whether tip and root of a tooth's chip are in the
/// stock there, `cut` what acts there.
pub(super) fn averaged<P>(
    cutter: &Cutter,
    at: impl Fn(f64) -> P,
    ends: impl Fn(usize, &P) -> [bool; 2],
    cut: impl Fn(&P) -> MillingLoads,
) -> MillingLoads {
    let mut mean = MillingLoads::default();
    let mut start = START;
    for end in crossings(cutter, &at, ends).into_iter().chain([END]) {
        let parts = ((end - start) * PARTS as f64).ceil();
        let share = (end - start) / parts;
        for part in 0..parts as usize {
            let loads = cut(&at(start + (part as f64 + 0.5) * share));
            mean.force_on_tool_n += loads.force_on_tool_n * share;
            mean.moment_on_tool_n_m += loads.moment_on_tool_n_m * share;
        }
        start = end;
    }
    mean
}

/// Moments at which a straight edge crosses a face, rising.
fn crossings<P>(
    cutter: &Cutter,
    at: impl Fn(f64) -> P,
    ends: impl Fn(usize, &P) -> [bool; 2],
) -> Vec<f64> {
    let mut found = Vec::new();
    if cutter.lag_rad_per_m() != 0.0 {
        return found;
    }
    let [first, last] = [at(START), at(END)];
    for tooth in 0..cutter.teeth {
        let (before, after) = (ends(tooth, &first), ends(tooth, &last));
        for end in (0..2).filter(|end| before[*end] != after[*end]) {
            let is_in = |ahead| ends(tooth, &at(ahead))[end];
            found.push(crossing(is_in, before[end]));
        }
    }
    found.sort_by(f64::total_cmp);
    found
}

/// Where a condition changes that holds at the end of a step if it does not at its start.
fn crossing(holds: impl Fn(f64) -> bool, at_start: bool) -> f64 {
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
