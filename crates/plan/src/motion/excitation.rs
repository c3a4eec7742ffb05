//! Motions that excite an arm: a Fourier series for each joint that starts and ends at rest.
//!
//! `q(t) = c + Σ aₖ sin(2πk t/T) + bₖ cos(2πk t/T)`, k from 1 to K (`swevers1997`). With
//! `Σ k aₖ = 0` and `Σ k² bₖ = 0` velocity and acceleration are zero at the ends of a period, so
//! that the arm is at rest there. A series is made of free numbers such that bounds of place, speed
//! and acceleration hold at every sample, whatever the numbers are: an optimiser need not know of
//! them.

use std::f64::consts::TAU;

/// What a joint may do, rad or m, per second, per second squared; infinite where it is not bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointRange {
    /// Least coordinate, finite.
    pub lower: f64,
    /// Largest coordinate, finite.
    pub upper: f64,
    /// Largest speed.
    pub speed: f64,
    /// Largest acceleration.
    pub acceleration: f64,
}

/// Which series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesForm {
    /// Time of the whole motion, s.
    pub duration_s: f64,
    /// So many times the series runs through in it.
    pub periods: usize,
    /// Number of harmonics, at least 2: a single one is never at rest.
    pub harmonics: usize,
}

impl SeriesForm {
    /// Time of one period, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.duration_s / self.periods as f64
    }

    /// Frequency of the highest harmonic, Hz.
    #[must_use]
    pub fn highest_hz(&self) -> f64 {
        self.harmonics as f64 / self.period_s()
    }

    /// Free numbers of a joint: sines, cosines, how far it goes, and where.
    #[must_use]
    pub fn numbers_per_joint(&self) -> usize {
        2 * self.harmonics + 2
    }
}

/// A series of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSeries {
    /// The constant, rad or m.
    pub centre: f64,
    /// Amplitudes of the sines, from the first harmonic on.
    pub sines: Vec<f64>,
    /// Amplitudes of the cosines.
    pub cosines: Vec<f64>,
}

/// Coordinates and their first two derivatives, `[joint][sample]`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SampledMotion {
    /// Coordinates, rad or m.
    pub position: Vec<Vec<f64>>,
    /// Velocities.
    pub velocity: Vec<Vec<f64>>,
    /// Accelerations.
    pub acceleration: Vec<Vec<f64>>,
}

/// All series of a form within the ranges of the joints, at given times.
#[derive(Debug, Clone)]
pub struct SeriesSpace {
    form: SeriesForm,
    ranges: Vec<JointRange>,
    /// `[harmonic][sample]`.
    sine: Vec<Vec<f64>>,
    cosine: Vec<Vec<f64>>,
}

impl SeriesSpace {
    /// Series whose bounds hold at these times, s.
    #[must_use]
    pub fn new(form: SeriesForm, ranges: Vec<JointRange>, times_s: &[f64]) -> Self {
        let rate = |k: usize| TAU * k as f64 / form.period_s();
        let table = |of: fn(f64) -> f64| {
            let row = |k| times_s.iter().map(|t| of(rate(k) * t)).collect();
            (1..=form.harmonics).map(row).collect()
        };
        Self {
            sine: table(f64::sin),
            cosine: table(f64::cos),
            form,
            ranges,
        }
    }

    /// Free numbers of a motion of all joints.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.form.numbers_per_joint() * self.ranges.len()
    }

    /// The series that free numbers stand for, any finite ones: for each joint shares of the sines
    /// (by speed) and of the cosines (by acceleration), how much of its bounds it uses, and where
    /// it lies in the range that is left, the last two through a logistic function.
    ///
    /// # Panics
    /// If there are not [`dimension`](Self::dimension) numbers.
    #[must_use]
    pub fn series(&self, numbers: &[f64]) -> Vec<JointSeries> {
        assert_eq!(numbers.len(), self.dimension());
        let each = numbers.chunks(self.form.numbers_per_joint());
        (each.zip(&self.ranges))
            .map(|(own, range)| self.joint(own, range))
            .collect()
    }

    fn joint(&self, numbers: &[f64], range: &JointRange) -> JointSeries {
        let (shares, rest) = numbers.split_at(2 * self.form.harmonics);
        let (by_speed, by_acceleration) = shares.split_at(self.form.harmonics);
        let at_rest = |shares: &[f64], power: i32| -> Vec<f64> {
            let mean = shares.iter().sum::<f64>() / shares.len() as f64;
            let harmonics = (1..).zip(shares);
            harmonics
                .map(|(k, share)| (share - mean) / f64::from(k).powi(power))
                .collect()
        };
        let mut series = JointSeries {
            centre: 0.0,
            sines: at_rest(by_speed, 1),
            cosines: at_rest(by_acceleration, 2),
        };
        let [place, speed, acceleration] = self.sampled_joint(&series);
        let ([low, high], width) = (ends(&place), range.upper - range.lower);
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let most = (width / (high - low))
            .min(range.speed / largest(&speed))
            .min(range.acceleration / largest(&acceleration));
        // Equal shares are no motion at all.
        let most = if most.is_finite() { most } else { 0.0 };
        let size = most * logistic(rest[0]);
        for amplitude in series.sines.iter_mut().chain(&mut series.cosines) {
            *amplitude *= size;
        }
        let left = (width - size * (high - low)).max(0.0);
        series.centre = range.lower + left * logistic(rest[1]) - size * low;
        series
    }

    /// The motion at the times.
    #[must_use]
    pub fn sampled(&self, series: &[JointSeries]) -> SampledMotion {
        let mut motion = SampledMotion::default();
        for one in series {
            let [position, velocity, acceleration] = self.sampled_joint(one);
            motion.position.push(position);
            motion.velocity.push(velocity);
            motion.acceleration.push(acceleration);
        }
        motion
    }

    fn sampled_joint(&self, series: &JointSeries) -> [Vec<f64>; 3] {
        let samples = self.sine.first().map_or(0, Vec::len);
        let mut columns = [
            vec![series.centre; samples],
            vec![0.0; samples],
            vec![0.0; samples],
        ];
        let [place, speed, acceleration] = &mut columns;
        for (k, (a, b)) in series.sines.iter().zip(&series.cosines).enumerate() {
            let rate = TAU * (k + 1) as f64 / self.form.period_s();
            for (i, (sine, cosine)) in self.sine[k].iter().zip(&self.cosine[k]).enumerate() {
                let wave = a * sine + b * cosine;
                place[i] += wave;
                speed[i] += rate * (a * cosine - b * sine);
                acceleration[i] -= rate * rate * wave;
            }
        }
        columns
    }
}

