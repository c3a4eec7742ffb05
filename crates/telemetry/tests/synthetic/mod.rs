//! A made-up run that looks like a real one: a six-axis arm presses a tool with a pressure foot against a plate with a
//! hole; the cutting force grows and turns with the spindle at 5 Hz; from 2.6 s on the foot slides. Nothing here is
//! physics: it only has the channels, the size and the looks of a chamfering run.

use std::f64::consts::TAU;

use truecut_recording::{
    Arrow, Body, ChannelSpec, ClaimResult, ClaimSpec, Frame, Geometry, Header, MetricSpec, Outcome, Pose, Profile,
    Recorder, Recording, Reducer, RunReference, Scalar, Scene, Shape, Sink, SinkError, Unit, UserUnit, Window,
};

pub const SLIP_S: f64 = 2.6;
const SCALE: f64 = 300.0;
const POSTURE_DEG: [f64; 6] = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95];
/// Tool point beyond the flange.
const TOOL_M: f64 = 0.30;

/// Runs it, with the given sinks, at the given step; returns the recording and its claims, and how long the rows and
/// frames took apart from making them up.
pub fn run(
    duration_s: f64,
    step_s: f64,
    sinks: Vec<Box<dyn Sink + Send>>,
) -> Result<(Recording, Vec<ClaimResult>), SinkError> {
    let mut recorder = Recorder::new(header(), sinks)?;
    let steps = (duration_s / step_s).round() as usize;
    let mut row = Vec::new();
    for step in 0..=steps {
        let t = step as f64 * step_s;
        if recorder.frame_is_due(t) {
            recorder.push_frame(frame(t));
        }
        row_at(t, &mut row);
        recorder.push_row(t, &row)?;
    }
    let (recording, sinks) = recorder.finish(scalars(), vec![profile()], Outcome::Completed)?;
    let claims = claims(&recording);
    sinks.close(&recording, &claims)?;
    Ok((recording, claims))
}

/// Amplitude of the vibration.
fn radius_m(t: f64) -> f64 {
    if t < SLIP_S { 1.5e-6 * t } else { 4e-6 + 6e-5 * (t - SLIP_S) }
}

/// Tool displacement X, Y, Z in the process frame.
fn displacement_m(t: f64) -> [f64; 3] {
    let phase = TAU * 5.0 * t;
    let r = radius_m(t);
    let noise = 2e-7 * (TAU * 41.3 * t).sin() + 1e-7 * (TAU * 23.7 * t + 1.0).sin();
    [-1.1e-4 * t / 4.4 + 0.1 * r * phase.sin(), r * phase.cos() + noise, 0.7 * r * phase.sin() - noise]
}

fn cutting_force_n(t: f64) -> [f64; 3] {
    let size = 110.0 * (t / 4.0).min(1.0);
    let phase = TAU * 5.0 * t;
    [-0.9 * size, size * phase.cos(), size * phase.sin()]
}

fn sliding(t: f64) -> bool {
    t >= SLIP_S && (TAU * 10.0 * t).sin() > -0.6
}

fn row_at(t: f64, row: &mut Vec<f64>) {
    row.clear();
    let d = displacement_m(t);
    for joint in 0..6 {
        let q = POSTURE_DEG[joint].to_radians();
        let deflection = deflection_rad(t)[joint];
        row.extend([q + deflection, 10.0 * deflection, q, -2e6 * deflection]);
    }
    let tool = world_from_links(&joint_angles(t, 1.0)).pop().map_or([0.0; 3], |flange| flange.apply([0.0, 0.0, TOOL_M]));
    row.extend(tool);
    row.extend(d);
    row.extend([0.0, 31.4 * d[2], -31.4 * d[1]]);
    let force = cutting_force_n(t);
    let slides = sliding(t);
    let friction = if slides { 72.0 } else { 0.65 * force[1].hypot(force[2]) };
    let phase = TAU * 5.0 * t;
    row.extend([482.0 + 0.02 * force[0], friction * phase.cos(), friction * phase.sin()]);
    row.extend([f64::from(u8::from(slides)), if slides { 1e-3 * phase.sin().abs() } else { 0.0 }, 0.0]);
    row.extend(force);
    row.extend([2.5e-4 * t, 2.5e-4 * t - d[0].abs(), 1.25e-8 * t, phase % TAU]);
    row.extend([482.0 - force[0], friction * phase.cos() - force[1], friction * phase.sin() - force[2]]);
    row.extend([0.5 * 557.0 * (31.4 * radius_m(t)).powi(2), 0.5 * 1e6 * radius_m(t).powi(2)]);
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
            channels.push(ChannelSpec::new(format!("joint{joint}.{name}"), unit, format!("{name} of joint {joint}")));
        }
    }
    let axes = ["x", "y", "z"];
    let vector = |name: &str, unit| axes.map(|axis| ChannelSpec::new(format!("{name}_{axis}"), unit, ""));
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
        scene: scene(),
        notes: vec!["made up: nothing here is physics".into()],
    }
}

