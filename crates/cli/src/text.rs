//! Numbers and tables as printed.

use std::fmt::Display;
use std::path::{Path, PathBuf};

pub use comfy_table::CellAlignment as Align;
use comfy_table::presets;
use serde::Serialize;
use truecut_recording::{ClaimResult, Outcome, Scalar, Unit, UserUnit, significant};
use truecut_sim::sweep::{Fault, SweepTable};

use crate::failure::Failure;

/// The customary unit of a quantity of this size.
pub fn reading_unit(unit: Unit, size: f64) -> UserUnit {
    let size = size.abs();
    let symbol = match unit {
        Unit::Metre if size >= 1.0 => "m",
        Unit::Metre if size >= 1e-4 || size == 0.0 => "mm",
        Unit::Metre if size >= 1e-7 => "µm",
        Unit::Metre => "nm",
        Unit::SquareMetre => "mm^2",
        Unit::CubicMetre => "mm^3",
        Unit::MetrePerSecond if size < 1.0 => "mm/s",
        Unit::Pascal => "MPa",
        Unit::Radian => "deg",
        Unit::Second if size < 0.1 && size > 0.0 => "ms",
        Unit::NewtonPerMetre => "N/µm",
        _ => unit.symbol(),
    };
    UserUnit::parse(symbol).unwrap_or_else(|_| UserUnit::from(unit))
}

/// A value in its customary unit.
pub fn show(unit: Unit, value: f64) -> String {
    if value.is_nan() {
        return "none".to_owned();
    }
    reading_unit(unit, value).show(value)
}

/// The scalars of a run, one per line.
pub fn scalars(scalars: &[Scalar]) -> String {
    let of = |one: &Scalar| row(&one.name, show(one.unit, one.value), &*one.description);
    let rows: Vec<Vec<String>> = scalars.iter().map(of).collect();
    table(&[Align::Left, Align::Right, Align::Left], &rows)
}

/// The scalars of the process; those of the plant are summed up in one line.
pub fn headline(all: &[Scalar]) -> String {
    let of_plant = |one: &&Scalar| one.name.starts_with("plant.") || one.name.starts_with("run.");
    let results: Vec<Scalar> = all.iter().filter(|one| !of_plant(one)).cloned().collect();
    let modes: Vec<String> = all
        .iter()
        .filter(|one| one.name.starts_with("plant.mode") && one.unit == Unit::Hertz)
        .map(|one| significant(one.value, 4))
        .collect();
    let mut text = scalars(&results);
    if !modes.is_empty() {
        text.push_str(&format!(
            "  natural frequencies of the free arm: {} Hz\n",
            modes.join(", ")
        ));
    }
    if let Some(use_max) = all.iter().find(|one| one.name == "plant.torque_use_max") {
        let shown = significant(use_max.value, 3);
        let what = use_max.description.split_once(": ");
        let what = what.map_or("", |(_, what)| what);
        text.push_str(&if use_max.value > 1.0 {
            format!(
                "  ✗ DRIVE OVERLOADED: {shown} times what a drive can give is asked for ({what}); \
                 the real arm would not hold\n"
            )
        } else {
            format!("  largest drive torque: {shown} of its limit ({what})\n")
        });
    }
    if let Some(saturated) = all.iter().find(|one| one.name == "plant.torque_saturated") {
        let what = saturated.description.split_once(": ");
        text.push_str(&format!(
            "  ! SERVO SATURATED for {} ({}): it gives all that it can, and the arm does not follow\n",
            seconds(saturated.value),
            what.map_or("", |(_, what)| what)
        ));
    }
    text.push_str(&belt_faults(all));
    text
}

