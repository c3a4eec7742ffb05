//! How channels are shown to a person: in which unit, under which name, with which others.
//!
//! Files hold SI. In the viewer a displacement is in µm, a length in mm, an angle in degrees, so
//! that an axis carries plain numbers.

mod templates;

use templates::{DEFLECTION, TEMPLATES, Template};
use truecut_recording::{ChannelSpec, Unit, UserUnit};

/// One curve of a plot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Series {
    /// Column in the recording.
    pub(crate) channel: usize,
    /// In the legend: `Y [µm]`.
    pub(crate) legend: String,
    /// Unit in which it is shown.
    pub(crate) unit: UserUnit,
    /// Red, green, blue.
    pub(crate) color: [u8; 3],
}

/// Where a plot is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// At once, with its spectrum in the first tabs.
    FrontWithSpectrum,
    /// At once.
    Front,
    /// In a tab.
    Behind,
}

/// Curves that share a plot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// Above the plot: `Tool displacement, process frame [µm]`.
    pub(crate) title: String,
    /// Where its curves are logged: `/plots/joint_angle_deg`.
    pub(crate) entity: String,
    pub(crate) place: Place,
    /// What is smaller than this, SI, is as good as nothing.
    pub(crate) least: f64,
    pub(crate) series: Vec<Series>,
}

/// Channels that are states, not curves: shown as coloured bars.
pub(crate) const SLIDING: &str = "foot.sliding";
/// As [`SLIDING`]: 1 while the foot is off the workpiece.
pub(crate) const LIFTED: &str = "foot.lifted";

/// Sorts channels into plots.
pub(crate) fn groups(channels: &[ChannelSpec]) -> Vec<Group> {
    let mut found: Vec<(usize, Group)> = Vec::new();
    for (index, channel) in channels.iter().enumerate() {
        if [SLIDING, LIFTED].contains(&channel.name.as_str()) {
            continue;
        }
        let unit = shown_in(channel);
        let (rank, mut new) = empty_group(&channel.name);
        // The unit is part of the title, so that unlike units never share an axis.
        new.title += &format!(" [{}]", unit.symbol);
        let same = found.iter().position(|(_, group)| group.title == new.title);
        let place = same.unwrap_or_else(|| {
            new.entity = format!("/plots/{}", in_path(&new.title));
            found.push((rank, new));
            found.len() - 1
        });
        let series = &mut found[place].1.series;
        let color = color(&channel.name, series.len());
        let legend = format!("{} [{}]", short_name(&channel.name), unit.symbol);
        series.push(Series {
            channel: index,
            legend,
            unit,
            color,
        });
    }
    found.sort_by_key(|(rank, _)| *rank);
    let mut groups: Vec<Group> = found.into_iter().map(|(_, group)| group).collect();
    if groups
        .iter()
        .any(|group| group.title.starts_with(DEFLECTION))
    {
        let displaced = groups.iter_mut().filter(|group| {
            let channel = |series: &Series| channels[series.channel].name.as_str();
            let mut names = group.series.iter().map(channel);
            names.all(|name| name.starts_with("tool.displacement_"))
        });
        displaced.for_each(|group| group.place = Place::Behind);
    }
    groups
}

/// The plot into which a channel goes, and its rank among all.
fn empty_group(channel: &str) -> (usize, Group) {
    let general = without_joint_number(channel);
    let fits = |template: &Template| template.beginnings.iter().any(|b| general.starts_with(b));
    let rank = TEMPLATES.iter().position(fits).unwrap_or(TEMPLATES.len());
    let (title, place, least) = match TEMPLATES.get(rank) {
        Some(template) => (template.title.to_owned(), template.place, template.least),
        None => (in_words(stem(&general)), Place::Behind, 0.0),
    };
    (
        rank,
        Group {
            title,
            entity: String::new(),
            place,
            least,
            series: Vec::new(),
        },
    )
}

/// Letters and digits, joined by single lines.
fn in_path(title: &str) -> String {
    let words = title.split(|letter: char| !letter.is_alphanumeric());
    words
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join("_")
        .to_lowercase()
}

/// The unit in which a person expects a channel.
pub(crate) fn shown_in(channel: &ChannelSpec) -> UserUnit {
    let small = ["displacement", "indentation", "deflection", "wall_error"];
    let small = small.iter().any(|word| channel.name.contains(word));
    shown_unit(channel.unit, small)
}

/// The unit in which a person expects a quantity; `small` for lengths far below a millimetre.
pub(crate) fn shown_unit(unit: Unit, small: bool) -> UserUnit {
    let symbol = match unit {
        Unit::Metre if small => "µm",
        Unit::Metre => "mm",
        Unit::MetrePerSecond => "mm/s",
        Unit::SquareMetre => "mm^2",
        Unit::CubicMetre => "mm^3",
        Unit::Radian => "deg",
        Unit::RadianPerSecond => "deg/s",
        Unit::Pascal => "MPa",
        other => other.symbol(),
    };
    // Every symbol above is in the table of units; SI is the answer if one ever were not.
    UserUnit::parse(symbol).unwrap_or_else(|_| UserUnit::from(unit))
}

