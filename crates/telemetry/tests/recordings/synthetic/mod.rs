//! A made-up run that looks like a real one: a six-axis arm presses a tool with a pressure foot
//! against a plate with a hole; the cutting force grows and turns with the spindle at 5 Hz; from
//! 2.6 s on the foot slides. Nothing here is physics: it only has the channels, the size and the
//! looks of a chamfering run.

mod arm;

use std::f64::consts::TAU;
use std::time::Duration;

use truecut_recording::{
    ChannelSpec, ClaimResult, ClaimSpec, Header, MetricSpec, Outcome, Pace, Profile, Recorder,
    Recording, Reducer, RunReference, Scalar, Sink, SinkError, Unit, UserUnit, Window,
};

const SLIP_S: f64 = 2.6;
const POSTURE_DEG: [f64; 6] = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95];
/// Tool point beyond the flange.
const TOOL_M: f64 = 0.30;

/// Runs it at the given step, with the given sinks, and with some work before each step; returns
/// the recording and its claims.
pub fn run(
    duration_s: f64,
    step_s: f64,
    sinks: Vec<Box<dyn Sink + Send>>,
    work: impl Fn(),
) -> Result<(Recording, Vec<ClaimResult>), SinkError> {
    let mut recorder = recorder(sinks)?;
    let steps = (duration_s / step_s).round() as usize;
    for step in 0..=steps {
        work();
        push(&mut recorder, step as f64 * step_s)?;
    }
    let (recording, sinks) = recorder.finish(scalars(), vec![profile()], Outcome::Completed)?;
    let claims = claims(&recording);
    sinks.close(&recording, &claims)?;
    Ok((recording, claims))
}

/// A recorder for its channels. Only simulated time sends a chunk, so that a busy machine changes
/// nothing.
pub fn recorder(sinks: Vec<Box<dyn Sink + Send>>) -> Result<Recorder, SinkError> {
    let pace = Pace {
        chunk_wall: Duration::MAX,
        ..Pace::default()
    };
    Recorder::with_pace(header(), sinks, pace)
}

/// The row of a time, and its frame if one is due.
pub fn push(recorder: &mut Recorder, t: f64) -> Result<(), SinkError> {
    if recorder.frame_is_due(t) {
        recorder.push_frame(arm::frame(t));
    }
    recorder.push_row(t, &row_at(t))
}

/// Amplitude of the vibration.
fn radius_m(t: f64) -> f64 {
    if t < SLIP_S {
        1.5e-6 * t
    } else {
        4e-6 + 6e-5 * (t - SLIP_S)
    }
}

/// Tool displacement X, Y, Z in the process frame.
fn displacement_m(t: f64) -> [f64; 3] {
    let phase = TAU * 5.0 * t;
    let r = radius_m(t);
    let noise = 2e-7 * (TAU * 41.3 * t).sin() + 1e-7 * (TAU * 23.7 * t + 1.0).sin();
    [
        -1.1e-4 * t / 4.4 + 0.1 * r * phase.sin(),
        r * phase.cos() + noise,
        0.7 * r * phase.sin() - noise,
    ]
}

fn cutting_force_n(t: f64) -> [f64; 3] {
    let size = 110.0 * (t / 4.0).min(1.0);
    let phase = TAU * 5.0 * t;
    [-0.9 * size, size * phase.cos(), size * phase.sin()]
}

fn sliding(t: f64) -> bool {
    t >= SLIP_S && (TAU * 10.0 * t).sin() > -0.6
}

fn row_at(t: f64) -> Vec<f64> {
    let mut row = Vec::with_capacity(64);
    let d = displacement_m(t);
    for (angle_deg, deflection) in POSTURE_DEG.iter().zip(arm::deflection_rad(t)) {
        let q = angle_deg.to_radians();
        row.extend([q + deflection, 10.0 * deflection, q, -2e6 * deflection]);
    }
    let tool = arm::world_from_links(&arm::joint_angles(t, 1.0))
        .pop()
        .map_or([0.0; 3], |flange| flange.apply([0.0, 0.0, TOOL_M]));
    row.extend(tool);
    row.extend(d);
    row.extend([0.0, 31.4 * d[2], -31.4 * d[1]]);
    let force = cutting_force_n(t);
    let slides = sliding(t);
    let friction = if slides {
        72.0
    } else {
        0.65 * force[1].hypot(force[2])
    };
    let phase = TAU * 5.0 * t;
    row.extend([
        482.0 + 0.02 * force[0],
        friction * phase.cos(),
        friction * phase.sin(),
    ]);
    row.extend([
        f64::from(u8::from(slides)),
        if slides {
            1e-3 * phase.sin().abs()
        } else {
            0.0
        },
        0.0,
    ]);
    row.extend(force);
    row.extend([
        2.5e-4 * t,
        2.5e-4 * t - d[0].abs(),
        1.25e-8 * t,
        phase % TAU,
    ]);
    row.extend([
        482.0 - force[0],
        friction * phase.cos() - force[1],
        friction * phase.sin() - force[2],
    ]);
    row.extend([
        0.5 * 557.0 * (31.4 * radius_m(t)).powi(2),
        0.5 * 1e6 * radius_m(t).powi(2),
    ]);
    row
}

