//! The effects on a sensor as one model of its channel.
#![deny(clippy::wildcard_enum_match_arm)]

pub use truecut_core::sensor::ChannelModel;
use truecut_scenario::effect::{Effect, SensorEffect, Typed};

/// What sensors with these effects make of a channel.
pub fn channel_model<'a>(
    effects: impl IntoIterator<Item = &'a Effect>,
    channel: &str,
) -> ChannelModel {
    let mut model = ChannelModel::default();
    for effect in effects {
        if let Some(Typed::Sensor(name, effect)) = effect.typed()
            && name == channel
        {
            add(&mut model, effect);
        }
    }
    model
}

/// Takes over one effect.
pub(crate) fn add(model: &mut ChannelModel, effect: SensorEffect) {
    match effect {
        SensorEffect::Delay { delay_s } => model.delay_s = delay_s,
        SensorEffect::Gain { factor } => model.gain = factor,
        SensorEffect::Offset { offset } => model.offset = offset,
        SensorEffect::Drift {
            amplitude,
            time_constant_s,
        } => model.drift = Some((amplitude, time_constant_s)),
        SensorEffect::LowPass { time_constant_s } => model.low_pass_s = time_constant_s,
    }
}