/// `joint3.angle` → `joint.angle`.
fn without_joint_number(name: &str) -> String {
    match name
        .strip_prefix("joint")
        .and_then(|rest| rest.split_once('.'))
    {
        Some((number, quantity)) if number.bytes().all(|byte| byte.is_ascii_digit()) => {
            format!("joint.{quantity}")
        }
        _ => name.to_owned(),
    }
}

/// A name without its axis: `belt.force_y` → `belt.force`.
fn stem(name: &str) -> &str {
    match name.rsplit_once('_') {
        Some((stem, "x" | "y" | "z")) => stem,
        _ => name,
    }
}

/// `belt.normal_force` → `Belt normal force`.
fn in_words(name: &str) -> String {
    let words = name.replace(['.', '_'], " ");
    let mut letters = words.chars();
    letters.next().map_or(words.clone(), |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// What tells a channel from the others of its plot: its axis, its joint, or its quantity.
fn short_name(name: &str) -> String {
    let (owner, quantity) = name.split_once('.').unwrap_or(("", name));
    match (owner.strip_prefix("joint"), quantity.rsplit_once('_')) {
        (Some(number), _) if !number.is_empty() => format!("joint {number}"),
        (
            _,
            Some((
                "displacement" | "deflection" | "velocity" | "position" | "force",
                axis @ ("x" | "y" | "z"),
            )),
        ) => axis.to_uppercase(),
        (_, Some(("deflection", axis))) => axis.to_owned(),
        (_, Some((rest, axis @ ("x" | "y" | "z")))) => {
            format!("{} {}", rest.replace('_', " "), axis.to_uppercase())
        }
        _ => quantity.replace('_', " "),
    }
}

/// X, Y and Z have the same colour in every plot; others take turns.
fn color(name: &str, place: usize) -> [u8; 3] {
    const TURNS: [[u8; 3]; 8] = [
        [78, 121, 167],
        [242, 142, 43],
        [118, 183, 178],
        [237, 201, 72],
        [176, 122, 161],
        [255, 157, 167],
        [156, 117, 95],
        [186, 176, 172],
    ];
    match name.rsplit_once('_') {
        Some((_, "x" | "normal")) => [230, 90, 90],
        Some((_, "y" | "along")) => [105, 200, 105],
        Some((_, "z" | "across")) => [100, 150, 255],
        _ => TURNS[place % TURNS.len()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(names: &[(&str, Unit)]) -> Vec<(String, Vec<String>)> {
        let channels: Vec<ChannelSpec> = names
            .iter()
            .map(|(name, unit)| ChannelSpec::new(*name, *unit, ""))
            .collect();
        let legends = |group: &Group| {
            group
                .series
                .iter()
                .map(|series| series.legend.clone())
                .collect()
        };
        groups(&channels)
            .iter()
            .map(|group| (group.title.clone(), legends(group)))
            .collect()
    }

    #[test]
    fn channels_are_sorted_into_plots() {
        let plots = shown(&[
            ("joint1.angle", Unit::Radian),
            ("joint2.angle", Unit::Radian),
            ("tool.displacement_x", Unit::Metre),
            ("tool.displacement_y", Unit::Metre),
            ("foot.sliding", Unit::One),
            ("foot.normal_force", Unit::Newton),
            ("foot.friction_y", Unit::Newton),
            ("belt.speed", Unit::MetrePerSecond),
        ]);
        let expected = [
            (
                "Tool displacement, process frame [µm]",
                vec!["X [µm]", "Y [µm]"],
            ),
            (
                "Pressure foot on the workpiece [N]",
                vec!["normal force [N]", "friction Y [N]"],
            ),
            ("Joint angle [deg]", vec!["joint 1 [deg]", "joint 2 [deg]"]),
            ("Belt speed [mm/s]", vec!["speed [mm/s]"]),
        ];
        let expected: Vec<(String, Vec<String>)> = expected
            .into_iter()
            .map(|(title, legends)| {
                (
                    title.into(),
                    legends.into_iter().map(str::to_owned).collect(),
                )
            })
            .collect();
        assert_eq!(plots, expected);
    }

    #[test]
    fn on_a_path_the_deflection_is_in_front_and_the_path_behind() {
        let channels = [
            "tool.displacement_x",
            "tool.deflection_along",
            "tool.deflection_normal",
        ];
        let channels = channels.map(|name| ChannelSpec::new(name, Unit::Metre, ""));
        let groups = groups(&channels);
        let shown: Vec<(&str, Place)> = groups
            .iter()
            .map(|group| (group.title.as_str(), group.place))
            .collect();
        let expected = [
            (
                "Deflection of the tool from its path [µm]",
                Place::FrontWithSpectrum,
            ),
            ("Tool displacement, process frame [µm]", Place::Behind),
        ];
        assert_eq!(shown, expected);
        let legends = groups[0].series.iter().map(|series| series.legend.as_str());
        assert_eq!(legends.collect::<Vec<_>>(), ["along [µm]", "normal [µm]"]);
    }

    #[test]
    fn unlike_units_never_share_an_axis() {
        let plots = shown(&[
            ("joint1.command", Unit::Radian),
            ("joint2.command", Unit::Metre),
        ]);
        assert_eq!(plots[0].0, "Joint command [deg]");
        assert_eq!(plots[1].0, "Joint command [mm]");
    }
}
