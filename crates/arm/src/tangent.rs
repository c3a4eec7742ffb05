//! Tangent stiffness of the arm in joint coordinates: transmissions, gravity and preload.
//!
//! For joints i ≤ j counted from the base, column j of a geometric Jacobian turns rigidly with
//! joint i: ∂J_j/∂q_i = z_i × J_j if joint i is revolute, 0 if it is prismatic; and ∂J_j/∂q_i with
//! i > j follows from the symmetry of second derivatives of a position.

use nalgebra::{DMatrix, Isometry3, Matrix6xX, Point3, Vector3, Vector6};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, JointKind, Robot};

impl Robot {
    /// Transmission stiffnesses on the diagonal of an n×n matrix (N m/rad or N/m).
    ///
    /// # Errors
    /// Names the first joint that has none; `purpose` completes the sentence.
    pub fn transmission_stiffness(&self, purpose: &'static str) -> Result<DMatrix<f64>, ArmError> {
        let mut stiffness = DMatrix::zeros(self.dof(), self.dof());
        for (i, joint) in self.chain.joints.iter().enumerate() {
            let Some(value) = joint.transmission.stiffness else {
                return Err(ArmErrorKind::NoStiffness {
                    joint: joint.name.clone(),
                    key: match joint.kind {
                        JointKind::Revolute => "stiffness_nm_per_rad",
                        JointKind::Prismatic => "stiffness_n_per_m",
                    },
                    purpose,
                }
                .into());
            };
            stiffness[(i, i)] = value;
        }
        Ok(stiffness)
    }

    /// Transmission dampings on the diagonal of an n×n matrix (N m s/rad or N s/m).
    #[must_use]
    pub fn transmission_damping(&self) -> DMatrix<f64> {
        let joints = self.chain.joints.iter();
        let damping = joints.map(|joint| joint.transmission.damping);
        DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(self.dof(), damping))
    }

    /// ∂g/∂q at posture `q`: how the torques that hold the arm against gravity change with posture.
    /// n×n, symmetric.
    ///
    /// # Panics
    /// If `q` does not have one value per joint.
    #[must_use]
    pub fn gravity_stiffness(&self, q: &[f64], gravity_m_s2: &Vector3<f64>) -> DMatrix<f64> {
        let links = self.world_from_links(q);
        let mut tangent = DMatrix::zeros(links.len(), links.len());
        for (k, (body, pose)) in self.chain.moving().zip(&links).enumerate() {
            let link = body.link;
            let com_m = pose * Point3::from(link.com_m);
            let jacobian = self.jacobian_by_link(&links, k + 1, &com_m);
            // V = −Σ m g·p, so ∂g/∂q = ∂²V/∂q² = −Σ m g·∂²p/∂q².
            let weight_n = gravity_m_s2 * link.mass_kg;
            tangent -= self.force_stiffness(&links, &jacobian, &weight_n);
        }
        self.chain.folded_square(tangent)
    }

    /// ∂(Jᵀw)/∂q at posture `q` for a wrench (force N, moment N m; world axes, at the frame's
    /// origin) that keeps its direction. n×n; symmetric if the moment is zero.
    ///
    /// This is the K_c of K = J⁻ᵀ(K_θ − K_c)J⁻¹.
    ///
    /// # Panics
    /// If `q` does not have one value per joint.
    #[must_use]
    pub fn preload_stiffness(
        &self,
        q: &[f64],
        frame: FrameId,
        wrench: &Vector6<f64>,
    ) -> DMatrix<f64> {
        let links = self.world_from_links(q);
        let last = links.last().copied().unwrap_or_else(Isometry3::identity);
        let point_m = last * Point3::from(self.last_link_from_frame(frame).translation.vector);
        let jacobian = self.jacobian_by_link(&links, links.len(), &point_m);
        let force_n: Vector3<f64> = wrench.fixed_rows::<3>(0).into();
        let moment_nm: Vector3<f64> = wrench.fixed_rows::<3>(3).into();
        let mut tangent = self.force_stiffness(&links, &jacobian, &force_n);
        // A rotation axis turns only with the joints before it, so this part is not symmetric.
        for j in 0..links.len() {
            let axis_j: Vector3<f64> = jacobian.fixed_view::<3, 1>(3, j).into();
            for i in 0..j {
                let axis_i: Vector3<f64> = jacobian.fixed_view::<3, 1>(3, i).into();
                tangent[(j, i)] += moment_nm.dot(&axis_i.cross(&axis_j));
            }
        }
        self.chain.folded_square(tangent)
    }

    /// f·∂²p/∂q² for the point whose Jacobian is given, over the links that move.
    fn force_stiffness(
        &self,
        world_from_links: &[Isometry3<f64>],
        jacobian: &Matrix6xX<f64>,
        force_n: &Vector3<f64>,
    ) -> DMatrix<f64> {
        let count = world_from_links.len();
        let mut tangent = DMatrix::zeros(count, count);
        for (i, joint) in self.chain.moving().enumerate() {
            if joint.kind == JointKind::Prismatic {
                continue;
            }
            let axis = world_from_links[i] * joint.axis.into_inner();
            for j in i..count {
                let column: Vector3<f64> = jacobian.fixed_view::<3, 1>(0, j).into();
                let value = force_n.dot(&axis.cross(&column));
                tangent[(i, j)] = value;
                tangent[(j, i)] = value;
            }
        }
        tangent
    }

    /// Joint-space tangent K_θ + ∂g/∂q − ∂(Jᵀw)/∂q with the parts that `load` names.
    ///
    /// # Errors
    /// If a joint has no stiffness, or `q` the wrong length.
    pub fn tangent_stiffness(&self, q: &[f64], load: &Load) -> Result<DMatrix<f64>, ArmError> {
        self.check_length(q)?;
        let mut tangent = self.transmission_stiffness("stiffness figures")?;
        if let Some(gravity) = &load.gravity_m_s2 {
            tangent += self.gravity_stiffness(q, gravity);
        }
        if let Some((frame, wrench)) = &load.wrench {
            tangent -= self.preload_stiffness(q, *frame, wrench);
        }
        Ok(tangent)
    }
}

/// What loads the arm: gravity and a wrench at a frame, each optional. [`Load::none`] has neither.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// World axes.
    pub gravity_m_s2: Option<Vector3<f64>>,
    /// Force (N) and moment (N m) on the robot at the frame's origin, in world axes, keeping their
    /// direction as the arm moves.
    pub wrench: Option<(FrameId, Vector6<f64>)>,
}

impl Load {
    /// No gravity, no wrench.
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }

    /// Gravity only.
    #[must_use]
    pub fn gravity(gravity_m_s2: Vector3<f64>) -> Self {
        Self {
            gravity_m_s2: Some(gravity_m_s2),
            wrench: None,
        }
    }

    /// Adds a wrench on the robot at `frame`.
    #[must_use]
    pub fn with_wrench(self, frame: FrameId, wrench: Vector6<f64>) -> Self {
        Self {
            wrench: Some((frame, wrench)),
            ..self
        }
    }
}
