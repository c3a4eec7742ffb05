//! `truecut path` of a CAM file: G-code, APT or poses before an arm.

use std::path::{Path, PathBuf};

use serde_json::Value;
use truecut::outputs::write_file;
use truecut_arm::{JointKind, Robot};
use truecut_plan::cam::{self, CamOptions, CamPath, WorkSetup};
use truecut_plan::clearance::Station;
use truecut_plan::program::{
    Dialect, Motion, Options, Program, ProgramError, Replay, Settings, Start, TravelOptions,
    dialect_named, maker_note, read_text,
};
use truecut_plan::surface_path::joint_cells;
use truecut_recording::{ChannelSpec, Chunk, Header, Outcome, Recording, Sink, Unit};
use truecut_sim::travel_view;
use truecut_telemetry::RrdSink;

use super::files::{slide_cells, slide_heads};
use crate::args::{CamArguments, PathArguments};
use crate::clearance::Checked;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::program::{RunThrough, replayed, run_through};
use crate::progress::Progress;
use crate::robot::{of_slides, posture, with_slides, without_tool};

/// Most frames of the recording.
const FRAMES: usize = 5000;

/// Reads, plans, runs through, prints and writes.
pub fn path(arguments: &PathArguments) -> Result<ExitStatus, Failure> {
    let (file, cam) = (&arguments.file, &arguments.cam);
    let robot = robot(cam, file)?;
    let dialect = dialect(cam)?;
    let settings = settings(cam, dialect)?;
    let cell = cam.cell.as_deref();
    let cell = cell.map(|file| Checked::cell(&robot, file)).transpose()?;
    let text = read_text(file).map_err(|error| Failure::at(file, error))?;
    let options = CamOptions {
        chord_m: cam.chord_mm.unwrap_or(0.01) * 1e-3,
        unit_m: match cam.unit.as_deref() {
            Some("inch") => 0.0254,
            _ => 1e-3,
        },
    };
    let read = cam::read(&text, file, &options).map_err(|error| refused(file, &error))?;
    check_spin(cam, &read, file)?;
    let program = followed(arguments, &robot, dialect, &settings, &read)?;
    let run = |tell: &(dyn Fn(f64) + Sync)| replayed(&program, &robot, file, tell);
    let replay = Progress::of_one("run through", run)?;
    let clearance = cell.map(|cell| {
        let is_rapid = |point: usize| read.points[point].feed_m_per_s.is_none();
        let stations = Station::of_replay(&program, &replay, is_rapid);
        Checked::of(&robot, cell, stations)
    });
    let planned = Planned {
        robot: &robot,
        read: &read,
        program: &program,
        replay: &replay,
        clearance: clearance.as_ref(),
    };
    let written = write(arguments, dialect, &settings, &planned)?;
    let name = |point: usize| {
        let line = read.points[point].line;
        format!("line {line}, path point {point}")
    };
    let status = run_through(&RunThrough {
        robot: &robot,
        program: &program,
        replay: &replay,
        deviation: None,
        clearance: clearance.as_ref(),
        point_name: &name,
        acceleration_m_per_s2: cam.acceleration_m_per_s2,
    })?;
    if let Some((first, rest)) = written.split_first() {
        crate::print(&format!("\n{}", crate::text::written(first, rest)))?;
    }
    Ok(status)
}

