//! How a wheel presses on a face while it is on it, for what a run ends with.

use truecut_core::wheel::force_control::ForceControl;
use truecut_recording::Outcome;

/// Part of the time at a stop above which a force counts as not held: its larger half. Setting down
/// and lifting take some thousandths.
const MOST_STOPPED: f64 = 0.5;

/// What is summed up while the run goes on.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pressing {
    /// Time in contact, s, and the part of it with the carrier at a stop.
    pub contact_s: f64,
    stopped_s: f64,
    /// `∫ F dt`, N s.
    impulse_n_s: f64,
    /// `∫ F² dt`, N² s.
    square_n2_s: f64,
    pub largest_n: f64,
}

impl Pressing {
    pub fn step(&mut self, normal_n: f64, at_stop: bool, dt_s: f64) {
        self.impulse_n_s += normal_n * dt_s;
        self.square_n2_s += normal_n.powi(2) * dt_s;
        self.largest_n = self.largest_n.max(normal_n);
        if normal_n > 0.0 {
            self.contact_s += dt_s;
            self.stopped_s += if at_stop { dt_s } else { 0.0 };
        }
    }

    /// Mean force in contact, N.
    pub fn mean_n(&self) -> f64 {
        self.impulse_n_s / self.contact_s
    }

    /// Standard deviation of the force in contact, N.
    pub fn spread_n(&self) -> f64 {
        let variance = self.square_n2_s / self.contact_s - self.mean_n().powi(2);
        variance.max(0.0).sqrt()
    }

    /// Part of the time in contact with the carrier at a stop.
    pub fn stopped(&self) -> f64 {
        self.stopped_s / self.contact_s
    }

    /// A force is held while the carrier is free: that it stands at an end of its stroke for most
    /// of the time is another process than the one asked for.
    pub fn at_stop(&self, control: &ForceControl) -> Option<Outcome> {
        let value = self.stopped();
        let holds = *control == ForceControl::Position || value.is_nan() || value <= MOST_STOPPED;
        (!holds).then(|| Outcome::BeyondModel {
            quantity: "the part of the time on the face during which the carrier stands at an end of its stroke"
                .to_owned(),
            value,
            limit: MOST_STOPPED,
            rule: "the force is not the one asked for; ask for another force or give a longer stroke \
                   (`run.overload = \"warn\"` leaves the verdict to the claims)"
                .to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HELD: ForceControl = ForceControl::ConstantForce {
        force_n: 15.0,
        damping_n_s_per_m: 500.0,
        fastest_m_per_s: 0.05,
        stroke_m: 2e-3,
        stiction_n: 0.0,
    };

    /// A carrier at its stop for most of the time on the face holds no force; without one there is
    /// nothing to hold, and without contact nothing to tell.
    #[test]
    fn a_carrier_that_stands_at_its_stop_fails_the_run() {
        let pressed = |stopped_s: f64, contact_s: f64| Pressing {
            stopped_s,
            contact_s,
            ..Pressing::default()
        };
        assert!(pressed(2.0, 2.0).at_stop(&HELD).is_some());
        assert_eq!(pressed(0.9, 2.0).at_stop(&HELD), None);
        assert_eq!(pressed(0.0, 0.0).at_stop(&HELD), None);
        assert_eq!(pressed(2.0, 2.0).at_stop(&ForceControl::Position), None);
    }

    #[test]
    fn verify_mean_and_spread_of_a_force_in_two_steps() {
        let mut pressing = Pressing::default();
        pressing.step(0.0, true, 1.0);
        pressing.step(10.0, false, 0.5);
        pressing.step(20.0, true, 0.5);
        assert_eq!([pressing.contact_s, pressing.mean_n()], [1.0, 15.0]);
        assert!((pressing.spread_n() - 5.0).abs() < 1e-12);
        assert_eq!([pressing.stopped(), pressing.largest_n], [0.5, 20.0]);
    }
}
