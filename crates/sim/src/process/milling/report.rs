//! What a milling pass reports: channels, forces, vibration, the finished surface.

use super::{Milling, MillingLoads, MillingSetup, MillingStep, MillingTheory};
use crate::process::Findings;
use crate::process::quantity::{self, Quantity};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_core::chatter::forced::unforced;
use truecut_core::chatter::growth::{GrowthOptions, growth};
use truecut_core::cutting::milling::dexel::{DexelRow, RayGrid, Wall};
use truecut_core::cutting::milling::finish;
use truecut_recording::spectrum::{Spectrum, amplitude_spectrum_up_to};
use truecut_recording::{Profile, Scalar, Unit};

const AXES: [(&str, &str); 3] = [
    ("x", "along the feed"),
    ("y", "across it"),
    ("z", "into the spindle"),
];
/// Change of the deflection from one tooth to the next that still counts as small, as a part of the
/// feed per tooth. It is what the chip sees of vibration where teeth meet their own surface; where
/// they meet the nominal one the chip sees the deflection, and slow flutter is small for longer.
pub(crate) fn linear_share(regeneration: bool) -> f64 {
    if regeneration { 0.05 } else { 0.15 }
}

/// Spectra reach to so many times the tooth-passing frequency, or so many times the fastest mode.
const SPECTRUM_TEETH: f64 = 3.0;
const SPECTRUM_MODES: f64 = 1.5;
/// Feed per revolution by which rays at the ends of a surface are left out: their neighbours are
/// not all cut.
const MARGIN_REVOLUTIONS: f64 = 2.0;

/// What is recorded of a step: the cut, with its chips at the instant, and of a pass that finishes
/// a wall what is left on that.
pub(super) fn quantities(
    setup: &MillingSetup,
    last: &MillingStep,
    at_the_instant: Option<MillingLoads>,
) -> impl Iterator<Item = Quantity> {
    let (force, torque) = (last.force_on_tool_n, last.moment_on_tool_n_m.z);
    let (chip_m, teeth) = (at_the_instant).map_or((0.0, 0), |loads| {
        (loads.thickest_chip_m, loads.teeth_in_cut)
    });
    let (teeth, in_cut) = (teeth as f64, f64::from(u8::from(teeth > 0)));
    let (deflection, angle_rad) = (last.deflection_m, last.rotation_rad.rem_euclid(TAU));
    let cut = [
        Quantity::new("milling.force_x", Unit::Newton, force.x)
            .text("Cutting force on the tool, along the feed"),
        Quantity::new("milling.force_y", Unit::Newton, force.y)
            .text("Cutting force on the tool, across it"),
        Quantity::new("milling.force_z", Unit::Newton, force.z)
            .text("Cutting force on the tool, into the spindle"),
        Quantity::new("milling.torque", Unit::NewtonMetre, torque)
            .text("Torque of the cut about the tool axis; positive brakes the spindle"),
        Quantity::new("milling.deflection_x", Unit::Metre, deflection.x)
            .text("Tool point minus its place on the path, along the feed"),
        Quantity::new("milling.deflection_y", Unit::Metre, deflection.y)
            .text("Tool point minus its place on the path, across it"),
        Quantity::new("milling.deflection_z", Unit::Metre, deflection.z)
            .text("Tool point minus its place on the path, into the spindle"),
        Quantity::new("milling.chip_thickness", Unit::Metre, chip_m)
            .text("Thickest chip of all teeth"),
        Quantity::new("milling.teeth_in_cut", Unit::One, teeth).text("Teeth that cut"),
        Quantity::new("milling.in_cut", Unit::One, in_cut).text("1 while a tooth cuts, else 0"),
        Quantity::new("milling.spindle_angle", Unit::Radian, angle_rad)
            .text("Angle of the first tooth, from +y towards the feed, 0 to 2 pi"),
    ];
    let error_m = last.wall_error_m;
    let wall = setup.wall().map(|_| {
        Quantity::new("milling.wall_error", Unit::Metre, error_m)
            .text("Material that the last tooth left on the wall; negative if it took too much")
    });
    cut.into_iter().chain(wall)
}

/// Scalars and profiles at the end of the run.
pub(super) fn findings(milling: &Milling) -> Findings {
    let mut findings = Findings::default();
    forces(milling, &mut findings);
    vibration(milling, &mut findings);
    surfaces(milling, &mut findings);
    predictions(&milling.setup.theory.limits(), &mut findings);
    findings
}

