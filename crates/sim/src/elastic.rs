//! The arm as an elastic structure, for identification: how it gives under a load, and how it
//! rings.

use nalgebra::{DMatrix, Isometry3, Matrix3, Matrix6xX, Point3, Vector3, Vector6};
use truecut_arm::{ArmError, FrameId, JointKind, Load, Robot, standard_gravity_m_s2};
use truecut_scenario::RobotSpec;
use truecut_scenario::identification::{Axes, HammerPoint};

use crate::build::load_robot;
use crate::error::SimError;
use crate::posture::posture;

/// An arm at rest in the posture of its file.
#[derive(Debug, Clone)]
pub struct ElasticArm {
    robot: Robot,
    gravity_m_s2: Option<Vector3<f64>>,
    posture: Vec<f64>,
}

/// A joint as identification sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticJoint {
    /// Name in the URDF.
    pub name: String,
    /// Rotary, or else prismatic.
    pub rotary: bool,
    /// Transmission stiffness that robot.toml gives, N m/rad or N/m.
    pub stiffness: Option<f64>,
}

/// What a load does to an arm.
#[derive(Debug, Clone)]
pub struct Deflection {
    /// Displacement and small rotation of the observed frame, world axes (m, rad), from the arm
    /// without the load.
    pub motion: Vector6<f64>,
    /// Derivatives of `motion` by the compliances of the joints, 6×n.
    pub by_compliance: Matrix6xX<f64>,
}

/// A mode of the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmMode {
    /// Undamped natural frequency, Hz.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Mass-normalised shape in joint space.
    pub shape: Vec<f64>,
}

impl ElasticArm {
    /// Reads the arm's files.
    ///
    /// # Errors
    /// Whatever is wrong with them, or with the posture.
    pub fn load(spec: &RobotSpec) -> Result<ElasticArm, SimError> {
        let robot = load_robot(spec)?;
        Ok(ElasticArm {
            posture: posture(spec, &robot)?,
            gravity_m_s2: spec.gravity.then(standard_gravity_m_s2),
            robot,
        })
    }

    /// The joints, in chain order.
    pub fn joints(&self) -> Vec<ElasticJoint> {
        let joints = self.robot.chain.joints.iter();
        joints
            .map(|joint| ElasticJoint {
                name: joint.name.clone(),
                rotary: joint.kind == JointKind::Revolute,
                stiffness: joint.transmission.stiffness,
            })
            .collect()
    }

    /// The posture of the file, rad and m.
    pub fn posture(&self) -> &[f64] {
        &self.posture
    }

    /// The same arm with other transmission stiffnesses, one for each joint.
    #[must_use]
    pub fn with_stiffness(&self, stiffness: &[f64]) -> ElasticArm {
        let mut arm = self.clone();
        for (joint, value) in arm.robot.chain.joints.iter_mut().zip(stiffness) {
            joint.transmission.stiffness = Some(*value);
        }
        arm
    }

    /// Whether a posture keeps the limits of the joints.
    ///
    /// # Errors
    /// The joint, its value and its limits.
    pub fn check_posture(&self, q: &[f64]) -> Result<(), ArmError> {
        self.robot.check_posture(q)
    }

    /// World from the axes that components are given in.
    pub fn world_from_axes(&self, q: &[f64], axes: Axes) -> Matrix3<f64> {
        let of = |pose: Isometry3<f64>| pose.rotation.to_rotation_matrix().into_inner();
        match axes {
            Axes::World => Matrix3::identity(),
            Axes::Tool => of(self.robot.world_from_frame(q, FrameId::Tool)),
            Axes::Process => of(self.robot.world_from_process(q)),
        }
    }

