//! The catalogue: every kind of effect, its target, its parameters, their units and bounds.

use truecut_recording::Unit;

/// Where an effect belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Family {
    /// The law of one joint.
    Joint,
    /// The build of the robot.
    Robot,
    /// Cutting edge and spindle.
    Cutting,
    /// The pressure foot.
    Foot,
    /// The polishing wheel.
    Wheel,
    /// What a sensor makes of a channel.
    Sensor,
}

/// What an effect of a kind acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TargetKind {
    /// There is only one.
    Whole,
    /// Key `joint`.
    Joint,
    /// Key `axis`.
    Axis,
    /// Key `channel`.
    Channel,
}

/// One parameter of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Key in the file, for prismatic joints and whatever is not a joint. Ends in the unit, which is SI.
    pub key: &'static str,
    /// Key in the file for a rotary joint.
    pub rotary_key: &'static str,
    /// Unit, for prismatic joints and whatever is not a joint. [`Unit::One`] for the channel's own unit.
    pub unit: Unit,
    /// Unit for a rotary joint.
    pub rotary_unit: Unit,
    /// Value at which the effect changes nothing.
    pub neutral: f64,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// Whether it measures the effect's size. The others only shape it, and mean nothing at size zero.
    pub is_size: bool,
    /// Values worth starting a search from; empty where they follow from the data.
    pub starts: &'static [f64],
    /// One line.
    pub description: &'static str,
}
/// Every kind of effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum EffectKind {
    /// The transmission is softer or stiffer than its data sheet says.
    JointStiffness,
    /// The transmission damps less or more.
    JointDamping,
    /// Viscous friction of the bearings, on the link's velocity.
    JointViscous,
    /// Dry friction of the bearings, on the link.
    JointCoulomb,
    /// Viscous friction that depends on the direction.
    JointAsymmetricViscous,
    /// Dry friction that depends on the direction.
    JointAsymmetricCoulomb,
    /// Dry friction that is higher at low speed: `excess exp(-(v / speed)^2)`, beyond Coulomb's.
    JointStribeck,
    /// Play between motor and link.
    JointBacklash,
    /// Elastic-plastic friction inside the gear (Bouc-Wen), on the wind-up.
    JointHysteresis,
    /// The transmission stiffens with its wind-up: `cubic w^3` beyond the linear part.
    JointCubicStiffness,
    /// Transmission error that repeats with the motor angle: `amplitude sin(cycles q + phase)`.
    JointRipple,
    /// A spring that balances the link: torque `cosine cos q + sine sin q`.
    JointCounterbalance,
    /// A constant drive force: offset of an amplifier, or a load left out.
    JointOffset,
    /// A mass at the flange.
    Payload,
    /// The base tilts about a world axis under load.
    BaseCompliance,
    /// Cutting takes more or less force per chip area.
    CuttingCoefficient,
    /// Force that acts while the edge is engaged, whatever the chip: a blunt edge.
    CuttingEdgeForce,
    /// The tool turns about an axis beside its own: once per revolution.
    CuttingRunout,
    /// The hole is not where the program has it: the rim is met deeper on one side.
    CuttingHoleOffset,
    /// One edge stands back, or is missing.
    CuttingWornTooth,
    /// Forces grow with the path that the edge has cut.
    CuttingWear,
    /// Touch-down was taken too early or too late.
    CuttingDepthOffset,
    /// The spindle turns slower or faster than commanded.
    SpindleSpeed,
    /// The foot rubs more or less.
    FootFriction,
    /// Friction of the foot falls with its speed: `1 - drop (1 - exp(-v / speed))`.
    FootFrictionFalling,
    /// The supply pressure sinks during the pass.
    FootPressureLoss,
    /// The seals hold more than their data sheet says.
    FootSealStiction,
    /// The wheel is softer or stiffer.
    WheelStiffness,
    /// The wheel runs out: once per revolution.
    WheelEccentricity,
    /// The channel arrives late.
    SensorDelay,
    /// The channel's gain is off.
    SensorGain,
    /// The channel's zero is off.
    SensorOffset,
    /// The channel's zero creeps as it warms up: `amplitude (1 - exp(-t / time))`.
    SensorDrift,
    /// The channel is smoothed by a filter of first order.
    SensorLowPass,
}
impl EffectKind {
    /// All kinds.
    pub const ALL: &'static [EffectKind] = &[
        EffectKind::JointStiffness,
        EffectKind::JointDamping,
        EffectKind::JointViscous,
        EffectKind::JointCoulomb,
        EffectKind::JointAsymmetricViscous,
        EffectKind::JointAsymmetricCoulomb,
        EffectKind::JointStribeck,
        EffectKind::JointBacklash,
        EffectKind::JointHysteresis,
        EffectKind::JointCubicStiffness,
        EffectKind::JointRipple,
        EffectKind::JointCounterbalance,
        EffectKind::JointOffset,
        EffectKind::Payload,
        EffectKind::BaseCompliance,
        EffectKind::CuttingCoefficient,
        EffectKind::CuttingEdgeForce,
        EffectKind::CuttingRunout,
        EffectKind::CuttingHoleOffset,
        EffectKind::CuttingWornTooth,
        EffectKind::CuttingWear,
        EffectKind::CuttingDepthOffset,
        EffectKind::SpindleSpeed,
        EffectKind::FootFriction,
        EffectKind::FootFrictionFalling,
        EffectKind::FootPressureLoss,
        EffectKind::FootSealStiction,
        EffectKind::WheelStiffness,
        EffectKind::WheelEccentricity,
        EffectKind::SensorDelay,
        EffectKind::SensorGain,
        EffectKind::SensorOffset,
        EffectKind::SensorDrift,
        EffectKind::SensorLowPass,
    ];

    /// The kind's name in files.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<EffectKind> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Where it belongs.
    pub fn family(self) -> Family {
        self.entry().family
    }

    /// What it acts on.
    pub fn target(self) -> TargetKind {
        self.entry().target
    }

    /// One line for a reader.
    pub fn description(self) -> &'static str {
        self.entry().description
    }

    /// Its parameters.
    pub fn parameters(self) -> &'static [ParameterInfo] {
        self.entry().parameters
    }

    fn entry(self) -> &'static Entry {
        match self {
            EffectKind::JointStiffness => &JOINT_STIFFNESS,
            EffectKind::JointDamping => &JOINT_DAMPING,
            EffectKind::JointViscous => &JOINT_VISCOUS,
            EffectKind::JointCoulomb => &JOINT_COULOMB,
            EffectKind::JointAsymmetricViscous => &JOINT_ASYMMETRIC_VISCOUS,
            EffectKind::JointAsymmetricCoulomb => &JOINT_ASYMMETRIC_COULOMB,
            EffectKind::JointStribeck => &JOINT_STRIBECK,
            EffectKind::JointBacklash => &JOINT_BACKLASH,
            EffectKind::JointHysteresis => &JOINT_HYSTERESIS,
            EffectKind::JointCubicStiffness => &JOINT_CUBIC_STIFFNESS,
            EffectKind::JointRipple => &JOINT_RIPPLE,
            EffectKind::JointCounterbalance => &JOINT_COUNTERBALANCE,
            EffectKind::JointOffset => &JOINT_OFFSET,
            EffectKind::Payload => &PAYLOAD,
            EffectKind::BaseCompliance => &BASE_COMPLIANCE,
            EffectKind::CuttingCoefficient => &CUTTING_COEFFICIENT,
            EffectKind::CuttingEdgeForce => &CUTTING_EDGE_FORCE,
            EffectKind::CuttingRunout => &CUTTING_RUNOUT,
            EffectKind::CuttingHoleOffset => &CUTTING_HOLE_OFFSET,
            EffectKind::CuttingWornTooth => &CUTTING_WORN_TOOTH,
            EffectKind::CuttingWear => &CUTTING_WEAR,
            EffectKind::CuttingDepthOffset => &CUTTING_DEPTH_OFFSET,
            EffectKind::SpindleSpeed => &SPINDLE_SPEED,
            EffectKind::FootFriction => &FOOT_FRICTION,
            EffectKind::FootFrictionFalling => &FOOT_FRICTION_FALLING,
            EffectKind::FootPressureLoss => &FOOT_PRESSURE_LOSS,
            EffectKind::FootSealStiction => &FOOT_SEAL_STICTION,
            EffectKind::WheelStiffness => &WHEEL_STIFFNESS,
            EffectKind::WheelEccentricity => &WHEEL_ECCENTRICITY,
            EffectKind::SensorDelay => &SENSOR_DELAY,
            EffectKind::SensorGain => &SENSOR_GAIN,
            EffectKind::SensorOffset => &SENSOR_OFFSET,
            EffectKind::SensorDrift => &SENSOR_DRIFT,
            EffectKind::SensorLowPass => &SENSOR_LOW_PASS,
        }
    }
}

