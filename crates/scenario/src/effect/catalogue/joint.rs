//! Effects on the law of one joint.

use super::entry::{Entry, factor, joint, same};
use super::{Family, TargetKind};
use truecut_recording::Unit;

pub(super) const JOINT_STIFFNESS: Entry = Entry {
    name: "joint_stiffness",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "The transmission is softer or stiffer than its data sheet says.",
    parameters: &[factor(0.05, 20.0, "Times the nominal stiffness").starts(&[0.7, 1.4])],
};

pub(super) const JOINT_DAMPING: Entry = Entry {
    name: "joint_damping",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "The transmission damps less or more.",
    parameters: &[factor(0.0, 50.0, "Times the nominal damping").starts(&[0.5, 2.0])],
};

pub(super) const JOINT_VISCOUS: Entry = Entry {
    name: "joint_viscous",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Viscous friction of the bearings, on the link's velocity.",
    parameters: &[joint(
        "viscous_n_s_per_m",
        Unit::NewtonSecondPerMetre,
        "viscous_n_m_s_per_rad",
        Unit::NewtonMetreSecondPerRadian,
        0.0,
        0.0,
        1e9,
        "Friction per velocity",
    )],
};

pub(super) const JOINT_COULOMB: Entry = Entry {
    name: "joint_coulomb",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Dry friction of the bearings, on the link.",
    parameters: &[joint(
        "friction_n",
        Unit::Newton,
        "friction_n_m",
        Unit::NewtonMetre,
        0.0,
        0.0,
        1e9,
        "Level",
    )],
};

pub(super) const JOINT_LOAD_FRICTION: Entry = Entry {
    name: "joint_load_friction",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Dry friction that grows with the torque that the transmission passes on.",
    parameters: &[same(
        "share",
        Unit::One,
        0.0,
        0.0,
        0.9,
        "Friction per torque (force) passed on",
    )],
};

pub(super) const JOINT_ASYMMETRIC_VISCOUS: Entry = Entry {
    name: "joint_asymmetric_viscous",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Viscous friction that depends on the direction.",
    parameters: &[
        joint(
            "viscous_positive_n_s_per_m",
            Unit::NewtonSecondPerMetre,
            "viscous_positive_n_m_s_per_rad",
            Unit::NewtonMetreSecondPerRadian,
            0.0,
            0.0,
            1e9,
            "While the coordinate grows",
        ),
        joint(
            "viscous_negative_n_s_per_m",
            Unit::NewtonSecondPerMetre,
            "viscous_negative_n_m_s_per_rad",
            Unit::NewtonMetreSecondPerRadian,
            0.0,
            0.0,
            1e9,
            "While it falls",
        ),
    ],
};

pub(super) const JOINT_ASYMMETRIC_COULOMB: Entry = Entry {
    name: "joint_asymmetric_coulomb",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Dry friction that depends on the direction.",
    parameters: &[
        joint(
            "friction_positive_n",
            Unit::Newton,
            "friction_positive_n_m",
            Unit::NewtonMetre,
            0.0,
            0.0,
            1e9,
            "While the coordinate grows",
        ),
        joint(
            "friction_negative_n",
            Unit::Newton,
            "friction_negative_n_m",
            Unit::NewtonMetre,
            0.0,
            0.0,
            1e9,
            "While it falls",
        ),
    ],
};

pub(super) const JOINT_STRIBECK: Entry = Entry {
    name: "joint_stribeck",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Dry friction that is higher at low speed: `excess exp(-(v / speed)^2)`, beyond Coulomb's.",
    parameters: &[
        joint(
            "excess_n",
            Unit::Newton,
            "excess_n_m",
            Unit::NewtonMetre,
            0.0,
            0.0,
            1e9,
            "At standstill, beyond Coulomb's level",
        ),
        joint(
            "speed_m_per_s",
            Unit::MetrePerSecond,
            "speed_rad_per_s",
            Unit::RadianPerSecond,
            0.01,
            1e-6,
            1000.0,
            "Speed by which the excess has fallen to 37 %",
        )
        .shape()
        .starts(&[0.005, 0.02, 0.1]),
    ],
};

