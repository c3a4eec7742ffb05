//! What can be wrong with a surface or the file that holds it.

use thiserror::Error;
use truecut_arm::Placed;

use crate::bounds::OutOfBounds;

/// A fault with its place.
pub type SurfaceError = Placed<SurfaceFault>;

/// The faults, their values in SI units unless the text says otherwise.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SurfaceFault {
    #[error("cannot read the file: {0}")]
    Unreadable(#[source] std::io::Error),
    #[error("{0}")]
    Syntax(String),
    #[error("\"{key}\" is missing; a patch of kind \"{kind}\" needs it")]
    MissingKey {
        key: &'static str,
        kind: &'static str,
    },
    #[error("\"{key}\" has no effect on a patch of kind \"{kind}\"")]
    NoEffect {
        key: &'static str,
        kind: &'static str,
    },
    #[error(transparent)]
    OutOfBounds(#[from] OutOfBounds),
    #[error(
        "{direction}: {found} knots; {points} control points of degree {degree} have {expected}"
    )]
    KnotCount {
        direction: &'static str,
        found: usize,
        points: usize,
        degree: usize,
        expected: usize,
    },
    #[error("{direction}: knot {index} is {value}, after {before}; knots must not fall")]
    KnotsFall {
        direction: &'static str,
        index: usize,
        value: f64,
        before: f64,
    },
    #[error(
        "{direction}: the patch begins and ends at knot {value}, but must reach from one knot to a larger one: it has \
         no extent"
    )]
    KnotsWithoutSpan { direction: &'static str, value: f64 },
    #[error(
        "{direction}: knot {value} stands {times} times where at most {limit} are allowed; more would tear a patch of degree {degree} there"
    )]
    KnotRepeated {
        direction: &'static str,
        value: f64,
        times: usize,
        limit: usize,
        degree: usize,
    },
    #[error("{direction}: {points} control points; degree {degree} needs {least} at least")]
    TooFewPoints {
        direction: &'static str,
        points: usize,
        degree: usize,
        least: usize,
    },
    #[error("row {row} of the {what} has {found} entries; the other rows have {expected}")]
    Ragged {
        what: &'static str,
        row: usize,
        found: usize,
        expected: usize,
    },
    #[error(
        "the patch has no normal at u = {u}, v = {v}: its parameter lines are parallel or stand still there"
    )]
    NoNormal { u: f64, v: f64 },
    #[error(
        "inverted normals: at u = {u}, v = {v} the normal stands at {angle_deg:.1} deg to \"outside\"; it must be below 90 deg (swap u and v to turn it over)"
    )]
    InvertedNormal { u: f64, v: f64, angle_deg: f64 },
    #[error("{what} {index} is not finite: {value}")]
    NotFinite {
        what: &'static str,
        index: usize,
        value: String,
    },
    #[error("the mesh has no triangles")]
    EmptyMesh,
    #[error(
        "the mesh is not manifold: the edge from {from} to {to} m belongs to {count} triangles; at most two may share one"
    )]
    NonManifold {
        from: String,
        to: String,
        count: usize,
    },
    #[error(
        "the mesh is open: the edge from {from} to {to} m belongs to one triangle only ({open_edges} such edges); a closed one is asked for"
    )]
    OpenMesh {
        from: String,
        to: String,
        open_edges: usize,
    },
    #[error(
        "inverted normals: triangles {first} and {second} (counted from 1), which meet at {from} m, are wound against each other"
    )]
    MixedWinding {
        first: usize,
        second: usize,
        from: String,
    },
    #[error(
        "inverted normals: the closed mesh encloses {volume_m3:.4e} m3; triangles must be wound counter-clockwise seen from outside, which makes it positive"
    )]
    InsideOut { volume_m3: f64 },
    #[error(
        "inverted normals: the normal stated for triangle {index} (counted from 1), near {near} in the file's unit, is against its winding"
    )]
    StatedNormal { index: usize, near: String },
    #[error(
        "triangle {index} (counted from 1) has no area; its corners lie on one line near {near} m"
    )]
    FlatTriangle { index: usize, near: String },
    #[error(
        "the part has {count} {what}, the first at {first} mm; a face is taken from a whole part: closed, each edge in two triangles, all wound one way"
    )]
    NotWhole {
        what: &'static str,
        count: usize,
        first: String,
    },
    #[error(
        "the point lies {away_mm:.4} mm off the part, whose nearest point is {nearest} mm; it picks a face up to {limit_mm:.4} mm off, a thousandth of the part's diagonal"
    )]
    OffThePart {
        away_mm: f64,
        limit_mm: f64,
        nearest: String,
    },
    #[error(
        "the face stands at {angle_deg:.1} deg to its mean normal at {at} mm; a face that is fitted may turn by {limit_deg} deg from its mean at most; a smaller crease angle takes less of the part for one face"
    )]
    FaceTurns {
        angle_deg: f64,
        at: String,
        limit_deg: f64,
    },
    #[error("the face touches itself in the corner at {at} mm; lines around a face must not")]
    PinchedFace { at: String },
    #[error(
        "the face cannot be laid out flat: it lies over itself at {at}, seen along its mean normal; it must not"
    )]
    FaceFolds { at: String },
    #[error(
        "the fitted surface lies {deviation_mm:.4} mm off the mesh at {at} mm, {at_vertices_mm:.4} mm at its vertices, with {} by {} control points; the limit is {limit_mm:.4} mm; what the vertices keep and the mesh does not is its chords: take a finer mesh or a wider limit",
        points[0], points[1]
    )]
    Deviates {
        deviation_mm: f64,
        at: String,
        at_vertices_mm: f64,
        limit_mm: f64,
        points: [usize; 2],
    },
    #[error(
        "the boundary is open: it ends {gap_m} m from where it starts; first and last point must be the same to {limit_m} m"
    )]
    OpenBoundary { gap_m: f64, limit_m: f64 },
    #[error("the boundary has {count} corners; it needs three at least")]
    FewCorners { count: usize },
    #[error(
        "the boundary crosses itself: its sides {first} and {second} (counted from 1) meet at {at} m"
    )]
    SelfIntersecting {
        first: usize,
        second: usize,
        at: String,
    },
}

/// A place as people read it, in mm.
pub(crate) fn place_mm(p_m: &nalgebra::Vector3<f64>) -> String {
    let [x, y, z] = [p_m.x, p_m.y, p_m.z].map(|x_m| 1e3 * x_m);
    format!("({x:.4}, {y:.4}, {z:.4})")
}

/// A place as people read it, m.
pub(crate) fn place(p: &nalgebra::Vector3<f64>) -> String {
    format!("({:.6}, {:.6}, {:.6})", p.x, p.y, p.z)
}