struct Entry {
    name: &'static str,
    family: Family,
    target: TargetKind,
    description: &'static str,
    parameters: &'static [ParameterInfo],
}

const JOINT_STIFFNESS: Entry = Entry {
    name: "joint_stiffness",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "The transmission is softer or stiffer than its data sheet says.",
    parameters: &[ParameterInfo {
        key: "factor",
        rotary_key: "factor",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 1.0,
        min: 0.05,
        max: 20.0,
        is_size: true,
        starts: &[0.7, 1.4],
        description: "Times the nominal stiffness",
    }],
};

const JOINT_DAMPING: Entry = Entry {
    name: "joint_damping",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "The transmission damps less or more.",
    parameters: &[ParameterInfo {
        key: "factor",
        rotary_key: "factor",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 1.0,
        min: 0.0,
        max: 50.0,
        is_size: true,
        starts: &[0.5, 2.0],
        description: "Times the nominal damping",
    }],
};

const JOINT_VISCOUS: Entry = Entry {
    name: "joint_viscous",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Viscous friction of the bearings, on the link's velocity.",
    parameters: &[ParameterInfo {
        key: "viscous_n_s_per_m",
        rotary_key: "viscous_n_m_s_per_rad",
        unit: Unit::NewtonSecondPerMetre,
        rotary_unit: Unit::NewtonMetreSecondPerRadian,
        neutral: 0.0,
        min: 0.0,
        max: 1000000000.0,
        is_size: true,
        starts: &[],
        description: "Friction per velocity",
    }],
};

