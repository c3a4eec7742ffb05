//! What the run came to, in the viewer: spectra, profiles, numbers, the scenario.

use super::store::{Logged, Store};
use truecut_recording::spectrum::{Line, Spectrum, amplitude_spectrum_up_to};
use truecut_recording::{Profile, Recording, Scalar, Unit, UserUnit, significant};

use super::chart::{Chart, Curve, CurveStyle};
use super::seen::Seen;
use super::verdict::one_cell;
use crate::display::{Group, Place, Series, shown_unit};

/// Where notes and scalars are logged.
pub(super) const ABOUT: &str = "/about";
/// Where the scenario's text is logged.
pub(super) const SCENARIO: &str = "/scenario";
/// Above all spectra.
pub(super) const SPECTRA: &str = "/spectra";
/// Above all profiles.
pub(super) const PROFILES: &str = "/profiles";

/// Vibration of an arm is mostly below this, and a spectrum shows so far at least.
const LEAST_RANGE_HZ: f64 = 60.0;
/// Lines are looked for up to here: teeth may shake an arm's wrist, or the tool.
const HIGHEST_HZ: f64 = 1500.0;
/// A line of at least this share of the largest belongs into the picture.
const WORTH_SEEING: f64 = 0.3;
/// How much further than its last such line a spectrum goes.
const BEYOND_LINE: f64 = 1.25;
/// More points than this are no more than a screen shows.
const MOST_POINTS: usize = 4000;
/// Below this a ramp shows, not a vibration.
const LOWEST_HZ: f64 = 2.0;
/// The scalar that names the frequency of chatter, and how many bins from it its line may stand.
const CHATTER_HZ: &str = "milling.chatter_frequency";
const CHATTER_BINS: f64 = 1.5;
/// Lines below this share of what means something on the plot are not worth a name.
const LEAST_SHARE: f64 = 0.01;

/// A drawn chart: where it is, and what its tab is called.
pub(super) struct Drawn {
    pub(super) entity: String,
    pub(super) title: String,
    /// What its view must show across.
    pub(super) across: [f64; 2],
    /// A spectrum without a line: nothing to open on.
    pub(super) says_little: bool,
}

impl Drawn {
    /// Logs a chart.
    pub(super) fn of(chart: Chart, stream: &Store, entity: String) -> Logged<Drawn> {
        chart.log(stream, &entity)?;
        Ok(Drawn {
            entity,
            across: chart.across(),
            title: chart.title,
            says_little: false,
        })
    }
}

/// Draws the spectra of the main plots: one chart each, with the highest lines named.
pub(super) fn log_spectra(
    stream: &Store,
    groups: &[Group],
    time_s: &[f64],
    seen: &Seen,
) -> Logged<Vec<Drawn>> {
    let mut drawn = Vec::new();
    for group in groups
        .iter()
        .filter(|group| group.place == Place::FrontWithSpectrum)
    {
        let spectra = group.series.iter().filter_map(|series| {
            let values = seen.column(series.channel);
            let spectrum = amplitude_spectrum_up_to(time_s, values, HIGHEST_HZ)?;
            Some((series, spectrum))
        });
        let spectra: Vec<_> = spectra.collect();
        let range_hz = range_hz(spectra.iter().map(|(_, spectrum)| spectrum));
        let mut curves: Vec<Curve> = spectra
            .iter()
            .map(|(series, spectrum)| spectrum_curve(series, spectrum, group.least, range_hz))
            .collect();
        if curves.is_empty() {
            continue;
        }
        keep_highest_mark(&mut curves);
        let has_lines = curves.iter().any(|curve| !curve.marks.is_empty());
        let entity = format!("{SPECTRA}/{}", drawn.len());
        let name = group
            .title
            .split([',', ':', '['])
            .next()
            .unwrap_or_default()
            .trim();
        let unit = &group.series[0].unit.symbol;
        let chart = Chart {
            title: format!("Spectrum: {name}"),
            x_label: "frequency [Hz]".to_owned(),
            y_label: format!("{name}: amplitude [{unit}]"),
            least_y: group.series[0].unit.from_si(LEAST_SHARE * group.least),
            logarithmic: false,
            curves,
        };
        drawn.push(Drawn {
            says_little: !has_lines,
            ..Drawn::of(chart, stream, entity)?
        });
    }
    Ok(drawn)
}

/// How far spectra that share a chart are shown: as far as an arm vibrates, and beyond where one
/// of the large lines stands.
fn range_hz<'a>(spectra: impl Iterator<Item = &'a Spectrum>) -> f64 {
    let lines = spectra.flat_map(|spectrum| spectrum.lines([LOWEST_HZ, HIGHEST_HZ], 3, 0.1));
    let lines: Vec<Line> = lines.collect();
    let largest = (lines.iter()).fold(0.0, |largest: f64, line| largest.max(line.amplitude));
    let worth = lines
        .iter()
        .filter(|line| line.amplitude >= WORTH_SEEING * largest);
    let last_hz = worth.fold(0.0, |last: f64, line| last.max(line.frequency_hz));
    match last_hz <= LEAST_RANGE_HZ {
        true => LEAST_RANGE_HZ,
        false => BEYOND_LINE * last_hz,
    }
}

