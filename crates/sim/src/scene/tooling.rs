//! What the arm carries: spindle, holder, and the tool of a process at its size.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, Robot};
use truecut_core::cutting::milling::profile::Profile;
use truecut_recording::{Geometry, Pose, Shape};

use super::pose;

/// Colour of brushes, wheels, cutters.
const TOOL_RGBA: [u8; 4] = [205, 150, 60, 255];
/// Colour of a pressure foot.
const FOOT_RGBA: [u8; 4] = [70, 160, 230, 255];
/// Colour of spindle and holder.
const SPINDLE_RGBA: [u8; 4] = [95, 105, 120, 255];
/// Corners of what is turned.
const CORNERS: u32 = 40;
/// Parts of a cutter's round corner.
const CORNER_PARTS: u32 = 10;
/// Parts of the way from flange to tool point at which the spindle ends, and at most the holder.
const SPINDLE_PART: f64 = 0.6;
/// Radius of the spindle in that way's length, and its bounds, m.
const SPINDLE_RADIUS: f64 = 0.18;
const SPINDLE_RADII_M: [f64; 2] = [4e-3, 0.05];
/// Radius of the holder in that of the spindle.
const HOLDER: f64 = 0.5;
/// Radius of the ring of a pressure foot and half its thickness, m: its true form is not known.
const FOOT_M: [f64; 2] = [0.055, 6e-3];

/// In which frame, fixed to the arm, a shape is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// The tool frame.
    Tool,
    /// The process frame as it stands at the start.
    Process,
    /// At the foot, process axes.
    Foot,
}

/// The tool of a process, as it is drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tooling {
    /// Shapes, each in its frame.
    pub shapes: Vec<(Held, Shape)>,
    /// How far the tool reaches back from the tool point, m: there the holder ends.
    pub back_m: f64,
    /// What clearances call it.
    pub name: &'static str,
}

impl Tooling {
    /// A brush or contact wheel about the tool's y axis, its middle at the tool point.
    pub fn drum([radius_m, width_m]: [f64; 2]) -> Self {
        // A cylinder stands along its z axis.
        let about_y = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
        let drum = cylinder(
            radius_m,
            width_m,
            &Isometry3::from_parts(Vector3::zeros().into(), about_y),
        );
        Self::of("wheel", Held::Tool, drum, radius_m)
    }

    /// A wheel that touches the workpiece at the tool point, from against process X, about process
    /// Z.
    pub fn disc([radius_m, width_m]: [f64; 2]) -> Self {
        let at = Isometry3::translation(-radius_m, 0.0, 0.0);
        Self::of(
            "wheel",
            Held::Process,
            cylinder(radius_m, width_m, &at),
            2.0 * radius_m,
        )
    }

    /// A ball about the tool point.
    pub fn ball(radius_m: f64) -> Self {
        let ball = tool(Geometry::Sphere { radius_m }, Pose::IDENTITY);
        Self::of("wheel", Held::Tool, ball, radius_m)
    }

    /// An end mill that ends at the tool point, along the tool's z axis.
    pub fn end_mill(radius_m: f64, length_m: f64) -> Self {
        let at = Isometry3::translation(0.0, 0.0, -0.5 * length_m);
        Self::of(
            "cutter",
            Held::Tool,
            cylinder(radius_m, length_m, &at),
            length_m,
        )
    }

    /// The same with a round corner.
    pub fn round_mill(outline: &Profile, length_m: f64) -> Self {
        let corner = (0..=CORNER_PARTS).rev().map(|k| {
            let kappa = FRAC_PI_2 * f64::from(k) / f64::from(CORNER_PARTS);
            let height_m = outline.corner_radius_m * (1.0 - kappa.cos());
            (-height_m, outline.radius_at_m(height_m))
        });
        let profile: Vec<(f64, f64)> = [(-length_m, outline.radius_m)]
            .into_iter()
            .chain(corner)
            .collect();
        let shape = tool(turned(&profile), Pose::IDENTITY);
        Self::of("cutter", Held::Tool, shape, length_m)
    }

