//! `truecut new`: a scenario of one's own robot that runs, to begin with.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use truecut::outputs::write_file;
use truecut_arm::{FrameId, Joint, JointKind, Limits, Masses, Packages, Reading, Robot};
use truecut_scenario::{Scenario, named_from};
use truecut_sim::run::Run;

use crate::args::{NewArguments, ProcessName};
use crate::exit_status::ExitStatus;
use crate::failure::Failure;

const HEAD: &str = include_str!("new/head.toml");

/// How the tool may be turned about its axis, in degrees.
const TURNS: [f64; 4] = [0.0, 90.0, 180.0, 270.0];

/// How many postures and places are looked at.
const TRIALS: usize = 400;

/// Writes the scenario, once one is found that can run.
pub fn new(arguments: &NewArguments) -> Result<ExitStatus, Failure> {
    if arguments.out.exists() {
        return Err(Failure::with_help(
            format!("{} is there already", arguments.out.display()),
            "write another file with --out",
        ));
    }
    let place_leads = matches!(
        arguments.process,
        ProcessName::Milling | ProcessName::Polish
    );
    refuse_idle(arguments, place_leads)?;
    let reading = Reading {
        config: arguments.config.as_deref(),
        masses: Masses::Needed,
        packages: Packages::from_environment([]),
        arguments: arguments.arguments.iter().cloned().collect(),
        ..Reading::default()
    };
    let robot = Robot::read(&arguments.robot, &reading).map_err(|error| Failure::arm(&error))?;
    check_count(arguments, &robot)?;
    let mut last: Option<String> = None;
    let mut is_one = true;
    for start in starts(arguments, &robot, place_leads) {
        let text = filled(arguments, &robot, &start)?;
        let scenario = Scenario::from_str(&arguments.out, &text, &[])?;
        match Run::of(&scenario)
            .check()
            .map_err(|error| error.to_string())
        {
            Ok(()) => {
                write_file(&arguments.out, text.as_bytes())?;
                let shown = arguments.out.display();
                return crate::print(&format!("  {shown}   (run it: truecut run {shown})\n"));
            }
            Err(fault) => {
                is_one &= last.as_ref().is_none_or(|last| *last == fault);
                last = Some(fault);
            }
        }
    }
    let is_given = arguments.posture_deg.is_some() || arguments.place_mm.is_some();
    if let Some(fault) = last.as_ref().filter(|_| is_given) {
        return Err(Failure::message(fault));
    }
    if place_leads && let Some(fault) = of_lasting_axis(arguments.process, &robot) {
        return Err(fault);
    }
    // What is wrong everywhere has nothing to do with the start.
    if let Some(fault) = last.as_ref().filter(|_| is_one) {
        return Err(of_every_start(&robot, fault));
    }
    let what = if place_leads {
        "--place-mm"
    } else {
        "--posture-deg"
    };
    let fault = last.unwrap_or_else(|| "there is none".to_owned());
    Err(Failure::with_help(
        format!(
            "no start was found from which the arm can do it; the last that was tried: {fault}"
        ),
        format!("name one with {what}"),
    ))
}

/// A fault that no start changes. There is a command for what a robot's file lacks, and for no
/// more.
fn of_every_start(robot: &Robot, fault: &str) -> Failure {
    let mut joints = robot.chain.joints.iter();
    let lacks =
        robot.config_path.is_none() || joints.any(|joint| joint.transmission.stiffness.is_none());
    match lacks {
        true => Failure::with_help(
            fault,
            "what a robot's file lacks goes into robot.toml: truecut robot init FILE --payload KG",
        ),
        false => Failure::message(format!("{fault} (so from every start that was tried)")),
    }
}

/// Each option that is given has a use.
fn refuse_idle(arguments: &NewArguments, place_leads: bool) -> Result<(), Failure> {
    let idle = match place_leads {
        true => arguments.posture_deg.is_some().then_some("--posture-deg"),
        false => arguments.place_mm.is_some().then_some("--place-mm"),
    };
    if let Some(name) = idle {
        let leads = if place_leads {
            "a place leads the tool"
        } else {
            "a posture leads the tool"
        };
        return Err(Failure::message(format!(
            "{name} has no effect here: {leads}"
        )));
    }
    if let Some(place) = arguments.place_mm.as_ref().filter(|place| place.len() != 3) {
        let text = format!(
            "--place-mm has {} numbers, but must have three",
            place.len()
        );
        return Err(Failure::message(text));
    }
    Ok(())
}

/// A posture has a value for each joint.
fn check_count(arguments: &NewArguments, robot: &Robot) -> Result<(), Failure> {
    let joints = robot.dof();
    match &arguments.posture_deg {
        Some(given) if given.len() != joints => Err(Failure::message(format!(
            "--posture-deg has {} values, but the chain has {joints} joints, slides included",
            given.len()
        ))),
        _ => Ok(()),
    }
}

