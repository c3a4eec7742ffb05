//! The list of all effects: to add one, add its entry here and follow the compiler.
//!
//! An entry reads: kind, name in files, name in its family, models in which it acts, the kind that
//! it holds as a limit, the signal that its trace follows, what it is; then its values with
//! meaning, key, unit, neutral value and bounds.

use super::define::effects;
use super::parameter::{described, factor, geometric, joint, same};
use super::{Model, ParameterInfo, Signal, TargetKind};
use crate::effect::{Effect, Target};
use truecut_recording::Unit;

/// What is said of one kind of effect.
pub(super) struct Entry {
    pub name: &'static str,
    pub family: Family,
    pub target: TargetKind,
    pub description: &'static str,
    pub parameters: &'static [ParameterInfo],
    pub models: &'static [Model],
    pub limits: &'static [EffectKind],
    pub follows: Option<Signal>,
}

/// Frequencies from which a tool's mode is looked for, a twelfth apart: one struck by every tooth
/// rings for some periods, and a model that is further out of tune is out of phase before the end.
const TOOL_FREQUENCIES_HZ: [f64; 64] = geometric(30.0, 13.0 / 12.0);

effects! {
/// The law of one joint.
Joint: JointEffect on Joint(joint: usize = *joint) {
    JointStiffness "joint_stiffness" is Stiffness in [Driven] follows Load:
        "The transmission is softer or stiffer than its data sheet says." {
        factor: "Times the nominal stiffness" = factor(0.05, 20.0).starts(&[0.7, 1.4]),
    }
    JointDamping "joint_damping" is Damping in [Driven] follows Load:
        "The transmission damps less or more." {
        factor: "Times the nominal damping" = factor(0.0, 50.0).starts(&[0.5, 2.0]),
    }
    JointViscous "joint_viscous" is Viscous in [Driven, Free, Inverse] follows Speed:
        "Viscous friction of the bearings, on the link's velocity." {
        viscous: "Friction per velocity"
            = joint("viscous_n_s_per_m", Unit::NewtonSecondPerMetre,
                "viscous_n_m_s_per_rad", Unit::NewtonMetreSecondPerRadian, 0.0, 0.0, 1e9),
    }
    JointCoulomb "joint_coulomb" is Coulomb in [Driven, Free, Inverse] follows Speed:
        "Dry friction of the bearings, on the link." {
        friction: "Level"
            = joint("friction_n", Unit::Newton,
                "friction_n_m", Unit::NewtonMetre, 0.0, 0.0, 1e9),
    }
    JointLoadFriction "joint_load_friction" is LoadFriction in [Driven, Inverse]:
        "Dry friction that grows with the torque that the transmission passes on." {
        share: "Friction per torque (force) passed on"
            = same("share", Unit::One, 0.0, 0.0, 0.9),
    }
    JointAsymmetricViscous "joint_asymmetric_viscous" is AsymmetricViscous
        in [Driven, Free, Inverse] beyond JointViscous follows Speed:
        "Viscous friction that depends on the direction." {
        positive: "While the coordinate grows"
            = joint("viscous_positive_n_s_per_m", Unit::NewtonSecondPerMetre,
                "viscous_positive_n_m_s_per_rad", Unit::NewtonMetreSecondPerRadian, 0.0, 0.0, 1e9),
        negative: "While it falls"
            = joint("viscous_negative_n_s_per_m", Unit::NewtonSecondPerMetre,
                "viscous_negative_n_m_s_per_rad", Unit::NewtonMetreSecondPerRadian, 0.0, 0.0, 1e9),
    }
    JointAsymmetricCoulomb "joint_asymmetric_coulomb" is AsymmetricCoulomb
        in [Driven, Free, Inverse] beyond JointCoulomb follows Speed:
        "Dry friction that depends on the direction." {
        positive: "While the coordinate grows"
            = joint("friction_positive_n", Unit::Newton,
                "friction_positive_n_m", Unit::NewtonMetre, 0.0, 0.0, 1e9),
        negative: "While it falls"
            = joint("friction_negative_n", Unit::Newton,
                "friction_negative_n_m", Unit::NewtonMetre, 0.0, 0.0, 1e9),
    }
    JointStribeck "joint_stribeck" is Stribeck
        in [Driven, Free, Inverse] beyond JointCoulomb follows Speed:
        "Dry friction that is higher at low speed: `excess exp(-(v / speed)^2)`, \
         beyond Coulomb's." {
        excess: "At standstill, beyond Coulomb's level"
            = joint("excess_n", Unit::Newton, "excess_n_m", Unit::NewtonMetre, 0.0, 0.0, 1e9),
        speed: "Speed by which the excess has fallen to 37 %"
            = joint("speed_m_per_s", Unit::MetrePerSecond,
                "speed_rad_per_s", Unit::RadianPerSecond, 0.01, 1e-6, 1000.0)
                .shape().starts(&[0.005, 0.02, 0.05, 0.12]),
    }
    JointBacklash "joint_backlash" is Backlash in [Driven] follows Load:
        "Play between motor and link." {
        gap: "Full width of the play"
            = joint("gap_m", Unit::Metre,
                "gap_rad", Unit::Radian, 0.0, 0.0, 1.0).starts(&[0.0002, 0.0006, 0.002]),
    }
    JointHysteresis "joint_hysteresis" is Hysteresis in [Driven] beyond JointCoulomb follows Load:
        "Elastic-plastic friction inside the gear (Bouc-Wen), on the wind-up." {
        amplitude: "Force at which the loop saturates"
            = joint("amplitude_n", Unit::Newton,
                "amplitude_n_m", Unit::NewtonMetre, 0.0, 0.0, 1e9),
        yield_windup: "Wind-up over which it builds up"
            = joint("yield_windup_m", Unit::Metre,
                "yield_windup_rad", Unit::Radian, 0.0001, 1e-9, 1.0)
                .shape().starts(&[3e-5, 0.0003, 0.003]),
    }
    JointCubicStiffness "joint_cubic_stiffness" is CubicStiffness in [Driven] follows Load:
        "The transmission stiffens with its wind-up: `cubic w^3` beyond the linear part." {
        cubic: "Coefficient, per square of the wind-up"
            = joint("cubic_n_per_m3", Unit::NewtonPerCubicMetre,
                "cubic_n_m_per_rad3", Unit::NewtonMetrePerCubicRadian, 0.0, -1e15, 1e15),
    }
    JointRipple "joint_ripple" is Ripple in [Driven] follows Angle:
        "Transmission error that repeats with the motor angle: `amplitude sin(cycles q + phase)`." {
        cosine: "Amplitude of the cosine"
            = joint("cosine_m", Unit::Metre, "cosine_rad", Unit::Radian, 0.0, -0.1, 0.1),
        sine: "Amplitude of the sine"
            = joint("sine_m", Unit::Metre, "sine_rad", Unit::Radian, 0.0, -0.1, 0.1),
        cycles: "Cycles per 2 pi of the joint's coordinate, or per metre"
            = same("cycles", Unit::One, 1.0, 0.1, 10000.0)
                .shape().starts(&[1.0, 2.0, 10.0, 50.0, 80.0, 100.0, 120.0, 160.0]),
    }
    JointCounterbalance "joint_counterbalance" is Counterbalance in [Driven, Free, Inverse]:
        "A spring that balances the link: torque `cosine cos q + sine sin q`." {
        cosine: "Amplitude of the cosine"
            = joint("cosine_n", Unit::Newton, "cosine_n_m", Unit::NewtonMetre, 0.0, -1e9, 1e9),
        sine: "Amplitude of the sine"
            = joint("sine_n", Unit::Newton, "sine_n_m", Unit::NewtonMetre, 0.0, -1e9, 1e9),
    }
    JointOffset "joint_offset" is Offset in [Driven, Free, Inverse]:
        "A constant drive force: offset of an amplifier, or a load left out." {
        force: "On the link"
            = joint("force_n", Unit::Newton, "force_n_m", Unit::NewtonMetre, 0.0, -1e9, 1e9),
    }
    JointZero "joint_zero" is Zero in [Driven, Free, Inverse]:
        "The zero of the joint is off: the link stands beyond what is reported and commanded." {
        offset: "True coordinate less the reported one"
            = joint("offset_m", Unit::Metre, "offset_rad", Unit::Radian, 0.0, -1.6, 1.6),
    }
    LinkMass "link_mass" is LinkMass in [Driven, Free, Inverse]:
        "The link that the joint moves is heavier or lighter than its file says; its centre stays." {
        factor: "Times the nominal mass and inertia about the centre of mass" = factor(0.05, 20.0).starts(&[1.1]),
    }
    LinkCenter "link_center" is LinkCenter in [Driven, Free, Inverse]:
        "The centre of mass of the link that the joint moves is not where its file says." {
        x: "True place less that of the file, in the link's frame" = same("x_m", Unit::Metre, 0.0, -5.0, 5.0),
        y: "True place less that of the file, in the link's frame" = same("y_m", Unit::Metre, 0.0, -5.0, 5.0),
        z: "True place less that of the file, in the link's frame" = same("z_m", Unit::Metre, 0.0, -5.0, 5.0),
    }
    LinkLength "link_length" is LinkLength in [Driven, Free, Inverse]:
        "What the link that the joint moves carries, the next joint or the flange, stands elsewhere on it than its file says." {
        x: "True place less that of the file, in the link's frame" = same("x_m", Unit::Metre, 0.0, -5.0, 5.0),
        y: "True place less that of the file, in the link's frame" = same("y_m", Unit::Metre, 0.0, -5.0, 5.0),
        z: "True place less that of the file, in the link's frame" = same("z_m", Unit::Metre, 0.0, -5.0, 5.0),
    }
    JointRotor "joint_rotor" is Rotor in [Driven, Inverse]:
        "The motor's rotor, seen through its gear, is not that of the robot's file." {
        inertia: "True inertia (mass) less that of the file, on the gear's joint side"
            = joint("mass_kg", Unit::Kilogram, "inertia_kg_m2", Unit::KilogramSquareMetre, 0.0, -1e6, 1e6),
    }
}
/// A law of a joint without a name, by values at even places over its position or its speed. Of
/// these the named one is the first; the whole is [`Effect::curve`].
Curve: CurveEffect on Joint(joint: usize = *joint) {
    JointPositionCurve "joint_position_curve" is Position in [Driven, Free, Inverse]:
        "A force on the link that follows its position: a natural cubic spline, constant beyond its ends." {
        from: "Position of the first value"
            = joint("from_m", Unit::Metre, "from_rad", Unit::Radian, 0.0, -1e4, 1e4)
                .shape(),
        to: "Position of the last value"
            = joint("to_m", Unit::Metre, "to_rad", Unit::Radian, 1.0, -1e4, 1e4)
                .shape(),
        value: "Values at even places, a list"
            = joint("forces_n", Unit::Newton, "torques_n_m", Unit::NewtonMetre, 0.0, -1e9, 1e9),
    }
    JointFrictionByPosition "joint_friction_by_position" is FrictionByPosition in [Driven, Free, Inverse]:
        "Dry friction that follows the position, beyond the other: a natural cubic spline; all friction \
         together is never below zero." {
        from: "Position of the first value"
            = joint("from_m", Unit::Metre, "from_rad", Unit::Radian, 0.0, -1e4, 1e4)
                .shape(),
        to: "Position of the last value"
            = joint("to_m", Unit::Metre, "to_rad", Unit::Radian, 1.0, -1e4, 1e4)
                .shape(),
        value: "Values at even places, a list"
            = joint("frictions_n", Unit::Newton, "frictions_n_m", Unit::NewtonMetre, 0.0, -1e9, 1e9),
    }
    JointFrictionBySpeed "joint_friction_by_speed" is FrictionBySpeed in [Driven, Free, Inverse]:
        "Friction that follows the speed, in both directions alike, beyond the other: a natural cubic \
         spline; all friction together is never below zero." {
        from: "Speed of the first value"
            = joint("from_m_per_s", Unit::MetrePerSecond, "from_rad_per_s", Unit::RadianPerSecond, 0.0, 0.0, 1e4)
                .shape(),
        to: "Speed of the last value"
            = joint("to_m_per_s", Unit::MetrePerSecond, "to_rad_per_s", Unit::RadianPerSecond, 1.0, 0.0, 1e4)
                .shape(),
        value: "Values at even places, a list"
            = joint("frictions_n", Unit::Newton, "frictions_n_m", Unit::NewtonMetre, 0.0, -1e9, 1e9),
    }
}
/// The build of the robot.
Robot: RobotEffect on Whole {
    Payload "payload" is Payload in [Driven, Free, Inverse]: "A mass at the flange." {
        mass_kg: "Mass" = same("mass_kg", Unit::Kilogram, 0.0, -1000.0, 10000.0),
        center_x_m: "Its centre in the flange frame"
            = same("center_x_m", Unit::Metre, 0.0, -5.0, 5.0).shape(),
        center_y_m: "Its centre in the flange frame"
            = same("center_y_m", Unit::Metre, 0.0, -5.0, 5.0).shape(),
        center_z_m: "Its centre in the flange frame"
            = same("center_z_m", Unit::Metre, 0.0, -5.0, 5.0).shape(),
    }
}
/// The base under the robot.
Base: BaseEffect on Axis(axis: usize = *axis) {
    BaseCompliance "base_compliance" is Compliance in [Driven, Free]:
        "The base tilts about a world axis under load." {
        compliance_rad_per_n_m: "Tilt per moment"
            = same("compliance_rad_per_n_m", Unit::RadianPerNewtonMetre, 0.0, 0.0, 1.0),
    }
    BaseTilt "base_tilt" is Tilt in [Driven, Free, Inverse]:
        "The base does not stand level: it is turned about a world axis, and gravity with it." {
        angle_rad: "Angle of the base about the axis"
            = same("angle_rad", Unit::Radian, 0.0, -1.6, 1.6),
    }
}
/// Cutting edge and spindle.
Cutting: CuttingEffect on Whole {
    CuttingCoefficient "cutting_coefficient" is Coefficient in [Driven, Free]:
        "Cutting takes more or less force per chip area." {
        factor: "Times the nominal coefficients" = factor(0.05, 20.0).starts(&[0.8, 1.25]),
    }
    CuttingEdgeForce "cutting_edge_force" is EdgeForce in [Driven, Free]:
        "Force that acts while the edge is engaged, whatever the chip: a blunt edge." {
        axial_n_per_m: "Per edge length"
            = same("axial_n_per_m", Unit::NewtonPerMetre, 0.0, 0.0, 1e9),
        radial_n_per_m: "Per edge length"
            = same("radial_n_per_m", Unit::NewtonPerMetre, 0.0, 0.0, 1e9),
        tangential_n_per_m: "Per edge length"
            = same("tangential_n_per_m", Unit::NewtonPerMetre, 0.0, 0.0, 1e9),
    }
    CuttingRunout "cutting_runout" is Runout in [Driven, Free, Steady]:
        "The tool turns about an axis beside its own: once per revolution." {
        cosine_m: "Offset towards the first edge"
            = same("cosine_m", Unit::Metre, 0.0, -0.01, 0.01),
        sine_m: "Offset a quarter of a turn ahead of it"
            = same("sine_m", Unit::Metre, 0.0, -0.01, 0.01),
    }
    CuttingHoleOffset "cutting_hole_offset" is HoleOffset in [Driven, Free]:
        "The hole is not where the program has it: the rim is met deeper on one side." {
        y_m: "Along process Y" = same("y_m", Unit::Metre, 0.0, -0.01, 0.01),
        z_m: "Along process Z" = same("z_m", Unit::Metre, 0.0, -0.01, 0.01),
    }
    CuttingWornTooth "cutting_worn_tooth" is WornTooth in [Driven, Free]:
        "One edge stands back, or is missing." {
        recess_m: "How far the first edge stands back, along the feed"
            = same("recess_m", Unit::Metre, 0.0, 0.0, 0.01),
    }
    CuttingWear "cutting_wear" is Wear in [Driven, Free]:
        "Forces grow with the path that the edge has cut." {
        growth_per_m: "Relative growth of the coefficients per metre of path"
            = same("growth_per_m", Unit::PerMetre, 0.0, 0.0, 1000.0),
    }
    CuttingDepthOffset "cutting_depth_offset" is DepthOffset in [Driven, Free]:
        "Touch-down was taken too early or too late." {
        depth_m: "Additional depth" = same("depth_m", Unit::Metre, 0.0, -0.01, 0.01),
    }
    SpindleSpeed "spindle_speed" is SpindleSpeed in [Driven, Free]:
        "The spindle turns slower or faster than commanded." {
        factor: "Times the commanded speed"
            = factor(0.5, 1.5).starts(&[0.97, 0.98, 0.99, 0.996, 1.004, 1.01, 1.02, 1.03]),
    }
}
/// An end mill.
Milling: MillingEffect on Whole {
    MillingProcessDamping "milling_process_damping" is ProcessDamping in [Driven, Free]:
        "Worn flanks resist the velocity of their edges: a radial force per slope of the path." {
        per_slope_n_per_m: "Per height of the edge and slope, a quarter of the resistance to \
                            indentation times the square of the wear land"
            = same("per_slope_n_per_m", Unit::NewtonPerMetre, 0.0, 0.0, 1e9),
    }
    ToolMode "tool_mode" is ToolMode in [Driven, Free]:
        "Tool, holder and spindle bend, alike in all directions across the tool axis." {
        compliance_m_per_n: "Deflection of the tip per force"
            = same("compliance_m_per_n", Unit::MetrePerNewton, 0.0, 0.0, 1e-3),
        frequency_hz: "Natural frequency with the arm's tool point held"
            = same("frequency_hz", Unit::Hertz, 500.0, 5.0, 20000.0)
                .shape().starts(&TOOL_FREQUENCIES_HZ),
        damping_ratio: "Damping ratio"
            = same("damping_ratio", Unit::One, 0.03, 0.0, 0.9).shape(),
    }
}
/// The pressure foot.
Foot: FootEffect on Whole {
    FootFriction "foot_friction" is Friction in [Driven, Free] follows Load:
        "The foot rubs more or less." {
        factor: "Times the nominal friction coefficient"
            = factor(0.0, 20.0).starts(&[0.7, 1.4]),
    }
    FootFrictionFalling "foot_friction_falling" is FrictionFalling
        in [Driven, Free] beyond FootFriction follows Load:
        "Friction of the foot falls with its speed: `1 - drop (1 - exp(-v / speed))`." {
        drop: "Part lost at high speed" = same("drop", Unit::One, 0.0, 0.0, 1.0).starts(&[0.3]),
        speed_m_per_s: "Speed over which it falls"
            = same("speed_m_per_s", Unit::MetrePerSecond, 0.001, 1e-6, 10.0)
                .shape().starts(&[0.0005, 0.002, 0.01]),
    }
    FootPressureLoss "foot_pressure_loss" is PressureLoss in [Driven, Free] follows Load:
        "The supply pressure sinks during the pass." {
        rate_per_s: "Part of the pressure lost per second"
            = same("rate_per_s", Unit::PerSecond, 0.0, 0.0, 10.0).starts(&[0.05]),
    }
    FootSealStiction "foot_seal_stiction" is SealStiction in [Driven, Free] follows Load:
        "The seals hold more than their data sheet says." {
        force_n: "Beyond the nominal seal stiction"
            = same("force_n", Unit::Newton, 0.0, -10000.0, 10000.0),
    }
}
/// The polishing wheel, belt or brush.
Wheel: WheelEffect on Whole {
    WheelStiffness "wheel_stiffness" is Stiffness in [Driven, Free]:
        "The wheel is softer or stiffer." {
        factor: "Times the nominal contact stiffness" = factor(0.05, 20.0).starts(&[0.7, 1.4]),
    }
    WheelEccentricity "wheel_eccentricity" is Eccentricity in [Driven, Free]:
        "The wheel runs out: once per revolution." {
        cosine_m: "At the contact when the wheel starts; \
                   of a wheel in precession along the tool's x axis"
            = same("cosine_m", Unit::Metre, 0.0, -0.01, 0.01),
        sine_m: "A quarter of a turn later; of a wheel in precession along the tool's y axis"
            = same("sine_m", Unit::Metre, 0.0, -0.01, 0.01),
    }
    WheelFriction "wheel_friction" is Friction in [Driven, Free]:
        "The wheel rubs more or less." {
        factor: "Times the nominal friction coefficient"
            = factor(0.0, 20.0).starts(&[0.7, 1.4]),
    }
    WheelRemoval "wheel_removal" is Removal in [Driven, Free]:
        "The wheel takes off more or less: abrasive worn, slurry thin." {
        factor: "Times the nominal Preston coefficient"
            = factor(0.0, 100.0).starts(&[0.7, 1.4]),
    }
    WheelEdgeGrains "wheel_edge_grains" is EdgeGrains in [Driven, Free]:
        "Grains jam at edges over which the wheel runs inward: their mean force against it." {
        share: "Part of the edge's force along the normal, met square on"
            = same("share", Unit::One, 0.0, 0.0, 10.0),
    }
    WheelForceOffset "wheel_force_offset" is ForceOffset in [Driven, Free]:
        "The force control holds another force than it is told to." {
        force_n: "Beyond the force that it is told"
            = same("force_n", Unit::Newton, 0.0, -10000.0, 10000.0),
    }
    WheelForceStiction "wheel_force_stiction" is ForceStiction in [Driven, Free]:
        "The carrier of the force control sticks: what lacks less than that stays." {
        force_n: "Dry friction of the carrier"
            = same("force_n", Unit::Newton, 0.0, 0.0, 10000.0),
    }
}
/// The clock of the measured data.
Clock: ClockEffect on Whole {
    ClockDelay "clock_delay" is Delay in [Driven, Free, Inverse]:
        "All that is measured comes late against the commands: two clocks, or late commands." {
        delay_s: "Of all measured channels"
            = same("delay_s", Unit::Second, 0.0, -1.0, 1.0).starts(&[0.002, 0.01]),
    }
    ClockRate "clock_rate" is Rate in [Inverse]:
        "The clock of the data runs slow or fast: the motion is faster or slower than its times say." {
        factor: "Speed of the motion over that by the times of the data" = factor(0.5, 2.0).starts(&[1.01]),
    }
}
/// What a sensor makes of a channel.
Sensor: SensorEffect on Channel(channel: &'a str = channel) {
    SensorDelay "sensor_delay" is Delay in [Driven, Free, Inverse]:
        "The channel arrives late." {
        delay_s: "Delay" = same("delay_s", Unit::Second, 0.0, -1.0, 1.0).starts(&[0.002, 0.01]),
    }
    SensorGain "sensor_gain" is Gain in [Driven, Free, Inverse]: "The channel's gain is off." {
        factor: "Times the true value" = factor(-100.0, 100.0).starts(&[1.1]),
    }
    SensorOffset "sensor_offset" is Offset in [Driven, Free, Inverse]:
        "The channel's zero is off." {
        offset: "In the channel's unit" = same("offset", Unit::One, 0.0, -1e12, 1e12),
    }
    SensorDrift "sensor_drift" is Drift in [Driven, Free, Steady] beyond SensorOffset:
        "The channel's zero creeps as it warms up: `amplitude (1 - exp(-t / time))`." {
        amplitude: "In the channel's unit, when warm"
            = same("amplitude", Unit::One, 0.0, -1e12, 1e12),
        time_constant_s: "Warming up"
            = same("time_constant_s", Unit::Second, 10.0, 0.01, 1e5)
                .shape().starts(&[1.0, 5.0, 50.0]),
    }
    SensorLowPass "sensor_low_pass" is LowPass in [Driven, Free]:
        "The channel is smoothed by a filter of first order." {
        time_constant_s: "Of the filter"
            = same("time_constant_s", Unit::Second, 0.0, 0.0, 10.0).starts(&[0.002, 0.01]),
    }
}
}
