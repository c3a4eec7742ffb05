//! A part as a mesh file gives it: size, defects, faces parted by creases, edges between them.
//!
//! Unlike [`Mesh`](super::Mesh) a part may have defects; they are counted and told with a place.
//! Vertices within a tolerance count as one, and faces are what triangles reach from one to the
//! next without turning by the crease angle or more.

mod cylinder;
mod edges;
mod faces;
mod topology;
mod units;
mod weld;

use std::path::Path;

use nalgebra::Vector3;
use serde::Serialize;
use truecut_arm::MeshData;

use super::error::SurfaceError;
use super::mesh_files::{check_unit, read_step, read_triangles};
use super::step::StepFace;
use crate::bounds::OutOfBounds;

pub use edges::PartEdge;
pub use faces::{FaceKind, PartFace};
use topology::Topology;
pub use units::SuspectedUnit;

/// Farthest coordinate, m: a double is rounded by some 1e-11 m there, and more would be lost in
/// squares and volumes.
const FARTHEST_M: f64 = 1e5;

/// Vertices closer than this share of the part's diagonal count as one, unless it is said
/// otherwise: a few roundings of the single precision of STL.
pub const WELD_SHARE: f64 = 1e-6;
/// A triangle is tiny whose longest side is below this share of the part's diagonal.
pub const TINY_SHARE: f64 = 1e-4;

/// How a part is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartOptions {
    /// Length of the file's unit, m; it is looked for where the file may have another.
    pub unit_m: f64,
    /// Triangles that turn by this or more from one to the next belong to two faces, rad.
    pub crease_rad: f64,
    /// Vertices this close count as one, m; without it [`WELD_SHARE`] of the diagonal.
    pub weld_m: Option<f64>,
}

/// How often a defect is there, and where first: between two vertices, or the middle of a triangle,
/// m.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Defect {
    pub count: usize,
    pub first_at_m: Option<[f64; 3]>,
}

impl Defect {
    fn add(&mut self, place: impl FnOnce() -> Vector3<f64>) {
        self.count += 1;
        self.first_at_m.get_or_insert_with(|| place().into());
    }
}

/// What is wrong with a mesh.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Defects {
    /// Edges of one triangle only.
    pub open_edges: Defect,
    /// Edges of more than two.
    pub non_manifold_edges: Defect,
    /// Triangles wound against most of those that they hang together with.
    pub inverted_triangles: Defect,
    /// Triangles whose normal as stated in an STL file is against their winding.
    pub against_stated_normal: Defect,
    /// Triangles with two corners in one place, or lower than the welding distance.
    pub degenerate_triangles: Defect,
    /// Triangles that are not degenerate, with all sides below [`TINY_SHARE`] of the diagonal.
    pub tiny_triangles: Defect,
    /// Triangles that stand there twice.
    pub duplicate_triangles: Defect,
    /// Vertices near another, but not in the same place, that were welded to it.
    pub welded_vertices: Defect,
    /// Closed and wound one way, but inwards.
    pub inside_out: bool,
}

impl Defects {
    /// Each with its name.
    #[must_use]
    pub fn named(&self) -> [(&'static str, Defect); 8] {
        [
            ("open edges", self.open_edges),
            ("non-manifold edges", self.non_manifold_edges),
            ("inverted triangles", self.inverted_triangles),
            (
                "triangles against their stated normal",
                self.against_stated_normal,
            ),
            ("degenerate triangles", self.degenerate_triangles),
            ("tiny triangles", self.tiny_triangles),
            ("duplicate triangles", self.duplicate_triangles),
            ("vertices welded to others", self.welded_vertices),
        ]
    }
}

/// A part, all lengths m in the file's own frame.
#[derive(Debug, Clone, Serialize)]
pub struct Part {
    /// Corners of the box about it.
    pub low_m: [f64; 3],
    pub high_m: [f64; 3],
    pub unit_m: f64,
    /// What speaks against the unit.
    pub suspected_unit: Option<SuspectedUnit>,
    pub weld_m: f64,
    pub crease_rad: f64,
    /// Without those that welding makes degenerate or double.
    pub triangle_count: usize,
    pub vertex_count: usize,
    /// Pieces that hang together by edges.
    pub shells: usize,
    pub area_m2: f64,
    /// Of a closed part.
    pub volume_m3: Option<f64>,
    pub defects: Defects,
    /// The largest first.
    pub faces: Vec<PartFace>,
    /// The longest first.
    pub edges: Vec<PartEdge>,
    /// Faces of a STEP file as its modeller has them, in the file's order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub step_faces: Vec<StepFace>,
    #[serde(skip)]
    vertices_m: Vec<Vector3<f64>>,
    #[serde(skip)]
    triangles: Vec<[u32; 3]>,
    /// Face of each triangle, its index in `faces`.
    #[serde(skip)]
    face_of: Vec<u32>,
}

impl Part {
    /// Reads and looks at a file; `progress` is told the share that is done.
    ///
    /// # Errors
    /// If the file cannot be read, or an option is out of bounds.
    pub fn load(
        path: &Path,
        options: &PartOptions,
        progress: &dyn Fn(f64),
    ) -> Result<Self, SurfaceError> {
        let (data, step_faces) = match read_step(path, options.unit_m)? {
            Some(body) => (body.mesh, Some(body.faces)),
            None => (read_triangles(path, options.unit_m)?, None),
        };
        progress(0.2);
        let mut part = Self::of(data, options, progress)
            .map_err(|fault| SurfaceError::in_file(path, None, fault.into()))?;
        if let Some(step_faces) = step_faces {
            part.step_faces = step_faces;
            // The file says its unit.
            part.suspected_unit = None;
        }
        Ok(part)
    }

