//! What is drawn: primitive shapes of a URDF with their colour.

use std::collections::HashMap;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use urdf_rs::Geometry;

use crate::model::{Shape, Visual};

/// Colour of a visual without material: light grey.
pub(crate) const DEFAULT_RGBA: [f32; 4] = [0.8, 0.8, 0.8, 1.0];

/// Colours of the materials that a file names.
pub(crate) type Palette<'a> = HashMap<&'a str, [f64; 4]>;

pub(crate) fn palette(urdf: &urdf_rs::Robot) -> Palette<'_> {
    (urdf.materials.iter())
        .filter_map(|m| Some((m.name.as_str(), m.color.as_ref()?.rgba.0)))
        .collect()
}

/// The visual, `None` if it is a mesh.
pub(crate) fn visual(urdf: &urdf_rs::Visual, palette: &Palette) -> Option<Visual> {
    Some(Visual {
        shape: shape(&urdf.geometry)?,
        link_from_visual: pose(&urdf.origin),
        color_rgba: color(urdf, palette).unwrap_or(DEFAULT_RGBA),
    })
}

fn shape(geometry: &Geometry) -> Option<Shape> {
    Some(match geometry {
        Geometry::Box { size } => Shape::Box {
            half_extents_m: Vector3::from(size.0) * 0.5,
        },
        &Geometry::Cylinder { radius, length } => Shape::Cylinder {
            radius_m: radius,
            length_m: length,
        },
        &Geometry::Capsule { radius, length } => Shape::Capsule {
            radius_m: radius,
            length_m: length,
        },
        &Geometry::Sphere { radius } => Shape::Sphere { radius_m: radius },
        Geometry::Mesh { .. } => return None,
    })
}

/// The colour that a visual is given, by itself or by a material that the file names.
pub(crate) fn color(urdf: &urdf_rs::Visual, palette: &Palette) -> Option<[f32; 4]> {
    let rgba = urdf.material.as_ref().and_then(|material| {
        let own = material.color.as_ref().map(|color| color.rgba.0);
        own.or_else(|| palette.get(material.name.as_str()).copied())
    });
    rgba.map(|rgba| rgba.map(|v| v as f32))
}

/// The transform that a URDF gives by position and roll, pitch, yaw.
pub(crate) fn pose(origin: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = origin.rpy.0;
    Isometry3::from_parts(
        Translation3::from(Vector3::from(origin.xyz.0)),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}
