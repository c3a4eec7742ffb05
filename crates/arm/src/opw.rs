//! Arms with an ortho-parallel basis and a spherical wrist: recognised by their axes, solved in
//! closed form.
//!
//! Geometry after `brandstoetter2014`: axis 2 at right angles to axis 1, axis 3 parallel to axis 2,
//! axes 4, 5, 6 through one point and each at right angles to the next. It is read off the joint
//! axes at zero, whatever the frames of the file, and checked against the chain's own forward
//! kinematics.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rs_opw_kinematics::glam::{DQuat, DVec3};
use rs_opw_kinematics::kinematic_traits::{Kinematics, Pose};
use rs_opw_kinematics::kinematics_impl::OPWKinematics;
use rs_opw_kinematics::parameters::opw_kinematics::Parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::{JointKind, Robot};

/// Lengths (m) within which axes count as meeting, and the sine within which they count as parallel
/// or square.
const LENGTH_TOLERANCE_M: f64 = 1e-7;
const ANGLE_TOLERANCE: f64 = 1e-8;

/// Geometry of an ortho-parallel arm with spherical wrist. Angles of the model are θ = sign · q −
/// offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpwGeometry {
    /// Distance of axis 2 from axis 1.
    pub a1_m: f64,
    /// Offset of axis 4 from axis 3, across the forearm; negative above it.
    pub a2_m: f64,
    /// Sideways offset of the wrist centre from axis 1.
    pub b_m: f64,
    /// Upper arm, axis 2 to axis 3.
    pub c2_m: f64,
    /// Forearm, axis 3 to the wrist centre along axis 4.
    pub c3_m: f64,
    pub offset_rad: [f64; 6],
    pub sign: [f64; 6],
    /// Whether axis 1 points down, against the z axis of its joint's frame: the model then stands
    /// on its head.
    upside_down: bool,
    /// Whether the model counts axis 5 the other way round than an arm whose axes 4 and 6 point
    /// ahead and whose axes 2 and 5 point to the left.
    wrist_reversed: bool,
    /// World from the frame on axis 1 at the height of axis 2.
    pub world_from_shoulder: Isometry3<f64>,
    /// Last link from the model's wrist frame.
    pub wrist_from_last_link: Isometry3<f64>,
}

/// Which of the eight solutions a posture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ArmBranch {
    pub shoulder: Shoulder,
    pub elbow: Elbow,
    pub wrist: Wrist,
}

/// Side of the shoulder of an arm with a spherical wrist.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Shoulder {
    /// The wrist is on the side to which the arm faces.
    Front,
    /// The arm reaches over its head.
    Rear,
}

/// Side of the elbow.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Elbow {
    /// Above the line from shoulder to wrist.
    Upper,
    /// Below it.
    Lower,
}

/// Sense of the wrist.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Wrist {
    /// With the forearm level and not turned about itself the tool is bent down: the fifth joint's
    /// angle is positive as the ortho-parallel model counts it.
    Positive,
    /// It is bent up.
    Negative,
}

/// How far a posture is from the three singularities of such an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingularityDistance {
    /// Angle of axis 6 from the line of axis 4, 0 to π/2: wrist singularity at 0.
    pub wrist_rad: f64,
    /// Angle of the forearm from being stretched or folded, 0 to π/2.
    pub elbow_rad: f64,
    /// Distance of the wrist centre from axis 1 (in its plane): shoulder singularity at 0.
    pub shoulder_m: f64,
}

/// An axis in the world: a point on it and its direction.
struct OpwAxis {
    point: Vector3<f64>,
    direction: Vector3<f64>,
}

impl OpwGeometry {
    /// Recognises the arm; `None` if it is not of this kind.
    #[must_use]
    pub fn of(robot: &Robot) -> Option<Self> {
        let joints = &robot.chain.joints;
        let is_coupled = !robot.chain.followers.is_empty();
        if is_coupled || joints.len() != 6 || joints.iter().any(|j| j.kind != JointKind::Revolute) {
            return None;
        }
        let links = robot.world_from_links(&[0.0; 6]);
        let axes: Vec<OpwAxis> = links
            .iter()
            .zip(joints)
            .map(|(pose, joint)| OpwAxis {
                point: pose.translation.vector,
                direction: pose.rotation * joint.axis.into_inner(),
            })
            .collect();
        let upside_down = joints[0].axis.z < -0.5;
        let geometry = Self::from_axes(&axes, &links[5], upside_down)?;
        geometry.agrees(robot).then_some(geometry)
    }

