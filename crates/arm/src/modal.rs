//! Natural modes of the arm linearised at a posture,
//! M δq̈ + D δq̇ + K δq = Jᵀ F.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, Robot};
use crate::tangent::Load;

/// Undamped modes with the damping that each sees, slowest first.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    pub frequency_hz: Vec<f64>,
    /// φᵀDφ/(2ω); exact damping ratios if D is proportional to M or K.
    pub damping_ratio: Vec<f64>,
    /// Columns are the joint-space shapes φ, mass-normalised: φᵀMφ = 1, φᵀKφ = ω².
    pub shapes: DMatrix<f64>,
}

/// Mass, damping and stiffness matrices of the arm linearised at a posture.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearArm {
    /// kg m² or kg.
    pub mass: DMatrix<f64>,
    /// N m s/rad or N s/m.
    pub damping: DMatrix<f64>,
    /// N m/rad or N/m.
    pub stiffness: DMatrix<f64>,
    /// Translational rows of the Jacobian of the frame asked for, 3×n, world axes.
    pub tip_jacobian: DMatrix<f64>,
}

impl Robot {
    /// The arm linearised at posture `q`, seen at `frame`. `load` adds gravity and preload to the
    /// stiffness; the rotors are held by their drives and do not take part.
    ///
    /// # Errors
    /// If a joint has no stiffness, or `q` the wrong length.
    pub fn linearised(
        &self,
        q: &[f64],
        frame: FrameId,
        load: &Load,
    ) -> Result<LinearArm, ArmError> {
        let stiffness = self.tangent_stiffness(q, load)?;
        let jacobian = self.jacobian(q, frame);
        let arm = LinearArm {
            mass: self.mass_matrix(q),
            damping: self.transmission_damping(),
            stiffness,
            tip_jacobian: DMatrix::from_fn(3, self.dof(), |r, c| jacobian[(r, c)]),
        };
        if self.damping_ratios.is_empty() {
            return Ok(arm);
        }
        arm.with_damping_ratios(&self.damping_ratios)
    }

    /// Modes at posture `q`; `gravity_m_s2` adds ∂g/∂q to the transmission stiffness.
    ///
    /// # Errors
    /// If a joint has no stiffness, the mass matrix is singular, or the arm is not stable there.
    pub fn modes(&self, q: &[f64], gravity_m_s2: Option<&Vector3<f64>>) -> Result<Modes, ArmError> {
        let load = Load {
            gravity_m_s2: gravity_m_s2.copied(),
            wrench: None,
        };
        self.linearised(q, FrameId::Tool, &load)?.modes()
    }
}

impl Modes {
    /// Says that modes do not swing at all: damping was given in another unit, most likely.
    #[must_use]
    pub fn overdamped_note(&self) -> Option<String> {
        let count = (self.damping_ratio.iter()).filter(|ratio| **ratio > 1.0);
        match count.count() {
            0 => None,
            count => Some(format!(
                "{count} of the modes are damped by more than 100 %: damping in another unit, it seems"
            )),
        }
    }
}

impl LinearArm {
    /// Modes of the symmetric part of the stiffness: (K − ω²M) φ = 0.
    ///
    /// # Errors
    /// If the mass matrix is not positive definite or an eigenvalue is not positive.
    pub fn modes(&self) -> Result<Modes, ArmError> {
        let n = self.mass.nrows();
        let cholesky = self
            .mass
            .clone()
            .cholesky()
            .ok_or(ArmErrorKind::SingularMassMatrix)?;
        let lower = cholesky.l();
        let solve = |m: &DMatrix<f64>| {
            lower
                .solve_lower_triangular(m)
                .ok_or(ArmErrorKind::SingularMassMatrix)
        };
        // A = L⁻¹ K L⁻ᵀ has the eigenvalues ω² and eigenvectors y = Lᵀφ.
        let half = solve(&self.stiffness)?;
        let full = solve(&half.transpose())?;
        let eigen = SymmetricEigen::new((&full + full.transpose()) * 0.5);
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        if let Some(&first) = order.first()
            && eigen.eigenvalues[first] <= 0.0
        {
            return Err(ArmErrorKind::Unstable {
                eigenvalue: eigen.eigenvalues[first],
            }
            .into());
        }
        let mut modes = Modes {
            frequency_hz: Vec::with_capacity(n),
            damping_ratio: Vec::with_capacity(n),
            shapes: DMatrix::zeros(n, n),
        };
        for (column, &k) in order.iter().enumerate() {
            let omega = eigen.eigenvalues[k].sqrt();
            let shape: DVector<f64> = lower
                .tr_solve_lower_triangular(&eigen.eigenvectors.column(k))
                .ok_or(ArmErrorKind::SingularMassMatrix)?;
            modes.frequency_hz.push(omega / TAU);
            modes
                .damping_ratio
                .push(shape.dot(&(&self.damping * &shape)) / (2.0 * omega));
            modes.shapes.set_column(column, &shape);
        }
        Ok(modes)
    }

    /// The same with a damping that gives each mode a damping ratio of its own and couples none:
    /// D = M Φ diag(2ζω) Φᵀ M with the mass-normalised shapes Φ. One ratio is that of all modes;
    /// several are in the order of [`LinearArm::modes`].
    ///
    /// # Errors
    /// As [`LinearArm::modes`].
    ///
    /// # Panics
    /// If there are several ratios, but not one for each mode.
    pub fn with_damping_ratios(mut self, ratios: &[f64]) -> Result<LinearArm, ArmError> {
        let modes = self.modes()?;
        let n = self.mass.nrows();
        assert!(
            [1, n].contains(&ratios.len()),
            "one ratio, or one for each mode"
        );
        let momenta = &self.mass * &modes.shapes;
        let rates = DVector::from_fn(n, |k, _| {
            2.0 * ratios[k.min(ratios.len() - 1)] * TAU * modes.frequency_hz[k]
        });
        self.damping = &momenta * DMatrix::from_diagonal(&rates) * momenta.transpose();
        Ok(self)
    }
}
