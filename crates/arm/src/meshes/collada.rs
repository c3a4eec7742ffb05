//! COLLADA 1.4 and 1.5: the triangles of all geometries that the scene places, in metres.
//!
//! The axis that the file calls up is not turned: robot descriptions are read so everywhere
//! (`<up_axis>` is what the drawing program had, the URDF says how the mesh lies on its link).

use std::collections::HashMap;

use nalgebra::{Matrix4, Point3, Unit, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use super::files::{Part, fan};
use crate::xml_bounds;

/// Nodes that a scene may have, instances of nodes counted each time; a file that places a node in
/// itself has no end.
const MOST_NODES: usize = 100_000;
/// Vertices of one polygon list that are still read.
const MOST_CORNERS: usize = 30_000_000;

pub(super) fn parts(text: &str) -> Result<Vec<Part>, String> {
    if let Some((at, kind)) = xml_bounds::exceeded(text) {
        let line = text[..at].matches('\n').count() + 1;
        return Err(format!("not a valid COLLADA file: line {line}: {kind}"));
    }
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options)
        .map_err(|error| format!("not a valid COLLADA file: {error}"))?;
    let file = File::new(&document)?;
    let unit = (document.descendants())
        .find(|node| node.has_tag_name_any("unit"))
        .and_then(|unit| unit.attribute("meter")?.trim().parse::<f64>().ok())
        .unwrap_or(1.0);
    let mut parts = Vec::new();
    let mut open = Vec::new();
    let scenes = || {
        document
            .descendants()
            .filter(|n| n.has_tag_name_any("visual_scene"))
    };
    let asked = (document.descendants())
        .find(|node| node.has_tag_name_any("instance_visual_scene"))
        .and_then(|instance| file.referred(&instance, "url"));
    if let Some(scene) = asked.or_else(|| scenes().next()) {
        open.push((scene, Matrix4::new_scaling(unit)));
    }
    let mut count = 0;
    while let Some((node, above)) = open.pop() {
        count += 1;
        if count > MOST_NODES {
            return Err(format!("its scene has more than {MOST_NODES} nodes"));
        }
        let pose = above * placement(&node)?;
        for child in node.children() {
            match child.tag_name().name() {
                "node" => open.push((child, pose)),
                "instance_node" => open.extend(file.referred(&child, "url").map(|n| (n, pose))),
                "instance_geometry" => file.geometry(&child, &pose, &mut parts)?,
                _ => {}
            }
        }
    }
    Ok(parts)
}

trait Tags {
    fn has_tag_name_any(&self, name: &str) -> bool;
    fn child(&self, name: &str) -> Option<Self>
    where
        Self: Sized;
}

impl Tags for Node<'_, '_> {
    /// Whatever the namespace: it names the version of the format.
    fn has_tag_name_any(&self, name: &str) -> bool {
        self.tag_name().name() == name
    }

    fn child(&self, name: &str) -> Option<Self> {
        self.children().find(|child| child.has_tag_name_any(name))
    }
}

