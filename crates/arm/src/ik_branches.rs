//! Inverse kinematics with all branches.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::ik::IkOptions;
use crate::model::{FrameId, JointKind, Robot};
use crate::opw::{OpwGeometry, wrap};
use crate::six_axes::SixAxes;
use crate::told::in_the_workshop;
use crate::turns::turned;

/// Postures that agree to this in every joint, modulo whole turns, count as one.
const SAME_POSTURE: f64 = 1e-6;

/// What is left of a pose (m and rad together) by a posture that counts as exact.
const CLOSED_FORM_TOLERANCE: f64 = 1e-10;

/// How solutions of arms without a closed form are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchOptions {
    /// Seeds, spread evenly over the joints' ranges; more seeds miss fewer branches.
    pub seeds: usize,
    pub numeric: IkOptions,
}

impl Default for BranchOptions {
    fn default() -> Self {
        Self {
            seeds: 160,
            numeric: IkOptions::default(),
        }
    }
}

/// Inverse kinematics of one robot: closed form for ortho-parallel arms with spherical wrist, else
/// numeric.
#[derive(Debug, Clone)]
pub struct IkSolver<'a> {
    robot: &'a Robot,
    /// The robot with its position limits taken away.
    unlimited: Robot,
    /// With its joints, where it has a closed form.
    geometry: Option<(OpwGeometry, SixAxes)>,
    options: BranchOptions,
}

impl Robot {
    /// A solver for this robot.
    #[must_use]
    pub fn ik_solver(&self, options: &BranchOptions) -> IkSolver<'_> {
        let mut unlimited = self.clone();
        for joint in &mut unlimited.chain.joints {
            joint.limits = None;
        }
        IkSolver {
            robot: self,
            unlimited,
            geometry: OpwGeometry::of(self)
                .and_then(|geometry| Some((geometry, SixAxes::of(self)?))),
            options: *options,
        }
    }
}

