//! Estimates as the text of a `robot.toml`.

use std::fmt::Write as _;

use super::{
    DataSheet, Draft, JointEstimate, LIMIT_PER_TORQUE, LimitRule, LinkMass, MASS_FACTOR,
    MODE_DAMPING, MassRule, ROTOR_FACTOR, ROTOR_PER_TORQUE, STIFFNESS_FACTOR, VELOCITY_LOOP_RAD_S,
};
use crate::model::{Chain, JointKind};

/// A number with so many significant digits, as TOML reads it.
fn number(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits - 1).parse::<f64>();
    format!("{:?}", rounded.unwrap_or(value))
}

/// The file. Damping needs the modes, and is left out without a draft.
pub(super) fn write(
    chain: &Chain,
    sheet: &DataSheet,
    masses: &[LinkMass],
    joints: &[JointEstimate],
    draft: Option<&Draft>,
) -> String {
    let mut text = head(chain, sheet, draft);
    for mass in masses {
        link(&mut text, mass, sheet.mass_kg.unwrap_or_default());
    }
    if let Some(total_kg) = sheet.mass_kg {
        let _ = writeln!(text, "[masses]\ntotal_kg = {}\n", number(total_kg, 9));
    }
    for (at, (own, estimate)) in chain.joints.iter().zip(joints).enumerate() {
        let damping_s = draft.map(|draft| draft.damping_s[at]);
        joint(&mut text, &own.name, own.kind, estimate, damping_s);
    }
    text
}

fn head(chain: &Chain, sheet: &DataSheet, draft: Option<&Draft>) -> String {
    let mass = match sheet.mass_kg {
        Some(mass_kg) => format!("mass {mass_kg} kg, "),
        None => "masses of the URDF, ".to_owned(),
    };
    let first_hz = draft.map_or("?".to_owned(), |draft| number(draft.first_hz, 3));
    let scatter = scatter(sheet, draft).unwrap_or_default();
    format!(
        "# Estimated from a data sheet: {mass}payload {} kg. First mode {first_hz} Hz.\n\
         # Every value below is a guess by a rule, with the interval in which it is expected. What replaces it:\n\
         #   stiffness   truecut identify with a load-deflection test\n\
         #   damping     truecut identify with a hammer test\n\
         #   masses      the maker's CAD, or truecut diagnose with drive torques of slow and fast moves\n\
         #   servo       the controller's parameters\n{scatter}\n\
         name = {}\n\n\
         # The tool point relative to the flange {}: put the tool's length here.\n\
         [frames.tool]\nxyz_m = [0.0, 0.0, 0.0]\nrpy_deg = [0.0, 0.0, 0.0]\n\n",
        sheet.payload_kg,
        quoted(&format!("{} (estimated)", chain.name)),
        one_line(&chain.tip),
    )
}

/// What a repeatability says: not how stiff the arm is, but how much force is lost in its scatter.
fn scatter(sheet: &DataSheet, draft: Option<&Draft>) -> Option<String> {
    let repeatability_mm = sheet.repeatability_mm?;
    let force_n = draft?.softest_n_per_m? * repeatability_mm * 1e-3;
    let [least, force, most] =
        [1.0 / STIFFNESS_FACTOR, 1.0, STIFFNESS_FACTOR].map(|factor| number(factor * force_n, 2));
    Some(format!(
        "# Repeatability {repeatability_mm} mm is the scatter of a pose reached from one side (ISO 9283). It holds \
         neither stiffness nor\n# lost motion. In its softest direction the tool gives way by as much under {force} N \
         (estimated: {least} to {most} N):\n# load-deflection tests need forces well above that.\n"
    ))
}

/// A name within a comment.
fn one_line(name: &str) -> String {
    format!("\"{}\"", name.escape_debug())
}

/// A name as TOML writes it, in quotes, whatever it holds.
fn quoted(name: &str) -> String {
    toml::Value::from(name).to_string()
}

