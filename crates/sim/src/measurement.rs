//! The effects on sensors and their clock as one model of each channel.
#![deny(clippy::wildcard_enum_match_arm)]

pub use truecut_core::sensor::ChannelModel;
use truecut_scenario::effect::{ClockEffect, Effect, SensorEffect, Typed};

/// How channels end that say what a joint is told.
const COMMAND: &str = ".command";

/// What stands between what happens and what is recorded of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sensors {
    /// How late all that is measured comes, s.
    clock_delay_s: f64,
    /// Channels with a sensor of their own, with the entry in the scenario.
    channels: Vec<(String, ChannelModel)>,
}

impl Sensors {
    /// Those among the effects.
    pub fn new<'a>(effects: impl IntoIterator<Item = &'a Effect>) -> Sensors {
        let mut sensors = Sensors::default();
        for effect in effects {
            match effect.typed() {
                Some(Typed::Sensor(channel, effect)) => sensors.add(channel, effect),
                Some(Typed::Clock(effect)) => sensors.add_clock(effect),
                Some(
                    Typed::Joint(..)
                    | Typed::Curve(..)
                    | Typed::Robot(_)
                    | Typed::Base(..)
                    | Typed::Cutting(_)
                    | Typed::Milling(_)
                    | Typed::Foot(_)
                    | Typed::Wheel(_),
                )
                | None => {}
            }
        }
        sensors
    }

    /// What is made of a channel that is measured. Commands are told, not measured: the clock's
    /// delay is one against them.
    pub fn of(&self, channel: &str) -> ChannelModel {
        let own = self.own(channel);
        if channel.ends_with(COMMAND) {
            return own;
        }
        ChannelModel {
            delay_s: own.delay_s + self.clock_delay_s,
            ..own
        }
    }

    /// What a channel's own sensor makes of it.
    pub(crate) fn own(&self, channel: &str) -> ChannelModel {
        let known = self.channels.iter().find(|(name, _)| name == channel);
        known.map_or_else(ChannelModel::default, |(_, model)| *model)
    }

    pub(crate) fn add_clock(&mut self, effect: ClockEffect) {
        match effect {
            ClockEffect::Delay { delay_s } => self.clock_delay_s = delay_s,
            // Of the motion that is measured, not of what sensors make of it.
            ClockEffect::Rate { .. } => {}
        }
    }

    pub(crate) fn add(&mut self, channel: &str, effect: SensorEffect) {
        let known = self.channels.iter().position(|(name, _)| name == channel);
        let at = known.unwrap_or(self.channels.len());
        if known.is_none() {
            let own = (channel.to_owned(), ChannelModel::default());
            self.channels.push(own);
        }
        let model = &mut self.channels[at].1;
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
}
