//! Commanded joint coordinates over time.

use crate::error::SimError;
use crate::process::ForceSamples;
use nalgebra::{Isometry3, Translation3, Vector3};
use truecut_arm::{FrameId, IkOptions, Load, Robot};
use truecut_plan::motion::LeadIn;
use truecut_plan::motion::interpolation::{hermite, lagrange};
use truecut_plan::motion::straight::SolvedPath;
use truecut_recording::spline_slopes;

/// In which a commanded feed comes up to speed.
const LEAD_IN: LeadIn = LeadIn { duration_s: 0.1 };
/// Knots of a path lie this far apart, m. Cubic interpolation between them errs by less than 1e-9 m
/// on the posture changes of a machining path.
const KNOT_SPACING_M: f64 = 2e-3;

/// What the controller asks of the joints.
pub(crate) enum JointCommand {
    /// One posture for the whole run.
    Hold(Vec<f64>),
    /// A straight path of the tool.
    Along(StraightCommand),
    /// Measured commands and drive forces.
    Replay(Samples),
}

/// Knots of a straight path and the speed along it.
pub(crate) struct StraightCommand {
    speed_m_per_s: f64,
    start_m: f64,
    spacing_m: f64,
    /// Whether it starts at rest; else at its speed.
    from_rest: bool,
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
            Self::Replay(samples) => samples.at(t_s, position, velocity),
        }
    }

    /// Asks for `by` more of a joint, all the time.
    pub(crate) fn shift(&mut self, joint: usize, by: f64) {
        let postures = match self {
            Self::Hold(posture) => std::slice::from_mut(posture),
            Self::Along(path) => &mut path.knots[..],
            Self::Replay(samples) => &mut samples.postures[..],
        };
        for posture in postures {
            posture[joint] += by;
        }
    }

    /// Given drive force of every joint at time `t`.
    pub(crate) fn force_at(&self, t_s: f64, force: &mut [f64]) {
        force.fill(0.0);
        let Self::Replay(samples) = self else { return };
        for (force, series) in force.iter_mut().zip(&samples.forces) {
            *force = series.as_ref().map_or(0.0, |series| series.at(t_s));
        }
    }

    /// The same for an arm with `count` further joints before the first, which stay at zero.
    pub(crate) fn behind(mut self, count: usize) -> Self {
        let postures = match &mut self {
            Self::Hold(posture) => std::slice::from_mut(posture),
            Self::Along(path) => &mut path.knots,
            Self::Replay(samples) => {
                samples
                    .forces
                    .splice(0..0, std::iter::repeat_n(None, count));
                for slopes in &mut samples.slopes {
                    slopes.splice(0..0, std::iter::repeat_n(0.0, count));
                }
                &mut samples.postures
            }
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

    /// Velocities of the joints at the start, where the arm starts with those of its command; else
    /// none.
    pub(crate) fn start_velocity(&self, dof: usize) -> Vec<f64> {
        let (mut position, mut velocity) = (vec![0.0; dof], vec![0.0; dof]);
        if let Self::Along(path) = self
            && !path.from_rest
        {
            path.at(0.0, &mut position, &mut velocity);
        }
        velocity
    }

    /// Postures that the command passes through, for checking limits.
    pub(crate) fn postures(&self) -> &[Vec<f64>] {
        match self {
            Self::Hold(posture) => std::slice::from_ref(posture),
            Self::Along(path) => &path.knots,
            Self::Replay(samples) => &samples.postures,
        }
    }
}

/// Commands sampled at a constant rate from t = 0 on; a single one holds for ever.
pub(crate) struct Samples {
    pub interval_s: f64,
    /// `[sample][joint]`.
    postures: Vec<Vec<f64>>,
    /// Of the spline through them, per interval; `[sample][joint]`.
    slopes: Vec<Vec<f64>>,
    /// Given drive force of each joint, where there is one.
    forces: Vec<Option<ForceSamples>>,
}

impl Samples {
    /// Commands at every interval, `[sample][joint]`, and drive forces.
    pub fn new(
        interval_s: f64,
        postures: Vec<Vec<f64>>,
        forces: Vec<Option<ForceSamples>>,
    ) -> Self {
        let dof = postures.first().map_or(0, Vec::len);
        let mut slopes = vec![vec![0.0; dof]; postures.len()];
        let intervals: Vec<f64> = (0..postures.len()).map(|k| k as f64).collect();
        for joint in 0..dof {
            let knots: Vec<f64> = postures.iter().map(|posture| posture[joint]).collect();
            for (row, slope) in slopes.iter_mut().zip(spline_slopes(&intervals, &knots)) {
                row[joint] = slope;
            }
        }
        Self {
            interval_s,
            postures,
            slopes,
            forces,
        }
    }

    /// A cubic spline: the velocity is the derivative of the position, and both and the
    /// acceleration are continuous. Slopes by central differences, of second order, made a drive's
    /// damping look like a viscous friction of `D (h ω)²/6` more. Behind the last sample
    /// it goes on as it ended: the last step of a run may lie a fraction of a step behind, and a
    /// command that stopped there at once would ask a jump of the drives.
    fn at(&self, t_s: f64, position: &mut [f64], velocity: &mut [f64]) {
        let last = self.postures.len() - 1;
        let x = (t_s / self.interval_s).clamp(0.0, last as f64);
        let k = (x.floor() as usize).min(last.saturating_sub(1));
        let u = x - k as f64;
        let moves = last > 0 && t_s >= 0.0;
        let behind_s = (t_s - last as f64 * self.interval_s).max(0.0);
        for joint in 0..position.len() {
            let knot = |i: usize| self.postures[i][joint];
            let ends = [knot(k), knot((k + 1).min(last))];
            let slopes = [k, (k + 1).min(last)].map(|i| self.slopes[i][joint]);
            let [value, rate] = hermite(ends, slopes, u);
            velocity[joint] = if moves { rate / self.interval_s } else { 0.0 };
            position[joint] = value + velocity[joint] * behind_s;
        }
    }
}

impl StraightCommand {
    /// Solves the knots by inverse kinematics from `q0`, and adds the sag that the command makes up
    /// for.
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
            spacing_m: KNOT_SPACING_M,
            from_rest: true,
            knots,
        })
    }

    /// A path whose postures are known, at its speed from the start on, with the sag that the
    /// command makes up for.
    pub(crate) fn of(
        robot: &Robot,
        path: SolvedPath,
        speed_m_per_s: f64,
        sag: Option<&Load>,
    ) -> Result<Self, SimError> {
        let knots = match sag {
            Some(load) => robot.holding_commands(&path.knots, load)?,
            None => path.knots,
        };
        Ok(Self {
            speed_m_per_s,
            start_m: 0.0,
            spacing_m: path.spacing_m,
            from_rest: false,
            knots,
        })
    }

    /// Distance along the path and its rate: a lead-in, then constant speed.
    fn distance(&self, t_s: f64) -> (f64, f64) {
        if !self.from_rest {
            return (self.speed_m_per_s * t_s, self.speed_m_per_s);
        }
        (
            self.speed_m_per_s * LEAD_IN.own_s(t_s),
            self.speed_m_per_s * LEAD_IN.rate(t_s),
        )
    }

    fn at(&self, t_s: f64, position: &mut [f64], velocity: &mut [f64]) {
        let (distance, rate) = self.distance(t_s);
        let x = (distance - self.start_m) / self.spacing_m;
        let k = (x.floor() as usize).clamp(1, self.knots.len() - 3);
        let u = x - k as f64;
        for joint in 0..position.len() {
            let knot = |i: usize| self.knots[k + i - 1][joint];
            let [value, slope] = lagrange([0, 1, 2, 3].map(knot), u);
            position[joint] = value;
            velocity[joint] = slope * rate / self.spacing_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The interpolant goes through the samples, is exact for parabolas inside, and its velocity is
    /// its slope.
    #[test]
    fn measured_commands_are_smooth_between_samples() {
        let h = 0.01;
        let parabola = |t: f64| 0.3 - 2.0 * t + 5.0 * t * t;
        let postures = (0..50).map(|k| vec![parabola(h * k as f64)]).collect();
        let command = JointCommand::Replay(Samples::new(h, postures, vec![None]));
        let at = |t: f64| {
            let (mut p, mut v) = ([0.0], [0.0]);
            command.at(t, &mut p, &mut v);
            (p[0], v[0])
        };
        for t in [0.0, 0.004, 0.01, 0.0137, 0.2, 0.2051, 0.47, 0.486] {
            let (p, v) = at(t);
            assert!((p - parabola(t)).abs() < 1e-14, "{t}");
            assert!((v - (10.0 * t - 2.0)).abs() < 1e-11, "{t}");
        }
        assert_eq!(at(0.49).0, parabola(0.49));
        let (end, rate) = at(0.49);
        assert!(rate > 0.0);
        assert_eq!(at(0.4901), (end + 1e-4 * rate, rate), "goes on behind it");
    }

    #[test]
    fn verify_velocity_is_the_derivative_of_the_command() {
        let path = StraightCommand {
            speed_m_per_s: 0.05,
            start_m: -2.0 * KNOT_SPACING_M,
            spacing_m: KNOT_SPACING_M,
            from_rest: true,
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
