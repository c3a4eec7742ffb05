//! The catalogue: every kind of effect, its target, its parameters, their units and bounds.

mod entry;
mod joint;
mod process;
mod robot;
mod sensor;

use entry::Entry;
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
    /// Dry friction that grows with what the transmission passes on: `share |τ|`.
    JointLoadFriction,
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
    /// The wheel rubs more or less.
    WheelFriction,
    /// The wheel takes off more or less.
    WheelRemoval,
    /// The force control holds another force than it is told to.
    WheelForceOffset,
    /// The carrier of the force control sticks.
    WheelForceStiction,
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
        EffectKind::JointLoadFriction,
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
        EffectKind::WheelFriction,
        EffectKind::WheelRemoval,
        EffectKind::WheelForceOffset,
        EffectKind::WheelForceStiction,
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
            EffectKind::JointStiffness => &joint::JOINT_STIFFNESS,
            EffectKind::JointDamping => &joint::JOINT_DAMPING,
            EffectKind::JointViscous => &joint::JOINT_VISCOUS,
            EffectKind::JointCoulomb => &joint::JOINT_COULOMB,
            EffectKind::JointLoadFriction => &joint::JOINT_LOAD_FRICTION,
            EffectKind::JointAsymmetricViscous => &joint::JOINT_ASYMMETRIC_VISCOUS,
            EffectKind::JointAsymmetricCoulomb => &joint::JOINT_ASYMMETRIC_COULOMB,
            EffectKind::JointStribeck => &joint::JOINT_STRIBECK,
            EffectKind::JointBacklash => &joint::JOINT_BACKLASH,
            EffectKind::JointHysteresis => &joint::JOINT_HYSTERESIS,
            EffectKind::JointCubicStiffness => &joint::JOINT_CUBIC_STIFFNESS,
            EffectKind::JointRipple => &joint::JOINT_RIPPLE,
            EffectKind::JointCounterbalance => &joint::JOINT_COUNTERBALANCE,
            EffectKind::JointOffset => &joint::JOINT_OFFSET,
            EffectKind::Payload => &robot::PAYLOAD,
            EffectKind::BaseCompliance => &robot::BASE_COMPLIANCE,
            EffectKind::CuttingCoefficient => &process::CUTTING_COEFFICIENT,
            EffectKind::CuttingEdgeForce => &process::CUTTING_EDGE_FORCE,
            EffectKind::CuttingRunout => &process::CUTTING_RUNOUT,
            EffectKind::CuttingHoleOffset => &process::CUTTING_HOLE_OFFSET,
            EffectKind::CuttingWornTooth => &process::CUTTING_WORN_TOOTH,
            EffectKind::CuttingWear => &process::CUTTING_WEAR,
            EffectKind::CuttingDepthOffset => &process::CUTTING_DEPTH_OFFSET,
            EffectKind::SpindleSpeed => &process::SPINDLE_SPEED,
            EffectKind::FootFriction => &process::FOOT_FRICTION,
            EffectKind::FootFrictionFalling => &process::FOOT_FRICTION_FALLING,
            EffectKind::FootPressureLoss => &process::FOOT_PRESSURE_LOSS,
            EffectKind::FootSealStiction => &process::FOOT_SEAL_STICTION,
            EffectKind::WheelStiffness => &process::WHEEL_STIFFNESS,
            EffectKind::WheelEccentricity => &process::WHEEL_ECCENTRICITY,
            EffectKind::WheelFriction => &process::WHEEL_FRICTION,
            EffectKind::WheelRemoval => &process::WHEEL_REMOVAL,
            EffectKind::WheelForceOffset => &process::WHEEL_FORCE_OFFSET,
            EffectKind::WheelForceStiction => &process::WHEEL_FORCE_STICTION,
            EffectKind::SensorDelay => &sensor::SENSOR_DELAY,
            EffectKind::SensorGain => &sensor::SENSOR_GAIN,
            EffectKind::SensorOffset => &sensor::SENSOR_OFFSET,
            EffectKind::SensorDrift => &sensor::SENSOR_DRIFT,
            EffectKind::SensorLowPass => &sensor::SENSOR_LOW_PASS,
        }
    }
}
