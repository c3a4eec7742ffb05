//! The trajectory nearest to the steady turn, on a grid of angles.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use truecut_core::wheel::precession::{AngleSet, wrapped};

/// Angles of a turn.
pub(super) struct Grid {
    pub angles: usize,
}

/// Stations at which a search ended.
#[derive(Debug)]
pub(super) struct Stuck {
    pub stations: Vec<usize>,
    /// No angle is left there at all; else there are some that cannot be reached in time.
    pub narrow: bool,
}

/// Angles of the grid that follow each other without a gap: the first, and how many. `closed` if
/// the last meets the first.
struct AngleRun {
    first: usize,
    count: usize,
    closed: bool,
}

impl Grid {
    fn step_rad(&self) -> f64 {
        TAU / self.angles as f64
    }

    fn runs(&self, set: &AngleSet) -> Vec<AngleRun> {
        let AngleSet::Arcs(arcs) = set else {
            return vec![AngleRun {
                first: 0,
                count: self.angles,
                closed: true,
            }];
        };
        let runs = arcs.iter().filter_map(|arc| {
            let first = (arc.from_rad / self.step_rad()).ceil() as usize;
            let end = (arc.to_rad / self.step_rad()).floor() as usize + 1;
            (end > first).then(|| AngleRun {
                first,
                count: end - first,
                closed: false,
            })
        });
        runs.collect()
    }

    /// The trajectory of least ∫ deviation² dt through `sets`, turns counted from the first angle
    /// in [0, 2π). From one station to the next it moves within one arc of the earlier station's
    /// set, at the rate that `rates_rad_s` has for this step at most.
    ///
    /// # Errors
    /// Where no trajectory gets through.
    pub fn trajectory(
        &self,
        sets: &[AngleSet],
        times_s: &[f64],
        nominal_rad: &[f64],
        rates_rad_s: &[f64],
    ) -> Result<Vec<f64>, Stuck> {
        let runs: Vec<Vec<AngleRun>> = sets.iter().map(|set| self.runs(set)).collect();
        let stations: Vec<usize> = (0..runs.len()).filter(|k| runs[*k].is_empty()).collect();
        if !stations.is_empty() {
            let narrow = true;
            return Err(Stuck { stations, narrow });
        }
        let last = sets.len() - 1;
        let mut costs = vec![0.0; self.angles];
        self.charge(
            &mut costs,
            &runs[0],
            nominal_rad[0],
            times_s[1] - times_s[0],
        );
        // Steps of the grid by which each angle was reached, station by station.
        let mut came_by: Vec<Vec<i16>> = Vec::with_capacity(last);
        for k in 1..=last {
            let far_rad = rates_rad_s[k - 1] * (times_s[k] - times_s[k - 1]);
            let most = (far_rad / self.step_rad()) as usize;
            let (mut reached, steps) = self.reached(&costs, &runs[k - 1], most);
            let held_s = times_s[(k + 1).min(last)] - times_s[k - 1];
            self.charge(&mut reached, &runs[k], nominal_rad[k], held_s);
            if reached.iter().all(|cost| cost.is_infinite()) {
                return Err(Stuck {
                    stations: vec![k],
                    narrow: false,
                });
            }
            costs = reached;
            came_by.push(steps);
        }
        Ok(self.traced(&costs, &came_by))
    }

    /// Adds what a station costs, and forbids what it does not allow.
    fn charge(&self, costs: &mut [f64], runs: &[AngleRun], nominal_rad: f64, held_s: f64) {
        let mut charged = vec![f64::INFINITY; self.angles];
        for run in runs {
            for angle in run.first..run.first + run.count {
                let angle = angle % self.angles;
                let deviation = wrapped(angle as f64 * self.step_rad() - nominal_rad);
                charged[angle] = costs[angle] + deviation * deviation * held_s;
            }
        }
        costs.copy_from_slice(&charged);
    }

    /// Least cost at which each angle is reached by at most `most` steps within a run, and by how
    /// many. A sliding minimum, linear in the angles whatever the rate.
    fn reached(&self, costs: &[f64], runs: &[AngleRun], most: usize) -> (Vec<f64>, Vec<i16>) {
        let most = most.min(self.angles / 2 - 1);
        let mut least = vec![f64::INFINITY; self.angles];
        let mut steps = vec![0; self.angles];
        let mut queue: VecDeque<(usize, f64)> = VecDeque::new();
        for run in runs {
            // A closed run is walked with an overlap at both ends; places count from its first
            // angle, less the overlap.
            let overlap = if run.closed { most } else { 0 };
            let places = run.count + 2 * overlap;
            let angle = |place: usize| (run.first + self.angles + place - overlap) % self.angles;
            queue.clear();
            let mut next = 0;
            for place in overlap..overlap + run.count {
                while next < places && next <= place + most {
                    let cost = costs[angle(next)];
                    while queue.back().is_some_and(|(_, worse)| *worse > cost) {
                        queue.pop_back();
                    }
                    queue.push_back((next, cost));
                    next += 1;
                }
                while queue.front().is_some_and(|(from, _)| from + most < place) {
                    queue.pop_front();
                }
                if let Some((from, cost)) = queue.front() {
                    least[angle(place)] = *cost;
                    steps[angle(place)] = (place as i64 - *from as i64) as i16;
                }
            }
        }
        (least, steps)
    }

    fn traced(&self, costs: &[f64], came_by: &[Vec<i16>]) -> Vec<f64> {
        let cheapest = (0..self.angles).min_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let mut angle = cheapest.unwrap_or(0) as i64;
        let mut trajectory = vec![angle];
        for steps in came_by.iter().rev() {
            angle -= i64::from(steps[angle.rem_euclid(self.angles as i64) as usize]);
            trajectory.push(angle);
        }
        trajectory.reverse();
        let turns = trajectory[0].div_euclid(self.angles as i64) * self.angles as i64;
        let angles = trajectory
            .iter()
            .map(|a| (a - turns) as f64 * self.step_rad());
        angles.collect()
    }
}

/// Mean over `window_s` about each of `at_s`, which grow, of what runs straight between values, the
/// first and the last of them held beyond the ends.
pub(super) fn moving_mean(
    times_s: &[f64],
    values: &[f64],
    window_s: f64,
    at_s: &[f64],
) -> Vec<f64> {
    let last = times_s.len() - 1;
    let mut sums = vec![0.0];
    for k in 1..=last {
        let step = 0.5 * (values[k] + values[k - 1]) * (times_s[k] - times_s[k - 1]);
        sums.push(sums[k - 1] + step);
    }
    // Integral from the first time to any, `near` the place of the last one asked for.
    let integral = |time_s: f64, near: &mut usize| {
        if time_s <= times_s[0] {
            return (time_s - times_s[0]) * values[0];
        }
        if time_s >= times_s[last] {
            return sums[last] + (time_s - times_s[last]) * values[last];
        }
        while times_s[*near + 1] < time_s {
            *near += 1;
        }
        let k = *near;
        let (in_s, over_s) = (time_s - times_s[k], times_s[k + 1] - times_s[k]);
        let slope = (values[k + 1] - values[k]) / over_s;
        sums[k] + in_s * (values[k] + 0.5 * slope * in_s)
    };
    let (mut behind, mut ahead) = (0, 0);
    let mean = |time_s: &f64| {
        let to = integral(time_s + 0.5 * window_s, &mut ahead);
        let from = integral(time_s - 0.5 * window_s, &mut behind);
        (to - from) / window_s
    };
    at_s.iter().map(mean).collect()
}

#[cfg(test)]
mod tests;
