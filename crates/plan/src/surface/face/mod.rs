//! A face of a part's mesh as a patch: picked by a point and a crease angle, laid over the unit
//! square, fitted by a cubic B-spline surface whose deviation from the mesh is measured and
//! bounded.
//!
//! The face must be a graph over the plane across its mean normal. A face with four corners is laid
//! over the square side by side, so that lines of constant parameters run along its sides; any
//! other one with the smallest rectangle about it, and its outline is the boundary of the patch.

mod chart;
mod fit;
mod outline;
mod samples;
#[cfg(test)]
mod tests;

use std::path::Path;

use nalgebra::{Unit, Vector3};
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;

use super::error::{SurfaceError, SurfaceFault, place};
use super::file::check_normals;
use super::mesh::to_parry;
use super::mesh_files::MeshFile;
use super::part::{Part, PartOptions};
use super::{Boundary, PatchFile};
use crate::bounds::OutOfBounds;
use chart::Chart;
use outline::Loop;

/// A point picks a face from this share of the part's diagonal at most.
const PICK_SHARE: f64 = 1e-3;
/// A face is laid out flat along its mean normal; nowhere may it stand steeper to that.
const STEEPEST_DEG: f64 = 75.0;

/// A face of a mesh, and how near a patch shall come to it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFace {
    /// The whole part, closed.
    pub mesh: MeshFile,
    /// A point on the face or near it, in the mesh's frame.
    pub point_m: Vector3<f64>,
    /// Triangles that turn by this or more from one to the next belong to two faces, rad.
    pub crease_rad: f64,
    /// How far the patch may lie off the mesh, m.
    pub deviation_m: f64,
    /// The direction that u follows as nearly as it can; `None`: the longer one of the face.
    pub u_along: Option<Vector3<f64>>,
}

/// How near a patch comes to the face that it stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceFit {
    /// Number of the face in a report on the part.
    pub face: usize,
    pub triangles: usize,
    pub area_m2: f64,
    /// Largest distance of the mesh from the patch, m: at its vertices, and anywhere, where chords
    /// between vertices stand off a curved face by themselves.
    pub at_vertices_m: f64,
    pub deviation_m: f64,
    pub control_points: [usize; 2],
    /// Whether lines of constant parameters run along the sides of a face of four corners.
    pub has_four_sides: bool,
    pub holes: usize,
}

impl MeshFace {
    /// Reads the part, picks the face and fits it.
    ///
    /// # Errors
    /// If the file cannot be read, the part is not whole, no face is at the point, the face is no
    /// graph over a plane, or the deviation cannot be kept.
    pub fn load(&self) -> Result<PatchFile, SurfaceError> {
        let path: &Path = &self.mesh.file;
        let options = PartOptions {
            unit_m: self.mesh.unit_m,
            crease_rad: self.crease_rad,
            weld_m: None,
        };
        let part = Part::load(path, &options, &|_| {})?;
        self.of(&part)
            .map_err(|fault| SurfaceError::in_file(path, None, fault))
    }

    /// The patch of a part that was looked at with the crease angle.
    ///
    /// # Errors
    /// As [`MeshFace::load`], but for the file.
    pub fn of(&self, part: &Part) -> Result<PatchFile, SurfaceFault> {
        check_whole(part)?;
        let face = self.pick(part)?;
        let triangles: Vec<[u32; 3]> = (part.triangles().iter().zip(part.face_of()))
            .filter(|(_, of)| **of as usize == face)
            .map(|(triangle, _)| *triangle)
            .collect();
        let vertices_m = part.vertices_m();
        let normal = check_graph(vertices_m, &triangles, &part.faces[face].normal.into())?;
        let (outer, holes) = outline::loops(vertices_m, &triangles, &normal)?;
        let u_along = self.u_along.as_ref();
        let mut chart = Chart::of(&outer, &normal, u_along, true);
        let mut taken = samples::taken(vertices_m, &triangles, &chart);
        // Four sides may be bent so far that what Coons blends between them folds.
        if matches!(taken, Err(SurfaceFault::FaceFolds { .. })) && chart.has_four_sides {
            chart = Chart::of(&outer, &normal, u_along, false);
            taken = samples::taken(vertices_m, &triangles, &chart);
        }
        let samples = taken?;
        // Before the fit: what lies over itself has no patch, and would be told to deviate.
        let boundary = boundary(&chart, &outer, &holes, 0.25 * self.deviation_m)?;
        let fitted = fit::fit(&samples, &chart, self.deviation_m)?;
        check_normals(&fitted.patch, normal.into_inner().into())?;
        Ok(PatchFile {
            surface: Box::new(fitted.patch),
            boundary,
            fit: Some(FaceFit {
                face: face + 1,
                triangles: triangles.len(),
                area_m2: part.faces[face].area_m2,
                at_vertices_m: fitted.at_vertices_m,
                deviation_m: fitted.deviation_m,
                control_points: fitted.control_points,
                has_four_sides: chart.has_four_sides,
                holes: holes.len(),
            }),
        })
    }

