//! Commanded joint coordinates over time.

use crate::error::SimError;
use nalgebra::{Isometry3, Translation3, Vector3};
use truecut_arm::{FrameId, IkOptions, Load, Robot};

/// Time in which a commanded feed comes up to speed, s.
const RUN_UP_S: f64 = 0.1;
/// Knots of a path lie this far apart, m. Cubic interpolation between them errs by less than 1e-9 m on
/// the posture changes of a machining path.
const KNOT_SPACING_M: f64 = 2e-3;

/// What the controller asks of the joints.
pub(crate) enum JointCommand {
    /// One posture for the whole run.
    Hold(Vec<f64>),
    /// A straight path of the tool along process Y, attitude kept.
    Along(StraightPath),
}

/// Knots of a straight path and the speed along it.
pub(crate) struct StraightPath {
    speed_m_per_s: f64,
    start_m: f64,
    knots: Vec<Vec<f64>>,
}

impl JointCommand {
    /// Command of every joint at time `t`: coordinates and velocities.
    pub(crate) fn at(&self, t_s: f64, position: &mut [f64], velocity: &mut [f64]) {
        match self {
            Self::Hold(posture) => {
                position.copy_from_slice(posture);
                velocity.fill(0.0);
            }
            Self::Along(path) => path.at(t_s, position, velocity),
        }
    }

    /// The same for an arm with `count` further joints before the first, which stay at zero.
    pub(crate) fn behind(mut self, count: usize) -> Self {
        let postures = match &mut self {
            Self::Hold(posture) => std::slice::from_mut(posture),
            Self::Along(path) => &mut path.knots,
        };
        for posture in postures {
            posture.splice(0..0, std::iter::repeat_n(0.0, count));
        }
        self
    }

    /// Whether the command ever leaves its first posture.
    pub(crate) fn moves(&self) -> bool {
        !matches!(self, Self::Hold(_))
    }

    /// Postures that the command passes through, for checking limits.
    pub(crate) fn postures(&self) -> &[Vec<f64>] {
        match self {
            Self::Hold(posture) => std::slice::from_ref(posture),
            Self::Along(path) => &path.knots,
        }
    }
}

impl StraightPath {
    /// Solves the knots by inverse kinematics from `q0`, and adds the sag that the command makes up for.
    pub(crate) fn solve(
        robot: &Robot,
        q0: &[f64],
        world_from_process: &Isometry3<f64>,
        speed_m_per_s: f64,
        duration_s: f64,
        sag: Option<&Load>,
    ) -> Result<Self, SimError> {
        let reach = speed_m_per_s * duration_s + 3.0 * KNOT_SPACING_M;
        let count = (reach / KNOT_SPACING_M).ceil() as i64;
        let direction: Vector3<f64> = world_from_process.rotation * Vector3::y();
        let start = robot.world_from_frame(q0, FrameId::Tool);
        let mut seed = q0.to_vec();
        let mut knots = Vec::new();
        for k in -2..=count {
            let shift = Translation3::from(direction * (k as f64 * KNOT_SPACING_M));
            let target = shift * start;
            let q = robot
                .inverse_kinematics(&target, FrameId::Tool, &seed, &IkOptions::default())
                .map_err(|error| {
                    SimError::scenario(
                        "robot.posture_deg",
                        format!(
                            "the tool cannot follow the strip {:.1} mm from its start: {error}",
                            k as f64 * KNOT_SPACING_M * 1e3
                        ),
                    )
                })?;
            seed.clone_from(&q);
            knots.push(match sag {
                Some(load) => robot.holding_command(&q, load)?,
                None => q,
            });
        }
        Ok(Self {
            speed_m_per_s,
            start_m: -2.0 * KNOT_SPACING_M,
            knots,
        })
    }

    /// Distance along the path and its rate: a smooth run-up (quintic in position), then constant speed.
    fn distance(&self, t_s: f64) -> (f64, f64) {
        let x = (t_s / RUN_UP_S).clamp(0.0, 1.0);
        // speed rises as 3x² - 2x³
        let ramped = RUN_UP_S * (x.powi(3) - 0.5 * x.powi(4));
        let rate = x * x * (3.0 - 2.0 * x);
        let after = (t_s - RUN_UP_S).max(0.0);
        (
            self.speed_m_per_s * (ramped + after),
            self.speed_m_per_s * rate,
        )
    }

    fn at(&self, t_s: f64, position: &mut [f64], velocity: &mut [f64]) {
        let (distance, rate) = self.distance(t_s);
        let x = (distance - self.start_m) / KNOT_SPACING_M;
        let k = (x.floor() as usize).clamp(1, self.knots.len() - 3);
        let u = x - k as f64;
        for joint in 0..position.len() {
            let p = |i: usize| self.knots[k + i - 1][joint];
            let (p0, p1, p2, p3) = (p(0), p(1), p(2), p(3));
            // Cubic Lagrange through the four knots around.
            let a = (-p0 + 3.0 * p1 - 3.0 * p2 + p3) / 6.0;
            let b = (p0 - 2.0 * p1 + p2) / 2.0;
            let c = (-2.0 * p0 - 3.0 * p1 + 6.0 * p2 - p3) / 6.0;
            position[joint] = ((a * u + b) * u + c) * u + p1;
            let slope = (3.0 * a * u + 2.0 * b) * u + c;
            velocity[joint] = slope * rate / KNOT_SPACING_M;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_velocity_is_the_derivative_of_the_command() {
        let path = StraightPath {
            speed_m_per_s: 0.05,
            start_m: -2.0 * KNOT_SPACING_M,
            knots: (0..60)
                .map(|k| vec![(0.03 * k as f64).sin(), 0.2 * k as f64])
                .collect(),
        };
        let command = JointCommand::Along(path);
        let at = |t: f64| {
            let (mut p, mut v) = ([0.0; 2], [0.0; 2]);
            command.at(t, &mut p, &mut v);
            (p, v)
        };
        let h = 1e-6;
        for t in [0.03, 0.09, 0.4, 1.234, 2.0] {
            for joint in 0..2 {
                let slope = (at(t + h).0[joint] - at(t - h).0[joint]) / (2.0 * h);
                let scale = at(t).1[joint].abs().max(1e-3);
                assert!((slope - at(t).1[joint]).abs() < 1e-5 * scale, "{t} {joint}");
            }
        }
    }
}
