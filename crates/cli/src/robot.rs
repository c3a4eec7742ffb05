//! `truecut robot`: a robot as read from its files, and `truecut robot init`.

use std::path::{Path, PathBuf};

use truecut::outputs::write_file;
use truecut_arm::estimate::{DataSheet, robot_toml};
use truecut_arm::report::{
    fk_table, ik_csv, ik_rows, other_units_note, outside_limits_note, poses,
};
use truecut_arm::{ArmErrorKind, CONFIG_FILE_NAME, JointKind, Masses, Robot, expanded_urdf};
use truecut_recording::significant;

use crate::args::{InitArguments, RobotArguments, RobotCommand};
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::text;

/// Prints the report, as text or JSON, a table of poses or postures, or the URDF; or writes a
/// `robot.toml`.
pub fn robot(arguments: &RobotArguments) -> Result<ExitStatus, Failure> {
    match (&arguments.command, &arguments.urdf) {
        (Some(RobotCommand::Init(init)), _) => write_estimate(init),
        (None, Some(urdf)) => describe(arguments, urdf),
        (None, None) => Err(Failure::message("no robot file is given")),
    }
}

fn describe(arguments: &RobotArguments, urdf: &Path) -> Result<ExitStatus, Failure> {
    let source = &arguments.source;
    let config = arguments.config.as_ref();
    if arguments.urdf_text {
        let text = expanded_urdf(urdf, &source.packages(), &source.arguments());
        return crate::print(&text.map_err(|error| Failure::arm(&error))?);
    }
    let read = |masses| Robot::read(urdf, &source.reading(config, masses));
    let kinematics = || read(Masses::NotNeeded).map_err(|error| Failure::arm(&error));
    if let Some(asked) = &arguments.fk {
        let (text, name) = written_or_file(asked, "--fk")?;
        let failed = |error| Failure::message(format!("{name}: {error}"));
        let robot = with_slides(kinematics()?, arguments.slide_mm.as_deref())?;
        let table = fk_table(&robot, &text).map_err(failed)?;
        if let Some(note) = outside_limits_note(&robot, &text).map_err(failed)? {
            // Beside the table, not in it.
            eprintln!("note: {name}: {note}");
        }
        return crate::print(&table);
    }
    if let Some(asked) = &arguments.ik {
        let slides = arguments.slide_mm.as_deref();
        let robot = with_slides(kinematics()?, slides)?;
        if slides.is_none() && robot.slides().count() > 0 {
            eprintln!(
                "note: slides of the arm move, so that postures are samples of many; --slide-mm puts \
                 them at a place"
            );
        }
        return print_postures(&robot, asked, arguments);
    }
    if arguments.slide_mm.is_some() {
        return Err(Failure::with_help(
            "--slide-mm is for --fk and --ik",
            "--posture-deg has a value for each joint, slides included",
        ));
    }
    let robot = match read(Masses::Needed) {
        Err(error) if matches!(error.kind(), ArmErrorKind::MasslessMovingLink { .. }) => {
            kinematics()?
        }
        other => other.map_err(|error| Failure::arm(&error))?,
    };
    let posture = match &arguments.posture_deg {
        Some(written) => posture(&robot, written)?,
        None => robot.default_posture(),
    };
    let report = robot
        .report(&posture)
        .map_err(|error| Failure::arm(&error))?;
    if arguments.json {
        return crate::print(&text::json(&report)?);
    }
    crate::print(&report.to_text())
}

/// Numbers on the command line, or what a file has, and what they are called.
fn written_or_file(asked: &str, option: &str) -> Result<(String, String), Failure> {
    let file = Path::new(asked);
    let is_written = asked.contains(',') || asked.trim().parse::<f64>().is_ok();
    if is_written && !file.exists() {
        return Ok((asked.to_owned(), option.to_owned()));
    }
    let text = truecut_files::read_text(file).map_err(|error| Failure::at(file, error))?;
    Ok((text, file.display().to_string()))
}

/// The postures for a pose on the command line, or for those of a file.
fn print_postures(
    robot: &Robot,
    asked: &str,
    arguments: &RobotArguments,
) -> Result<ExitStatus, Failure> {
    let (text, name) = written_or_file(asked, "--ik")?;
    let failed = |error| Failure::message(format!("{name}: {error}"));
    let poses = poses(&text).map_err(failed)?;
    if let Some(note) = other_units_note(robot, &text).map_err(failed)? {
        // Beside the table, not in it.
        eprintln!("note: {name}: {note}");
    }
    let rows = ik_rows(robot, &poses, arguments.frame.into());
    let is_reached = |pose: usize| rows.iter().any(|row| row.pose == pose && row.within_limits);
    let missed: Vec<usize> = (1..=poses.len()).filter(|it| !is_reached(*it)).collect();
    let status = match missed.first() {
        None => ExitStatus::Good,
        Some(first) => {
            let place = poses[first - 1].translation.vector;
            eprintln!(
                "note: {} of {} poses have no posture within limits, the first of them pose {first}, at ({}, {}, {}) m",
                missed.len(),
                poses.len(),
                significant(place.x, 4),
                significant(place.y, 4),
                significant(place.z, 4)
            );
            ExitStatus::ClaimFailed
        }
    };
    if arguments.json {
        crate::print(&text::json(&rows)?)?;
    } else {
        crate::print(&ik_csv(robot, &rows))?;
    }
    Ok(status)
}

