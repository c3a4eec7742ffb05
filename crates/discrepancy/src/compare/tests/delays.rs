//! Delay and gain where they are what differs, and where something else is.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::*;

const RECORDS: u64 = 40;

/// Three waves of drawn frequency, amplitude and phase, and their derivatives.
struct Motion([[f64; 3]; 3]);

impl Motion {
    fn drawn(seed: u64) -> Motion {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut within = |low: f64, high: f64| {
            low + (high - low) * f64::from(random.next_u32()) / f64::from(u32::MAX)
        };
        Motion(std::array::from_fn(|_| {
            [within(0.2, 1.5), within(0.2, 1.0), within(0.0, TAU)]
        }))
    }

    fn sum(&self, term: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let waves = self.0.iter();
        waves
            .map(|[hz, size, phase]| term(TAU * hz, *size, *phase))
            .sum()
    }

    fn position(&self, t: f64) -> f64 {
        self.sum(|w, a, p| a * (w * t + p).sin())
    }

    fn velocity(&self, t: f64) -> f64 {
        self.sum(|w, a, p| a * w * (w * t + p).cos())
    }

    fn signals(&self) -> [Explanatory; 3] {
        [
            signal(
                "joint1.angle",
                Kind::Position,
                of_time(|t| self.position(t)),
            ),
            signal(
                "joint1.velocity",
                Kind::Velocity,
                of_time(|t| self.velocity(t)),
            ),
            signal("time", Kind::Time, times()),
        ]
    }
}

/// Records in whose alignment a pattern is left.
fn with_pattern(law: impl Fn(&Motion, f64) -> (f64, f64), colour: Colour) -> Vec<u64> {
    let left = |seed: &u64| {
        let motion = Motion::drawn(*seed);
        let simulated = of_time(|t| law(&motion, t).0);
        let clean = of_time(|t| law(&motion, t).1);
        let measured = sum(&[&clean, &noise(colour, SAMPLES, 700 + seed)]);
        let found = compared(&measured, &simulated, &motion.signals()).unwrap();
        found
            .alignment
            .is_some_and(|one| one.pattern_left.is_some())
    };
    (0..RECORDS).filter(left).collect()
}

/// The angle behind a spring that dry friction of the link holds back by c/K: it lags as if late.
#[test]
fn verify_friction_is_not_told_as_a_delay() {
    for colour in COLOURS {
        let law = |motion: &Motion, t: f64| {
            let driven = 200.0 * motion.position(t);
            (driven, driven - 20.0 * motion.velocity(t).signum())
        };
        let found = with_pattern(law, colour).len() as u64;
        assert!(found >= RECORDS - 2, "{colour:?}: {found} of {RECORDS}");
    }
}

#[test]
fn verify_a_delay_with_a_gain_leaves_no_pattern() {
    for colour in COLOURS {
        let late = |motion: &Motion, t: f64| {
            let law = |t: f64| 200.0 * motion.position(t);
            (law(t), 0.97 * law(t - 0.013))
        };
        let found = with_pattern(late, colour);
        assert!(found.len() <= 2, "{colour:?}: {found:?}");
    }
}

/// A resonance that the simulation lacks, beside a signal with a delay of nothing.
#[test]
fn verify_lines_that_outweigh_a_delay_are_told() {
    for colour in COLOURS {
        let law = |motion: &Motion, t: f64| {
            let simulated = 20.0 * motion.position(t);
            (simulated, simulated + 3.0 * (TAU * 15.7 * t).sin())
        };
        let found = with_pattern(law, colour).len() as u64;
        assert!(found >= RECORDS - 2, "{colour:?}: {found} of {RECORDS}");
    }
}
