//! A planned path for the viewer: the arm along it, the reserve as the path's colour, the stiffness
//! ellipsoid at the tool, or the lines of a path on the workpiece.

use std::path::Path;

use super::store::{Logged, Store};
use re_sdk_types::archetypes::{Ellipsoids3D, LineStrips3D, Transform3D};
use re_sdk_types::blueprint::components::PlayState;
use re_sdk_types::components::{Color, Radius};
use re_sdk_types::datatypes::Quaternion;
use truecut_recording::{Frame, Scene, SinkError};

use super::blueprint::Layout;
use super::charts::{ChartPage, log_pages};
use super::layout::scene_views;
use super::results::SCENARIO;
use super::scene::SceneLogger;
use super::{SCENE, application, log_text, time_column, write_store};
use crate::error::failed;

const TEXT: &str = "/text";
/// Half the length of the ellipsoid's longest axis along the whole path, m.
const ELLIPSOID_M: f64 = 0.18;
/// Reserves from which on the path is as green, and as red, as it gets.
const GREENEST: f64 = 1.0;
const REDDEST: f64 = -0.5;

/// A plan and what is said of it.
pub struct PlanShown<'a> {
    /// What it is about.
    pub title: &'a str,
    /// What came of it.
    pub text: &'a str,
    /// The scenario with the plan.
    pub scenario: &'a str,
    /// The arm at the start.
    pub scene: &'a Scene,
    /// The arm at each station.
    pub frames: &'a [Frame],
    /// In the order of the path; with none neither reserve nor stiffness is shown.
    pub stations: &'a [PlanStation],
    /// Lines on the workpiece, world.
    pub lines: &'a [Vec<[f64; 3]>],
    /// Name of the tab of `text`.
    pub text_title: &'a str,
    /// Charts beside the arm.
    pub pages: &'a [ChartPage],
}

/// A place of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanStation {
    /// When the tool is there.
    pub time_s: f64,
    /// The tool point, world.
    pub point_m: [f64; 3],
    /// Limit or decay over what is needed, whichever is less, less 1: stable from 0 on.
    pub reserve: f64,
    /// Principal stiffnesses.
    pub stiffness_n_per_m: [f64; 3],
    /// Rotation from their axes to the world.
    pub world_from_axes_xyzw: [f64; 4],
}

/// Writes the file.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_plan(path: &Path, shown: &PlanShown<'_>) -> Result<(), SinkError> {
    write_store(path, shown.title, |store| log(store, shown))
        .map_err(failed(path, "write the plan"))
}

fn log(stream: &Store, shown: &PlanShown<'_>) -> Logged<()> {
    log_text(stream, TEXT, format!("```\n{}\n```\n", shown.text))?;
    log_text(stream, SCENARIO, super::results::scenario(shown.scenario))?;
    let mut scene = SceneLogger::begin(stream, shown.scene)?;
    scene.frames(stream, shown.frames)?;
    scene.finish(stream)?;
    if !shown.stations.is_empty() {
        log_path(stream, shown.stations)?;
        log_ellipsoid(stream, shown.stations)?;
    }
    if !shown.lines.is_empty() {
        let single = |line: &Vec<[f64; 3]>| -> Vec<[f32; 3]> {
            line.iter().map(|point| point.map(|x| x as f32)).collect()
        };
        let lines = LineStrips3D::new(shown.lines.iter().map(single))
            .with_colors([Color::from_rgb(255, 220, 90)])
            .with_radii([Radius::new_ui_points(1.2)]);
        stream.log_static(format!("{SCENE}/lines"), &lines)?;
    }
    let layout = Layout::new(application(shown.title))?;
    let words = layout.tabs(&[
        layout.document(shown.text_title, TEXT)?,
        layout.document("Scenario", SCENARIO)?,
    ])?;
    let views = scene_views(&layout, shown.scene, true)?;
    let left = layout.stacked(vec![(5.0, views), (2.5, words)])?;
    let right = log_pages(stream, &layout, shown.pages)?;
    let root = layout.side_by_side(vec![(1.2, left), (1.0, right)])?;
    layout.send(&root, PlayState::Playing, stream)
}

/// The path in pieces from station to station, each as its worse end.
fn log_path(stream: &Store, stations: &[PlanStation]) -> Logged<()> {
    let single = |point: [f64; 3]| point.map(|value| value as f32);
    let pieces = stations.windows(2);
    let strips = pieces
        .clone()
        .map(|w| [single(w[0].point_m), single(w[1].point_m)]);
    let colors = pieces.map(|w| color(w[0].reserve.min(w[1].reserve)));
    let line = LineStrips3D::new(strips)
        .with_colors(colors.map(|[r, g, b]| Color::from_rgb(r, g, b)))
        .with_radii([Radius::new_ui_points(4.0)]);
    stream.log_static(format!("{SCENE}/margin"), &line)
}

/// Red, by way of yellow at the limit, to green.
fn color(reserve: f64) -> [u8; 3] {
    let mix = |from: [f64; 3], to: [f64; 3], share: f64| -> [u8; 3] {
        std::array::from_fn(|i| (from[i] + (to[i] - from[i]) * share).round() as u8)
    };
    let (red, yellow, green) = (
        [220.0, 40.0, 40.0],
        [240.0, 200.0, 60.0],
        [40.0, 200.0, 90.0],
    );
    if reserve >= 0.0 {
        mix(yellow, green, (reserve / GREENEST).min(1.0))
    } else {
        mix(yellow, red, (reserve / REDDEST).min(1.0))
    }
}

/// Semi-axes in the ratio of the principal stiffnesses, at one scale along the path.
fn log_ellipsoid(stream: &Store, stations: &[PlanStation]) -> Logged<()> {
    let all = stations.iter().flat_map(|s| s.stiffness_n_per_m);
    let scale = ELLIPSOID_M / all.fold(f64::MIN_POSITIVE, f64::max);
    let entity = format!("{SCENE}/stiffness");
    let style = Ellipsoids3D::update_fields()
        .with_colors([Color::from_rgb(120, 190, 255)])
        .with_fill_mode(re_sdk_types::components::FillMode::MajorWireframe)
        .with_line_radii([Radius::new_ui_points(0.8)])
        .with_labels(["stiffness"]);
    stream.log_static(entity.as_str(), &style)?;
    let half = stations
        .iter()
        .map(|s| s.stiffness_n_per_m.map(|k| (k * scale) as f32));
    let columns = Ellipsoids3D::update_fields()
        .with_half_sizes(half)
        .columns_of_unit_batches()?;
    let times = time_column(stations.iter().map(|s| s.time_s));
    stream.send_columns(entity.as_str(), [times.clone()], columns)?;
    let places = stations.iter().map(|s| s.point_m.map(|x| x as f32));
    let turns = stations
        .iter()
        .map(|s| Quaternion::from_xyzw(s.world_from_axes_xyzw.map(|value| value as f32)));
    let poses = Transform3D::update_fields()
        .with_many_translation(places)
        .with_many_quaternion(turns)
        .columns_of_unit_batches()?;
    stream.send_columns(entity, [times], poses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_tell_stable_from_unstable() {
        let [red, limit, green] = [-0.9, 0.0, f64::INFINITY].map(color);
        assert!(red[0] > 200 && red[1] < 60);
        assert!(green[1] > 180 && green[0] < 60);
        assert!(limit[0] > 200 && limit[1] > 180);
    }
}
