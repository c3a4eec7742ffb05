//! Which views the recording opens on.

use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, EyeControls3D, PlotLegend, VisualBounds2D,
};
use rerun::external::re_sdk_types::blueprint::components as kinds;
use rerun::{RecordingStream, RecordingStreamResult};
use truecut_recording::{Camera, Header, Scene};

use super::blueprint::{Layout, Part};
use super::chart::{ACROSS, DOWN};
use super::results::{ABOUT, CLAIMS, Drawn, SCENARIO};
use super::series::FOOT_STATE;
use super::{SCENE, camera};
use crate::display::{Group, Place};

/// The layout; while the run is under way (`charts` is `None`) only what is in front, at the end everything.
///
/// Left: the arm and its tool, below them the claims. Right: what is measured, over time; below it the state of the foot and tabs
/// with spectra, profiles and all other channels.
pub(super) fn send(
    stream: &RecordingStream,
    header: &Header,
    groups: &[Group],
    has_foot: bool,
    charts: Option<&[Drawn]>,
) -> RecordingStreamResult<()> {
    let layout = Layout::new(super::application(header))?;
    let scene = scene_views(&layout, &header.scene)?;
    let texts = [("Claims", CLAIMS), ("About this run", ABOUT), ("Scenario", SCENARIO)];
    let texts = texts
        .into_iter()
        .map(|(title, entity)| layout.view("TextDocument", title, entity, &["$origin".to_owned()], &[]))
        .collect::<RecordingStreamResult<Vec<_>>>()?;
    let texts = layout.tabs("Texts", &texts)?;
    let left = layout.stacked(vec![(5.0, scene), (3.0, texts)])?;

    let mut right = Vec::new();
    for group in groups.iter().filter(|group| group.place != Place::Behind) {
        right.push((3.0, curves(&layout, group)?));
    }
    if has_foot {
        let query = ["$origin/**".to_owned()];
        right.push((1.2, layout.view("StateTimeline", "Foot: sticks (green), slides (red), lifted off (grey)", FOOT_STATE, &query, &[])?));
    }
    let mut tabs = Vec::new();
    if let Some(charts) = charts {
        for chart in charts {
            tabs.push(chart_view(&layout, chart)?);
        }
        for group in groups.iter().filter(|group| group.place == Place::Behind) {
            tabs.push(curves(&layout, group)?);
        }
    }
    if !tabs.is_empty() {
        right.push((4.0, layout.tabs("More", &tabs)?));
    }
    let right = layout.stacked(right)?;
    let root = layout.side_by_side(vec![(1.0, left), (1.1, right)])?;
    layout.send(&root, stream)
}

fn curves(layout: &Layout, group: &Group) -> RecordingStreamResult<Part> {
    let queries: Vec<String> = group.series.iter().map(|series| format!("+ {}", series.entity)).collect();
    let legend = PlotLegend::new().with_corner(kinds::Corner2D::LeftTop);
    layout.view("TimeSeries", &group.title, "/", &queries, &[("PlotLegend", &legend)])
}

fn chart_view(layout: &Layout, chart: &Drawn) -> RecordingStreamResult<Part> {
    let range = rerun::datatypes::Range2D {
        x_range: ACROSS.into(),
        y_range: DOWN.into(),
    };
    let bounds = VisualBounds2D::new(range);
    let query = ["$origin/**".to_owned()];
    layout.view("2D", &chart.title, &chart.entity, &query, &[("VisualBounds2D", &bounds)])
}

/// The whole arm, and beside it the tool from near by.
fn scene_views(layout: &Layout, scene: &Scene) -> RecordingStreamResult<Part> {
    let exaggerated = scene.bodies.iter().any(|body| body.path.contains("exaggerated"));
    let enlarged = exaggerated && scene.deflection_scale != 1.0;
    let scale = scene.deflection_scale;
    let title =
        if enlarged { format!("Arm, deflection ×{scale} (grey: true)") } else { "Arm".to_owned() };
    let arm = scene_view(layout, &title, scene.camera.unwrap_or_else(|| camera::whole(scene)))?;
    let Some(near) = camera::near_tool(scene) else { return Ok(arm) };
    let title = if enlarged { format!("Tool, deflection ×{scale}") } else { "Tool".to_owned() };
    let tool = scene_view(layout, &title, near)?;
    layout.side_by_side(vec![(1.0, arm), (1.0, tool)])
}

fn scene_view(layout: &Layout, title: &str, camera: Camera) -> RecordingStreamResult<Part> {
    let single = |point: [f64; 3]| point.map(|value| value as f32);
    let eye = EyeControls3D::new()
        .with_kind(kinds::Eye3DKind::Orbital)
        .with_position(single(camera.position_m))
        .with_look_target(single(camera.target_m))
        .with_eye_up([0.0, 0.0, 1.0]);
    let background = Background::new(kinds::BackgroundKind::SolidColor).with_color(rerun::Color::from_rgb(28, 30, 34));
    let query = ["$origin/**".to_owned()];
    layout.view("3D", title, SCENE, &query, &[("EyeControls3D", &eye), ("Background", &background)])
}
