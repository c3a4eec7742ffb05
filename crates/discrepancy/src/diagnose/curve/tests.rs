//! Where fits of curves start.

use truecut_recording::{ChannelSpec, Unit};
use truecut_scenario::UncertainSpec;
use truecut_scenario::effect::Effect;

use super::*;
use crate::diagnose::Options;
use crate::diagnose::tests::observed;
use crate::model::{Candidate, Columns, CurveCandidate, Model, PredictError};
use crate::testing::Colour;

const SAMPLES: usize = 600;

/// A drive force with friction over the position, that is known or not.
struct Drive {
    channels: Vec<ChannelSpec>,
    least: f64,
}

fn motion(row: usize) -> (f64, f64) {
    let t = row as f64 * 0.02;
    ((1.3 * t).sin(), (1.3 * t).cos())
}

impl Model for Drive {
    fn channels(&self) -> &[ChannelSpec] {
        &self.channels
    }

    fn nominal(&self) -> &[UncertainSpec] {
        &[]
    }

    fn candidates(&self) -> Vec<Candidate> {
        Vec::new()
    }

    fn curves(&self) -> Vec<CurveCandidate> {
        vec![CurveCandidate {
            candidate: Candidate {
                kind: EffectKind::JointFrictionByPosition,
                target: Target::Joint(0),
                rotary: true,
                scale: vec![1.0],
            },
            ends: [-1.0, 1.0],
            least: self.least,
        }]
    }

    fn predict(&self, _: &[f64], effects: &[Effect]) -> Result<Columns, PredictError> {
        let at_row = |row: usize| {
            let (x, v) = motion(row);
            let friction: f64 = effects.iter().map(|one| at(one, x)).sum();
            10.0 * x + friction * v.signum()
        };
        Ok(vec![(0..SAMPLES).map(at_row).collect()])
    }
}

/// A fit of a friction that may have become less starts from less where there is less.
#[test]
fn a_curve_starts_on_the_side_on_which_it_is() {
    for (seed, size) in [(1, 0.9), (2, -0.9), (3, -0.35), (4, 0.1)] {
        let model = Drive {
            channels: vec![ChannelSpec::new(
                "joint1.drive_torque",
                Unit::NewtonMetre,
                "",
            )],
            least: f64::NEG_INFINITY,
        };
        let mut made = model.predict(&[], &[]).unwrap();
        for (row, value) in made[0].iter_mut().enumerate() {
            *value += size * motion(row).1.signum();
        }
        let data = observed(&made, &[0.02], Colour::White, seed, 0.02);
        let options = Options::default();
        let quiet = |_| {};
        let problem = Problem::new(&model, &data, &options, &quiet);
        let curve = problem.curves().start;
        let point = started(&problem, problem.start(), curve, &[0]).unwrap();
        let level = point.effects[0].values[0];
        assert!(level / size > 0.3 && level / size < 3.4, "{size}: {level}");
    }
}

/// Rows of `fast`, from one end of the travel to the other once a second.
fn fast(row: usize, size: f64) -> f64 {
    size * (0.12 * row as f64).sin()
}

/// A joint whose motion becomes smaller after so many rows; a torque may follow its position.
struct Stopped {
    channels: Vec<ChannelSpec>,
    large_until: usize,
}

impl Stopped {
    fn position(&self, row: usize) -> f64 {
        fast(row, if row < self.large_until { 1.0 } else { 0.75 })
    }
}

impl Model for Stopped {
    fn channels(&self) -> &[ChannelSpec] {
        &self.channels
    }

    fn nominal(&self) -> &[UncertainSpec] {
        &[]
    }

    fn candidates(&self) -> Vec<Candidate> {
        Vec::new()
    }

    fn curves(&self) -> Vec<CurveCandidate> {
        vec![CurveCandidate {
            candidate: Candidate {
                kind: EffectKind::JointPositionCurve,
                target: Target::Joint(0),
                rotary: true,
                scale: vec![1.0],
            },
            ends: [-1.0, 1.0],
            least: f64::NEG_INFINITY,
        }]
    }

    fn predict(&self, _: &[f64], effects: &[Effect]) -> Result<Columns, PredictError> {
        let at_row = |row: usize| {
            let x = self.position(row);
            10.0 * x + effects.iter().map(|one| at(one, x)).sum::<f64>()
        };
        Ok(vec![(0..SAMPLES).map(at_row).collect()])
    }
}

/// An elastic stop from 0.8 of the travel on: what blocks that choose and the last part say of it,
/// if the motion comes there until one row, and the stop is there until another.
fn said_of_a_stop(large_until: usize, there_until: usize, seed: u64) -> [Option<bool>; 2] {
    let torque = ChannelSpec::new("joint1.drive_torque", Unit::NewtonMetre, "");
    let model = Stopped {
        channels: vec![torque],
        large_until,
    };
    let mut made = model.predict(&[], &[]).unwrap();
    for (row, value) in made[0].iter_mut().enumerate().take(there_until) {
        *value += 15.0 * (model.position(row) - 0.8).max(0.0);
    }
    let data = observed(&made, &[0.02], Colour::White, seed, 0.02);
    let options = Options::default();
    let quiet = |_| {};
    let problem = Problem::new(&model, &data, &options, &quiet);
    let split = &problem.split;
    let parts = [
        [&split.train, &split.validation],
        [&split.development, &split.test],
    ];
    parts.map(|[fitted, others]| {
        let without = fit(&problem, problem.start(), fitted, &[0], false).unwrap();
        let curve = problem.curves().start;
        let start = started(&problem, problem.start(), curve, &[0]).unwrap();
        let with = fit(&problem, start, fitted, &[0], false).unwrap();
        borne_out(&problem, &without.residual, &with, [fitted, others]).unwrap()
    })
}

/// Rows that do not come to a stop say nothing of it, though the curve follows the noise in all of
/// them; rows that do come there bear it out, or speak against it.
#[test]
fn what_does_not_come_to_an_elastic_stop_says_nothing_of_it() {
    for seed in 0..8 {
        let said = |large_until, there_until| said_of_a_stop(large_until, there_until, seed);
        assert_eq!(said(SAMPLES, SAMPLES), [Some(true); 2], "{seed}");
        assert_eq!(said(200, SAMPLES)[0], Some(true), "{seed}");
        assert_ne!(said(200, SAMPLES)[1], Some(false), "{seed}");
        assert!(!said(60, SAMPLES).contains(&Some(false)), "{seed}");
        assert_eq!(said(SAMPLES, 468), [Some(true), Some(false)], "{seed}");
    }
}
