//! The arm linearised about a posture.

use super::recurrence::Recurrence;
use super::{Drive, FrameState};
use nalgebra::{DMatrix, DVector, Matrix6xX, Vector3};
use std::sync::Arc;
use truecut_arm::{Dynamics, FrameId, Robot};

/// What every linearisation of one arm shares.
pub(super) struct Arm {
    pub robot: Arc<Robot>,
    pub gravity_m_s2: Vector3<f64>,
    pub dynamics: Dynamics,
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    step_s: f64,
}

/// What the arm is about one posture.
pub(super) struct Linear {
    pub posture: DVector<f64>,
    pub mass: DMatrix<f64>,
    pub gravity_torque: DVector<f64>,
    pub gravity_stiffness: DMatrix<f64>,
    /// Potential energy of gravity, J.
    pub gravity_j: f64,
    pub tool: FrameState,
    pub foot: FrameState,
    pub recurrence: Recurrence,
}

impl Arm {
    /// `springs` says whether the transmissions' stiffness acts.
    pub(super) fn new(
        robot: Arc<Robot>,
        drive: &Drive,
        springs: bool,
        gravity_m_s2: Vector3<f64>,
        step_s: f64,
    ) -> Self {
        let n = robot.dof();
        let stiffness = |i: usize| robot.chain.joints[i].transmission.stiffness.unwrap_or(0.0);
        let stiffness = DVector::from_fn(n, |i, _| if springs { stiffness(i) } else { 0.0 });
        let damping = DVector::from_fn(n, |i, _| drive.damping_without_play(i));
        Self {
            dynamics: Dynamics::new(&robot),
            stiffness: DMatrix::from_diagonal(&stiffness),
            damping: match drive.coupled_damping() {
                Some(coupled) => DMatrix::from_diagonal(&damping) + coupled,
                None => DMatrix::from_diagonal(&damping),
            },
            robot,
            gravity_m_s2,
            step_s,
        }
    }

    /// The arm about posture `q`; `None` if its mass matrix is singular there, or the step a whole
    /// number of half periods of one of its modes.
    pub(super) fn about(&mut self, q: &[f64]) -> Option<Linear> {
        let n = q.len();
        let mut mass = DMatrix::zeros(n, n);
        self.dynamics.mass_matrix_into(q, &mut mass);
        let mut gravity_torque = DVector::zeros(n);
        let torque = gravity_torque.as_mut_slice();
        (self.dynamics).gravity_torques_into(q, &self.gravity_m_s2, torque);
        let gravity_stiffness = if self.gravity_m_s2 == Vector3::zeros() {
            DMatrix::zeros(n, n)
        } else {
            self.robot.gravity_stiffness(q, &self.gravity_m_s2)
        };
        let stiffness = &self.stiffness + &gravity_stiffness;
        let energy = (self.dynamics).energy(q, &vec![0.0; n], &self.gravity_m_s2);
        Some(Linear {
            recurrence: Recurrence::new(&mass, &self.damping, &stiffness, self.step_s)?,
            gravity_j: energy.potential_j,
            posture: DVector::from_column_slice(q),
            mass,
            gravity_torque,
            gravity_stiffness,
            tool: self.frame(q, FrameId::Tool),
            foot: self.frame(q, FrameId::Foot),
        })
    }

    fn frame(&mut self, q: &[f64], id: FrameId) -> FrameState {
        let mut jacobian = Matrix6xX::zeros(q.len());
        self.dynamics.jacobian_into(q, id, &mut jacobian);
        FrameState {
            world_from_frame: self.robot.world_from_frame(q, id),
            jacobian,
        }
    }
}
