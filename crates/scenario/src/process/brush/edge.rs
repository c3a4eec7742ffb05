//! The tables `[process.brush.workpiece]` and `[[process.brush.edge]]`.

use std::path::Path;

use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::Deserialize;
use truecut_plan::surface::MeshFile;

use super::TABLE;
use crate::check::Check;
use crate::fault::Fault;
use crate::path_job::place;
use crate::units::{from_deg, from_mm};

/// An edge of the workpiece.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeSpec {
    /// Where it is.
    pub place: EdgePlace,
    /// How far the burr stands out.
    pub burr_height_m: f64,
    /// Thickness of the burr.
    pub burr_thickness_m: f64,
}

/// Where an edge is, in the workpiece's frame.
#[derive(Debug, Clone, PartialEq)]
pub enum EdgePlace {
    /// Points along it.
    Points(Vec<[f64; 3]>),
    /// The whole edge that a point picks.
    Picked {
        /// The point.
        point_m: [f64; 3],
        /// Whether it is fed the other way round.
        reversed: bool,
    },
}

impl EdgePlace {
    /// The key that gives it.
    pub fn key(&self) -> &'static str {
        match self {
            EdgePlace::Points(_) => "points_mm",
            EdgePlace::Picked { .. } => "point_mm",
        }
    }
}

/// A workpiece as a closed mesh.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WorkpieceTable {
    /// Closed mesh (.stl, .obj, .ply or .step), relative to this file.
    mesh: String,
    /// Length of the mesh's unit. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a unit has a length"))]
    unit_mm: Option<f64>,
    /// Where the mesh's frame stands in the world. Default: [0, 0, 0].
    xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of that frame about the world's x, y, z. Default: [0, 0, 0].
    rpy_deg: Option<[f64; 3]>,
    /// Where a point picks an edge: faces that turn by this or more meet in one, and it ends where
    /// its own way turns by as much, or where a third edge meets it. Default: 30.
    #[schemars(extend("minimum" = 10.0, "exclusiveMaximum" = 180.0, "x-rule" = "a curved face cut into triangles turns by less"))]
    crease_deg: Option<f64>,
}

/// An edge.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct EdgeTable {
    /// Points along the edge, in the mesh's frame; from point to point it is straight. Default:
    /// none; one of `points_mm` and `point_mm` must be there.
    #[schemars(length(min = 2), extend("x-rule" = "an edge has two ends"))]
    points_mm: Option<Vec<[f64; 3]>>,
    /// A point on the edge in their place, which picks all of it. Along an open edge the way begins
    /// at the end that is nearer to it, along a closed one here, counter-clockwise seen from
    /// outside.
    point_mm: Option<[f64; 3]>,
    /// Whether the way goes along it the other way round. Default: false.
    reversed: Option<bool>,
    /// How far the burr stands out. Default: 0, a clean sharp edge.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a burr stands out"))]
    burr_height_mm: Option<f64>,
    /// Thickness of the burr.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a burr has a thickness"))]
    burr_thickness_mm: Option<f64>,
}

const DEFAULT_CREASE_DEG: f64 = 30.0;

impl WorkpieceTable {
    /// The mesh, where its frame stands, and the crease angle.
    pub(super) fn resolve(
        self,
        edges: &[EdgeSpec],
        folder: &Path,
        check: &mut Check,
    ) -> (MeshFile, Isometry3<f64>, f64) {
        let is_picked = |edge: &EdgeSpec| matches!(edge.place, EdgePlace::Picked { .. });
        if !edges.iter().any(is_picked) {
            let because = "no edge is picked by `point_mm`";
            check.ignored("process.brush.workpiece", &["crease_deg"], because);
        }
        let body = MeshFile {
            file: folder.join(self.mesh),
            unit_m: from_mm(self.unit_mm.unwrap_or(1.0)),
        };
        let crease_rad = from_deg(self.crease_deg.unwrap_or(DEFAULT_CREASE_DEG));
        (body, place(self.xyz_mm, self.rpy_deg), crease_rad)
    }
}

impl EdgeTable {
    /// `None` after recording a fault. `laid`: the way is laid along the edges.
    pub(super) fn resolve(self, index: usize, laid: bool, check: &mut Check) -> Option<EdgeSpec> {
        let table = format!("{TABLE}.edge.{index}");
        let burr = self.burr(&table, check);
        if !laid {
            let because =
                "only a way that is laid along the edges ([process.brush.along]) has a direction";
            check.ignored(&table, &["reversed"], because);
        }
        let place = match (self.points_mm, self.point_mm) {
            (Some(points_mm), None) => {
                if laid {
                    let is = "gives points, but a way is laid along an edge that is picked: give `point_mm`, a point on it";
                    check.wrong(&table, "points_mm", is, "not picked");
                    return None;
                }
                points(&points_mm, &table, check)?
            }
            (None, Some(point_mm)) => EdgePlace::Picked {
                point_m: point_mm.map(from_mm),
                reversed: self.reversed.unwrap_or(false),
            },
            (Some(_), Some(_)) => {
                check.ignored(&table, &["points_mm"], "`point_mm` picks the edge");
                return None;
            }
            (None, None) => {
                let who = "an edge (or `points_mm` along it)";
                return check.needed(&table, "point_mm", None, who);
            }
        };
        let (burr_height_m, burr_thickness_m) = burr?;
        Some(EdgeSpec {
            place,
            burr_height_m,
            burr_thickness_m,
        })
    }

    /// Height and thickness, m; `None` after recording a fault.
    fn burr(&self, table: &str, check: &mut Check) -> Option<(f64, f64)> {
        let height_mm = self.burr_height_mm.unwrap_or(0.0);
        if height_mm == 0.0 {
            let because = "without `burr_height_mm` there is no burr";
            check.ignored(table, &["burr_thickness_mm"], because);
            return Some((0.0, 0.0));
        }
        let thickness_mm = self.burr_thickness_mm;
        let thickness_mm = check.needed(table, "burr_thickness_mm", thickness_mm, "a burr")?;
        Some((from_mm(height_mm), from_mm(thickness_mm)))
    }
}

/// `None` after recording a fault.
fn points(points_mm: &[[f64; 3]], table: &str, check: &mut Check) -> Option<EdgePlace> {
    if let Some(k) = points_mm.windows(2).position(|pair| pair[0] == pair[1]) {
        let path = format!("{table}.points_mm");
        let message = format!(
            "points {} and {} of `{path}` are the same, {:?}: an edge gets on from point to point",
            k + 1,
            k + 2,
            points_mm[k]
        );
        check.refuse(Fault::value(&path, message, "stands still"));
        return None;
    }
    let points_m = points_mm.iter().map(|point| point.map(from_mm));
    Some(EdgePlace::Points(points_m.collect()))
}
