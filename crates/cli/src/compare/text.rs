//! The comparison as text: a table, and one line per finding.

use std::path::PathBuf;

use truecut_discrepancy::compare::{
    Alignment, ChannelComparison, Comparison, Dependence, Estimate, Event, Kind, LEVEL, Level,
    LineKind, SpectralLine,
};
use truecut_recording::{Unit, short_number, significant};

use crate::text::{self, Align, show};

/// Most spectral lines, and most signals, that are printed; the report has all.
const MOST: usize = 3;

pub fn printed(name: &str, comparison: &Comparison, written: &[PathBuf]) -> String {
    let mut text = format!(
        "{name}\n  {} of {}, {} samples a second\n",
        text::seconds(comparison.duration_s),
        comparison.source,
        significant(comparison.rate_hz, 4)
    );
    text.push_str(&text::notes(&comparison.notes));
    text.push_str(&format!("\n{}", table(comparison)));
    for channel in &comparison.channels {
        let findings = findings(channel);
        text.push_str(&format!("\n  {}\n", channel.channel));
        if findings.is_empty() {
            text.push_str(&format!("    {}\n", nothing_found(&channel.level)));
        }
        findings
            .iter()
            .for_each(|finding| text.push_str(&format!("    {finding}\n")));
    }
    if let Some(report) = written.first() {
        text.push_str(&format!(
            "\n  {}   (beside it: report.html, a figure of each channel)\n\n",
            report.display()
        ));
    }
    text
}

/// A residual without a pattern is noise only as far as noise is known.
fn nothing_found(level: &Level) -> String {
    match level.error_over_noise {
        Some(ratio) => format!(
            "no pattern in what is left, which is {} times the noise stated",
            significant(ratio, 3)
        ),
        None => format!(
            "no pattern in what is left, {} % of the signal: how much of it is noise, the data do not say \
             (`noise` of a channel does)",
            significant(100.0 * level.nrmse, 3)
        ),
    }
}

fn table(comparison: &Comparison) -> String {
    let head = [
        "channel",
        "NRMSE",
        "RMS error",
        "bias",
        "delay",
        "gain",
        "independent samples",
    ];
    let rows = comparison.channels.iter().map(|channel| {
        let level = &channel.level;
        let aligned = channel.alignment.as_ref();
        let of = |unit, pick: fn(&Alignment) -> (f64, f64)| {
            // An error that holds for noise alone would be read as if it held.
            let described = aligned.filter(|one| one.pattern_left.is_none());
            described.map_or("–".to_owned(), |alignment| {
                let (value, error) = pick(alignment);
                with_error(unit, value, error)
            })
        };
        vec![
            channel.channel.clone(),
            format!("{} %", significant(100.0 * level.nrmse, 3)),
            show(channel.unit, level.rms_error),
            mean(channel.unit, level),
            of(Unit::Second, |a| {
                (a.delay_s.value, a.delay_s.standard_error)
            }),
            of(Unit::One, |a| (a.gain.value, a.gain.standard_error)),
            format!(
                "{} of {}",
                short_number(level.effective_samples.round()),
                level.samples
            ),
        ]
    });
    let mut aligns = [Align::Right; 7];
    aligns[0] = Align::Left;
    text::table(&aligns, &text::headed(&head, rows))
}

/// `1.23 ± 0.05 mm`: as many decimals as the standard error justifies.
fn with_error(unit: Unit, value: f64, error: f64) -> String {
    let unit = text::reading_unit(unit, value.abs().max(error));
    let (value, error) = (unit.from_si(value), unit.from_si(error));
    let decimals = if error > 0.0 {
        (1.0 - error.log10().floor()).clamp(0.0, 6.0) as usize
    } else {
        3
    };
    let symbol = if unit.symbol == "1" {
        String::new()
    } else {
        format!(" {}", unit.symbol)
    };
    // No minus sign on a value that is rounded to zero.
    let value = if value.abs() < 0.5 * 10_f64.powi(-(decimals as i32)) {
        0.0
    } else {
        value
    };
    format!("{value:.decimals$} ± {error:.decimals$}{symbol}")
}

