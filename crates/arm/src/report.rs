//! What was understood of a robot file, for people and as JSON.

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Vector3};
use serde::Serialize;

use crate::compliance::{
    PlanarStiffness, RIGID_SHARE, axial_lateral_coupling, clamped, directional_stiffness, in_axes,
    planar_principal, translational,
};
use crate::doubts::unknown_speeds;
use crate::error::{ArmError, ArmErrorKind};
use crate::estimated::TransmissionValue;
use crate::model::{FrameId, JointKind, Link, Robot, TransmissionSources};
use crate::moving::Moving;
use crate::tangent::Load;

pub use crate::posture_rows::{IkRow, ik_csv, ik_rows};
pub use crate::report_estimates::EstimateReport;
pub use crate::table::{fk_table, other_units_note, outside_limits_note, poses};

/// Everything `truecut robot` prints. Field units are in the names; joint values are in the joint's
/// own units ([`JointReport::coordinate_unit`], per second, per coordinate unit); infinite bounds
/// are `null` in JSON.
#[derive(Debug, Clone, Serialize)]
pub struct RobotReport {
    pub name: String,
    pub urdf: String,
    pub config: Option<String>,
    pub tip: String,
    pub joints: Vec<JointReport>,
    pub links: Vec<LinkReport>,
    pub base: LinkReport,
    pub moving_mass_kg: f64,
    pub notes: Vec<String>,
    /// Joint coordinates (rad or m) at which the rest holds.
    pub posture: Vec<f64>,
    /// Joints whose posture value is outside their limits.
    pub outside_limits: Vec<String>,
    pub flange: PoseReport,
    pub tool: PoseReport,
    pub foot: PoseReport,
    /// Joint-space inertia, rows in chain order: kg m² between rotary joints, kg between prismatic
    /// ones, kg m between the two kinds.
    pub mass_matrix: Vec<Vec<f64>>,
    /// Undamped modes without gravity; absent without stiffness.
    pub modes: Option<Vec<ModeReport>>,
    /// Stiffness at the tool without gravity; absent without stiffness.
    pub stiffness: Option<StiffnessReport>,
    /// What each estimated stiffness is worth.
    pub estimates: Vec<EstimateReport>,
    /// Why there are no modes or no stiffness figures.
    pub missing: Vec<String>,
}

/// A joint and its transmission.
#[derive(Debug, Clone, Serialize)]
pub struct JointReport {
    pub name: String,
    pub kind: JointKind,
    pub coordinate_unit: &'static str,
    pub effort_unit: &'static str,
    /// In the joint frame.
    pub axis: [f64; 3],
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    pub velocity: Option<f64>,
    pub effort: Option<f64>,
    pub stiffness: Option<f64>,
    pub damping: f64,
    pub dry_friction: f64,
    pub rotor_inertia: f64,
    pub servo: Option<ServoReport>,
    pub sources: TransmissionSources,
}

/// A P–P servo; gains in the joint's own units.
#[derive(Debug, Clone, Serialize)]
pub struct ServoReport {
    pub position_gain_per_s: f64,
    pub velocity_gain: f64,
    pub torque_limit: f64,
    /// What the loop, which has no integral action, resists a lasting torque with: the product of
    /// both gains.
    pub static_stiffness: f64,
}

/// A rigid body of the chain.
#[derive(Debug, Clone, Serialize)]
pub struct LinkReport {
    pub name: String,
    pub mass_kg: f64,
    pub com_m: [f64; 3],
    /// About the centre of mass, ascending.
    pub principal_inertia_kg_m2: [f64; 3],
}

/// A frame in the world.
#[derive(Debug, Clone, Serialize)]
pub struct PoseReport {
    pub position_m: [f64; 3],
    /// Rows of the rotation matrix, world from frame.
    pub rotation: [[f64; 3]; 3],
}

/// One natural mode.
#[derive(Debug, Clone, Serialize)]
pub struct ModeReport {
    pub frequency_hz: f64,
    pub damping_ratio: f64,
}

/// Stiffness at the tool in process axes: X along the tool, Y horizontal, Z = X × Y.
#[derive(Debug, Clone, Serialize)]
pub struct StiffnessReport {
    /// Columns X, Y, Z: the process axes in the world.
    pub process_axes: [[f64; 3]; 3],
    /// Rotation free: 1/(eᵀ C_tt e).
    pub free: DirectionalReport,
    /// Rotation clamped: 1/(eᵀ (K_tt)⁻¹ e); absent if K does not exist.
    pub clamped: Option<DirectionalReport>,
    /// Lateral force (Y, Z) per axial force on a tool held laterally.
    pub axial_lateral_coupling: Option<[f64; 2]>,
}

