//! A path for the viewer: the arm along it, the lines on the workpiece, charts.

use std::path::{Path, PathBuf};

use nalgebra::Point3;
use truecut_recording::{Frame, Scene};
use truecut_sim::process::Tooling;
use truecut_sim::{arm_view, mesh_body};
use truecut_telemetry::{PlanShown, write_plan};

use super::{PlannedPath, durations_s, figure, text};
use crate::clearance::Checked;
use crate::failure::Failure;
use crate::figure::charts_of;

/// Most postures that are shown; the program has all.
const MOST_POSTURES: usize = 3000;

/// The arm along the path beside the workpiece, and when.
pub fn seen(answer: &PlannedPath<'_>) -> (Scene, Vec<Frame>) {
    let (job, inputs) = (answer.job, answer.inputs);
    let at = &job.surface.world_from_patch;
    let workpiece = inputs.body.as_ref().unwrap_or(&inputs.patch_mesh);
    let checked = answer.clearance.as_ref();
    let mut about = checked.map(Checked::surroundings).unwrap_or_default();
    about
        .standing
        .insert(0, mesh_body("workpiece", at, workpiece));
    let moves = &answer.program.moves;
    let mut time_s = 0.0;
    let times = durations_s(answer).into_iter().map(|step_s| {
        time_s += step_s;
        time_s
    });
    let times: Vec<f64> = times.collect();
    let every = moves.len().div_ceil(MOST_POSTURES).max(1);
    let stops = (0..moves.len().div_ceil(every)).map(|k| {
        let at = k * every;
        (times[at], moves[at].posture.as_slice())
    });
    let tooling = Tooling::drum([job.wheel.radius_m, job.wheel.width_m]);
    arm_view(&inputs.robot, &tooling, stops, about)
}

/// Writes the file. `written` are files that the text names.
pub fn show(
    answer: &PlannedPath<'_>,
    (scene, frames): &(Scene, Vec<Frame>),
    written: &[PathBuf],
    rrd: &Path,
) -> Result<(), Failure> {
    let job = answer.job;
    let title = format!("{}: path", job.name);
    let source = truecut_files::read_text(job.path()).unwrap_or_default();
    let shown = PlanShown {
        title: &title,
        text: &text::printed(answer, written),
        scenario: &source,
        scene,
        frames,
        stations: &[],
        lines: &lines(answer),
        text_title: "Path",
        pages: &[charts_of(&figure::figure(answer))],
    };
    write_plan(rrd, &shown).map_err(|error| Failure::message(error.to_string()))
}

/// Where the wheel touches, line by line, and where bodies come nearest to each other, world.
pub fn lines(answer: &PlannedPath<'_>) -> Vec<Vec<[f64; 3]>> {
    let place = |point| {
        (answer.job.surface.world_from_patch * Point3::from(point))
            .coords
            .into()
    };
    let lines = answer.path.lines.iter();
    let lines = lines.map(|line| line.iter().map(|contact| place(contact.point_m)).collect());
    let nearest = answer.clearance.iter().flat_map(Checked::nearest);
    lines.chain(nearest).collect()
}