    /// What a wrench (N, N m; world axes) on the frame `loaded` does to the frame `observed`. The
    /// controller holds the motors at `command`; gravity acts before and after.
    ///
    /// # Errors
    /// If the arm finds no rest.
    pub fn deflection(
        &self,
        command: &[f64],
        loaded: FrameId,
        observed: FrameId,
        wrench: Vector6<f64>,
    ) -> Result<Deflection, SimError> {
        let robot = &self.robot;
        let free = Load {
            gravity_m_s2: self.gravity_m_s2,
            wrench: None,
        };
        let under_load = free.with_wrench(loaded, wrench);
        let before = robot.static_posture(command, &free)?;
        let after = robot.static_posture(command, &under_load)?;
        let poses = [&before, &after].map(|q| robot.world_from_frame(q, observed));
        let turned = (poses[1].rotation * poses[0].rotation.inverse()).scaled_axis();
        let moved = poses[1].translation.vector - poses[0].translation.vector;
        // δ(q − command) = C δτ + δC τ, and τ itself changes by −(tangent − K) δq.
        let stiffness = robot.transmission_stiffness("the deflection")?;
        let tangent = robot.tangent_stiffness(&after, &under_load)?;
        let torque = robot.load_torques(&before, &free) - robot.load_torques(&after, &under_load);
        let spread = tangent
            .lu()
            .solve(&stiffness)
            .ok_or(truecut_arm::ArmErrorKind::SingularCompliance)
            .map_err(ArmError::from)?;
        let jacobian = robot.jacobian(&after, observed);
        let by_torque = DMatrix::from_fn(6, robot.dof(), |r, c| jacobian[(r, c)]) * spread;
        Ok(Deflection {
            motion: Vector6::new(moved.x, moved.y, moved.z, turned.x, turned.y, turned.z),
            by_compliance: Matrix6xX::from_fn(robot.dof(), |r, c| by_torque[(r, c)] * torque[c]),
        })
    }

    /// Modes in the posture of the file, slowest first.
    ///
    /// # Errors
    /// If a joint has no stiffness, or the arm is not stable there.
    pub fn modes(&self) -> Result<Vec<ArmMode>, SimError> {
        let modes = (self.robot).modes(&self.posture, self.gravity_m_s2.as_ref())?;
        let numbers = modes.frequency_hz.iter().zip(&modes.damping_ratio);
        Ok(numbers
            .zip(modes.shapes.column_iter())
            .map(|((frequency_hz, damping_ratio), shape)| ArmMode {
                frequency_hz: *frequency_hz,
                damping_ratio: *damping_ratio,
                shape: shape.iter().copied().collect(),
            })
            .collect())
    }

    /// Mass of the arm at its tool point along a direction of length 1 in the tool frame, rotation
    /// and the other directions free, in the posture of the file: 1/(nᵀJM⁻¹Jᵀn), kg.
    ///
    /// # Errors
    /// If the mass matrix is singular.
    pub fn mass_at_tool_kg(&self, direction: &Vector3<f64>) -> Result<f64, SimError> {
        let (robot, q) = (&self.robot, &self.posture);
        let direction = robot.tool_axes(q) * direction;
        let row = robot
            .jacobian(q, FrameId::Tool)
            .fixed_rows::<3>(0)
            .tr_mul(&direction);
        let factor = robot.mass_matrix(q).cholesky();
        let factor = factor.ok_or(truecut_arm::ArmErrorKind::SingularMassMatrix);
        let moved = factor.map_err(ArmError::from)?.solve(&row);
        Ok(1.0 / row.dot(&moved))
    }

    /// Motion of a hammer point along its direction per unit of joint motion, in the posture of the
    /// file.
    pub fn along(&self, at: &HammerPoint, axes: Axes) -> Vec<f64> {
        let robot = &self.robot;
        let pose = robot.world_from_frame(&self.posture, at.frame);
        let offset = pose * Point3::from(at.offset_m) - Point3::from(pose.translation.vector);
        let direction =
            self.world_from_axes(&self.posture, axes) * Vector3::from_column_slice(&at.direction);
        let jacobian = robot.jacobian(&self.posture, at.frame);
        (jacobian.column_iter())
            .map(|column| {
                let linear: Vector3<f64> = column.fixed_rows::<3>(0).into();
                let angular: Vector3<f64> = column.fixed_rows::<3>(3).into();
                direction.dot(&(linear + angular.cross(&offset)))
            })
            .collect()
    }
}