    /// A countersink whose edges meet a hole's rim at the tool point, and its shank; pulled
    /// `backward` through the hole it is widest beyond.
    pub fn countersink(hole_radius_m: f64, half_angle_tan: f64, backward: bool) -> Self {
        let (r, half) = (hole_radius_m, 0.4 * hole_radius_m / half_angle_tan);
        let back_m = 4.0 * r + half;
        let profile = if backward {
            let shank = 0.45 * r;
            [
                (-back_m, shank),
                (-half, shank),
                (-half, 0.6 * r),
                (half, 1.4 * r),
                (half, 0.0),
            ]
        } else {
            let shank = 0.9 * r;
            [
                (-back_m, shank),
                (-half, shank),
                (-half, 1.4 * r),
                (half, 0.6 * r),
                (half, 0.0),
            ]
        };
        Self::of(
            "cutter",
            Held::Tool,
            tool(turned(&profile), Pose::IDENTITY),
            back_m,
        )
    }

    /// With the ring of a pressure foot, so far from the foot's frame along process X.
    #[must_use]
    pub fn with_foot(mut self, along_m: f64) -> Self {
        let [ring_m, half_m] = FOOT_M;
        let ring = Shape {
            geometry: super::shapes::ring(along_m - half_m, ring_m, half_m, 64),
            color_rgba: FOOT_RGBA,
            body_from_shape: Pose::IDENTITY,
        };
        self.shapes.push((Held::Foot, ring));
        self
    }

    /// Under another name.
    #[must_use]
    pub fn named(self, name: &'static str) -> Self {
        Self { name, ..self }
    }

    fn of(name: &'static str, held: Held, shape: Shape, back_m: f64) -> Self {
        Self {
            shapes: vec![(held, shape)],
            back_m,
            name,
        }
    }
}

fn tool(geometry: Geometry, body_from_shape: Pose) -> Shape {
    Shape {
        geometry,
        color_rgba: TOOL_RGBA,
        body_from_shape,
    }
}

fn cylinder(radius_m: f64, length_m: f64, at: &Isometry3<f64>) -> Shape {
    tool(Geometry::Cylinder { radius_m, length_m }, pose(at))
}

/// A body of revolution about z through (z, radius), from its back.
fn turned(profile: &[(f64, f64)]) -> Geometry {
    let point = |(z, r): (f64, f64), corner: u32| {
        let (s, c) = (TAU * f64::from(corner) / f64::from(CORNERS)).sin_cos();
        [r * c, r * s, z]
    };
    let (first, last) = (profile.first(), profile.last());
    let ends = [first, last].map(|end| end.map_or(0.0, |(z, _)| *z));
    let closed = [(ends[0], 0.0)].into_iter().chain(profile.iter().copied());
    let closed: Vec<(f64, f64)> = closed.chain([(ends[1], 0.0)]).collect();
    let vertices_m = closed
        .iter()
        .flat_map(|at| (0..CORNERS).map(|i| point(*at, i)));
    let triangles = (1..closed.len() as u32).flat_map(|ring| {
        (0..CORNERS).flat_map(move |i| {
            let next = (i + 1) % CORNERS;
            let [below, above] = [(ring - 1) * CORNERS, ring * CORNERS];
            [
                [below + i, below + next, above + next],
                [below + i, above + next, above + i],
            ]
        })
    });
    Geometry::Mesh {
        vertices_m: vertices_m.collect(),
        triangles: triangles.collect(),
    }
}

