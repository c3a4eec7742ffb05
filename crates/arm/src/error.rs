//! What can be wrong with a robot file or with a question asked of a robot.

use std::path::Path;

use thiserror::Error;

use crate::placed::Placed;
use crate::told::{in_the_workshop, short, told};

/// An error with the place it was found at.
pub type ArmError = Placed<ArmErrorKind>;

/// The faults this crate reports. Field values are in SI units.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ArmErrorKind {
    /// All that is wrong with a file, where it is more than one thing.
    #[error("{}", listed(.0))]
    Several(Vec<ArmError>),
    #[error("cannot read the file: {0}")]
    Unreadable(#[source] std::io::Error),
    #[error(
        "the byte {byte:#04x} (byte {at} of the file) is not UTF-8, which XML is unless its first line says otherwise; save the file as UTF-8, or begin it with <?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>, or whatever it is"
    )]
    NotUtf8 { byte: u8, at: usize },
    #[error(
        "the encoding \"{found}\" of the file is not known, or the file is in another one; save it as UTF-8"
    )]
    UnknownEncoding { found: String },
    #[error("not well-formed XML: {0}")]
    Xml(String),
    #[error("elements are nested more than {limit} deep; a URDF is nested less than ten deep")]
    TooDeep { limit: usize },
    #[error("an element has {count} attributes; at most {limit} are read")]
    TooManyAttributes { count: usize, limit: usize },
    #[error("the root element is <{found}>; a URDF has <robot>")]
    NotARobot { found: String },
    #[error(
        "{what} is of xacro, a language from which URDF files are made; a file in it is called .xacro and is expanded when it is read"
    )]
    XacroInUrdf { what: String },
    #[error("xacro: {0}")]
    Xacro(String),
    /// An argument that is given, and that the file does not have.
    #[error("xacro: {message}")]
    XacroArgument { name: String, message: String },
    #[error("the file has {count} links; at most {limit} are read")]
    TooManyLinks { count: usize, limit: usize },
    #[error("{owner}: {quantity} is {}; it must be {rule}", told(*.value))]
    OutOfBounds {
        owner: String,
        quantity: &'static str,
        value: f64,
        rule: &'static str,
    },
    #[error("not a valid URDF: {0}")]
    Urdf(String),
    #[error("<{element} {attribute}=\"{value}\"> of {owner}: expected {expected}")]
    BadNumber {
        owner: String,
        element: String,
        attribute: String,
        value: String,
        expected: &'static str,
    },
    #[error("<{element}> without the attribute `{attribute}`")]
    MissingAttribute { element: String, attribute: String },
    #[error(
        "{element} name \"{name}\" is used twice; names must be unique (first use in line {first_line})"
    )]
    DuplicateName {
        element: &'static str,
        name: String,
        first_line: usize,
    },
    #[error("joint \"{joint}\" names the {role} link \"{link}\", which does not exist{hint}")]
    UnknownLink {
        joint: String,
        role: &'static str,
        link: String,
        hint: String,
    },
    #[error("the file has no links")]
    NoLinks,
    #[error(
        "link \"{link}\" is the child of joints \"{first}\" and \"{second}\": the links form a closed loop; a URDF is a tree"
    )]
    TwoParents {
        link: String,
        first: String,
        second: String,
    },
    #[error("the links {cycle} form a closed loop; a URDF is a tree")]
    Cycle { cycle: String },
    #[error("{count} root links ({names}); a URDF has exactly one link that is no joint's child")]
    ManyRoots { count: usize, names: String },
    #[error(
        "joint \"{joint}\" on the chain to \"{tip}\" is {kind}; only revolute, continuous, prismatic and fixed joints can be on the chain"
    )]
    JointType {
        joint: String,
        tip: String,
        kind: &'static str,
    },
    #[error("joint \"{joint}\" mimics \"{mimicked}\", which does not exist{hint}")]
    UnknownMimicked {
        joint: String,
        mimicked: String,
        hint: String,
    },
    #[error(
        "joint \"{joint}\" mimics itself, by way of the joints that it mimics; one of them must move by itself"
    )]
    MimicsItself { joint: String },
    #[error("joint \"{joint}\" moves with \"{leader}\" ({multiplier} times, <mimic>): {purpose}")]
    Follows {
        joint: String,
        leader: String,
        multiplier: f64,
        purpose: &'static str,
    },
    #[error(
        "joint \"{joint}\": axis has length {length}; it must be longer than {limit} and finite"
    )]
    ZeroAxis {
        joint: String,
        length: f64,
        limit: f64,
    },
    #[error("joint \"{joint}\": lower limit {lower} is above upper limit {upper}")]
    LimitsReversed {
        joint: String,
        lower: f64,
        upper: f64,
    },
    #[error("joint \"{joint}\": {quantity} is {value}; it must not be negative")]
    NegativeJointValue {
        joint: String,
        quantity: &'static str,
        value: f64,
    },
    #[error("link \"{link}\": mass is {mass_kg} kg; it must not be negative")]
    NegativeMass { link: String, mass_kg: f64 },
    #[error(
        "link \"{link}\" moves with joint \"{joint}\" but has mass 0 kg, and so has everything fixed to it; a moving link needs a positive mass: give it as a [[link]] of robot.toml, or estimate all from the data sheet: truecut robot init"
    )]
    MasslessMovingLink { link: String, joint: String },
    #[error(
        "link \"{link}\": the inertia tensor has the principal moments {moments}; none may be negative"
    )]
    InertiaNotPositive { link: String, moments: String },
    #[error(
        "link \"{link}\": the principal moments of inertia {moments} break the triangle rule; the largest ({largest} kg m^2) must not exceed the sum of the other two ({sum} kg m^2)"
    )]
    InertiaTriangle {
        link: String,
        moments: String,
        largest: f64,
        sum: f64,
    },
    #[error(
        "the chain from \"{root}\" to \"{tip}\" has {count} moving joints; 1 to {limit} are supported"
    )]
    JointCount {
        root: String,
        tip: String,
        count: usize,
        limit: usize,
    },
    #[error("no link \"{tip}\"{hint}")]
    UnknownTip { tip: String, hint: String },
    #[error("the robot is a tree with several possible tips; choose one: {candidates}")]
    AmbiguousTip { candidates: String },

    #[error("{0}")]
    Toml(String),
    #[error("no joint \"{joint}\" on the chain to \"{tip}\"; its joints are {known}")]
    UnknownJoint {
        joint: String,
        tip: String,
        known: String,
    },
    #[error("joint \"{joint}\" is {kind}: use `{right}` instead of `{wrong}`")]
    WrongUnitKey {
        joint: String,
        kind: &'static str,
        wrong: &'static str,
        right: &'static str,
    },
    #[error("link \"{link}\" has no mass in the URDF; give the arm's mass with --mass")]
    MassNotGiven { link: String },
    #[error("no link \"{link}\" in the URDF{hint}")]
    UnknownConfigLink { link: String, hint: String },
    #[error(
        "link \"{link}\": `source` is empty; say where the values come from, or \"estimated: ...\""
    )]
    LinkWithoutSource { link: String },
    #[error("link \"{link}\": mass, centre and inertia must be finite numbers")]
    LinkNotFinite { link: String },
    #[error(
        "the links' masses sum to {sum_kg} kg, but `total_kg` is {total_kg}; they must agree within 0.5 %"
    )]
    MassesDoNotSum { sum_kg: f64, total_kg: f64 },
    #[error("joint \"{joint}\": `{key}` is {value}; it must be {rule}")]
    ConfigValue {
        joint: String,
        key: &'static str,
        value: f64,
        rule: &'static str,
    },
    #[error("frame `{frame}`: `{key}` holds {value}; it must be a finite number")]
    FrameValue {
        frame: &'static str,
        key: &'static str,
        value: f64,
    },
    #[error(
        "joint \"{joint}\": `{key}` has no source; add `{source_key} = \"...\"` to its [joint.source] (where the value comes from, or \"estimated: ...\")"
    )]
    NoSource {
        joint: String,
        key: &'static str,
        source_key: &'static str,
    },

    #[error(
        "joint \"{joint}\" has no transmission stiffness; give it in robot.toml (`{key}`) to use {purpose}"
    )]
    NoStiffness {
        joint: String,
        key: &'static str,
        purpose: &'static str,
    },
    #[error("the posture has {found} values; the chain has {expected} joints")]
    PostureLength { found: usize, expected: usize },
    #[error(
        "joint \"{joint}\": {} is outside the limits {} to {} ({} {unit}; {} to {} {unit})",
        in_the_workshop(*value, unit), in_the_workshop(*lower, unit), in_the_workshop(*upper, unit),
        short(*value), short(*lower), short(*upper)
    )]
    OutsideLimits {
        joint: String,
        value: f64,
        lower: f64,
        upper: f64,
        unit: &'static str,
    },
    #[error("joint \"{joint}\": posture value {value} is not a finite number")]
    PostureNotFinite { joint: String, value: f64 },
    #[error(
        "no static equilibrium found: after {iterations} Newton steps the torque balance is still off by {residual:e} (limit {limit:e}){wound}"
    )]
    NoEquilibrium {
        iterations: usize,
        residual: f64,
        limit: f64,
        wound: String,
    },
    #[error(
        "the equilibrium found is not stable: the smallest eigenvalue of the joint stiffness there is {stiffness}; it must be positive{wound}"
    )]
    UnstableEquilibrium { stiffness: f64, wound: String },
    #[error(
        "the tool's modes weigh {mass_kg:.4} kg together (stiffness over the square of the angular frequency), but must weigh less than the arm gives at its tool point: their masses are part of its own"
    )]
    ToolTooHeavy { mass_kg: f64 },
    #[error(
        "the mass matrix is not positive definite at this posture; a link has no inertia about its joint's axis"
    )]
    SingularMassMatrix,
    #[error(
        "the arm is not stable at this posture: the smallest eigenvalue of stiffness over mass is {eigenvalue} rad^2/s^2; it must be positive"
    )]
    Unstable { eigenvalue: f64 },
    #[error(
        "the compliance is singular in this subspace: the arm is at a singular posture or has too few joints"
    )]
    SingularCompliance,
    #[error(
        "pose not reached from this seed: after {iterations} steps {position_m:.3e} m and {angle_rad:.3e} rad are left (limits {position_limit_m:e} m, {angle_limit_rad:e} rad)"
    )]
    Unreachable {
        iterations: usize,
        position_m: f64,
        angle_rad: f64,
        position_limit_m: f64,
        angle_limit_rad: f64,
    },
    #[error(
        "pose out of reach at ({}, {}, {}) m: no posture puts the {frame} there",
        short(*x_m), short(*y_m), short(*z_m)
    )]
    OutOfReach {
        frame: &'static str,
        x_m: f64,
        y_m: f64,
        z_m: f64,
    },
    #[error(
        "the pose at ({}, {}, {}) m is reached by {count} postures, but by none within the joint limits{nearest}",
        short(*x_m), short(*y_m), short(*z_m)
    )]
    LimitsExclude {
        count: usize,
        x_m: f64,
        y_m: f64,
        z_m: f64,
        /// Which limit the nearest of them breaks and by how much.
        nearest: String,
    },
    #[error(
        "the path breaks off at pose {index}: the nearest posture is {} away in joint \"{joint}\" (limit {}); a singularity or a joint limit lies there",
        in_the_workshop(*jump, unit), in_the_workshop(*limit, unit)
    )]
    PathBreaks {
        index: usize,
        joint: String,
        jump: f64,
        limit: f64,
        /// Of both: that of the joint's coordinate.
        unit: &'static str,
    },
    #[error("pose {index} of the path: {source}")]
    OnPath {
        index: usize,
        #[source]
        source: Box<ArmErrorKind>,
    },
    #[error(
        "the table holds no posture{only}; a row has one number for each of the {joints} joints"
    )]
    NoPostures {
        joints: usize,
        /// What stands in it, if it is a heading alone.
        only: String,
    },
    #[error("the table holds no pose; a row has x, y, z, roll, pitch, yaw")]
    NoPoses,
    #[error("row {row}: {message}")]
    PostureTable { row: usize, message: String },
    #[error(
        "link \"{link}\" carries a payload, but has no mass of its own: give it in the URDF, in [[link]], or by \
         `truecut robot init`"
    )]
    LoadWithoutLink { link: String },
    #[error("{0}")]
    Implausible(String),
    #[error("{quantity} is {value}; it must be {rule}")]
    Argument {
        quantity: &'static str,
        value: f64,
        rule: &'static str,
    },
}

fn listed(faults: &[ArmError]) -> String {
    let line = |fault: &ArmError| match fault.line() {
        Some(line) => format!("line {line}: {}", fault.message()),
        None => fault.message(),
    };
    let all: Vec<String> = faults.iter().map(line).collect();
    format!("{} faults: {}", faults.len(), all.join("; "))
}

/// Most faults of a file that are told at once: each is shown within the text of its file.
const MOST_FAULTS: usize = 100;

/// One error of all faults of a file, at the first of them; none if there are none.
pub(crate) fn several(mut faults: Vec<ArmError>) -> Option<ArmError> {
    faults.sort_by_key(ArmError::line);
    let path = faults.first()?.path().map(Path::to_owned);
    if faults.len() > MOST_FAULTS {
        let rest = format!("{} more faults are not shown", faults.len() - MOST_FAULTS);
        faults.truncate(MOST_FAULTS);
        faults.push(ArmErrorKind::Toml(rest).into());
    }
    let line = faults[0].line();
    if faults.len() == 1 {
        return faults.pop();
    }
    let kind = ArmErrorKind::Several(faults);
    Some(match path {
        Some(path) => ArmError::in_file(&path, line, kind),
        None => kind.into(),
    })
}
