//! The 3-D scene in the viewer's terms.

use super::store::{Logged, Store};
use re_chunk::TimeColumn;
use re_sdk_types::archetypes::{Arrows3D, LineStrips3D, Transform3D, ViewCoordinates};
use re_sdk_types::components::{Color, Radius};
use truecut_recording::{Arrow, Field, Frame, Pose, Scene};

use super::field;

use super::shapes::{log_shapes, quaternion, rgba, translation};
use super::{SCENE, time_column};

/// Logs what moves; shapes are logged once, then only poses that change.
pub(super) struct SceneLogger {
    bodies: Vec<LoggedBody>,
    arrows: Vec<Arrow>,
    /// With their values so far.
    fields: Vec<(Field, Vec<f32>)>,
    /// Where the first force acted: the path of the tool.
    path: Vec<[f32; 3]>,
}

struct LoggedBody {
    entity: String,
    initial: Pose,
    /// As logged last; `None` before the first frame.
    last: Option<Pose>,
}

impl SceneLogger {
    /// Logs all shapes.
    pub(super) fn begin(stream: &Store, scene: &Scene) -> Logged<SceneLogger> {
        stream.log_static(SCENE, &ViewCoordinates::RIGHT_HAND_Z_UP())?;
        let mut bodies = Vec::new();
        for body in &scene.bodies {
            let entity = format!("{SCENE}/{}", body.path);
            log_shapes(stream, &entity, &body.shapes)?;
            bodies.push(LoggedBody {
                entity,
                initial: body.initial_pose,
                last: None,
            });
        }
        for arrow in &scene.arrows {
            let style = Arrows3D::update_fields()
                .with_colors([rgba(arrow.color_rgba)])
                .with_labels([arrow.label.as_str()])
                .with_show_labels(true)
                .with_radii([Radius::new_ui_points(2.5)]);
            stream.log_static(format!("{SCENE}/{}", arrow.path), &style)?;
        }
        for one in &scene.fields {
            field::begin(stream, &format!("{SCENE}/{}", one.path), one)?;
        }
        Ok(SceneLogger {
            bodies,
            fields: (scene.fields.iter())
                .map(|one| (one.clone(), Vec::new()))
                .collect(),
            arrows: scene.arrows.clone(),
            path: Vec::new(),
        })
    }

    /// Logs the poses and forces of some frames.
    pub(super) fn frames(&mut self, stream: &Store, frames: &[Frame]) -> Logged<()> {
        if frames.is_empty() {
            return Ok(());
        }
        let times = time_column(frames.iter().map(|frame| frame.time_s));
        for (index, body) in self.bodies.iter_mut().enumerate() {
            let poses: Vec<Pose> = frames.iter().map(|frame| frame.poses[index]).collect();
            if poses.iter().any(|pose| body.last != Some(*pose)) {
                body.last = poses.last().copied();
                send_poses(stream, &body.entity, times.clone(), &poses)?;
            }
        }
        for (index, arrow) in self.arrows.iter().enumerate() {
            let forces = frames.iter().map(|frame| frame.arrows[index]);
            let scaled =
                |force_n: [f64; 3]| force_n.map(|value| (value * arrow.metres_per_newton) as f32);
            let columns = Arrows3D::update_fields()
                .with_vectors(forces.clone().map(|(_, force_n)| scaled(force_n)))
                .with_origins(forces.map(|(origin_m, _)| origin_m.map(|value| value as f32)))
                .columns_of_unit_batches()?;
            stream.send_columns(format!("{SCENE}/{}", arrow.path), [times.clone()], columns)?;
        }
        for (index, (one, last)) in self.fields.iter_mut().enumerate() {
            for frame in frames
                .iter()
                .filter(|frame| !frame.fields[index].is_empty())
            {
                let time = time_column(std::iter::once(frame.time_s));
                let entity = format!("{SCENE}/{}", one.path);
                field::colours(stream, &entity, one, time, &frame.fields[index])?;
                last.clone_from(&frame.fields[index]);
            }
        }
        let tool = frames.iter().filter_map(|frame| frame.arrows.first());
        self.path
            .extend(tool.map(|(origin_m, _)| origin_m.map(|value| value as f32)));
        Ok(())
    }

    /// Logs the path that the tool took, once the run has ended, how fields are left, and where
    /// bodies stand of which there was no frame.
    pub(super) fn finish(self, stream: &Store) -> Logged<()> {
        for body in self.bodies.iter().filter(|body| body.last.is_none()) {
            send_poses(
                stream,
                &body.entity,
                time_column(std::iter::once(0.0)),
                &[body.initial],
            )?;
        }
        for (one, values) in self.fields.iter().filter(|(_, values)| !values.is_empty()) {
            field::end(stream, &format!("{SCENE}/{}", one.path), one, values)?;
        }
        if self.path.len() < 2 {
            return Ok(());
        }
        let line = LineStrips3D::new([self.path])
            .with_colors([Color::from_rgb(255, 240, 150)])
            .with_radii([Radius::new_ui_points(0.8)]);
        stream.log_static(format!("{SCENE}/tool_path"), &line)
    }
}

fn send_poses(stream: &Store, entity: &str, times: TimeColumn, poses: &[Pose]) -> Logged<()> {
    let columns = Transform3D::update_fields()
        .with_many_translation(poses.iter().map(translation))
        .with_many_quaternion(poses.iter().map(quaternion))
        .columns_of_unit_batches()?;
    stream.send_columns(entity, [times], columns)
}