const JOINT_COULOMB: Entry = Entry {
    name: "joint_coulomb",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Dry friction of the bearings, on the link.",
    parameters: &[ParameterInfo {
        key: "friction_n",
        rotary_key: "friction_n_m",
        unit: Unit::Newton,
        rotary_unit: Unit::NewtonMetre,
        neutral: 0.0,
        min: 0.0,
        max: 1000000000.0,
        is_size: true,
        starts: &[],
        description: "Level",
    }],
};

const JOINT_ASYMMETRIC_VISCOUS: Entry = Entry {
    name: "joint_asymmetric_viscous",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Viscous friction that depends on the direction.",
    parameters: &[
        ParameterInfo {
            key: "viscous_positive_n_s_per_m",
            rotary_key: "viscous_positive_n_m_s_per_rad",
            unit: Unit::NewtonSecondPerMetre,
            rotary_unit: Unit::NewtonMetreSecondPerRadian,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "While the coordinate grows",
        },
        ParameterInfo {
            key: "viscous_negative_n_s_per_m",
            rotary_key: "viscous_negative_n_m_s_per_rad",
            unit: Unit::NewtonSecondPerMetre,
            rotary_unit: Unit::NewtonMetreSecondPerRadian,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "While it falls",
        },
    ],
};

const JOINT_ASYMMETRIC_COULOMB: Entry = Entry {
    name: "joint_asymmetric_coulomb",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Dry friction that depends on the direction.",
    parameters: &[
        ParameterInfo {
            key: "friction_positive_n",
            rotary_key: "friction_positive_n_m",
            unit: Unit::Newton,
            rotary_unit: Unit::NewtonMetre,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "While the coordinate grows",
        },
        ParameterInfo {
            key: "friction_negative_n",
            rotary_key: "friction_negative_n_m",
            unit: Unit::Newton,
            rotary_unit: Unit::NewtonMetre,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "While it falls",
        },
    ],
};

const JOINT_STRIBECK: Entry = Entry {
    name: "joint_stribeck",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Dry friction that is higher at low speed: `excess exp(-(v / speed)^2)`, beyond Coulomb's.",
    parameters: &[
        ParameterInfo {
            key: "excess_n",
            rotary_key: "excess_n_m",
            unit: Unit::Newton,
            rotary_unit: Unit::NewtonMetre,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "At standstill, beyond Coulomb's level",
        },
        ParameterInfo {
            key: "speed_m_per_s",
            rotary_key: "speed_rad_per_s",
            unit: Unit::MetrePerSecond,
            rotary_unit: Unit::RadianPerSecond,
            neutral: 0.01,
            min: 1e-6,
            max: 1000.0,
            is_size: false,
            starts: &[0.005, 0.02, 0.1],
            description: "Speed by which the excess has fallen to 37 %",
        },
    ],
};

