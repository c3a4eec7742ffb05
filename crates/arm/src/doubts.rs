//! What looks like a placeholder rather than a value: files are published so, and a run with them
//! gives numbers like any other.

use crate::model::{Chain, Frames, JointKind, Link, Robot};

mod motion;
mod place;
mod windup;

pub(crate) use motion::{of_frame_angles, unknown_speeds};
pub(crate) use windup::most_wound;

/// Fewest joints of what is an arm; a rig of one or two may have any masses.
pub(crate) const FEWEST_JOINTS: usize = 4;
/// Moving mass over the square of the reach, kg/m², of machines that there are: 15 of light
/// collaborating arms, 450 of the heaviest.
const LEAST_KG_PER_M2: f64 = 5.0;
const MOST_KG_PER_M2: f64 = 1000.0;
/// Reach of arms that there are: the smallest stand on a desk, the largest carry 2.3 t over 4.7 m.
const LEAST_REACH_M: f64 = 0.1;
pub(crate) const MOST_REACH_M: f64 = 10.0;
/// An origin is turned by no more than a whole turn, and rounding.
const MOST_TURN_RAD: f64 = 6.5;
/// A tool's frame is along the last axis, or across it, within this cosine.
const RIGHT_ANGLE: f64 = 0.02;

/// What speaks against the values of an arm.
pub(crate) struct Doubts {
    pub(crate) notes: Vec<String>,
    /// Why masses and inertias are not the arm's own: two signs, since one alone may be chance, or
    /// a machine like no other.
    pub(crate) placeholders: Option<String>,
}

/// Looks at masses, inertias, damping, lengths and limits for values that no machine has.
/// `signs` are those of the robot's file that are known already.
pub(crate) fn of(chain: &Chain, frames: &Frames, mut signs: Vec<String>) -> Doubts {
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
    notes.extend(of_geometry(chain, frames));
    if chain.joints.len() >= FEWEST_JOINTS {
        notes.extend(windup::of_windup(chain));
    }
    Doubts {
        notes,
        placeholders: (signs.len() >= 2).then(|| signs.join("; ")),
    }
}

/// Looks at lengths, limits, speeds, the flange and the tool's frame, which say where an arm goes,
/// whatever else is known.
pub(crate) fn of_geometry(chain: &Chain, frames: &Frames) -> Vec<String> {
    let mut notes: Vec<String> = of_lengths(chain)
        .into_iter()
        .chain(motion::of_limits(chain))
        .chain(motion::of_speeds(chain))
        .chain(motion::of_missing_speeds(chain))
        .collect();
    if chain.joints.len() >= FEWEST_JOINTS {
        notes.extend(of_tool_axis(chain, frames));
        notes.extend(of_tool_point(chain, frames));
    }
    notes
}

impl Robot {
    /// What speaks against where the arm goes and how fast, for whoever asks for its motion alone:
    /// [`Chain::motion_doubts`], and joints without a speed limit, of which none is too fast.
    #[must_use]
    pub fn motion_doubts(&self) -> Vec<String> {
        let mut doubts = self.chain.motion_doubts.clone();
        let of_speeds = unknown_speeds(&self.chain);
        doubts.extend(of_speeds.filter(|note| !self.chain.motion_doubts.contains(note)));
        doubts
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
    let (reach_m, travel_m) = (chain.reach_m(), chain.travel_m());
    // The reach of a gantry is the travel of its slides, that of an arm on a track is the arm's.
    let with_travel_m = reach_m + travel_m;
    let (over_m, what) = if mass_kg / reach_m.powi(2) < LEAST_KG_PER_M2 {
        (reach_m, "less")
    } else if mass_kg / with_travel_m.powi(2) > MOST_KG_PER_M2 {
        (with_travel_m, "more")
    } else {
        return None;
    };
    let travel = match over_m > reach_m {
        true => format!(", {travel_m:.2} m of travel of its slides included"),
        false => String::new(),
    };
    Some(format!(
        "{mass_kg:.3} kg move over a reach of {over_m:.2} m{travel}, {what} than in any machine known (or \
         it is in another unit)"
    ))
}

impl Chain {
    /// Joint to joint, from the first on, m.
    pub(crate) fn reach_m(&self) -> f64 {
        let offsets = self.moving().skip(1);
        offsets
            .map(|joint| joint.parent_from_joint.translation.vector.norm())
            .sum()
    }

    /// How far all slides travel together, those without limits left out, m.
    pub(crate) fn travel_m(&self) -> f64 {
        let slides = self.joints.iter();
        let slides = slides.filter(|joint| joint.kind == JointKind::Prismatic);
        let travel = slides.filter_map(|joint| joint.limits.map(|own| own.upper - own.lower));
        travel.filter(|travel| travel.is_finite()).sum()
    }
}

/// Lengths of another unit. A long track stands before the first joint that turns; travel of slides
/// is reach, of which a gantry has little else.
fn of_lengths(chain: &Chain) -> Option<String> {
    let reach_m = chain.reach_m();
    let least_m = if chain.joints.len() < FEWEST_JOINTS {
        0.0
    } else {
        LEAST_REACH_M
    };
    if reach_m <= MOST_REACH_M && reach_m + chain.travel_m() >= least_m {
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

/// A tool that is longer than the arm.
fn of_tool_point(chain: &Chain, frames: &Frames) -> Option<String> {
    let (reach_m, off_m) = (
        chain.reach_m() + chain.travel_m(),
        frames.flange_from_tool.translation.vector.norm(),
    );
    (off_m > reach_m && reach_m > LEAST_REACH_M).then(|| {
        format!(
            "the tool point is {off_m:.4} m off the flange, and the joints reach {reach_m:.4} m: \
             frames.tool has xyz_m in metres"
        )
    })
}

/// Origins turned in degrees.
pub(crate) fn of_turns(urdf: &urdf_rs::Robot) -> Option<String> {
    let furthest = |joint: &urdf_rs::Joint| {
        let turns = joint.origin.rpy.0.map(f64::abs);
        turns.into_iter().fold(0.0, f64::max)
    };
    let joints = urdf.joints.iter().map(|joint| (joint, furthest(joint)));
    let far: Vec<_> = joints.filter(|(_, turn)| *turn > MOST_TURN_RAD).collect();
    let (joint, turn) = far.first()?;
    Some(format!(
        "{} of {} joints have an origin turned by more than a whole turn, the joint \"{}\" by {turn} rad: angles \
         of a robot's file are radians, and these look like degrees",
        far.len(),
        urdf.joints.len(),
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
