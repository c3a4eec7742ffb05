//! What is to be doubted about named causes: that they cancel one another, or lie at a bound.

use super::answer::{Cause, key_and_unit, target_name};
use super::data::Output;
use super::fit::Fit;
use super::noise::{add_columns, dot};
use super::problem::{Found, Problem};
use crate::model::Columns;
use crate::stats::{centred, deviation, ratio};
use truecut_scenario::effect::{EffectKind, ParameterInfo};

/// Whether a value lies at an end of where it was looked for. What is gone altogether is no such
/// end: no friction, a sensor that is dead.
fn is_at_end(info: &ParameterInfo, value: f64) -> bool {
    (value == info.min || value == info.max) && value != info.neutral && value != 0.0
}

/// A rotor of which less than this part is left is none of a machine.
const LEAST_ROTOR: f64 = 0.1;

/// What is left of a rotor, as a part of it, where that is next to nothing: `of_kind` is bounded by
/// none, `info` by the rotor of the robot's file.
fn rotor_left(of_kind: &ParameterInfo, info: &ParameterInfo, value: f64) -> Option<f64> {
    let is_known = info.min > of_kind.min && info.min < info.neutral;
    let left = (value - info.min) / (info.neutral - info.min);
    (is_known && left < LEAST_ROTOR).then_some(left)
}

/// That next to nothing would be left of a rotor: no cause, as it stands.
fn is_no_rotor(problem: &Problem, found: &Found) -> Option<String> {
    let kind = problem.candidates[found.candidate].kind;
    if kind != EffectKind::JointRotor {
        return None;
    }
    let of_kind = kind.parameters().first()?;
    let (info, value) = (
        problem.infos(found.candidate).first()?,
        found.values.first()?,
    );
    let left = rotor_left(of_kind, info, *value)?;
    Some(format!(
        "{} would leave {} % of the rotor of the robot's file, and no machine has so light a one",
        name(problem, found.candidate),
        truecut_recording::short_number(100.0 * left)
    ))
}

/// Two causes cancel if together they change less than this part of what each does.
const CANCELLING: f64 = 0.25;

/// The first size of an effect that lies at an end of its range, which is no size that was found,
/// or next to one that no machine has.
pub(super) fn at_bound(problem: &Problem, fit: &Fit) -> Option<String> {
    fit.point.effects.iter().find_map(|effect| {
        if let Some(told) = is_no_rotor(problem, effect) {
            return Some(told);
        }
        let infos = problem.infos(effect.candidate);
        let mut sizes = infos.iter().zip(&effect.values).enumerate();
        let (i, (_, value)) =
            sizes.find(|(_, (info, value))| info.is_size && is_at_end(info, **value))?;
        let (key, unit) = key_and_unit(problem, effect.candidate, i);
        Some(format!(
            "`{key}` of {} lies at the end of its range, {} {unit}",
            name(problem, effect.candidate),
            truecut_recording::significant(*value, 3)
        ))
    })
}

/// One sentence for each doubt.
pub(super) fn doubts(problem: &Problem, fit: &Fit) -> Vec<String> {
    let mut position = problem.nominal.len();
    let (mut parts, mut found) = (Vec::new(), Vec::new());
    for effect in &fit.point.effects {
        let infos = problem.infos(effect.candidate);
        let no_rotor = is_no_rotor(problem, effect);
        found.extend(no_rotor.iter().map(|told| {
            format!(
                "{told}: a coordinate or a drive force on a wrong scale takes away as much where the joint accelerates"
            )
        }));
        let mut change: Columns = fit.residual.iter().map(|x| vec![0.0; x.len()]).collect();
        for (i, (info, value)) in infos.iter().zip(&effect.values).enumerate() {
            if let Some(column) = fit.jacobian.get(position + i).filter(|_| info.is_size) {
                add_columns(&mut change, column, value - info.neutral);
            }
            if no_rotor.is_none() && is_at_end(info, *value) {
                let (key, unit) = key_and_unit(problem, effect.candidate, i);
                found.push(format!(
                    "`{key}` of {} lies at the end of its range, {} {unit}: another cause may be behind it",
                    name(problem, effect.candidate),
                    truecut_recording::significant(*value, 3)
                ));
            }
        }
        position += effect.values.len();
        parts.push(change);
    }
    for (i, a) in parts.iter().enumerate() {
        for (j, b) in parts.iter().enumerate().skip(i + 1) {
            let channels = (0..a.len()).filter(|&c| cancel(problem, c, &a[c], &b[c]));
            if let Some(channel) = channels.into_iter().next() {
                let [one, other] = [i, j].map(|k| name(problem, fit.point.effects[k].candidate));
                let channel = &problem.model.channels()[channel].name;
                found.push(format!(
                    "{one} and {other} all but cancel in `{channel}`, and each is larger than what was measured: \
                     their sum is known, not their sizes"
                ));
            }
        }
    }
    found
}

