//! Transmissions that are softer than any.

use nalgebra::DVector;

use crate::model::{Chain, Joint, JointKind, Robot, standard_gravity_m_s2};

/// Drives with springs in series, the softest that there are, give way by half of it.
const MOST_WINDUP_RAD: f64 = 0.1;
/// Sheets of reducers have N m/arcmin.
const ARCMIN_PER_RAD: f64 = 60.0 * 180.0 / std::f64::consts::PI;

/// A transmission that the arm's own weight winds up, stretched out, by more than any does.
pub(super) fn of_windup(chain: &Chain) -> Option<String> {
    // From each joint to the centres of what it carries, along the chain.
    let torque = |joint: usize| -> f64 {
        let mut lever_m = 0.0;
        let carried = chain
            .joints
            .iter()
            .zip(&chain.links)
            .enumerate()
            .skip(joint);
        let weights = carried.map(|(index, (own, link))| {
            if index > joint {
                lever_m += own.parent_from_joint.translation.vector.norm();
            }
            link.mass_kg * (lever_m + link.com_m.norm())
        });
        standard_gravity_m_s2().norm() * weights.sum::<f64>()
    };
    let windups = chain
        .joints
        .iter()
        .enumerate()
        .filter_map(|(index, joint)| {
            let stiffness = joint.transmission.stiffness?;
            let rotary = joint.kind == JointKind::Revolute;
            rotary.then(|| (joint, stiffness, torque(index) / stiffness))
        });
    let (joint, stiffness, windup) = windups.max_by(|a, b| a.2.total_cmp(&b.2))?;
    (windup > MOST_WINDUP_RAD).then(|| {
        format!(
            "the arm's weight, stretched out, would wind the joint \"{}\" up by {:.1} deg ({:.0} deg is more than \
             any arm's): its stiffness is {stiffness} N m/rad{}",
            joint.name,
            windup.to_degrees(),
            MOST_WINDUP_RAD.to_degrees(),
            of_sheets(windup)
        )
    })
}

/// The joint that `torques` (N m or N) wind up most, as the end of a message that an arm finds no
/// rest: by far too much where its stiffness is in another unit.
pub(crate) fn most_wound(robot: &Robot, torques: &DVector<f64>) -> String {
    let joints = robot.chain.joints.iter().zip(torques.iter());
    let windups = joints.filter_map(|(joint, torque)| {
        let stiffness = joint.transmission.stiffness?;
        Some((joint, *torque, stiffness, torque.abs() / stiffness))
    });
    let Some((joint, torque, stiffness, windup)) = windups.max_by(|a, b| a.3.total_cmp(&b.3))
    else {
        return String::new();
    };
    let (by, meaning) = in_user_units(joint, windup);
    let effort = joint.kind.effort_unit();
    let file = match &robot.config_path {
        Some(file) => format!(" of {}", file.display()),
        None => String::new(),
    };
    format!(
        "; at the commanded posture {:.1} {effort} wind the joint \"{}\" up most, by {by}: its stiffness is {stiffness} \
         {effort}/{}{file}{meaning}",
        torque.abs(),
        joint.name,
        joint.kind.coordinate_unit(),
    )
}

/// A wind-up as a reader has it, and what it says of the stiffness.
fn in_user_units(joint: &Joint, windup: f64) -> (String, String) {
    match joint.kind {
        JointKind::Prismatic => (format!("{:.3} mm", 1e3 * windup), String::new()),
        JointKind::Revolute => {
            let most = MOST_WINDUP_RAD.to_degrees();
            let meaning = match windup > MOST_WINDUP_RAD {
                true => format!(
                    ", and no arm's winds up by {most:.0} deg{}",
                    of_sheets(windup)
                ),
                false => String::new(),
            };
            (format!("{:.1} deg", windup.to_degrees()), meaning)
        }
    }
}

/// The unit that was probably meant where a joint winds up by so much, rad.
fn of_sheets(windup: f64) -> String {
    match windup / ARCMIN_PER_RAD <= MOST_WINDUP_RAD {
        true => {
            format!("; if it is one in N m/arcmin, it is {ARCMIN_PER_RAD:.1} times as many N m/rad")
        }
        false => String::new(),
    }
}
