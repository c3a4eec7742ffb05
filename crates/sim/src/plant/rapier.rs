//! The arm as a rapier multibody, stepped to second order.
//!
//! rapier's multibody step is symplectic Euler, `v⁺ = v⁻ + dt a(q, v⁻)`, `q⁺ = q + dt v⁺`. Read
//! with velocities at half steps it is the leapfrog scheme and of second order, provided that
//!
//! 1. the first velocity is that of half a step before the start,
//! 2. torques that depend on velocity use the velocity at the whole step: the joint damping is
//!    taken half explicitly at v⁻, half implicitly at v⁺ (trapezoid), other laws see an
//!    extrapolated velocity,
//! 3. the Coriolis and gyroscopic terms, which rapier evaluates at v⁻ and damps, are put right:
//!    after each step our own inverse dynamics at `(q, (v⁻+v⁺)/2, (v⁺-v⁻)/dt)` gives the torque
//!    that the step *should* have had, and the defect is returned in the next step.
//!
//! The scheme has no numerical damping; its frequency error is `(ω dt)²/24`.

use super::world::World;
use super::{Command, Drive, FrameState, JointState, Plant, WorldWrench};
use crate::loads::Attachment;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Isometry3, Matrix6xX, Vector3};
use truecut_arm::{Dynamics, Robot};

/// The arm in rapier.
pub struct RapierPlant {
    robot: Robot,
    gravity_m_s2: Vector3<f64>,
    dt_s: f64,
    world: World,
    dynamics: Dynamics,
    drive: Drive,
    joints: JointState,
    tool: FrameState,
    foot: FrameState,
    axes: Vec<Vector3<f64>>,
    /// Velocities at the last two half steps.
    half: DVector<f64>,
    half_before: DVector<f64>,
    /// Generalised torques of this step, all but gravity and implicit damping.
    applied: DVector<f64>,
    /// Torques of `applied` that are injected at the joints.
    at_joints: DVector<f64>,
    wrenches: Vec<WorldWrench>,
    defect: DVector<f64>,
    free: DVector<f64>,
    mass: DMatrix<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
    scratch: Vec<f64>,
    started: bool,
}

impl RapierPlant {
    /// The arm at rest at posture `q`, with its drives.
    pub fn new(
        robot: &Robot,
        q: &[f64],
        command: &[f64],
        drive: Drive,
        gravity_m_s2: Vector3<f64>,
        dt_s: f64,
    ) -> Self {
        let n = robot.dof();
        let implicit: Vec<f64> = (0..n).map(|i| 0.5 * drive.damping(i)).collect();
        let frame = FrameState {
            world_from_frame: Isometry3::identity(),
            jacobian: Matrix6xX::zeros(n),
        };
        let mut plant = Self {
            world: World::new(robot, q, &gravity_m_s2, &implicit, dt_s),
            dynamics: Dynamics::new(robot),
            robot: robot.clone(),
            gravity_m_s2,
            dt_s,
            drive,
            joints: JointState::at_rest(q, command),
            tool: frame.clone(),
            foot: frame,
            axes: vec![Vector3::zeros(); n],
            half: DVector::zeros(n),
            half_before: DVector::zeros(n),
            applied: DVector::zeros(n),
            at_joints: DVector::zeros(n),
            wrenches: Vec::new(),
            defect: DVector::zeros(n),
            free: DVector::zeros(n),
            mass: DMatrix::zeros(n, n),
            factor: None,
            scratch: vec![0.0; n],
            started: false,
        };
        plant.update_frames();
        plant
    }

    /// The same arm with its joints moving at the start.
    pub(crate) fn moving(mut self, velocity: &[f64]) -> Self {
        self.joints.velocity.copy_from_slice(velocity);
        self.half.copy_from_slice(velocity);
        self.half_before.copy_from_slice(velocity);
        self.drive.start_at(velocity);
        self
    }

    fn update_frames(&mut self) {
        let q = &self.joints.position;
        let mut pose = Isometry3::identity();
        for (i, (joint, q)) in self.robot.chain.joints.iter().zip(q).enumerate() {
            pose *= joint.parent_from_link(*q);
            self.axes[i] = pose * joint.axis.into_inner();
        }
        for (attachment, state) in [
            (Attachment::Tool, &mut self.tool),
            (Attachment::Foot, &mut self.foot),
        ] {
            let frame = attachment.into();
            self.dynamics.jacobian_into(q, frame, &mut state.jacobian);
            state.world_from_frame = pose * self.robot.last_link_from_frame(frame);
        }
    }

    /// Damping torque of the half of the link's own damping that is explicit, and of the whole for
    /// the prediction.
    fn damping_torque(&self, joint: usize, share: f64) -> f64 {
        -share * self.drive.damping(joint) * self.half[joint]
    }