/// A sensor whose gain may be 0 shows nothing of what is simulated for it, by the nominal model.
/// Where another column does, it is named.
pub(super) fn unrelated(problem: &Problem, simulated: &Columns, cause: &Cause) -> Option<String> {
    let gain = cause.parameters.values().next()?;
    let holds_zero = gain.low? <= 0.0 && gain.high? >= 0.0;
    let name = cause.target.as_ref()?;
    if !holds_zero || cause.kind != EffectKind::SensorGain.name() {
        return None;
    }
    let channels = problem.model.channels();
    let channel = channels.iter().position(|spec| spec.name == *name);
    let rows = &problem.split.development.per_channel;
    let shown = channel.and_then(|c| shown_by(c, simulated, &problem.data.outputs, rows));
    let advice = match shown {
        None => "look whether its column is another channel's, swapped, or dead".to_owned(),
        Some(shown) => {
            let other = &channels[shown.other].name;
            let told = format!(
                "the column of `{other}` shows it (correlation {:.2}, its own column {:.2})",
                shown.correlation, shown.own
            );
            match shown.is_swapped {
                true => format!("{told}, and its own shows `{other}`: the two columns are swapped"),
                false => format!("{told}: look whether columns are swapped"),
            }
        }
    };
    Some(format!(
        "`{name}` has nothing to do with what is simulated for it (its gain may be 0): {advice}"
    ))
}

/// From this correlation on, in magnitude, a column shows what is simulated for a channel.
const SHOWS: f64 = 0.95;
/// Below this one it does not.
const SHOWS_NOT: f64 = 0.5;

/// The channel whose column shows what another channel should.
#[derive(Debug, PartialEq)]
struct Shown {
    other: usize,
    correlation: f64,
    /// That of the channel's own column.
    own: f64,
    /// Whether that column shows the other channel.
    is_swapped: bool,
}

/// Looks for the column that shows what is simulated for a channel, whose own column does not.
/// A column that shows its own channel is no other's, however much alike both move.
fn shown_by(
    channel: usize,
    simulated: &Columns,
    outputs: &[Output],
    rows: &[Vec<usize>],
) -> Option<Shown> {
    let shows = |column: usize, channel: usize| {
        let both = rows[channel].iter().copied();
        let both = both.filter(|&t| outputs[column].valid[t]);
        correlation(both.map(|t| [simulated[channel][t], outputs[column].values[t]]))
    };
    let own = shows(channel, channel);
    if own.abs() >= SHOWS_NOT {
        return None;
    }
    let others = (0..outputs.len()).filter(|other| *other != channel);
    let (other, correlation) = others
        .map(|other| (other, shows(other, channel)))
        .filter(|(other, found)| found.abs() > SHOWS && shows(*other, *other).abs() <= SHOWS)
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(Shown {
        other,
        correlation,
        own,
        is_swapped: shows(channel, other).abs() > SHOWS,
    })
}

/// Correlation of pairs; 0 where one of both stands still.
pub(super) fn correlation(pairs: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (a, b): (Vec<f64>, Vec<f64>) = pairs.map(|[a, b]| (a, b)).unzip();
    let (a, b) = (centred(&a), centred(&b));
    ratio(dot(&a, &b), (dot(&a, &a) * dot(&b, &b)).sqrt())
}