const JOINT_BACKLASH: Entry = Entry {
    name: "joint_backlash",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Play between motor and link.",
    parameters: &[ParameterInfo {
        key: "gap_m",
        rotary_key: "gap_rad",
        unit: Unit::Metre,
        rotary_unit: Unit::Radian,
        neutral: 0.0,
        min: 0.0,
        max: 1.0,
        is_size: true,
        starts: &[],
        description: "Full width of the play",
    }],
};

const JOINT_HYSTERESIS: Entry = Entry {
    name: "joint_hysteresis",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Elastic-plastic friction inside the gear (Bouc-Wen), on the wind-up.",
    parameters: &[
        ParameterInfo {
            key: "amplitude_n",
            rotary_key: "amplitude_n_m",
            unit: Unit::Newton,
            rotary_unit: Unit::NewtonMetre,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "Force at which the loop saturates",
        },
        ParameterInfo {
            key: "yield_windup_m",
            rotary_key: "yield_windup_rad",
            unit: Unit::Metre,
            rotary_unit: Unit::Radian,
            neutral: 0.0001,
            min: 1e-9,
            max: 1.0,
            is_size: false,
            starts: &[3e-5, 0.0003, 0.003],
            description: "Wind-up over which it builds up",
        },
    ],
};

const JOINT_CUBIC_STIFFNESS: Entry = Entry {
    name: "joint_cubic_stiffness",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "The transmission stiffens with its wind-up: `cubic w^3` beyond the linear part.",
    parameters: &[ParameterInfo {
        key: "cubic_n_per_m3",
        rotary_key: "cubic_n_m_per_rad3",
        unit: Unit::NewtonPerMetre,
        rotary_unit: Unit::NewtonMetrePerRadian,
        neutral: 0.0,
        min: -1000000000000000.0,
        max: 1000000000000000.0,
        is_size: true,
        starts: &[],
        description: "Coefficient, per square of the wind-up",
    }],
};

const JOINT_RIPPLE: Entry = Entry {
    name: "joint_ripple",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "Transmission error that repeats with the motor angle: `amplitude sin(cycles q + phase)`.",
    parameters: &[
        ParameterInfo {
            key: "cosine_m",
            rotary_key: "cosine_rad",
            unit: Unit::Metre,
            rotary_unit: Unit::Radian,
            neutral: 0.0,
            min: -0.1,
            max: 0.1,
            is_size: true,
            starts: &[],
            description: "Amplitude of the cosine",
        },
        ParameterInfo {
            key: "sine_m",
            rotary_key: "sine_rad",
            unit: Unit::Metre,
            rotary_unit: Unit::Radian,
            neutral: 0.0,
            min: -0.1,
            max: 0.1,
            is_size: true,
            starts: &[],
            description: "Amplitude of the sine",
        },
        ParameterInfo {
            key: "cycles",
            rotary_key: "cycles",
            unit: Unit::One,
            rotary_unit: Unit::One,
            neutral: 1.0,
            min: 0.1,
            max: 10000.0,
            is_size: false,
            starts: &[1.0, 2.0, 10.0, 50.0, 80.0, 100.0, 120.0, 160.0],
            description: "Cycles per 2 pi of the joint's coordinate, or per metre",
        },
    ],
};

const JOINT_COUNTERBALANCE: Entry = Entry {
    name: "joint_counterbalance",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "A spring that balances the link: torque `cosine cos q + sine sin q`.",
    parameters: &[
        ParameterInfo {
            key: "cosine_n",
            rotary_key: "cosine_n_m",
            unit: Unit::Newton,
            rotary_unit: Unit::NewtonMetre,
            neutral: 0.0,
            min: -1000000000.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "Amplitude of the cosine",
        },
        ParameterInfo {
            key: "sine_n",
            rotary_key: "sine_n_m",
            unit: Unit::Newton,
            rotary_unit: Unit::NewtonMetre,
            neutral: 0.0,
            min: -1000000000.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "Amplitude of the sine",
        },
    ],
};

