//! By what a motion is judged, the search for the best one, and what is expected of it.

use rayon::prelude::*;
use truecut_plan::motion::excitation::{SampledMotion, SeriesForm, SeriesSpace};
use truecut_recording::ChannelSpec;
use truecut_scenario::{Criterion, Scenario};
use truecut_sim::SimError;

use super::information::Information;
use super::limits::Limits;
use super::model::{Jacobian, Kind, Model};
use super::parameters::Parameters;
use super::report::{AssumedNoise, Condition, ExciteReport, ExpectedError};
use super::unknowns::refused;
use super::{Excitation, Random, Request, search, separation};
use crate::stats::rms;

/// Samples of a period of the highest harmonic with which the search looks at a motion.
const SAMPLES_A_WAVE: usize = 14;
/// Motions that the search tries, by inverse dynamics and by runs.
const EVALUATIONS: [usize; 2] = [8000, 200];
/// What is added to the cost of a motion that the drives cannot hold, for each time their limit.
const BEYOND_DRIVES: f64 = 1e3;

/// Everything by which a motion is judged.
pub(super) struct Design<'a> {
    scenario: &'a Scenario,
    limits: &'a Limits,
    model: Model,
    parameters: Parameters,
    /// Of a sample of each output.
    noise: Vec<f64>,
    /// Information of the random motions.
    random: Vec<Information>,
    /// Standard errors in random motions.
    units: Vec<f64>,
    rough: Rough,
}

/// A motion as the search looks at it.
struct Rough {
    space: SeriesSpace,
    times_s: Vec<f64>,
    /// Information of all rows over that of the search's.
    factor: f64,
}

impl Design<'_> {
    /// Looks at the random motions, and what they leave to be known.
    ///
    /// # Errors
    /// A parameter that no motion shows; a motion too short.
    pub fn new<'a>(
        scenario: &'a Scenario,
        limits: &'a Limits,
        model: Model,
        form: SeriesForm,
        random: &[Random],
        time_s: &[f64],
    ) -> Result<Design<'a>, SimError> {
        let parameters = Parameters::new(&model)?;
        let whole: Vec<Jacobian> = (random.par_iter())
            .map(|(_, motion)| model.whole(motion, time_s))
            .collect::<Result<_, _>>()?;
        check_rows(scenario, &whole[0], parameters.leaders.len())?;
        check_shown(&parameters, &whole)?;
        let noise = noise(scenario, &model, &whole)?;
        let random: Vec<Information> = whole
            .iter()
            .map(|one| parameters.information(one, &noise))
            .collect();
        let errors: Vec<Vec<f64>> = (random.iter())
            .map(|one| one.clone().with_prior(&parameters.precisions).errors())
            .collect();
        let units = (0..parameters.leaders.len()).map(|i| median(errors.iter().map(|e| e[i])));
        let times_s = rough_times(&model, form, time_s);
        let rows = |one: &Jacobian| one.counts.iter().flatten().filter(|c| **c).count() as f64;
        let factor = rows(&whole[0]) / (times_s.len() * noise.len()) as f64;
        Ok(Design {
            scenario,
            limits,
            units: units.collect(),
            rough: Rough {
                space: SeriesSpace::new(form, limits.ranges.clone(), &times_s),
                times_s,
                factor: factor / whole[0].noise_share.powi(2),
            },
            model,
            parameters,
            noise,
            random,
        })
    }

    fn cost_of(&self, information: Information) -> f64 {
        information.with_prior(&self.parameters.precisions).cost(
            self.scenario.excite.criterion,
            &self.parameters.asked,
            &self.units,
        )
    }

    /// The numbers of the best motion found, and how many were tried.
    pub fn search(
        &self,
        random: &[Random],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Vec<f64>, usize), SimError> {
        let spec = &self.scenario.excite;
        let own = match self.model.kind {
            Kind::Inverse(_) => EVALUATIONS[0],
            Kind::Forward => EVALUATIONS[1],
        };
        let evaluations = spec.evaluations.unwrap_or(own);
        let cost = |numbers: &[f64]| {
            let series = self.rough.space.series(numbers);
            let (_, motion) = match self.limits.within(&self.rough.space, series) {
                Ok(within) => within,
                Err(effort) => return BEYOND_DRIVES * effort,
            };
            // A motion along which a run fails is none to be made.
            let Ok(jacobian) = self.model.rough(&motion, &self.rough.times_s) else {
                return BEYOND_DRIVES;
            };
            let information = self.parameters.information(&jacobian, &self.noise);
            self.cost_of(information.times(self.rough.factor))
        };
        let costs = self.random.iter().map(|one| self.cost_of(one.clone()));
        let best = costs.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let start = random[best.map_or(0, |(index, _)| index)].0.clone();
        let tell = |tried: usize| progress((tried as f64 / evaluations as f64).min(1.0));
        Ok(search::search(start, spec.seed, evaluations, &cost, &tell))
    }

    /// The motion of these numbers.
    ///
    /// # Errors
    /// Drives that cannot hold the arm; a run that fails.
    pub fn answer(
        &self,
        request: &Request<'_>,
        space: &SeriesSpace,
        (numbers, evaluations): (Vec<f64>, usize),
        time_s: Vec<f64>,
    ) -> Result<Excitation, SimError> {
        let held = |effort: f64| {
            let message = format!(
                "the drives cannot hold the arm along any motion found: {effort:.2} times what they may give"
            );
            SimError::scenario("excite.joint", message)
        };
        let (series, motion) = self
            .limits
            .within(space, space.series(&numbers))
            .map_err(held)?;
        let planned = self.model.whole(&motion, &time_s)?;
        let planned = self.parameters.information(&planned, &self.noise);
        let present = request.present.map(|data| {
            let jacobian = self.model.of_data(data)?;
            Ok::<_, SimError>(self.parameters.information(&jacobian, &self.noise))
        });
        let present = present.transpose()?;
        let expected = self.model.predicted(&motion, &time_s)?;
        let outputs = self.model.noisy_outputs().into_iter().zip(expected);
        Ok(Excitation {
            report: self.report(request, &motion, &planned, present.as_ref(), evaluations)?,
            inputs: self.model.inputs().to_vec(),
            outputs: outputs
                .map(|((spec, noise), values)| (spec, noise, values))
                .collect(),
            rotary: (0..motion.position.len())
                .map(|joint| self.limits.arm.joint(joint).1 == "rad")
                .collect(),
            series,
            time_s,
            motion,
        })
    }

    fn report(
        &self,
        request: &Request<'_>,
        motion: &SampledMotion,
        planned: &Information,
        present: Option<&Information>,
        evaluations: usize,
    ) -> Result<ExciteReport, SimError> {
        let (spec, own) = (&self.scenario.excite, &self.parameters);
        let errors = |one: &Information| one.clone().with_prior(&own.precisions).errors();
        let (expected, now) = (errors(planned), present.map(errors));
        let parameters: Vec<ExpectedError> = (own.asked.iter())
            .map(|&i| ExpectedError {
                name: own.names[i].clone(),
                unit: own.units[i].clone(),
                value: own.values[i],
                planned: expected[i],
                random: self.units[i],
                present: now.as_ref().map(|errors| errors[i]),
            })
            .collect();
        let logs = parameters.iter().map(|one| (one.planned / one.random).ln());
        let condition = |one: &Information| one.condition(&self.units);
        Ok(ExciteReport {
            scenario: self.scenario.name.clone(),
            criterion: match spec.criterion {
                Criterion::D => "d",
                Criterion::E => "e",
            },
            duration_s: spec.duration_s,
            periods: spec.periods,
            harmonics: spec.harmonics,
            evaluations,
            random_motions: self.random.len(),
            mean_ratio: (logs.sum::<f64>() / parameters.len() as f64).exp(),
            parameters,
            condition: Condition {
                planned: condition(planned),
                random: median(self.random.iter().map(condition)),
                present: present.map(condition),
            },
            joints: self.limits.used(motion),
            noise: (self.model.noisy_outputs().into_iter().zip(&self.noise))
                .map(|((spec, stated), noise)| AssumedNoise {
                    channel: spec.name,
                    noise: *noise,
                    unit: spec.unit.to_string(),
                    is_stated: stated.is_some(),
                })
                .collect(),
            separation: request.diagnosis.and_then(|diagnosis| {
                separation::separation(diagnosis, &self.model, own, planned, present)
            }),
        })
    }
}

