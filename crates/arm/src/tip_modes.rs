//! The arm's modes as a cutting process feels them, with those of what it holds.

use nalgebra::{DMatrix, Matrix3, Vector3};
use truecut_core::chatter::{AttachedMode, AttachedModes, TipMode};

use crate::error::{ArmError, ArmErrorKind};
use crate::modal::LinearArm;
use crate::model::{FrameId, Robot};
use crate::tangent::Load;

impl Robot {
    /// Modes at posture `q` with their mass-normalised shapes J_vφ at the origin of `frame`, world
    /// axes, slowest first; `gravity_m_s2` adds ∂g/∂q to the transmission stiffness. Damping ratios
    /// are φᵀDφ/(2ω), those of the modes taken singly.
    ///
    /// # Errors
    /// As [`Robot::modes`].
    pub fn tip_modes(
        &self,
        q: &[f64],
        frame: FrameId,
        gravity_m_s2: Option<&Vector3<f64>>,
    ) -> Result<Vec<TipMode>, ArmError> {
        let load = Load {
            gravity_m_s2: gravity_m_s2.copied(),
            wrench: None,
        };
        self.linearised(q, frame, &load)?.tip_modes()
    }

    /// Modes of the motion between tool and workpiece at posture `q`, world axes: those of the arm
    /// together with the tool's, then the workpiece's; without gravity.
    ///
    /// # Errors
    /// As [`Robot::modes`], and tool modes that weigh more than the arm at its tool point.
    pub fn cutting_modes(
        &self,
        q: &[f64],
        attached: &AttachedModes,
    ) -> Result<Vec<TipMode>, ArmError> {
        let arm = self.linearised(q, FrameId::Tool, &Load::none())?;
        let tool: Vec<AttachedMode> = (attached.tool.iter())
            .map(|mode| mode.turned(&self.tool_axes(q)))
            .collect();
        let mut modes = arm.with_tool(&tool)?.tip_modes()?;
        modes.extend(attached.workpiece.iter().map(AttachedMode::held));
        Ok(modes)
    }

    /// Axes of the tool frame at posture `q`, as columns in the world.
    pub fn tool_axes(&self, q: &[f64]) -> Matrix3<f64> {
        let pose = self.world_from_frame(q, FrameId::Tool);
        pose.rotation.to_rotation_matrix().into_inner()
    }
}

impl LinearArm {
    /// The arm that holds its tool by springs, seen at the tool's tip: coordinates are those of the
    /// joints, then the deflection of each mode against the arm. `modes` are in the axes of the tip
    /// Jacobian J, their masses part of the arm's, so that with their matrix of directions N
    ///
    /// M' = [M, JᵀNm; mNᵀJ, m], D' = diag(D, c), K' = diag(K, k), J' = [J, N].
    ///
    /// # Errors
    /// Masses that the arm has not got at its tip.
    pub fn with_tool(&self, modes: &[AttachedMode]) -> Result<LinearArm, ArmError> {
        if modes.is_empty() {
            return Ok(self.clone());
        }
        let (n, all) = (self.mass.nrows(), self.mass.nrows() + modes.len());
        let grown = |own: &DMatrix<f64>, rows: usize| {
            let mut grown = DMatrix::zeros(rows, all);
            grown.view_mut((0, 0), own.shape()).copy_from(own);
            grown
        };
        let mut arm = LinearArm {
            mass: grown(&self.mass, all),
            damping: grown(&self.damping, all),
            stiffness: grown(&self.stiffness, all),
            tip_jacobian: grown(&self.tip_jacobian, 3),
        };
        for (i, mode) in modes.iter().enumerate() {
            let (own, mass_kg) = (n + i, mode.mass_kg());
            let coupling = self.tip_jacobian.tr_mul(&mode.direction) * mass_kg;
            arm.mass.view_mut((0, own), (n, 1)).copy_from(&coupling);
            let across = arm.mass.column(own).rows(0, n).transpose();
            arm.mass.view_mut((own, 0), (1, n)).copy_from(&across);
            arm.mass[(own, own)] = mass_kg;
            arm.damping[(own, own)] = mode.damping_n_s_per_m();
            arm.stiffness[(own, own)] = mode.stiffness_n_per_m;
            arm.tip_jacobian.set_column(own, &mode.direction);
        }
        let arm_is_regular = self.mass.clone().cholesky().is_some();
        if arm_is_regular && arm.mass.clone().cholesky().is_none() {
            let mass_kg = modes.iter().map(AttachedMode::mass_kg).sum();
            return Err(ArmErrorKind::ToolTooHeavy { mass_kg }.into());
        }
        Ok(arm)
    }

    /// Largest part of the mass at the tip along its direction that one of these modes (axes of the
    /// tip Jacobian) moves, m nᵀJM⁻¹Jᵀn; none for an arm without inertia.
    pub fn largest_share(&self, modes: &[AttachedMode]) -> f64 {
        let Some(mass) = self.mass.clone().cholesky() else {
            return 0.0;
        };
        let shares = modes.iter().map(|mode| {
            let row = self.tip_jacobian.tr_mul(&mode.direction);
            mode.mass_kg() * row.dot(&mass.solve(&row))
        });
        shares.fold(0.0, f64::max)
    }

    /// The modes with their shapes at the tip.
    ///
    /// # Errors
    /// As [`LinearArm::modes`].
    pub fn tip_modes(&self) -> Result<Vec<TipMode>, ArmError> {
        let modes = self.modes()?;
        let tip = &self.tip_jacobian * &modes.shapes;
        let frequencies = modes.frequency_hz.iter().zip(&modes.damping_ratio);
        let tip_modes = frequencies.enumerate().map(|(j, (hz, zeta))| TipMode {
            natural_frequency_rad_s: std::f64::consts::TAU * hz,
            damping_ratio: *zeta,
            shape_per_sqrt_kg: Vector3::new(tip[(0, j)], tip[(1, j)], tip[(2, j)]),
        });
        Ok(tip_modes.collect())
    }
}