/// Points as a screen shows them: of many side by side the highest.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let highest = points.chunks(every).filter_map(|some| {
        let highest = some.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        highest.copied()
    });
    highest.collect()
}

fn spectrum_curve(series: &Series, spectrum: &Spectrum, least: f64, range_hz: f64) -> Curve {
    let shown = |amplitude: f64| series.unit.from_si(amplitude);
    let mut lines = spectrum.lines([LOWEST_HZ, range_hz], 3, 0.1);
    lines.retain(|line| line.amplitude >= LEAST_SHARE * least);
    let in_words = |line: &Line| {
        format!(
            "{:.2} Hz ({})",
            line.frequency_hz,
            significant(shown(line.amplitude), 3)
        )
    };
    let named = match lines.iter().map(in_words).collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => {
            format!("no line above {}", series.unit.show(LEAST_SHARE * least))
        }
        some => some,
    };
    let marks = lines.iter().map(|line| {
        (
            line.frequency_hz,
            shown(line.amplitude),
            format!("{:.2} Hz", line.frequency_hz),
        )
    });
    // What a ramp leaves at the left end is no vibration, and would set the scale.
    let points = spectrum.frequency_hz.iter().zip(&spectrum.amplitude);
    let points = points
        .skip_while(|(frequency_hz, _)| **frequency_hz < LOWEST_HZ)
        .take_while(|(frequency_hz, _)| **frequency_hz <= range_hz);
    Curve {
        name: format!("{}: {named}", series.legend),
        color: series.color,
        points: thinned(
            points
                .map(|(frequency_hz, amplitude)| (*frequency_hz, shown(*amplitude)))
                .collect(),
        ),
        marks: marks.collect(),
        style: CurveStyle::Line,
    }
}

/// Only the chart's highest line is named in the picture, where names would hide each other; all
/// are in the legend.
fn keep_highest_mark(curves: &mut [Curve]) {
    let marks = curves.iter().flat_map(|curve| &curve.marks);
    let highest = marks.map(|mark| mark.1).fold(0.0, f64::max);
    for curve in curves {
        curve.marks.retain(|mark| mark.1 >= highest);
    }
}

/// Draws each profile as a chart.
pub(super) fn log_profiles(
    stream: &Store,
    profiles: &[Profile],
    scalars: &[Scalar],
) -> Logged<Vec<Drawn>> {
    let mut drawn = Vec::new();
    for (index, profile) in profiles.iter().enumerate() {
        let (x_unit, y_unit) = (
            shown_unit(profile.axis_unit, false),
            shown_unit(profile.unit, is_small(profile)),
        );
        let points = profile.axis.iter().zip(&profile.values);
        let points = points.map(|(at, value)| (x_unit.from_si(*at), y_unit.from_si(*value)));
        let words = |name: &str| name.replace(['_', '.'], " ");
        let title = format!("{} [{}]", words(&profile.name), y_unit.symbol);
        let chart = Chart {
            x_label: format!("{} [{}]", words(&profile.axis_name), x_unit.symbol),
            y_label: format!("{title}: {}", profile.description),
            title,
            least_y: f64::NAN,
            logarithmic: false,
            curves: vec![Curve {
                name: spread(profile, &y_unit),
                color: [242, 142, 43],
                points: points.collect(),
                marks: chatter_mark(profile, scalars, &y_unit)
                    .into_iter()
                    .collect(),
                style: CurveStyle::Line,
            }],
        };
        let entity = format!("{PROFILES}/{index}");
        drawn.push(Drawn::of(chart, stream, entity)?);
    }
    Ok(drawn)
}

/// The chatter line of a spectrum of milling: the highest point near the frequency that the run
/// names.
fn chatter_mark(
    profile: &Profile,
    scalars: &[Scalar],
    unit: &UserUnit,
) -> Option<(f64, f64, String)> {
    if profile.axis_unit != Unit::Hertz || !profile.name.starts_with("milling.") {
        return None;
    }
    let line = scalars.iter().find(|one| one.name == CHATTER_HZ)?.value;
    let resolution = profile.axis.get(1)? - profile.axis.first()?;
    let near = profile.axis.iter().zip(&profile.values);
    let near = near.filter(|(hz, _)| (**hz - line).abs() <= CHATTER_BINS * resolution);
    let (hz, value) = near.max_by(|a, b| a.1.total_cmp(b.1))?;
    Some((
        *hz,
        unit.from_si(*value),
        format!("chatter line, {line:.2} Hz"),
    ))
}

