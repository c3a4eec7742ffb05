//! Frictional contacts and joint friction, solved together for one step.
//!
//! Every contact sees the plant through `W = J M⁻¹ Jᵀ` and the free velocity. Several of them
//! couple through the plant, so they are swept in order (Gauss–Seidel) until no impulse changes any
//! more; one contact alone is solved in one pass. Where a contact slides over a joint that friction
//! holds, each waits for the other, and hundreds of sweeps may not do: there the contact is solved
//! with the joint held.

use crate::loads::{ContactOutcome, ContactOutcomes, ContactRequest, stacked};
use crate::plant::{Plant, WorldWrench};
use nalgebra::{DVector, Matrix2, Matrix3, Vector2, Vector3};
use truecut_core::friction::{Approach, PlanarContact, solve_planar};
use truecut_core::joint_law::{LinkFriction, solve_link_friction};

/// Most sweeps over all contacts.
const MAX_SWEEPS: usize = 200;
/// Sweeps end when the velocities change by less than this part of the largest.
const TOLERANCE: f64 = 1e-13;
/// Part of its mobility that a held joint keeps while a contact is solved: where both move the same
/// way, nothing would be left to solve with. It does not change what the sweeps converge to.
const LEFT_TO_HELD: f64 = 1e-3;

/// Solves contacts and joint friction, keeping its buffers between steps.
pub(crate) struct ContactSolver {
    /// Friction of every joint.
    joint_friction: Vec<LinkFriction>,
    friction_joints: Vec<usize>,
    planes: Vec<Plane>,
    lines: Vec<Line>,
    /// Joint velocities under the impulses at hand.
    velocity: DVector<f64>,
    pub(crate) joint_torques: DVector<f64>,
    pub(crate) wrenches: Vec<WorldWrench>,
    pub(crate) outcomes: ContactOutcomes,
}

/// One planar contact during the solution.
struct Plane {
    request: ContactRequest,
    rows: [DVector<f64>; 2],
    response: [DVector<f64>; 2],
    /// Largest component of each response.
    largest: [f64; 2],
    inverse_mass: Matrix2<f64>,
    velocity_before: Vector2<f64>,
    contact: PlanarContact,
}

/// Friction of one joint during the solution.
struct Line {
    joint: usize,
    /// Under the load of this step.
    law: LinkFriction,
    response: DVector<f64>,
    /// Its largest component.
    largest: f64,
    velocity_before: f64,
    impulse: f64,
    /// Friction keeps the joint at rest.
    held: bool,
}

impl ContactSolver {
    pub(crate) fn new(joint_friction: Vec<LinkFriction>) -> Self {
        let n = joint_friction.len();
        Self {
            friction_joints: (0..n).filter(|i| !joint_friction[*i].is_none()).collect(),
            joint_friction,
            planes: Vec::new(),
            lines: Vec::new(),
            velocity: DVector::zeros(n),
            joint_torques: DVector::zeros(n),
            wrenches: Vec::new(),
            outcomes: ContactOutcomes::new(),
        }
    }

    /// Solves the requests of one step; results are left in the public fields.
    pub(crate) fn solve(
        &mut self,
        plant: &mut dyn Plant,
        requests: &[ContactRequest],
        world_from_process: &Matrix3<f64>,
    ) {
        self.outcomes.clear();
        self.wrenches.clear();
        if requests.is_empty() && self.friction_joints.is_empty() {
            return;
        }
        let dt = plant.time_step_s();
        let tangents = [
            world_from_process.column(1).into_owned(),
            world_from_process.column(2).into_owned(),
        ];
        self.gather(plant, requests, &tangents);
        let velocity = &mut self.velocity;
        let single = self.planes.len() + self.lines.len() == 1;
        for _ in 0..MAX_SWEEPS {
            let mut change: f64 = 0.0;
            for plane in &mut self.planes {
                change = change.max(update_plane(plane, &mut self.lines, velocity, dt));
            }
            for line in &mut self.lines {
                change = change.max(update_line(line, velocity, dt));
            }
            if single || change <= TOLERANCE * velocity.amax() {
                break;
            }
        }
        self.publish(&tangents, dt);
    }

    /// Contacts and joints of this step, before any impulse. What a linear plant answers is asked
    /// for once.
    fn gather(
        &mut self,
        plant: &mut dyn Plant,
        requests: &[ContactRequest],
        tangents: &[Vector3<f64>; 2],
    ) {
        self.velocity.copy_from(plant.free_velocity());
        let frames = self.planes.iter().map(|plane| plane.request.frame);
        let known = plant.is_linear()
            && frames.eq(requests.iter().map(|request| request.frame))
            && self.lines.len() == self.friction_joints.len();
        if !known {
            self.planes.clear();
            self.planes
                .extend(requests.iter().map(|one| plane(plant, one, tangents)));
            self.lines.clear();
            self.lines.extend(
                (self.friction_joints.iter())
                    .map(|joint| line(plant, *joint, &self.joint_friction[*joint])),
            );
            return;
        }
        let before = plant.half_step_velocity();
        for (plane, request) in self.planes.iter_mut().zip(requests) {
            plane.request = *request;
            plane.velocity_before =
                Vector2::new(plane.rows[0].dot(before), plane.rows[1].dot(before));
            plane.contact = AT_REST;
        }
        for line in &mut self.lines {
            line.law =
                self.joint_friction[line.joint].under(plant.joints().transmission[line.joint]);
            line.velocity_before = before[line.joint];
            line.impulse = 0.0;
            line.held = false;
        }
    }