impl IkSolver<'_> {
    /// The geometry by which the closed form works; `None` where solutions are sought numerically.
    #[must_use]
    pub fn geometry(&self) -> Option<&OpwGeometry> {
        self.geometry.as_ref().map(|(geometry, _)| geometry)
    }

    /// The robot that it solves for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        self.robot
    }

    pub(crate) fn options(&self) -> &BranchOptions {
        &self.options
    }

    /// The robot with its position limits taken away.
    pub(crate) fn unlimited(&self) -> &Robot {
        &self.unlimited
    }

    /// All postures that put `frame` at a pose, revolute joints in (−π, π], position limits not
    /// asked.
    ///
    /// In closed form these are all there are, eight at most; at a singularity, where there is a
    /// continuum, one of it stands for all. The numeric search may miss some, and gives samples of
    /// the continuum of an arm of more than six joints.
    #[must_use]
    pub fn branches(&self, world_from_target: &Isometry3<f64>, frame: FrameId) -> Vec<Vec<f64>> {
        let found = match &self.geometry {
            Some((geometry, axes)) => {
                let last_from_frame = self.robot.last_link_from_frame(frame);
                let solved = geometry.solve(&(world_from_target * last_from_frame.inverse()));
                let polish = |q: [f64; 6]| {
                    let (best, error) = axes.polished(q, &last_from_frame, world_from_target);
                    self.settled(best, error, world_from_target, frame)
                };
                solved.into_iter().filter_map(polish).collect()
            }
            None => self.searched(world_from_target, frame),
        };
        let mut unique: Vec<Vec<f64>> = Vec::new();
        for q in found {
            if !unique.iter().any(|known| self.same(known, &q)) {
                unique.push(q);
            }
        }
        unique
    }

    /// All postures within the position limits that put `frame` at a pose, whole turns of revolute
    /// joints included where limits leave room for them. A joint without limits is given in (−π, π]
    /// only. Where none is, an arm with joints to spare is moved with its tool at rest until some
    /// are.
    #[must_use]
    pub fn within_limits(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
    ) -> Vec<Vec<f64>> {
        let branches = self.branches(world_from_target, frame);
        let within: Vec<Vec<f64>> = branches
            .iter()
            .flat_map(|q| turned(&self.robot.chain.joints, q))
            .collect();
        if within.is_empty() {
            return self.brought_within(world_from_target, frame, &branches);
        }
        within
    }

    /// The posture within limits that puts `frame` at a pose and lies nearest to `from` (shortest
    /// travel: root of the sum of squared joint motions, rad and m). An arm with joints to spare
    /// comes as near as it can with its tool at rest.
    ///
    /// # Errors
    /// If no posture reaches the pose, or none within the limits.
    pub fn nearest(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        from: &[f64],
    ) -> Result<Vec<f64>, ArmError> {
        self.robot.check_length(from)?;
        Ok(self.nearest_kind(world_from_target, frame, from)?)
    }

    pub(crate) fn nearest_kind(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        from: &[f64],
    ) -> Result<Vec<f64>, ArmErrorKind> {
        let mut branches = self.branches(world_from_target, frame);
        if self.robot.has_joints_to_spare() {
            branches.extend(self.led_to(world_from_target, frame, from));
        }
        let mut nearest = branches.iter().map(|q| self.near(q, from)).collect();
        let within = |q: &Vec<f64>| self.robot.check_posture(q).is_ok();
        let mut candidates: Vec<Vec<f64>> = branches
            .iter()
            .flat_map(|q| turned(&self.robot.chain.joints, q))
            .collect();
        candidates.append(&mut nearest);
        candidates.retain(within);
        if candidates.is_empty() {
            candidates = self.brought_within(world_from_target, frame, &branches);
        }
        if self.robot.has_joints_to_spare() {
            candidates = self.drawn_near(world_from_target, frame, candidates, from);
        }
        let nearest = candidates
            .into_iter()
            .min_by(|a, b| travel(a, from).total_cmp(&travel(b, from)));
        nearest.ok_or_else(|| self.unreachable(world_from_target, frame, &branches))
    }

    /// Why no posture within limits was found.
    pub(crate) fn unreachable(
        &self,
        target: &Isometry3<f64>,
        frame: FrameId,
        branches: &[Vec<f64>],
    ) -> ArmErrorKind {
        let point = target.translation.vector;
        if branches.is_empty() {
            return ArmErrorKind::OutOfReach {
                frame: match frame {
                    FrameId::Flange => "flange",
                    FrameId::Tool => "tool",
                    FrameId::Foot => "foot",
                },
                x_m: point.x,
                y_m: point.y,
                z_m: point.z,
            };
        }
        let excess = |q: &Vec<f64>| {
            let joints = self.robot.chain.joints.iter().zip(q);
            let beyond = joints.filter_map(|(joint, value)| {
                let limits = joint.limits?;
                let by = (value - limits.upper).max(limits.lower - value);
                (by > 0.0).then_some((joint, by))
            });
            beyond.max_by(|a, b| a.1.total_cmp(&b.1))
        };
        let least = branches
            .iter()
            .filter_map(excess)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        ArmErrorKind::LimitsExclude {
            count: branches.len(),
            x_m: point.x,
            y_m: point.y,
            z_m: point.z,
            nearest: least.map_or_else(String::new, |(joint, by)| {
                let by = in_the_workshop(by, joint.kind.coordinate_unit());
                format!(
                    "; the nearest breaks those of joint \"{}\" by {by}",
                    joint.name
                )
            }),
        }
    }

    /// A posture that is right to rounding; what is not is handed to the damped search, and dropped
    /// if that does not reach the pose either.
    fn settled(
        &self,
        best: [f64; 6],
        error: f64,
        target: &Isometry3<f64>,
        frame: FrameId,
    ) -> Option<Vec<f64>> {
        if error <= CLOSED_FORM_TOLERANCE {
            return Some(best.to_vec());
        }
        let options = &self.options.numeric;
        let searched = self
            .unlimited
            .inverse_kinematics(target, frame, &best, options);
        let mut found = searched.ok()?;
        found.iter_mut().for_each(|q| *q = wrap(*q));
        Some(found)
    }

    /// Numeric solutions from seeds spread over the joints' ranges.
    fn searched(&self, target: &Isometry3<f64>, frame: FrameId) -> Vec<Vec<f64>> {
        let joints = &self.robot.chain.joints;
        // Additive recurrence with the powers of the plastic number's generalisation (Roberts).
        let steps: Vec<f64> = (0..joints.len())
            .map(|i| recurrence(joints.len(), i))
            .collect();
        let seed = |k: usize| -> Vec<f64> {
            let spread = joints.iter().zip(&steps).map(|(joint, step)| {
                let share = (0.5 + (k + 1) as f64 * step).fract();
                let (low, high) = range(joint.kind, joint.limits);
                low + share * (high - low)
            });
            spread.collect()
        };
        let mut found: Vec<Vec<f64>> = Vec::new();
        for k in 0..self.options.seeds {
            let options = &self.options.numeric;
            let solved = self
                .unlimited
                .inverse_kinematics(target, frame, &seed(k), options);
            if let Ok(mut q) = solved {
                for (value, joint) in q.iter_mut().zip(joints) {
                    if joint.kind == JointKind::Revolute {
                        *value = wrap(*value);
                    }
                }
                if !found.iter().any(|known| self.same(known, &q)) {
                    found.push(q);
                }
            }
        }
        found
    }

    fn same(&self, a: &[f64], b: &[f64]) -> bool {
        let joints = self.robot.chain.joints.iter();
        joints.zip(a.iter().zip(b)).all(|(joint, (a, b))| {
            let apart = match joint.kind {
                JointKind::Revolute => wrap(a - b),
                JointKind::Prismatic => a - b,
            };
            apart.abs() <= SAME_POSTURE
        })
    }

    /// The posture with every revolute joint turned as near to another posture as whole turns bring
    /// it.
    fn near(&self, q: &[f64], to: &[f64]) -> Vec<f64> {
        let joints = self.robot.chain.joints.iter();
        let values = joints
            .zip(q.iter().zip(to))
            .map(|(joint, (q, to))| match joint.kind {
                JointKind::Revolute => to + wrap(q - to),
                JointKind::Prismatic => *q,
            });
        values.collect()
    }
}

