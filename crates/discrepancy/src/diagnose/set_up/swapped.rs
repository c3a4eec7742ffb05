//! Columns of two outputs that are each other's.

use crate::diagnose::Observation;
use crate::diagnose::doubts::correlation;
use crate::model::{Columns, Model, SetUp};

/// The set-ups in which two outputs of one unit have each other's columns. Only such are tried as
/// both look more like what the other shows than like what they should.
pub(super) fn set_ups(model: &dyn Model, data: &Observation) -> Vec<SetUp> {
    let channels = model.channels();
    let nominal: Vec<f64> = model.nominal().iter().map(|one| one.value).collect();
    let Ok(simulated) = model.predict(&nominal, &[]) else {
        return Vec::new();
    };
    let shows = |column: usize, channel: usize| shows(data, &simulated, column, channel);
    let is_swapped = |&(a, b): &(usize, usize)| {
        channels[a].unit == channels[b].unit
            && shows(a, b) > shows(a, a).abs()
            && shows(b, a) > shows(b, b).abs()
    };
    let all = 0..channels.len();
    let pairs = all.flat_map(|b| (0..b).map(move |a| (a, b)));
    let pairs: Vec<(usize, usize)> = pairs.filter(is_swapped).collect();
    if pairs.is_empty() {
        return Vec::new();
    }
    let laws: Vec<Columns> = (channels.iter())
        .map(|spec| friction(data, &spec.name))
        .collect();
    let shown = |column: usize, channel: usize| {
        data.outputs[column].fitted(&simulated[channel], &laws[channel])
    };
    let own: Columns = (0..channels.len()).map(|one| shown(one, one)).collect();
    let swapped = pairs.into_iter().map(|(a, b)| {
        let mut predicted = own.clone();
        (predicted[a], predicted[b]) = (shown(a, b), shown(b, a));
        SetUp {
            told: format!(
                "the columns of `{}` and `{}` are swapped (column in their [[data.channel]])",
                channels[a].name, channels[b].name
            ),
            predicted,
        }
    });
    swapped.collect()
}

/// How much alike an output's column and what is simulated for a channel are.
fn shows(data: &Observation, simulated: &Columns, column: usize, channel: usize) -> f64 {
    let output = &data.outputs[column];
    let pairs = output.values.iter().zip(&simulated[channel]);
    let valid = pairs.zip(&output.valid).filter(|(_, valid)| **valid);
    correlation(valid.map(|((measured, simulated), _)| [*measured, *simulated]))
}