    /// The face of the triangle nearest to the point.
    fn pick(&self, part: &Part) -> Result<usize, SurfaceFault> {
        let at = to_parry(&self.point_m);
        let nearest = (part.triangles().iter().zip(part.face_of()))
            .map(|(triangle, face)| {
                let [a, b, c] = triangle.map(|i| to_parry(&part.vertices_m()[i as usize]));
                let on = Triangle::new(a, b, c).project_local_point(at, false).point;
                ((on - at).length(), on, *face as usize)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (away_m, on, face) = nearest.ok_or(SurfaceFault::EmptyMesh)?;
        let diagonal_m = (Vector3::from(part.high_m) - Vector3::from(part.low_m)).norm();
        let limit_m = PICK_SHARE * diagonal_m;
        if away_m <= limit_m {
            return Ok(face);
        }
        Err(SurfaceFault::OffThePart {
            away_mm: away_m * 1e3,
            limit_mm: limit_m * 1e3,
            nearest: place(&(1e3 * Vector3::new(on.x, on.y, on.z))),
        })
    }
}

/// A face is taken from a part that has an inside.
fn check_whole(part: &Part) -> Result<(), SurfaceFault> {
    let defects = &part.defects;
    let faults = [
        ("non-manifold edges", defects.non_manifold_edges),
        ("inverted triangles", defects.inverted_triangles),
        ("open edges", defects.open_edges),
    ];
    if let Some((what, defect)) = faults.into_iter().find(|(_, d)| d.count > 0) {
        let first: Vector3<f64> = defect.first_at_m.unwrap_or_default().into();
        return Err(SurfaceFault::NotWhole {
            what,
            count: defect.count,
            first: place(&(first * 1e3)),
        });
    }
    match part.volume_m3 {
        Some(volume_m3) if volume_m3 <= 0.0 => Err(SurfaceFault::InsideOut { volume_m3 }),
        _ => Ok(()),
    }
}

/// The mean normal, if all triangles stand within an angle of it.
fn check_graph(
    vertices_m: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    mean: &Vector3<f64>,
) -> Result<Unit<Vector3<f64>>, SurfaceFault> {
    let closed = || {
        OutOfBounds::new(
            "the mean normal of the face",
            "0",
            "above 0: it closes on itself",
        )
    };
    let mean = Unit::try_new(*mean, 0.5).ok_or_else(closed)?;
    let mut steepest = (1.0_f64, Vector3::zeros());
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| vertices_m[i as usize]);
        // A triangle without height has no normal to be steep by.
        let Some(normal) = (b - a)
            .cross(&(c - a))
            .try_normalize(1e-7 * (b - a).norm_squared())
        else {
            continue;
        };
        let cosine = normal.dot(&mean);
        if cosine < steepest.0 {
            steepest = (cosine, (a + b + c) / 3.0);
        }
    }
    let angle_deg = steepest.0.clamp(-1.0, 1.0).acos().to_degrees();
    if angle_deg <= STEEPEST_DEG {
        return Ok(mean);
    }
    Err(SurfaceFault::FaceTurns {
        angle_deg,
        at: place(&(steepest.1 * 1e3)),
        limit_deg: STEEPEST_DEG,
    })
}

/// The outline of a face that does not fill its square, and its holes.
fn boundary(
    chart: &Chart,
    outer: &Loop,
    holes: &[Loop],
    within_m: f64,
) -> Result<Option<Boundary>, SurfaceFault> {
    if chart.has_four_sides && holes.is_empty() {
        return Ok(None);
    }
    let closed = |line: &Loop| {
        let mut points = outline::simplified(&line.points_m, within_m);
        points.push(points[0]);
        points
    };
    let mut made = Boundary::new(&closed(outer)).map_err(|fault| match fault {
        SurfaceFault::SelfIntersecting { at, .. } => SurfaceFault::FaceFolds {
            at: format!("{at} m"),
        },
        other => other,
    })?;
    for hole in holes {
        made.add_hole(&closed(hole))?;
    }
    made.follows_border(|a, b| chart.has_four_sides || chart.on_one_side(a, b, 4.0 * within_m));
    Ok(Some(made))
}