/// Noise of a sample of each output: as it is stated, or a share of the output along the motions.
///
/// # Errors
/// An output that is nothing along every motion, whose noise nobody states.
fn noise(scenario: &Scenario, model: &Model, whole: &[Jacobian]) -> Result<Vec<f64>, SimError> {
    let of_channel = |(channel, (spec, stated)): (usize, &(ChannelSpec, Option<f64>))| {
        let columns = whole.iter().map(|one| one.outputs[channel].as_slice());
        let assumed = scenario.excite.noise_share * rms(&columns.collect::<Vec<_>>().concat());
        let noise = stated.unwrap_or(assumed);
        if noise > 0.0 {
            return Ok(noise);
        }
        let message = format!(
            "`{}` is 0 along every random motion, so that no noise can be taken as a share of it: give its `noise`",
            spec.name
        );
        Err(SimError::scenario("data", message))
    };
    (model.noisy_outputs().iter().enumerate())
        .map(of_channel)
        .collect()
}

/// Times at which the search looks at a motion: of one period.
fn rough_times(model: &Model, form: SeriesForm, time_s: &[f64]) -> Vec<f64> {
    match model.kind {
        Kind::Inverse(_) => {
            let count = SAMPLES_A_WAVE * form.harmonics;
            let time = |k: usize| form.period_s() * k as f64 / count as f64;
            (0..count).map(time).collect()
        }
        Kind::Forward => {
            let end_s = form.period_s() * (1.0 + 1e-9);
            let of_period = time_s.iter().take_while(|time| **time <= end_s);
            of_period.copied().collect()
        }
    }
}

/// Refuses what is asked for and changes nothing along any of the random motions.
fn check_shown(parameters: &Parameters, whole: &[Jacobian]) -> Result<(), SimError> {
    for &asked in &parameters.asked {
        let mut columns = whole
            .iter()
            .map(|one| &one.columns[parameters.leaders[asked]]);
        if columns.all(|column| column.iter().flatten().all(|value| *value == 0.0)) {
            return Err(refused(format!(
                "is \"{}\", which no motion can show: it changes none of the outputs along {} random ones",
                parameters.names[asked],
                whole.len()
            )));
        }
    }
    Ok(())
}

/// Refuses a motion that leaves too few rows.
fn check_rows(scenario: &Scenario, whole: &Jacobian, parameters: usize) -> Result<(), SimError> {
    let rows = whole
        .counts
        .iter()
        .flatten()
        .filter(|counts| **counts)
        .count();
    if rows > 2 * parameters {
        return Ok(());
    }
    let message = format!(
        "`excite.duration_s` is {} s, which leaves {rows} rows in which a joint moves, but {parameters} unknowns need more than twice as many",
        scenario.excite.duration_s
    );
    Err(SimError::scenario("excite.duration_s", message))
}

/// Their median.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    0.5 * (values[middle] + values[(values.len() - 1) / 2])
}
