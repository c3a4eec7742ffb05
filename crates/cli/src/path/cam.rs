//! `truecut path` of a CAM file: G-code, APT or poses before an arm.

use std::path::{Path, PathBuf};

use nalgebra::Point3;
use serde_json::Value;
use truecut::outputs::write_file;
use truecut_arm::{JointKind, Robot};
use truecut_plan::cam::{self, CamOptions, CamPath, Rapid, WorkSetup};
use truecut_plan::clearance::{Cell, Station};
use truecut_plan::program::{
    Dialect, Options, Program, ProgramError, Settings, Start, TravelOptions, dialect_named,
    maker_note, read_text,
};
use truecut_recording::significant;

use super::cam_files::{Planned, record, seen, table};
use super::cam_page;
use super::files::{UNWRITTEN, without_program};
use crate::args::{CamArguments, PathArguments};
use crate::clearance::Checked;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::program::{RunThrough, replayed, run_through};
use crate::progress::Progress;
use crate::robot::{posture, slides_note, unless_gantry, with_slides, without_tool};

/// What the tool of a path from CAM is called: of what kind it is no file says.
pub const TOOL: &str = "tool";

/// Reads, plans, runs through, prints and writes.
pub fn path(arguments: &PathArguments) -> Result<ExitStatus, Failure> {
    let (file, cam) = (&arguments.file, &arguments.cam);
    let robot = robot(cam, file)?;
    let dialect = dialect(cam)?;
    let settings = settings(cam, dialect)?;
    let head = head(cam, dialect, &settings, &robot, file)?;
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
    let mut read = cam::read(&text, file, &options).map_err(|error| refused(file, &error, None))?;
    check_spin(cam, &read, file)?;
    let posture = start_posture(cam, &robot)?;
    let setup = WorkSetup {
        world_from_work: crate::program::frame(cam.work_xyz_mm, cam.work_rpy_deg),
        spin_rad: cam.spin_deg.map(f64::to_radians),
        rapid: Rapid::Line {
            speed_m_per_s: cam.rapid_mm_per_s.unwrap_or(250.0) * 1e-3,
        },
        joint_share: cam.joint_speed.unwrap_or(0.25),
        zone_m: cam.zone_mm.map(|mm| mm * 1e-3),
    };
    let note = place_note(cam, &robot, &setup, &read);
    read.notes.extend(note);
    let slides_mm = cam.slide_mm.as_deref().unwrap_or_default();
    let way = BeforeArm {
        robot: &robot,
        read: &read,
        setup,
        near: posture.as_deref(),
        slides_m: slides_mm.iter().map(|mm| mm * 1e-3).collect(),
        line_word: "line",
        help: Some(
            "--work-xyz-mm and --work-rpy-deg place the file before the arm; --spin-deg and \
             --posture-deg choose other postures",
        ),
    };
    way.planned(arguments, cell, dialect, &settings, head)
}

/// That the path runs within the arm's own foot, where a place in metres puts it.
fn place_note(
    cam: &CamArguments,
    robot: &Robot,
    setup: &WorkSetup,
    read: &CamPath,
) -> Option<String> {
    let [x, y, z] = cam.work_xyz_mm?;
    let places = read.points.iter();
    let places = places.map(|point| setup.world_from_work * Point3::from(point.place_m));
    let off_m = places.filter_map(|place| robot.within_foot_m(&place.coords));
    let off_m = off_m.reduce(f64::min)?;
    Some(format!(
        "the path comes as near as {} mm to the origin of the arm, within its own foot: --work-xyz-mm {x},{y},{z} is \
         in mm; was it given in metres?",
        significant(1e3 * off_m, 2)
    ))
}

/// A path before an arm.
pub(super) struct BeforeArm<'a> {
    pub robot: &'a Robot,
    pub read: &'a CamPath,
    pub setup: WorkSetup,
    /// The posture that it shall begin near to.
    pub near: Option<&'a [f64]>,
    /// Where slides stand, m.
    pub slides_m: Vec<f64>,
    /// What a line of it is called.
    pub line_word: &'static str,
    /// What to do where the arm cannot follow.
    pub help: Option<&'static str>,
}