    /// Starts the scheme half a step before t = 0: with the step's own change of velocity Δv, the
    /// first velocity is `v0 - Δv/2`.
    fn start(&mut self, contacts: &DVector<f64>) {
        self.free_velocity();
        let change = self.free.clone() + self.mobility(&(contacts * self.dt_s)) - &self.half;
        self.half -= &change * 0.5;
        self.half_before = self.half.clone();
        self.world.set_velocity(&self.half);
        self.started = true;
    }

    /// Hands this step's torques and wrenches to rapier.
    fn inject(&mut self, contacts: &[WorldWrench]) {
        self.world
            .add_joint_torques(self.at_joints.as_slice(), &self.axes);
        for (attachment, wrench) in self.wrenches.iter().chain(contacts) {
            let point = match attachment {
                Attachment::Tool => self.tool.world_from_frame.translation.vector,
                Attachment::Foot => self.foot.world_from_frame.translation.vector,
            };
            let force = wrench.fixed_rows::<3>(0).into_owned();
            let moment = wrench.fixed_rows::<3>(3).into_owned();
            self.world.add_wrench(&force, &moment, &point);
        }
    }

    /// The torque that rapier's step lacked (see the module's text).
    fn update_defect(&mut self, after: &DVector<f64>) {
        let n = self.dof();
        let acceleration: Vec<f64> = (0..n)
            .map(|i| (after[i] - self.half[i]) / self.dt_s)
            .collect();
        self.dynamics.inverse_dynamics_into(
            &self.joints.position,
            &self.joints.velocity,
            &acceleration,
            &self.gravity_m_s2,
            &mut self.scratch,
        );
        for i in 0..n {
            let implicit = -0.5 * self.drive.damping(i) * after[i];
            self.defect[i] = self.scratch[i] - self.applied[i] - implicit;
        }
    }
}

impl Plant for RapierPlant {
    fn dof(&self) -> usize {
        self.joints.position.len()
    }

    fn time_step_s(&self) -> f64 {
        self.dt_s
    }

    fn joints(&self) -> &JointState {
        &self.joints
    }

    fn frame(&self, attachment: Attachment) -> &FrameState {
        match attachment {
            Attachment::Tool => &self.tool,
            Attachment::Foot => &self.foot,
        }
    }

    fn begin(&mut self, command: Command<'_>, wrenches: &[WorldWrench]) {
        self.drive
            .evaluate(command, &mut self.joints, &mut self.scratch);
        for i in 0..self.dof() {
            self.at_joints[i] = self.scratch[i] + self.damping_torque(i, 0.5) - self.defect[i]
                + self.drive.coupled_torque(i, &self.joints);
        }
        self.applied.copy_from(&self.at_joints);
        self.wrenches.clear();
        self.wrenches.extend_from_slice(wrenches);
        for (attachment, wrench) in wrenches {
            let jacobian = match attachment {
                Attachment::Tool => &self.tool.jacobian,
                Attachment::Foot => &self.foot.jacobian,
            };
            self.applied.gemv_tr(1.0, jacobian, wrench, 1.0);
        }
        self.factor = None;
    }

    fn half_step_velocity(&self) -> &DVector<f64> {
        &self.half
    }

    fn free_velocity(&mut self) -> &DVector<f64> {
        let n = self.dof();
        self.dynamics.bias_into(
            &self.joints.position,
            &self.joints.velocity,
            &self.gravity_m_s2,
            &mut self.scratch,
        );
        let torque = DVector::from_fn(n, |i, _| {
            // `applied` holds half of the damping at v⁻ and the defect, which is rapier's, not
            // ours.
            self.applied[i] + self.defect[i] + self.damping_torque(i, 0.5) - self.scratch[i]
        });
        let change = self.mobility(&(torque * self.dt_s));
        self.free = &self.half + change;
        &self.free
    }

    fn mobility(&mut self, impulse: &DVector<f64>) -> DVector<f64> {
        if self.factor.is_none() {
            self.dynamics
                .mass_matrix_into(&self.joints.position, &mut self.mass);
            for i in 0..self.dof() {
                self.mass[(i, i)] += 0.5 * self.dt_s * self.drive.damping(i);
            }
            self.factor = Cholesky::new(self.mass.clone());
        }
        match &self.factor {
            Some(factor) => factor.solve(impulse),
            // Only a state that has already left the numbers has no factor; the guard will say so.
            None => DVector::repeat(impulse.len(), f64::NAN),
        }
    }

