//! What is in a file of measured data, and the table of a scenario that would read it.

mod robots;

use std::path::Path;

use truecut_discrepancy::spikes;
use truecut_recording::UserUnit;
use truecut_recording::measured::{ColumnFacts, TableFacts, TimeFacts, facts};
use truecut_telemetry::{FileError, read_tables};

/// A file of measured data as it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspected {
    /// One table; one a topic of a log.
    pub tables: Vec<InspectedTable>,
    /// Topics that cannot be read: name and reason.
    pub unread: Vec<(String, String)>,
    /// Tables `[data]` and `[[data.channel]]` that a scenario takes as they are. What the file does
    /// not say is guessed, and marked so by comments.
    pub suggested: String,
}

/// A table as it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectedTable {
    /// Its times and columns.
    pub facts: TableFacts,
    /// Spikes of each column: samples that stand alone, far off their neighbours.
    pub spikes: Vec<usize>,
}

/// Looks at a file of measured data: `.csv` and its like, `.parquet`, `.arrow` or `.mcap`.
///
/// # Errors
/// A file that cannot be read.
pub fn inspect(path: &Path, header: bool) -> Result<Inspected, FileError> {
    let tables = read_tables(path, header)?;
    let looked_at = tables.tables.iter().map(|table| {
        let mut facts = facts(table);
        robots::say_units(&mut facts);
        let values = |name: &str| table.column(name).unwrap_or_default();
        let spikes = facts
            .columns
            .iter()
            .map(|one| spikes::count(values(&one.name)));
        let spikes = spikes.collect();
        InspectedTable { facts, spikes }
    });
    let found: Vec<InspectedTable> = looked_at.collect();
    Ok(Inspected {
        suggested: suggested(path, header, &found),
        tables: found,
        unread: tables.unread,
    })
}

fn suggested(path: &Path, header: bool, tables: &[InspectedTable]) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!("[data]\nfile = {}\n", quoted(&name));
    if !header {
        text.push_str("header = false\n");
    }
    text.push_str(&time(tables));
    let mut taken: Vec<String> = Vec::new();
    for one in tables.iter().flat_map(|table| &table.facts.columns) {
        if one.is_constant() || one.range.is_none() || one.name.contains("covariance") {
            continue;
        }
        text.push_str(&channel(one, &mut taken));
    }
    text
}

/// The keys of the times. Topics of a log have the same clocks, unless one has no header.
fn time(tables: &[InspectedTable]) -> String {
    let times = tables.iter().filter_map(|table| table.facts.time.as_ref());
    let mut times: Vec<&TimeFacts> = times.collect();
    // The clock that all have, in a log where some have no stamps.
    times.sort_by_key(|time| time.base.0 != "log_time");
    let Some(TimeFacts { base, guessed, .. }) = times.first() else {
        return "rate_hz = 1000.0 # not in the file: give its rate\n".to_owned();
    };
    let (name, unit) = base;
    let unit = match (unit.symbol.as_str(), guessed) {
        ("s", None) => String::new(),
        (unit, None) => format!("time_unit = {}\n", quoted(unit)),
        (unit, Some(why)) => {
            format!(
                "time_unit = {} # a guess, {why}: not in the file\n",
                quoted(unit)
            )
        }
    };
    format!("time = {}\n{unit}", quoted(name))
}

fn channel(column: &ColumnFacts, taken: &mut Vec<String>) -> String {
    let known = column.unit.clone();
    let by_file = known.filter(|unit| UserUnit::parse(unit).is_ok());
    let (unit, of_unit) = match &by_file {
        Some(unit) => (unit.clone(), ""),
        None => match unit_by_name(&column.name) {
            Some(unit) => (unit.to_owned(), " # by its name"),
            None => ("1".to_owned(), " # not in the file: give its unit"),
        },
    };
    let guess = match robots::knows(&column.name) {
        true => robots::channel(&column.name),
        false => channel_by_name(&column.name, &unit),
    };
    let guess = guess.filter(|guess| !taken.contains(guess));
    let (name, of_name) = match guess {
        Some(name) => (name, " # by its name"),
        None => (
            free(&plain(&column.name), taken),
            " # give the channel of the simulation",
        ),
    };
    taken.push(name.clone());
    let [low, high] = column.range.unwrap_or_default();
    let ends = match column.at_ends {
        [0, 0] => String::new(),
        _ => format!("# saturation = [{low:?}, {high:?}] # if these are the ends of its range\n"),
    };
    format!(
        "\n[[data.channel]]\ncolumn = {}\nchannel = {}{of_name}\nunit = {}{of_unit}\n{ends}",
        quoted(&column.name),
        quoted(&name),
        quoted(&unit)
    )
}

/// A name that no other channel has.
fn free(name: &str, taken: &[String]) -> String {
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken.contains(name)).unwrap_or_default()
}

