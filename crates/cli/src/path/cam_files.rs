//! What `truecut path` writes of a CAM file beside the program: the points, and the arm along them.

use std::path::Path;

use truecut_arm::Robot;
use truecut_plan::cam::CamPath;
use truecut_plan::program::{Motion, Program, Replay};
use truecut_plan::surface_path::joint_cells;
use truecut_recording::{ChannelSpec, Chunk, Frame, Header, Outcome, Recording, Scene, Sink, Unit};
use truecut_sim::travel_view;
use truecut_telemetry::RrdSink;

use super::files::{POSE, slide_cells, slide_heads};
use crate::clearance::Checked;
use crate::failure::Failure;

/// Most frames of the recording.
const FRAMES: usize = 5000;
/// The channel of distances.
pub(super) const CLEARANCE: &str = "cell.clearance";

/// What is planned of a file, before it is written.
pub(super) struct Planned<'a> {
    pub robot: &'a Robot,
    pub read: &'a CamPath,
    pub program: &'a Program,
    pub replay: &'a Replay,
    pub clearance: Option<&'a Checked>,
}

/// One row a path point: line of the file, or what its word says, pose in the world, posture.
pub(super) fn table(
    planned: &Planned<'_>,
    line_word: &str,
    slides_m: &[f64],
) -> csv::Result<Vec<u8>> {
    let (read, program, robot) = (planned.read, planned.program, planned.robot);
    let mut out = csv::Writer::from_writer(Vec::new());
    let heads = ["point", line_word, "work_x_mm", "work_y_mm", "work_z_mm"];
    let names = heads.into_iter().chain(POSE).map(str::to_owned);
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

/// The arm along the path as it is seen, and its joints over time.
pub(super) struct Seen {
    pub scene: Scene,
    pub frames: Vec<Frame>,
    pub time_s: Vec<f64>,
    pub channels: Vec<ChannelSpec>,
    pub columns: Vec<Vec<f64>>,
}

/// Looks at the arm along the path.
pub(super) fn seen(planned: &Planned<'_>) -> Seen {
    let (robot, replay) = (planned.robot, planned.replay);
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
        channels.push(ChannelSpec::new(CLEARANCE, Unit::Metre, what));
        columns.push(clearance_m);
    }
    Seen {
        scene,
        frames,
        time_s,
        channels,
        columns,
    }
}

/// The same for the viewer.
pub(super) fn record(program: &Program, seen: &Seen, file: &Path) -> Result<(), Failure> {
    let failed = |error: truecut_recording::SinkError| Failure::message(error.to_string());
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|error| Failure::at(folder, error))?;
    }
    let (time_s, columns, frames) = (&seen.time_s, &seen.columns, &seen.frames);
    let header = Header {
        scenario_name: program.name.clone(),
        scenario_text: String::new(),
        channels: seen.channels.clone(),
        scene: seen.scene.clone(),
        notes: program.notes.clone(),
    };
    let mut sink = RrdSink::new(file);
    sink.begin(&header).map_err(failed)?;
    let chunk = Chunk {
        time_s,
        columns: columns.iter().map(Vec::as_slice).collect(),
        frames,
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