/// The program of a path that was read, with what there is to note.
fn followed(
    arguments: &PathArguments,
    robot: &Robot,
    dialect: &dyn Dialect,
    settings: &Settings,
    read: &CamPath,
) -> Result<Program, Failure> {
    let (file, cam) = (&arguments.file, &arguments.cam);
    let posture = start_posture(cam, robot)?;
    let head = head(cam, dialect, settings, robot, file)?;
    let setup = WorkSetup {
        world_from_work: crate::program::frame(cam.work_xyz_mm, cam.work_rpy_deg),
        spin_rad: cam.spin_deg.map(f64::to_radians),
        rapid_m_per_s: cam.rapid_mm_per_s.unwrap_or(250.0) * 1e-3,
        joint_share: cam.joint_speed.unwrap_or(0.25),
        zone_m: cam.zone_mm.map(|mm| mm * 1e-3),
    };
    // Lines may be long: what lies between their ends is looked at when they are run through.
    let travel = TravelOptions {
        largest_step: std::f64::consts::PI,
        ..TravelOptions::default()
    };
    let start = posture.as_deref().map_or(Start::AtRest, Start::Near);
    let program = cam::follow(start, robot, head, read, file, &setup, &travel);
    let mut program = program.map_err(|error| refused(file, &error))?;
    program.notes.extend(without_tool(robot));
    program.notes.extend(maker_note(dialect, robot));
    program
        .notes
        .extend(dialect.limits_note().map(str::to_owned));
    program.notes.extend(of_slides(cam.slide_mm.as_deref()));
    Ok(program)
}

/// What is planned of a file, before it is written.
struct Planned<'a> {
    robot: &'a Robot,
    read: &'a CamPath,
    program: &'a Program,
    replay: &'a Replay,
    clearance: Option<&'a Checked>,
}

fn robot(cam: &CamArguments, file: &Path) -> Result<Robot, Failure> {
    let urdf = cam.robot.as_ref().ok_or_else(|| {
        let text = "a path from CAM needs --robot, the URDF of the arm that follows it";
        Failure::at(file, text)
    })?;
    let robot = Robot::load_kinematics(urdf, cam.config.as_deref(), cam.tip.as_deref())
        .map_err(|error| Failure::arm(&error))?;
    let robot = with_slides(robot, cam.slide_mm.as_deref())?;
    match robot
        .chain
        .joints
        .iter()
        .find(|joint| joint.kind == JointKind::Prismatic)
    {
        None => Ok(robot),
        Some(slide) => Err(Failure::at(
            urdf,
            format!(
                "joint `{}` is a slide: robot programs are written for rotary arms; say with --slide-mm \
                 where it stands",
                slide.name
            ),
        )),
    }
}

/// Refuses a turn about the tool's axis that would change nothing.
fn check_spin(cam: &CamArguments, read: &CamPath, file: &Path) -> Result<(), Failure> {
    match cam.spin_deg {
        Some(deg) if !read.leaves_turn_free() => Err(Failure::with_help(
            format!(
                "{}: --spin-deg {deg} has no effect: the file gives the whole attitude of the tool at \
                 every point",
                file.display()
            ),
            "leave it out; a turn is free where a file gives the tool's axis alone",
        )),
        _ => Ok(()),
    }
}

/// The posture of `--posture-deg`, rad.
fn start_posture(cam: &CamArguments, robot: &Robot) -> Result<Option<Vec<f64>>, Failure> {
    let Some(written) = &cam.posture_deg else {
        return Ok(None);
    };
    let posture = posture(robot, written)?;
    let checked = robot.check_posture(&posture);
    checked.map_err(|error| Failure::message(format!("--posture-deg: {}", error.message())))?;
    Ok(Some(posture))
}

fn dialect(cam: &CamArguments) -> Result<&'static dyn Dialect, Failure> {
    let name = cam.dialect.as_deref().unwrap_or("rapid");
    dialect_named(name).ok_or_else(|| Failure::message(format!("unknown dialect `{name}`")))
}

/// `--option key=value`: values that are numbers or truths are taken as such.
fn settings(cam: &CamArguments, dialect: &dyn Dialect) -> Result<Settings, Failure> {
    let mut options = Options::new();
    for text in &cam.option {
        let (key, value) = text
            .split_once('=')
            .ok_or_else(|| Failure::message(format!("--option {text}: must be like key=value")))?;
        let value = serde_json::from_str::<Value>(value)
            .ok()
            .filter(|value| value.is_number() || value.is_boolean());
        let text = text[key.len() + 1..].to_owned();
        options.insert(key.to_owned(), value.unwrap_or(Value::String(text)));
    }
    dialect.check(&options).map_err(|fault| {
        let help = format!("--option key=value gives an option of {}", dialect.name());
        Failure::with_help(fault.to_string(), help)
    })?;
    Ok(Settings {
        options,
        spindle_signal: cam.spindle_signal.clone(),
        ..Settings::default()
    })
}