fn header() -> Header {
    let mut channels = Vec::new();
    for joint in 1..=6 {
        for (name, unit) in [
            ("angle", Unit::Radian),
            ("velocity", Unit::RadianPerSecond),
            ("command", Unit::Radian),
            ("transmission_torque", Unit::NewtonMetre),
        ] {
            channels.push(ChannelSpec::new(
                format!("joint{joint}.{name}"),
                unit,
                format!("{name} of joint {joint}"),
            ));
        }
    }
    let axes = ["x", "y", "z"];
    let vector =
        |name: &str, unit| axes.map(|axis| ChannelSpec::new(format!("{name}_{axis}"), unit, ""));
    channels.extend(vector("tool.position", Unit::Metre));
    channels.extend(vector("tool.displacement", Unit::Metre));
    channels.extend(vector("tool.velocity", Unit::MetrePerSecond));
    for (name, unit) in [
        ("foot.normal_force", Unit::Newton),
        ("foot.friction_y", Unit::Newton),
        ("foot.friction_z", Unit::Newton),
        ("foot.sliding", Unit::One),
        ("foot.slip_speed", Unit::MetrePerSecond),
        ("foot.lifted", Unit::One),
    ] {
        channels.push(ChannelSpec::new(name, unit, ""));
    }
    channels.extend(vector("cutting.force", Unit::Newton));
    for (name, unit) in [
        ("cutting.depth", Unit::Metre),
        ("cutting.engaged_depth", Unit::Metre),
        ("cutting.chip_area", Unit::SquareMetre),
        ("cutting.edge_angle", Unit::Radian),
    ] {
        channels.push(ChannelSpec::new(name, unit, ""));
    }
    channels.extend(vector("dynamometer.force", Unit::Newton));
    channels.push(ChannelSpec::new("energy.kinetic", Unit::Joule, ""));
    channels.push(ChannelSpec::new("energy.potential", Unit::Joule, ""));
    Header {
        scenario_name: "Synthetic run in the shape of forward chamfering".into(),
        scenario_text: "name = \"Synthetic run in the shape of forward chamfering\"\n\n[run]\nduration_s = 4.4\n".into(),
        channels,
        scene: arm::scene(),
        notes: vec!["made up: nothing here is physics".into()],
    }
}

fn scalars() -> Vec<Scalar> {
    vec![
        Scalar::new(
            "chamfer.width_mean",
            Unit::Metre,
            0.987e-3,
            "mean over the rim",
        ),
        Scalar::new(
            "chamfer.width_spread",
            Unit::Metre,
            8.3e-5,
            "widest minus narrowest",
        ),
        Scalar::new(
            "chamfer.first_slip_depth",
            Unit::Metre,
            6.5e-4,
            "depth at which the foot first slides",
        ),
        Scalar::new(
            "chamfer.axial_share",
            Unit::One,
            0.02,
            "of the axial force, carried by the foot",
        ),
        Scalar::new(
            "theory.exact_threshold_pressure",
            Unit::Pascal,
            4.55e5,
            "planar condition",
        ),
    ]
}

fn profile() -> Profile {
    let axis: Vec<f64> = (0..360)
        .map(|degree| f64::from(degree).to_radians())
        .collect();
    let values = axis
        .iter()
        .map(|angle| 0.987e-3 + 3.5e-5 * angle.cos() + 8e-6 * (5.0 * angle).sin())
        .collect();
    Profile {
        name: "chamfer.width".into(),
        description: "Chamfer width around the rim".into(),
        axis_name: "rim_angle".into(),
        axis_unit: Unit::Radian,
        axis,
        unit: Unit::Metre,
        values,
    }
}

fn claims(recording: &Recording) -> Vec<ClaimResult> {
    let reduced = |reducer, channel: &str| MetricSpec::Reduced {
        reducer,
        channels: vec![channel.into()],
        window: Window::ALL,
    };
    let claim =
        |name: &str, metric, unit: &str, min: Option<f64>, max: Option<f64>, reason: &str| {
            let unit = UserUnit::parse(unit).expect("a known unit");
            let (min, max) = (
                min.map(|min| min * unit.si_factor),
                max.map(|max| max * unit.si_factor),
            );
            let spec = ClaimSpec {
                name: name.into(),
                metric,
                unit,
                min,
                max,
                reason: reason.into(),
                relative_to: None::<RunReference>,
            };
            spec.evaluate(recording, None)
                .expect("a claim that can be judged")
        };
    vec![
        claim(
            "vibrates at the spindle's frequency",
            reduced(
                Reducer::SpectralLine {
                    band_hz: [1.0, 50.0],
                },
                "tool.displacement_y",
            ),
            "Hz",
            Some(4.95),
            Some(5.05),
            "the cutting force turns with the spindle, 300 rpm",
        ),
        claim(
            "starts to slide half-way down the ramp",
            reduced(
                Reducer::FirstTimeAbove {
                    threshold: 0.5,
                    hold_s: 0.003,
                },
                "foot.sliding",
            ),
            "s",
            Some(2.0),
            Some(3.0),
            "friction holds 72 N, the cutting force passes it at 0.65 mm",
        ),
        claim(
            "even width",
            MetricSpec::Scalar {
                name: "chamfer.width_spread".into(),
            },
            "mm",
            None,
            Some(0.05),
            "width spread of the published backward result",
        ),
    ]
}
