//! Model, data and bookkeeping in one place; points of the search and their parameters.

use truecut_scenario::UncertainSpec;
use truecut_scenario::effect::{Effect, EffectKind, ParameterInfo};

use super::budget::{Budget, Part};
use super::data::{Observation, Rows, Split};
use super::floor::{Floor, floors};
use super::noise::Prior;
use super::{Options, Progress};
use crate::model::{Candidate, Columns, CurveCandidate, Model, PredictError};
use crate::trial::is_place;

pub(super) struct Problem<'a> {
    pub model: &'a dyn Model,
    pub data: &'a Observation,
    pub options: &'a Options,
    /// Those of the search, then curves.
    pub candidates: Vec<Candidate>,
    /// The parameters of those of the search.
    infos: Vec<Vec<ParameterInfo>>,
    /// What is given of each curve.
    curves: Vec<Given>,
    /// Those of them that are looked for at the end.
    pub late: Vec<usize>,
    pub nominal: &'a [UncertainSpec],
    pub split: Split,
    /// Least innovation that noise can have, for each channel: data have finitely many digits.
    pub floor: Vec<f64>,
    /// Of each channel, what it does by itself in the part that is searched.
    pub own_motion: Vec<f64>,
    /// What is known of each channel's noise.
    pub known: Vec<Option<Floor>>,
    pub(super) budget: Budget<'a>,
}

/// An effect with its values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub candidate: usize,
    pub values: Vec<f64>,
    /// Of a curve, the weight of its bending; see [`super::smooth`].
    pub smoothing: f64,
}

/// What a curve is given by, and what is fitted of it.
struct Given {
    ends: [f64; 2],
    /// Of each of its values.
    infos: Vec<ParameterInfo>,
}

/// Values of curves, coarse and fine. How much they tell is a matter of the smoothing, not of their
/// number, as long as there are enough.
pub(super) const PLACES: [usize; 2] = [45, 90];

/// A curve with so many values.
fn of_places(curve: &CurveCandidate, places: usize) -> (Candidate, Given) {
    let mut candidate = curve.candidate.clone();
    let info = candidate.kind.parameters().last();
    let mut info = *info.expect("a curve has values");
    info.min = info.min.max(curve.least);
    let given = Given {
        ends: curve.ends,
        infos: vec![info; places],
    };
    candidate.scale = vec![candidate.scale[0]; places];
    (candidate, given)
}

/// Nominal parameters and effects.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub nominal: Vec<f64>,
    pub effects: Vec<Found>,
}

impl Point {
    /// The kinds of its effects, in their order.
    pub fn candidates(&self) -> Vec<usize> {
        self.effects.iter().map(|found| found.candidate).collect()
    }

    /// The same, sorted.
    pub fn kinds(&self) -> Vec<usize> {
        let mut kinds = self.candidates();
        kinds.sort_unstable();
        kinds
    }

    /// Whether it has the effect.
    pub fn holds(&self, candidate: usize) -> bool {
        (self.effects.iter()).any(|found| found.candidate == candidate)
    }
}

/// A parameter of a point as the optimiser sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Variable {
    pub value: f64,
    /// For finite differences.
    pub step: f64,
    pub min: f64,
    pub max: f64,
    pub prior: Prior,
}

/// Standard deviation of a curve's values before the data are seen, in typical sizes: as large as
/// all that the joint carries. Where the data do not go, a curve is not there.
const OF_A_CURVE: f64 = 10.0;

/// A nominal parameter is refitted within so many standard deviations; a larger change is not due
/// to uncertainty.
const WITHIN_SIGMA: f64 = 3.0;

