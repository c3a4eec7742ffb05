//! The rapier world of one arm: bodies, joints, pipeline. rapier's own math types end here.

use nalgebra::{DVector, Isometry3, Matrix3, SymmetricEigen, UnitQuaternion, Vector3};
use rapier3d_f64::glamx::{DMat3, DQuat, DVec3};
use rapier3d_f64::prelude::{
    BroadPhaseBvh, CCDSolver, ColliderSet, GenericJointBuilder, ImpulseJointSet,
    IntegrationParameters, IslandManager, JointAxesMask, MassProperties, MultibodyJointHandle,
    MultibodyJointSet, NarrowPhase, PhysicsPipeline, Pose, RigidBodyBuilder, RigidBodyHandle,
    RigidBodySet, SoftBodySet,
};
use truecut_arm::{JointKind, Link, Robot};

/// One multibody on a fixed root.
pub(super) struct World {
    gravity: DVec3,
    parameters: IntegrationParameters,
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd: CCDSolver,
    links: Vec<RigidBodyHandle>,
    tip: MultibodyJointHandle,
    joints: Vec<(JointKind, Vector3<f64>)>,
}

fn to_vec(v: &Vector3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

fn to_quat(q: &UnitQuaternion<f64>) -> DQuat {
    DQuat::from_xyzw(q.i, q.j, q.k, q.w)
}

fn to_pose(p: &Isometry3<f64>) -> Pose {
    Pose::from_parts(to_vec(&p.translation.vector), to_quat(&p.rotation))
}

fn mass_properties(link: &Link) -> MassProperties {
    let eigen = SymmetricEigen::new(link.inertia_about_com_kg_m2);
    let mut axes: Matrix3<f64> = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let turn = DQuat::from_mat3(&DMat3::from_cols_slice(axes.as_slice()));
    MassProperties::with_principal_inertia_frame(
        to_vec(&link.com_m),
        link.mass_kg,
        to_vec(&eigen.eigenvalues.map(|i| i.max(0.0))),
        turn.normalize(),
    )
}

impl World {
    /// Builds the arm at posture `q`, at rest, with the given implicit joint damping.
    pub(super) fn new(
        robot: &Robot,
        q: &[f64],
        gravity_m_s2: &Vector3<f64>,
        implicit_damping: &[f64],
        dt_s: f64,
    ) -> Self {
        let mut bodies = RigidBodySet::new();
        let mut multibody_joints = MultibodyJointSet::new();
        let root = bodies.insert(RigidBodyBuilder::fixed());
        let mut links = Vec::with_capacity(q.len());
        let mut parent = root;
        let mut tip = None;
        for (joint, link) in robot.chain.joints.iter().zip(&robot.chain.links) {
            let body = bodies.insert(
                RigidBodyBuilder::dynamic()
                    .can_sleep(false)
                    .additional_mass_properties(mass_properties(link)),
            );
            // rapier moves its joints along or about the x axis of the joint frames.
            let axis_from_x = UnitQuaternion::rotation_between(&Vector3::x(), &joint.axis)
                .unwrap_or_else(|| {
                    UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI)
                });
            let mask = match joint.kind {
                JointKind::Revolute => JointAxesMask::LOCKED_REVOLUTE_AXES,
                JointKind::Prismatic => JointAxesMask::LOCKED_PRISMATIC_AXES,
            };
            let data = GenericJointBuilder::new(mask)
                .local_frame1(to_pose(&(joint.parent_from_joint * axis_from_x)))
                .local_frame2(Pose::from_rotation(to_quat(&axis_from_x)))
                .build();
            tip = multibody_joints.insert(parent, body, data, true);
            links.push(body);
            parent = body;
        }
        let mut world = Self {
            gravity: to_vec(gravity_m_s2),
            parameters: IntegrationParameters {
                dt: dt_s,
                // One substep: with more, the injected spring torques would act on positions that
                // have moved on, and the scheme would gain energy.
                num_solver_iterations: 1,
                ..IntegrationParameters::default()
            },
            pipeline: PhysicsPipeline::new(),
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            bodies,
            colliders: ColliderSet::new(),
            impulse_joints: ImpulseJointSet::new(),
            multibody_joints,
            soft_bodies: SoftBodySet::new(),
            ccd: CCDSolver::new(),
            links,
            tip: tip.expect("a chain has at least one joint"),
            joints: (robot.chain.joints.iter())
                .map(|j| (j.kind, j.axis.into_inner()))
                .collect(),
        };
        world.place(q, implicit_damping);
        world
    }

    fn place(&mut self, q: &[f64], implicit_damping: &[f64]) {
        // Until this has run, the centre of mass is taken at the link origin.
        for link in &self.links {
            self.bodies[*link].recompute_mass_properties_from_colliders(&self.colliders);
        }
        let (multibody, _) = self
            .multibody_joints
            .get_mut(self.tip)
            .expect("the arm is there");
        // A first pass drops the six free coordinates that a fixed root still has until then.
        multibody.forward_kinematics(&self.bodies, true);
        multibody.apply_displacements(q);
        for (slot, damping) in multibody.damping_mut().iter_mut().zip(implicit_damping) {
            *slot = *damping;
        }
        multibody.forward_kinematics(&self.bodies, true);
        multibody.update_rigid_bodies(&mut self.bodies, true);
    }

    /// Joint velocities at the last half step.
    pub(super) fn velocity(&self, out: &mut [f64]) {
        let (multibody, _) = self
            .multibody_joints
            .get(self.tip)
            .expect("the arm is there");
        out.copy_from_slice(multibody.generalized_velocity().as_slice());
    }

    /// Sets the joint velocities of the last half step.
    pub(super) fn set_velocity(&mut self, velocity: &DVector<f64>) {
        let (multibody, _) = self
            .multibody_joints
            .get_mut(self.tip)
            .expect("the arm is there");
        multibody.generalized_velocity_mut().copy_from(velocity);
        // The bodies' velocities, from which rapier takes its gyroscopic terms, follow in the first
        // step.
    }

    /// Pose of a link as rapier has it.
    #[cfg(test)]
    pub(super) fn link_pose(&self, link: usize) -> Isometry3<f64> {
        let pose = self.bodies[self.links[link]].position();
        let (t, r) = (pose.translation, pose.rotation);
        Isometry3::from_parts(
            nalgebra::Translation3::new(t.x, t.y, t.z),
            UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(r.w, r.x, r.y, r.z)),
        )
    }

    /// Adds a torque (or force) on every joint, equal and opposite on its two links.
    pub(super) fn add_joint_torques(&mut self, torques: &[f64], world_axes: &[Vector3<f64>]) {
        for (i, torque) in torques.iter().enumerate() {
            let load = to_vec(&(world_axes[i] * *torque));
            let link = self.links[i];
            match self.joints[i].0 {
                JointKind::Revolute => {
                    self.bodies[link].add_torque(load, true);
                    if i > 0 {
                        let parent = self.links[i - 1];
                        self.bodies[parent].add_torque(-load, true);
                    }
                }
                JointKind::Prismatic => {
                    // Both halves of the pair act along one line, through the link's centre of
                    // mass.
                    let point = self.bodies[link].center_of_mass();
                    self.bodies[link].add_force(load, true);
                    if i > 0 {
                        let parent = self.links[i - 1];
                        self.bodies[parent].add_force_at_point(-load, point, true);
                    }
                }
            }
        }
    }

    /// Adds a force at a world point, and a moment, on the last link.
    pub(super) fn add_wrench(
        &mut self,
        force_n: &Vector3<f64>,
        moment_n_m: &Vector3<f64>,
        point_m: &Vector3<f64>,
    ) {
        let Some(last) = self.links.last() else {
            return;
        };
        let body = &mut self.bodies[*last];
        body.add_force_at_point(to_vec(force_n), to_vec(point_m), true);
        body.add_torque(to_vec(moment_n_m), true);
    }

    /// One step; the forces added since the last one are used up.
    pub(super) fn step(&mut self) {
        self.pipeline.step(
            self.gravity,
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd,
            &(),
            &(),
        );
        for link in &self.links {
            let body = &mut self.bodies[*link];
            body.reset_forces(true);
            body.reset_torques(true);
        }
    }
}
