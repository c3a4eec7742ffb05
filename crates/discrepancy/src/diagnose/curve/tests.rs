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
