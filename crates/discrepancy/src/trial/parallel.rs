//! Parallel decimation: of filtered drive forces, measured and predicted alike, as many samples as
//! the filter leaves worth of information. (`gautier1997`.)
//!
//! Between the filter's cutoff and half the rate of the data nothing is left but rounding. A search
//! that whitens noise would weigh that as much as the motion.

use truecut_recording::measured::Measured;
use truecut_scenario::{ProcessSpec, ReplayMode, Scenario};

/// Samples kept per period of the cutoff. At 2 the cutoff is half the rate of what is kept: the
/// spectrum is filled to its end.
const PER_PERIOD: f64 = 2.0;

/// Samples of the data for one that is kept.
pub(crate) fn spacing(scenario: &Scenario, rate_hz: f64) -> usize {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return 1;
    };
    match replay.mode {
        ReplayMode::Inverse {
            compare_cutoff_hz, ..
        } => ((rate_hz / (PER_PERIOD * compare_cutoff_hz)) as usize).max(1),
        _ => 1,
    }
}

/// Every so many-th sample of all channels.
pub(super) fn thinned(measured: &Measured, every: usize) -> Measured {
    let mut thinned = measured.clone();
    thinned.time_s = picked(&measured.time_s, every);
    for (channel, whole) in thinned.channels.iter_mut().zip(&measured.channels) {
        channel.values = picked(&whole.values, every);
        channel.valid = picked(&whole.valid, every);
    }
    thinned
}

/// Every so many-th value.
pub(crate) fn picked<T: Copy>(values: &[T], every: usize) -> Vec<T> {
    values.iter().step_by(every).copied().collect()
}