/// Warnings on a belt beyond the validity of its law.
fn belt_faults(all: &[Scalar]) -> String {
    let value = |name: &str| (all.iter().find(|one| one.name == name)).map_or(0.0, |one| one.value);
    let (pressed_in, stopped) = (
        value("belt.largest_indentation"),
        value("belt.carrier_at_stop"),
    );
    let mut text = String::new();
    if pressed_in >= 1.0 {
        text.push_str(&format!(
            "  ✗ HUB ON THE FACE: the wheel is pressed in by {} times the thickness of its \
             rubber, as if there were more of it\n",
            significant(pressed_in, 3)
        ));
    }
    if stopped >= LEAST_STOPPED {
        text.push_str(&format!(
            "  ✗ CARRIER AT ITS STOP for {} % of the time on the face: there the force is not the \
             one asked for\n",
            significant(100.0 * stopped, 2)
        ));
    }
    text
}

/// Fraction of the time on the face that a carrier may need to leave its stop at touch-down.
const LEAST_STOPPED: f64 = 0.05;

/// How many rows a sweep has, and in how many of them a run did not end well, and how.
pub fn count_rows(table: &SweepTable) -> String {
    let ends: Vec<&str> = table.faults.iter().flatten().map(ended).collect();
    let mut text = format!("{} rows", table.rows.len());
    for (end, how) in [
        (DIVERGED, DIVERGED),
        (CHATTER, "ended in chatter"),
        (OVERLOADED, OVERLOADED),
        (PLACEHOLDERS, "on placeholders"),
        (BEYOND_MODEL, BEYOND_MODEL),
    ] {
        let count = ends.iter().filter(|found| **found == end).count();
        if count > 0 {
            text += &format!(", ✗ {count} {how}");
        }
    }
    text
}

const DIVERGED: &str = "diverged";
const CHATTER: &str = "chatter";
const OVERLOADED: &str = "overloaded";
const PLACEHOLDERS: &str = "placeholders";
const BEYOND_MODEL: &str = "beyond the model";

/// How the run of a row ended, in a word.
pub fn ended(fault: &Fault) -> &'static str {
    match &fault.outcome {
        Outcome::Chatter { .. } => CHATTER,
        Outcome::Overloaded { .. } => OVERLOADED,
        Outcome::Placeholders { .. } => PLACEHOLDERS,
        Outcome::BeyondModel { .. } => BEYOND_MODEL,
        Outcome::Completed | Outcome::Interrupted | Outcome::Diverged { .. } => DIVERGED,
    }
}

/// The claims, one per line: whether it holds, its value and bounds, and why it must hold.
pub fn claims(claims: &[ClaimResult]) -> String {
    let rows: Vec<Vec<String>> = claims
        .iter()
        .map(|claim| {
            let mark = if claim.holds { "✓" } else { "✗" };
            let name = format!("{mark} {}", claim.name);
            row(&name, with_note(claim), &*claim.reason)
        })
        .collect();
    table(&[Align::Left; 3], &rows)
}

/// What a claim found and must be, with its note.
pub fn with_note(claim: &ClaimResult) -> String {
    match &claim.note {
        Some(note) => format!("{} ({note})", claim.shown),
        None => claim.shown.clone(),
    }
}

/// Outcome of a run as a phrase; names what diverged.
pub fn outcome(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Completed => "completed".to_owned(),
        other => format!("✗ {other}"),
    }
}

/// A duration with three digits.
pub fn seconds(value: f64) -> String {
    format!("{} s", significant(value, 3))
}

/// The file to look at first, and those written with it.
pub fn written(first: &Path, rest: &[PathBuf]) -> String {
    let names = rest.iter().filter_map(|path| path.file_name());
    let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
    format!(
        "  {}   (beside it: {})\n",
        first.display(),
        names.join(", ")
    )
}

/// A row of a name, a value and what it is.
pub fn row(name: &str, value: String, what: impl Into<String>) -> Vec<String> {
    vec![name.to_owned(), value, what.into()]
}

/// The row of the joint that is closest to its speed limit on a line.
pub fn fastest_joint(share: f64, joint: &str, point: usize) -> Vec<String> {
    let what =
        format!("of its limit: the fastest joint on a line, \"{joint}\" at path point {point}");
    row("joint speed", significant(share, 3), what)
}