/// Stiffness along X, Y, Z and the principal values in the lateral plane, angle from Y towards Z.
#[derive(Debug, Clone, Serialize)]
pub struct DirectionalReport {
    pub x_n_per_m: f64,
    pub y_n_per_m: f64,
    pub z_n_per_m: f64,
    pub lateral: PlanarStiffness,
}

impl Robot {
    /// The posture that a report shows if none is asked for: zero, or for a joint whose limits
    /// exclude zero the middle of its range (the one limit, if the range is open).
    #[must_use]
    pub fn default_posture(&self) -> Vec<f64> {
        (self.chain.joints.iter())
            .map(|joint| match joint.limits {
                Some(l) if !(l.lower..=l.upper).contains(&0.0) => {
                    let middle = 0.5 * (l.lower + l.upper);
                    let nearest = if l.lower > 0.0 { l.lower } else { l.upper };
                    if middle.is_finite() { middle } else { nearest }
                }
                _ => 0.0,
            })
            .collect()
    }

    /// The report at `posture` (rad or m).
    ///
    /// # Errors
    /// If `posture` does not have one finite value per joint. Values outside the limits and figures
    /// that cannot be had are reported, not refused.
    pub fn report(&self, posture: &[f64]) -> Result<RobotReport, ArmError> {
        let mut outside_limits = Vec::new();
        if let Err(error) = self.check_posture(posture) {
            match error.kind() {
                ArmErrorKind::OutsideLimits { .. } => {
                    outside_limits = self.outside_limits(posture);
                }
                _ => return Err(error),
            }
        }
        let mut notes = self.chain.notes.clone();
        notes.extend(self.estimates(&TransmissionValue::ALL));
        notes.extend(self.unchecked_drives());
        let of_speeds = unknown_speeds(&self.chain);
        notes.extend(of_speeds.filter(|note| !self.chain.notes.contains(note)));
        let mut missing = Vec::new();
        let modes = match self.modes(posture, None) {
            Ok(modes) => {
                notes.extend(modes.overdamped_note());
                let modes = modes.frequency_hz.iter().zip(&modes.damping_ratio);
                let report = |(&frequency_hz, &damping_ratio): (&f64, &f64)| ModeReport {
                    frequency_hz,
                    damping_ratio,
                };
                Some(modes.map(report).collect())
            }
            Err(error) => {
                missing.push(format!("no modes: {error}"));
                None
            }
        };
        let stiffness = match self.stiffness_report(posture) {
            Ok(report) => Some(report),
            Err(error) => {
                missing.push(format!("no stiffness figures: {error}"));
                None
            }
        };
        Ok(RobotReport {
            name: self.name.clone(),
            urdf: self.urdf_path.display().to_string(),
            config: self.config_path.as_ref().map(|p| p.display().to_string()),
            tip: self.chain.tip.clone(),
            joints: self.joint_reports(),
            links: (self.chain.moving())
                .map(|body| link_report(body.link))
                .collect(),
            base: link_report(&self.chain.base),
            moving_mass_kg: self.chain.moving().map(|body| body.link.mass_kg).sum(),
            notes,
            posture: posture.to_vec(),
            outside_limits,
            flange: pose_report(&self.world_from_frame(posture, FrameId::Flange)),
            tool: pose_report(&self.world_from_frame(posture, FrameId::Tool)),
            foot: pose_report(&self.world_from_frame(posture, FrameId::Foot)),
            mass_matrix: (self.mass_matrix(posture).row_iter())
                .map(|row| row.iter().copied().collect())
                .collect(),
            modes,
            stiffness,
            estimates: self.estimate_reports(posture),
            missing,
        })
    }

    /// Which joints have no effort limit.
    fn unchecked_drives(&self) -> Option<String> {
        let is_unknown = |joint: &&crate::model::Joint| {
            let urdf = joint
                .limits
                .is_none_or(|limits| limits.effort.is_infinite());
            joint.transmission.servo.is_none() && urdf
        };
        let unknown = self.chain.joints.iter().filter(is_unknown);
        let names: Vec<&str> = unknown.map(|joint| joint.name.as_str()).collect();
        (!names.is_empty()).then(|| {
            let names = names.join(", ");
            format!("no effort limit is known of {names}: overload of these drives is not checked")
        })
    }

