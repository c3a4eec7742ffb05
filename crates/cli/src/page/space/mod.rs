//! A scene in space as data for the page's script: triangles and lines in few bytes.

mod forms;
mod thin;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, PreEscaped, html};
use serde::Serialize;
use truecut_recording::{Body, Field, Frame, Geometry, PartMesh, Pose, Scene};

use super::figures::safe_json;
use crate::figure::ColourScale;
use thin::Surface;

/// Most triangles of a scene, so that a page stays small and turns at once.
const TRIANGLES: usize = 30_000;
/// Most points of the lines that are added to a scene, about.
const POINTS: usize = 20_000;
/// What a mesh keeps in any case.
const FEWEST: usize = 200;
/// Colour of a part where it has no value.
const PART_RGB: [u8; 3] = [150, 155, 160];
/// Corners are told by so many steps along the sides of a mesh's box.
const STEPS: f64 = 65_535.0;
/// Values are told by so many steps; one more says that there is none.
const SHADES: f64 = 250.0;
const NO_SHADE: u8 = 255;
/// Arms that are drawn enlarged, or behind one that is: [`Scene::deflection_scale`].
const EXAGGERATED: &str = "arm/exaggerated";

/// Something to be looked at from all sides.
pub struct Space {
    /// Over it.
    pub title: String,
    groups: Vec<Group>,
    meshes: Vec<Mesh>,
    lines: Vec<Line>,
    time_s: Vec<f64>,
    /// Poses of the bodies at each time.
    poses: Vec<Vec<Pose>>,
    scales: Vec<ColourScale>,
    /// Eye and target.
    camera: Option<[[f64; 3]; 2]>,
}

/// What is shown or hidden together.
#[derive(Serialize)]
struct Group {
    label: String,
    hidden: bool,
}

struct Mesh {
    group: usize,
    /// Which pose it follows; none: it stands in the world.
    body: Option<usize>,
    rgb: [u8; 3],
    surface: Surface,
    /// The scale of the surface's values.
    scale: Option<usize>,
}

struct Line {
    group: usize,
    body: Option<usize>,
    rgb: [u8; 3],
    points_m: Vec<[f64; 3]>,
}

impl Space {
    /// Nothing yet.
    fn empty(title: impl Into<String>) -> Space {
        Space {
            title: title.into(),
            groups: Vec::new(),
            meshes: Vec::new(),
            lines: Vec::new(),
            time_s: Vec::new(),
            poses: Vec::new(),
            scales: Vec::new(),
            camera: None,
        }
    }

    /// Bodies of a scene at some moments.
    pub fn of_scene(title: impl Into<String>, scene: &Scene, frames: &[Frame]) -> Space {
        let mut space = Space::empty(title);
        space.camera = (scene.camera).map(|camera| [camera.position_m, camera.target_m]);
        for (index, body) in scene.bodies.iter().enumerate() {
            let group = space.group_of(body, scene.deflection_scale);
            for shape in &body.shapes {
                let [r, g, b, _] = shape.color_rgba;
                let rgb = [r, g, b];
                let body = Some(index);
                if let Geometry::Line { points_m, .. } = &shape.geometry {
                    let placed = points_m.iter().map(|p| shape.body_from_shape.place(p));
                    space.lines.push(Line {
                        group,
                        body,
                        rgb,
                        points_m: placed.collect(),
                    });
                } else if let Some(mut surface) = forms::surface(&shape.geometry) {
                    let placed = surface.corners_m.iter();
                    surface.corners_m = placed.map(|p| shape.body_from_shape.place(p)).collect();
                    space.meshes.push(Mesh {
                        group,
                        body,
                        rgb,
                        surface,
                        scale: None,
                    });
                }
            }
        }
        space.poses = match frames.is_empty() {
            true => vec![scene.bodies.iter().map(|body| body.initial_pose).collect()],
            false => frames.iter().map(|frame| frame.poses.clone()).collect(),
        };
        space.time_s = frames.iter().map(|frame| frame.time_s).collect();
        space
    }

