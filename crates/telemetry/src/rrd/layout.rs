//! Which views the recording opens on.

use super::store::{Logged, Store};
use re_sdk_types::AsComponents;
use re_sdk_types::blueprint::archetypes::{Background, EyeControls3D, PlotLegend, VisualBounds2D};
use re_sdk_types::blueprint::components as kinds;
use re_sdk_types::components::Color;
use truecut_recording::{Camera, Field, Header, Scene};

use super::blueprint::{Layout, Part};
use super::chart::DOWN;
use super::field::{END, SCALE};
use super::outline::{self, Plot};
use super::results::{ABOUT, Drawn, SCENARIO};
use super::seen::Seen;
use super::series::FOOT_STATE;
use super::verdict::CLAIMS;
use super::{SCENE, camera};
use crate::display::{Group, Place};

/// What is known only when the run has ended.
pub(super) struct AtEnd<'a> {
    pub(super) charts: &'a [Drawn],
    pub(super) seen: &'a Seen,
    /// First and last time, s.
    pub(super) time_s: [f64; 2],
}

/// Makes a layout and sends it: while the run is under way with what is in front, at the end with
/// everything. The second is a layout of its own: the viewer may have opened the first before all
/// rows were there, and its views would keep the range that they had then.
///
/// Left: the arm and its tool, below them the claims. Right: how the tool moves; tabs with the
/// forces; the state of the foot; tabs with spectra, profiles and all other channels.
pub(super) fn send(
    stream: &Store,
    header: &Header,
    groups: &[Group],
    has_foot: bool,
    at_end: Option<&AtEnd<'_>>,
) -> Logged<()> {
    let layout = Layout::new(super::application(&header.scenario_name))?;
    let left = left_side(&layout, header, at_end.is_some())?;
    let plots = |wanted: fn(Place) -> bool| {
        let chosen = groups.iter().filter(|group| wanted(group.place));
        chosen
            .map(|group| curves(&layout, group, at_end))
            .collect::<Logged<Vec<_>>>()
    };
    let mut front = plots(|place| place != Place::Behind)?.into_iter();
    let mut right: Vec<(f32, Part)> = front
        .next()
        .map(|motion| (3.5, motion))
        .into_iter()
        .collect();
    let forces: Vec<Part> = front.collect();
    if !forces.is_empty() {
        right.push((3.5, layout.tabs(&forces)?));
    }
    if has_foot {
        let title = "Foot: sticks (green), slides (red), lifted off (grey)";
        let query = ["$origin/**".to_owned()];
        let axis = at_end.and_then(|end| outline::time_axis(end.time_s));
        let axis = axis
            .iter()
            .map(|axis| ("TimeAxis", axis as &dyn AsComponents));
        let axis: Vec<_> = axis.collect();
        right.push((
            1.2,
            layout.view("StateTimeline", title, FOOT_STATE, &query, &axis)?,
        ));
    }
    if let Some(end) = at_end {
        let charts = end.charts.iter().map(|chart| chart_view(&layout, chart));
        let mut tabs = charts.collect::<Logged<Vec<_>>>()?;
        tabs.extend(plots(|place| place == Place::Behind)?);
        if !tabs.is_empty() {
            right.push((3.5, layout.tabs(&tabs)?));
        }
    }
    let right = layout.stacked(right)?;
    let root = layout.side_by_side(vec![(1.0, left), (1.1, right)])?;
    layout.send(&root, kinds::PlayState::Playing, stream)
}

fn left_side(layout: &Layout, header: &Header, at_end: bool) -> Logged<Part> {
    let texts = [
        ("Claims", CLAIMS),
        ("About this run", ABOUT),
        ("Scenario", SCENARIO),
    ];
    let texts = (texts.into_iter()).map(|(title, entity)| layout.document(title, entity));
    let texts = layout.tabs(&texts.collect::<Logged<Vec<_>>>()?)?;
    if header.scene.bodies.is_empty() {
        return Ok(texts);
    }
    let scene = scene_views(layout, &header.scene, at_end)?;
    layout.stacked(vec![(5.0, scene), (3.0, texts)])
}

