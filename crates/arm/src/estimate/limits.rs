//! Limits of the drives: the URDF's, unless they could not hold the arm.

use nalgebra::Vector3;

use super::{JointEstimate, LIMIT_PER_TORQUE, MASS_FACTOR};
use crate::dynamics::Dynamics;
use crate::model::{FrameId, JointKind, Robot, standard_gravity_m_s2};

/// Where an effort of the URDF is less than this part of what gravity asks, the drive could not
/// hold the arm, whose masses are known within a factor: a placeholder.
const WEAKEST_DRIVE: f64 = 1.0 / MASS_FACTOR;
/// Postures among which the one is found in which gravity asks most of a joint.
const POSTURES: usize = 1000;

/// Where the limit of a drive comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LimitRule {
    /// The URDF's effort.
    Given,
    /// By the torque that the joint is sized for, since the URDF has none.
    Missing,
    /// Likewise, since the URDF's effort does not hold the arm.
    TooWeak(f64),
}

/// The limit by the URDF's effort, else by the torque that the joint is sized for.
pub(super) fn limit(effort: Option<f64>, torque: f64) -> (f64, LimitRule) {
    match effort.filter(|effort| effort.is_finite() && *effort > 0.0) {
        Some(effort) => (effort, LimitRule::Given),
        None => (LIMIT_PER_TORQUE * torque, LimitRule::Missing),
    }
}

/// Replaces limits of the URDF that are far from holding the arm with its payload, and tells them;
/// and those that are kept although they do not hold it everywhere. `torque` is what each joint is
/// sized for.
pub(super) fn replace_weak(
    robot: &Robot,
    payload_kg: f64,
    torque: impl Fn(usize) -> f64,
    joints: &mut [JointEstimate],
) -> Vec<String> {
    let held = largest_gravity_torques(robot, payload_kg);
    let (mut replaced, mut kept) = (Vec::new(), Vec::new());
    for (index, (estimate, held)) in joints.iter_mut().zip(held).enumerate() {
        let effort = estimate.torque_limit;
        if estimate.limit != LimitRule::Given || effort >= held {
            continue;
        }
        let name = &robot.chain.joints[index].name;
        let told = format!("{name} ({effort} of {held:.0})");
        if effort >= WEAKEST_DRIVE * held {
            kept.push(told);
            continue;
        }
        estimate.torque_limit = LIMIT_PER_TORQUE * torque(index);
        estimate.limit = LimitRule::TooWeak(effort);
        replaced.push(told);
    }
    let units = "(N m, or N, of what gravity asks in some posture)";
    let notes = [
        (
            replaced,
            format!(
                "effort limits of the file that do not hold the arm with its payload are placeholders, it seems, \
                 and are not used {units}"
            ),
        ),
        (
            kept,
            format!(
                "effort limits of the file are kept that hold the arm with its payload in some postures only \
                 {units}; runs elsewhere end as overloaded, unless links are lighter than estimated"
            ),
        ),
    ];
    let told = notes.into_iter().filter(|(joints, _)| !joints.is_empty());
    told.map(|(joints, what)| format!("{what}: {}", joints.join(", ")))
        .collect()
}

/// The largest that gravity asks of each joint with the payload at the flange, over postures that
/// fill the limits evenly.
fn largest_gravity_torques(robot: &Robot, payload_kg: f64) -> Vec<f64> {
    let gravity_m_s2 = standard_gravity_m_s2();
    let weight_n: Vector3<f64> = gravity_m_s2 * payload_kg;
    let mut dynamics = Dynamics::new(robot);
    let mut largest = vec![0.0_f64; robot.dof()];
    let mut torques = vec![0.0; robot.dof()];
    for number in 0..POSTURES {
        let q = posture(robot, number);
        dynamics.gravity_torques_into(&q, &gravity_m_s2, &mut torques);
        let jacobian = robot.jacobian(&q, FrameId::Flange);
        for (joint, largest) in largest.iter_mut().enumerate() {
            let lever: Vector3<f64> = jacobian.fixed_view::<3, 1>(0, joint).into();
            // The drive carries the links and the payload.
            let asked = torques[joint] - lever.dot(&weight_n);
            *largest = largest.max(asked.abs());
        }
    }
    largest
}

/// Postures of the additive recurrence over powers of the generalised golden ratio (Roberts 2018),
/// which fills the limits evenly.
fn posture(robot: &Robot, number: usize) -> Vec<f64> {
    let dof = robot.dof() as f64;
    // The root of x^(d + 1) = x + 1; the map contracts towards it.
    let root = (0..60).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / (dof + 1.0)));
    let joints = robot.chain.joints.iter().zip(1..);
    let coordinate = |(joint, power): (&crate::model::Joint, i32)| {
        let share = (0.5 + number as f64 * root.powi(-power)).fract();
        let whole = match joint.kind {
            JointKind::Revolute => std::f64::consts::PI,
            JointKind::Prismatic => 1.0,
        };
        let bounds = joint.limits.map_or((-whole, whole), |limits| {
            (limits.lower.max(-whole), limits.upper.min(whole))
        });
        bounds.0 + (bounds.1 - bounds.0) * share
    };
    joints.map(coordinate).collect()
}