/// Rows below their headings.
pub fn headed(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Vec<Vec<String>> {
    let head = head.iter().map(|&heading| heading.to_owned()).collect();
    std::iter::once(head).chain(rows).collect()
}

/// Lines with aligned columns, indented by two.
pub fn table(aligns: &[Align], rows: &[Vec<String>]) -> String {
    let mut table = comfy_table::Table::new();
    table.load_preset(presets::NOTHING).add_rows(rows);
    for (column, align) in table.column_iter_mut().zip(aligns) {
        column.set_cell_alignment(*align);
        column.set_padding((2, 0));
    }
    table
        .lines()
        .map(|line| format!("{}\n", line.trim_end()))
        .collect()
}

/// Notes, one a line.
pub fn notes<T: Display>(notes: impl IntoIterator<Item = T>) -> String {
    (notes.into_iter())
        .map(|note| format!("  note: {note}\n"))
        .collect()
}

/// A report as JSON, indented, with a line end.
pub fn json(report: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(report)
        .map(|json| format!("{json}\n"))
        .map_err(|error| Failure::message(format!("cannot write the report: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_in_the_unit_of_their_size() {
        assert_eq!(show(Unit::Metre, 1.9e-5), "19.00 µm");
        assert_eq!(show(Unit::Metre, 9.999e-4), "0.9999 mm");
        assert_eq!(show(Unit::Metre, 8e-8), "80.00 nm");
        assert_eq!(show(Unit::Metre, 0.0), "0 mm");
        assert_eq!(show(Unit::Pascal, 4.5e5), "0.4500 MPa");
        assert_eq!(show(Unit::Metre, f64::NAN), "none");
        assert_eq!(show(Unit::Hertz, 5.0), "5.000 Hz");
    }

    #[test]
    fn a_hub_on_the_face_and_a_carrier_at_its_stop_are_told() {
        let hints = |pressed_in, stopped| {
            let scalar = |name: &str, value| Scalar::new(name, Unit::One, value, "what it is");
            belt_faults(&[
                scalar("belt.largest_indentation", pressed_in),
                scalar("belt.carrier_at_stop", stopped),
            ])
        };
        assert_eq!(hints(0.99, 0.049), "");
        assert!(
            hints(1.36, 0.0).contains("HUB ON THE FACE: the wheel is pressed in by 1.36 times")
        );
        assert!(hints(0.2, 0.31).contains("CARRIER AT ITS STOP for 31 % of the time"));
        assert_eq!(belt_faults(&[]), "");
    }

    #[test]
    fn the_headline_names_results_and_sums_up_the_plant() {
        let scalar = |name: &str, unit, value| Scalar::new(name, unit, value, "what it is");
        let text = headline(&[
            scalar("run.time_step", Unit::Second, 2e-4),
            scalar("plant.mode1_frequency", Unit::Hertz, 6.672),
            scalar("plant.mode2_frequency", Unit::Hertz, 11.03),
            scalar("chamfer.width_spread", Unit::Metre, 1.9e-5),
            Scalar::new(
                "plant.torque_use_max",
                Unit::One,
                1.25,
                "Over its limit: joint `a`",
            ),
        ]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "  chamfer.width_spread  19.00 µm  what it is");
        assert_eq!(
            lines[1],
            "  natural frequencies of the free arm: 6.672, 11.03 Hz"
        );
        assert!(lines[2].starts_with("  ✗ DRIVE OVERLOADED: 1.25 times"));
        assert!(lines[2].contains("(joint `a`)"));
        assert_eq!(lines.len(), 3);
    }

    #[test]
    fn columns_line_up_also_with_wide_letters() {
        let rows = vec![
            vec!["µ".to_owned(), "1".to_owned()],
            vec!["abc".to_owned(), "22".to_owned()],
        ];
        assert_eq!(
            table(&[Align::Left, Align::Right], &rows),
            "  µ     1\n  abc  22\n"
        );
    }
}