pub(super) const JOINT_BACKLASH: Entry = Entry {
    name: "joint_backlash",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Play between motor and link.",
    parameters: &[joint(
        "gap_m",
        Unit::Metre,
        "gap_rad",
        Unit::Radian,
        0.0,
        0.0,
        1.0,
        "Full width of the play",
    )
    .starts(&[0.0002, 0.0006, 0.002])],
};

pub(super) const JOINT_HYSTERESIS: Entry = Entry {
    name: "joint_hysteresis",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Elastic-plastic friction inside the gear (Bouc-Wen), on the wind-up.",
    parameters: &[
        joint(
            "amplitude_n",
            Unit::Newton,
            "amplitude_n_m",
            Unit::NewtonMetre,
            0.0,
            0.0,
            1e9,
            "Force at which the loop saturates",
        ),
        joint(
            "yield_windup_m",
            Unit::Metre,
            "yield_windup_rad",
            Unit::Radian,
            0.0001,
            1e-9,
            1.0,
            "Wind-up over which it builds up",
        )
        .shape()
        .starts(&[3e-5, 0.0003, 0.003]),
    ],
};

pub(super) const JOINT_CUBIC_STIFFNESS: Entry = Entry {
    name: "joint_cubic_stiffness",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "The transmission stiffens with its wind-up: `cubic w^3` beyond the linear part.",
    parameters: &[joint(
        "cubic_n_per_m3",
        Unit::NewtonPerCubicMetre,
        "cubic_n_m_per_rad3",
        Unit::NewtonMetrePerCubicRadian,
        0.0,
        -1e15,
        1e15,
        "Coefficient, per square of the wind-up",
    )],
};

pub(super) const JOINT_RIPPLE: Entry = Entry {
    name: "joint_ripple",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Transmission error that repeats with the motor angle: `amplitude sin(cycles q + phase)`.",
    parameters: &[
        joint(
            "cosine_m",
            Unit::Metre,
            "cosine_rad",
            Unit::Radian,
            0.0,
            -0.1,
            0.1,
            "Amplitude of the cosine",
        ),
        joint(
            "sine_m",
            Unit::Metre,
            "sine_rad",
            Unit::Radian,
            0.0,
            -0.1,
            0.1,
            "Amplitude of the sine",
        ),
        same(
            "cycles",
            Unit::One,
            1.0,
            0.1,
            10000.0,
            "Cycles per 2 pi of the joint's coordinate, or per metre",
        )
        .shape()
        .starts(&[1.0, 2.0, 10.0, 50.0, 80.0, 100.0, 120.0, 160.0]),
    ],
};

pub(super) const JOINT_COUNTERBALANCE: Entry = Entry {
    name: "joint_counterbalance",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "A spring that balances the link: torque `cosine cos q + sine sin q`.",
    parameters: &[
        joint(
            "cosine_n",
            Unit::Newton,
            "cosine_n_m",
            Unit::NewtonMetre,
            0.0,
            -1e9,
            1e9,
            "Amplitude of the cosine",
        ),
        joint(
            "sine_n",
            Unit::Newton,
            "sine_n_m",
            Unit::NewtonMetre,
            0.0,
            -1e9,
            1e9,
            "Amplitude of the sine",
        ),
    ],
};

pub(super) const JOINT_OFFSET: Entry = Entry {
    name: "joint_offset",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "A constant drive force: offset of an amplifier, or a load left out.",
    parameters: &[joint(
        "force_n",
        Unit::Newton,
        "force_n_m",
        Unit::NewtonMetre,
        0.0,
        -1e9,
        1e9,
        "On the link",
    )],
};
