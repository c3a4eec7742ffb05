//! Measured motion of all joints, smoothed and differentiated.

use super::drive_forces::FILTER_ORDER;
use super::inputs::{JointQuantity, Source, joint_channel};
use crate::build::gravity_m_s2;
use crate::error::SimError;
use nalgebra::Vector3;
use truecut_arm::{Dynamics, Robot};
use truecut_plan::motion::excitation::SampledMotion;
use truecut_recording::Role;
use truecut_recording::filter::{
    Butterworth, differentiate_over_nine, differentiate_over_seven, differentiate_sixth_order,
};

/// Samples in a period of the cutoff from which on differences smooth: what they take from
/// accelerations that the filter lets pass is less than it lets pass of noise. Central differences,
/// as published (`gautier1997`, `janot2014`), take .13 % from those of a motion of 1 Hz at 100 Hz,
/// which was told as gains, or as a clock that runs fast.
const SMOOTHING_FROM: f64 = 5.0;
/// The same from which on they smooth over nine samples, not seven: what the filter lets pass lies
/// lower then, and noise beside it as well.
const OVER_NINE_FROM: f64 = 10.0;

/// Motion of every joint, `[joint][sample]`, and the gravity that it happens under.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub position: Vec<Vec<f64>>,
    pub velocity: Vec<Vec<f64>>,
    pub acceleration: Vec<Vec<f64>>,
    pub gravity_m_s2: Vector3<f64>,
}

impl Motion {
    /// The measured coordinates through a low pass of this cutoff, and their differences.
    pub fn new(robot: &Robot, source: &Source<'_>, cutoff_hz: f64) -> Result<Motion, SimError> {
        let (rate_hz, interval) = (source.measured.rate_hz(), source.measured.interval_s());
        let smooth = Butterworth::low_pass(FILTER_ORDER, cutoff_hz, rate_hz);
        let slope = match rate_hz / cutoff_hz {
            samples if samples < SMOOTHING_FROM => differentiate_sixth_order,
            samples if samples < OVER_NINE_FROM => differentiate_over_seven,
            _ => differentiate_over_nine,
        };
        let slopes = |columns: &[Vec<f64>]| -> Vec<Vec<f64>> {
            columns
                .iter()
                .map(|column| slope(column, interval))
                .collect()
        };
        let measured = coordinates(robot, source)?;
        let position: Vec<_> = measured.iter().map(|q| smooth.zero_phase(q)).collect();
        let velocity = slopes(&position);
        Ok(Motion {
            acceleration: slopes(&velocity),
            velocity,
            position,
            gravity_m_s2: gravity_m_s2(&source.scenario.robot),
        })
    }

    /// A motion that is known with its derivatives.
    pub fn of(motion: &SampledMotion, gravity_m_s2: Vector3<f64>) -> Motion {
        Motion {
            position: motion.position.clone(),
            velocity: motion.velocity.clone(),
            acceleration: motion.acceleration.clone(),
            gravity_m_s2,
        }
    }

    /// The same course `speed` times as fast.
    pub fn faster(&self, speed: f64) -> Motion {
        let times = |columns: &[Vec<f64>], factor: f64| -> Vec<Vec<f64>> {
            let columns = columns.iter();
            columns
                .map(|column| column.iter().map(|x| x * factor).collect())
                .collect()
        };
        Motion {
            position: self.position.clone(),
            velocity: times(&self.velocity, speed),
            acceleration: times(&self.acceleration, speed * speed),
            gravity_m_s2: self.gravity_m_s2,
        }
    }

    /// The same course under gravity along a unit vector and `speed` times as fast.
    pub fn set_up(&self, gravity_direction: Vector3<f64>, speed: f64) -> Motion {
        Motion {
            gravity_m_s2: gravity_direction * self.gravity_m_s2.norm(),
            ..self.faster(speed)
        }
    }