fn scalars() -> Vec<Scalar> {
    vec![
        Scalar::new("chamfer.width_mean", Unit::Metre, 0.987e-3, "mean over the rim"),
        Scalar::new("chamfer.width_spread", Unit::Metre, 8.3e-5, "widest minus narrowest"),
        Scalar::new("chamfer.first_slip_depth", Unit::Metre, 6.5e-4, "depth at which the foot first slides"),
        Scalar::new("chamfer.axial_share", Unit::One, 0.02, "of the axial force, carried by the foot"),
        Scalar::new("theory.exact_threshold_pressure", Unit::Pascal, 4.55e5, "planar condition"),
    ]
}

fn profile() -> Profile {
    let axis: Vec<f64> = (0..360).map(|degree| f64::from(degree).to_radians()).collect();
    let values = axis.iter().map(|angle| 0.987e-3 + 3.5e-5 * angle.cos() + 8e-6 * (5.0 * angle).sin()).collect();
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
    let claim = |name: &str, metric, unit: &str, min: Option<f64>, max: Option<f64>, reason: &str| {
        let unit = UserUnit::parse(unit).expect("a known unit");
        let (min, max) = (min.map(|min| min * unit.si_factor), max.map(|max| max * unit.si_factor));
        let spec = ClaimSpec {
            name: name.into(),
            metric,
            unit,
            min,
            max,
            reason: reason.into(),
            relative_to: None::<RunReference>,
        };
        spec.evaluate(recording, None).expect("a claim that can be judged")
    };
    vec![
        claim(
            "vibrates at the spindle's frequency",
            reduced(Reducer::SpectralLine { band_hz: [1.0, 50.0] }, "tool.displacement_y"),
            "Hz",
            Some(4.95),
            Some(5.05),
            "the cutting force turns with the spindle, 300 rpm",
        ),
        claim(
            "starts to slide half-way down the ramp",
            reduced(Reducer::FirstTimeAbove { threshold: 0.5, hold_s: 0.003 }, "foot.sliding"),
            "s",
            Some(2.0),
            Some(3.0),
            "friction holds 72 N, the cutting force passes it at 0.65 mm",
        ),
        claim(
            "even width",
            MetricSpec::Scalar { name: "chamfer.width_spread".into() },
            "mm",
            None,
            Some(0.05),
            "width spread of the published backward result",
        ),
    ]
}

/// A rigid transform.
#[derive(Clone, Copy)]
struct Rigid {
    at: [f64; 3],
    turn: [f64; 4],
}

impl Rigid {
    fn new(at: [f64; 3], axis: [f64; 3], angle: f64) -> Rigid {
        let (sin, cos) = (0.5 * angle).sin_cos();
        Rigid { at, turn: [axis[0] * sin, axis[1] * sin, axis[2] * sin, cos] }
    }

    fn rotate(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z, w] = self.turn;
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let t = cross([x, y, z], v).map(|value| 2.0 * value);
        let u = cross([x, y, z], t);
        std::array::from_fn(|i| v[i] + w * t[i] + u[i])
    }

    fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        let turned = self.rotate(p);
        std::array::from_fn(|i| self.at[i] + turned[i])
    }

    fn then(&self, next: Rigid) -> Rigid {
        let ([x, y, z, w], [a, b, c, d]) = (self.turn, next.turn);
        let turn = [
            w * a + x * d + y * c - z * b,
            w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d,
            w * d - x * a - y * b - z * c,
        ];
        Rigid { at: self.apply(next.at), turn }
    }

    fn pose(&self) -> Pose {
        Pose { translation_m: self.at, rotation_xyzw: self.turn }
    }
}

fn deflection_rad(t: f64) -> [f64; 6] {
    let d = displacement_m(t);
    [0.5 * d[1], 0.4 * d[2] - 0.2 * d[0], 0.3 * d[2], 0.5 * d[1], 0.6 * d[2], 0.3 * d[1]]
}

fn joint_angles(t: f64, scale: f64) -> [f64; 6] {
    let deflection = deflection_rad(t);
    std::array::from_fn(|joint| POSTURE_DEG[joint].to_radians() + scale * deflection[joint])
}

/// Base, six links, flange.
fn world_from_links(q: &[f64; 6]) -> Vec<Rigid> {
    let (y, z) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let steps = [
        Rigid::new([0.0, 0.0, 0.78], z, q[0]),
        Rigid::new([0.32, 0.0, 0.0], y, q[1]),
        Rigid::new([0.0, 0.0, 1.075], y, q[2] + 0.25 * TAU),
        Rigid::new([-0.2, 0.0, 1.142], z, q[3]),
        Rigid::new([0.0; 3], y, q[4]),
        Rigid::new([0.0; 3], z, q[5]),
        Rigid::new([0.0, 0.0, 0.2], z, 0.0),
    ];
    let mut links = vec![Rigid::new([0.0; 3], z, 0.0)];
    for step in steps {
        links.push(links[links.len() - 1].then(step));
    }
    links
}

fn shape(geometry: Geometry, color_rgba: [u8; 4], at: Rigid) -> Shape {
    Shape { geometry, color_rgba, body_from_shape: at.pose() }
}