fn link(text: &mut String, mass: &LinkMass, total_kg: f64) {
    let [x, y, z] = <[f64; 3]>::from(mass.center_m).map(|value| number(value, 6));
    let i = &mass.inertia_kg_m2;
    let inertia = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    let inertia = inertia.map(|at| number(i[at], 9)).join(", ");
    let part = format!("its part of {total_kg} kg by");
    let rule = match mass.rule {
        MassRule::Mesh => format!(
            "{part} the volume within its mesh, one density for all links; within a factor of {MASS_FACTOR}"
        ),
        MassRule::Cylinder => format!(
            "{part} a cylinder to the next joint, since not every link has a closed mesh; within a factor of {MASS_FACTOR}"
        ),
        MassRule::Part => "counts as part of what it is fixed to".to_owned(),
    };
    let _ = write!(
        text,
        "[[link]]\nname = {}\nmass_kg = {}\ncenter_m = [{x}, {y}, {z}]\n\
         inertia_kg_m2 = [{inertia}]\n\
         source = \"estimated: {rule}\"\n\n",
        quoted(&mass.link),
        number(mass.mass_kg, 9),
    );
}

fn joint(
    text: &mut String,
    name: &str,
    kind: JointKind,
    estimate: &JointEstimate,
    damping_s: Option<f64>,
) {
    let (units, per_torque, torque) = match kind {
        JointKind::Revolute => (
            [
                "stiffness_nm_per_rad",
                "damping_nm_s_per_rad",
                "rotor_inertia_kg_m2",
                "velocity_gain_nm_s_per_rad",
                "torque_limit_nm",
            ],
            format!("{} per rad", estimate.stiffness_per_torque),
            "torque",
        ),
        JointKind::Prismatic => (
            [
                "stiffness_n_per_m",
                "damping_n_s_per_m",
                "rotor_mass_kg",
                "velocity_gain_n_s_per_m",
                "force_limit_n",
            ],
            format!("{} per m", estimate.stiffness_per_torque),
            "force",
        ),
    };
    let [stiffness, damping, rotor, velocity, limit] = units;
    let mut sources = format!(
        "stiffness = \"estimated: {per_torque} times the {torque} that gravity asks of the stretched arm with its payload; within a factor of {STIFFNESS_FACTOR}\"\n"
    );
    let mut values = vec![(stiffness, estimate.stiffness)];
    if let Some(seconds) = damping_s {
        values.push((damping, estimate.stiffness * seconds));
        let _ = writeln!(
            sources,
            "damping = \"estimated: a damping ratio of {MODE_DAMPING} in the modes in which the joint gives way; 0.01 to 0.06 are seen\""
        );
    }
    values.push((rotor, estimate.rotor_inertia));
    let _ = writeln!(
        sources,
        "rotor_inertia = \"estimated: {ROTOR_PER_TORQUE} s^2 times that {torque}; within a factor of {ROTOR_FACTOR}\""
    );
    let by_rule = format!("limit {LIMIT_PER_TORQUE} times that {torque}");
    let limit_rule = match estimate.limit {
        LimitRule::Given => "limit of the URDF".to_owned(),
        LimitRule::Missing => by_rule,
        LimitRule::TooWeak(effort) => {
            format!("{by_rule}, since the URDF's {effort} does not hold the arm")
        }
    };
    let _ = writeln!(
        sources,
        "servo = \"estimated: velocity loop at {VELOCITY_LOOP_RAD_S} rad/s on the rotor, position loop at a tenth of it; {limit_rule}\""
    );
    let _ = write!(text, "\n[[joint]]\nname = {}\n", quoted(name));
    let mut line = |key: &str, value: f64| {
        let _ = writeln!(text, "{key} = {}", number(value, 4));
    };
    for (key, value) in values {
        line(key, value);
    }
    line(
        "[joint.servo]\nposition_gain_per_s",
        VELOCITY_LOOP_RAD_S / 10.0,
    );
    line(velocity, estimate.velocity_gain);
    line(limit, estimate.torque_limit);
    let _ = write!(text, "[joint.source]\n{sources}");
}
