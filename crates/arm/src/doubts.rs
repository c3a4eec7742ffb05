//! What looks like a placeholder rather than a value: files are published so, and a run with them
//! gives numbers like any other.

use crate::model::{Chain, Frames, Joint, JointKind, Link};
use std::f64::consts::TAU;

/// Fewest joints of what is an arm; a rig of one or two may have any masses.
const FEWEST_JOINTS: usize = 4;
/// Moving mass over the square of the reach, kg/m², of machines that there are: 15 of light
/// collaborating arms, 450 of the heaviest.
const LEAST_KG_PER_M2: f64 = 5.0;
const MOST_KG_PER_M2: f64 = 1000.0;
/// Reach of arms that there are: the smallest stand on a desk, the largest carry 2.3 t over 4.7 m.
const LEAST_REACH_M: f64 = 0.1;
const MOST_REACH_M: f64 = 10.0;
/// Most turns to either side of a joint that an industrial arm has: cables do not bear more, and a
/// wrist without end has no limits. A quarter of a turn in degrees would be 14 turns in radians.
const MOST_TURNS: f64 = 12.0;
/// Larger limits stand for none.
const NO_LIMIT_RAD: f64 = 1000.0;
/// A tool's frame is along the last axis, or across it, within this cosine.
const RIGHT_ANGLE: f64 = 0.02;

/// What speaks against the values of an arm.
pub(crate) struct Doubts {
    pub(crate) notes: Vec<String>,
    /// Why masses and inertias are not the arm's own: two signs of three, since one alone may be
    /// chance, or a machine like no other.
    pub(crate) placeholders: Option<String>,
}

/// Looks at masses, inertias, damping, lengths and limits for values that no machine has.
pub(crate) fn of(chain: &Chain, frames: &Frames) -> Doubts {
    let mut signs = Vec::new();
    let has_masses = chain.moving().all(|body| body.link.mass_kg > 0.0);
    if chain.joints.len() >= FEWEST_JOINTS && has_masses {
        if all_alike(&chain.links, |link| link.mass_kg) {
            let (count, mass_kg) = (chain.links.len(), chain.links[0].mass_kg);
            signs.push(format!(
                "all {count} moving links have the same mass, {mass_kg} kg"
            ));
        }
        let trace = |link: &Link| link.inertia_about_com_kg_m2.trace();
        if all_alike(&chain.links, trace) {
            signs.push("all moving links have the same inertia".to_owned());
        }
        signs.extend(of_total(chain));
    }
    let note = |sign: &String| format!("{sign}: a placeholder, it seems");
    let mut notes: Vec<String> = signs.iter().map(note).collect();
    let transmissions = chain.joints.iter().map(|joint| &joint.transmission);
    let mut elastic = transmissions.filter(|t| t.stiffness.is_some()).peekable();
    if elastic.peek().is_some() && elastic.all(|t| t.damping == 0.0) {
        notes.push("no joint has damping: vibration never dies away".to_owned());
    }
    notes.extend(of_lengths(chain));
    notes.extend(of_limits(chain));
    if chain.joints.len() >= FEWEST_JOINTS {
        notes.extend(of_tool_axis(chain, frames));
    }
    Doubts {
        notes,
        placeholders: (signs.len() >= 2).then(|| signs.join("; ")),
    }
}

fn all_alike(links: &[Link], of: impl Fn(&Link) -> f64) -> bool {
    let first = of(&links[0]);
    links
        .iter()
        .all(|link| (of(link) - first).abs() <= 1e-6 * first.abs())
}

fn of_total(chain: &Chain) -> Option<String> {
    let mass_kg: f64 = chain.moving().map(|body| body.link.mass_kg).sum();
    let reach_m = reach_m(chain);
    let density = mass_kg / reach_m.powi(2);
    let what = if density < LEAST_KG_PER_M2 {
        "less"
    } else if density > MOST_KG_PER_M2 {
        "more"
    } else {
        return None;
    };
    Some(format!(
        "{mass_kg:.3} kg move over a reach of {reach_m:.2} m, {what} than in any machine known (or \
         it is in another unit)"
    ))
}