impl<'a> Problem<'a> {
    pub fn new(
        model: &'a dyn Model,
        data: &'a Observation,
        options: &'a Options,
        progress: &'a (dyn Fn(Progress) + Sync),
    ) -> Problem<'a> {
        let floor = data.outputs.iter().map(|output| {
            let rows = output.values.iter().zip(&output.valid);
            let squares = rows.filter(|(_, valid)| **valid).map(|(y, _)| y * y);
            let rms = (squares.sum::<f64>() / output.values.len() as f64).sqrt();
            (1e-9 * rms).max(1e-150)
        });
        let (curves, given): (Vec<Candidate>, Vec<Given>) = (model.curves().iter())
            .flat_map(|curve| PLACES.map(|places| of_places(curve, places)))
            .unzip();
        let searched = model.candidates();
        let split = Split::new(data);
        Problem {
            model,
            data,
            options,
            infos: searched.iter().map(|one| model.parameters(one)).collect(),
            candidates: [searched, curves].concat(),
            curves: given,
            late: model.late(),
            nominal: model.nominal(),
            own_motion: (split.development.per_channel.iter().enumerate())
                .map(|(c, rows)| data.own_motion(c, rows))
                .collect(),
            split,
            floor: floor.collect(),
            known: floors(data),
            budget: Budget::new(options, progress),
        }
    }

    /// As a part of a larger search.
    pub fn within(mut self, part: Part) -> Problem<'a> {
        self.budget = self.budget.within(part);
        self
    }

    /// A prediction for the samples before the test part: the search sees no others.
    ///
    /// # Errors
    /// The simulation cannot be run.
    pub fn predict(&self, point: &Point) -> Result<Columns, PredictError> {
        self.predict_first(self.split.searched, point)
    }

    /// A prediction that is good at the first samples.
    ///
    /// # Errors
    /// The simulation cannot be run.
    pub fn predict_until(&self, samples: usize, point: &Point) -> Result<Columns, PredictError> {
        self.predict_first(samples.min(self.split.searched), point)
    }

    /// A prediction for all samples.
    ///
    /// # Errors
    /// The simulation cannot be run.
    pub fn predict_whole(&self, point: &Point) -> Result<Columns, PredictError> {
        self.predict_first(self.data.time_s.len(), point)
    }

    /// A prediction that is good at the rows.
    ///
    /// # Errors
    /// The simulation cannot be run.
    pub fn predict_for(&self, rows: &Rows, point: &Point) -> Result<Columns, PredictError> {
        if rows.reach() > self.split.searched {
            self.predict_whole(point)
        } else {
            self.predict(point)
        }
    }

    fn predict_first(&self, samples: usize, point: &Point) -> Result<Columns, PredictError> {
        let effects = self.effects(point);
        self.count_prediction();
        let columns = if samples < self.data.time_s.len() {
            (self.model).predict_first(samples, &point.nominal, &effects)?
        } else {
            self.model.predict(&point.nominal, &effects)?
        };
        self.checked(columns)
    }

    fn checked(&self, columns: Columns) -> Result<Columns, PredictError> {
        let samples = self.data.time_s.len();
        let fits = columns.len() == self.data.outputs.len()
            && columns.iter().all(|column| column.len() == samples);
        if !fits {
            return Err(PredictError(format!(
                "the model must predict {} channels of {samples} samples",
                self.data.outputs.len()
            )));
        }
        match columns.iter().flatten().all(|x| x.is_finite()) {
            true => Ok(columns),
            false => Err(PredictError("the prediction is not finite".into())),
        }
    }

    /// Predicted outputs and known signals but angles, with their names.
    pub fn signals<'b>(
        &'b self,
        predicted: &'b Columns,
    ) -> impl Iterator<Item = (&'b str, &'b Vec<f64>)> {
        let names = self.model.channels().iter().map(|spec| spec.name.as_str());
        let known = self.data.regressors.iter().filter(|r| !r.is_angle);
        (names.zip(predicted)).chain(known.map(|r| (r.name.as_str(), &r.values)))
    }

    /// The effects of a point.
    pub fn effects(&self, point: &Point) -> Vec<Effect> {
        point
            .effects
            .iter()
            .map(|found| self.effect(found))
            .collect()
    }

    /// The candidates that the search looks for.
    pub fn searched(&self) -> std::ops::Range<usize> {
        0..self.candidates.len() - self.curves.len()
    }

    /// The candidates that are lengths of links, where no place of the tool is measured: drives
    /// alone take one for another cause.
    pub fn lengths(&self) -> impl Iterator<Item = usize> {
        let channels = self.model.channels().iter();
        let felt = channels.clone().all(|spec| !is_place(&spec.name));
        (self.searched())
            .filter(move |&one| felt && self.candidates[one].kind == EffectKind::LinkLength)
    }

    /// The candidates that are curves.
    pub fn curves(&self) -> std::ops::Range<usize> {
        self.searched().end..self.candidates.len()
    }

    /// The curve of a point, which is its last effect if there is one, and the first of its
    /// variables.
    pub fn curve<'b>(&self, point: &'b Point) -> Option<(usize, &'b Found)> {
        let (last, others) = point.effects.split_last()?;
        self.given(last.candidate)?;
        let before: usize = others.iter().map(|found| found.values.len()).sum();
        Some((point.nominal.len() + before, last))
    }

    fn given(&self, candidate: usize) -> Option<&Given> {
        let curve = candidate.checked_sub(self.searched().end)?;
        self.curves.get(curve)
    }

    /// The ends of a curve, which are given and not fitted; none of what is no curve.
    fn ends(&self, candidate: usize) -> &[f64] {
        self.given(candidate).map_or(&[], |given| &given.ends)
    }

    pub fn effect(&self, found: &Found) -> Effect {
        let candidate = &self.candidates[found.candidate];
        Effect {
            kind: candidate.kind,
            target: candidate.target.clone(),
            values: [self.ends(found.candidate), &found.values].concat(),
        }
    }

    /// An effect that does nothing yet.
    pub fn neutral(&self, candidate: usize) -> Found {
        let infos = self.infos(candidate).iter();
        Found {
            candidate,
            values: infos.map(|info| info.neutral).collect(),
            smoothing: super::smooth::AT_FIRST,
        }
    }

    /// Its parameters that are fitted.
    pub fn infos(&self, candidate: usize) -> &[ParameterInfo] {
        match self.given(candidate) {
            Some(given) => &given.infos,
            None => &self.infos[candidate],
        }
    }

    pub fn start(&self) -> Point {
        Point {
            nominal: self.nominal.iter().map(|p| p.value).collect(),
            effects: Vec::new(),
        }
    }

    /// The point of effects that are candidates; others are left out.
    pub fn at(&self, nominal: &[f64], effects: &[Effect]) -> Point {
        let found = effects.iter().filter_map(|effect| {
            let given = |i: usize| self.ends(i).len();
            let is_meant = |i: &usize| {
                let one = &self.candidates[*i];
                one.kind == effect.kind
                    && one.target == effect.target
                    && self.infos(*i).len() + given(*i) == effect.values.len()
            };
            let candidate = (0..self.candidates.len()).find(is_meant)?;
            let values = effect.values[given(candidate)..].to_vec();
            Some(Found {
                candidate,
                values,
                smoothing: super::smooth::AT_FIRST,
            })
        });
        Point {
            nominal: nominal.to_vec(),
            effects: found.collect(),
        }
    }

    /// All parameters of a point: nominal ones, then the effects'.
    pub fn variables(&self, point: &Point) -> Vec<Variable> {
        let nominal = self
            .nominal
            .iter()
            .zip(&point.nominal)
            .map(|(p, value)| Variable {
                value: *value,
                step: 0.05 * p.sigma,
                min: p.value - WITHIN_SIGMA * p.sigma,
                max: p.value + WITHIN_SIGMA * p.sigma,
                prior: Prior {
                    offset: value - p.value,
                    precision: 1.0 / p.sigma,
                },
            });
        let effects = point.effects.iter().flat_map(|found| {
            let scales = &self.candidates[found.candidate].scale;
            let is_curve = self.given(found.candidate).is_some();
            let rows = self.infos(found.candidate).iter().zip(scales);
            rows.zip(&found.values)
                .map(move |((info, scale), value)| Variable {
                    value: *value,
                    step: (0.01 * distance(info, *value)).max(1e-4 * scale),
                    min: info.min,
                    max: info.max,
                    prior: match is_curve {
                        false => Prior::default(),
                        true => Prior {
                            offset: value - info.neutral,
                            precision: 1.0 / (OF_A_CURVE * scale),
                        },
                    },
                })
        });
        nominal.chain(effects).collect()
    }

    /// The same point with other parameters.
    pub fn with_values(&self, point: &Point, values: &[f64]) -> Point {
        let (nominal, mut rest) = values.split_at(point.nominal.len());
        let effects = point.effects.iter().map(|found| {
            let (own, others) = rest.split_at(found.values.len());
            rest = others;
            Found {
                values: own.to_vec(),
                ..*found
            }
        });
        Point {
            effects: effects.collect(),
            nominal: nominal.to_vec(),
        }
    }
}

/// How far a size is from doing nothing; for a shape parameter, its magnitude.
fn distance(info: &ParameterInfo, value: f64) -> f64 {
    if info.is_size {
        (value - info.neutral).abs()
    } else {
        value.abs()
    }
}
