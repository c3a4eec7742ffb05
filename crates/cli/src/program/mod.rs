//! `truecut program`: reads a robot program back, replays it, and compares it with its path.

mod deviation;
mod read;

use std::path::Path;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use truecut_arm::{Joint, Robot};
use truecut_plan::clearance::Station;
use truecut_plan::program::{MOST_PLACES, Motion, Program, Replay, ReplayOptions, ZoneReport};
use truecut_recording::{Unit, significant};
use truecut_scenario::harmless_text;

use crate::args::ProgramArguments;
use crate::clearance::Checked;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::robot::{of_slides, with_slides, without_tool};
use crate::text::{Align, fastest_joint, row, show, table};
use deviation::Deviation;

/// Findings that are listed individually.
const LISTED: usize = 10;

/// Allowed deviation of the tool by printed decimals: some ten times the rounding error of three
/// decimals of a millimetre.
const ALLOWED_M: f64 = 1e-5;
const ALLOWED_RAD: f64 = 0.01 * std::f64::consts::PI / 180.0;

/// Reads, replays, compares and prints. Fails for a program that the robot cannot run, or that
/// deviates from its path.
pub fn program(arguments: &ProgramArguments) -> Result<ExitStatus, Failure> {
    let (config, tip) = (arguments.config.as_deref(), arguments.tip.as_deref());
    let robot = Robot::load_kinematics(&arguments.robot, config, tip)
        .map_err(|error| Failure::arm(&error))?;
    let robot = with_slides(robot, arguments.slide_mm.as_deref())?;
    let base = frame(arguments.base_xyz_mm, arguments.base_rpy_deg);
    let mut program = read::read(arguments, &robot, &base)?;
    program
        .notes
        .extend(of_slides(arguments.slide_mm.as_deref()));
    program.notes.extend(without_tool(&robot));
    program.notes.extend(robot.motion_doubts());
    let path = (arguments.path.as_ref())
        .map(|path| deviation::path_of(path, robot.dof()))
        .transpose()?;
    let run = |tell: &(dyn Fn(f64) + Sync)| replayed(&program, &robot, &arguments.file, tell);
    let replay = Progress::of_one("run through", run)?;
    let deviation = (path.as_ref()).map(|path| Deviation::of(&program, path));
    let deviation = deviation.transpose()?;
    let cell = arguments.cell.as_deref();
    let cell = cell.map(|file| Checked::cell(&robot, file)).transpose()?;
    let clearance = cell.map(|cell| {
        let stations = Station::of_replay(&program, &replay, |_| false);
        Checked::of(&robot, cell, stations)
    });
    let name = |point: usize| format!("path point {point}");
    run_through(&RunThrough {
        robot: &robot,
        program: &program,
        replay: &replay,
        deviation: deviation.as_ref(),
        clearance: clearance.as_ref(),
        point_name: &name,
        acceleration_m_per_s2: arguments.acceleration_m_per_s2,
    })
}

/// Runs through the program of a file, in memory that is bounded, and tells how far it has come.
pub fn replayed(
    program: &Program,
    robot: &Robot,
    file: &Path,
    tell: &(dyn Fn(f64) + Sync),
) -> Result<Replay, Failure> {
    let options = ReplayOptions::default();
    let places = program.places(&options);
    if places > MOST_PLACES {
        let what = format!(
            "the way is looked at every 1 mm and 1 degree, at {places} places in all; they must be at most \
             {MOST_PLACES}: cut the file"
        );
        return Err(Failure::at(file, what));
    }
    Ok(program.replay_telling(robot, &options, tell))
}

/// What came of running a program through.
pub struct RunThrough<'a> {
    pub robot: &'a Robot,
    pub program: &'a Program,
    pub replay: &'a Replay,
    pub deviation: Option<&'a Deviation>,
    pub clearance: Option<&'a Checked>,
    /// Tells a path point.
    pub point_name: &'a dyn Fn(usize) -> String,
    pub acceleration_m_per_s2: Option<f64>,
}

/// Prints what came of running a program through, and says whether the robot can run it.
pub fn run_through(run: &RunThrough<'_>) -> Result<ExitStatus, Failure> {
    crate::print(&told(run))?;
    Ok(match run.holds() {
        true => ExitStatus::Good,
        false => ExitStatus::ClaimFailed,
    })
}

/// What came of running a program through, as it is printed.
pub fn told(run: &RunThrough<'_>) -> String {
    printed(run, &run.program.zones(run.acceleration_m_per_s2))
}

impl RunThrough<'_> {
    /// Whether the arm can run the program, meets nothing, and is led along the path.
    pub fn holds(&self) -> bool {
        let near =
            |d: &Deviation| d.position_m.value <= ALLOWED_M && d.attitude_rad.value <= ALLOWED_RAD;
        self.replay.grave().next().is_none()
            && self.deviation.is_none_or(near)
            && self.clearance.is_none_or(Checked::holds)
    }
}

