//! Arms drawn from a seed: chain, masses, limits, transmissions, servos, forces.

use std::fmt::Write;
use std::path::Path;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use truecut_arm::MAX_JOINTS;

pub struct Drawn {
    pub seed: u64,
    /// Its scenario; arm and robot.toml lie beside it.
    pub scenario: String,
    /// How its joints are driven.
    pub drive: &'static str,
    /// Whether a joint has dry friction, so that it may stick.
    pub sticks: bool,
    /// What it is, for a report.
    pub told: String,
}

struct Draw(ChaCha8Rng);

impl Draw {
    fn share(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Evenly over decades.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.share())
    }

    fn chance(&mut self, of: f64) -> bool {
        self.share() < of
    }

    /// Below that number.
    fn up_to(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-size, size))
    }

    fn turn(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.vector(2.0))
    }
}

/// A rigid body: mass, centre, inertia about it.
struct Body {
    mass_kg: f64,
    centre_m: Vector3<f64>,
    inertia_kg_m2: Matrix3<f64>,
}

/// Masses over five decades, inertias from a needle to a disc, about any axes.
fn body(draw: &mut Draw) -> Body {
    let mass_kg = draw.decades(0.01, 500.0);
    let (a, b) = (draw.decades(0.01, 0.4), draw.decades(0.01, 0.4));
    // Principal moments as a body's are: none more than the sum of the others.
    let (a, b) = (mass_kg * a * a, mass_kg * b * b);
    let c = draw.between((a - b).abs() * 1.000_001, a + b);
    let turn = draw.turn().to_rotation_matrix();
    let inertia = turn * Matrix3::from_diagonal(&Vector3::new(a, b, c)) * turn.inverse();
    Body {
        mass_kg,
        centre_m: draw.vector(0.3),
        inertia_kg_m2: inertia,
    }
}

fn triple(v: &Vector3<f64>) -> String {
    format!("{:?} {:?} {:?}", v.x, v.y, v.z)
}

/// What is drawn of the chain, joint by joint.
#[derive(Default)]
struct Files {
    urdf: String,
    toml: String,
    posture_deg: Vec<f64>,
    posture_mm: Vec<f64>,
    sticks: bool,
    weight_n: f64,
}

/// What all joints of a robot have in common.
struct Traits {
    is_singular: bool,
    /// Narrow limits, close to which it works.
    is_narrow: bool,
    /// The joint that stands at one of its limits.
    at_limit: Option<usize>,
    /// Share of servos that saturate under gravity or soon after.
    weak: f64,
}

/// The robot's files in the folder, and its scenario.
pub fn draw(seed: u64, folder: &Path) -> Drawn {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let joints = 1 + draw.up_to(MAX_JOINTS);
    let bodies: Vec<Body> = (0..joints).map(|_| body(&mut draw)).collect();
    let drive = match draw.share() {
        ..0.5 => "position",
        ..0.9 => "servo",
        _ => "force",
    };
    let mut chosen = |of: f64| draw.chance(of).then(|| draw.up_to(joints));
    let at_limit = chosen(0.1).map(|joint| joint + 1);
    let traits = Traits {
        is_singular: draw.chance(0.2),
        is_narrow: draw.chance(0.1),
        at_limit,
        weak: if draw.chance(0.2) { 0.5 } else { 0.0 },
    };
    let mut files = Files {
        urdf: "<robot name=\"drawn\">\n<link name=\"l0\"/>\n".to_owned(),
        weight_n: 9.81 * bodies.iter().map(|body| body.mass_kg).sum::<f64>(),
        ..Files::default()
    };
    for number in 1..=joints {
        joint(
            &mut draw,
            &mut files,
            number,
            &traits,
            &bodies[number - 1..],
        );
    }
    files.urdf.push_str("</robot>\n");
    std::fs::write(folder.join("arm.urdf"), &files.urdf).unwrap();
    std::fs::write(folder.join("robot.toml"), &files.toml).unwrap();
    let sticks = files.sticks && drive != "force";
    Drawn {
        seed,
        scenario: scenario(&mut draw, &files, drive),
        drive,
        sticks,
        told: format!(
            "{joints} joints, {drive}, singular {}, narrow {}, sticks {sticks}, at limit {at_limit:?}, weak {}",
            traits.is_singular, traits.is_narrow, traits.weak
        ),
    }
}