    fn from_axes(axes: &[OpwAxis], last_link: &Isometry3<f64>, upside_down: bool) -> Option<Self> {
        let wrist = wrist_centre(axes)?;
        let d = |i: usize| axes[i - 1].direction;
        // Shoulder frame: z along axis 1, y along axis 2 or against it, so that axis 2 stands in
        // front.
        let z = d(1);
        let to_second = axes[1].point - axes[0].point;
        let ahead = to_second.dot(&d(2).cross(&z));
        let sign_2 = if ahead < 0.0 { -1.0 } else { 1.0 };
        let y = d(2) * sign_2;
        let x = y.cross(&z);
        let origin = axes[0].point + z * to_second.dot(&z);
        let plane = |v: &Vector3<f64>| (v.dot(&x), v.dot(&z));
        let (upper_x, upper_z) = plane(&(axes[2].point - axes[1].point));
        let upper_rad = upper_x.atan2(upper_z);
        let elbow = axes[1].point + x * upper_x + z * upper_z;
        let to_wrist = wrist - elbow;
        let along = to_wrist.dot(&d(4));
        let sign_4 = if along < 0.0 { -1.0 } else { 1.0 };
        let z3 = d(4) * sign_4;
        let x3 = y.cross(&z3);
        let fore_rad = z3.dot(&x).atan2(z3.dot(&z));
        let roll_rad = (-d(5).dot(&x3)).atan2(d(5).dot(&y));
        let [fifth_back, sixth_back] = [d(5).dot(&y), d(6).dot(&z3)].map(|along| along < -0.5);
        let bend_rad = d(6).dot(&d(5).cross(&z3)).atan2(d(6).dot(&z3));
        let zero = [
            0.0,
            upper_rad,
            fore_rad - upper_rad,
            roll_rad,
            bend_rad,
            0.0,
        ];
        let axes_of_shoulder = Matrix3::from_columns(&[x, y, z]);
        let mut geometry = Self {
            a1_m: ahead.abs(),
            a2_m: to_wrist.dot(&x3),
            b_m: (wrist - origin).dot(&y),
            c2_m: upper_x.hypot(upper_z),
            c3_m: along.abs(),
            offset_rad: zero.map(|angle| wrap(-angle)),
            sign: [
                1.0,
                sign_2,
                sign_2 * d(2).dot(&d(3)).signum(),
                sign_4,
                1.0,
                1.0,
            ],
            upside_down,
            wrist_reversed: fifth_back ^ sixth_back ^ upside_down,
            world_from_shoulder: isometry(&origin, &axes_of_shoulder),
            wrist_from_last_link: Isometry3::identity(),
        };
        let wrist_frame = geometry.world_from_wrist(&[0.0; 6]);
        geometry.wrist_from_last_link = wrist_frame.inverse() * last_link;
        (geometry.c2_m > 0.0).then_some(geometry)
    }

    /// Model angles θ of a posture.
    fn model_angles(&self, q: &[f64]) -> [f64; 6] {
        std::array::from_fn(|i| self.sign[i] * q[i] - self.offset_rad[i])
    }

    /// Forward kinematics of the model, its wrist frame in the world.
    fn world_from_wrist(&self, q: &[f64]) -> Isometry3<f64> {
        let theta = self.model_angles(q);
        let (reach, height) = self.wrist_in_plane(&theta);
        let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
        let (y, z) = (Vector3::y_axis(), Vector3::z_axis());
        let base = turn(z, theta[0]);
        let wrist = turn(z, theta[3]) * turn(y, theta[4]) * turn(z, theta[5]);
        let rotation = base * turn(y, theta[1] + theta[2]) * wrist;
        let centre = base * Vector3::new(reach, self.b_m, height);
        self.world_from_shoulder * isometry(&centre, rotation.matrix())
    }

    /// Wrist centre in the plane of the arm: distance from axis 1, signed, and height above the
    /// shoulder, m.
    fn wrist_in_plane(&self, theta: &[f64; 6]) -> (f64, f64) {
        let psi = self.a2_m.atan2(self.c3_m);
        let kappa = self.a2_m.hypot(self.c3_m);
        let sum = theta[1] + theta[2] + psi;
        (
            self.c2_m * theta[1].sin() + kappa * sum.sin() + self.a1_m,
            self.c2_m * theta[1].cos() + kappa * sum.cos(),
        )
    }

