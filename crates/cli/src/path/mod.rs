//! `truecut path`: from a path job to a robot program.

mod body;
mod cam;
mod cam_files;
mod cam_page;
mod depth;
mod edges;
mod figure;
mod files;
mod inputs;
mod text;
mod view;

pub use cam::TOOL;
use depth::Depths;
use nalgebra::{Isometry3, Vector3};
use truecut_plan::clearance::{Cell, Own, Solid, Station, Tool};
use truecut_plan::motion::joints::slowest_joint_s;
use truecut_plan::program::{
    Finding, FindingKind, Motion, Move, Program, ProgramErrorKind, Replay, TravelOptions,
};
use truecut_plan::surface_path::{
    AxisRule, Chord, Part, Segment, Speeds, SurfacePath, SurfacePathError, TaughtWhen, parts_of,
    program_of,
};
use truecut_scenario::{PathJob, Scenario};

use crate::args::PathArguments;
use crate::clearance::Checked;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::program::replayed;
use crate::progress::Progress;
use inputs::Inputs;

/// A planned path job.
struct PlannedPath<'a> {
    job: &'a PathJob,
    inputs: &'a Inputs,
    path: SurfacePath,
    /// Segments of all copies, in the order of the program.
    parts: Vec<Part>,
    program: Program,
    depths: Depths,
    /// Straight lines from contact to contact: `[line][contact]`.
    chords: Vec<Vec<Chord>>,
    findings: Vec<Finding>,
    /// Where the job names a cell.
    clearance: Option<Checked>,
    /// The program run through: the places at which clearances are looked at.
    replay: Replay,
}

impl PlannedPath<'_> {
    /// Whether the arm can run the program, between its points too, and nothing comes nearer than
    /// asked, as far as that is looked at.
    fn holds(&self) -> bool {
        self.replay.grave().next().is_none() && self.clearance.as_ref().is_none_or(Checked::holds)
    }
}

/// Plans, checks, prints and writes.
pub fn path(arguments: &PathArguments) -> Result<ExitStatus, Failure> {
    if truecut_plan::cam::is_cam(&arguments.file) {
        return cam::path(arguments);
    }
    if Scenario::lays_a_way(&arguments.file) {
        return edges::path(arguments);
    }
    if cam::given(&arguments.cam) {
        let text = format!(
            "options for paths from CAM have no effect on a path job; CAM files end in {}",
            truecut_plan::cam::endings()
        );
        return Err(Failure::at(&arguments.file, text));
    }
    let job = PathJob::load(&arguments.file)?;
    let inputs = Inputs::load(&job)?;
    let (head, cell) = head_and_cell(&job, &inputs)?;
    let answer = answer(&job, &inputs, head, cell).map_err(|failure| {
        let folder = arguments.out.join(job.stem());
        let setup = &job.program;
        files::without_program(&folder, &setup.name, setup.dialect, failure)
    })?;
    let written = files::write(&answer, &arguments.out)?;
    crate::print(&text::printed(&answer, &written))?;
    Ok(match answer.holds() {
        true => ExitStatus::Good,
        false => ExitStatus::ClaimFailed,
    })
}

/// First what a look at the files tells: a fault of theirs leaves an earlier answer as it is.
fn head_and_cell(job: &PathJob, inputs: &Inputs) -> Result<(Program, Option<Cell>), Failure> {
    let setup = &job.program;
    let name = setup.dialect.check_name(&setup.name);
    name.map_err(|fault| job.problem("program.name", fault.to_string()))?;
    let head = setup.head(&inputs.robot);
    let head = head.map_err(|fault| job.problem("program", fault.to_string()))?;
    let cell = cell(job, inputs, &head)?;
    Ok((head, cell))
}

fn answer<'a>(
    job: &'a PathJob,
    inputs: &'a Inputs,
    head: Program,
    cell: Option<Cell>,
) -> Result<PlannedPath<'a>, Failure> {
    let progress = Progress::new(4, "path");
    let run = progress.run();
    let path = (job.path.lines(&job.wheel, &inputs.patch)).map_err(|error| refused(job, &error))?;
    drop(run);
    let poses = path.poses(job.path.lift_m);
    let run = progress.run();
    let (parts, program) =
        follow(job, inputs, head, &poses).map_err(|error| refused(job, &error))?;
    let findings = program.inspect(&inputs.robot, &TravelOptions::default().singularity);
    if let Some(fast) = fastest(&findings) {
        return Err(too_fast(job, fast));
    }
    drop(run);
    let depths = Depths::of(job, inputs, &poses, &progress)?;
    let chords = path.chords(inputs.patch.surface.as_ref(), &job.wheel);
    depth::check_edge_gaps(job, &path, &chords)?;
    let run = progress.run();
    let replay = replayed(&program, &inputs.robot, job.path(), &|part| run.set(part))?;
    drop(run);
    let clearance = cell.map(|cell| {
        let stations = Station::of_replay(&program, &replay, |_| false);
        Checked::of(&inputs.robot, cell, stations)
    });
    Ok(PlannedPath {
        job,
        inputs,
        path,
        parts,
        program,
        depths,
        chords,
        findings,
        clearance,
        replay,
    })
}