fn scene() -> Scene {
    let mut bodies = Vec::new();
    for (path, color, accent) in [
        ("arm/true", [150, 150, 150, 110], [150, 150, 150, 110]),
        ("arm/exaggerated", [235, 110, 30, 255], [60, 60, 65, 255]),
    ] {
        let links = world_from_links(&joint_angles(0.0, 1.0));
        for (index, shapes) in link_shapes(color, accent).into_iter().enumerate() {
            let initial_pose = links[index].pose();
            bodies.push(Body { path: format!("{path}/link_{index}"), shapes, initial_pose });
        }
    }
    let flange = world_from_links(&joint_angles(0.0, 1.0))[7];
    let x = [1.0, 0.0, 0.0];
    let plate = [(0.021, 0.0), (0.25, 0.0), (0.25, 0.03), (0.022, 0.03), (0.021, 0.029)];
    bodies.push(Body {
        path: "workpiece".into(),
        shapes: vec![shape(Geometry::revolved(&plate, 64), [120, 150, 190, 255], Rigid::new([0.0; 3], x, 0.0))],
        initial_pose: flange.then(Rigid::new([0.0, 0.0, TOOL_M], x, 0.0)).pose(),
    });
    let arrow = |path: &str, label: &str, color_rgba| Arrow {
        path: path.into(),
        label: label.into(),
        color_rgba,
        metres_per_newton: 0.004,
    };
    Scene {
        bodies,
        arrows: vec![
            arrow("force/cutting", "cutting force on the tool", [255, 220, 60, 255]),
            arrow("force/friction", "friction on the foot", [90, 220, 255, 255]),
        ],
        deflection_scale: SCALE,
        camera: None,
    }
}

fn link_shapes(main: [u8; 4], dark: [u8; 4]) -> Vec<Vec<Shape>> {
    let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let none = Rigid::new([0.0; 3], z, 0.0);
    let at = |p| Rigid::new(p, z, 0.0);
    let across = Rigid::new([0.0; 3], x, 0.25 * TAU);
    let cylinder = |radius_m, length_m| Geometry::Cylinder { radius_m, length_m };
    let foot = [(0.034, 0.0), (0.045, 0.0), (0.045, 0.12), (0.034, 0.12)];
    let cutter = [(0.0, 0.0), (0.010, 0.0), (0.024, -0.014), (0.024, -0.10), (0.0, -0.10)];
    vec![
        vec![shape(cylinder(0.35, 0.35), dark, at([0.0, 0.0, 0.175]))],
        vec![
            shape(cylinder(0.30, 0.40), main, at([0.0, 0.0, -0.23])),
            shape(Geometry::Box { half_extents_m: [0.22, 0.20, 0.22] }, main, at([0.18, 0.0, 0.0])),
        ],
        vec![
            shape(cylinder(0.20, 0.42), dark, across),
            shape(Geometry::Capsule { radius_m: 0.14, length_m: 1.075 }, main, at([0.0, 0.0, 0.5375])),
        ],
        vec![
            shape(cylinder(0.17, 0.38), dark, across),
            shape(Geometry::Box { half_extents_m: [0.17, 0.15, 0.25] }, main, at([-0.15, 0.0, 0.1])),
            shape(Geometry::Capsule { radius_m: 0.11, length_m: 0.75 }, main, at([-0.2, 0.0, 0.70])),
        ],
        vec![shape(cylinder(0.10, 0.20), dark, at([0.0, 0.0, -0.12]))],
        vec![shape(Geometry::Sphere { radius_m: 0.12 }, main, none)],
        vec![shape(cylinder(0.09, 0.10), dark, at([0.0, 0.0, 0.15]))],
        vec![
            shape(cylinder(0.07, 0.18), main, at([0.0, 0.0, 0.09])),
            shape(Geometry::revolved(&cutter, 32), [200, 200, 210, main[3]], at([0.0, 0.0, TOOL_M])),
            shape(Geometry::revolved(&foot, 32), [90, 200, 230, main[3]], at([0.0, 0.0, TOOL_M - 0.12])),
        ],
    ]
}

fn frame(t: f64) -> Frame {
    let still = world_from_links(&joint_angles(t, 1.0));
    let moved = world_from_links(&joint_angles(t, SCALE));
    let start = world_from_links(&joint_angles(0.0, 1.0));
    let workpiece = start[7].then(Rigid::new([0.0, 0.0, TOOL_M], [1.0, 0.0, 0.0], 0.0));
    let mut poses: Vec<Pose> = still.iter().chain(&moved).map(Rigid::pose).collect();
    poses.push(workpiece.pose());
    let tip = moved[7].apply([0.0, 0.0, TOOL_M]);
    let [fx, fy, fz] = cutting_force_n(t);
    let cutting = start[7].rotate([fy, fz, fx]);
    let friction = start[7].rotate([-0.65 * fy, -0.65 * fz, 0.0]);
    Frame { time_s: t, poses, arrows: vec![(tip, cutting), (tip, friction)] }
}
