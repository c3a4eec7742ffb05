//! Effects on cutting edge, pressure foot and wheel.

use super::entry::{Entry, factor, same};
use super::{Family, TargetKind};
use truecut_recording::Unit;

pub(super) const CUTTING_COEFFICIENT: Entry = Entry {
    name: "cutting_coefficient",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Cutting takes more or less force per chip area.",
    parameters: &[factor(0.05, 20.0, "Times the nominal coefficients").starts(&[0.8, 1.25])],
};

pub(super) const CUTTING_EDGE_FORCE: Entry = Entry {
    name: "cutting_edge_force",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Force that acts while the edge is engaged, whatever the chip: a blunt edge.",
    parameters: &[
        same(
            "axial_n_per_m",
            Unit::NewtonPerMetre,
            0.0,
            0.0,
            1e9,
            "Per edge length",
        ),
        same(
            "radial_n_per_m",
            Unit::NewtonPerMetre,
            0.0,
            0.0,
            1e9,
            "Per edge length",
        ),
        same(
            "tangential_n_per_m",
            Unit::NewtonPerMetre,
            0.0,
            0.0,
            1e9,
            "Per edge length",
        ),
    ],
};

pub(super) const CUTTING_RUNOUT: Entry = Entry {
    name: "cutting_runout",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "The tool turns about an axis beside its own: once per revolution.",
    parameters: &[
        same(
            "cosine_m",
            Unit::Metre,
            0.0,
            -0.01,
            0.01,
            "Offset towards the first edge",
        ),
        same(
            "sine_m",
            Unit::Metre,
            0.0,
            -0.01,
            0.01,
            "Offset a quarter of a turn ahead of it",
        ),
    ],
};

pub(super) const CUTTING_HOLE_OFFSET: Entry = Entry {
    name: "cutting_hole_offset",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "The hole is not where the program has it: the rim is met deeper on one side.",
    parameters: &[
        same("y_m", Unit::Metre, 0.0, -0.01, 0.01, "Along process Y"),
        same("z_m", Unit::Metre, 0.0, -0.01, 0.01, "Along process Z"),
    ],
};

pub(super) const CUTTING_WORN_TOOTH: Entry = Entry {
    name: "cutting_worn_tooth",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "One edge stands back, or is missing.",
    parameters: &[same(
        "recess_m",
        Unit::Metre,
        0.0,
        0.0,
        0.01,
        "How far the first edge stands back, along the feed",
    )],
};

pub(super) const CUTTING_WEAR: Entry = Entry {
    name: "cutting_wear",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Forces grow with the path that the edge has cut.",
    parameters: &[same(
        "growth_per_m",
        Unit::PerMetre,
        0.0,
        0.0,
        1000.0,
        "Relative growth of the coefficients per metre of path",
    )],
};

pub(super) const CUTTING_DEPTH_OFFSET: Entry = Entry {
    name: "cutting_depth_offset",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Touch-down was taken too early or too late.",
    parameters: &[same(
        "depth_m",
        Unit::Metre,
        0.0,
        -0.01,
        0.01,
        "Additional depth",
    )],
};

pub(super) const SPINDLE_SPEED: Entry = Entry {
    name: "spindle_speed",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "The spindle turns slower or faster than commanded.",
    parameters: &[factor(0.5, 1.5, "Times the commanded speed")
        .starts(&[0.97, 0.98, 0.99, 0.996, 1.004, 1.01, 1.02, 1.03])],
};

pub(super) const FOOT_FRICTION: Entry = Entry {
    name: "foot_friction",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "The foot rubs more or less.",
    parameters: &[factor(0.0, 20.0, "Times the nominal friction coefficient").starts(&[0.7, 1.4])],
};

pub(super) const FOOT_FRICTION_FALLING: Entry = Entry {
    name: "foot_friction_falling",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "Friction of the foot falls with its speed: `1 - drop (1 - exp(-v / speed))`.",
    parameters: &[
        same("drop", Unit::One, 0.0, 0.0, 1.0, "Part lost at high speed").starts(&[0.3]),
        same(
            "speed_m_per_s",
            Unit::MetrePerSecond,
            0.001,
            1e-6,
            10.0,
            "Speed over which it falls",
        )
        .shape()
        .starts(&[0.0005, 0.002, 0.01]),
    ],
};

pub(super) const FOOT_PRESSURE_LOSS: Entry = Entry {
    name: "foot_pressure_loss",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "The supply pressure sinks during the pass.",
    parameters: &[same(
        "rate_per_s",
        Unit::PerSecond,
        0.0,
        0.0,
        10.0,
        "Part of the pressure lost per second",
    )
    .starts(&[0.05])],
};

pub(super) const FOOT_SEAL_STICTION: Entry = Entry {
    name: "foot_seal_stiction",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "The seals hold more than their data sheet says.",
    parameters: &[same(
        "force_n",
        Unit::Newton,
        0.0,
        -10000.0,
        10000.0,
        "Beyond the nominal seal stiction",
    )],
};

pub(super) const WHEEL_STIFFNESS: Entry = Entry {
    name: "wheel_stiffness",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The wheel is softer or stiffer.",
    parameters: &[factor(0.05, 20.0, "Times the nominal contact stiffness").starts(&[0.7, 1.4])],
};

pub(super) const WHEEL_ECCENTRICITY: Entry = Entry {
    name: "wheel_eccentricity",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The wheel runs out: once per revolution.",
    parameters: &[
        same(
            "cosine_m",
            Unit::Metre,
            0.0,
            -0.01,
            0.01,
            "At the contact when the wheel starts; of a wheel in precession along the tool's x axis",
        ),
        same(
            "sine_m",
            Unit::Metre,
            0.0,
            -0.01,
            0.01,
            "A quarter of a turn later; of a wheel in precession along the tool's y axis",
        ),
    ],
};

pub(super) const WHEEL_FRICTION: Entry = Entry {
    name: "wheel_friction",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The wheel rubs more or less.",
    parameters: &[factor(0.0, 20.0, "Times the nominal friction coefficient").starts(&[0.7, 1.4])],
};

pub(super) const WHEEL_REMOVAL: Entry = Entry {
    name: "wheel_removal",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The wheel takes off more or less: abrasive worn, slurry thin.",
    parameters: &[factor(0.0, 100.0, "Times the nominal Preston coefficient").starts(&[0.7, 1.4])],
};

pub(super) const WHEEL_FORCE_OFFSET: Entry = Entry {
    name: "wheel_force_offset",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The force control holds another force than it is told to.",
    parameters: &[same(
        "force_n",
        Unit::Newton,
        0.0,
        -10000.0,
        10000.0,
        "Beyond the force that it is told",
    )],
};

pub(super) const WHEEL_FORCE_STICTION: Entry = Entry {
    name: "wheel_force_stiction",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The carrier of the force control sticks: what lacks less than that stays.",
    parameters: &[same(
        "force_n",
        Unit::Newton,
        0.0,
        0.0,
        10000.0,
        "Dry friction of the carrier",
    )],
};