    /// A part with what is left on it beyond what was meant.
    pub fn of_part(title: impl Into<String>, part: &PartMesh, scale: ColourScale) -> Space {
        let mut space = Space::empty(title);
        let corners = part.triangles_m.as_flattened().iter();
        let surface = Surface {
            corners_m: corners.map(|corner| corner.map(f64::from)).collect(),
            triangles: (0..part.triangles_m.len() as u32)
                .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
                .collect(),
            values: part
                .left_m
                .as_flattened()
                .iter()
                .map(|x| f64::from(*x))
                .collect(),
        };
        space.coloured("part", surface, scale, PART_RGB);
        space
    }

    /// A field as it is left, bent as it is.
    pub fn field(&mut self, field: &Field, values: &[f32], scale: ColourScale) {
        let [columns, rows] = field.cells;
        let triangles = (1..rows).flat_map(|row| {
            (1..columns).flat_map(move |column| {
                let c = (row * columns + column) as u32;
                let [a, b, d] = [c - columns as u32 - 1, c - columns as u32, c - 1];
                [[a, b, c], [a, c, d]]
            })
        });
        let is_there = |k: &u32| {
            values
                .get(*k as usize)
                .is_some_and(|value| value.is_finite())
        };
        let surface = Surface {
            triangles: triangles.filter(|t| t.iter().all(is_there)).collect(),
            corners_m: field.places_m(),
            values: values.iter().map(|value| f64::from(*value)).collect(),
        };
        let label = field.name().replace('_', " ");
        self.coloured(&label, surface, scale, PART_RGB);
    }

    fn coloured(&mut self, label: &str, surface: Surface, scale: ColourScale, rgb: [u8; 3]) {
        let group = self.group(label, false);
        self.scales.push(scale);
        self.meshes.push(Mesh {
            group,
            body: None,
            rgb,
            surface,
            scale: Some(self.scales.len() - 1),
        });
    }

    /// Lines in the world under one name.
    pub fn lines(&mut self, label: &str, rgb: [u8; 3], lines: Vec<Vec<[f64; 3]>>) {
        let group = self.group(label, false);
        let drawn: Vec<_> = lines.into_iter().filter(|line| line.len() > 1).collect();
        let every = drawn
            .iter()
            .map(Vec::len)
            .sum::<usize>()
            .div_ceil(POINTS)
            .max(1);
        self.lines.extend(drawn.iter().map(|line| {
            let last = line.len() - 1;
            let kept = |k: &usize| k.is_multiple_of(every) || *k == last;
            Line {
                group,
                body: None,
                rgb,
                points_m: (0..=last).filter(kept).map(|k| line[k]).collect(),
            }
        }));
    }

    fn group_of(&mut self, body: &Body, deflection_scale: f64) -> usize {
        if body.path.starts_with(EXAGGERATED) {
            let label = format!("arm, deflection × {deflection_scale:.0}");
            return self.group(&label, true);
        }
        let first = body.path.split('/').next().unwrap_or(&body.path);
        self.group(&first.replace('_', " "), false)
    }

    fn group(&mut self, label: &str, hidden: bool) -> usize {
        let known = self.groups.iter().position(|group| group.label == label);
        known.unwrap_or_else(|| {
            let label = label.to_owned();
            self.groups.push(Group { label, hidden });
            self.groups.len() - 1
        })
    }

    /// Whether there is nothing to see.
    pub fn is_empty(&self) -> bool {
        self.meshes.is_empty() && self.lines.is_empty()
    }

    /// The element with its data.
    pub(super) fn markup(&self) -> Markup {
        html! {
            figure {
                figcaption { (self.title) }
                div.space { script type="application/json" { (PreEscaped(self.json())) } }
            }
        }
    }

    fn json(&self) -> String {
        let total: usize = self
            .meshes
            .iter()
            .map(|mesh| mesh.surface.triangles.len())
            .sum();
        let meshes = self.meshes.iter().map(|mesh| {
            // Each gives what it has in proportion; small ones stay as they are.
            let count = mesh.surface.triangles.len();
            let share = (count as f64 * TRIANGLES as f64 / total.max(1) as f64) as usize;
            let surface = match total > TRIANGLES && count > share.max(FEWEST) {
                true => mesh.surface.thinned(share.max(FEWEST)),
                false => mesh.surface.joined(),
            };
            MeshData::of(mesh, &surface, &self.scales)
        });
        let lines = self.lines.iter().map(|line| {
            let packed = Packed::of(&line.points_m);
            LineData {
                group: line.group,
                body: line.body,
                rgb: line.rgb,
                packed,
            }
        });
        let poses = self.poses.iter();
        safe_json(&SpaceData {
            groups: &self.groups,
            meshes: meshes.collect(),
            lines: lines.collect(),
            time: self.time_s.iter().map(|t| rounded(*t)).collect(),
            poses: poses
                .map(|poses| poses.iter().flat_map(numbers).collect())
                .collect(),
            scales: &self.scales,
            camera: self.camera,
        })
    }
}

