//! One least-squares fit of drive forces to measured motion: links, rotors and friction of all
//! joints at once.
//!
//! Drive forces are linear in the unknowns (`gautier1990`). Those that no motion of the arm tells
//! apart are regrouped into base parameters; each joint's equations are weighted by what the fit
//! leaves of them; rows in which a joint stands are not fitted, since friction then gives whatever
//! is asked of it, up to the dry friction. The record is divided into blocks, of which each is left
//! out in turn: that gives the error on data that were not fitted and, as the jackknife of blocks
//! (`kunsch1989`), intervals that hold in coloured noise.

pub(crate) mod base;
pub(crate) mod columns;
mod solve;
mod warnings;

use serde::Serialize;
use truecut_recording::Measured;
use truecut_scenario::{FitSpec, Scenario};
use truecut_sim::{InverseModel, Robots, SimError, estimates};

use self::base::{Base, Group};
use self::columns::{Column, columns};
use self::solve::{Rows, Solution};
use self::warnings::warnings;
use crate::stats::distributions::t_quantile;
use crate::trial::parallel;

/// Result of a fit of drive forces.
#[derive(Debug, Clone, Serialize)]
pub struct FitReport {
    /// The data.
    pub source: String,
    /// Samples kept of each second: twice the cutoff of the filter on drive forces.
    pub rate_hz: f64,
    /// Blocks that were left out in turn.
    pub blocks: usize,
    /// What was found.
    pub parameters: Vec<Parameter>,
    /// Parameters that the data tell apart badly, and what they do tell.
    pub combinations: Vec<Combination>,
    /// Directions of the parameters that the data do not show at all; they are left at the
    /// scenario's values.
    pub undetermined: usize,
    /// Errors by joint.
    pub channels: Vec<ChannelFit>,
    /// What no machine has among the estimates, and what it hints at; one sentence each.
    pub warnings: Vec<String>,
    /// Notes, one sentence each.
    pub notes: Vec<String>,
}

/// A parameter, or several that no motion tells apart.
#[derive(Debug, Clone, Serialize)]
pub struct Parameter {
    /// Its name; of several their sum, with factors.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// What the scenario has.
    pub nominal: f64,
    /// Estimate; what the scenario has where it is not seen.
    pub value: f64,
    /// Ends of its 95 % interval; none where it is not seen.
    pub interval: Option<[f64; 2]>,
    /// Whether the data show it: what no row depends on, or only together with others, has no
    /// estimate.
    pub seen: bool,
}

/// A sum of two parameters that is known better than either.
#[derive(Debug, Clone, Serialize)]
pub struct Combination {
    /// The sum.
    pub name: String,
    /// Correlation of the two estimates.
    pub correlation: f64,
    /// Estimate of the sum.
    pub value: f64,
    /// Ends of its 95 % interval.
    pub interval: [f64; 2],
}

/// Errors of one drive force; root mean squares.
#[derive(Debug, Clone, Serialize)]
pub struct ChannelFit {
    /// The channel.
    pub channel: String,
    /// Unit of all that follows but counts and parts.
    pub unit: String,
    /// Rows fitted: the joint moves.
    pub moving: usize,
    /// Measured drive force there.
    pub measured: f64,
    /// What the scenario's own values leave.
    pub nominal: f64,
    /// What the fit leaves.
    pub fitted: f64,
    /// What fits to the other blocks leave of each block.
    pub held_out: f64,
    /// The same, block by block; null where the joint never moves.
    pub held_out_by_block: Vec<f64>,
    /// Rows in which the joint stands.
    pub standing: usize,
    /// Part of these within the dry friction found, and twice `fitted`.
    pub standing_within_friction: f64,
}

/// Estimates that correlate by more than this are told as not separable.
const NOT_SEPARABLE: f64 = 0.9;
/// And those of one unit of which one is known to no better than this part of itself, if more than
/// half of its variance is the other's.
const VAGUE: f64 = 0.5;
const CONFIDENCE: f64 = 0.95;