const JOINT_OFFSET: Entry = Entry {
    name: "joint_offset",
    family: Family::Joint,
    target: TargetKind::Joint,
    description: "A constant drive force: offset of an amplifier, or a load left out.",
    parameters: &[ParameterInfo {
        key: "force_n",
        rotary_key: "force_n_m",
        unit: Unit::Newton,
        rotary_unit: Unit::NewtonMetre,
        neutral: 0.0,
        min: -1000000000.0,
        max: 1000000000.0,
        is_size: true,
        starts: &[],
        description: "On the link",
    }],
};

const PAYLOAD: Entry = Entry {
    name: "payload",
    family: Family::Robot,
    target: TargetKind::Whole,
    description: "A mass at the flange.",
    parameters: &[
        ParameterInfo {
            key: "mass_kg",
            rotary_key: "mass_kg",
            unit: Unit::Kilogram,
            rotary_unit: Unit::Kilogram,
            neutral: 0.0,
            min: -1000.0,
            max: 10000.0,
            is_size: true,
            starts: &[],
            description: "Mass",
        },
        ParameterInfo {
            key: "center_x_m",
            rotary_key: "center_x_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -5.0,
            max: 5.0,
            is_size: false,
            starts: &[],
            description: "Its centre in the flange frame",
        },
        ParameterInfo {
            key: "center_y_m",
            rotary_key: "center_y_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -5.0,
            max: 5.0,
            is_size: false,
            starts: &[],
            description: "Its centre in the flange frame",
        },
        ParameterInfo {
            key: "center_z_m",
            rotary_key: "center_z_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -5.0,
            max: 5.0,
            is_size: false,
            starts: &[],
            description: "Its centre in the flange frame",
        },
    ],
};

const BASE_COMPLIANCE: Entry = Entry {
    name: "base_compliance",
    family: Family::Robot,
    target: TargetKind::Axis,
    description: "The base tilts about a world axis under load.",
    parameters: &[ParameterInfo {
        key: "compliance_rad_per_n_m",
        rotary_key: "compliance_rad_per_n_m",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 0.0,
        min: 0.0,
        max: 1.0,
        is_size: true,
        starts: &[],
        description: "Tilt per moment",
    }],
};

const CUTTING_COEFFICIENT: Entry = Entry {
    name: "cutting_coefficient",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Cutting takes more or less force per chip area.",
    parameters: &[ParameterInfo {
        key: "factor",
        rotary_key: "factor",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 1.0,
        min: 0.05,
        max: 20.0,
        is_size: true,
        starts: &[0.8, 1.25],
        description: "Times the nominal coefficients",
    }],
};

const CUTTING_EDGE_FORCE: Entry = Entry {
    name: "cutting_edge_force",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Force that acts while the edge is engaged, whatever the chip: a blunt edge.",
    parameters: &[
        ParameterInfo {
            key: "axial_n_per_m",
            rotary_key: "axial_n_per_m",
            unit: Unit::NewtonPerMetre,
            rotary_unit: Unit::NewtonPerMetre,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "Per edge length",
        },
        ParameterInfo {
            key: "radial_n_per_m",
            rotary_key: "radial_n_per_m",
            unit: Unit::NewtonPerMetre,
            rotary_unit: Unit::NewtonPerMetre,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "Per edge length",
        },
        ParameterInfo {
            key: "tangential_n_per_m",
            rotary_key: "tangential_n_per_m",
            unit: Unit::NewtonPerMetre,
            rotary_unit: Unit::NewtonPerMetre,
            neutral: 0.0,
            min: 0.0,
            max: 1000000000.0,
            is_size: true,
            starts: &[],
            description: "Per edge length",
        },
    ],
};

const CUTTING_RUNOUT: Entry = Entry {
    name: "cutting_runout",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "The tool turns about an axis beside its own: once per revolution.",
    parameters: &[
        ParameterInfo {
            key: "cosine_m",
            rotary_key: "cosine_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -0.01,
            max: 0.01,
            is_size: true,
            starts: &[],
            description: "Offset towards the first edge",
        },
        ParameterInfo {
            key: "sine_m",
            rotary_key: "sine_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -0.01,
            max: 0.01,
            is_size: true,
            starts: &[],
            description: "Offset a quarter of a turn ahead of it",
        },
    ],
};

