//! What is drawn of an arm: the shapes and meshes of its files, else its links from joint to joint.

mod light;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::meshes::{LinkMesh, Part, read};
use crate::model::{FrameId, Robot, Shape, Visual};
use crate::visual::DEFAULT_RGBA;

/// Radius of a link that is drawn from joint to joint, as a part of the arm's length.
pub(crate) const RADIUS_PER_LENGTH: f64 = 0.03;

/// What is drawn of a link, in its frame.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnLink {
    pub visuals: Vec<Visual>,
    pub meshes: Vec<DrawnMesh>,
}

/// Triangles in the frame of a link, counter-clockwise seen from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnMesh {
    pub vertices_m: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
    /// Red, green, blue, opacity, each 0 to 1.
    pub color_rgba: [f32; 4],
}

impl Robot {
    /// What is drawn of the base and of each link that moves ([`crate::Chain::moving`]), and a note
    /// on every mesh that cannot be read. Heavy meshes are thinned; a link of which nothing can
    /// be drawn becomes a rod to the next joint, or to the flange.
    ///
    /// Reads the files of the meshes.
    #[must_use]
    pub fn drawn_links(&self) -> (Vec<DrawnLink>, Vec<String>) {
        let mut notes = Vec::new();
        let radius_m = RADIUS_PER_LENGTH * self.ends().map(|end| end.norm()).sum::<f64>();
        let moving = self.chain.moving().map(|body| body.link);
        let links = std::iter::once(&self.chain.base).chain(moving);
        let drawn = links.zip(self.ends()).map(|(link, end)| {
            let mut visuals = link.visuals.clone();
            let mut meshes = Vec::new();
            for mesh in &link.meshes {
                match of_file(mesh) {
                    Ok(drawn) => meshes.extend(drawn),
                    Err(why) => notes.push(format!(
                        "the mesh {} of link \"{}\" is not drawn: {why}",
                        mesh.path.display(),
                        link.name
                    )),
                }
            }
            if visuals.is_empty() && meshes.is_empty() && end.norm() > radius_m {
                visuals.push(rod(&end, radius_m));
            }
            DrawnLink { visuals, meshes }
        });
        (drawn.collect(), notes)
    }

    /// Where base and links end, each in its frame: at the next joint, or at the flange.
    pub(crate) fn ends(&self) -> impl Iterator<Item = Vector3<f64>> {
        let moving = self.chain.moving();
        let ends = moving.map(|body| body.parent_from_joint.translation.vector);
        ends.chain([self
            .last_link_from_frame(FrameId::Flange)
            .translation
            .vector])
    }
}

fn of_file(mesh: &LinkMesh) -> Result<Vec<DrawnMesh>, String> {
    Ok(light::thinned(placed(mesh)?, mesh.color_rgba))
}

/// The triangles of a link's mesh, in the link's frame.
pub(crate) fn placed(mesh: &LinkMesh) -> Result<Vec<Part>, String> {
    let place = |corner: Vector3<f64>| {
        let scaled = corner.component_mul(&mesh.scale);
        mesh.link_from_mesh.rotation * scaled + mesh.link_from_mesh.translation.vector
    };
    // A scale that mirrors turns every triangle inside out.
    let mirrors = mesh.scale.product() < 0.0;
    let mut parts = read(&mesh.path)?;
    for triangle in parts.iter_mut().flat_map(|part| &mut part.triangles) {
        *triangle = triangle.map(place);
        if mirrors {
            triangle.swap(1, 2);
        }
    }
    let parts = parts.into_iter().filter(|part| !part.triangles.is_empty());
    Ok(parts.collect())
}

/// A capsule from the origin to a point.
pub(crate) fn rod(end: &Vector3<f64>, radius_m: f64) -> Visual {
    let down = || UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let rotation = UnitQuaternion::rotation_between(&Vector3::z(), end).unwrap_or_else(down);
    Visual {
        shape: Shape::Capsule {
            radius_m,
            length_m: end.norm(),
        },
        link_from_visual: Isometry3::from_parts(Translation3::from(end * 0.5), rotation),
        color_rgba: DEFAULT_RGBA,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_a_rod_leads_from_joint_to_joint() {
        for end in [Vector3::new(0.3, -0.2, 0.6), Vector3::new(0.0, 0.0, -0.5)] {
            let rod = rod(&end, 0.05);
            let half = Vector3::z() * (0.5 * end.norm());
            let [tip, foot] =
                [half, -half].map(|at| rod.link_from_visual * nalgebra::Point3::from(at));
            assert!((tip.coords - end).norm() < 1e-12 && foot.coords.norm() < 1e-12);
        }
    }
}
