//! Arms of seven rotary joints, drawn at random from seeds.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{DMatrix, Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{Chain, FrameId, Frames, Joint, JointKind, Limits, Link, Robot, Transmission};

/// Seeds whose arms stand clear of singularities: the Jacobian's least singular value is above
/// 0.05, rad and m.
pub const SEEDS: [u64; 6] = [2, 4, 5, 17, 29, 31];

/// Corners of a path in the frame of the tool, m.
pub const CORNERS_M: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [0.04, 0.0, 0.0],
    [0.04, 0.03, 0.0],
    [0.0, 0.03, 0.0],
    [0.0, 0.0, 0.0],
    [0.0, 0.0, -0.03],
];

/// Limits of every joint, rad, and its top speed, rad/s.
const LIMIT_RAD: f64 = 2.9;
const SPEED_RAD_S: f64 = 1.7;

/// Even numbers from 0 to 1 (Knuth's congruences).
pub struct Draws(pub u64);

impl Draws {
    pub fn share(&mut self) -> f64 {
        self.0 = (self.0.wrapping_mul(6_364_136_223_846_793_005))
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// To either side of zero.
    pub fn within(&mut self, size: f64) -> f64 {
        size * (2.0 * self.share() - 1.0)
    }
}

/// An arm whose axes lie across each other, each with what a bent elbow or a slanted wrist adds,
/// and a posture of it.
pub fn drawn(seed: u64) -> (Robot, Vec<f64>) {
    let mut draws = Draws(seed);
    let joints = (0..7).map(|i| joint(i, &mut draws));
    let joints: Vec<Joint> = joints.collect();
    let posture = [10.0, 40.0, 0.0, -70.0, 0.0, 60.0, 20.0_f64].map(f64::to_radians);
    let posture = posture.map(|q| q + draws.within(0.2)).to_vec();
    let links = (0..7).map(|i| body(&format!("link_{i}"), 5.0)).collect();
    let robot = Robot {
        name: format!("seven {seed}"),
        chain: Chain {
            name: format!("seven {seed}"),
            joints,
            links,
            followers: Vec::new(),
            base: body("base", 0.0),
            tip: "tip".into(),
            notes: Vec::new(),
            motion_doubts: Vec::new(),
            estimated_masses: Vec::new(),
            placeholders: None,
        },
        frames: Frames {
            last_link_from_flange: Isometry3::identity(),
            flange_from_tool: Isometry3::translation(0.0, 0.0, 0.1),
            flange_from_foot: Isometry3::identity(),
        },
        urdf_path: "seven.urdf".into(),
        config_path: None,
        damping_ratios: Vec::new(),
        tool_load: None,
    };
    (robot, posture)
}

/// Distance of poses: metres and radians together.
pub fn off(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let turned = (a.rotation * b.rotation.inverse()).scaled_axis().norm();
    (a.translation.vector - b.translation.vector).norm() + turned
}

/// Distance of postures, rad.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// Of the tool.
pub fn jacobian(robot: &Robot, q: &[f64]) -> DMatrix<f64> {
    let jacobian = robot.jacobian(q, FrameId::Tool);
    DMatrix::from_fn(6, q.len(), |r, c| jacobian[(r, c)])
}

pub fn least_singular_value(robot: &Robot, q: &[f64]) -> f64 {
    jacobian(robot, q).singular_values().min()
}

fn joint(index: usize, draws: &mut Draws) -> Joint {
    let across = [draws.within(0.02), draws.within(0.02)];
    let length_m = 0.12 + 0.12 * draws.share();
    let place = match index {
        2 | 4 | 6 => Translation3::new(across[0], -length_m, across[1]),
        _ => Translation3::new(across[0], across[1], length_m),
    };
    let turn = [0.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0][index] * FRAC_PI_2;
    let [roll, pitch, yaw] = [turn, 0.0, 0.0].map(|angle| angle + draws.within(0.15));
    Joint {
        name: format!("q{}", index + 1),
        kind: JointKind::Revolute,
        parent_from_joint: Isometry3::from_parts(
            place,
            UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        ),
        axis: Vector3::z_axis(),
        limits: Some(Limits {
            lower: -LIMIT_RAD,
            upper: LIMIT_RAD,
            velocity: SPEED_RAD_S,
            effort: 200.0,
        }),
        transmission: Transmission {
            stiffness: Some(3e4),
            damping: 30.0,
            ..Transmission::default()
        },
        urdf_damping: 0.0,
        urdf_friction: 0.0,
    }
}

fn body(name: &str, mass_kg: f64) -> Link {
    Link {
        name: name.into(),
        mass_kg,
        com_m: Vector3::zeros(),
        inertia_about_com_kg_m2: Matrix3::identity() * 0.02,
        visuals: Vec::new(),
        meshes: Vec::new(),
        solids: Default::default(),
    }
}