const CUTTING_HOLE_OFFSET: Entry = Entry {
    name: "cutting_hole_offset",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "The hole is not where the program has it: the rim is met deeper on one side.",
    parameters: &[
        ParameterInfo {
            key: "y_m",
            rotary_key: "y_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -0.01,
            max: 0.01,
            is_size: true,
            starts: &[],
            description: "Along process Y",
        },
        ParameterInfo {
            key: "z_m",
            rotary_key: "z_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -0.01,
            max: 0.01,
            is_size: true,
            starts: &[],
            description: "Along process Z",
        },
    ],
};

const CUTTING_WORN_TOOTH: Entry = Entry {
    name: "cutting_worn_tooth",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "One edge stands back, or is missing.",
    parameters: &[ParameterInfo {
        key: "recess_m",
        rotary_key: "recess_m",
        unit: Unit::Metre,
        rotary_unit: Unit::Metre,
        neutral: 0.0,
        min: 0.0,
        max: 0.01,
        is_size: true,
        starts: &[],
        description: "How far the first edge stands back, along the feed",
    }],
};

const CUTTING_WEAR: Entry = Entry {
    name: "cutting_wear",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Forces grow with the path that the edge has cut.",
    parameters: &[ParameterInfo {
        key: "growth_per_m",
        rotary_key: "growth_per_m",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 0.0,
        min: 0.0,
        max: 1000.0,
        is_size: true,
        starts: &[],
        description: "Relative growth of the coefficients per metre of path",
    }],
};

const CUTTING_DEPTH_OFFSET: Entry = Entry {
    name: "cutting_depth_offset",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "Touch-down was taken too early or too late.",
    parameters: &[ParameterInfo {
        key: "depth_m",
        rotary_key: "depth_m",
        unit: Unit::Metre,
        rotary_unit: Unit::Metre,
        neutral: 0.0,
        min: -0.01,
        max: 0.01,
        is_size: true,
        starts: &[],
        description: "Additional depth",
    }],
};

const SPINDLE_SPEED: Entry = Entry {
    name: "spindle_speed",
    family: Family::Cutting,
    target: TargetKind::Whole,
    description: "The spindle turns slower or faster than commanded.",
    parameters: &[ParameterInfo {
        key: "factor",
        rotary_key: "factor",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 1.0,
        min: 0.5,
        max: 1.5,
        is_size: true,
        starts: &[0.97, 0.99, 1.01, 1.03],
        description: "Times the commanded speed",
    }],
};

const FOOT_FRICTION: Entry = Entry {
    name: "foot_friction",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "The foot rubs more or less.",
    parameters: &[ParameterInfo {
        key: "factor",
        rotary_key: "factor",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 1.0,
        min: 0.0,
        max: 20.0,
        is_size: true,
        starts: &[0.7, 1.4],
        description: "Times the nominal friction coefficient",
    }],
};

const FOOT_FRICTION_FALLING: Entry = Entry {
    name: "foot_friction_falling",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "Friction of the foot falls with its speed: `1 - drop (1 - exp(-v / speed))`.",
    parameters: &[
        ParameterInfo {
            key: "drop",
            rotary_key: "drop",
            unit: Unit::One,
            rotary_unit: Unit::One,
            neutral: 0.0,
            min: 0.0,
            max: 1.0,
            is_size: true,
            starts: &[0.3],
            description: "Part lost at high speed",
        },
        ParameterInfo {
            key: "speed_m_per_s",
            rotary_key: "speed_m_per_s",
            unit: Unit::MetrePerSecond,
            rotary_unit: Unit::MetrePerSecond,
            neutral: 0.001,
            min: 1e-6,
            max: 10.0,
            is_size: false,
            starts: &[0.0005, 0.002, 0.01],
            description: "Speed over which it falls",
        },
    ],
};

const FOOT_PRESSURE_LOSS: Entry = Entry {
    name: "foot_pressure_loss",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "The supply pressure sinks during the pass.",
    parameters: &[ParameterInfo {
        key: "rate_per_s",
        rotary_key: "rate_per_s",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 0.0,
        min: 0.0,
        max: 10.0,
        is_size: true,
        starts: &[0.05],
        description: "Part of the pressure lost per second",
    }],
};

