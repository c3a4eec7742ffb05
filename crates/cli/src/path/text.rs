//! A path as text.

use std::path::PathBuf;

use truecut_plan::motion::joints::joint_speeds;
use truecut_plan::program::{FindingKind, Motion, maker_note};
use truecut_plan::surface::FaceFit;
use truecut_plan::surface_path::{Chord, Contact, Segment};
use truecut_recording::{Unit, significant};

use super::{PlannedPath, durations_s};
use crate::clearance::Checked;
use crate::robot::slides_note;
use crate::text::{self, Align, fastest_joint, row, show, table};

/// Findings that are listed individually.
const LISTED: usize = 5;

pub fn printed(answer: &PlannedPath<'_>, written: &[PathBuf]) -> String {
    let mut text = format!("{}\n", answer.job.name);
    text.push_str(&format!("  {}\n\n", extent(answer)));
    text.push_str(&table(
        &[Align::Left, Align::Right, Align::Left],
        &rows(answer),
    ));
    if let Some(checked) = &answer.clearance {
        text.push_str(&checked.faults(&|point| name(answer, point)));
    }
    for finding in answer.replay.grave().take(LISTED) {
        text.push_str(&format!("  ✗ {finding}\n"));
    }
    let more = answer.replay.grave().count().saturating_sub(LISTED);
    if more > 0 {
        text.push_str(&format!("  ✗ and {more} more\n"));
    }
    if !answer.holds() {
        text.push_str(super::files::UNWRITTEN);
    }
    text.push_str(&notes(answer));
    if let Some((first, rest)) = written.split_first() {
        text.push_str(&format!("\n{}", text::written(first, rest)));
    }
    text
}

fn extent(answer: &PlannedPath<'_>) -> String {
    let lines = answer.path.lines.len();
    let points: usize = answer.path.lines.iter().map(Vec::len).sum();
    let copies = match answer.job.symmetry {
        None => String::new(),
        Some(one) => {
            let by = if one.turntable {
                "brought by a turntable"
            } else {
                "the arm goes to each"
            };
            format!(", {} copies, {by}", one.count)
        }
    };
    let taught = (answer.parts.iter())
        .filter(|part| part.copy == 0)
        .filter_map(|part| match &part.segment {
            Segment::Taught(points) => Some(points.postures.len()),
            Segment::Planned(_) => None,
        });
    let taught: usize = taught.sum();
    let taught = if taught > 0 {
        format!(", {taught} taught postures a copy")
    } else {
        String::new()
    };
    format!(
        "{lines} lines with {points} contacts{copies}{taught}: {} moves in all",
        answer.program.moves.len()
    )
}

fn rows(answer: &PlannedPath<'_>) -> Vec<Vec<String>> {
    let contacts = || answer.path.lines.iter().flatten();
    let range = |of: &dyn Fn(&Contact) -> f64| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in contacts().map(of) {
            (low, high) = (low.min(value), high.max(value));
        }
        (low, high)
    };
    let (narrow, wide) = range(&|c| c.swath_m);
    let (_, gap) = range(&|c| c.edge_gap_m);
    let [shallow, deep] = answer.depths.on_lines_m();
    let way_m: f64 = (answer.path.lines.iter())
        .flat_map(|line| line.windows(2))
        .map(|w| (w[1].point_m - w[0].point_m).norm())
        .sum();
    let durations = durations_s(answer);
    let total_s: f64 = durations.iter().sum();
    let mm = |value: f64| show(Unit::Metre, value);
    let fit = answer.inputs.patch.fit.as_ref();
    let mut rows: Vec<Vec<String>> = fit.map(fitted).into_iter().collect();
    rows.extend([
        row("lines", mm(way_m), "length of one copy's lines"),
        row(
            "swath",
            mm(wide),
            format!("widest; narrowest {}", mm(narrow)),
        ),
        row("edge gap", mm(gap), "largest, by curvature along the axis"),
        row(
            "depth",
            mm(deep),
            format!(
                "of the undeformed wheel in the workpiece, largest (least {}), between points too; \
                 allowed {}",
                mm(shallow),
                mm(answer.job.path.gouge_limit_m)
            ),
        ),
    ]);
    rows.extend(left_over(answer));
    rows.push(row(
        "time",
        format!("{} s", significant(total_s, 4)),
        "of the whole program",
    ));
    let hardest = hardest(answer, &durations);
    rows.extend(hardest.map(|(share, joint, point)| fastest_joint(share, &joint, point)));
    let checked = answer.clearance.as_ref();
    rows.extend(checked.map(|checked| checked.row(&|point| name(answer, point))));
    rows
}

