//! The model of two recordings whose effects are changes: what the second has more than the first.

use truecut_recording::ChannelSpec;
use truecut_scenario::UncertainSpec;
use truecut_scenario::effect::{Effect, ParameterInfo};

use super::Between;
use super::split::{bounds, split, twin};
use crate::model::{Candidate, Columns, CurveCandidate, Model, PredictError};
use crate::trial::cache::Cache;
use crate::trial::{Trial, of_kinds};

/// A value that both recordings share is refitted within three of these parts of its size: what the
/// first alone shows by another name may go.
const SHARED_SIGMA: f64 = 0.5;

/// Effects of the search are changes from the first recording to the second. A prediction is the
/// second's less the first's, or that of both, with numbers that they share refitted.
pub(super) struct Change<'a> {
    pair: &'a Between,
    of: Of,
    /// Effects that act in both.
    shared: Vec<Effect>,
    /// The numbers of each recording's scenario, as far as they are not refitted.
    fixed: [Vec<f64>; 2],
    nominal: Vec<UncertainSpec>,
    candidates: Vec<Candidate>,
    /// Predictions of the first recording: few changes reach it.
    first: Cache<FirstKey, Columns>,
}

/// What is predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Of {
    /// The second recording less the first: their motion is the same.
    Difference,
    /// The first, then the second.
    Both,
}

/// What the first recording is predicted for: samples, numbers, effects.
type FirstKey = (usize, Vec<f64>, Vec<Effect>);

impl<'a> Change<'a> {
    /// `own` are the numbers of the first recording's scenario as its diagnosis found them.
    pub fn new(pair: &'a Between, of: Of, own: &[f64], shared: Vec<Effect>) -> Change<'a> {
        let common = pair.uncertain;
        let both = [&pair.first, &pair.second].map(|trial| trial.nominal());
        let mut nominal = Vec::new();
        if of == Of::Both {
            let refitted = both[0].iter().zip(own).map(|(spec, value)| UncertainSpec {
                value: *value,
                ..spec.clone()
            });
            nominal.extend(refitted);
        }
        // Where the second recording begins is its own.
        nominal.extend(both[1][common..].iter().cloned());
        if of == Of::Both {
            nominal.extend(shared.iter().flat_map(|effect| numbers(pair, effect)));
        }
        let second = own[..common].iter().copied();
        let begun = both[1][common..].iter().map(|spec| spec.value);
        Change {
            candidates: [pair.second.candidates(), pair.second.held().to_vec()].concat(),
            fixed: [own.to_vec(), second.chain(begun).collect()],
            pair,
            of,
            shared,
            nominal,
            first: Cache::default(),
        }
    }

    /// Effects that both recordings share.
    pub fn shared(&self) -> &[Effect] {
        &self.shared
    }

    /// Numbers of both recordings' scenarios, and what they share, as they were refitted.
    pub fn settled(&self, nominal: &[f64]) -> ([Vec<f64>; 2], Vec<Effect>) {
        self.unpacked(nominal)
    }

    /// Effects of the first and of the second recording, for changes of what both share.
    pub fn split(&self, shared: &[Effect], changes: &[Effect]) -> [Vec<Effect>; 2] {
        split(shared, &self.pair.second.scenario().effects, changes)
    }

    /// Numbers of both scenarios and what they share, of the numbers that are refitted.
    fn unpacked(&self, nominal: &[f64]) -> ([Vec<f64>; 2], Vec<Effect>) {
        let common = self.pair.uncertain;
        let [mut first, mut second] = self.fixed.clone();
        let begins = second.len() - common;
        if self.of == Of::Difference {
            second[common..].copy_from_slice(&nominal[..begins]);
            return ([first, second], self.shared.clone());
        }
        let (own, rest) = nominal.split_at(first.len());
        let (begun, mut rest) = rest.split_at(begins);
        first.copy_from_slice(own);
        second[..common].copy_from_slice(&own[..common]);
        second[common..].copy_from_slice(begun);
        let mut shared = self.shared.clone();
        for effect in shared.iter_mut().filter(|effect| !effect.kind.is_curve()) {
            let (values, others) = rest.split_at(effect.values.len());
            let infos = effect.kind.parameters().iter();
            for ((own, value), info) in effect.values.iter_mut().zip(values).zip(infos) {
                *own = value.clamp(info.min, info.max);
            }
            rest = others;
        }
        ([first, second], shared)
    }

    fn predicted(
        &self,
        samples: usize,
        nominal: &[f64],
        changes: &[Effect],
    ) -> Result<Columns, PredictError> {
        let ([own, later], shared) = self.unpacked(nominal);
        let held = &self.pair.second.scenario().effects;
        let [before, after] = split(&shared, held, changes);
        let overlap = self.pair.overlap;
        let rows = self.pair.first.observation.time_s.len();
        let [of_first, of_second] = match self.of {
            Of::Difference => [overlap.first + samples, overlap.second + samples],
            Of::Both => [samples.min(rows), samples.saturating_sub(rows)],
        };
        let key = (of_first, own.clone(), before.clone());
        let made = || of_trial(&self.pair.first, of_first, &own, &before);
        let first = self.first.get(key, made)?;
        let second = match of_second {
            0 => {
                let count = self.pair.second.observation.time_s.len();
                vec![vec![0.0; count]; first.len()]
            }
            _ => of_trial(&self.pair.second, of_second, &later, &after)?,
        };
        let pairs = first.iter().zip(&second);
        Ok(match self.of {
            Of::Difference => pairs
                .map(|(a, b)| {
                    let a = &a[overlap.first..overlap.first + overlap.count];
                    let b = &b[overlap.second..overlap.second + overlap.count];
                    b.iter().zip(a).map(|(b, a)| b - a).collect()
                })
                .collect(),
            Of::Both => pairs.map(|(a, b)| [a.as_slice(), b].concat()).collect(),
        })
    }
}

impl Model for Change<'_> {
    fn channels(&self) -> &[ChannelSpec] {
        self.pair.second.channels()
    }

