//! Meshes that a robot's file names, and where they lie on disk.

mod collada;
mod files;

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use crate::model::Shape;
use crate::packages::Packages;
use crate::tree::{Tree, TreeLink};
use crate::xml_bounds;

pub use files::{MeshData, MeshFileError};
pub(crate) use files::{Part, Triangle, read};

/// A mesh of a link.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeshReference {
    /// As written: `package://NAME/…`, `file://…` or a path.
    pub(crate) file: String,
    pub(crate) scale: Vector3<f64>,
    pub(crate) link_from_mesh: Isometry3<f64>,
    /// For collision, rather than to be seen.
    pub(crate) is_collision: bool,
    /// Red, green, blue, opacity, each 0 to 1, if the URDF says so.
    pub(crate) color_rgba: Option<[f32; 4]>,
}

/// A mesh to be drawn, fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkMesh {
    /// Its file, which is there; it is read only when it is drawn.
    pub path: PathBuf,
    /// From the file's coordinates to metres, along its axes.
    pub scale: Vector3<f64>,
    pub link_from_mesh: Isometry3<f64>,
    /// Red, green, blue, opacity, each 0 to 1; without it the file's own, or grey.
    pub color_rgba: Option<[f32; 4]>,
}

/// Finds the files of all meshes to be drawn: those to be seen, or where there are none, and no
/// primitive shapes, those for collision. A note tells of those that are not found.
pub(crate) fn find(tree: &mut Tree, urdf: &Path, packages: &Packages) -> Option<String> {
    let folder = urdf.parent().unwrap_or(Path::new("."));
    let mut missing = Vec::new();
    for link in &mut tree.links {
        let found = found(link, false, folder, packages);
        let (drawn, faults) = match found {
            (drawn, faults) if drawn.is_empty() && link.visuals.is_empty() => {
                let (collision, _) = self::found(link, true, folder, packages);
                (collision, faults)
            }
            seen => seen,
        };
        link.drawn = drawn;
        link.solids.meshes = self::found(link, true, folder, packages).0;
        if link.solids.meshes.is_empty() && link.solids.shapes.is_empty() {
            let seen = link.visuals.iter();
            link.solids.shapes = seen.map(|one| (one.shape, one.link_from_visual)).collect();
            link.solids.meshes.clone_from(&link.drawn);
        }
        missing.extend(faults);
    }
    let first = missing.first()?;
    let others = match missing.len() - 1 {
        0 => String::new(),
        count => format!(", nor are {count} others"),
    };
    Some(format!(
        "{first}{others}; links without shapes are drawn from joint to joint"
    ))
}

fn found(
    link: &TreeLink,
    is_collision: bool,
    folder: &Path,
    packages: &Packages,
) -> (Vec<LinkMesh>, Vec<String>) {
    let own = link.meshes.iter();
    let own = own.filter(|mesh| mesh.is_collision == is_collision);
    let (mut drawn, mut faults) = (Vec::new(), Vec::new());
    for mesh in own {
        match located(&mesh.file, folder, packages) {
            Ok(path) => drawn.push(LinkMesh {
                path,
                scale: mesh.scale,
                link_from_mesh: mesh.link_from_mesh,
                color_rgba: mesh.color_rgba,
            }),
            Err(why) => faults.push(format!(
                "the mesh \"{}\" of link \"{}\" is not drawn: {why}",
                mesh.file, link.name
            )),
        }
    }
    (drawn, faults)
}

/// The file of a mesh: `package://NAME/…`, `file://…`, or a path from the robot's file.
pub(crate) fn located(file: &str, folder: &Path, packages: &Packages) -> Result<PathBuf, String> {
    let path = match file.strip_prefix("package://") {
        Some(rest) => {
            let (name, inner) = rest.split_once('/').unwrap_or((rest, ""));
            let package = packages.find(name, folder);
            let missing =
                || format!("package \"{name}\" is not found; give it with --package {name}=DIR");
            package.ok_or_else(missing)?.join(inner)
        }
        None => folder.join(file.strip_prefix("file://").unwrap_or(file)),
    };
    if !path.is_file() {
        return Err(format!("there is no file {}", path.display()));
    }
    if !files::ENDINGS.contains(&files::ending(&path).as_str()) {
        return Err(format!(
            "its ending is none of {}",
            files::ENDINGS.join(", ")
        ));
    }
    Ok(path)
}