/// A joint with its link; the first of `carried` is that link's body. A singular posture has axes
/// that are parallel or at right angles.
fn joint(draw: &mut Draw, files: &mut Files, number: usize, traits: &Traits, carried: &[Body]) {
    let is_singular = traits.is_singular;
    let is_slide = draw.chance(0.2);
    let axis = match is_singular || draw.chance(0.4) {
        true => Vector3::ith(draw.up_to(3), 1.0),
        false => (draw.vector(1.0) + Vector3::new(0.0, 0.0, 1e-3)).normalize(),
    };
    let origin = match draw.chance(0.2) {
        true => Vector3::zeros(),
        false => draw.vector(0.5),
    };
    let rpy = match is_singular {
        true => Vector3::zeros(),
        false => draw.vector(3.0),
    };
    // In the unit of the scenario, so that a joint at its limit is there to the bit.
    let reach = if is_slide { 500.0 } else { 170.0 };
    let q = if is_singular {
        0.0
    } else {
        draw.between(-reach, reach)
    };
    let q_si = if is_slide { q / 1e3 } else { q.to_radians() };
    let room = |draw: &mut Draw| match traits.is_narrow {
        true => draw.decades(0.02, 0.3),
        false => draw.decades(0.5, 6.0),
    };
    let mut limits = (q_si - room(draw), q_si + room(draw));
    if traits.at_limit == Some(number) {
        let is_lower = draw.chance(0.5);
        *(if is_lower {
            &mut limits.0
        } else {
            &mut limits.1
        }) = q_si;
    }
    let kind = if is_slide { "prismatic" } else { "revolute" };
    let _ = writeln!(
        files.urdf,
        "<joint name=\"j{number}\" type=\"{kind}\"><parent link=\"l{}\"/><child link=\"l{number}\"/>\
         <origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/>\
         <limit lower=\"{:?}\" upper=\"{:?}\" velocity=\"0\" effort=\"0\"/></joint>",
        number - 1,
        triple(&origin),
        triple(&rpy),
        triple(&axis),
        limits.0,
        limits.1,
    );
    files.urdf.push_str(&link(number, &carried[0]));
    files.sticks |= transmission(
        draw,
        &mut files.toml,
        (number, is_slide, traits.weak),
        carried,
    );
    match is_slide {
        true => files.posture_mm.push(q),
        false => files.posture_deg.push(q),
    }
}

/// A link with its mass.
fn link(number: usize, body: &Body) -> String {
    let i = &body.inertia_kg_m2;
    format!(
        "<link name=\"l{number}\"><inertial><origin xyz=\"{}\"/><mass value=\"{:?}\"/>\
         <inertia ixx=\"{:?}\" iyy=\"{:?}\" izz=\"{:?}\" ixy=\"{:?}\" ixz=\"{:?}\" iyz=\"{:?}\"/></inertial></link>\n",
        triple(&body.centre_m),
        body.mass_kg,
        i[(0, 0)],
        i[(1, 1)],
        i[(2, 2)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 2)],
    )
}

/// Transmission and servo, sized for what the joint carries; whether it has dry friction.
fn transmission(
    draw: &mut Draw,
    toml: &mut String,
    (k, is_slide, weak): (usize, bool, f64),
    carried: &[Body],
) -> bool {
    let mass_kg: f64 = carried.iter().map(|body| body.mass_kg).sum();
    // Of what it moves: as if all of it stood half a metre off, at least that of the body itself.
    let moved = if is_slide { mass_kg } else { mass_kg * 0.25 };
    let turning_rad_s = std::f64::consts::TAU * draw.decades(2.0, 60.0);
    let stiffness = moved * turning_rad_s * turning_rad_s;
    let damping = 2.0 * draw.decades(0.003, 0.3) * moved * turning_rad_s;
    let gravity = 9.81 * if is_slide { mass_kg } else { mass_kg * 0.5 };
    let friction = if draw.chance(0.15) {
        gravity * draw.decades(0.01, 1.0)
    } else {
        0.0
    };
    let rotor = moved * draw.decades(0.01, 3.0);
    // Weak servos saturate under gravity or soon after.
    let limit = gravity
        * if draw.chance(weak) {
            draw.between(0.2, 1.2)
        } else {
            draw.between(3.0, 20.0)
        };
    let bandwidth_rad_s = draw.decades(20.0, 300.0);
    let units = match is_slide {
        true => [
            "stiffness_n_per_m",
            "damping_n_s_per_m",
            "dry_friction_n",
            "rotor_mass_kg",
            "velocity_gain_n_s_per_m",
            "force_limit_n",
            "linear_to_m",
        ],
        false => [
            "stiffness_nm_per_rad",
            "damping_nm_s_per_rad",
            "dry_friction_nm",
            "rotor_inertia_kg_m2",
            "velocity_gain_nm_s_per_rad",
            "torque_limit_nm",
            "linear_to_rad",
        ],
    };
    let values = [stiffness, damping, friction, rotor];
    let _ = writeln!(toml, "[[joint]]\nname = \"j{k}\"");
    for (name, value) in units.iter().zip(values) {
        let _ = writeln!(toml, "{name} = {value:?}");
    }
    let _ = writeln!(
        toml,
        "{} = 10\n[joint.servo]\nposition_gain_per_s = {:?}\n{} = {:?}\n{} = {limit:?}\n[joint.source]\n\
         stiffness = \"drawn\"\nlinear_to = \"drawn: everywhere\"\ndamping = \"drawn\"\ndry_friction = \"drawn\"\nrotor_inertia = \"drawn\"\nservo = \"drawn\"",
        units[6],
        bandwidth_rad_s / 10.0,
        units[4],
        bandwidth_rad_s * rotor,
        units[5],
    );
    friction > 0.0
}