/// The cell that the job names: the part, its copies and what stands about them, with the wheel.
fn cell(job: &PathJob, inputs: &Inputs, head: &Program) -> Result<Option<Cell>, Failure> {
    let Some(cell) = job.cell.as_deref() else {
        return Ok(None);
    };
    let mesh = inputs.body.as_ref().unwrap_or(&inputs.patch_mesh);
    let at = job.surface.world_from_patch;
    let places: Vec<Isometry3<f64>> = match &job.symmetry {
        Some(symmetry) => symmetry.places().map(|copy| copy * at).collect(),
        None => vec![at],
    };
    // A cylinder's axis is its z, the wheel's is the tool's y.
    let about_y = Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
    let wheel = Tool {
        name: "wheel".to_owned(),
        solid: Solid::Cylinder {
            radius_m: job.wheel.radius_m,
            length_m: job.wheel.width_m,
        },
        flange_from_solid: head.tool.flange_from_tool * about_y,
    };
    let own = Own {
        part: places.into_iter().map(|place| (mesh, place)).collect(),
        tools: vec![wheel],
    };
    Checked::cell_of_job(&inputs.robot, cell, &own, "the path job").map(Some)
}

/// The program of all copies.
fn follow(
    job: &PathJob,
    inputs: &Inputs,
    head: Program,
    poses: &[Vec<Isometry3<f64>>],
) -> Result<(Vec<Part>, Program), SurfacePathError> {
    let world_from_patch = job.surface.world_from_patch;
    let planned = poses.iter().map(|line| {
        let line = line.iter().map(|pose| world_from_patch * pose);
        Segment::Planned(line.collect())
    });
    let taught = |when: TaughtWhen| {
        let all = job.taught.iter().zip(&inputs.taught);
        all.filter(move |(spec, _)| spec.when == when)
            .map(|(_, points)| Segment::Taught(points.clone()))
    };
    let segments: Vec<Segment> = taught(TaughtWhen::Before)
        .chain(planned)
        .chain(taught(TaughtWhen::After))
        .collect();
    let parts = parts_of(&segments, job.symmetry.as_ref())?;
    let speeds = Speeds {
        feed_m_per_s: job.path.feed_m_per_s,
        joint_share: job.program.joint_share,
    };
    let options = TravelOptions {
        largest_step: job.program.largest_step_rad,
        ..TravelOptions::default()
    };
    let start = &job.robot.posture_rad;
    let program = program_of(&inputs.robot, head, &parts, start, speeds, &options)?;
    Ok((parts, program))
}

/// The joint that exceeds its speed limit most.
fn fastest(findings: &[Finding]) -> Option<(&Finding, f64, f64)> {
    let fast = findings.iter().filter_map(|finding| match finding.kind {
        FindingKind::TooFast {
            speed_rad_per_s,
            limit_rad_per_s,
        } => Some((finding, speed_rad_per_s, limit_rad_per_s)),
        _ => None,
    });
    fast.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))
}

fn too_fast(job: &PathJob, (finding, speed, limit): (&Finding, f64, f64)) -> Failure {
    let feed_mm_per_s = job.path.feed_m_per_s * 1e3;
    let message = format!(
        "`path.feed_mm_per_s` is {feed_mm_per_s}, but must be at most {:.3}: {finding}",
        feed_mm_per_s * limit / speed
    );
    job.problem("path.feed_mm_per_s", message).into()
}

/// An error of the path, at the key of the job that caused it or in the file that holds it.
fn refused(job: &PathJob, error: &SurfacePathError) -> Failure {
    let key = match error {
        SurfacePathError::Gouge { .. } => "wheel.radius_mm",
        SurfacePathError::NoAxis { .. } => "path.edge_gap_limit_mm",
        SurfacePathError::WiderThanFace { .. } => "wheel.width_mm",
        SurfacePathError::TooFine { .. } => "path.step_mm",
        SurfacePathError::TooClose { .. } => "path",
        SurfacePathError::PlaneAlong { .. } => "path.plane_normal",
        SurfacePathError::TaughtTurned => "symmetry.carried_by",
        SurfacePathError::Travel { source, .. } => match source.kind() {
            ProgramErrorKind::Jump {
                turn_deg,
                largest_deg,
                ..
            } => return jumped(job, error, turn_deg > largest_deg),
            _ => "surface.xyz_mm",
        },
        _ => job.surface.face.key(),
    };
    job.problem(key, error.to_string()).into()
}

/// A joint that would have to jump: because the wheel's axis does, or beside a singular posture,
/// where the arm turns by more than the wheel.
fn jumped(job: &PathJob, error: &SurfacePathError, axis_jumps: bool) -> Failure {
    let (key, remedy) = match (axis_jumps, job.path.options.rule) {
        (true, AxisRule::WidestSwath { .. }) => (
            "path.edge_gap_limit_mm",
            "the edge gap's limit leaves the wheel's axis no way to turn gradually: allow a wider \
             gap, take a narrower wheel or feed along the other parameter",
        ),
        (true, AxisRule::LeastCurvature) => (
            "path.axis",
            "the direction of least curvature turns there: `path.axis = \"widest_swath\"` turns \
             the axis gradually",
        ),
        (false, _) => (
            "program.largest_step_deg",
            "the arm is near a posture where small turns of the wheel ask for large ones of a \
             joint: place the part elsewhere, take shorter steps, or allow more",
        ),
    };
    job.problem(key, format!("{error}; {remedy}")).into()
}

/// Duration of each move, s: at the feed along lines, else as long as the slowest joint needs.
fn durations_s(answer: &PlannedPath<'_>) -> Vec<f64> {
    let moves = &answer.program.moves;
    let step = |pair: &[Move]| {
        let distance =
            pair[1].base_from_tool.translation.vector - pair[0].base_from_tool.translation.vector;
        let robot = &answer.inputs.robot;
        let slowest =
            |share: f64| slowest_joint_s(robot, &pair[0].posture, &pair[1].posture, share);
        match pair[1].motion {
            Motion::Linear { speed_m_per_s } => (distance.norm() / speed_m_per_s).max(slowest(1.0)),
            Motion::Joint { share } => slowest(share),
        }
    };
    std::iter::once(0.0)
        .chain(moves.windows(2).map(step))
        .collect()
}