/// Significant findings, the clearest first.
fn findings(channel: &ChannelComparison) -> Vec<String> {
    // A line far above a low background may still be negligible, unless it is at an order of
    // rotation of the spindle.
    let matters = |line: &&SpectralLine| {
        line.per_revolution.is_some() || line.residual > 0.05 * channel.level.rms_error
    };
    let (listed, rest): (Vec<_>, Vec<_>) = channel.lines.iter().partition(matters);
    let mut found: Vec<String> = channel.event.iter().map(event).collect();
    found.extend((listed.iter().take(MOST)).map(|one| line(channel.unit, one)));
    let more: Vec<f64> = listed
        .iter()
        .skip(MOST)
        .chain(&rest)
        .map(|line| line.residual)
        .collect();
    if !more.is_empty() {
        let largest = show(channel.unit, more.iter().copied().fold(0.0, f64::max));
        found.push(format!("{} more lines, of {largest} and less", more.len()));
    }
    let significant_ones = channel.dependence.iter().filter(|one| one.p_value < LEVEL);
    found.extend(
        significant_ones
            .take(MOST)
            .map(|one| dependence(channel.unit, one)),
    );
    let input = channel.inputs.iter().find(|one| one.p_value < LEVEL);
    found.extend(input.map(|input| {
        format!(
            "follows {} by {}: correlation {} ({})",
            input.signal,
            show(Unit::Second, input.delay_s),
            significant(input.correlation, 2),
            chance(input.p_value)
        )
    }));
    if channel.level.bias.p_value < LEVEL {
        let bias = show(channel.unit, channel.level.bias.value);
        found.push(format!(
            "mean off by {bias} ({})",
            chance(channel.level.bias.p_value)
        ));
    }
    found.extend(channel.alignment.as_ref().and_then(alignment));
    found
}

/// The mean of the residual. An error that is larger than any residual tells nothing but that too
/// few samples are independent.
fn mean(unit: Unit, level: &Level) -> String {
    let Estimate {
        value,
        standard_error,
        ..
    } = level.bias;
    match standard_error > level.largest_error {
        true => format!("{}, ± unknown", show(unit, value)),
        false => with_error(unit, value, standard_error),
    }
}

fn event(found: &Event) -> String {
    format!(
        "{} % of its square lies between {} and {}, {} % of the record ({})",
        significant(100.0 * found.stretch.share, 2),
        text::seconds(found.from_s),
        text::seconds(found.until_s),
        significant(100.0 * found.stretch.part, 2),
        chance(found.stretch.p_value)
    )
}

/// What delay and gain explain, or that they do not describe the difference.
fn alignment(found: &Alignment) -> Option<String> {
    if found.delay_s.p_value.min(found.gain.p_value) >= LEVEL {
        return None;
    }
    if let Some(left) = &found.pattern_left {
        let pattern = match left.kind {
            Some(kind) => format!("what changes with {}", signal_name(kind, &left.signal)),
            None => format!("lines (a {})", left.signal),
        };
        return Some(format!(
            "delay and gain ({}, {}) do not describe the difference: they leave {pattern}, {} % of \
             the variance of both",
            show(Unit::Second, found.delay_s.value),
            significant(found.gain.value, 4),
            significant(100.0 * left.share, 2)
        ));
    }
    let share = significant(100.0 * found.explained_share, 2);
    Some(format!(
        "delay and gain together explain {share} % of the residual's variance"
    ))
}

fn line(unit: Unit, line: &SpectralLine) -> String {
    let place = format!("line at {} Hz", significant(line.frequency_hz, 4));
    let order = match line.per_revolution {
        Some(1) => ", once per revolution".to_owned(),
        Some(multiple) => format!(", {multiple} per revolution"),
        None => String::new(),
    };
    let [measured, simulated] =
        [line.measured, line.simulated].map(|amplitude| show(unit, amplitude));
    match line.kind {
        LineKind::Missing => format!("{place}{order}: {measured} that the simulation lacks"),
        LineKind::Extra => format!("{place}{order}: {simulated} simulated, not measured"),
        LineKind::Differs => format!("{place}{order}: {measured} measured, {simulated} simulated"),
    }
}

/// A signal, as a residual follows it.
fn signal_name(kind: Kind, signal: &str) -> String {
    match kind {
        Kind::Velocity => format!("the sign of {signal}"),
        Kind::SpindlePhase => "the phase of the spindle".to_owned(),
        _ => signal.to_owned(),
    }
}

fn dependence(unit: Unit, found: &Dependence) -> String {
    let with = signal_name(found.kind, &found.signal);
    let means = || found.bins.iter().map(|bin| bin.mean);
    let range = means().fold(f64::NEG_INFINITY, f64::max) - means().fold(f64::INFINITY, f64::min);
    format!(
        "changes with {with}: by {} over its range, {} % of the variance ({})",
        show(unit, range),
        significant(100.0 * found.share, 2),
        chance(found.p_value)
    )
}

fn chance(p: f64) -> String {
    if p < 1e-6 {
        "p < 1e-6".to_owned()
    } else {
        format!("p = {}", significant(p, 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_no_residual_reaches_is_unknown() {
        let told = |standard_error: f64| {
            let bias = Estimate {
                value: -5.0,
                standard_error,
                degrees_of_freedom: 1.0,
                p_value: 0.9,
            };
            let level = Level {
                samples: 4000,
                effective_samples: 1.0,
                rms_error: 30.0,
                nrmse: 0.3,
                relative_rms_error: 0.6,
                bias,
                largest_error: 47.0,
                error_over_noise: None,
            };
            mean(Unit::NewtonMetre, &level)
        };
        assert!(told(1123.0).ends_with("± unknown"), "{}", told(1123.0));
        assert!(told(12.0).contains("± 12"), "{}", told(12.0));
    }
}