/// Fits the unknowns that `[fit]` asks for.
///
/// # Errors
/// As [`InverseModel::new`]; a joint that the chain lacks, or whose drive force is not measured;
/// fewer rows than unknowns.
pub fn fit(
    scenario: &Scenario,
    measured: &Measured,
    spec: &FitSpec,
) -> Result<FitReport, SimError> {
    let model = InverseModel::new(scenario, measured)?;
    let every = parallel::spacing(scenario, measured.rate_hz());
    let columns = columns(scenario, &model, spec, every)?;
    let base = Base::new(scenario, &model, spec)?;
    let rows = Rows::new(&model, spec, &columns, &base, every)?;
    let solution = Solution::new(&rows);
    let mut report = FitReport {
        source: measured.source.clone(),
        rate_hz: measured.rate_hz() / every as f64,
        blocks: spec.blocks,
        parameters: Vec::new(),
        combinations: Vec::new(),
        undetermined: solution.undetermined,
        channels: channels(&model, &rows, &solution),
        warnings: Vec::new(),
        notes: measured.notes.clone(),
    };
    let half = t_quantile(1.0 - CONFIDENCE, (spec.blocks - 1) as f64);
    for (i, group) in base.groups.iter().enumerate() {
        report
            .parameters
            .push(parameter(group, &columns, &solution, i, half));
    }
    report.combinations = combinations(&base, &columns, &report.parameters, &solution, half);
    report.warnings = warnings(&base, &columns, &report.parameters, &solution, half);
    report.notes.extend(estimates(scenario, &Robots::new())?);
    if solution.undetermined > 0 {
        report.notes.push(format!(
            "{} directions of the parameters do not show in these data and stay as the scenario has them",
            solution.undetermined
        ));
    }
    Ok(report)
}

fn parameter(
    group: &Group,
    columns: &[Column],
    solution: &Solution,
    index: usize,
    half: f64,
) -> Parameter {
    let nominal = (group.members.iter())
        .map(|(column, factor)| factor * columns[*column].nominal)
        .sum::<f64>();
    let seen = solution.seen[index];
    let value = nominal + if seen { solution.found[index] } else { 0.0 };
    let reach = half * solution.deviation(|x| x[index]);
    Parameter {
        name: sum_of(
            group
                .members
                .iter()
                .map(|(c, f)| (*f, columns[*c].name.as_str())),
        ),
        unit: columns[group.members[0].0].unit.to_owned(),
        nominal,
        value,
        interval: seen.then_some([value - reach, value + reach]),
        seen,
    }
}

/// Factors and names as a sum; those of parameters that are there in traces only are left out.
pub(crate) fn sum_of<'a>(terms: impl Iterator<Item = (f64, &'a str)>) -> String {
    let mut text = String::new();
    for (factor, name) in terms {
        let sign = match (text.is_empty(), factor < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = truecut_recording::short_number(factor.abs());
        let size = if size == "1" {
            String::new()
        } else {
            format!("{size} ")
        };
        text += &format!("{sign}{size}{name}");
    }
    text
}

/// Of pairs of parameters that correlate much the sum that is known best.
fn combinations(
    base: &Base,
    columns: &[Column],
    parameters: &[Parameter],
    solution: &Solution,
    half: f64,
) -> Vec<Combination> {
    let mut found = Vec::new();
    for j in 0..parameters.len() {
        for i in 0..j {
            let correlation = solution.correlation(i, j);
            let vague = |one: &Parameter| {
                let reach = one.interval.map_or(0.0, |[_, high]| high - one.value);
                reach > VAGUE * one.value.abs()
            };
            let (one, other) = (&parameters[i], &parameters[j]);
            let exchanged = one.unit == other.unit
                && correlation * correlation > 0.5
                && (vague(one) || vague(other));
            let is_told = correlation.abs() >= NOT_SEPARABLE || exchanged;
            if !(is_told && one.seen && other.seen) {
                continue;
            }
            let factor = solution.regression(i, j);
            let first = |k: usize| columns[base.groups[k].members[0].0].name.as_str();
            let value = parameters[i].value + factor * parameters[j].value;
            let reach = half * solution.deviation(|x| x[i] + factor * x[j]);
            found.push(Combination {
                name: sum_of([(1.0, first(i)), (factor, first(j))].into_iter()),
                correlation,
                value,
                interval: [value - reach, value + reach],
            });
        }
    }
    found
}

fn channels(model: &InverseModel, rows: &Rows, solution: &Solution) -> Vec<ChannelFit> {
    let specs = model.channels().iter().enumerate();
    specs
        .map(|(c, spec)| {
            let zero = &solution.found * 0.0;
            let (held_out, held_out_by_block) = rows.held_out(c, &solution.without);
            let fitted = rows.rms(c, &solution.found);
            let (standing, within) = rows.standing(c, &solution.found, 2.0 * fitted);
            ChannelFit {
                channel: spec.name.clone(),
                unit: spec.unit.to_string(),
                moving: rows.count(c),
                measured: rows.measured_rms(c),
                nominal: rows.rms(c, &zero),
                fitted,
                held_out,
                held_out_by_block,
                standing,
                standing_within_friction: crate::stats::ratio(within as f64, standing as f64),
            }
        })
        .collect()
}