impl BeforeArm<'_> {
    /// Finds postures, runs through, prints and writes.
    pub(super) fn planned(
        &self,
        arguments: &PathArguments,
        cell: Option<Cell>,
        dialect: &dyn Dialect,
        settings: &Settings,
        head: Program,
    ) -> Result<ExitStatus, Failure> {
        let (robot, read, file) = (self.robot, self.read, &arguments.file);
        let folder = folder(arguments);
        let program_name = head.name.clone();
        let none = |failure: Failure| without_program(&folder, &program_name, dialect, failure);
        let program = self.followed(file, dialect, head).map_err(none)?;
        let run = |tell: &(dyn Fn(f64) + Sync)| replayed(&program, robot, file, tell);
        let replay = Progress::of_one("run through", run).map_err(none)?;
        let clearance = cell.map(|cell| {
            let is_rapid = |point: usize| read.points[point].feed_m_per_s.is_none();
            let stations = Station::of_replay(&program, &replay, is_rapid);
            Checked::of(robot, cell, stations)
        });
        let planned = Planned {
            robot,
            read,
            program: &program,
            replay: &replay,
            clearance: clearance.as_ref(),
        };
        let name = |point: usize| {
            let line = read.points[point].line;
            format!("{} {line}, path point {point}", self.line_word)
        };
        let run = RunThrough {
            robot,
            program: &program,
            replay: &replay,
            deviation: None,
            clearance: clearance.as_ref(),
            point_name: &name,
            acceleration_m_per_s2: arguments.cam.acceleration_m_per_s2,
        };
        let written = self.write(arguments, dialect, settings, &planned, &run)?;
        let status = run_through(&run)?;
        if !run.holds() {
            crate::print(UNWRITTEN)?;
        }
        if let Some((first, rest)) = written.split_first() {
            crate::print(&format!("\n{}", crate::text::written(first, rest)))?;
        }
        Ok(status)
    }

    /// The program of the path, with what there is to note.
    fn followed(
        &self,
        file: &Path,
        dialect: &dyn Dialect,
        head: Program,
    ) -> Result<Program, Failure> {
        // Lines may be long: what lies between their ends is looked at when they are run through.
        let travel = TravelOptions {
            largest_step: std::f64::consts::PI,
            ..TravelOptions::default()
        };
        let start = self.near.map_or(Start::AtRest, Start::Near);
        let robot = self.robot;
        let program = cam::follow(start, robot, head, self.read, file, &self.setup, &travel);
        let mut program = program.map_err(|error| self.refused(file, &error))?;
        program.notes.extend(without_tool(robot));
        program.notes.extend(robot.motion_doubts());
        program.notes.extend(maker_note(dialect, robot));
        program
            .notes
            .extend(dialect.limits_note().map(str::to_owned));
        let slides = (!self.slides_m.is_empty()).then(|| slides_note(&self.slides_m));
        program.notes.extend(slides);
        Ok(program)
    }

    /// What is wrong with the file, or where the arm cannot follow it.
    fn refused(&self, file: &Path, error: &ProgramError) -> Failure {
        let help = error.kind().path_point().and(self.help);
        refused(file, error, help)
    }

    /// What a dialect cannot say: at the line that the point comes from.
    fn unwritten(&self, file: &Path, error: &ProgramError) -> Failure {
        let point = error.kind().path_point();
        let line = point
            .and_then(|at| self.read.points.get(at))
            .map(|point| point.line);
        let help = line.map(|_| {
            "--posture-deg and --spin-deg choose other postures, --dialect another language"
                .to_owned()
        });
        match self.help {
            Some(_) => Failure::in_file(Some(file), line, error.message(), help),
            None => {
                let word = self.line_word;
                let place = line.map_or_else(String::new, |line| format!("{word} {line}: "));
                Failure::at(file, format!("{place}{}", error.message()))
            }
        }
    }

    fn write(
        &self,
        arguments: &PathArguments,
        dialect: &dyn Dialect,
        settings: &Settings,
        planned: &Planned<'_>,
        run: &RunThrough<'_>,
    ) -> Result<Vec<PathBuf>, Failure> {
        let (robot, program) = (planned.robot, planned.program);
        let folder = folder(arguments);
        // First what can be refused.
        let files = dialect.write(program, robot, settings).map_err(|error| {
            let failure = self.unwritten(&arguments.file, &error);
            without_program(&folder, &program.name, dialect, failure)
        })?;
        let [points, recording, html] =
            ["path.csv", "path.rrd", "path.html"].map(|one| folder.join(one));
        let table = table(planned, self.line_word, &self.slides_m);
        write_file(
            &points,
            &table.map_err(|error| Failure::at(&points, error))?,
        )?;
        let seen = seen(planned);
        record(program, &seen, &recording)?;
        let page = cam_page::page(planned, &seen, run);
        write_file(&html, page.html().as_bytes())?;
        let mut written = vec![points, recording, html];
        written.extend(super::files::programs(&folder, files, run.holds())?);
        Ok(written)
    }
}

