//! Watches a run for divergence.

use truecut_recording::Outcome;

/// Energy that numerics may add, as a part of all that has been exchanged, before a run counts as
/// diverging.
const ENERGY_SHARE: f64 = 0.05;
/// And a floor for runs in which hardly anything moves, J.
const ENERGY_FLOOR_J: f64 = 1e-3;

/// Balance of energy over a run and the bounds of the joints.
pub(crate) struct Guard {
    limits: Vec<(String, f64, f64, &'static str)>,
    start_j: f64,
    work_j: f64,
    exchanged_j: f64,
    last_power_w: f64,
    started: bool,
}

/// What the guard looks at in a step.
pub(crate) struct Watch<'a> {
    pub time_s: f64,
    pub positions: &'a [f64],
    pub velocities: &'a [f64],
    /// `None` where no balance is drawn.
    pub balance: Option<Balance>,
}

/// Energy and power of one step.
pub(crate) struct Balance {
    pub dt_s: f64,
    /// If it was looked at in this step; always in the first.
    pub energy_j: Option<f64>,
    /// Power of loads and drives less what is dissipated, W.
    pub power_w: f64,
}

impl Guard {
    /// `limits`: name, lower, upper, unit of every joint.
    pub(crate) fn new(limits: Vec<(String, f64, f64, &'static str)>) -> Self {
        Self {
            limits,
            start_j: 0.0,
            work_j: 0.0,
            exchanged_j: 0.0,
            last_power_w: 0.0,
            started: false,
        }
    }

    /// `Some` if the run has diverged.
    pub(crate) fn check(&mut self, watch: &Watch<'_>) -> Option<Outcome> {
        self.not_finite(watch)
            .or_else(|| self.outside_limits(watch))
            .or_else(|| self.energy_grows(watch.time_s, watch.balance.as_ref()?))
    }

    fn not_finite(&self, watch: &Watch<'_>) -> Option<Outcome> {
        let joints = self
            .limits
            .iter()
            .zip(watch.positions.iter().zip(watch.velocities));
        for ((name, ..), (q, v)) in joints {
            if !(q.is_finite() && v.is_finite()) {
                return Some(Outcome::Diverged {
                    time_s: watch.time_s,
                    quantity: format!("coordinate of joint `{name}`"),
                    value: *q,
                    limit: f64::MAX,
                    rule: "every coordinate and velocity is a finite number".into(),
                });
            }
        }
        None
    }

    fn outside_limits(&self, watch: &Watch<'_>) -> Option<Outcome> {
        for ((name, lower, upper, unit), q) in self.limits.iter().zip(watch.positions) {
            if q < lower || q > upper {
                return Some(Outcome::Diverged {
                    time_s: watch.time_s,
                    quantity: format!("coordinate of joint `{name}`, {unit}"),
                    value: *q,
                    limit: if q < lower { *lower } else { *upper },
                    rule: "a joint stays within its limits".into(),
                });
            }
        }
        None
    }

    /// The energy of the arm may grow only by the work done on it (trapezoidal in time).
    fn energy_grows(&mut self, time_s: f64, balance: &Balance) -> Option<Outcome> {
        if !self.started {
            self.start_j = balance.energy_j?;
            self.started = true;
        } else {
            let power = 0.5 * (self.last_power_w + balance.power_w);
            self.work_j += power * balance.dt_s;
            self.exchanged_j += power.abs() * balance.dt_s;
        }
        self.last_power_w = balance.power_w;
        let growth = balance.energy_j? - self.start_j - self.work_j;
        let limit = ENERGY_SHARE * (self.exchanged_j + self.start_j.abs()) + ENERGY_FLOOR_J;
        (growth > limit || !growth.is_finite()).then(|| Outcome::Diverged {
            time_s,
            quantity: "energy of the arm beyond the work done on it, J".into(),
            value: growth,
            limit,
            rule: "energy grows only by work; a growth of its own is an unstable step".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watch(time_s: f64, q: &[f64], energy_j: f64, power_w: f64) -> Watch<'_> {
        Watch {
            time_s,
            positions: q,
            velocities: &[0.0],
            balance: Some(Balance {
                dt_s: 1e-3,
                energy_j: Some(energy_j),
                power_w,
            }),
        }
    }

    fn guard() -> Guard {
        Guard::new(vec![("j".into(), -1.0, 1.0, "rad")])
    }

    #[test]
    fn work_done_on_the_arm_is_no_divergence() {
        let mut g = guard();
        for i in 0..1000 {
            let t = i as f64 * 1e-3;
            assert_eq!(g.check(&watch(t, &[0.0], 5.0 * t, 5.0)), None);
        }
    }

    #[test]
    fn energy_from_nowhere_is_found() {
        let mut g = guard();
        assert_eq!(g.check(&watch(0.0, &[0.0], 1.0, 0.0)), None);
        let found = g.check(&watch(1e-3, &[0.0], 1.2, 0.0));
        assert!(
            matches!(found, Some(Outcome::Diverged { value, .. }) if (value - 0.2).abs() < 1e-12)
        );
    }

    #[test]
    fn nan_and_limits_are_found_with_joint_and_time() {
        let Some(Outcome::Diverged { quantity, .. }) =
            guard().check(&watch(0.5, &[f64::NAN], 0.0, 0.0))
        else {
            panic!("NaN passed");
        };
        assert!(quantity.contains("`j`"));
        let Some(Outcome::Diverged { limit, time_s, .. }) =
            guard().check(&watch(0.5, &[1.5], 0.0, 0.0))
        else {
            panic!("limit passed");
        };
        assert_eq!((limit, time_s), (1.0, 0.5));
    }
}