/// A plot. At the end it is told how far its axes go: the viewer may open it while rows still load,
/// and it would keep the part that it had then.
fn curves(layout: &Layout, group: &Group, at_end: Option<&AtEnd<'_>>) -> Logged<Part> {
    let query = ["$origin".to_owned()];
    // Every property is a message of its own; what is in a tab makes do without.
    if group.place == Place::Behind {
        return layout.view("TimeSeries", &group.title, &group.entity, &query, &[]);
    }
    let mut corner = kinds::Corner2D::LeftTop;
    let mut axes: Vec<(&str, Box<dyn AsComponents>)> = Vec::new();
    if let (Some(end), Some(first)) = (at_end, group.series.first()) {
        if let Some(axis) = outline::time_axis(end.time_s) {
            axes.push(("TimeAxis", Box::new(axis)));
        }
        let series = group.series.iter();
        let plot = Plot(
            series
                .map(|series| (end.seen.outline(series.channel), series.unit.from_si(1.0)))
                .collect(),
        );
        if let Some(range) = plot.range(first.unit.from_si(group.least)) {
            let names: Vec<&str> = group.series.iter().map(|s| s.legend.as_str()).collect();
            corner = plot.corner(&names, end.time_s, range);
            axes.push(("ScalarAxis", Box::new(outline::value_axis(range))));
        }
    }
    axes.push((
        "PlotLegend",
        Box::new(PlotLegend::new().with_corner(corner)),
    ));
    let properties: Vec<(&str, &dyn AsComponents)> = axes
        .iter()
        .map(|(name, axis)| (*name, axis.as_ref()))
        .collect();
    layout.view(
        "TimeSeries",
        &group.title,
        &group.entity,
        &query,
        &properties,
    )
}

pub(super) fn chart_view(layout: &Layout, chart: &Drawn) -> Logged<Part> {
    let range = re_sdk_types::datatypes::Range2D {
        x_range: chart.across.into(),
        y_range: DOWN.into(),
    };
    let bounds = VisualBounds2D::new(range);
    let query = ["$origin/**".to_owned()];
    layout.view(
        "2D",
        &chart.title,
        &chart.entity,
        &query,
        &[("VisualBounds2D", &bounds)],
    )
}

/// The whole arm, and beside it the tool from near by.
pub(super) fn scene_views(layout: &Layout, scene: &Scene, at_end: bool) -> Logged<Part> {
    let aspect = camera::aspect(2 + scene.fields.len());
    let exaggerated = scene
        .bodies
        .iter()
        .any(|body| body.path.contains("exaggerated"));
    let enlarged = exaggerated && scene.deflection_scale != 1.0;
    let scale = scene.deflection_scale;
    let title = if enlarged {
        format!("Arm, deflection ×{scale} (grey: true)")
    } else {
        "Arm".to_owned()
    };
    let arm = scene_view(
        layout,
        scene,
        &title,
        scene.camera.unwrap_or_else(|| camera::whole(scene, aspect)),
    )?;
    let Some(near) = camera::near_tool(scene, aspect) else {
        return Ok(arm);
    };
    let title = if enlarged {
        format!("Tool, deflection ×{scale}")
    } else {
        "Tool".to_owned()
    };
    let tool = scene_view(layout, scene, &title, near)?;
    let mut views = vec![(1.0, arm), (1.0, tool)];
    for field in &scene.fields {
        views.push((1.0, field_view(layout, field, at_end)?));
    }
    layout.side_by_side(views)
}

fn scene_view(layout: &Layout, scene: &Scene, title: &str, camera: Camera) -> Logged<Part> {
    // Numbers of colours, and how it ends, belong to a map's own view.
    let hidden = scene.fields.iter().flat_map(|field| {
        let entity = |part: &str| format!("- $origin/{}/{part}/**", field.path);
        [SCALE, END].map(entity)
    });
    let queries: Vec<String> = (std::iter::once("$origin/**".to_owned()).chain(hidden)).collect();
    looking_at(layout, title, &queries, camera, [0.0, 0.0, 1.0])
}

/// A field alone, from above: in the scene the tool stands on it. At the end it is seen as it is
/// then, whatever the time.
fn field_view(layout: &Layout, field: &Field, at_end: bool) -> Logged<Part> {
    let (camera, up) = camera::above(field);
    let (name, path) = (field.path.replace('_', " "), &field.path);
    let (title, shown) = match at_end {
        true => (name, format!("$origin/{path}/{END}/**")),
        false => (name, format!("$origin/{path}")),
    };
    let queries = [shown, format!("$origin/{path}/{SCALE}/**")];
    looking_at(layout, &title, &queries, camera, up)
}

/// A view of the scene, or of what the queries find in it.
pub(super) fn looking_at(
    layout: &Layout,
    title: &str,
    queries: &[String],
    camera: Camera,
    up: [f64; 3],
) -> Logged<Part> {
    let single = |point: [f64; 3]| point.map(|value| value as f32);
    let eye = EyeControls3D::new()
        .with_kind(kinds::Eye3DKind::Orbital)
        .with_position(single(camera.position_m))
        .with_look_target(single(camera.target_m))
        .with_eye_up(single(up));
    let background =
        Background::new(kinds::BackgroundKind::SolidColor).with_color(Color::from_rgb(28, 30, 34));
    layout.view(
        "3D",
        title,
        SCENE,
        queries,
        &[("EyeControls3D", &eye), ("Background", &background)],
    )
}