#[derive(Serialize)]
struct SpaceData<'a> {
    groups: &'a [Group],
    meshes: Vec<MeshData>,
    lines: Vec<LineData>,
    time: Vec<f64>,
    /// Place and quaternion (scalar last) of each body, one after the other.
    poses: Vec<Vec<f64>>,
    scales: &'a [ColourScale],
    #[serde(skip_serializing_if = "Option::is_none")]
    camera: Option<[[f64; 3]; 2]>,
}

#[derive(Serialize)]
struct MeshData {
    group: usize,
    body: Option<usize>,
    rgb: [u8; 3],
    #[serde(flatten)]
    packed: Packed,
    /// Corners of triangles, two bytes each, or four where `wide`.
    triangles: String,
    wide: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<usize>,
    /// A byte a corner: share of the scale in [`SHADES`], or none.
    #[serde(skip_serializing_if = "Option::is_none")]
    shades: Option<String>,
}

#[derive(Serialize)]
struct LineData {
    group: usize,
    body: Option<usize>,
    rgb: [u8; 3],
    #[serde(flatten)]
    packed: Packed,
}

/// Points in the box that holds them, two bytes a coordinate.
#[derive(Serialize)]
struct Packed {
    low: [f64; 3],
    size: [f64; 3],
    points: String,
}

impl Packed {
    fn of(points_m: &[[f64; 3]]) -> Packed {
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
            points_m.iter().map(|p| p[axis]).fold(from, pick)
        };
        let low = [0, 1, 2].map(|axis| bound(axis, f64::min, f64::INFINITY));
        let high = [0, 1, 2].map(|axis| bound(axis, f64::max, f64::NEG_INFINITY));
        let size: [f64; 3] = std::array::from_fn(|axis| (high[axis] - low[axis]).max(1e-9));
        let steps = points_m.iter().flat_map(|point| {
            (0..3).flat_map(move |axis| {
                let share = (point[axis] - low[axis]) / size[axis];
                ((share * STEPS).round() as u16).to_le_bytes()
            })
        });
        let points = BASE64_STANDARD.encode(steps.collect::<Vec<u8>>());
        Packed { low, size, points }
    }
}

impl MeshData {
    fn of(mesh: &Mesh, surface: &Surface, scales: &[ColourScale]) -> MeshData {
        let wide = surface.corners_m.len() > usize::from(u16::MAX);
        let corners = surface.triangles.as_flattened().iter();
        let bytes: Vec<u8> = match wide {
            true => corners.flat_map(|k| k.to_le_bytes()).collect(),
            false => corners.flat_map(|k| (*k as u16).to_le_bytes()).collect(),
        };
        let shades = mesh.scale.map(|scale| {
            let shade = |value: &f64| match scales[scale].share(*value) {
                Some(share) => (share * SHADES).round() as u8,
                None => NO_SHADE,
            };
            let shades: Vec<u8> = surface.values.iter().map(shade).collect();
            BASE64_STANDARD.encode(shades)
        });
        MeshData {
            group: mesh.group,
            body: mesh.body,
            rgb: mesh.rgb,
            packed: Packed::of(&surface.corners_m),
            triangles: BASE64_STANDARD.encode(bytes),
            wide,
            scale: mesh.scale,
            shades,
        }
    }
}

/// To a hundredth of a millimetre, or of a milliradian. A quotient: digits of a product would be
/// many.
fn rounded(value: f64) -> f64 {
    (value * 1e5).round() / 1e5
}

fn numbers(pose: &Pose) -> impl Iterator<Item = f64> {
    let parts = pose.translation_m.into_iter().chain(pose.rotation_xyzw);
    parts.map(rounded)
}