/// Whether two changes of a channel are each beyond what it does, and next to nothing together.
fn cancel(problem: &Problem, channel: usize, a: &[f64], b: &[f64]) -> bool {
    let rows = &problem.split.development.per_channel[channel];
    let pick = |x: &[f64]| -> Vec<f64> { rows.iter().map(|&t| x[t]).collect() };
    let (a, b) = (pick(a), pick(b));
    let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + b).collect();
    let size = |x: &[f64]| dot(x, x).sqrt();
    let measured = pick(&problem.data.outputs[channel].values);
    let own = deviation(&measured) * (rows.len() as f64).sqrt();
    size(&sum) < CANCELLING * size(&a).min(size(&b)) && size(&a).min(size(&b)) > own
}

fn name(problem: &Problem, candidate: usize) -> String {
    let candidate = &problem.candidates[candidate];
    match target_name(candidate) {
        Some(target) => format!("{} on {target}", candidate.kind.name()),
        None => candidate.kind.name().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::observed;
    use crate::testing::{Colour, noise};

    const SAMPLES: usize = 1000;

    /// What is found for a channel whose data come from these columns of what is simulated, each
    /// with a noise of a tenth.
    fn found(channel: usize, simulated: &Columns, order: [usize; 3], seed: u64) -> Option<Shown> {
        let measured = order.map(|k| simulated[k].clone()).to_vec();
        let data = observed(&measured, &[0.1; 3], Colour::White, 1000 + seed, 0.01);
        let rows: Vec<Vec<usize>> = vec![(0..SAMPLES).collect(); 3];
        shown_by(channel, simulated, &data.outputs, &rows)
    }

    fn drawn(seed: u64) -> Columns {
        let column = |k: u64| noise(Colour::Ar1(0.9), SAMPLES, 10 * seed + k);
        (0..3).map(column).collect()
    }

    #[test]
    fn a_swapped_column_is_named_with_the_channel_that_has_it() {
        for seed in 0..10 {
            let simulated = drawn(seed);
            for (channel, other) in [(0, 1), (1, 0)] {
                let shown = found(channel, &simulated, [1, 0, 2], seed).expect("a column");
                assert_eq!((shown.other, shown.is_swapped), (other, true), "{shown:?}");
                assert!(shown.correlation > 0.99 && shown.own.abs() < 0.5);
            }
            assert_eq!(found(2, &simulated, [1, 0, 2], seed), None);
            // Passed on in a ring: which column it is is known, but no two are swapped.
            let shown = found(0, &simulated, [1, 2, 0], seed).expect("a column");
            assert_eq!((shown.other, shown.is_swapped), (2, false), "{shown:?}");
        }
    }

    /// A rotor that is all but gone is none; one that is a third of the file's may be, and so may
    /// any of which the file gives nothing.
    #[test]
    fn a_rotor_that_is_all_but_gone_is_doubted() {
        let of_kind = EffectKind::JointRotor.parameters()[0];
        let bounded = |least: f64| ParameterInfo {
            min: least,
            ..of_kind
        };
        let left = |least: f64, value: f64| rotor_left(&of_kind, &bounded(least), value);
        assert_eq!(left(-4.0, -4.0), Some(0.0));
        assert!(left(-4.0, -3.9).is_some_and(|left| (left - 0.025).abs() < 1e-12));
        for (least, value) in [(-4.0, -2.7), (-4.0, 0.3), (0.0, 0.0), (of_kind.min, -1e6)] {
            assert_eq!(left(least, value), None, "{least} {value}");
        }
    }

    /// A column of a channel that moves alike is not taken from it; a dead one has no other.
    #[test]
    fn columns_that_show_their_own_channels_are_no_others() {
        for seed in 0..10 {
            let mut simulated = drawn(seed);
            assert_eq!(found(0, &simulated, [0, 1, 2], seed), None);
            simulated[1] = simulated[0].iter().map(|x| 2.0 * x).collect();
            assert_eq!(found(0, &simulated, [2, 1, 2], seed), None);
            let still = correlation(simulated[0].iter().map(|x| [*x, 7.0]));
            assert_eq!(still, 0.0);
        }
    }
}