/// What the lines leave of the face, and what straight lines between points leave it by.
fn left_over(answer: &PlannedPath<'_>) -> [Vec<String>; 2] {
    let chords = answer.chords.iter().flatten();
    let chord_m = chords.map(Chord::largest_m).fold(0.0, f64::max);
    let untouched = answer.path.untouched_share(&answer.inputs.patch);
    [
        row(
            "chords",
            show(Unit::Metre, chord_m),
            "largest distance of the straight lines between points from the face",
        ),
        row(
            "untouched",
            format!("{} %", significant(100.0 * untouched, 3)),
            "of the face lies under no contact, corners at the ends of lines included that a wheel askew to the feed leaves",
        ),
    ]
}

/// A path point with the segment that it belongs to.
fn name(answer: &PlannedPath<'_>, point: usize) -> String {
    let mut first = 0;
    for part in &answer.parts {
        let (count, kind) = match &part.segment {
            Segment::Planned(poses) => (poses.len(), "segment"),
            Segment::Taught(points) => (points.postures.len(), "taught segment"),
        };
        if point < first + count {
            let copy = match answer.job.symmetry {
                Some(_) => format!(" of copy {}", part.copy + 1),
                None => String::new(),
            };
            return format!("path point {point} ({kind} {}{copy})", part.index + 1);
        }
        first += count;
    }
    format!("path point {point}")
}

/// What clearances are of.
fn checked_note(answer: &PlannedPath<'_>) -> String {
    if answer.clearance.is_none() {
        return "collisions are not looked at: a cell says what stands about the arm \
                (`cell = \"FILE\"`, `truecut schema --cell`)"
            .to_owned();
    }
    let table = match answer.job.symmetry {
        Some(symmetry) if symmetry.turntable => {
            "; the part is taken as it stands at the lines, not while the turntable turns"
        }
        _ => "",
    };
    format!(
        "clearances are those of the whole program, moves between lines too; the wheel is \
         held against the part by its depth on lines, by its clearance elsewhere{table}"
    )
}

/// How near the patch comes to the face of the mesh.
fn fitted(fit: &FaceFit) -> Vec<String> {
    let laid = if fit.has_four_sides {
        "laid by its four sides"
    } else {
        "laid in a rectangle, its outline the boundary"
    };
    let holes = match fit.holes {
        0 => String::new(),
        1 => ", 1 hole".to_owned(),
        more => format!(", {more} holes"),
    };
    let [rows, columns] = fit.control_points;
    row(
        "deviation",
        show(Unit::Metre, fit.deviation_m),
        format!(
            "largest, of the patch from face {} of the mesh ({} triangles{holes}), {} at its \
             vertices; {rows} by {columns} control points, {laid}",
            fit.face,
            fit.triangles,
            show(Unit::Metre, fit.at_vertices_m)
        ),
    )
}

/// The joint closest to its speed limit on a line.
fn hardest(answer: &PlannedPath<'_>, durations_s: &[f64]) -> Option<(f64, String, usize)> {
    let robot = &answer.inputs.robot;
    let steps = answer.program.moves.windows(2).zip(&durations_s[1..]);
    let lines = steps.filter(|(pair, _)| matches!(pair[1].motion, Motion::Linear { .. }));
    let each = lines.flat_map(|(pair, duration)| {
        let (from, to) = (&pair[0].posture, &pair[1].posture);
        let speeds = joint_speeds(robot, from, to, duration.max(1e-9));
        speeds.map(|one| (one, pair[1].path_point))
    });
    let hardest = each.max_by(|a, b| a.0.share().total_cmp(&b.0.share()));
    hardest.map(|(one, point)| {
        let joint = robot.chain.joints[one.joint].name.clone();
        (one.share(), joint, point)
    })
}

/// Notes for the reader.
fn notes(answer: &PlannedPath<'_>) -> String {
    let mut text = String::new();
    for finding in answer.findings.iter().take(LISTED) {
        if !matches!(finding.kind, FindingKind::TooFast { .. }) {
            text.push_str(&format!("  note: {finding}\n"));
        }
    }
    let more = answer.findings.len().saturating_sub(LISTED);
    if more > 0 {
        text.push_str(&format!("  note: and {more} more of this kind\n"));
    }
    for note in answer.clearance.iter().flat_map(Checked::notes) {
        text.push_str(&format!("  note: {note}\n"));
    }
    for doubt in answer.inputs.robot.motion_doubts() {
        text.push_str(&format!("  note: {doubt}\n"));
    }
    let slides_m = &answer.job.robot.posture_m;
    if !slides_m.is_empty() {
        text.push_str(&format!("  note: {}\n", slides_note(slides_m)));
    }
    if let Some(note) = maker_note(answer.job.program.dialect, &answer.inputs.robot) {
        text.push_str(&format!("  note: {note}\n"));
    }
    if let Some(note) = answer.job.program.dialect.limits_note() {
        text.push_str(&format!("  note: {note}\n"));
    }
    text.push_str(&format!("  note: {}\n", checked_note(answer)));
    text
}