fn head(
    cam: &CamArguments,
    dialect: &dyn Dialect,
    settings: &Settings,
    robot: &Robot,
    file: &Path,
) -> Result<Program, Failure> {
    let stem = file
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or("PATH");
    let plain = stem.chars().filter(char::is_ascii_alphanumeric);
    let name: String = plain.take(8).collect::<String>().to_uppercase();
    let tool = dialect.tool(robot, &settings.options);
    Ok(Program {
        name: cam.name.clone().unwrap_or(name),
        comment: String::new(),
        tool: tool.map_err(|fault| Failure::message(fault.to_string()))?,
        world_from_base: crate::program::frame(cam.base_xyz_mm, cam.base_rpy_deg),
        moves: Vec::new(),
        spindle: Vec::new(),
        notes: Vec::new(),
    })
}

/// What is wrong with the file, or where the arm cannot follow it.
fn refused(file: &Path, error: &ProgramError) -> Failure {
    let path = error.path().unwrap_or(file);
    let arm = error.kind().path_point().map(|_| {
        "--work-xyz-mm and --work-rpy-deg place the file before the arm; --spin-deg and \
         --posture-deg choose other postures"
            .to_owned()
    });
    Failure::in_file(Some(path), error.line(), error.message(), arm)
}

/// What a dialect cannot say: at the line that the point comes from.
fn unwritten(file: &Path, read: &CamPath, error: &ProgramError) -> Failure {
    let point = error.kind().path_point();
    let line = point
        .and_then(|at| read.points.get(at))
        .map(|point| point.line);
    let help = line.map(|_| {
        "--posture-deg and --spin-deg choose other postures, --dialect another language".to_owned()
    });
    Failure::in_file(Some(file), line, error.message(), help)
}

fn write(
    arguments: &PathArguments,
    dialect: &dyn Dialect,
    settings: &Settings,
    planned: &Planned<'_>,
) -> Result<Vec<PathBuf>, Failure> {
    let (robot, read, program) = (planned.robot, planned.read, planned.program);
    let stem = truecut_files::folder_name(&arguments.file, "path");
    let folder = arguments.out.join(&stem);
    // First what can be refused.
    let files = dialect
        .write(program, robot, settings)
        .map_err(|error| unwritten(&arguments.file, read, &error))?;
    let (points, recording) = (folder.join("path.csv"), folder.join("path.rrd"));
    let slides_mm = arguments.cam.slide_mm.as_deref().unwrap_or_default();
    let slides_m: Vec<f64> = slides_mm.iter().map(|mm| mm * 1e-3).collect();
    let table = table(read, program, robot, &slides_m);
    write_file(
        &points,
        &table.map_err(|error| Failure::at(&points, error))?,
    )?;
    record(planned, &recording)?;
    let mut written = vec![points, recording];
    let holds = planned.clearance.is_none_or(Checked::holds);
    written.extend(super::files::programs(&folder, files, holds)?);
    Ok(written)
}