/// The same motion so many times as large about the middle of each joint's way.
#[must_use]
pub fn scaled(series: &[JointSeries], factor: f64) -> Vec<JointSeries> {
    let mut scaled = series.to_vec();
    for one in &mut scaled {
        for amplitude in one.sines.iter_mut().chain(&mut one.cosines) {
            *amplitude *= factor;
        }
    }
    scaled
}

fn ends(values: &[f64]) -> [f64; 2] {
    let [none, all] = [f64::INFINITY, f64::NEG_INFINITY];
    (values.iter()).fold([none, all], |[low, high], x| [low.min(*x), high.max(*x)])
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FORM: SeriesForm = SeriesForm {
        duration_s: 20.0,
        periods: 2,
        harmonics: 4,
    };

    fn times() -> Vec<f64> {
        (0..=2000).map(|k| 0.01 * f64::from(k)).collect()
    }

    fn range() -> impl Strategy<Value = JointRange> {
        (-3.0..3.0, 0.1..5.0, 0.1..4.0, 0.1..20.0).prop_map(
            |(lower, width, speed, acceleration)| JointRange {
                lower,
                upper: lower + width,
                speed,
                acceleration,
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Bounds hold at every sample, whatever the numbers; the ends are at rest; one of the
        /// bounds is nearly met where as much as possible of them is to be used.
        #[test]
        fn verify_bounds_hold_at_every_sample_and_the_ends_are_at_rest(
            ranges in proptest::collection::vec(range(), 1..4),
            drawn in proptest::collection::vec(-4.0..4.0, 30),
        ) {
            let space = SeriesSpace::new(FORM, ranges.clone(), &times());
            let motion = space.sampled(&space.series(&drawn[..space.dimension()]));
            let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (joint, range) in ranges.iter().enumerate() {
                let [low, high] = ends(&motion.position[joint]);
                let slack = 1e-9 * (1.0 + range.upper.abs() + range.lower.abs());
                prop_assert!(low >= range.lower - slack && high <= range.upper + slack);
                let (v, a) = (&motion.velocity[joint], &motion.acceleration[joint]);
                prop_assert!(largest(v) <= range.speed * (1.0 + 1e-9));
                prop_assert!(largest(a) <= range.acceleration * (1.0 + 1e-9));
                for k in [0, 1000, 2000] {
                    prop_assert!(v[k].abs() < 1e-9 * largest(v).max(1e-3));
                    prop_assert!(a[k].abs() < 1e-7 * largest(a).max(1e-3));
                }
                let use_of = |most: f64, limit: f64| most / limit;
                let share = use_of(high - low, range.upper - range.lower)
                    .max(use_of(largest(v), range.speed))
                    .max(use_of(largest(a), range.acceleration));
                let asked = logistic(drawn[joint * FORM.numbers_per_joint() + 8]);
                prop_assert!((share / asked - 1.0).abs() < 1e-6, "{share} {asked}");
            }
        }
    }

    /// Velocity and acceleration are the derivatives of the coordinate.
    #[test]
    fn verify_derivatives() {
        let range = JointRange {
            lower: -1.0,
            upper: 2.0,
            speed: f64::INFINITY,
            acceleration: f64::INFINITY,
        };
        let numbers = [0.3, -1.2, 0.8, 0.1, -0.4, 0.9, 1.1, -0.7, 1.0, 0.2];
        let series = SeriesSpace::new(FORM, vec![range], &times()).series(&numbers);
        let h = 1e-4;
        for t in [0.0, 1.3, 4.9, 12.0] {
            let near: Vec<f64> = (-1..=1).map(|k| t + h * f64::from(k)).collect();
            let motion = SeriesSpace::new(FORM, vec![range], &near).sampled(&series);
            let (q, v, a) = (
                &motion.position[0],
                &motion.velocity[0],
                &motion.acceleration[0],
            );
            assert!((0.5 * (q[2] - q[0]) / h - v[1]).abs() < 1e-7);
            assert!((0.5 * (v[2] - v[0]) / h - a[1]).abs() < 1e-7);
        }
    }
}