    /// Whether model and chain put the last link at the same place, at postures spread over all
    /// turns.
    fn agrees(&self, robot: &Robot) -> bool {
        (0..16).all(|k| {
            let q: [f64; 6] = std::array::from_fn(|i| {
                TAU * (0.37 + f64::from(k) * (0.618_034 + 0.113 * i as f64)).fract() - PI
            });
            let model = self.world_from_wrist(&q) * self.wrist_from_last_link;
            let chain = robot.world_from_links(&q)[5];
            let apart = model.translation.vector - chain.translation.vector;
            let turned = model.rotation.angle_to(&chain.rotation);
            apart.norm() <= 10.0 * LENGTH_TOLERANCE_M && turned <= 1e-6
        })
    }

    /// Which solution a posture is.
    #[must_use]
    pub fn branch(&self, q: &[f64]) -> ArmBranch {
        let theta = self.model_angles(q);
        let psi = self.a2_m.atan2(self.c3_m);
        ArmBranch {
            shoulder: match self.wrist_in_plane(&theta).0 < 0.0 {
                true => Shoulder::Rear,
                false => Shoulder::Front,
            },
            elbow: match ((theta[2] + psi).sin() < 0.0) ^ self.upside_down {
                true => Elbow::Lower,
                false => Elbow::Upper,
            },
            wrist: match (theta[4].sin() < 0.0) ^ self.wrist_reversed {
                true => Wrist::Negative,
                false => Wrist::Positive,
            },
        }
    }

    /// How far a posture is from singularities.
    #[must_use]
    pub fn singularity_distance(&self, q: &[f64]) -> SingularityDistance {
        let theta = self.model_angles(q);
        let psi = self.a2_m.atan2(self.c3_m);
        let from_line = |angle: f64| angle.sin().abs().atan2(angle.cos().abs());
        SingularityDistance {
            wrist_rad: from_line(theta[4]),
            elbow_rad: from_line(theta[2] + psi),
            shoulder_m: self.wrist_in_plane(&theta).0.abs(),
        }
    }

    /// All postures, joints in (−π, π], that put the last link at a pose: eight at most, limits not
    /// asked.
    pub(crate) fn solve(&self, world_from_last_link: &Isometry3<f64>) -> Vec<[f64; 6]> {
        let wrist = self.world_from_shoulder.inverse()
            * world_from_last_link
            * self.wrist_from_last_link.inverse();
        let (t, r) = (wrist.translation.vector, wrist.rotation.coords);
        let pose = Pose::try_from_parts(
            DVec3::new(t.x, t.y, t.z),
            DQuat::from_xyzw(r.x, r.y, r.z, r.w),
        );
        let Ok(pose) = pose else { return Vec::new() };
        let solver = OPWKinematics::new(Parameters {
            a1: self.a1_m,
            a2: self.a2_m,
            b: self.b_m,
            c1: 0.0,
            c2: self.c2_m,
            c3: self.c3_m,
            c4: 0.0,
            offsets: self.offset_rad,
            sign_corrections: self.sign.map(|s| if s < 0.0 { -1 } else { 1 }),
            dof: 6,
        });
        let found = solver.inverse(&pose);
        found.into_iter().map(|q| q.map(wrap)).collect()
    }
}

fn isometry(point: &Vector3<f64>, axes: &Matrix3<f64>) -> Isometry3<f64> {
    let rotation = Rotation3::from_matrix_unchecked(*axes);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    Isometry3::from_parts(Translation3::from(*point), rotation)
}

/// Angle brought to (−π, π].
pub(crate) fn wrap(angle_rad: f64) -> f64 {
    let turned = (angle_rad + PI).rem_euclid(TAU) - PI;
    if turned <= -PI { turned + TAU } else { turned }
}

fn distance(axis: &OpwAxis, point: &Vector3<f64>) -> f64 {
    (point - axis.point).cross(&axis.direction).norm()
}

/// Where axes 4, 5 and 6 meet, if all six stand as the geometry asks.
fn wrist_centre(axes: &[OpwAxis]) -> Option<Vector3<f64>> {
    let d = |i: usize| axes[i - 1].direction;
    let square = |i, j| d(i).dot(&d(j)).abs() <= ANGLE_TOLERANCE;
    let parallel = d(2).cross(&d(3)).norm() <= ANGLE_TOLERANCE;
    if !(square(1, 2) && parallel && square(3, 4) && square(4, 5) && square(5, 6)) {
        return None;
    }
    let wrist = meeting_point(&axes[3], &axes[4])?;
    (distance(&axes[5], &wrist) <= LENGTH_TOLERANCE_M).then_some(wrist)
}

/// Where two axes at right angles meet.
fn meeting_point(a: &OpwAxis, b: &OpwAxis) -> Option<Vector3<f64>> {
    let between = b.point - a.point;
    let point = a.point + a.direction * between.dot(&a.direction);
    (distance(b, &point) <= LENGTH_TOLERANCE_M).then_some(point)
}