    fn finish(&mut self, contacts: &[WorldWrench], joint_torques: &DVector<f64>) {
        let mut from_contacts = joint_torques.clone();
        for (attachment, wrench) in contacts {
            let jacobian = &self.frame(*attachment).jacobian;
            from_contacts.gemv_tr(1.0, jacobian, wrench, 1.0);
        }
        if !self.started {
            self.start(&from_contacts);
        }
        self.applied += &from_contacts;
        self.at_joints += joint_torques;
        self.inject(contacts);
        self.world.step();
        let mut after = DVector::zeros(self.dof());
        self.world.velocity(after.as_mut_slice());
        for i in 0..self.dof() {
            self.joints.velocity[i] = 0.5 * (self.half[i] + after[i]);
        }
        self.drive.advance(&mut self.joints);
        for i in 0..self.dof() {
            self.joints.transmission[i] = self.drive.transmission(i, &self.joints);
            self.joints.drive[i] = self.drive.drive_force(i, &self.joints);
        }
        self.update_defect(&after);
        self.half_before = std::mem::replace(&mut self.half, after);
    }

    fn drift(&mut self) {
        for i in 0..self.dof() {
            self.joints.position[i] += self.half[i] * self.dt_s;
            self.joints.velocity[i] = 1.5 * self.half[i] - 0.5 * self.half_before[i];
        }
        self.drive.drift(&mut self.joints);
        self.update_frames();
    }

    fn energy_j(&mut self) -> (f64, f64) {
        let energy = self.dynamics.energy(
            &self.joints.position,
            &self.joints.velocity,
            &self.gravity_m_s2,
        );
        let (elastic, rotors) = self.drive.energy_j(&self.joints);
        (energy.kinetic_j + rotors, energy.potential_j + elastic)
    }

    fn drive_power_w(&self) -> f64 {
        self.drive.power_w(&self.joints)
    }

    fn drive_torque(&self, joint: usize) -> f64 {
        self.drive.torque(joint, &self.joints)
    }

    fn dissipation_w(&self) -> f64 {
        self.drive.dissipation_w(&self.joints)
    }

    fn link_poses(&self) -> Vec<Isometry3<f64>> {
        self.robot.world_from_links(&self.joints.position)
    }
}

#[cfg(test)]
mod tests {
    use super::super::JointLaw;
    use super::*;
    use std::path::Path;
    use truecut_scenario::DriveKind;

    fn falling_arm(dt_s: f64) -> RapierPlant {
        let urdf = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../assets/robots/irb6600_175_255/robot.urdf");
        let robot = Robot::load(&urdf, None, None).expect("asset");
        let q = [0.3, -0.2, 0.4, 0.1, 0.5, -0.3];
        let drive = Drive::new(
            DriveKind::Force,
            &robot,
            0,
            &vec![JointLaw::default(); 6],
            dt_s,
        );
        RapierPlant::new(
            &robot,
            &q,
            &q,
            drive,
            truecut_arm::standard_gravity_m_s2(),
            dt_s,
        )
    }

    /// Starts a step without command or load.
    fn begin_free(plant: &mut RapierPlant) {
        let position = plant.joints().position.clone();
        let command = Command {
            position: &position,
            velocity: &[0.0; 6],
            force: &[0.0; 6],
        };
        plant.begin(command, &[]);
    }

    /// rapier integrates its own joint coordinates; ours run beside them. They must be the same
    /// arm.
    #[test]
    fn verify_rapiers_links_stand_where_our_kinematics_puts_them() {
        let mut plant = falling_arm(2.5e-4);
        for _ in 0..400 {
            begin_free(&mut plant);
            plant.finish(&[], &DVector::zeros(6));
            plant.drift();
        }
        assert!(plant.joints().velocity.iter().any(|v| v.abs() > 0.1));
        for (i, ours) in plant.link_poses().iter().enumerate() {
            let theirs = plant.world.link_pose(i);
            let apart = (ours.translation.vector - theirs.translation.vector).norm();
            assert!(apart < 1e-12, "link {i}: {apart}");
            assert!(ours.rotation.angle_to(&theirs.rotation) < 1e-7, "link {i}");
        }
    }

    /// The prediction that contacts are solved with is the velocity that rapier then arrives at.
    #[test]
    fn verify_free_velocity_is_the_velocity_of_the_step() {
        let mut plant = falling_arm(2.5e-4);
        for step in 0..400 {
            begin_free(&mut plant);
            let predicted = plant.free_velocity().clone();
            plant.finish(&[], &DVector::zeros(6));
            let got = plant.half_step_velocity();
            if step > 2 {
                let error = (got - &predicted).amax() / got.amax();
                assert!(error < 1e-5, "step {step}: {error}");
            }
            plant.drift();
        }
    }
}
