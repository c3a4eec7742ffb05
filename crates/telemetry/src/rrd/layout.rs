//! Which views the recording opens on.

use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, EyeControls3D, PlotLegend, ScalarAxis, VisualBounds2D,
};
use rerun::external::re_sdk_types::blueprint::components as kinds;
use rerun::{AsComponents, RecordingStream, RecordingStreamResult};
use truecut_recording::{Camera, Header, Recording, Scene};

use super::blueprint::{Layout, Part};
use super::chart::{ACROSS, DOWN};
use super::results::{ABOUT, CLAIMS, Drawn, SCENARIO};
use super::series::FOOT_STATE;
use super::{SCENE, camera};
use crate::display::{Group, Place};

/// The layout of a recording.
///
/// Left: the arm and its tool, below them the claims. Right: how the tool moves; tabs with the
/// forces; the state of the foot; tabs with all other channels and, once the run has ended, with
/// spectra and profiles before them.
pub(super) struct Screen {
    layout: Layout,
    /// The view of each group, in their order.
    plots: Vec<Part>,
    right: Part,
    /// Its contents, but for the tabs at the bottom.
    fixed: Vec<(f32, Part)>,
    tabs: Part,
}

impl Screen {
    /// Makes the layout and sends it.
    pub(super) fn begin(
        stream: &RecordingStream,
        header: &Header,
        groups: &[Group],
        has_foot: bool,
    ) -> RecordingStreamResult<Screen> {
        let layout = Layout::new(super::application(header))?;
        let left = left_side(&layout, header)?;
        let plots = groups.iter().map(|group| curves(&layout, group));
        let plots = plots.collect::<RecordingStreamResult<Vec<_>>>()?;
        let mut front = in_place(groups, &plots, |place| place != Place::Behind).into_iter();
        let mut fixed: Vec<(f32, Part)> = front
            .next()
            .map(|motion| (3.5, motion))
            .into_iter()
            .collect();
        let forces: Vec<Part> = front.collect();
        if !forces.is_empty() {
            let place = Part::container();
            layout.tabs(&place, &forces)?;
            fixed.push((3.5, place));
        }
        if has_foot {
            let title = "Foot: sticks (green), slides (red), lifted off (grey)";
            let query = ["$origin/**".to_owned()];
            fixed.push((
                1.2,
                layout.view("StateTimeline", title, FOOT_STATE, &query, &[])?,
            ));
        }
        let (right, tabs) = (Part::container(), Part::container());
        let root = layout.side_by_side(vec![(1.0, left), (1.1, right.clone())])?;
        layout.root(&root)?;
        let screen = Screen {
            layout,
            plots,
            right,
            fixed,
            tabs,
        };
        screen.fill(groups, Vec::new())?;
        screen.layout.send(stream);
        Ok(screen)
    }

    /// Adds what is known only now, and sends the layout again.
    pub(super) fn finish(
        self,
        stream: &RecordingStream,
        groups: &[Group],
        charts: &[Drawn],
        recording: &Recording,
    ) -> RecordingStreamResult<()> {
        for (group, plot) in groups.iter().zip(&self.plots) {
            if let Some(axis) = least_axis(group, recording) {
                self.layout.set(plot, "ScalarAxis", &axis)?;
            }
        }
        let charts = charts.iter().map(|chart| chart_view(&self.layout, chart));
        self.fill(groups, charts.collect::<RecordingStreamResult<_>>()?)?;
        self.layout.send(stream);
        Ok(())
    }

    /// The right side, with these charts as the first of the tabs.
    fn fill(&self, groups: &[Group], charts: Vec<Part>) -> RecordingStreamResult<()> {
        let mut tabs = charts;
        tabs.extend(in_place(groups, &self.plots, |place| {
            place == Place::Behind
        }));
        let mut right = self.fixed.clone();
        if !tabs.is_empty() {
            self.layout.tabs(&self.tabs, &tabs)?;
            right.push((3.5, self.tabs.clone()));
        }
        self.layout.stacked(&self.right, &right)
    }
}

fn in_place(groups: &[Group], plots: &[Part], wanted: impl Fn(Place) -> bool) -> Vec<Part> {
    let pairs = groups
        .iter()
        .zip(plots)
        .filter(|(group, _)| wanted(group.place));
    pairs.map(|(_, plot)| plot.clone()).collect()
}

fn left_side(layout: &Layout, header: &Header) -> RecordingStreamResult<Part> {
    let texts = [
        ("Claims", CLAIMS),
        ("About this run", ABOUT),
        ("Scenario", SCENARIO),
    ];
    let texts = texts.into_iter().map(|(title, entity)| {
        layout.view("TextDocument", title, entity, &["$origin".to_owned()], &[])
    });
    let place = Part::container();
    layout.tabs(&place, &texts.collect::<RecordingStreamResult<Vec<_>>>()?)?;
    if header.scene.bodies.is_empty() {
        return Ok(place);
    }
    let scene = scene_views(layout, &header.scene)?;
    let left = Part::container();
    layout.stacked(&left, &[(5.0, scene), (3.0, place)])?;
    Ok(left)
}

fn curves(layout: &Layout, group: &Group) -> RecordingStreamResult<Part> {
    let query = ["$origin".to_owned()];
    let legend = PlotLegend::new().with_corner(kinds::Corner2D::LeftTop);
    let properties: [(&str, &dyn AsComponents); 1] = [("PlotLegend", &legend)];
    layout.view(
        "TimeSeries",
        &group.title,
        &group.entity,
        &query,
        &properties,
    )
}

/// An axis of the least size that means something, if the curves would not fill it.
fn least_axis(group: &Group, recording: &Recording) -> Option<ScalarAxis> {
    let values = group
        .series
        .iter()
        .flat_map(|series| &recording.columns[series.channel]);
    let largest = values.fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let unit = &group.series.first()?.unit;
    let end = unit.from_si(group.least);
    let range = rerun::datatypes::Range1D([-end, end]);
    (largest < group.least).then(|| ScalarAxis::new().with_range(range))
}

fn chart_view(layout: &Layout, chart: &Drawn) -> RecordingStreamResult<Part> {
    let range = rerun::datatypes::Range2D {
        x_range: ACROSS.into(),
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
fn scene_views(layout: &Layout, scene: &Scene) -> RecordingStreamResult<Part> {
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
        &title,
        scene.camera.unwrap_or_else(|| camera::whole(scene)),
    )?;
    let Some(near) = camera::near_tool(scene) else {
        return Ok(arm);
    };
    let title = if enlarged {
        format!("Tool, deflection ×{scale}")
    } else {
        "Tool".to_owned()
    };
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
    let background = Background::new(kinds::BackgroundKind::SolidColor)
        .with_color(rerun::Color::from_rgb(28, 30, 34));
    let query = ["$origin/**".to_owned()];
    layout.view(
        "3D",
        title,
        SCENE,
        &query,
        &[("EyeControls3D", &eye), ("Background", &background)],
    )
}