/// Where the tool begins.
enum Start {
    /// Of the joints, in degrees or mm.
    Posture(Vec<f64>),
    /// In the world, mm, and how the tool is turned about its axis, in degrees.
    Place([f64; 3], f64),
}

/// What is given, or what is worth a try, best first.
fn starts(arguments: &NewArguments, robot: &Robot, place_leads: bool) -> Vec<Start> {
    if let Some(given) = &arguments.posture_deg {
        return vec![Start::Posture(given.clone())];
    }
    if let Some([x, y, z]) = arguments.place_mm.as_deref() {
        return TURNS.map(|turn| Start::Place([*x, *y, *z], turn)).into();
    }
    let mut drawn = postures(robot);
    if place_leads {
        // The tool works from above; where it hangs over the floor in a good posture is in reach.
        let places = drawn.into_iter().flat_map(|posture| {
            let tool = robot.world_from_frame(&posture, FrameId::Tool).translation;
            let mm = [tool.x, tool.y, tool.z].map(|value| (1e2 * value).round() * 10.0);
            TURNS.map(|turn| Start::Place(mm, turn))
        });
        let above = |start: &Start| matches!(start, Start::Place([_, _, z], _) if *z > 0.0);
        return places.filter(above).take(TRIALS).collect();
    }
    drawn.truncate(TRIALS / 10);
    let shown = |posture: Vec<f64>| {
        let values = posture.iter().zip(&robot.chain.joints);
        let values = values.map(|(value, joint)| match joint.kind {
            JointKind::Prismatic => (1e3 * value).round(),
            JointKind::Revolute => value.to_degrees().round(),
        });
        Start::Posture(values.collect())
    };
    drawn.into_iter().map(shown).collect()
}

/// Why an arm whose joints do not turn the tool's axis cannot do it, if that is why.
fn of_lasting_axis(process: ProcessName, robot: &Robot) -> Option<Failure> {
    let [x, y, z] = lasting_axis(robot)?;
    let lasts = format!("is ({x:.3}, {y:.3}, {z:.3}) in every posture of this arm");
    if z > -0.999 {
        return Some(Failure::with_help(
            format!("the tool cannot work from above: its z axis {lasts}"),
            "rpy_deg of [frames.tool] in robot.toml turns the tool against the flange: its z axis \
             points into the workpiece",
        ));
    }
    matches!(process, ProcessName::Polish).then(|| {
        Failure::message(format!(
            "polishing leans the wheel and leads the lean round, but the tool's z axis {lasts}"
        ))
    })
}

/// The tool's z axis in the world where no joint turns it, as on arms that move parts from above.
fn lasting_axis(robot: &Robot) -> Option<[f64; 3]> {
    let axis = |posture: &Vec<f64>| {
        let tool = robot.world_from_frame(posture, FrameId::Tool);
        tool.rotation * Vector3::z()
    };
    let axes: Vec<Vector3<f64>> = postures(robot).iter().map(axis).collect();
    let first = *axes.first()?;
    let lasts = axes.iter().all(|axis| (axis - first).norm() < 1e-6);
    lasts.then(|| first.into())
}

/// Postures within the middle of the limits, the best conditioned first.
fn postures(robot: &Robot) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut share = || (random.next_u64() >> 11) as f64 * 2f64.powi(-53);
    let mut drawn: Vec<(f64, Vec<f64>)> = (0..TRIALS)
        .map(|_| {
            let joints = robot.chain.joints.iter();
            let posture: Vec<f64> = joints
                .map(|joint| {
                    let (low, high) = joint.limits.map_or((-2.0, 2.0), |l| {
                        let near = (l.lower.max(-2.0), l.upper.min(2.0));
                        // A range that is far from zero has nothing near it.
                        if near.0 < near.1 { near } else { range(&l) }
                    });
                    low + (0.2 + 0.6 * share()) * (high - low)
                })
                .collect();
            let jacobian = robot.jacobian(&posture, FrameId::Tool);
            let values = jacobian.singular_values();
            (values.min() / values.max(), posture)
        })
        .collect();
    drawn.sort_by(|a, b| b.0.total_cmp(&a.0));
    drawn.into_iter().map(|(_, posture)| posture).collect()
}

/// The limits of a joint; where one is not given, 4 rad or 4 m from the other, a range as wide as
/// that in which postures are looked for.
fn range(limits: &Limits) -> (f64, f64) {
    let (low, high) = (limits.lower, limits.upper);
    match (low.is_finite(), high.is_finite()) {
        (true, false) => (low, low + 4.0),
        (false, true) => (high - 4.0, high),
        (true, true) => (low, high),
        (false, false) => (-2.0, 2.0),
    }
}