/// Length of the way between two postures, rad and m together.
pub(crate) fn travel(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

fn recurrence(dimensions: usize, index: usize) -> f64 {
    let mut root: f64 = 2.0;
    for _ in 0..40 {
        root = (1.0 + root).powf(1.0 / (dimensions as f64 + 1.0));
    }
    root.powi(-(index as i32 + 1))
}

fn range(kind: JointKind, limits: Option<crate::model::Limits>) -> (f64, f64) {
    use std::f64::consts::PI;
    let fallback = match kind {
        JointKind::Revolute => (-PI, PI),
        JointKind::Prismatic => (-1.0, 1.0),
    };
    let (low, high) = limits.map_or(fallback, |l| (l.lower, l.upper));
    match kind {
        JointKind::Revolute => (low.max(-PI), high.min(PI)),
        JointKind::Prismatic if (high - low).is_finite() => (low, high),
        JointKind::Prismatic => fallback,
    }
}

/// Pose of a tool whose z axis is `tool_axis`, at `point_m` (both world), with redundancy angle
/// `angle_rad`: its x axis is `zero_direction`, made square to the axis, turned by the angle
/// against the tool axis. With the tool pointing down the angle counts from above in the
/// mathematical sense: x = (cos, sin, 0), y = (sin, −cos, 0), z = (0, 0, −1) for a zero direction
/// along world x.
///
/// # Errors
/// If the zero direction is parallel to the tool axis.
pub fn tool_pose(
    point_m: &Vector3<f64>,
    tool_axis: &Unit<Vector3<f64>>,
    zero_direction: &Vector3<f64>,
    angle_rad: f64,
) -> Result<Isometry3<f64>, ArmError> {
    let across = zero_direction - tool_axis.into_inner() * tool_axis.dot(zero_direction);
    let sine = across.norm() / zero_direction.norm();
    if sine.is_nan() || sine < 1e-9 {
        return Err(ArmErrorKind::Argument {
            quantity: "the sine between zero direction and tool axis",
            value: sine,
            rule: "at least 1e-9",
        }
        .into());
    }
    let turn = Rotation3::from_axis_angle(tool_axis, -angle_rad);
    let x = turn * across.normalize();
    let z = tool_axis.into_inner();
    let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    Ok(Isometry3::from_parts(
        Translation3::from(*point_m),
        rotation,
    ))
}
