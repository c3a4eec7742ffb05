//! Files that `truecut path` writes.

use std::path::{Path, PathBuf};

use truecut_plan::program::{Dialect, Motion, Move, Program, ProgramError, ProgramFile};
use truecut_plan::surface_path::{Contact, Part, Segment, joint_cells};
use truecut_recording::{Frame, Scene};

use super::{PlannedPath, figure, text, view};
use crate::failure::Failure;
use crate::page::{self, Page, Space};
use truecut::outputs::write_file;

/// Colour of the wheel's lines in space.
const LINE_RGB: [u8; 3] = [242, 142, 43];
/// Most moments that a page has.
const FEW: usize = 80;

/// Some of the frames, at even distances.
pub fn few(frames: &[Frame]) -> Vec<Frame> {
    let every = frames.len().div_ceil(FEW).max(1);
    frames.iter().step_by(every).cloned().collect()
}

/// Writes the figure first, then the path, then the program.
pub fn write(answer: &PlannedPath<'_>, out: &Path) -> Result<Vec<PathBuf>, Failure> {
    let folder = out.join(answer.job.stem());
    let setup = &answer.job.program;
    let program = program(answer)
        .map_err(|failure| without_program(&folder, &setup.name, setup.dialect, failure))?;
    let (svg, points_csv) = (folder.join("path.svg"), folder.join("path.csv"));
    write_file(&svg, figure::figure(answer).to_svg().as_bytes())?;
    let html = folder.join("path.html");
    let seen = view::seen(answer);
    write_file(&html, page(answer, &seen).html().as_bytes())?;
    let points = table(answer).map_err(|error| Failure::at(&points_csv, error))?;
    write_file(&points_csv, &points)?;
    let mut written = vec![svg, points_csv];
    let rrd = folder.join("path.rrd");
    view::show(answer, &seen, &written, &rrd)?;
    written.extend([rrd, html]);
    written.extend(programs(&folder, program, answer.holds())?);
    Ok(written)
}

/// Why there is no program beside a path that was written.
pub const UNWRITTEN: &str = "  ✗ no program is written: what collides, or asks of the arm what it \
                             cannot do, is not to be run\n";

/// Writes a program's files. What collides or asks of the arm what it cannot do gets none, and
/// those of an earlier call go: beside the path of this one they would be taken for its own.
pub fn programs(
    folder: &Path,
    files: Vec<ProgramFile>,
    holds: bool,
) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    for one in files {
        let file = folder.join(one.name);
        if holds {
            write_file(&file, one.text.as_bytes())?;
            written.push(file);
            continue;
        }
        take_away(&file)?;
    }
    Ok(written)
}

/// Takes the program of an earlier call away where this one comes to none, and passes on why: what
/// stayed would be taken for a program of what is asked for now.
pub fn without_program(
    folder: &Path,
    name: &str,
    dialect: &dyn Dialect,
    failure: Failure,
) -> Failure {
    for file in earlier_program(folder, name, dialect) {
        if let Err(fault) = take_away(&file) {
            return fault;
        }
    }
    failure
}

/// Files of an earlier program of this name that are there, with the parts of a long job.
fn earlier_program(folder: &Path, name: &str, dialect: &dyn Dialect) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for ending in dialect.extensions() {
        let file = folder.join(format!("{name}.{ending}"));
        let bytes = truecut_files::read(&file).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let parts = dialect.parts(name, &text).into_iter();
        files.extend(parts.map(|part| folder.join(format!("{part}.{ending}"))));
        files.push(file);
    }
    files.retain(|file| file.is_file());
    files
}

/// Removes a file, if it is there.
fn take_away(file: &Path) -> Result<(), Failure> {
    match std::fs::remove_file(file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Failure::at(file, error)),
        _ => Ok(()),
    }
}

/// The path as a page.
fn page(answer: &PlannedPath<'_>, (scene, frames): &(Scene, Vec<Frame>)) -> Page {
    let mut page = Page::new("path", format!("{}: path", answer.job.name));
    page.told(&text::printed(answer, &[]));
    page.figures("Path", [figure::figure(answer)]);
    let mut space = Space::of_scene("The arm along the path", scene, &few(frames));
    space.lines("where the wheel touches", LINE_RGB, view::lines(answer));
    page.space("In space", space);
    page.text(page::repeat(
        "truecut path",
        &format!("{}.toml", answer.job.stem()),
    ));
    page
}

