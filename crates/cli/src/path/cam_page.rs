//! A path from CAM as a page: what came of running it through, the path, joints, the arm along it.

use truecut_plan::cam::CamPath;
use truecut_plan::program::Program;

use super::cam_files::{Planned, Seen};
use super::files::few;
use crate::figure::{BLUE, Figure, GREEN, Layer, Legend, ORANGE, Panel};
use crate::page::{self, Page, Space};
use crate::program::{RunThrough, told};

/// Colours of moves in space.
const CUTTING_RGB: [u8; 3] = [0, 114, 178];
const RAPID_RGB: [u8; 3] = [242, 142, 43];

/// The page.
pub(super) fn page(planned: &Planned<'_>, seen: &Seen, run: &RunThrough<'_>) -> Page {
    let (read, program) = (planned.read, planned.program);
    let mut page = Page::new("path", format!("{}: path", program.name));
    let headline = match run.holds() {
        true => "The arm can follow it",
        false => "The arm cannot follow it as it is",
    };
    let detail = format!("{} points of the file", read.points.len());
    page.verdict(run.holds(), headline, &detail);
    page.told(&told(run));
    let figure = |title: &str, panels| Figure {
        title: title.to_owned(),
        panels,
        columns: 1,
        legend: Legend::Above,
    };
    let mut of_arm = vec![joints(seen)];
    of_arm.extend(clearance(seen));
    let figures = [
        figure("The path as the file has it", of_path(read).into()),
        figure("The arm along it", of_arm),
    ];
    page.figures("Path", figures);
    page.space("In space", space(planned, seen));
    page.text(page::called());
    page
}

/// From above, heights and feeds along the way; frame of the file.
fn of_path(read: &CamPath) -> [Panel; 3] {
    let mut along_mm = 0.0;
    let (mut cutting, mut rapid) = (Curve::default(), Curve::default());
    let (mut height, mut feed) = (Vec::new(), Vec::new());
    let points = read.points.iter();
    for (k, point) in points.enumerate() {
        let before = k.checked_sub(1).map_or(point, |k| &read.points[k]);
        let at = |place: &truecut_plan::cam::CamPoint| {
            let place = place.place_m * 1e3;
            (place.x, place.y)
        };
        along_mm += (point.place_m - before.place_m).norm() * 1e3;
        let own = match point.feed_m_per_s {
            Some(_) => &mut cutting,
            None => &mut rapid,
        };
        own.leg(k, at(before), at(point));
        height.push((along_mm, point.place_m.z * 1e3));
        let feed_mm_per_s = point.feed_m_per_s.map_or(f64::NAN, |feed| feed * 1e3);
        feed.push((along_mm, feed_mm_per_s));
    }
    let along = "along the path [mm]";
    [
        Panel::new(
            "from above",
            "x [mm]",
            "y [mm]",
            vec![
                Layer::line("with feed", cutting.points, BLUE),
                Layer::dashed("rapid", rapid.points, ORANGE),
            ],
        )
        .evenly(),
        Panel::new(
            "",
            along,
            "z [mm]",
            vec![Layer::line("height", height, BLUE)],
        ),
        Panel::new("", along, "[mm/s]", vec![Layer::line("feed", feed, GREEN)]),
    ]
}

/// Legs of one kind, broken where others lie between.
#[derive(Default)]
struct Curve {
    points: Vec<(f64, f64)>,
    last: Option<usize>,
}

impl Curve {
    fn leg(&mut self, k: usize, from: (f64, f64), to: (f64, f64)) {
        if self.last.is_none_or(|last| last + 1 != k) {
            self.points.extend([(f64::NAN, f64::NAN), from]);
        }
        self.points.push(to);
        self.last = Some(k);
    }
}

fn joints(seen: &Seen) -> Panel {
    let columns = seen.columns.iter().zip(&seen.channels);
    let joints = columns.filter(|(_, channel)| channel.name.starts_with("joint"));
    let layers = joints.enumerate().map(|(k, (column, channel))| {
        let degrees = column.iter().map(|angle| angle.to_degrees());
        Layer::line(&channel.name, seen.time_s.iter().copied().zip(degrees), k)
    });
    Panel::new("", "time [s]", "[deg]", layers.collect())
}

fn clearance(seen: &Seen) -> Option<Panel> {
    let named = |name: &str| {
        seen.channels
            .iter()
            .position(|channel| channel.name == name)
    };
    let column = &seen.columns[named(super::cam_files::CLEARANCE)?];
    let mm = column.iter().map(|m| m * 1e3);
    let layer = Layer::line("clearance", seen.time_s.iter().copied().zip(mm), BLUE);
    Some(Panel::new(
        "nearest bodies",
        "time [s]",
        "[mm]",
        vec![layer],
    ))
}

/// The arm at moments of the way, and the way of the tool.
fn space(planned: &Planned<'_>, seen: &Seen) -> Space {
    let mut space = Space::of_scene(
        "The arm and the way of its tool",
        &seen.scene,
        &few(&seen.frames),
    );
    let (cutting, rapid) = ways(planned.read, planned.program);
    space.lines("path", CUTTING_RGB, cutting);
    space.lines("rapid moves", RAPID_RGB, rapid);
    space
}

type Lines = Vec<Vec<[f64; 3]>>;

/// The tool's way in the world, with feed and rapid.
fn ways(read: &CamPath, program: &Program) -> (Lines, Lines) {
    let (mut cutting, mut rapid): (Lines, Lines) = (Vec::new(), Vec::new());
    let mut last: Option<([f64; 3], bool)> = None;
    for (step, point) in program.moves.iter().zip(&read.points) {
        let place = program.world_from_base * step.base_from_tool;
        let place: [f64; 3] = place.translation.vector.into();
        let feeds = point.feed_m_per_s.is_some();
        let own = if feeds { &mut cutting } else { &mut rapid };
        match (last, own.last_mut()) {
            (Some((_, before)), Some(line)) if before == feeds => line.push(place),
            (Some((from, _)), _) => own.push(vec![from, place]),
            (None, _) => own.push(vec![place]),
        }
        last = Some((place, feeds));
    }
    (cutting, rapid)
}