/// A chain without drives, friction and limits, the first axis of which is vertical: its energy and
/// its angular momentum about that axis stay as they are. The scenario of its fall.
pub fn draw_falling(seed: u64, folder: &Path) -> String {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    // One joint alone would turn about the vertical, which nothing makes it do.
    let joints = 2 + draw.up_to(MAX_JOINTS - 1);
    let mut urdf = "<robot name=\"drawn\">\n<link name=\"l0\"/>\n".to_owned();
    let mut posture_deg = Vec::new();
    for number in 1..=joints {
        let axis = match number {
            1 => Vector3::z(),
            _ => (draw.vector(1.0) + Vector3::new(0.0, 0.0, 1e-3)).normalize(),
        };
        let head = format!(
            "<joint name=\"j{number}\" type=\"continuous\"><parent link=\"l{}\"/><child link=\"l{number}\"/>\
             <origin xyz=\"{}\"/><axis xyz=\"{}\"/></joint>\n",
            number - 1,
            triple(&draw.vector(0.5)),
            triple(&axis),
        );
        urdf.push_str(&head);
        urdf.push_str(&link(number, &body(&mut draw)));
        posture_deg.push(format!("{:?}", draw.between(-170.0, 170.0)));
    }
    urdf.push_str("</robot>\n");
    std::fs::write(folder.join("arm.urdf"), &urdf).unwrap();
    format!(
        "name = \"falling\"\n[robot]\nurdf = \"arm.urdf\"\nposture_deg = [{}]\ndrive = \"force\"\n\
         [run]\nduration_s = {:?}\nplaceholders = \"warn\"\n[process.load]\n",
        posture_deg.join(", "),
        draw.decades(0.1, 0.6),
    )
}

fn scenario(draw: &mut Draw, files: &Files, drive: &str) -> String {
    let list = |values: &[f64]| {
        let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        format!("[{}]", values.join(", "))
    };
    let force = |draw: &mut Draw| {
        let size = files.weight_n * draw.decades(0.01, 1.0);
        let force = draw.vector(size);
        list(force.as_slice())
    };
    let mut loads = String::new();
    if draw.chance(0.5) {
        let _ = writeln!(loads, "release_n = {}", force(draw));
    }
    if draw.chance(0.5) {
        let _ = writeln!(loads, "constant_n = {}", force(draw));
    }
    if draw.chance(0.4) {
        let (from, to) = (draw.between(0.0, 5.0), draw.between(6.0, 80.0));
        let _ = writeln!(
            loads,
            "sweep = {{ amplitude_n = {}, from_hz = {from:?}, to_hz = {to:?} }}",
            force(draw)
        );
    }
    let is_weightless = draw.chance(0.2);
    format!(
        "name = \"drawn\"\n[robot]\nurdf = \"arm.urdf\"\nconfig = \"robot.toml\"\nposture_deg = {}\nposture_mm = {}\ndrive = \"{drive}\"\ngravity = {}\n\
         [run]\nduration_s = {:?}\noverload = \"warn\"\nplaceholders = \"warn\"\n[process.load]\n{loads}",
        list(&files.posture_deg),
        list(&files.posture_mm),
        !is_weightless,
        draw.decades(0.1, 0.6)
    )
}