/// A column's name with letters, digits, points and underscores alone.
fn plain(name: &str) -> String {
    let one = |letter: char| match letter {
        letter if letter.is_ascii_alphanumeric() || letter == '_' => letter,
        '/' => '.',
        _ => '_',
    };
    let text: String = name.trim_matches('/').chars().map(one).collect();
    match text.is_empty() {
        true => "column".to_owned(),
        false => text,
    }
}

/// Units that names end in, the longest first.
const ENDINGS: [(&str, &str); 18] = [
    ("_rad_s2", "rad/s^2"),
    ("_deg_s2", "deg/s^2"),
    ("_rad_s", "rad/s"),
    ("_deg_s", "deg/s"),
    ("_mm_s", "mm/s"),
    ("_m_s2", "m/s^2"),
    ("_m_s", "m/s"),
    ("_n_m", "N m"),
    ("_rad", "rad"),
    ("_deg", "deg"),
    ("_rpm", "rpm"),
    ("_bar", "bar"),
    ("_kn", "kN"),
    ("_hz", "Hz"),
    ("_mm", "mm"),
    ("_um", "um"),
    ("_n", "N"),
    ("_m", "m"),
];

fn unit_by_name(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    // A joint that turns: nearly all do.
    let of_joints = [
        ("/position/", "rad"),
        ("/velocity/", "rad/s"),
        ("/effort/", "N m"),
    ];
    let of_joint = of_joints.iter().find(|(part, _)| lower.contains(part));
    let ending = ENDINGS.iter().find(|(end, _)| lower.ends_with(end));
    of_joint.or(ending).map(|(_, unit)| *unit)
}

/// The simulation's channel that a column seems to be.
fn channel_by_name(name: &str, unit: &str) -> Option<String> {
    let lower = name.to_lowercase();
    let has = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    let dimension = UserUnit::parse(unit).ok()?.unit.symbol();
    let axis = ["x", "y", "z"].into_iter().find(|axis| {
        [
            format!("/{axis}"),
            format!("_{axis}"),
            format!("_{axis}_{unit}").to_lowercase(),
        ]
        .iter()
        .any(|end| lower.ends_with(end))
    });
    if let Some(axis) = axis {
        return match dimension {
            "N" => Some(format!("tool.force_{axis}")),
            "m" if has(&["position", "tcp", "tool"]) => Some(format!("tool.position_{axis}")),
            _ => None,
        };
    }
    let joint = joint_number(&lower)?;
    let quantity = match dimension {
        "rad" if has(&["command", "cmd", "target", "desired", "setpoint", "soll"]) => "command",
        "rad" => "angle",
        "rad/s" => "velocity",
        "N m" if has(&["drive", "motor", "effort", "actual"]) => "drive_torque",
        "N m" => "transmission_torque",
        _ => return None,
    };
    Some(format!("joint{joint}.{quantity}"))
}

/// The number in a name that has one: `joint_3`, `q3`, `axis3_deg`.
fn joint_number(name: &str) -> Option<u32> {
    let numbers = name.split(|letter: char| !letter.is_ascii_digit());
    let mut numbers = numbers.filter(|number| !number.is_empty());
    let number = numbers.next()?.parse().ok()?;
    ((1..=9).contains(&number) && numbers.next().is_none()).then_some(number)
}

/// A text of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            letter if letter.is_control() => {
                quoted.push_str(&format!("\\u{:04X}", u32::from(letter)));
            }
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;

    /// Names that a text of TOML must escape, columns that are two alike, a stamp in ms.
    #[test]
    fn what_is_suggested_is_read_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mess \u{e4}.csv");
        let names = "time_ms,axis1_deg,\"say \\ \"\"what\"\"\",force_x_n,force,force_y_n";
        let rows = (0..300).map(|k| format!("{},{k},{},{k},{k},7", 2 * k, k % 5));
        let lines: Vec<String> = std::iter::once(names.to_owned()).chain(rows).collect();
        std::fs::write(&path, lines.join("\n")).unwrap();
        let found = inspect(&path, true).unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let text = format!(
            "name = \"x\"\n[process.replay]\nmode = \"observe\"\nspindle_rpm = 60\ndepth_mm = 1\n{}",
            found.suggested
        );
        let scenario = Scenario::from_str(&root.join("x.toml"), &text, &[]);
        let scenario = scenario.unwrap_or_else(|error| panic!("{error:?}\n{text}"));
        let mapping = &scenario.data.as_ref().unwrap().mapping;
        let channels: Vec<(&str, &str, &str)> = (mapping.channels.iter())
            .map(|one| (&*one.terms[0].column, &*one.channel, &*one.unit.symbol))
            .collect();
        assert_eq!(
            channels,
            [
                ("axis1_deg", "joint1.angle", "deg"),
                ("say \\ \"what\"", "say____what_", "1"),
                ("force_x_n", "tool.force_x", "N"),
                ("force", "force", "1"),
            ]
        );
    }
}
