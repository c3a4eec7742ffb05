//! Shapes in the viewer's terms.

use nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use rerun::components::FillMode;
use rerun::{AsComponents, RecordingStream, RecordingStreamResult};
use truecut_recording::{Geometry, Pose, Shape};

/// A pose to calculate with.
pub(super) fn isometry(pose: &Pose) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_quaternion(Quaternion::from(pose.rotation_xyzw));
    Isometry3::from_parts(pose.translation_m.into(), turn)
}

pub(super) fn translation(pose: &Pose) -> [f32; 3] {
    single(&pose.translation_m)
}

pub(super) fn quaternion(pose: &Pose) -> rerun::Quaternion {
    rerun::Quaternion::from_xyzw(pose.rotation_xyzw.map(|value| value as f32))
}

pub(super) fn rgba([r, g, b, a]: [u8; 4]) -> rerun::Color {
    rerun::Color::from_unmultiplied_rgba(r, g, b, a)
}

/// The viewer's precision.
fn single(point_m: &[f64; 3]) -> [f32; 3] {
    point_m.map(|value| value as f32)
}

/// Shapes of one kind and look, with the measures that tell them apart.
struct Kind<'a, M>(Vec<(&'a Shape, M)>);

/// A translucent shape is the shadow of another that nearly coincides with it. Two surfaces in one
/// place flicker, so the shadow is drawn as an outline.
fn is_shadow(shape: &Shape) -> bool {
    shape.color_rgba[3] < u8::MAX
}

fn fill(shadow: bool) -> FillMode {
    if shadow {
        FillMode::MajorWireframe
    } else {
        FillMode::Solid
    }
}

