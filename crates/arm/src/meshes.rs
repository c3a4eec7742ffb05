//! Meshes that a robot's file names.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

/// A mesh of a link.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeshReference {
    /// As written: `package://NAME/…`, `file://…` or a path.
    pub(crate) file: String,
    pub(crate) scale: Vector3<f64>,
    pub(crate) link_from_mesh: Isometry3<f64>,
    /// For collision, rather than to be seen.
    pub(crate) is_collision: bool,
}

/// The meshes of every link, in file order; numbers that cannot be read count as not given, since
/// nothing but volumes and pictures depends on them.
pub(crate) fn references(text: &str) -> Vec<Vec<MeshReference>> {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let Ok(document) = Document::parse_with_options(text, options) else {
        return Vec::new();
    };
    let links = document.root_element().children();
    let links = links.filter(|node| node.has_tag_name("link"));
    links.map(|link| of_link(&link)).collect()
}

fn of_link(link: &Node) -> Vec<MeshReference> {
    let shapes = link.children().filter_map(|shape| {
        let is_collision = shape.has_tag_name("collision");
        if !(is_collision || shape.has_tag_name("visual")) {
            return None;
        }
        let mesh = shape.descendants().find(|node| node.has_tag_name("mesh"))?;
        let origin = shape.children().find(|node| node.has_tag_name("origin"));
        let numbers = |name| origin.and_then(|origin| three(origin.attribute(name)?));
        let [x, y, z] = numbers("xyz").unwrap_or_default();
        let [roll, pitch, yaw] = numbers("rpy").unwrap_or_default();
        Some(MeshReference {
            file: mesh.attribute("filename")?.trim().to_owned(),
            scale: Vector3::from(mesh.attribute("scale").and_then(three).unwrap_or([1.0; 3])),
            link_from_mesh: Isometry3::from_parts(
                Translation3::new(x, y, z),
                UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            ),
            is_collision,
        })
    });
    shapes.collect()
}

fn three(text: &str) -> Option<[f64; 3]> {
    let numbers = text.split_whitespace().map(|word| word.parse::<f64>().ok());
    let numbers: Option<Vec<f64>> = numbers.collect();
    let numbers: [f64; 3] = numbers?.try_into().ok()?;
    numbers.iter().all(|n| n.is_finite()).then_some(numbers)
}