/// Joint to joint, from the first on.
fn reach_m(chain: &Chain) -> f64 {
    let offsets = chain.moving().skip(1);
    offsets
        .map(|joint| joint.parent_from_joint.translation.vector.norm())
        .sum()
}

/// Lengths of another unit. A long track stands before the first joint that turns.
fn of_lengths(chain: &Chain) -> Option<String> {
    let reach_m = reach_m(chain);
    let least_m = if chain.joints.len() < FEWEST_JOINTS {
        0.0
    } else {
        LEAST_REACH_M
    };
    if (least_m..=MOST_REACH_M).contains(&reach_m) {
        return None;
    }
    let read = if reach_m > MOST_REACH_M {
        format!("; in millimetres it were {:.3} m", 1e-3 * reach_m)
    } else {
        String::new()
    };
    Some(format!(
        "the joints reach {reach_m:.4} m, which no arm known does ({LEAST_REACH_M} to {MOST_REACH_M} m): lengths \
         of a robot's file are metres{read}"
    ))
}

/// Limits in degrees.
fn of_limits(chain: &Chain) -> Option<String> {
    let most = |joint: &Joint| {
        let limits = joint.limits.filter(|_| joint.kind == JointKind::Revolute)?;
        let furthest = [limits.lower, limits.upper].map(f64::abs);
        let furthest = furthest.into_iter().filter(|it| it.is_finite());
        furthest.reduce(f64::max)
    };
    let limited: Vec<(&Joint, f64)> = (chain.joints.iter())
        .filter_map(|joint| Some((joint, most(joint)?)))
        .collect();
    let far = |(_, limit): &&(&Joint, f64)| (MOST_TURNS * TAU..NO_LIMIT_RAD).contains(limit);
    let doubtful: Vec<_> = limited.iter().filter(far).collect();
    let (joint, limit) = doubtful.first()?;
    if 2 * doubtful.len() < limited.len() {
        return None;
    }
    Some(format!(
        "{} of {} joints with limits may turn by more than {MOST_TURNS} times, the joint \"{}\" as far as {limit} \
         rad: angles of a robot's file are radians, and these look like degrees",
        doubtful.len(),
        limited.len(),
        joint.name
    ))
}

/// A flange whose z axis is square to the axis that turns it: the x axis points out of some files'
/// flanges (that is how ROS has them), and a tool would stand across the wrist.
fn of_tool_axis(chain: &Chain, frames: &Frames) -> Option<String> {
    let last = chain
        .joints
        .last()
        .filter(|it| it.kind == JointKind::Revolute)?;
    let tool = frames.last_link_from_flange * frames.flange_from_tool;
    if frames.flange_from_tool.rotation.angle() > 1e-6 {
        return None;
    }
    let axis = tool.inverse() * last.axis.into_inner();
    if axis.z.abs() > RIGHT_ANGLE {
        return None;
    }
    // From the last joint to the flange, or to the last joint from the one before, is out.
    let to_joint = last.parent_from_joint;
    let before = to_joint.rotation.inverse() * to_joint.translation.vector;
    let steps = [frames.last_link_from_flange.translation.vector, before];
    let outwards = steps.iter().map(|step| step.dot(&last.axis));
    let outwards = outwards.into_iter().find(|it| it.abs() > 1e-6);
    let axis = axis * outwards.map_or(1.0, f64::signum);
    let out = [("x", axis.x), ("y", axis.y)];
    let (name, along) = out
        .into_iter()
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let rpy = match (name, along > 0.0) {
        ("x", true) => "[0, 90, 0]",
        ("x", false) => "[0, -90, 0]",
        (_, true) => "[-90, 0, 0]",
        (_, false) => "[90, 0, 0]",
    };
    Some(format!(
        "the z axis of \"{}\" lies across the axis of the last joint, and a tool points along z: if yours points \
         out of the wrist, give frames.tool rpy_deg = {rpy}",
        chain.tip
    ))
}