fn is_small(profile: &Profile) -> bool {
    profile
        .values
        .iter()
        .all(|value| value.is_nan() || value.abs() < 1e-4)
}

fn spread(profile: &Profile, unit: &UserUnit) -> String {
    let finite = || {
        profile
            .values
            .iter()
            .copied()
            .filter(|value| value.is_finite())
    };
    let (low, high) = (
        finite().fold(f64::INFINITY, f64::min),
        finite().fold(f64::NEG_INFINITY, f64::max),
    );
    if low > high {
        "no values".to_owned()
    } else {
        format!("widest − narrowest: {}", unit.show(high - low))
    }
}

/// What a reader should know: how to read the views, the run's numbers, its notes.
pub(super) fn about(recording: &Recording) -> String {
    let header = &recording.header;
    let mut text = format!(
        "## {}\n\nThe run {}.\n\n",
        header.scenario_name, recording.outcome
    );
    text += "Displacements are in µm, lengths in mm, angles in degrees. Curves keep the smallest and the largest value \
             of every 2 ms, in plots behind others of every 8 ms; the Parquet file beside this one has every step, in SI. ";
    if header.scene.deflection_scale != 1.0 {
        text += &format!(
            "The coloured arm's deflection is enlarged {} times; the grey outline is where it truly is. ",
            header.scene.deflection_scale
        );
    }
    text +=
        "Amplitude spectra are of the whole run, mean and trend removed, with a Hann window.\n\n";
    if !recording.scalars.is_empty() {
        text += "| result | value | |\n|---|---|---|\n";
        for scalar in &recording.scalars {
            let small = scalar.value.abs() < 1e-4;
            let shown = shown_unit(scalar.unit, small).show(scalar.value);
            text += &format!(
                "| {} | {shown} | {} |\n",
                one_cell(&scalar.name),
                one_cell(&scalar.description)
            );
        }
    }
    text
}

/// The scenario as a block of code.
pub(super) fn scenario(text: &str) -> String {
    format!("```toml\n{text}\n```\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chatter_line_stands_on_the_peak_beside_its_frequency() {
        let profile = |name: &str| Profile {
            name: name.into(),
            description: String::new(),
            axis_name: "frequency".into(),
            axis_unit: Unit::Hertz,
            unit: Unit::MetrePerSecondSquared,
            axis: (0..100).map(|k| 0.2 * f64::from(k)).collect(),
            values: (0..100)
                .map(|k| if k == 49 || k == 80 { 2.0 } else { 0.1 })
                .collect(),
        };
        let line = [Scalar::new(CHATTER_HZ, Unit::Hertz, 9.91, "")];
        let unit = UserUnit::from(Unit::MetrePerSecondSquared);
        let mark = |name: &str, scalars: &[Scalar]| chatter_mark(&profile(name), scalars, &unit);
        let (hz, value, text) = mark("milling.acceleration_spectrum_x", &line).expect("a mark");
        assert!((hz - 9.8).abs() < 1e-9 && value == 2.0);
        assert_eq!(text, "chatter line, 9.91 Hz");
        assert_eq!(mark("milling.acceleration_spectrum_x", &[]), None);
        assert_eq!(mark("rim.width", &line), None);
        let none = [Scalar::new(CHATTER_HZ, Unit::Hertz, f64::NAN, "")];
        assert_eq!(mark("milling.acceleration_spectrum_x", &none), None);
    }

    /// A line of half the size of the arm's own widens the picture to itself, a tenth does not.
    #[test]
    fn a_spectrum_reaches_to_its_large_lines() {
        let time_s: Vec<f64> = (0..10_000).map(|k| 2e-4 * f64::from(k)).collect();
        for tooth_hz in [35.0, 83.0, 200.0, 640.0, 1210.0] {
            for (share, is_worth) in [(0.5, true), (0.1, false)] {
                let wave = |hz: f64, t: f64| (std::f64::consts::TAU * hz * t).sin();
                let values: Vec<f64> = time_s
                    .iter()
                    .map(|t| 3e-6 * (wave(12.0, *t) + share * wave(tooth_hz, *t)))
                    .collect();
                let spectrum = amplitude_spectrum_up_to(&time_s, &values, HIGHEST_HZ);
                let found_hz = range_hz(spectrum.iter());
                let expected_hz = match is_worth && tooth_hz > LEAST_RANGE_HZ {
                    true => BEYOND_LINE * tooth_hz,
                    false => LEAST_RANGE_HZ,
                };
                assert!(
                    (found_hz / expected_hz - 1.0).abs() < 0.01,
                    "{found_hz} Hz for {expected_hz} Hz"
                );
            }
        }
        let many = (0..9_000).map(|k| (f64::from(k), if k == 4_321 { 1.0 } else { 0.1 }));
        let few = thinned(many.collect());
        assert!(few.len() <= MOST_POINTS && few.contains(&(4_321.0, 1.0)));
    }
}