/// Elements by their identifiers.
struct File<'a, 'i>(HashMap<&'a str, Node<'a, 'i>>);

impl<'a, 'i> File<'a, 'i> {
    fn new(document: &'a Document<'i>) -> Result<Self, String> {
        if !document.root_element().has_tag_name_any("COLLADA") {
            return Err("not a COLLADA file".to_owned());
        }
        let named = document.descendants();
        Ok(Self(
            named
                .filter_map(|n| Some((n.attribute("id")?, n)))
                .collect(),
        ))
    }

    fn referred(&self, node: &Node<'a, 'i>, attribute: &str) -> Option<Node<'a, 'i>> {
        let target = node.attribute(attribute)?.strip_prefix('#')?;
        self.0.get(target).copied()
    }

    /// Appends what an `<instance_geometry>` places.
    fn geometry(
        &self,
        instance: &Node<'a, 'i>,
        pose: &Matrix4<f64>,
        parts: &mut Vec<Part>,
    ) -> Result<(), String> {
        let Some(mesh) = self.referred(instance, "url").and_then(|g| g.child("mesh")) else {
            return Ok(());
        };
        let materials: HashMap<&str, Node> = (instance.descendants())
            .filter(|node| node.has_tag_name_any("instance_material"))
            .filter_map(|m| Some((m.attribute("symbol")?, self.referred(&m, "target")?)))
            .collect();
        for list in mesh.children() {
            let polygons = match list.tag_name().name() {
                "triangles" => self.polygons(&list, Some(3))?,
                "polylist" | "polygons" => self.polygons(&list, None)?,
                _ => continue,
            };
            let place = |corner: Point3<f64>| pose.transform_point(&corner).coords;
            let triangles = polygons.iter().flat_map(|polygon| fan(polygon));
            let material = list
                .attribute("material")
                .and_then(|name| materials.get(name));
            parts.push(Part {
                triangles: triangles.map(|corners| corners.map(place)).collect(),
                color_rgba: material.and_then(|material| self.color(material)),
            });
        }
        Ok(())
    }

    /// Corners of each polygon of a list, `each` of them a polygon if that is fixed.
    fn polygons(
        &self,
        list: &Node<'a, 'i>,
        each: Option<usize>,
    ) -> Result<Vec<Vec<Point3<f64>>>, String> {
        let inputs = || {
            list.children()
                .filter(|node| node.has_tag_name_any("input"))
        };
        let offset = |input: &Node| input.attribute("offset").and_then(|o| o.parse().ok());
        let offsets = inputs().filter_map(|input| offset(&input));
        let stride = offsets
            .max()
            .map_or(1, |largest: usize| largest.saturating_add(1));
        let vertex = inputs().find(|input| input.attribute("semantic") == Some("VERTEX"));
        let vertex = vertex.ok_or("a list of polygons has no vertices")?;
        let at: usize = offset(&vertex).unwrap_or(0);
        let positions = self
            .positions(&vertex)
            .ok_or("a geometry has no positions")?;
        let counts: Option<Vec<usize>> = match list.child("vcount") {
            Some(vcount) => Some(numbers(&vcount)?),
            None => None,
        };
        let mut polygons = Vec::new();
        for p in list.descendants().filter(|node| node.has_tag_name_any("p")) {
            let indices: Vec<usize> = numbers(&p)?;
            let corners = indices.chunks_exact(stride).map(|corner| {
                let index = corner[at];
                let missing = || format!("a polygon names position {index} of {}", positions.len());
                positions.get(index).copied().ok_or_else(missing)
            });
            let corners: Vec<_> = corners.collect::<Result<_, String>>()?;
            if corners.len() > MOST_CORNERS {
                return Err(format!(
                    "a list of polygons has more than {MOST_CORNERS} corners"
                ));
            }
            match (&counts, each) {
                (Some(counts), _) => {
                    let mut rest = corners.as_slice();
                    for count in counts {
                        let short = "a list of polygons ends within a polygon";
                        let (polygon, others) = rest.split_at_checked(*count).ok_or(short)?;
                        polygons.push(polygon.to_vec());
                        rest = others;
                    }
                }
                (None, Some(each)) => {
                    polygons.extend(corners.chunks_exact(each).map(<[_]>::to_vec));
                }
                (None, None) => polygons.push(corners),
            }
        }
        Ok(polygons)
    }

    /// The positions that a `VERTEX` input leads to.
    fn positions(&self, vertex: &Node<'a, 'i>) -> Option<Vec<Point3<f64>>> {
        let vertices = self.referred(vertex, "source")?;
        let input =
            (vertices.children()).find(|input| input.attribute("semantic") == Some("POSITION"))?;
        let source = self.referred(&input, "source")?;
        let values: Vec<f64> = numbers(&source.child("float_array")?).ok()?;
        let accessor = (source.descendants()).find(|node| node.has_tag_name_any("accessor"));
        let stride = accessor.and_then(|accessor| accessor.attribute("stride")?.parse().ok());
        let stride = stride.unwrap_or(3_usize).max(3);
        Some(
            (values.chunks_exact(stride))
                .map(|v| Point3::new(v[0], v[1], v[2]))
                .collect(),
        )
    }

    /// The diffuse colour of a material.
    fn color(&self, material: &Node<'a, 'i>) -> Option<[f32; 4]> {
        let effect = self.referred(&material.child("instance_effect")?, "url")?;
        let diffuse = effect
            .descendants()
            .find(|n| n.has_tag_name_any("diffuse"))?;
        let values: Vec<f32> = numbers(&diffuse.child("color")?).ok()?;
        let [r, g, b, _] = values.try_into().ok()?;
        // Transparency is given in several ways that programs do not agree on.
        Some([r, g, b, 1.0])
    }
}

fn numbers<T: std::str::FromStr>(node: &Node) -> Result<Vec<T>, String> {
    let words = node.text().unwrap_or_default().split_ascii_whitespace();
    let number = |word: &str| {
        let name = node.tag_name().name();
        word.parse()
            .map_err(|_| format!("`{word}` in <{name}> is not the number it must be"))
    };
    words.map(number).collect()
}

/// The transform of a node: its elements in their order, each within the ones before.
fn placement(node: &Node) -> Result<Matrix4<f64>, String> {
    let mut pose = Matrix4::identity();
    for element in node.children() {
        let name = element.tag_name().name();
        if !["matrix", "translate", "rotate", "scale"].contains(&name) {
            continue;
        }
        let values: Vec<f64> = numbers(&element)?;
        pose *= match (name, values.as_slice()) {
            ("matrix", values) if values.len() == 16 => Matrix4::from_row_slice(values),
            ("translate", [x, y, z]) => Matrix4::new_translation(&Vector3::new(*x, *y, *z)),
            ("rotate", [x, y, z, degrees]) => {
                let axis = Unit::try_new(Vector3::new(*x, *y, *z), 0.0);
                axis.map_or(Matrix4::identity(), |axis| {
                    Matrix4::from_axis_angle(&axis, degrees.to_radians())
                })
            }
            ("scale", [x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(*x, *y, *z)),
            _ => return Err(format!("<{name}> has {} numbers", values.len())),
        };
    }
    Ok(pose)
}