/// Where an arm begins that a place leads, as a scenario gives it: at zero, which needs no word. A
/// joint that cannot stand there stands in the middle of its range, far from its limits.
fn resting_keys(robot: &Robot) -> String {
    let rests = |joint: &Joint| -> f64 {
        let at_zero = |own: &Limits| (own.lower..=own.upper).contains(&0.0);
        let Some(limits) = joint.limits.filter(|own| !at_zero(own)) else {
            return 0.0;
        };
        let scale = match joint.kind {
            JointKind::Prismatic => 1e3,
            JointKind::Revolute => 1_f64.to_degrees(),
        };
        let (low, high) = range(&limits);
        let (low, high) = (scale * low, scale * high);
        let middle = 0.5 * (low + high);
        // A range of less than a millimetre or a degree may have no whole number in it.
        let is_inside = low < middle.round() && middle.round() < high;
        if is_inside { middle.round() } else { middle }
    };
    let values: Vec<f64> = robot.chain.joints.iter().map(rests).collect();
    match values.iter().all(|value| *value == 0.0) {
        true => String::new(),
        false => posture_keys(robot, &values),
    }
}

/// Where the joints stand, degrees or mm in chain order, as a scenario gives it: slides apart.
fn posture_keys(robot: &Robot, values: &[f64]) -> String {
    let of = |kind: JointKind| -> Vec<f64> {
        let joints = robot.chain.joints.iter().zip(values);
        let joints = joints.filter(|(joint, _)| joint.kind == kind);
        joints.map(|(_, value)| *value).collect()
    };
    [("deg", JointKind::Revolute), ("mm", JointKind::Prismatic)]
        .map(|(unit, kind)| (unit, of(kind)))
        .into_iter()
        .filter(|(_, values)| !values.is_empty())
        .map(|(unit, values)| format!("\nposture_{unit} = {values:?}"))
        .collect()
}

/// The arguments of the robot's file, as a scenario gives them; nothing where there are none.
fn argument_key(given: &[(String, String)]) -> String {
    if given.is_empty() {
        return String::new();
    }
    // A text of JSON is one of TOML. Of an argument that is given twice the last counts.
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let given: BTreeMap<String, String> = given.iter().cloned().collect();
    let pairs = given
        .iter()
        .map(|(name, value)| format!("{} = {}", quoted(name), quoted(value)));
    let pairs: Vec<String> = pairs.collect();
    format!("\narguments = {{ {} }}", pairs.join(", "))
}

/// The template with everything in its place.
fn filled(arguments: &NewArguments, robot: &Robot, start: &Start) -> Result<String, Failure> {
    let (body, does) = match arguments.process {
        ProcessName::Load => (include_str!("new/load.toml"), "Load"),
        ProcessName::Chamfer => (include_str!("new/chamfer.toml"), "Chamfering"),
        ProcessName::Milling => (include_str!("new/milling.toml"), "Milling"),
        ProcessName::Polish => (include_str!("new/polish.toml"), "Polishing"),
    };
    let folder = arguments
        .out
        .parent()
        .map(|folder| Path::new(".").join(folder));
    let folder = folder.and_then(|folder| folder.canonicalize().ok());
    let file = |path: &Path| {
        let real = path
            .canonicalize()
            .map_err(|error| Failure::at(path, error))?;
        let named = match &folder {
            Some(folder) if path.is_relative() => named_from(folder, &real),
            _ => real,
        };
        let text = named.display().to_string();
        match text.contains('\'') {
            true => Err(Failure::message(format!(
                "{text}: a path with ' cannot be written here"
            ))),
            false => Ok(text),
        }
    };
    let config = match &arguments.config {
        Some(config) => format!("\nconfig = '{}'", file(config)?),
        None => String::new(),
    };
    let named = arguments.name.clone();
    let named = named.unwrap_or_else(|| format!("{does} with {}", robot.chain.name));
    let mut text = format!("{HEAD}{body}")
        .replace("@NAME@", &named.replace(['"', '\\'], "'"))
        .replace("@URDF@", &file(&arguments.robot)?)
        .replace("@CONFIG@", &config)
        .replace("@ARGUMENTS@", &argument_key(&arguments.arguments));
    match start {
        Start::Posture(values) => {
            text = text.replace("@POSTURE@", &posture_keys(robot, values));
        }
        Start::Place(place, turn) => {
            text = text.replace("@POSTURE@", &resting_keys(robot));
            text = text.replace("@TURN@", &format!("{turn:?}"));
            for (key, value) in ["@X@", "@Y@", "@Z@"].iter().zip(place) {
                text = text.replace(key, &format!("{value:?}"));
            }
        }
    }
    Ok(text)
}