    fn publish(&mut self, tangents: &[Vector3<f64>; 2], dt: f64) {
        for plane in &self.planes {
            let outcome = ContactOutcome::from_contact(&plane.contact, dt);
            let force = tangents[0] * outcome.friction_n.x + tangents[1] * outcome.friction_n.y;
            let wrench = stacked(&force, &Vector3::zeros());
            self.wrenches.push((plane.request.frame, wrench));
            self.outcomes.push(outcome);
        }
        for line in &self.lines {
            self.joint_torques[line.joint] = line.impulse / dt;
        }
    }
}

/// A contact to which no impulse has been given.
const AT_REST: PlanarContact = PlanarContact {
    impulse_n_s: Vector2::new(0.0, 0.0),
    velocity_m_per_s: Vector2::new(0.0, 0.0),
    sliding: false,
};

fn plane(plant: &mut dyn Plant, request: &ContactRequest, tangents: &[Vector3<f64>; 2]) -> Plane {
    let rows = tangents.each_ref().map(|tangent| {
        let jacobian = &plant.frame(request.frame).jacobian;
        jacobian.fixed_rows::<3>(0).tr_mul(tangent)
    });
    let response = [plant.mobility(&rows[0]), plant.mobility(&rows[1])];
    let inverse_mass = Matrix2::from_fn(|r, c| rows[r].dot(&response[c]));
    let before = plant.half_step_velocity();
    Plane {
        largest: response.each_ref().map(DVector::amax),
        velocity_before: Vector2::new(rows[0].dot(before), rows[1].dot(before)),
        request: *request,
        rows,
        response,
        inverse_mass,
        contact: AT_REST,
    }
}

/// The load is that of the last instant: what the transmission passes on now is known when the step
/// is done.
fn line(plant: &mut dyn Plant, joint: usize, law: &LinkFriction) -> Line {
    let mut unit = DVector::zeros(plant.dof());
    unit[joint] = 1.0;
    let response = plant.mobility(&unit);
    Line {
        joint,
        law: law
            .at(plant.joints().position[joint])
            .under(plant.joints().transmission[joint]),
        largest: response.amax(),
        response,
        velocity_before: plant.half_step_velocity()[joint],
        impulse: 0.0,
        held: false,
    }
}

/// Solves one contact with the others' impulses held; returns how far its velocity row has moved.
/// If it has slid so far, of the joints that friction holds the one that it moves most is kept at
/// rest, and its impulse follows.
fn update_plane(
    plane: &mut Plane,
    lines: &mut [Line],
    velocity: &mut DVector<f64>,
    dt: f64,
) -> f64 {
    let before = plane.contact.impulse_n_s;
    let current = Vector2::new(plane.rows[0].dot(velocity), plane.rows[1].dot(velocity));
    let held = if plane.contact.sliding {
        held_most(&plane.rows, lines)
    } else {
        None
    };
    let inverse_mass = match &held {
        Some((coupling, line)) => {
            let taken = (1.0 - LEFT_TO_HELD) / line.response[line.joint];
            plane.inverse_mass - coupling * coupling.transpose() * taken
        }
        None => plane.inverse_mass,
    };
    let request = &plane.request;
    let body = Approach {
        inverse_mass,
        velocity_before_m_per_s: plane.velocity_before,
        free_velocity_m_per_s: current - inverse_mass * before,
    };
    plane.contact = solve_planar(&body, request.law, request.normal_force_n, dt);
    let change = plane.contact.impulse_n_s - before;
    for axis in 0..2 {
        velocity.axpy(change[axis], &plane.response[axis], 1.0);
    }
    if let Some((coupling, line)) = held {
        let follows = -coupling.dot(&change) / line.response[line.joint];
        line.impulse += follows;
        velocity.axpy(follows, &line.response, 1.0);
    }
    (plane.largest[0] * change.x.abs()).max(plane.largest[1] * change.y.abs())
}

/// Of the joints that friction holds the one that an impulse on the contact would move most, with
/// the contact's velocity per impulse on that joint.
fn held_most<'a>(
    rows: &[DVector<f64>; 2],
    lines: &'a mut [Line],
) -> Option<(Vector2<f64>, &'a mut Line)> {
    let held = lines.iter_mut().filter(|line| line.held);
    let coupled = held.map(|line| {
        let coupling = Vector2::new(rows[0].dot(&line.response), rows[1].dot(&line.response));
        (coupling, line)
    });
    let taken = |(coupling, line): &(Vector2<f64>, &mut Line)| {
        coupling.norm_squared() / line.response[line.joint]
    };
    coupled.max_by(|a, b| taken(a).total_cmp(&taken(b)))
}

fn update_line(line: &mut Line, velocity: &mut DVector<f64>, dt_s: f64) -> f64 {
    let inverse_mass = line.response[line.joint];
    let free = velocity[line.joint] - inverse_mass * line.impulse;
    let impulse = solve_link_friction(inverse_mass, line.velocity_before, free, &line.law, dt_s);
    line.held = impulse == -free / inverse_mass;
    let change = impulse - line.impulse;
    line.impulse = impulse;
    velocity.axpy(change, &line.response, 1.0);
    line.largest * change.abs()
}

#[cfg(test)]
mod tests;