    /// The same course with one joint's coordinate reversed.
    pub fn reversed(&self, joint: usize) -> Motion {
        let mut motion = self.clone();
        for columns in [
            &mut motion.position,
            &mut motion.velocity,
            &mut motion.acceleration,
        ] {
            columns[joint].iter_mut().for_each(|x| *x = -*x);
        }
        motion
    }

    /// The same course with the coordinates of two joints exchanged.
    pub fn swapped(&self, one: usize, other: usize) -> Motion {
        let mut motion = self.clone();
        for columns in [
            &mut motion.position,
            &mut motion.velocity,
            &mut motion.acceleration,
        ] {
            columns.swap(one, other);
        }
        motion
    }

    /// The same course with the coordinates of some joints a factor times as large.
    pub fn scaled(&self, joints: &[usize], factor: f64) -> Motion {
        let mut motion = self.clone();
        for columns in [
            &mut motion.position,
            &mut motion.velocity,
            &mut motion.acceleration,
        ] {
            for &joint in joints {
                columns[joint].iter_mut().for_each(|x| *x *= factor);
            }
        }
        motion
    }

    /// Unrelated states of all joints: coordinates, speeds and accelerations even between -pi and
    /// pi, SI. The same in every call.
    pub fn of_any_states(&self, states: usize) -> Motion {
        let mut seed = 0_u64;
        // SplitMix64 (`steele2014`).
        let mut draw = || {
            seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = seed;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            let part = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
            std::f64::consts::PI * (2.0 * part - 1.0)
        };
        let mut columns = || -> Vec<Vec<f64>> {
            let joints = 0..self.position.len();
            (joints.map(|_| (0..states).map(|_| draw()).collect())).collect()
        };
        Motion {
            position: columns(),
            velocity: columns(),
            acceleration: columns(),
            gravity_m_s2: self.gravity_m_s2,
        }
    }

    /// Inverse dynamics under a gravity at every sample: `[joint][sample]` for the joints asked
    /// for.
    pub fn inverse_dynamics(
        &self,
        dynamics: &mut Dynamics,
        gravity_m_s2: &Vector3<f64>,
        joints: &[usize],
    ) -> Vec<Vec<f64>> {
        let n = self.position.len();
        let samples = self.position.first().map_or(0, Vec::len);
        let mut columns = vec![Vec::with_capacity(samples); joints.len()];
        let at = |columns: &[Vec<f64>], k: usize, into: &mut [f64]| {
            for (value, column) in into.iter_mut().zip(columns) {
                *value = column[k];
            }
        };
        let (mut q, mut v, mut a) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut tau = vec![0.0; n];
        for k in 0..samples {
            at(&self.position, k, &mut q);
            at(&self.velocity, k, &mut v);
            at(&self.acceleration, k, &mut a);
            dynamics.inverse_dynamics_into(&q, &v, &a, gravity_m_s2, &mut tau);
            for (column, &joint) in columns.iter_mut().zip(joints) {
                column.push(tau[joint]);
            }
        }
        columns
    }
}

/// The measured coordinates of all joints.
fn coordinates<'a>(robot: &Robot, source: &Source<'a>) -> Result<Vec<&'a [f64]>, SimError> {
    let names: Vec<String> = (0..robot.dof())
        .map(|joint| joint_channel(robot, joint, JointQuantity::Coordinate))
        .collect();
    source.refuse_others(&names)?;
    (0..robot.dof())
        .map(|joint| {
            let channel = source.joint(robot, joint, JointQuantity::Coordinate)?;
            let Some(channel) = channel.filter(|channel| channel.role == Role::Input) else {
                let message = format!(
                    "inverse dynamics needs the motion of every joint, but no column is mapped to {} with \
                     role \"input\"",
                    names[joint]
                );
                return Err(source.error(&names[joint], message));
            };
            source.made_within_limits(robot, joint, channel)?;
            source.complete(channel)
        })
        .collect()
}