    /// Looks at triangles.
    ///
    /// # Errors
    /// If an option is out of bounds, or all vertices stand in one place.
    pub fn of(
        data: MeshData,
        options: &PartOptions,
        progress: &dyn Fn(f64),
    ) -> Result<Self, OutOfBounds> {
        check_unit(options.unit_m)?;
        let crease_deg = options.crease_rad.to_degrees();
        let has_angle = crease_deg > 0.0 && crease_deg < 180.0;
        OutOfBounds::unless(
            has_angle,
            "the crease angle (deg)",
            crease_deg,
            "between 0 and 180",
        )?;
        let unit_m = options.unit_m;
        let [low, high] = extent(&data.vertices);
        let farthest_m = low.amax().max(high.amax()) * unit_m;
        let rule =
            format!("at most {FARTHEST_M:e}: no workpiece lies further out; is the unit right?");
        OutOfBounds::unless(
            farthest_m <= FARTHEST_M,
            "a coordinate (m)",
            farthest_m,
            rule,
        )?;
        let diagonal_m = (high - low).norm() * unit_m;
        let is_extended = diagonal_m.is_finite() && diagonal_m > 0.0;
        let rule = "finite and above 0";
        OutOfBounds::unless(is_extended, "the part's diagonal (m)", diagonal_m, rule)?;
        let weld_m = options.weld_m.unwrap_or(WELD_SHARE * diagonal_m);
        let is_close = (0.0..0.1 * diagonal_m).contains(&weld_m);
        let rule = format!(
            "from 0 to below a tenth of the part's diagonal, {}",
            100.0 * diagonal_m
        );
        let weld_mm = 1e3 * weld_m;
        OutOfBounds::unless(is_close, "the welding distance (mm)", weld_mm, &rule)?;

        let mut defects = Defects::default();
        let welded = weld::weld(data, unit_m, weld_m, &mut defects);
        progress(0.5);
        let topology = Topology::of(&welded, weld_m, TINY_SHARE * diagonal_m, &mut defects);
        progress(0.7);
        let (faces, face_of) = faces::faces(&welded, &topology, options.crease_rad, weld_m);
        progress(0.85);
        let edges = edges::edges(&welded, &topology, &face_of, options.crease_rad);
        progress(0.95);
        let closed = defects.open_edges.count == 0
            && defects.non_manifold_edges.count == 0
            && defects.inverted_triangles.count == 0;
        let volume_m3 = closed.then(|| welded.volume_m3());
        defects.inside_out = volume_m3.is_some_and(|volume| volume < 0.0);
        Ok(Self {
            low_m: (low * unit_m).into(),
            high_m: (high * unit_m).into(),
            unit_m,
            suspected_unit: units::suspected(&(high - low), unit_m),
            weld_m,
            crease_rad: options.crease_rad,
            triangle_count: welded.triangles.len(),
            vertex_count: welded.vertices_m.len(),
            shells: topology.shells,
            area_m2: topology.areas_m2.iter().sum(),
            volume_m3,
            defects,
            faces,
            edges,
            step_faces: Vec::new(),
            vertices_m: welded.vertices_m,
            triangles: welded.triangles,
            face_of,
        })
    }

    /// Vertices, each once.
    #[must_use]
    pub fn vertices_m(&self) -> &[Vector3<f64>] {
        &self.vertices_m
    }

    /// Vertex indices of the triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// For each triangle the index of its face.
    #[must_use]
    pub fn face_of(&self) -> &[u32] {
        &self.face_of
    }
}

fn extent(vertices: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let first = vertices.first().copied().unwrap_or_default();
    let low = vertices.iter().fold(first, |low, v| low.inf(v));
    [low, vertices.iter().fold(first, |high, v| high.sup(v))]
}

#[cfg(test)]
mod tests;