/// Primitive shapes, each in the frame of its link.
type Shapes = Vec<(Shape, Isometry3<f64>)>;

/// The meshes of every link and its primitive shapes for collision, in file order; numbers that
/// cannot be read count as not given, since nothing but volumes, clearances and pictures depends on
/// them.
pub(crate) fn references(text: &str) -> (Vec<Vec<MeshReference>>, Vec<Shapes>) {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let none = || (Vec::new(), Vec::new());
    if xml_bounds::exceeded(text).is_some() {
        return none();
    }
    let Ok(document) = Document::parse_with_options(text, options) else {
        return none();
    };
    let links = document.root_element().children();
    let links = links.filter(|node| node.has_tag_name("link"));
    links.map(|link| (of_link(&link), solids(&link))).unzip()
}

fn of_link(link: &Node) -> Vec<MeshReference> {
    let shapes = link.children().filter_map(|shape| {
        let is_collision = shape.has_tag_name("collision");
        if !(is_collision || shape.has_tag_name("visual")) {
            return None;
        }
        let mesh = shape.descendants().find(|node| node.has_tag_name("mesh"))?;
        Some(MeshReference {
            file: mesh.attribute("filename")?.trim().to_owned(),
            scale: Vector3::from(mesh.attribute("scale").and_then(three).unwrap_or([1.0; 3])),
            link_from_mesh: origin(&shape),
            is_collision,
            color_rgba: None,
        })
    });
    shapes.collect()
}

/// Primitive shapes for collision; those without a size are left out.
fn solids(link: &Node) -> Shapes {
    let shapes = link
        .children()
        .filter(|node| node.has_tag_name("collision"));
    let solids = shapes.filter_map(|shape| {
        let geometry = shape
            .children()
            .find(|node| node.has_tag_name("geometry"))?;
        let own = geometry.children().find(Node::is_element)?;
        let size = |name: &str| {
            let size: f64 = own.attribute(name)?.trim().parse().ok()?;
            (size.is_finite() && size > 0.0).then_some(size)
        };
        let solid = match own.tag_name().name() {
            "box" => {
                let sides = own.attribute("size").and_then(three)?;
                let has_size = sides.iter().all(|side| *side > 0.0);
                has_size.then(|| Shape::Box {
                    half_extents_m: Vector3::from(sides) * 0.5,
                })?
            }
            "cylinder" => Shape::Cylinder {
                radius_m: size("radius")?,
                length_m: size("length")?,
            },
            "capsule" => Shape::Capsule {
                radius_m: size("radius")?,
                length_m: size("length")?,
            },
            "sphere" => Shape::Sphere {
                radius_m: size("radius")?,
            },
            _ => return None,
        };
        Some((solid, origin(&shape)))
    });
    solids.collect()
}

/// Where a shape stands on its link.
fn origin(shape: &Node) -> Isometry3<f64> {
    let origin = shape.children().find(|node| node.has_tag_name("origin"));
    let numbers = |name| origin.and_then(|origin| three(origin.attribute(name)?));
    let [x, y, z] = numbers("xyz").unwrap_or_default();
    let [roll, pitch, yaw] = numbers("rpy").unwrap_or_default();
    Isometry3::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

fn three(text: &str) -> Option<[f64; 3]> {
    let numbers = text.split_whitespace().map(|word| word.parse::<f64>().ok());
    let numbers: Option<Vec<f64>> = numbers.collect();
    let numbers: [f64; 3] = numbers?.try_into().ok()?;
    numbers.iter().all(|n| n.is_finite()).then_some(numbers)
}
