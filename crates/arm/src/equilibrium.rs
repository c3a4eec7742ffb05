//! Static equilibrium of the arm on its transmissions: K (q − command) + g(q) = J(q)ᵀ w.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::doubts::most_wound;
use crate::dynamics::Dynamics;
use crate::error::{ArmError, ArmErrorKind};
use crate::model::Robot;
use crate::tangent::Load;

const MAX_ITERATIONS: usize = 50;
/// Torque balance counts as reached when it is off by less than this share of the torques in it,
/// a few hundred times the rounding of a sum of n products.
const RELATIVE_RESIDUAL: f64 = 1e-13;

impl Robot {
    /// Torques that the load puts into the transmissions: g(q) − Jᵀw (N m or N).
    ///
    /// # Panics
    /// If `q` does not have one value per joint.
    #[must_use]
    pub fn load_torques(&self, q: &[f64], load: &Load) -> DVector<f64> {
        self.load_torques_with(&mut Dynamics::new(self), q, load)
    }

    fn load_torques_with(&self, dynamics: &mut Dynamics, q: &[f64], load: &Load) -> DVector<f64> {
        let mut tau = DVector::zeros(self.dof());
        if let Some(gravity) = load
            .gravity_m_s2
            .as_ref()
            .filter(|g| **g != Vector3::zeros())
        {
            dynamics.gravity_torques_into(q, gravity, tau.as_mut_slice());
        }
        if let Some((frame, wrench)) = &load.wrench {
            tau -= self.jacobian(q, *frame).tr_mul(wrench);
        }
        tau
    }

    /// The command (rad or m) at which the arm rests at posture `q` under `load`:
    /// q + K⁻¹ (g(q) − Jᵀw).
    ///
    /// # Errors
    /// If a joint has no stiffness, or `q` the wrong length.
    pub fn holding_command(&self, q: &[f64], load: &Load) -> Result<Vec<f64>, ArmError> {
        let mut commands = self.holding_commands(std::slice::from_ref(&q), load)?;
        Ok(commands.remove(0))
    }

    /// [`Robot::holding_command`] of many postures under the same load.
    ///
    /// # Errors
    /// As [`Robot::holding_command`].
    pub fn holding_commands<Posture: AsRef<[f64]>>(
        &self,
        postures: &[Posture],
        load: &Load,
    ) -> Result<Vec<Vec<f64>>, ArmError> {
        let stiffness = self.transmission_stiffness("the holding command")?;
        let mut dynamics = Dynamics::new(self);
        let command = |q: &Posture| {
            let q = q.as_ref();
            self.check_length(q)?;
            let tau = self.load_torques_with(&mut dynamics, q, load);
            Ok((0..self.dof())
                .map(|i| q[i] + tau[i] / stiffness[(i, i)])
                .collect())
        };
        postures.iter().map(command).collect()
    }

    /// The posture (rad or m) in which the arm rests under `load` when it is commanded to
    /// `command`, by Newton's method from there.
    ///
    /// # Errors
    /// If a joint has no stiffness, `command` has the wrong length, or no stable equilibrium is
    /// found.
    pub fn static_posture(&self, command: &[f64], load: &Load) -> Result<Vec<f64>, ArmError> {
        self.check_length(command)?;
        let stiffness = self.transmission_stiffness("the static posture")?;
        let command = DVector::from_column_slice(command);
        let mut q = command.clone();
        let mut residual = f64::INFINITY;
        let mut limit = 0.0;
        let mut largest: f64 = 0.0;
        for _ in 0..MAX_ITERATIONS {
            let tau = self.load_torques(q.as_slice(), load);
            let spring = &stiffness * (&q - &command);
            let defect = &spring + &tau;
            residual = defect.amax();
            // Rounding of q itself is worth K ε |q| of torque.
            let rounding = (&stiffness * &q).amax() + (&stiffness * &command).amax();
            // Torques met on the way: at the end they may cancel, their rounding does not.
            largest = largest.max(tau.amax() + spring.amax());
            limit = RELATIVE_RESIDUAL * largest + f64::EPSILON * rounding;
            let tangent = self.tangent_stiffness(q.as_slice(), load)?;
            if residual <= limit {
                let wound = || self.wound_most(command.as_slice(), load);
                check_stable(&tangent, wound)?;
                return Ok(q.as_slice().to_vec());
            }
            let Some(step) = tangent.lu().solve(&defect) else {
                break;
            };
            q -= step;
        }
        Err(ArmErrorKind::NoEquilibrium {
            iterations: MAX_ITERATIONS,
            residual,
            limit,
            wound: self.wound_most(command.as_slice(), load),
        }
        .into())
    }

    /// What an error adds of the springs, which may be far too soft.
    fn wound_most(&self, command: &[f64], load: &Load) -> String {
        most_wound(self, &self.load_torques(command, load))
    }
}

/// An arm rests only where any small displacement takes work.
fn check_stable(tangent: &DMatrix<f64>, wound: impl Fn() -> String) -> Result<(), ArmError> {
    let symmetric = (tangent + tangent.transpose()) * 0.5;
    let smallest = symmetric.symmetric_eigenvalues().min();
    if smallest > 0.0 {
        return Ok(());
    }
    Err(ArmErrorKind::UnstableEquilibrium {
        stiffness: smallest,
        wound: wound(),
    }
    .into())
}
