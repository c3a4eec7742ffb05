//! Shapes in the viewer's terms.

use super::store::{Logged, Store};
use nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion};
use re_sdk_types::AsComponents;
use re_sdk_types::archetypes::{
    Boxes3D, Capsules3D, Cylinders3D, Ellipsoids3D, LineStrips3D, Mesh3D, Transform3D,
};
use re_sdk_types::components::FillMode;
use re_sdk_types::components::{Color, Radius};
use re_sdk_types::datatypes;
use truecut_recording::{Geometry, Pose, Shape};

use super::surface::Surface;

/// Half the thickness of the outline of a shadow, points of the screen.
const SHADOW_LINE: f32 = 0.4;

/// A pose to calculate with.
pub(super) fn isometry(pose: &Pose) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_quaternion(Quaternion::from(pose.rotation_xyzw));
    Isometry3::from_parts(pose.translation_m.into(), turn)
}

pub(super) fn translation(pose: &Pose) -> [f32; 3] {
    single(&pose.translation_m)
}

pub(super) fn quaternion(pose: &Pose) -> datatypes::Quaternion {
    datatypes::Quaternion::from_xyzw(pose.rotation_xyzw.map(|value| value as f32))
}

pub(super) fn rgba([r, g, b, a]: [u8; 4]) -> Color {
    Color::from_unmultiplied_rgba(r, g, b, a)
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

    fn quaternions(&self) -> impl Iterator<Item = datatypes::Quaternion> {
        self.0
            .iter()
            .map(|(shape, _)| quaternion(&shape.body_from_shape))
    }

    fn colors(&self) -> impl Iterator<Item = Color> {
        self.0.iter().map(|(shape, _)| {
            let [r, g, b, _] = shape.color_rgba;
            Color::from_rgb(r, g, b)
        })
    }
}

/// Logs a body's shapes once: those of a kind together, meshes and lines one by one.
pub(super) fn log_shapes(stream: &Store, entity: &str, shapes: &[Shape]) -> Logged<()> {
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
    stream: &Store,
    entity: &str,
    shapes: &[&Shape],
    fill: FillMode,
) -> Logged<()> {
    let boxes = Kind::of(shapes, |geometry| match geometry {
        Geometry::Box { half_extents_m } => Some(single(half_extents_m)),
        _ => None,
    });
    if !boxes.is_empty() {
        let form = Boxes3D::from_half_sizes(boxes.measures())
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
        let form = Ellipsoids3D::from_centers_and_radii(balls.centers(), balls.measures())
            .with_colors(balls.colors())
            .with_fill_mode(fill);
        stream.log_static(format!("{entity}/balls"), &form)?;
    }
    Ok(())
}

fn log_round_bars(stream: &Store, entity: &str, shapes: &[&Shape], fill: FillMode) -> Logged<()> {
    let cylinders = Kind::of(shapes, |geometry| match geometry {
        Geometry::Cylinder { radius_m, length_m } => Some((*length_m as f32, *radius_m as f32)),
        _ => None,
    });
    if !cylinders.is_empty() {
        let (lengths, radii): (Vec<f32>, Vec<f32>) = cylinders.measures().unzip();
        let form = Cylinders3D::from_lengths_and_radii(lengths, radii)
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
        let form = Capsules3D::from_lengths_and_radii(lengths.clone(), radii)
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
fn log_single(stream: &Store, entity: &str, shape: &Shape) -> Logged<()> {
    let color = rgba(shape.color_rgba);
    let form: Box<dyn AsComponents> = match &shape.geometry {
        Geometry::Mesh {
            vertices_m,
            triangles,
        } => {
            let surface = Surface::new(vertices_m, triangles);
            if is_shadow(shape) {
                let edges = surface.sharp_edges();
                let lines = LineStrips3D::new(edges.iter().map(|edge| edge.map(|p| single(&p))));
                let [r, g, b, _] = shape.color_rgba;
                let lines = lines.with_colors([Color::from_rgb(r, g, b)]);
                Box::new(lines.with_radii([Radius::new_ui_points(SHADOW_LINE)]))
            } else {
                let (corners, normals, faces) = surface.shaded();
                let mesh = Mesh3D::new(corners.iter().map(single));
                let mesh = mesh.with_triangle_indices(faces);
                let mesh = mesh.with_vertex_normals(normals.iter().map(single));
                Box::new(mesh.with_albedo_factor(*color))
            }
        }
        Geometry::Line { points_m, radius_m } => {
            let lines = LineStrips3D::new([points_m.iter().map(single).collect::<Vec<_>>()]);
            Box::new(lines.with_colors([color]).with_radii([*radius_m as f32]))
        }
        _ => return Ok(()),
    };
    let place = Transform3D::new()
        .with_translation(translation(&shape.body_from_shape))
        .with_quaternion(quaternion(&shape.body_from_shape));
    stream.log_static(entity, &[&place as &dyn AsComponents, form.as_ref()])
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
}