    fn outside_limits(&self, posture: &[f64]) -> Vec<String> {
        let outside = |joint: Moving| {
            let limits = joint.limits?;
            let is_within = (limits.lower..=limits.upper).contains(&joint.value(posture));
            (!is_within).then(|| joint.joint.to_owned())
        };
        self.chain.moving().filter_map(outside).collect()
    }

    fn joint_reports(&self) -> Vec<JointReport> {
        let finite = |v: f64| v.is_finite().then_some(v);
        (self.chain.joints.iter())
            .map(|joint| JointReport {
                name: joint.name.clone(),
                kind: joint.kind,
                coordinate_unit: joint.kind.coordinate_unit(),
                effort_unit: joint.kind.effort_unit(),
                axis: joint.axis.into_inner().into(),
                lower: joint.limits.and_then(|l| finite(l.lower)),
                upper: joint.limits.and_then(|l| finite(l.upper)),
                velocity: joint.limits.and_then(|l| finite(l.velocity)),
                effort: joint.limits.and_then(|l| finite(l.effort)),
                stiffness: joint.transmission.stiffness,
                damping: joint.transmission.damping,
                dry_friction: joint.transmission.dry_friction,
                rotor_inertia: joint.transmission.rotor_inertia,
                servo: joint.transmission.servo.map(|servo| ServoReport {
                    position_gain_per_s: servo.position_gain_per_s,
                    velocity_gain: servo.velocity_gain,
                    torque_limit: servo.torque_limit,
                    static_stiffness: servo.static_stiffness(),
                }),
                sources: joint.transmission.sources.clone(),
            })
            .collect()
    }

    fn stiffness_report(&self, posture: &[f64]) -> Result<StiffnessReport, ArmError> {
        let compliance = self.cartesian_compliance(posture, FrameId::Tool, &Load::none())?;
        let axes = self.world_from_process(posture);
        let free = in_axes(&translational(&compliance), &axes);
        let held = clamped(&compliance).ok().map(|c| in_axes(&c, &axes));
        let matrix = axes.rotation.to_rotation_matrix();
        Ok(StiffnessReport {
            process_axes: std::array::from_fn(|c| matrix.matrix().column(c).into_owned().into()),
            free: directional_report(&free, &free),
            clamped: held.map(|held| directional_report(&held, &free)),
            axial_lateral_coupling: axial_lateral_coupling(&free).ok().map(Into::into),
        })
    }
}

fn directional_report(compliance: &Matrix3<f64>, free: &Matrix3<f64>) -> DirectionalReport {
    let least_m_per_n = RIGID_SHARE * free.trace();
    let or_rigid = |k_n_per_m: f64| match 1.0 / k_n_per_m > least_m_per_n {
        true => k_n_per_m,
        false => f64::INFINITY,
    };
    let along = |axis| or_rigid(directional_stiffness(compliance, &axis));
    let lateral = planar_principal(compliance, &Vector3::y_axis(), &Vector3::z_axis());
    DirectionalReport {
        x_n_per_m: along(Vector3::x_axis()),
        y_n_per_m: along(Vector3::y_axis()),
        z_n_per_m: along(Vector3::z_axis()),
        lateral: PlanarStiffness {
            k_min_n_per_m: or_rigid(lateral.k_min_n_per_m),
            k_max_n_per_m: or_rigid(lateral.k_max_n_per_m),
            ..lateral
        },
    }
}

fn link_report(link: &Link) -> LinkReport {
    let eigen = SymmetricEigen::new(link.inertia_about_com_kg_m2).eigenvalues;
    let mut principal = [eigen[0], eigen[1], eigen[2]];
    principal.sort_by(f64::total_cmp);
    LinkReport {
        name: link.name.clone(),
        mass_kg: link.mass_kg,
        com_m: link.com_m.into(),
        principal_inertia_kg_m2: principal,
    }
}

fn pose_report(pose: &Isometry3<f64>) -> PoseReport {
    let matrix = pose.rotation.to_rotation_matrix();
    PoseReport {
        position_m: pose.translation.vector.into(),
        rotation: std::array::from_fn(|r| std::array::from_fn(|c| matrix[(r, c)])),
    }
}