impl<'a, M: Copy> Kind<'a, M> {
    fn of(shapes: &[&'a Shape], measures: impl Fn(&Geometry) -> Option<M>) -> Kind<'a, M> {
        Kind(
            shapes
                .iter()
                .filter_map(|shape| Some((*shape, measures(&shape.geometry)?)))
                .collect(),
        )
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn measures(&self) -> impl Iterator<Item = M> {
        self.0.iter().map(|(_, measures)| *measures)
    }

    fn centers(&self) -> impl Iterator<Item = [f32; 3]> {
        self.0
            .iter()
            .map(|(shape, _)| translation(&shape.body_from_shape))
    }

    fn quaternions(&self) -> impl Iterator<Item = rerun::Quaternion> {
        self.0
            .iter()
            .map(|(shape, _)| quaternion(&shape.body_from_shape))
    }

    fn colors(&self) -> impl Iterator<Item = rerun::Color> {
        self.0.iter().map(|(shape, _)| {
            let [r, g, b, _] = shape.color_rgba;
            rerun::Color::from_rgb(r, g, b)
        })
    }
}

/// Logs a body's shapes once: those of a kind together, meshes and lines one by one.
pub(super) fn log_shapes(
    stream: &RecordingStream,
    entity: &str,
    shapes: &[Shape],
) -> RecordingStreamResult<()> {
    for shadow in [false, true] {
        let alike: Vec<&Shape> = shapes
            .iter()
            .filter(|shape| is_shadow(shape) == shadow)
            .collect();
        let entity = if shadow {
            format!("{entity}/shadow")
        } else {
            entity.to_owned()
        };
        log_boxes_and_balls(stream, &entity, &alike, fill(shadow))?;
        log_round_bars(stream, &entity, &alike, fill(shadow))?;
    }
    for (index, shape) in shapes.iter().enumerate() {
        log_single(stream, &format!("{entity}/shape_{index}"), shape)?;
    }
    Ok(())
}

fn log_boxes_and_balls(
    stream: &RecordingStream,
    entity: &str,
    shapes: &[&Shape],
    fill: FillMode,
) -> RecordingStreamResult<()> {
    let boxes = Kind::of(shapes, |geometry| match geometry {
        Geometry::Box { half_extents_m } => Some(single(half_extents_m)),
        _ => None,
    });
    if !boxes.is_empty() {
        let form = rerun::Boxes3D::from_half_sizes(boxes.measures())
            .with_centers(boxes.centers())
            .with_quaternions(boxes.quaternions())
            .with_colors(boxes.colors())
            .with_fill_mode(fill);
        stream.log_static(format!("{entity}/boxes"), &form)?;
    }
    let balls = Kind::of(shapes, |geometry| match geometry {
        Geometry::Sphere { radius_m } => Some(*radius_m as f32),
        _ => None,
    });
    if !balls.is_empty() {
        let form = rerun::Ellipsoids3D::from_centers_and_radii(balls.centers(), balls.measures())
            .with_colors(balls.colors())
            .with_fill_mode(fill);
        stream.log_static(format!("{entity}/balls"), &form)?;
    }
    Ok(())
}

fn log_round_bars(
    stream: &RecordingStream,
    entity: &str,
    shapes: &[&Shape],
    fill: FillMode,
) -> RecordingStreamResult<()> {
    let cylinders = Kind::of(shapes, |geometry| match geometry {
        Geometry::Cylinder { radius_m, length_m } => Some((*length_m as f32, *radius_m as f32)),
        _ => None,
    });
    if !cylinders.is_empty() {
        let (lengths, radii): (Vec<f32>, Vec<f32>) = cylinders.measures().unzip();
        let form = rerun::Cylinders3D::from_lengths_and_radii(lengths, radii)
            .with_centers(cylinders.centers())
            .with_quaternions(cylinders.quaternions())
            .with_colors(cylinders.colors())
            .with_fill_mode(fill);
        stream.log_static(format!("{entity}/cylinders"), &form)?;
    }
    let capsules = Kind::of(shapes, |geometry| match geometry {
        Geometry::Capsule { radius_m, length_m } => Some((*length_m as f32, *radius_m as f32)),
        _ => None,
    });
    if !capsules.is_empty() {
        let (lengths, radii): (Vec<f32>, Vec<f32>) = capsules.measures().unzip();
        // The viewer's capsule begins at its origin and goes along z; ours is centred.
        let starts = capsules
            .0
            .iter()
            .map(|(shape, (length, _))| down_z(&shape.body_from_shape, 0.5 * length));
        let form = rerun::Capsules3D::from_lengths_and_radii(lengths.clone(), radii)
            .with_translations(starts)
            .with_quaternions(capsules.quaternions())
            .with_colors(capsules.colors())
            .with_fill_mode(fill);
        stream.log_static(format!("{entity}/capsules"), &form)?;
    }
    Ok(())
}

/// The point at a distance along the pose's own −z axis.
fn down_z(pose: &Pose, distance_m: f32) -> [f32; 3] {
    let point = isometry(pose) * Point3::new(0.0, 0.0, -f64::from(distance_m));
    single(&point.coords.into())
}

/// A shape with points of its own; any other has been logged with its kind.
fn log_single(stream: &RecordingStream, entity: &str, shape: &Shape) -> RecordingStreamResult<()> {
    let color = rgba(shape.color_rgba);
    let form: Box<dyn AsComponents> = match &shape.geometry {
        Geometry::Mesh {
            vertices_m,
            triangles,
        } => {
            let (corners, normals) = flat_triangles(vertices_m, triangles);
            let mesh = rerun::Mesh3D::new(corners).with_vertex_normals(normals);
            Box::new(mesh.with_albedo_factor(*color))
        }
        Geometry::Line { points_m, radius_m } => {
            let lines = rerun::LineStrips3D::new([points_m.iter().map(single).collect::<Vec<_>>()]);
            Box::new(lines.with_colors([color]).with_radii([*radius_m as f32]))
        }
        _ => return Ok(()),
    };
    let place = rerun::Transform3D::new()
        .with_translation(translation(&shape.body_from_shape))
        .with_quaternion(quaternion(&shape.body_from_shape));
    stream.log_static(entity, &[&place as &dyn AsComponents, form.as_ref()])
}

/// Corners that no two triangles share, each with its triangle's normal: machined parts have edges,
/// and shared normals would round them off. A triangle that names a corner which is not there, or
/// that has no area, is left out.
fn flat_triangles(
    vertices_m: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let mut corners = Vec::with_capacity(3 * triangles.len());
    let mut normals = Vec::with_capacity(3 * triangles.len());
    for triangle in triangles {
        let [Some(a), Some(b), Some(c)] = triangle.map(|corner| vertices_m.get(corner as usize))
        else {
            continue;
        };
        let side = |to: &[f64; 3]| Vector3::from(*to) - Vector3::from(*a);
        if let Some(normal) = side(b).cross(&side(c)).try_normalize(0.0) {
            corners.extend([a, b, c].map(single));
            normals.extend([single(&normal.into()); 3]);
        }
    }
    (corners, normals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_a_capsule_begins_half_its_length_down_its_axis() {
        // A quarter turn about x takes z to −y, so that down is +y.
        let half = 0.5_f64.sqrt();
        let pose = Pose {
            translation_m: [1.0, 2.0, 3.0],
            rotation_xyzw: [half, 0.0, 0.0, half],
        };
        let start = down_z(&pose, 0.5);
        for (found, expected) in start.into_iter().zip([1.0, 2.5, 3.0]) {
            assert!((found - expected).abs() < 1e-6, "{start:?}");
        }
    }

    #[test]
    fn triangles_get_their_own_normals_and_bad_ones_are_left_out() {
        let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let (corners, normals) = flat_triangles(&vertices, &[[0, 1, 2], [0, 1, 1], [0, 1, 9]]);
        assert_eq!(corners.len(), 3);
        assert_eq!(normals, [[0.0, 0.0, 1.0]; 3]);
    }
}