    fn nominal(&self) -> &[UncertainSpec] {
        &self.nominal
    }

    fn candidates(&self) -> Vec<Candidate> {
        self.candidates.clone()
    }

    /// A change may go either way.
    fn parameters(&self, candidate: &Candidate) -> Vec<ParameterInfo> {
        let held = &self.pair.second.scenario().effects;
        bounds(
            self.pair.second.parameters(candidate),
            twin(&self.shared, held, candidate.kind, &candidate.target),
        )
    }

    fn curves(&self) -> Vec<CurveCandidate> {
        let mut curves = self.pair.second.curves();
        curves.retain(|curve| {
            let one = &curve.candidate;
            twin(&self.shared, &[], one.kind, &one.target).is_none()
        });
        // A friction may have become less.
        curves
            .iter_mut()
            .for_each(|curve| curve.least = f64::NEG_INFINITY);
        curves
    }

    /// Those that the scenario holds, too.
    fn additive(&self) -> Vec<usize> {
        of_kinds(&self.candidates, |kind| self.pair.second.adds_up(kind))
    }

    fn late(&self) -> Vec<usize> {
        of_kinds(&self.candidates, |kind| self.pair.second.comes_late(kind))
    }

    fn sizes_by_mode(&self, candidate: &Candidate, step_hz: f64) -> Vec<f64> {
        self.pair.second.sizes_by_mode(candidate, step_hz)
    }

    fn slowest_mode_hz(&self) -> Option<f64> {
        self.pair.second.slowest_mode_hz()
    }

    fn predict(&self, nominal: &[f64], effects: &[Effect]) -> Result<Columns, PredictError> {
        self.predicted(self.pair.observation.time_s.len(), nominal, effects)
    }

    fn predict_first(
        &self,
        samples: usize,
        nominal: &[f64],
        effects: &[Effect],
    ) -> Result<Columns, PredictError> {
        self.predicted(samples, nominal, effects)
    }

    fn may_be(&self, effects: &[Effect]) -> bool {
        let [before, after] = self.split(&self.shared, effects);
        self.pair.first.may_be(&before) && self.pair.second.may_be(&after)
    }

    /// Where nothing changed a difference stands still, and that tells something.
    fn is_steady(&self) -> bool {
        true
    }
}

/// A recording's first samples.
fn of_trial(
    trial: &Trial,
    samples: usize,
    nominal: &[f64],
    effects: &[Effect],
) -> Result<Columns, PredictError> {
    match samples >= trial.observation.time_s.len() {
        true => trial.predict(nominal, effects),
        false => trial.predict_first(samples, nominal, effects),
    }
}

/// The name of a shared effect's value among the numbers that are refitted.
pub(super) fn shared_key(effect: &Effect, info: &ParameterInfo) -> String {
    format!("{effect}.{}", info.key)
}

/// The values of a shared effect as numbers to be refitted; a curve stays as it is.
fn numbers(pair: &Between, effect: &Effect) -> Vec<UncertainSpec> {
    if effect.kind.is_curve() {
        return Vec::new();
    }
    let candidates = pair.second.candidates();
    let own = (candidates.iter().chain(pair.second.held()))
        .find(|one| one.kind == effect.kind && one.target == effect.target);
    let infos = effect.kind.parameters().iter().enumerate();
    infos
        .zip(&effect.values)
        .map(|((i, info), value)| {
            let size = match info.is_size {
                true => (value - info.neutral).abs(),
                false => value.abs(),
            };
            let typical = own.map_or(size, |one| one.scale[i]);
            UncertainSpec {
                key: shared_key(effect, info),
                value: *value,
                sigma: (SHARED_SIGMA * size.max(typical)).max(f64::MIN_POSITIVE),
            }
        })
        .collect()
}