fn forces(milling: &Milling, findings: &mut Findings) {
    let (sum, square, count) = milling.history.force.whole;
    let part = |value: f64| {
        if count == 0 {
            f64::NAN
        } else {
            value / count as f64
        }
    };
    let nominal = &milling.setup.nominal_force_n;
    for (i, (axis, text)) in AXES.into_iter().enumerate() {
        let scalar = |name: &str, value: f64, what: &str| {
            Scalar::new(
                format!("milling.{name}_force_{axis}"),
                Unit::Newton,
                value,
                format!("{what} {text}"),
            )
        };
        findings.scalars.extend([
            scalar(
                "mean",
                part(sum[i]),
                "Mean over whole revolutions of the force on the tool",
            ),
            scalar(
                "rms",
                part(square[i]).sqrt(),
                "Root mean square over whole revolutions of the force on the tool",
            ),
            scalar(
                "nominal",
                nominal[i],
                "Mean force of the nominal cut in closed form",
            ),
        ]);
    }
}

/// Samples of the settled cut at even steps.
struct Samples<'a> {
    interval_s: f64,
    deflection_m: &'a [Vector3<f64>],
    velocity_m_per_s: &'a [Vector3<f64>],
}

impl Samples<'_> {
    fn spectrum(&self, values: &[Vector3<f64>], axis: usize, highest_hz: f64) -> Option<Spectrum> {
        let values: Vec<f64> = values.iter().map(|v| v[axis]).collect();
        spectrum(&values, self.interval_s, highest_hz)
    }
}

fn spectrum(values: &[f64], interval_s: f64, highest_hz: f64) -> Option<Spectrum> {
    let times: Vec<f64> = (0..values.len()).map(|i| i as f64 * interval_s).collect();
    amplitude_spectrum_up_to(&times, values, highest_hz)
}

fn vibration(milling: &Milling, findings: &mut Findings) {
    let (setup, history) = (&milling.setup, &milling.history);
    let samples = Samples {
        interval_s: milling.step_s * history.stride.max(1) as f64,
        deflection_m: &history.deflection_m,
        velocity_m_per_s: &history.velocity_m_per_s,
    };
    let forced_s = forced_period_s(setup);
    let share = linear_share(setup.parameters.regeneration);
    let options = GrowthOptions {
        period_s: forced_s,
        linear_m: share * setup.parameters.feed_per_tooth_m,
    };
    let grown = growth(samples.deflection_m, samples.interval_s, &options);
    let of_modes_hz = SPECTRUM_MODES * setup.fastest_mode_hz;
    let highest_hz = (SPECTRUM_TEETH / setup.tooth_period_s()).max(of_modes_hz);
    let line = dominant_line(&samples, forced_s, highest_hz);
    let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let rate_per_s = or_nan(grown.and_then(|g| g.rate_per_s));
    let level_m = or_nan(grown.map(|g| g.last_level_m));
    let (line_hz, line_m) = line.unwrap_or((f64::NAN, f64::NAN));
    findings.scalars.extend(quantity::scalars([
        Quantity::new("milling.growth_rate", Unit::PerSecond, rate_per_s)
            .text("Growth of vibration that does not repeat with the teeth, while it is small beside the feed per tooth (if it \
             never is: as it is); negative: it dies away; none: less than an atom, noise of computing"),
        Quantity::new("milling.vibration_level", Unit::Metre, level_m)
            .text("Change of the deflection from one tooth to the next (with runout: one revolution), root mean square at the end"),
        Quantity::new("milling.chatter_frequency", Unit::Hertz, line_hz)
            .text("Highest line of the deflection in the plane of cut apart from the teeth's harmonics"),
        Quantity::new("milling.chatter_amplitude", Unit::Metre, line_m)
            .text("Amplitude of that line"),
    ]));
    for (i, (axis, text)) in AXES.into_iter().enumerate() {
        let Some(spectrum) = samples.spectrum(samples.velocity_m_per_s, i, highest_hz) else {
            continue;
        };
        let pairs = spectrum.frequency_hz.iter().zip(&spectrum.amplitude);
        findings.profiles.push(Profile {
            name: format!("milling.acceleration_spectrum_{axis}"),
            description: format!(
                "Amplitude spectrum of the tool point's acceleration {text}, of the settled cut"
            ),
            axis_name: "frequency".into(),
            axis_unit: Unit::Hertz,
            values: pairs.map(|(f, v)| TAU * f * v).collect(),
            axis: spectrum.frequency_hz,
            unit: Unit::MetrePerSecondSquared,
        });
    }
}

/// Period of forced vibration: that of the teeth, or of the revolution if they differ.
fn forced_period_s(setup: &MillingSetup) -> f64 {
    let cutter = &setup.parameters.cutter;
    let teeth = if cutter.runout.offset_m == 0.0 {
        1
    } else {
        cutter.teeth
    };
    setup.tooth_period_s() * teeth as f64
}