/// Where the files of a call go.
fn folder(arguments: &PathArguments) -> PathBuf {
    let stem = truecut_files::folder_name(&arguments.file, "path");
    arguments.out.join(stem)
}

fn robot(cam: &CamArguments, file: &Path) -> Result<Robot, Failure> {
    let urdf = cam.robot.as_ref().ok_or_else(|| {
        let text = "a path from CAM needs --robot, the URDF of the arm that follows it";
        Failure::at(file, text)
    })?;
    let robot = Robot::load_kinematics(urdf, cam.config.as_deref(), cam.tip.as_deref())
        .map_err(|error| Failure::arm(&error))?;
    unless_gantry(&robot, urdf)?;
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

pub(super) fn dialect(cam: &CamArguments) -> Result<&'static dyn Dialect, Failure> {
    let name = cam.dialect.as_deref().unwrap_or("rapid");
    dialect_named(name).ok_or_else(|| Failure::message(format!("unknown dialect `{name}`")))
}

/// `--option key=value`: values that are numbers or truths are taken as such.
pub(super) fn settings(cam: &CamArguments, dialect: &dyn Dialect) -> Result<Settings, Failure> {
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

pub(super) fn head(
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
    let mut name: String = plain.take(8).collect::<String>().to_uppercase();
    if name.starts_with(|c: char| c.is_ascii_digit()) || name.is_empty() {
        // Most languages ask for a letter.
        name.insert(0, 'P');
        name.truncate(8);
    }
    let name = cam.name.clone().unwrap_or(name);
    let checked = dialect.check_name(&name);
    checked.map_err(|fault| Failure::message(format!("--name: {fault}")))?;
    let tool = dialect.tool(robot, &settings.options);
    let mut tool = tool.map_err(|fault| Failure::message(fault.to_string()))?;
    if !settings.options.contains_key("tool_name") {
        TOOL.clone_into(&mut tool.name);
    }
    Ok(Program {
        name,
        comment: String::new(),
        tool,
        world_from_base: crate::program::frame(cam.base_xyz_mm, cam.base_rpy_deg),
        moves: Vec::new(),
        spindle: Vec::new(),
        notes: Vec::new(),
    })
}

/// What is wrong with the file, or where the arm cannot follow it.
fn refused(file: &Path, error: &ProgramError, help: Option<&str>) -> Failure {
    let path = error.path().unwrap_or(file);
    Failure::in_file(
        Some(path),
        error.line(),
        error.message(),
        help.map(str::to_owned),
    )
}

/// Whether a job's arguments hold any that only CAM files take.
pub fn given(cam: &CamArguments) -> bool {
    *cam != CamArguments::default()
}
