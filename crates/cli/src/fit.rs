//! `truecut fit`: links, rotors and friction of all joints by one least-squares fit.

use truecut::data;
use truecut::outputs::write_file;
use truecut_discrepancy::fit::{self, ChannelFit, FitReport};
use truecut_recording::significant;

use crate::args::FitArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::text::{Align, headed, json, notes, table};

/// Fits, writes `fit.json`, prints what was found.
pub fn fit(arguments: &FitArguments) -> Result<ExitStatus, Failure> {
    let scenario = &arguments.common.load(&arguments.scenario)?;
    let Some(spec) = &scenario.fit else {
        return Err(Failure::with_help(
            format!("{}: there is no [fit] table", scenario.path().display()),
            "add [fit] with the unknowns, e.g. unknowns = [\"viscous\", \"coulomb\", \"offset\"]",
        ));
    };
    let measured = data::measured(scenario, arguments.data.as_deref())?;
    let report = fit::fit(scenario, &measured, spec).map_err(|e| Failure::sim(scenario, e))?;
    let path = arguments.out.join(scenario.stem()).join("fit.json");
    write_file(&path, json(&report)?.as_bytes())?;
    crate::print(&format!(
        "{}\n{}  {}\n",
        scenario.name,
        text(&report),
        path.display()
    ))
}

fn text(report: &FitReport) -> String {
    let four = |value: f64| significant(value, 4);
    let interval = |[low, high]: [f64; 2]| format!("{} to {}", four(low), four(high));
    let mut text = format!(
        "  {}: {} rows a second, each of {} blocks left out in turn\n\n",
        report.source,
        significant(report.rate_hz, 4),
        report.blocks
    );
    let rows = report.parameters.iter().map(|one| {
        vec![
            if one.seen {
                four(one.value)
            } else {
                "–".to_owned()
            },
            one.interval
                .map_or_else(|| "not seen in these data".to_owned(), interval),
            one.unit.clone(),
            four(one.nominal),
            one.name.clone(),
        ]
    });
    let head = ["found", "95 % interval", "unit", "scenario's", ""];
    use Align::{Left, Right};
    let aligns = [Right, Left, Left, Right, Left];
    text += &table(&aligns, &headed(&head, rows));
    for one in &report.combinations {
        text += &format!(
            "  not separable (correlation {}): {} = {}, {}\n",
            significant(one.correlation, 3),
            one.name,
            four(one.value),
            interval(one.interval)
        );
    }
    let head = [
        "drive force, rms",
        "measured",
        "scenario leaves",
        "fit leaves",
        "on blocks left out",
        "unit",
        "at rest",
        "within dry friction",
    ];
    text += "\n";
    let aligns = [Left, Right, Right, Right, Right, Left, Right, Right];
    text += &table(&aligns, &headed(&head, report.channels.iter().map(channel)));
    for warning in &report.warnings {
        text += &format!("  doubtful: {warning}\n");
    }
    text + &notes(&report.notes)
}

fn channel(one: &ChannelFit) -> Vec<String> {
    let three = |value: f64| significant(value, 3);
    let within = match one.standing {
        0 => "–".to_owned(),
        _ => format!("{:.0} %", 100.0 * one.standing_within_friction),
    };
    vec![
        one.channel.clone(),
        three(one.measured),
        three(one.nominal),
        three(one.fitted),
        three(one.held_out),
        one.unit.clone(),
        one.standing.to_string(),
        within,
    ]
}
