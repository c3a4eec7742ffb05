//! Measured drive forces as they are compared: filtered, without what ends and gaps spoil.

use super::inputs::{JointQuantity, joint_channel};
use truecut_arm::Robot;
use truecut_recording::Measured;
use truecut_recording::filter::Butterworth;

/// Order of the filters of coordinates and of drive forces; run forward and backward they act
/// twice.
pub(super) const FILTER_ORDER: usize = 4;

/// Periods of the cutoffs of coordinates and of drive forces within which the ends of a record
/// spoil the samples: the acceleration turns its sign where the coordinates are reflected, and the
/// second filter carries that on. From there on it errs by less than 0.2 % of its deviation.
const SPOILT_BY_ENDS: [f64; 2] = [1.0, 2.0];

/// The measured drive forces through `filter`. A gap spoils the samples within a period of the
/// cutoff; ends do so for longer, since coordinates are differentiated twice there.
pub(super) fn filtered(
    measured: &Measured,
    robot: &Robot,
    joints: &[usize],
    filter: &Butterworth,
    cutoffs_hz: [f64; 2],
) -> Measured {
    let periods = |count: f64, hz: f64| (count * measured.rate_hz() / hz).ceil() as usize;
    let reach = periods(1.0, cutoffs_hz[1]);
    let [first, second] = [0, 1].map(|i| periods(SPOILT_BY_ENDS[i], cutoffs_hz[i]));
    let end = first + second;
    let mut channels = Vec::new();
    for &joint in joints {
        let name = joint_channel(robot, joint, JointQuantity::Drive);
        let found = measured
            .channels
            .iter()
            .find(|channel| channel.spec.name == name);
        channels.extend(found.cloned());
    }
    for channel in &mut channels {
        channel.values = filter.zero_phase(&channel.values);
        let share = Butterworth::white_share(FILTER_ORDER, cutoffs_hz[1], measured.rate_hz());
        channel.noise = channel.noise.map(|noise| share * noise);
        let gaps = std::mem::replace(&mut channel.valid, vec![true; measured.time_s.len()]);
        let last = gaps.len() - 1;
        channel.valid[..=end.min(last)].fill(false);
        channel.valid[last - end.min(last)..].fill(false);
        for k in (0..gaps.len()).filter(|k| !gaps[*k]) {
            let beyond = (k + reach + 1).min(gaps.len());
            channel.valid[k.saturating_sub(reach)..beyond].fill(false);
        }
    }
    Measured {
        channels,
        ..measured.clone()
    }
}