/// A frame in the world as options give it: mm, and degrees about the fixed axes x, y, z.
pub fn frame(xyz_mm: Option<[f64; 3]>, rpy_deg: Option<[f64; 3]>) -> Isometry3<f64> {
    let [roll, pitch, yaw] = rpy_deg.unwrap_or_default().map(f64::to_radians);
    Isometry3::from_parts(
        (Vector3::from(xyz_mm.unwrap_or_default()) * 1e-3).into(),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

fn printed(run: &RunThrough<'_>, zones: &ZoneReport) -> String {
    let (program, replay) = (run.program, run.replay);
    let lines = (program.moves.iter()).filter(|m| matches!(m.motion, Motion::Linear { .. }));
    let mut text = format!(
        "{}: {} moves, {} of them on lines, tool \"{}\"\n\n",
        program.name,
        program.moves.len(),
        lines.count(),
        program.tool.name
    );
    let time_s = replay.rows.last().map_or(0.0, |row| row.time_s);
    let places = format!("{} places looked at", replay.rows.len());
    let mut rows = vec![row("time", format!("{} s", significant(time_s, 4)), places)];
    rows.extend(of_zones(zones, time_s));
    if let Some((share, joint, point)) = replay.fastest {
        let joint = &run.robot.chain.joints[joint].name;
        rows.push(fastest_joint(share, joint, point));
    }
    rows.extend(run.deviation.into_iter().flat_map(beside_path));
    rows.extend(run.clearance.map(|own| own.row(run.point_name)));
    text.push_str(&table(&[Align::Left, Align::Right, Align::Left], &rows));
    if replay.findings.is_empty() {
        text.push_str(&format!(
            "  ✓ within limits, clear of singularities, {}, also between path points\n",
            of_speeds(run.robot)
        ));
    }
    for finding in replay.findings.iter().take(LISTED) {
        text.push_str(&format!("  ✗ {finding}\n"));
    }
    let more = replay.findings.len().saturating_sub(LISTED);
    if more > 0 {
        text.push_str(&format!("  ✗ and {more} more\n"));
    }
    let faults = run.clearance.map(|own| own.faults(run.point_name));
    text.push_str(&faults.unwrap_or_default());
    let of_cell = run.clearance.iter().flat_map(|own| own.notes());
    for note in program.notes.iter().chain(of_cell) {
        // Notes quote words of the file.
        text.push_str(&format!("  note: {}\n", harmless_text(note)));
    }
    text
}

/// What a run-through without findings says of speeds: nothing of joints without a limit.
fn of_speeds(robot: &Robot) -> String {
    let joints = &robot.chain.joints;
    let has_limit = |joint: &&Joint| joint.limits.is_some_and(|l| l.velocity.is_finite());
    match joints.iter().filter(has_limit).count() {
        0 => "speeds not judged since no joint has a speed limit".to_owned(),
        judged if judged < joints.len() => format!(
            "none of the {judged} joints with a speed limit too fast ({} without one)",
            joints.len() - judged
        ),
        _ => "no joint too fast".to_owned(),
    }
}

/// Rows on stops and zones.
fn of_zones(zones: &ZoneReport, time_s: f64) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let stops = "stops on lines between the first and the last";
    rows.push(match zones.lost_s {
        Some(lost_s) => {
            let seconds = format!("{} s", significant(time_s + lost_s, 4));
            let what = format!("with {} {stops}, speeding up and braking", zones.stops);
            row("cycle time", seconds, what)
        }
        None => {
            let what = format!("{stops}; accelerations are left out");
            row("stops", zones.stops.to_string(), what)
        }
    });
    rows.extend(zones.corner.map(|(cut_m, point)| {
        let what = format!("cut off a corner by its zone at most, at path point {point}");
        row("corner", show(Unit::Metre, cut_m), what)
    }));
    rows
}

/// Rows of the comparison with the path.
fn beside_path(d: &Deviation) -> [Vec<String>; 3] {
    let mark = |good: bool| if good { "✓" } else { "✗" };
    [
        row(
            "position",
            show(Unit::Metre, d.position_m.value),
            format!(
                "{} from the path at most, at path point {}; 0.01 mm are allowed",
                mark(d.position_m.value <= ALLOWED_M),
                d.position_m.at
            ),
        ),
        row(
            "attitude",
            format!("{} deg", significant(d.attitude_rad.value.to_degrees(), 3)),
            format!(
                "{} from the path at most, at path point {}; 0.01 deg are allowed",
                mark(d.attitude_rad.value <= ALLOWED_RAD),
                d.attitude_rad.at
            ),
        ),
        row(
            "joints",
            format!("{} deg", significant(d.joint_rad.value.to_degrees(), 3)),
            format!(
                "from the path's postures at most, at path point {}",
                d.joint_rad.at
            ),
        ),
    ]
}