/// The highest line along x or y of what does not repeat with the forced vibration: frequency, Hz,
/// and amplitude, m.
fn dominant_line(samples: &Samples<'_>, forced_s: f64, highest_hz: f64) -> Option<(f64, f64)> {
    let lines = (0..2).filter_map(|axis| {
        let motion: Vec<f64> = samples.deflection_m.iter().map(|x| x[axis]).collect();
        let rest = unforced(&motion, forced_s / samples.interval_s)?;
        let spectrum = spectrum(&rest.values, rest.interval * samples.interval_s, highest_hz)?;
        spectrum.highest_line([0.5 * spectrum.resolution_hz, highest_hz])
    });
    let highest = lines.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude))?;
    Some((highest.frequency_hz, highest.amplitude))
}

fn surfaces(milling: &Milling, findings: &mut Findings) {
    let Some(finished) = milling.cut.finished() else {
        return;
    };
    let setup = &milling.setup;
    for (i, wall) in setup.finished_walls.iter().enumerate() {
        let name = match wall {
            Wall::Exit => "exit_wall",
            Wall::Entry => "entry_wall",
        };
        let text = match wall {
            Wall::Exit => "the wall where teeth leave, at half the depth",
            Wall::Entry => "the wall where teeth enter, at half the depth",
        };
        surface(
            setup,
            finished.grid(),
            finished.wall(i),
            (name, text),
            findings,
        );
    }
    surface(
        setup,
        finished.grid(),
        finished.floor(0),
        ("floor", "the floor, under the tool axis"),
        findings,
    );
}

fn surface(
    setup: &MillingSetup,
    grid: &RayGrid,
    row: &DexelRow,
    (name, text): (&str, &str),
    findings: &mut Findings,
) {
    let left = row.left_m();
    let margin = MARGIN_REVOLUTIONS * setup.parameters.feed_per_revolution_m() / grid.spacing_m;
    let margin = margin.ceil() as usize;
    let first = left
        .iter()
        .position(|x| x.is_finite())
        .unwrap_or(left.len())
        + margin;
    // The last ray before the first that is not cut.
    let end = (left.iter().skip(first)).position(|x| !x.is_finite());
    let end = end
        .map_or(left.len(), |count| first + count)
        .saturating_sub(margin);
    let kept = left.get(first..end).unwrap_or_default();
    let figures = finish::figures(kept);
    let scalar = |what: &str, value: Option<f64>, words: &str| {
        Scalar::new(
            format!("milling.{name}_{what}"),
            Unit::Metre,
            value.unwrap_or(f64::NAN),
            format!("{words} {text}"),
        )
    };
    findings.scalars.extend([
        scalar(
            "error",
            figures.map(|f| f.location_error_m),
            "Surface location error: mean of the material left on",
        ),
        scalar(
            "scallop",
            figures.map(|f| f.peak_to_valley_m),
            "Highest minus lowest point of",
        ),
        scalar(
            "roughness",
            figures.map(|f| f.arithmetic_deviation_m),
            "Ra about the mean of",
        ),
    ]);
    if kept.is_empty() {
        return;
    }
    findings.profiles.push(Profile {
        name: format!("milling.{name}"),
        description: format!("Material left above the nominal surface on {text}"),
        axis_name: "path_position".into(),
        axis_unit: Unit::Metre,
        axis: (first..end)
            .map(|ray| grid.x_m(ray) - setup.origin_m())
            .collect(),
        unit: Unit::Metre,
        values: kept.to_vec(),
    });
}

fn predictions(theory: &MillingTheory, findings: &mut Findings) {
    findings.scalars.extend(quantity::scalars([
        Quantity::new("theory.mode_coupling_depth", Unit::Metre, theory.coupling_depth_m)
            .text("Depth limit of the averaged theory for teeth that meet the nominal surface, at the start"),
        Quantity::new("theory.mode_coupling_frequency", Unit::Hertz, theory.coupling_hz)
            .text("Chatter frequency there"),
        Quantity::new("theory.regenerative_depth", Unit::Metre, theory.regenerative_depth_m)
            .text("Depth limit to zero order for teeth that meet their own surface, at the start"),
        Quantity::new("theory.regenerative_frequency", Unit::Hertz, theory.regenerative_hz)
            .text("Chatter frequency there"),
        Quantity::new("theory.stability_depth", Unit::Metre, theory.stability_depth_m)
            .text("Depth limit by spectral elements for teeth that meet their own surface, at the start; looked for up to twice that to zero order"),
        Quantity::new("theory.stability_frequency", Unit::Hertz, theory.stability_hz)
            .text("Chatter frequency there"),
        Quantity::new("theory.stability_depth_error", Unit::Metre, theory.stability_error_m)
            .text("Error of that limit by discretisation in time, estimated"),
    ]));
}