/// One row a path point: line of the file, pose in the world, posture.
fn table(
    read: &CamPath,
    program: &Program,
    robot: &Robot,
    slides_m: &[f64],
) -> csv::Result<Vec<u8>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let heads = [
        "point",
        "line",
        "work_x_mm",
        "work_y_mm",
        "work_z_mm",
        "x_mm",
        "y_mm",
        "z_mm",
        "qw",
        "qx",
        "qy",
        "qz",
    ];
    let names = heads.map(str::to_owned).into_iter();
    let names = names.chain((1..=robot.dof()).map(|j| format!("j{j}")));
    let names = names.chain(slide_heads(slides_m));
    out.write_record(names.chain(["feed_mm_per_s".to_owned()]))?;
    for (step, source) in program.moves.iter().zip(&read.points) {
        let pose = program.world_from_base * step.base_from_tool;
        let (t, q) = (pose.translation.vector * 1e3, pose.rotation);
        let mut cells = vec![step.path_point.to_string(), source.line.to_string()];
        cells.extend(source.place_m.iter().map(|m| format!("{:.6}", m * 1e3)));
        cells.extend([t.x, t.y, t.z].map(|mm| format!("{mm:.6}")));
        cells.extend([q.w, q.i, q.j, q.k].map(|part| format!("{part:.9}")));
        cells.extend(joint_cells(robot, &step.posture));
        cells.extend(slide_cells(slides_m));
        cells.push(match step.motion {
            Motion::Linear { speed_m_per_s } => format!("{:.3}", speed_m_per_s * 1e3),
            Motion::Joint { .. } => String::new(),
        });
        out.write_record(cells)?;
    }
    out.into_inner().map_err(|error| error.into_error().into())
}

/// The arm along the path, and its joints over time, for the viewer.
fn record(planned: &Planned<'_>, file: &Path) -> Result<(), Failure> {
    let (robot, program, replay) = (planned.robot, planned.program, planned.replay);
    let failed = |error: truecut_recording::SinkError| Failure::message(error.to_string());
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|error| Failure::at(folder, error))?;
    }
    let every = replay.rows.len().div_ceil(FRAMES).max(1);
    // Turns on the spot take no time here: a viewer shows one row an instant.
    let mut rows: Vec<(f64, &[f64])> = Vec::new();
    let mut clearance_m = Vec::new();
    let over = planned.clearance.map(|own| own.over_stations(robot, every));
    for (k, row) in replay.rows.iter().step_by(every).enumerate() {
        if rows.last().is_none_or(|(time_s, _)| row.time_s > *time_s) {
            rows.push((row.time_s, &row.posture));
            clearance_m.extend(over.as_ref().map(|over| over[k]));
        }
    }
    let about = planned.clearance.map(Checked::surroundings);
    let (scene, frames) = travel_view(robot, &rows, about.unwrap_or_default());
    let joints = robot.chain.joints.iter().enumerate();
    let channel = |(i, joint): (usize, &truecut_arm::Joint)| {
        let name = format!("joint{}.angle", i + 1);
        ChannelSpec::new(name, Unit::Radian, format!("angle of {}", joint.name))
    };
    let mut channels: Vec<ChannelSpec> = joints.map(channel).collect();
    let time_s: Vec<f64> = rows.iter().map(|(time_s, _)| *time_s).collect();
    let column = |joint: usize| rows.iter().map(|(_, posture)| posture[joint]).collect();
    let mut columns: Vec<Vec<f64>> = (0..robot.dof()).map(column).collect();
    // Where there is nothing that could be met, there is no clearance.
    if !clearance_m.is_empty() && clearance_m.iter().all(|m| m.is_finite()) {
        let what = "distance of the two bodies that are nearest to each other";
        channels.push(ChannelSpec::new("cell.clearance", Unit::Metre, what));
        columns.push(clearance_m);
    }
    let header = Header {
        scenario_name: program.name.clone(),
        scenario_text: String::new(),
        channels,
        scene,
        notes: program.notes.clone(),
    };
    let mut sink = RrdSink::new(file);
    sink.begin(&header).map_err(failed)?;
    let chunk = Chunk {
        time_s: &time_s,
        columns: columns.iter().map(Vec::as_slice).collect(),
        frames: &frames,
    };
    sink.chunk(&chunk).map_err(failed)?;
    let recording = Recording {
        header,
        time_s: time_s.clone(),
        columns: columns.clone(),
        profiles: Vec::new(),
        scalars: Vec::new(),
        outcome: Outcome::Completed,
    };
    sink.finish(&recording, &[]).map_err(failed)
}

/// Whether a job's arguments hold any that only CAM files take.
pub fn given(cam: &CamArguments) -> bool {
    *cam != CamArguments::default()
}
