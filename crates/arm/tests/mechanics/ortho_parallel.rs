//! Ortho-parallel arms with spherical wrist: chains built from their lengths, and the inverse as
//! printed.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use truecut_arm::{Joint, JointKind, Link, Robot, Transmission};

use super::random_chain::{assemble, body};

/// a1, a2, b, c1, c2, c3, c4 (m), signs; θ3 = sign q3 + 90°.
#[derive(Clone, Copy)]
pub struct Opw {
    pub lengths_m: [f64; 7],
    sign: [f64; 6],
}

pub const IRB6600: Opw = Opw {
    lengths_m: [0.320, -0.200, 0.0, 0.780, 1.075, 1.142, 0.200],
    sign: [1.0; 6],
};
pub const HP20: Opw = Opw {
    lengths_m: [0.150, -0.140, 0.0, 0.505, 0.760, 0.795, 0.105],
    sign: [1.0, 1.0, -1.0, -1.0, -1.0, -1.0],
};
/// Made up, for the sideways offset that neither of the others has.
pub const OFFSET: Opw = Opw {
    lengths_m: [0.2, 0.08, 0.11, 0.4, 0.6, 0.7, 0.09],
    sign: [1.0, 1.0, 1.0, -1.0, 1.0, -1.0],
};

fn turn(axis: Unit<Vector3<f64>>, angle: f64) -> Matrix3<f64> {
    *Rotation3::from_axis_angle(&axis, angle).matrix()
}

impl Opw {
    /// The inverse as printed (Brandstötter, Angerer, Hofbaur 2014): eight branches, of which those
    /// with an acos of more than 1 drop out. Joint values in (−π, π].
    pub fn printed_inverse(&self, position: &Vector3<f64>, r: &Matrix3<f64>) -> Vec<[f64; 6]> {
        let [a1, a2, b, c1, c2, c3, c4] = self.lengths_m;
        let (kappa, psi) = (a2.hypot(c3), a2.atan2(c3));
        let c = position - r * Vector3::z() * c4;
        let n = (c.x * c.x + c.y * c.y - b * b).sqrt() - a1;
        let height = c.z - c1;
        let s1 = n.hypot(height);
        let s2 = (n + 2.0 * a1).hypot(height);
        let around = c.y.atan2(c.x);
        let side = b.atan2(n + a1);
        let mut found = Vec::new();
        for (front, s) in [(true, s1), (false, s2)] {
            for up in [1.0, -1.0] {
                let shoulder = ((s * s + c2 * c2 - kappa * kappa) / (2.0 * s * c2)).acos();
                let elbow = ((s * s - c2 * c2 - kappa * kappa) / (2.0 * c2 * kappa)).acos();
                if shoulder.is_nan() || elbow.is_nan() {
                    continue;
                }
                let (first, line) = if front {
                    (around - side, n.atan2(height))
                } else {
                    (around + side - PI, -(n + 2.0 * a1).atan2(height))
                };
                let second = line - up * shoulder;
                let third = up * elbow - psi;
                let r03 = turn(Vector3::z_axis(), first) * turn(Vector3::y_axis(), second + third);
                let w = r03.transpose() * r;
                for wrist in [1.0, -1.0] {
                    let fifth = wrist * w.m13.hypot(w.m23).atan2(w.m33);
                    let extra = if wrist < 0.0 { PI } else { 0.0 };
                    let fourth = w.m23.atan2(w.m13) + extra;
                    let sixth = w.m32.atan2(-w.m31) - extra;
                    let theta = [first, second, third - FRAC_PI_2, fourth, fifth, sixth];
                    found.push(std::array::from_fn(|i| wrapped(self.sign[i] * theta[i])));
                }
            }
        }
        found
    }

    /// A chain with these axes. `shift` moves every joint frame along its axis and turns it about
    /// it, which changes no axis, and the base stands askew.
    pub fn robot(&self, shift: f64) -> Robot {
        let [a1, a2, b, c1, c2, c3, c4] = self.lengths_m;
        let origins = [
            Vector3::new(0.0, 0.0, c1),
            Vector3::new(a1, 0.0, 0.0),
            Vector3::new(0.0, 0.0, c2),
            Vector3::new(a2, b, c3),
            Vector3::zeros(),
            Vector3::zeros(),
        ];
        let (y, z) = (Vector3::y(), Vector3::z());
        let axes = [z, y, y, z, y, z];
        let base = Isometry3::new(
            Vector3::new(0.3, -0.2, 0.5),
            Vector3::new(0.4, -0.2, 0.9) * shift,
        );
        let mut before = base;
        let mut joints = Vec::new();
        let mut links: Vec<Link> = Vec::new();
        for (i, (origin, axis)) in origins.iter().zip(axes).enumerate() {
            let bend = if i == 2 {
                y * FRAC_PI_2
            } else {
                Vector3::zeros()
            };
            let nominal = Isometry3::new(*origin, bend);
            let slide = Translation3::from(axis * (0.07 * shift * (i as f64 + 1.0)));
            let twist = UnitQuaternion::from_scaled_axis(axis * (0.5 * shift * (i as f64 - 2.0)));
            let moved = Isometry3::from_parts(slide, twist);
            joints.push(joint(i, before * nominal * moved, axis * self.sign[i]));
            links.push(body(
                &format!("link_{i}"),
                1.0,
                Vector3::zeros(),
                Matrix3::identity(),
            ));
            before = moved.inverse();
        }
        let flange = before * Isometry3::translation(0.0, 0.0, c4);
        let tool = Isometry3::new(Vector3::new(0.1, 0.05, 0.2), Vector3::new(0.2, 0.5, -0.4));
        let mut robot = assemble(joints, links, [flange, tool, Isometry3::identity()]);
        if shift == 0.0 {
            robot.chain.joints[0].parent_from_joint = Isometry3::translation(0.0, 0.0, c1);
        }
        robot
    }
}

fn joint(index: usize, parent_from_joint: Isometry3<f64>, axis: Vector3<f64>) -> Joint {
    Joint {
        name: format!("joint_{}", index + 1),
        kind: JointKind::Revolute,
        parent_from_joint,
        axis: Unit::new_normalize(axis),
        limits: None,
        transmission: Transmission::default(),
        urdf_damping: 0.0,
        urdf_friction: 0.0,
    }
}

fn wrapped(angle: f64) -> f64 {
    let turned = (angle + PI).rem_euclid(TAU) - PI;
    if turned == -PI { PI } else { turned }
}

pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    let each = a.iter().zip(b).map(|(a, b)| wrapped(a - b).abs());
    each.fold(0.0, f64::max)
}

/// Postures spread over all turns of all joints (additive recurrence).
pub fn spread(count: u32) -> impl Iterator<Item = [f64; 6]> {
    (1..=count).map(|k| {
        std::array::from_fn(|i| {
            let rate = 0.819_172_513_396_164_f64.powi(i as i32 + 1);
            TAU * (0.5 + f64::from(k) * rate).fract() - PI
        })
    })
}