const FOOT_SEAL_STICTION: Entry = Entry {
    name: "foot_seal_stiction",
    family: Family::Foot,
    target: TargetKind::Whole,
    description: "The seals hold more than their data sheet says.",
    parameters: &[ParameterInfo {
        key: "force_n",
        rotary_key: "force_n",
        unit: Unit::Newton,
        rotary_unit: Unit::Newton,
        neutral: 0.0,
        min: -10000.0,
        max: 10000.0,
        is_size: true,
        starts: &[],
        description: "Beyond the nominal seal stiction",
    }],
};

const WHEEL_STIFFNESS: Entry = Entry {
    name: "wheel_stiffness",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The wheel is softer or stiffer.",
    parameters: &[ParameterInfo {
        key: "factor",
        rotary_key: "factor",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 1.0,
        min: 0.05,
        max: 20.0,
        is_size: true,
        starts: &[0.7, 1.4],
        description: "Times the nominal contact stiffness",
    }],
};

const WHEEL_ECCENTRICITY: Entry = Entry {
    name: "wheel_eccentricity",
    family: Family::Wheel,
    target: TargetKind::Whole,
    description: "The wheel runs out: once per revolution.",
    parameters: &[
        ParameterInfo {
            key: "cosine_m",
            rotary_key: "cosine_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -0.01,
            max: 0.01,
            is_size: true,
            starts: &[],
            description: "At the contact when the wheel starts",
        },
        ParameterInfo {
            key: "sine_m",
            rotary_key: "sine_m",
            unit: Unit::Metre,
            rotary_unit: Unit::Metre,
            neutral: 0.0,
            min: -0.01,
            max: 0.01,
            is_size: true,
            starts: &[],
            description: "A quarter of a turn later",
        },
    ],
};

const SENSOR_DELAY: Entry = Entry {
    name: "sensor_delay",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel arrives late.",
    parameters: &[ParameterInfo {
        key: "delay_s",
        rotary_key: "delay_s",
        unit: Unit::Second,
        rotary_unit: Unit::Second,
        neutral: 0.0,
        min: -1.0,
        max: 1.0,
        is_size: true,
        starts: &[0.002, 0.01],
        description: "Delay",
    }],
};

const SENSOR_GAIN: Entry = Entry {
    name: "sensor_gain",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel's gain is off.",
    parameters: &[ParameterInfo {
        key: "factor",
        rotary_key: "factor",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 1.0,
        min: -100.0,
        max: 100.0,
        is_size: true,
        starts: &[1.1],
        description: "Times the true value",
    }],
};

const SENSOR_OFFSET: Entry = Entry {
    name: "sensor_offset",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel's zero is off.",
    parameters: &[ParameterInfo {
        key: "offset",
        rotary_key: "offset",
        unit: Unit::One,
        rotary_unit: Unit::One,
        neutral: 0.0,
        min: -1000000000000.0,
        max: 1000000000000.0,
        is_size: true,
        starts: &[],
        description: "In the channel's unit",
    }],
};

const SENSOR_DRIFT: Entry = Entry {
    name: "sensor_drift",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel's zero creeps as it warms up: `amplitude (1 - exp(-t / time))`.",
    parameters: &[
        ParameterInfo {
            key: "amplitude",
            rotary_key: "amplitude",
            unit: Unit::One,
            rotary_unit: Unit::One,
            neutral: 0.0,
            min: -1000000000000.0,
            max: 1000000000000.0,
            is_size: true,
            starts: &[],
            description: "In the channel's unit, when warm",
        },
        ParameterInfo {
            key: "time_constant_s",
            rotary_key: "time_constant_s",
            unit: Unit::Second,
            rotary_unit: Unit::Second,
            neutral: 10.0,
            min: 0.01,
            max: 100000.0,
            is_size: false,
            starts: &[1.0, 5.0, 50.0],
            description: "Warming up",
        },
    ],
};

const SENSOR_LOW_PASS: Entry = Entry {
    name: "sensor_low_pass",
    family: Family::Sensor,
    target: TargetKind::Channel,
    description: "The channel is smoothed by a filter of first order.",
    parameters: &[ParameterInfo {
        key: "time_constant_s",
        rotary_key: "time_constant_s",
        unit: Unit::Second,
        rotary_unit: Unit::Second,
        neutral: 0.0,
        min: 0.0,
        max: 10.0,
        is_size: true,
        starts: &[0.002, 0.01],
        description: "Of the filter",
    }],
};