/// Files of the program.
fn program(answer: &PlannedPath<'_>) -> Result<Vec<ProgramFile>, Failure> {
    let (job, robot) = (answer.job, &answer.inputs.robot);
    let refused =
        |error: ProgramError| -> Failure { job.problem("program", error.to_string()).into() };
    let setup = &job.program;
    let files = (setup.dialect).write(&answer.program, robot, &setup.settings);
    files.map_err(refused)
}

/// One row per path point, numbers only: tool pose in the world, posture, wheel contact. Cells
/// without a value are empty.
fn table(answer: &PlannedPath<'_>) -> csv::Result<Vec<u8>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let joints = (1..=answer.inputs.robot.dof()).map(|j| format!("j{j}"));
    let before = BEFORE_POSE.into_iter().chain(POSE).chain(["turntable_deg"]);
    let before = before.map(str::to_owned);
    let slides_m = &answer.job.robot.posture_m;
    let heads = joints.chain(slide_heads(slides_m));
    out.write_record(before.chain(heads).chain(AFTER_JOINTS.map(str::to_owned)))?;
    let mut moves = answer.program.moves.iter();
    let is_taught = |part: &&Part| matches!(part.segment, Segment::Taught(_));
    let before = answer.parts.iter().take_while(is_taught).count();
    for part in &answer.parts {
        let line = part.index.checked_sub(before);
        let line = line.and_then(|k| Some((answer.path.lines.get(k)?, answer.depths.at_m.get(k)?)));
        let count = match &part.segment {
            Segment::Planned(poses) => poses.len(),
            Segment::Taught(points) => points.postures.len(),
        };
        for (k, step) in moves.by_ref().take(count).enumerate() {
            // The tool is lifted at the first pose of a line.
            let contact = line
                .and_then(|(line, depths)| Some((line.get(k.checked_sub(1)?)?, *depths.get(k)?)));
            let mut joints = joint_cells(&answer.inputs.robot, &step.posture);
            joints.extend(slide_cells(slides_m));
            out.write_record(row(&answer.program, part, step, joints, contact))?;
        }
    }
    out.into_inner().map_err(|error| error.into_error().into())
}

/// Columns of where slides stand.
pub fn slide_heads(places_m: &[f64]) -> impl Iterator<Item = String> {
    (1..=places_m.len()).map(|slide| format!("slide{slide}_mm"))
}

/// Where slides stand: the same in every row, since programs move rotary joints alone.
pub fn slide_cells(places_m: &[f64]) -> impl Iterator<Item = String> + '_ {
    places_m.iter().map(|m| format!("{:.6}", m * 1e3))
}

const BEFORE_POSE: [&str; 5] = ["point", "copy", "segment", "contact", "taught"];
/// Columns of the tool's pose.
pub const POSE: [&str; 7] = ["x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"];
const AFTER_JOINTS: [&str; 6] = [
    "feed_mm_per_s",
    "joint_speed_percent",
    "swath_mm",
    "edge_gap_mm",
    "depth_mm",
    "psi_deg",
];

/// One row; a contact comes with the wheel's indentation, m.
fn row(
    program: &Program,
    part: &Part,
    step: &Move,
    joints: Vec<String>,
    contact: Option<(&Contact, f64)>,
) -> Vec<String> {
    let pose = program.world_from_base * step.base_from_tool;
    let (t, q) = (pose.translation.vector * 1e3, pose.rotation);
    let flag = |holds: bool| u8::from(holds).to_string();
    let angle = |rad: f64| format!("{:.6}", rad.to_degrees());
    let mut cells = vec![
        step.path_point.to_string(),
        (part.copy + 1).to_string(),
        (part.index + 1).to_string(),
        flag(contact.is_some()),
        flag(matches!(part.segment, Segment::Taught(_))),
    ];
    cells.extend([t.x, t.y, t.z].map(|mm| format!("{mm:.6}")));
    cells.extend([q.w, q.i, q.j, q.k].map(|part| format!("{part:.9}")));
    cells.push(step.turntable_rad.map(angle).unwrap_or_default());
    cells.extend(joints);
    cells.extend(match step.motion {
        Motion::Linear { speed_m_per_s } => [format!("{:.3}", speed_m_per_s * 1e3), String::new()],
        Motion::Joint { share } => [String::new(), format!("{:.2}", share * 100.0)],
    });
    cells.extend(contact.map_or_else(Default::default, |(c, depth_m)| {
        let [swath, gap, depth] =
            [c.swath_m, c.edge_gap_m, depth_m].map(|m| format!("{:.4}", m * 1e3));
        [swath, gap, depth, format!("{:.3}", c.psi_rad.to_degrees())]
    }));
    cells
}