fn write_estimate(init: &InitArguments) -> Result<ExitStatus, Failure> {
    let out: PathBuf = match &init.out {
        Some(out) => out.clone(),
        None => init.urdf.with_file_name(CONFIG_FILE_NAME),
    };
    if out.exists() && !init.force {
        return Err(Failure::with_help(
            format!("{} is there already", out.display()),
            "write another file with --out, or over it with --force",
        ));
    }
    let sheet = DataSheet {
        mass_kg: init.mass,
        payload_kg: init.payload,
        reach_m: init.reach,
        repeatability_mm: init.repeatability,
    };
    let source = &init.source;
    let (packages, arguments) = (source.packages(), source.arguments());
    let tip = source.tip.as_deref();
    let estimated = robot_toml(&init.urdf, tip, &packages, &arguments, sheet)
        .map_err(|error| Failure::arm(&error))?;
    Failure::if_read(&out)?;
    write_file(&out, estimated.text.as_bytes())?;
    let notes = estimated.notes.iter();
    let notes: String = notes.map(|note| format!("  note: {note}\n")).collect();
    crate::print(&format!(
        "{}\n{notes}  every value in it is estimated, by the rule that it states\n  \
         look at it: truecut robot {}{} --config {}\n",
        out.display(),
        init.urdf.display(),
        source.as_options(),
        out.display()
    ))
}

/// Degrees to radians for rotary joints, millimetres to metres for prismatic ones.
pub fn posture(robot: &Robot, written: &[f64]) -> Result<Vec<f64>, Failure> {
    let joints = &robot.chain.joints;
    if written.len() != joints.len() {
        return Err(Failure::with_help(
            format!(
                "--posture-deg has {} values, but the chain has {} joints",
                written.len(),
                joints.len()
            ),
            "one value for each joint, slides included, but for those that --slide-mm puts at a place",
        ));
    }
    let si = |(joint, value): (&truecut_arm::Joint, &f64)| match joint.kind {
        JointKind::Revolute => value.to_radians(),
        JointKind::Prismatic => value / 1e3,
    };
    Ok(joints.iter().zip(written).map(si).collect())
}

/// The arm with its slides where the option has them, mm; as it is without the option.
pub fn with_slides(robot: Robot, places_mm: Option<&[f64]>) -> Result<Robot, Failure> {
    let Some(places_mm) = places_mm else {
        return Ok(robot);
    };
    let count = robot.slides().count();
    if places_mm.len() != count {
        return Err(Failure::message(format!(
            "--slide-mm has {} values, but the arm has {count} slides",
            places_mm.len()
        )));
    }
    let places_m: Vec<f64> = places_mm.iter().map(|place| place / 1e3).collect();
    (robot.with_slides_at(&places_m)).map_err(|error| Failure::message(error.message()))
}

/// Joints that turn of an arm that follows a file: a pose asks for as many.
const OF_A_POSE: usize = 6;

/// Refuses an arm with slides whose other joints are too few for a pose: they follow a file alone.
pub fn unless_gantry(robot: &Robot, urdf: &Path) -> Result<(), Failure> {
    let slides = robot.slides().count();
    let turning = robot.dof() - slides;
    if slides == 0 || turning >= OF_A_POSE {
        return Ok(());
    }
    let text = format!(
        "the arm has {slides} slides and {turning} joints that turn, but must have at least {OF_A_POSE} that turn: \
         they follow a file alone, with the slides at rest; a gantry follows no file"
    );
    Err(Failure::at(urdf, text))
}

/// What a reader of a robot program must know of slides, by their places in m.
pub fn slides_note(places_m: &[f64]) -> String {
    let places = places_m
        .iter()
        .map(|place| format!("{:.1} mm", place * 1e3));
    format!(
        "slides of the arm stand still at {}: the program does not drive them; frames are those of the world",
        places.collect::<Vec<_>>().join(", ")
    )
}

/// The same by an option, mm; none without it.
pub fn of_slides(places_mm: Option<&[f64]>) -> Option<String> {
    let places_mm = places_mm?.iter().map(|place| place / 1e3);
    Some(slides_note(&places_mm.collect::<Vec<_>>()))
}

/// What a reader must know of an arm without a `robot.toml`.
pub fn without_tool(robot: &Robot) -> Option<String> {
    let what = match &robot.config_path {
        None => format!("there is no {CONFIG_FILE_NAME} beside the URDF and no --config"),
        Some(file) if robot.frames.flange_from_tool == nalgebra::Isometry3::identity() => {
            format!("{} gives no tool frame", file.display())
        }
        Some(_) => return None,
    };
    Some(format!(
        "{what}: the tool point is the flange's, no tool is known"
    ))
}