/// What the friction of a channel's joint does, in proportion to its speed and by its sign, and a
/// constant; nothing where no rate of the joint is known.
fn friction(data: &Observation, channel: &str) -> Columns {
    let joint = channel.split_once('.').map_or("", |(joint, _)| joint);
    let names = ["angle", "position"].map(|kind| format!("rate of {joint}.{kind}"));
    let mut known = data.regressors.iter();
    let Some(rate) = known.find(|one| names.contains(&one.name)) else {
        return Columns::new();
    };
    let signs = rate.values.iter().map(|rate| rate.signum()).collect();
    vec![rate.values.clone(), signs, vec![1.0; rate.values.len()]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::set_up::doubt;
    use crate::diagnose::tests::observed;
    use crate::diagnose::{Regressor, Verdict, diagnose};
    use crate::model::{Candidate, PredictError};
    use crate::testing::{Colour, noise};
    use truecut_recording::{ChannelSpec, Unit};
    use truecut_scenario::UncertainSpec;
    use truecut_scenario::effect::{Effect, EffectKind, Target};

    const SAMPLES: usize = 1200;

    /// What is simulated, which only a gain of the first column can change.
    struct Known {
        channels: Vec<ChannelSpec>,
        columns: Columns,
    }

    impl Known {
        fn new(units: [Unit; 3], seed: u64) -> Known {
            let names = ["joint1.drive_torque", "joint2.drive_torque", "other"];
            let specs = names.into_iter().zip(units);
            let column = |k: u64| noise(Colour::Ar1(0.9), SAMPLES, 10 * seed + k);
            Known {
                channels: (specs.map(|(name, unit)| ChannelSpec::new(name, unit, ""))).collect(),
                columns: (0..3).map(column).collect(),
            }
        }

        /// The data of these columns in this order, each with a noise of a tenth.
        fn measured(&self, order: [usize; 3], seed: u64) -> Observation {
            let columns = order.map(|k| self.columns[k].clone()).to_vec();
            observed(&columns, &[0.1; 3], Colour::White, 1000 + seed, 0.01)
        }
    }

    impl Model for Known {
        fn channels(&self) -> &[ChannelSpec] {
            &self.channels
        }

        fn nominal(&self) -> &[UncertainSpec] {
            &[]
        }

        fn candidates(&self) -> Vec<Candidate> {
            vec![Candidate {
                kind: EffectKind::SensorGain,
                target: Target::Channel(self.channels[0].name.clone()),
                rotary: false,
                scale: vec![0.1],
            }]
        }

        fn predict(&self, _: &[f64], effects: &[Effect]) -> Result<Columns, PredictError> {
            let mut columns = self.columns.clone();
            for effect in effects {
                columns[0].iter_mut().for_each(|x| *x *= effect.values[0]);
            }
            Ok(columns)
        }
    }

    fn told(model: &Known, data: &Observation) -> Option<String> {
        doubt(model, data, &model.columns)
    }

    #[test]
    fn swapped_columns_are_a_set_up_and_others_are_none() {
        for seed in 0..5 {
            let model = Known::new([Unit::NewtonMetre; 3], seed);
            let found = told(&model, &model.measured([1, 0, 2], seed)).expect("a set-up");
            let words =
                "the columns of `joint1.drive_torque` and `joint2.drive_torque` are swapped";
            assert!(found.contains(words), "{found}");
            // As they are, and passed on in a ring, of which no two are each other's.
            assert_eq!(told(&model, &model.measured([0, 1, 2], seed)), None);
            assert_eq!(told(&model, &model.measured([1, 2, 0], seed)), None);
            let units = [Unit::NewtonMetre, Unit::Metre, Unit::NewtonMetre];
            let model = Known::new(units, seed);
            assert_eq!(told(&model, &model.measured([1, 0, 2], seed)), None);
        }
    }

    /// Friction goes with the joint, whichever column shows it.
    #[test]
    fn friction_of_the_joints_does_not_hide_that_columns_are_swapped() {
        let model = Known::new([Unit::NewtonMetre; 3], 1);
        let mut data = model.measured([1, 0, 2], 1);
        for (joint, column) in [(1, 1), (2, 0)] {
            let rate: Vec<f64> = (0..SAMPLES)
                .map(|k| (0.05 * (k * joint) as f64).sin())
                .collect();
            let values = data.outputs[column].values.iter_mut().zip(&rate);
            values.for_each(|(x, rate)| *x += 2.0 * rate + 0.5 * rate.signum());
            let name = format!("rate of joint{joint}.angle");
            data.regressors.push(Regressor::new(name, rate));
        }
        let found = told(&model, &data).expect("a set-up");
        assert!(found.contains("are swapped"), "{found}");
    }

    /// A gain of zero explains a column that shows something else: it is no cause.
    #[test]
    fn no_cause_is_named_where_columns_are_swapped() {
        let model = Known::new([Unit::NewtonMetre; 3], 3);
        let data = model.measured([1, 0, 2], 3);
        match diagnose(&model, &data, &crate::diagnose::Options::default(), &|_| {}) {
            Ok(answer) => {
                let found = answer.diagnosis;
                assert_eq!(found.verdict, Verdict::UnknownCause, "{}", found.reason);
                assert!(found.causes.is_empty(), "{:?}", found.causes);
                assert!(
                    found
                        .set_up
                        .is_some_and(|told| told.contains("are swapped"))
                );
            }
            Err(error) => assert!(error.to_string().contains("are swapped"), "{error}"),
        }
    }
}
