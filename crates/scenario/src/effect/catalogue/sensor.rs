//! Effects of a sensor on its channel.

use super::entry::{Entry, factor, same};
use super::{Family, TargetKind};
use truecut_recording::Unit;

pub(super) const SENSOR_DELAY: Entry = Entry {
    name: "sensor_delay",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel arrives late.",
    parameters: &[same("delay_s", Unit::Second, 0.0, -1.0, 1.0, "Delay").starts(&[0.002, 0.01])],
};

pub(super) const SENSOR_GAIN: Entry = Entry {
    name: "sensor_gain",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel's gain is off.",
    parameters: &[factor(-100.0, 100.0, "Times the true value").starts(&[1.1])],
};

pub(super) const SENSOR_OFFSET: Entry = Entry {
    name: "sensor_offset",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel's zero is off.",
    parameters: &[same(
        "offset",
        Unit::One,
        0.0,
        -1e12,
        1e12,
        "In the channel's unit",
    )],
};

pub(super) const SENSOR_DRIFT: Entry = Entry {
    name: "sensor_drift",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel's zero creeps as it warms up: `amplitude (1 - exp(-t / time))`.",
    parameters: &[
        same(
            "amplitude",
            Unit::One,
            0.0,
            -1e12,
            1e12,
            "In the channel's unit, when warm",
        ),
        same(
            "time_constant_s",
            Unit::Second,
            10.0,
            0.01,
            1e5,
            "Warming up",
        )
        .shape()
        .starts(&[1.0, 5.0, 50.0]),
    ],
};

pub(super) const SENSOR_LOW_PASS: Entry = Entry {
    name: "sensor_low_pass",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel is smoothed by a filter of first order.",
    parameters: &[same(
        "time_constant_s",
        Unit::Second,
        0.0,
        0.0,
        10.0,
        "Of the filter",
    )
    .starts(&[0.002, 0.01])],
};
