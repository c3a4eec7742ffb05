//! The 3-D scene in the viewer's terms.

use super::store::{Logged, Store};
use nalgebra::{Point3, Vector3};
use re_chunk::TimeColumn;
use re_sdk_types::archetypes::{Arrows3D, LineStrips3D, Transform3D, ViewCoordinates};
use re_sdk_types::components::{Color, Radius};
use truecut_recording::{Arrow, Body, Field, Frame, Pose, Scene, significant};

use super::field;

use super::shapes::{isometry, log_shapes, quaternion, rgba, translation};
use super::{SCENE, time_column};

/// Logs what moves; shapes are logged once, then only poses that change.
pub(super) struct SceneLogger {
    bodies: Vec<LoggedBody>,
    arrows: Vec<Arrow>,
    /// With their values so far.
    fields: Vec<(Field, Vec<f32>)>,
    track: Track,
}

/// Where the first force acted: the path of the tool, as drawn and as it is. The arm that carries
/// the force is drawn with its deflection enlarged, and behind it stands where it is.
#[derive(Default)]
struct Track {
    /// Bodies of the last link, enlarged and true.
    links: Option<[usize; 2]>,
    drawn: Vec<Vector3<f64>>,
    true_m: Vec<Vector3<f64>>,
}

/// A tool that goes further than this is led along a path, m.
const LED_M: f64 = 5e-3;

impl Track {
    fn of(scene: &Scene) -> Track {
        let last = |arm: &str| {
            let is_of = |body: &Body| body.path.starts_with(arm);
            scene.bodies.iter().rposition(is_of)
        };
        let links = last("arm/exaggerated/").zip(last("arm/true/"));
        Track {
            links: links.map(|(enlarged, own)| [enlarged, own]),
            ..Track::default()
        }
    }

    fn extend(&mut self, frames: &[Frame]) {
        for frame in frames {
            let Some((origin_m, _)) = frame.arrows.first() else {
                continue;
            };
            let drawn = Point3::from(*origin_m);
            let own = self.links.map_or(drawn, |links| {
                let [enlarged, own] = links.map(|link| isometry(&frame.poses[link]));
                own * enlarged.inverse_transform_point(&drawn)
            });
            self.drawn.push(drawn.coords);
            self.true_m.push(own.coords);
        }
    }

    /// Of a tool that stays where it is, how it moves, enlarged; of one that is led, where it was:
    /// its deflection, enlarged, would hide the way, and leave the workpiece.
    fn shown(self) -> Vec<[f32; 3]> {
        let points = self.true_m.iter();
        let ends = points
            .map(|p| (*p, *p))
            .reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)));
        let is_led = ends.is_some_and(|(low, high)| (high - low).norm() > LED_M);
        let track = if is_led { self.true_m } else { self.drawn };
        (track.iter().map(|point| point.map(|x| x as f32).into())).collect()
    }
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
            track: Track::of(scene),
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
            let labels = forces.clone().map(|(_, force_n)| label(arrow, force_n));
            let columns = Arrows3D::update_fields()
                .with_labels(labels)
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
        self.track.extend(frames);
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
        let path = self.track.shown();
        if path.len() < 2 {
            return Ok(());
        }
        let line = LineStrips3D::new([path])
            .with_colors([Color::from_rgb(255, 240, 150)])
            .with_radii([Radius::new_ui_points(0.8)]);
        stream.log_static(format!("{SCENE}/tool_path"), &line)
    }
}

/// The name of a force with its size; nothing while there is none.
fn label(arrow: &Arrow, force_n: [f64; 3]) -> String {
    let size_n = Vector3::from(force_n).norm();
    match size_n > LEAST_N {
        true => format!("{} {} N", arrow.label, significant(size_n, 2)),
        false => String::new(),
    }
}

/// Less is no force, N.
const LEAST_N: f64 = 0.05;

fn send_poses(stream: &Store, entity: &str, times: TimeColumn, poses: &[Pose]) -> Logged<()> {
    let columns = Transform3D::update_fields()
        .with_many_translation(poses.iter().map(translation))
        .with_many_quaternion(poses.iter().map(quaternion))
        .columns_of_unit_batches()?;
    stream.send_columns(entity, [times], columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm that gives way by `off_m` sideways, drawn a hundred times as much, whose tool goes
    /// `way_m` ahead.
    fn shown(way_m: f64, off_m: f64) -> Vec<[f32; 3]> {
        let body = |path: &str| Body {
            path: path.into(),
            shapes: Vec::new(),
            initial_pose: Pose::IDENTITY,
        };
        let scene = Scene {
            bodies: vec![body("arm/exaggerated/link"), body("arm/true/link")],
            ..Scene::default()
        };
        let mut track = Track::of(&scene);
        let frame = |k: u32| {
            let (x, y) = (way_m * f64::from(k) / 10.0, off_m * f64::from(k % 2));
            Frame {
                time_s: f64::from(k),
                poses: vec![
                    Pose::translation([x, 100.0 * y, 0.0]),
                    Pose::translation([x, y, 0.0]),
                ],
                arrows: vec![([x, 100.0 * y, 0.3], [0.0; 3])],
                fields: Vec::new(),
            }
        };
        track.extend(&(0..=10).map(frame).collect::<Vec<_>>());
        track.shown()
    }

    #[test]
    fn a_tool_that_is_led_is_shown_where_it_was_and_one_that_stays_as_it_moves() {
        let led = shown(0.1, 1e-4);
        assert!(led.iter().all(|p| p[1] <= 1.001e-4 && p[2] == 0.3));
        assert!((led[10][0] - 0.1).abs() < 1e-6);
        let held = shown(0.0, 1e-5);
        assert!((held[1][1] - 1e-3).abs() < 1e-9);
    }
}