/// Shapes on the last link: spindle and holder from the flange to the tool, and the tool.
pub(super) fn on_last_link(
    robot: &Robot,
    q: &[f64],
    world_from_process: &Isometry3<f64>,
    tooling: &Tooling,
) -> Vec<Shape> {
    let Some(world_from_last) = robot.world_from_links(q).last().copied() else {
        return Vec::new();
    };
    let [flange, tool] = [FrameId::Flange, FrameId::Tool].map(|f| robot.last_link_from_frame(f));
    let mut shapes = spindle(
        &flange.translation.vector,
        &tool.translation.vector,
        tooling.back_m,
    );
    shapes.extend(tools_on_last_link(
        robot,
        &world_from_last,
        world_from_process,
        tooling,
    ));
    shapes
}

/// The tool alone, without what is drawn between it and the flange and without a foot.
pub(crate) fn tools_on_last_link(
    robot: &Robot,
    world_from_last: &Isometry3<f64>,
    world_from_process: &Isometry3<f64>,
    tooling: &Tooling,
) -> Vec<Shape> {
    let tool = robot.last_link_from_frame(FrameId::Tool);
    let last_from_process = Isometry3::from_parts(
        tool.translation,
        (world_from_last.inverse() * world_from_process).rotation,
    );
    let placed = |(held, shape): &(Held, Shape)| {
        let last_from = match held {
            Held::Tool => tool,
            Held::Process => last_from_process,
            Held::Foot => return None,
        };
        let own = super::isometry(&shape.body_from_shape);
        Some(Shape {
            body_from_shape: pose(&(last_from * own)),
            ..shape.clone()
        })
    };
    tooling.shapes.iter().filter_map(placed).collect()
}

fn spindle(flange_m: &Vector3<f64>, tool_m: &Vector3<f64>, back_m: f64) -> Vec<Shape> {
    let way = tool_m - flange_m;
    let length = way.norm();
    let [least, most] = SPINDLE_RADII_M;
    if length < 2.0 * least {
        return Vec::new();
    }
    let radius_m = (SPINDLE_RADIUS * length).clamp(least, most);
    let rotation = UnitQuaternion::rotation_between(&Vector3::z(), &way)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 2.0 * FRAC_PI_2));
    let bar = |from: f64, to: f64, radius_m: f64| Shape {
        geometry: Geometry::Cylinder {
            radius_m,
            length_m: (to - from) * length,
        },
        color_rgba: SPINDLE_RGBA,
        body_from_shape: pose(&Isometry3::from_parts(
            (flange_m + way * (0.5 * (from + to))).into(),
            rotation,
        )),
    };
    // A tool that fills the way has neither.
    let end = 1.0 - back_m / length;
    let spindle_end = SPINDLE_PART.min(end);
    let mut bars = Vec::new();
    if spindle_end > 0.0 {
        bars.push(bar(0.0, spindle_end, radius_m));
    }
    if end > spindle_end {
        bars.push(bar(spindle_end, end, HOLDER * radius_m));
    }
    bars
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cone of a countersink meets the rim of the hole at the tool point, pushed or pulled, and
    /// is a closed body wound outwards.
    #[test]
    fn verify_a_countersink_meets_the_rim() {
        let (r, tan) = (0.01, 0.7);
        for backward in [false, true] {
            let tooling = Tooling::countersink(r, tan, backward);
            let Geometry::Mesh {
                vertices_m,
                triangles,
            } = &tooling.shapes[0].1.geometry
            else {
                panic!("it is turned");
            };
            let radius_at = |z: f64, side: f64| {
                let near = vertices_m.iter().filter(|v| (v[2] - z).abs() < 1e-12);
                near.map(|v| side * v[0].hypot(v[1]))
                    .fold(f64::MIN, f64::max)
            };
            let half = 0.4 * r / tan;
            let (narrow, wide) = if backward {
                (-half, half)
            } else {
                (half, -half)
            };
            let mean = 0.5 * (radius_at(narrow, 1.0) + radius_at(wide, 1.0));
            assert!((mean - r).abs() < 1e-12, "{mean}");
            let volume: f64 = (triangles.iter())
                .map(|t| t.map(|i| Vector3::from(vertices_m[i as usize])))
                .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
                .sum();
            assert!(volume > 0.0, "{volume}");
        }
    }
}
