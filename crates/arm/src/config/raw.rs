//! The tables of a `robot.toml` as they are written.

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

pub(super) type Number = Option<Spanned<f64>>;

/// What a URDF cannot say of a robot.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawConfig {
    /// Name of the robot. Default: the URDF's.
    pub(super) name: Option<String>,
    /// Frames at the flange.
    #[serde(default)]
    pub(super) frames: RawFrames,
    /// Transmissions; joints left out keep the URDF's values.
    #[serde(default)]
    pub(super) joint: Vec<RawJoint>,
    /// What a controller is told of the tool's load. Default: nothing.
    pub(super) tool_load: Option<RawLoad>,
    /// What the masses must sum to.
    pub(super) masses: Option<RawMasses>,
    /// Masses of links in place of the URDF's.
    #[serde(default)]
    pub(super) link: Vec<RawLink>,
    /// What is mounted on links beside what they are: cables, dress packs, valves, a spindle.
    #[serde(default)]
    pub(super) payload: Vec<RawPayload>,
}

/// Frames relative to the flange, the tip link of the URDF.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFrames {
    /// Where the process acts; z points from the robot into the workpiece. Default: the flange.
    pub(super) tool: Option<RawFrame>,
    /// Where a pressure foot presses. Default: the tool frame.
    pub(super) foot: Option<RawFrame>,
}

/// Place and attitude of a frame.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFrame {
    /// Origin, m. Default: that of the flange.
    #[schemars(with = "Option<[f64; 3]>")]
    pub(super) xyz_m: Option<Spanned<[f64; 3]>>,
    /// Origin, mm, in place of xyz_m.
    #[schemars(with = "Option<[f64; 3]>")]
    pub(super) xyz_mm: Option<Spanned<[f64; 3]>>,
    /// Turns about the fixed axes x, y, z, as in URDF. Default: none.
    #[schemars(with = "Option<[f64; 3]>")]
    pub(super) rpy_deg: Option<Spanned<[f64; 3]>>,
}

/// Mass and centre of what is mounted on the flange.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawLoad {
    /// Mass, kg, above 0.
    #[schemars(with = "f64")]
    pub(super) mass_kg: Spanned<f64>,
    /// Centre of mass in the flange's frame, m.
    #[schemars(with = "[f64; 3]")]
    pub(super) center_m: Spanned<[f64; 3]>,
}

/// The transmission of a joint; values on the joint side of the gear.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawJoint {
    /// Name of the joint in the URDF.
    #[schemars(with = "String")]
    pub(super) name: Spanned<String>,
    /// Stiffness of a rotary joint, above 0.
    #[schemars(with = "Option<f64>")]
    pub(super) stiffness_nm_per_rad: Number,
    /// Stiffness of a slide, above 0.
    #[schemars(with = "Option<f64>")]
    pub(super) stiffness_n_per_m: Number,
    /// Wind-up to which the spring of a rotary joint is a straight line, above 0. Default: 0.03.
    #[schemars(with = "Option<f64>")]
    pub(super) linear_to_rad: Number,
    /// Deflection to which the spring of a slide is a straight line, above 0. Default: 0.01.
    #[schemars(with = "Option<f64>")]
    pub(super) linear_to_m: Number,
    /// Damping of a rotary joint.
    #[schemars(with = "Option<f64>")]
    pub(super) damping_nm_s_per_rad: Number,
    /// Damping of a slide.
    #[schemars(with = "Option<f64>")]
    pub(super) damping_n_s_per_m: Number,
    /// Dry friction of a rotary joint.
    #[schemars(with = "Option<f64>")]
    pub(super) dry_friction_nm: Number,
    /// Dry friction of a slide.
    #[schemars(with = "Option<f64>")]
    pub(super) dry_friction_n: Number,
    /// Inertia of motor and gear of a rotary joint.
    #[schemars(with = "Option<f64>")]
    pub(super) rotor_inertia_kg_m2: Number,
    /// Inertia of motor and gear of a slide.
    #[schemars(with = "Option<f64>")]
    pub(super) rotor_mass_kg: Number,
    /// Encoder pulses per degree, for robot programs that count in them.
    #[schemars(with = "Option<f64>")]
    pub(super) pulses_per_deg: Number,
    /// Encoder pulses per millimetre of a slide.
    #[schemars(with = "Option<f64>")]
    pub(super) pulses_per_mm: Number,
    /// The servo, for drive = "servo" and for limits of the drive.
    pub(super) servo: Option<RawServo>,
    /// Where each value comes from.
    #[serde(default)]
    pub(super) source: RawSource,
}

/// A P–P servo.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawServo {
    /// Gain of the position loop.
    #[schemars(with = "f64")]
    pub(super) position_gain_per_s: Spanned<f64>,
    /// Gain of the velocity loop of a rotary joint.
    #[schemars(with = "Option<f64>")]
    pub(super) velocity_gain_nm_s_per_rad: Number,
    /// Gain of the velocity loop of a slide.
    #[schemars(with = "Option<f64>")]
    pub(super) velocity_gain_n_s_per_m: Number,
    /// Largest torque of a rotary drive.
    #[schemars(with = "Option<f64>")]
    pub(super) torque_limit_nm: Number,
    /// Largest force of a slide's drive.
    #[schemars(with = "Option<f64>")]
    pub(super) force_limit_n: Number,
    /// Share of the command's velocity that is fed forward. Default: 1.
    #[schemars(with = "Option<f64>")]
    pub(super) velocity_feed_forward: Number,
}

/// Where the values of a joint come from; "estimated: …" is a source.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSource {
    /// Of the stiffness.
    pub(super) stiffness: Option<String>,
    /// Of the range in which the spring is a straight line.
    pub(super) linear_to: Option<String>,
    /// Of the damping.
    pub(super) damping: Option<String>,
    /// Of the dry friction.
    pub(super) dry_friction: Option<String>,
    /// Of the rotor.
    pub(super) rotor_inertia: Option<String>,
    /// Of the servo.
    pub(super) servo: Option<String>,
    /// Of the pulses.
    pub(super) pulses: Option<String>,
}

/// What all links must sum to.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMasses {
    /// Mass of all links, kg, within 0.5 %.
    #[schemars(with = "f64")]
    pub(super) total_kg: Spanned<f64>,
}

/// Mass, centre and inertia of a link.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawLink {
    /// Name of the link in the URDF.
    #[schemars(with = "String")]
    pub(super) name: Spanned<String>,
    /// Mass, kg.
    pub(super) mass_kg: f64,
    /// Centre of mass in the link frame, m.
    pub(super) center_m: [f64; 3],
    /// Inertia about the centre, in link axes, kg m²: xx, yy, zz, xy, xz, yz.
    pub(super) inertia_kg_m2: [f64; 6],
    /// Where the values come from.
    pub(super) source: String,
}

/// Mass that a link carries, in addition to its own.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPayload {
    /// Name of the link in the URDF.
    #[schemars(with = "String")]
    pub(super) link: Spanned<String>,
    /// Mass, kg, above 0.
    pub(super) mass_kg: f64,
    /// Centre of mass in the link frame, m.
    pub(super) center_m: [f64; 3],
    /// Inertia about the centre, in link axes, kg m²: xx, yy, zz, xy, xz, yz. Default: a point.
    #[serde(default)]
    pub(super) inertia_kg_m2: [f64; 6],
    /// Where the values come from.
    pub(super) source: String,
}
