//! The tables `[surface]`, `[wheel]` and `[path]`.

use std::path::Path;

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::Deserialize;
use truecut_plan::surface::{MeshFace, MeshFile};
use truecut_plan::surface_path::{
    AxisRule, ContactWheel, FaceSource, FeedAlong, PathOptions, PathSetup, Strategy, SurfaceSetup,
};

use crate::check::Check;
use crate::units::{from_deg, from_mm, from_mpa, from_n_per_mm};

/// The face to be finished.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SurfaceTable {
    /// File of the patch, relative to this file. Default: none; one of `patch` and `mesh` must be
    /// there.
    patch: Option<String>,
    /// A face of a part's mesh in its place: a patch is fitted to it.
    mesh: Option<MeshFaceTable>,
    /// Closed mesh of the whole workpiece (.stl, .obj, .ply or .step) in the patch's frame,
    /// relative to this file; the wheel must not gouge it either.
    body: Option<String>,
    /// Length of the mesh's unit. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a unit has a length"))]
    body_unit_mm: Option<f64>,
    /// Where the patch's frame stands in the world. Default: [0, 0, 0].
    xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the patch's frame about the world's x, y, z. Default: [0, 0, 0].
    rpy_deg: Option<[f64; 3]>,
}

/// A face of a mesh, picked by a point and a crease angle.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MeshFaceTable {
    /// Mesh of the whole part (.stl, .obj, .ply or .step), relative to this file. Its frame is the
    /// patch's.
    file: String,
    /// Length of the mesh's unit. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a unit has a length"))]
    unit_mm: Option<f64>,
    /// A point on the face, in the mesh's frame; `truecut part` names one for each.
    point_mm: [f64; 3],
    /// Triangles that turn by this or more from one to the next belong to two faces. Default: 30.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 180.0, "x-rule" = "an angle between two triangles"))]
    crease_deg: Option<f64>,
    /// How far the patch may lie off the mesh, its chords included. Default: 0.03.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "no patch lies on all triangles"))]
    deviation_mm: Option<f64>,
    /// The direction that lines along u follow as nearly as they can, in the mesh's frame. Default:
    /// the longer one of the face.
    u_along: Option<[f64; 3]>,
}

const DEFAULT_CREASE_DEG: f64 = 30.0;
const DEFAULT_DEVIATION_MM: f64 = 0.03;

impl MeshFaceTable {
    fn resolve(self, table: &str, folder: &Path, check: &mut Check) -> MeshFace {
        let key = format!("{table}.mesh.u_along");
        let u_along = (self.u_along).and_then(|way| check.direction(&key, way));
        MeshFace {
            mesh: MeshFile {
                file: folder.join(self.file),
                unit_m: from_mm(self.unit_mm.unwrap_or(1.0)),
            },
            point_m: self.point_mm.map(from_mm).into(),
            crease_rad: from_deg(self.crease_deg.unwrap_or(DEFAULT_CREASE_DEG)),
            deviation_m: from_mm(self.deviation_mm.unwrap_or(DEFAULT_DEVIATION_MM)),
            u_along: u_along.map(Vector3::from),
        }
    }
}

/// The contact wheel.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WheelTable {
    /// Radius with the belt on.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a wheel has a radius"))]
    radius_mm: f64,
    /// Width.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a wheel has a width"))]
    width_mm: f64,
    /// How far the wheel's centre is set below its radius. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a wheel that does not touch grinds nothing"))]
    indentation_mm: Option<f64>,
    /// Normal force per width.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    line_load_n_per_mm: f64,
    /// Effective modulus of wheel and workpiece.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is elastic"))]
    modulus_mpa: f64,
}

/// How lines are laid on the patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum StrategyWord {
    /// Lines along which one parameter is constant.
    IsoParametric,
    /// Lines between which ridges of one height are left.
    IsoScallop,
    /// Sections of the patch with parallel planes.
    ParallelPlane,
}

/// Where the wheel's axis points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Axis {
    /// Along the least curvature, whatever the feed: the published rule.
    LeastCurvature,
    /// Where the swath is widest and the edge gap keeps its limit.
    WidestSwath,
}

/// The lines on the face.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PathTable {
    /// How lines are laid.
    strategy: StrategyWord,
    /// The parameter along which lines are fed. Default: "u". Parallel planes choose it themselves.
    feed_along: Option<FeedAlong>,
    /// Where the wheel's axis points. Default: "widest_swath".
    axis: Option<Axis>,
    /// Largest gap under the wheel's edges, for the widest swath.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a straight wheel leaves a gap on every curved face"))]
    edge_gap_limit_mm: Option<f64>,
    /// Share of the swath that the next line covers again. Default: 0.
    #[schemars(extend("minimum" = 0.0, "exclusiveMaximum" = 1.0, "x-rule" = "lines stand side by side and get on"))]
    overlap: Option<f64>,
    /// Greatest height of the ridge between two lines, for iso_scallop.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "without a ridge lines would have no distance"))]
    scallop_mm: Option<f64>,
    /// Normal of the planes in the patch's frame, for parallel_plane.
    plane_normal: Option<[f64; 3]>,
    /// Whether a line is laid along each border of the patch, too, which takes the triangles that
    /// planes askew to a border leave there, for parallel_plane. Default: false.
    border_lines: Option<bool>,
    /// Largest distance of points along a line.
    #[schemars(extend("minimum" = 0.02, "x-rule" = "programs print thousandths of a millimetre, by which nearer points would lose the line's direction"))]
    step_mm: f64,
    /// Distance that the contact keeps from the borders of the face. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "the contact stays on the face"))]
    margin_mm: Option<f64>,
    /// How far the wheel is lifted before and after each line.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel leaves the face between lines"))]
    lift_mm: f64,
    /// Speed of the wheel's centre on a line.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is fed along the line"))]
    feed_mm_per_s: f64,
    /// How deep the undeformed wheel may lie in the face or the body anywhere. Default: the
    /// indentation and the edge gap limit together.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a depth"))]
    gouge_limit_mm: Option<f64>,
}

impl SurfaceTable {
    /// `None` after recording a fault. `table` is the table's path.
    pub(crate) fn resolve(
        self,
        table: &str,
        folder: &Path,
        check: &mut Check,
    ) -> Option<SurfaceSetup> {
        if self.body.is_none() {
            let because = format!("there is no `{table}.body` whose unit it could be");
            check.ignored(table, &["body_unit_mm"], &because);
        }
        let unit_m = from_mm(self.body_unit_mm.unwrap_or(1.0));
        let face = match (self.patch, self.mesh) {
            (Some(patch), None) => FaceSource::Patch(folder.join(patch)),
            (None, Some(mesh)) => FaceSource::Mesh(mesh.resolve(table, folder, check)),
            (Some(_), Some(_)) => {
                let because = format!("`{table}.mesh` gives the face");
                check.ignored(table, &["patch"], &because);
                return None;
            }
            (None, None) => {
                let who = format!("the face (or a table `{table}.mesh`)");
                return check.needed(table, "patch", None, &who);
            }
        };
        Some(SurfaceSetup {
            face,
            body: self.body.map(|name| MeshFile {
                file: folder.join(name),
                unit_m,
            }),
            world_from_patch: place(self.xyz_mm, self.rpy_deg),
        })
    }
}

/// Where something stands in the world, by default at its origin. Rotations are about the world's
/// x, then y, then z axis.
pub(crate) fn place(xyz_mm: Option<[f64; 3]>, rpy_deg: Option<[f64; 3]>) -> Isometry3<f64> {
    let [roll, pitch, yaw] = rpy_deg.unwrap_or_default().map(from_deg);
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    let xyz_m = xyz_mm.unwrap_or_default().map(from_mm);
    Isometry3::from_parts(Vector3::from(xyz_m).into(), rotation)
}

impl WheelTable {
    pub(super) fn resolve(&self, check: &mut Check) -> ContactWheel {
        let indentation_mm = self.indentation_mm.unwrap_or(0.0);
        if indentation_mm >= self.radius_mm {
            let message = format!(
                "is {indentation_mm}, but must be below the radius {}: the wheel's centre stays outside",
                self.radius_mm
            );
            check.wrong("wheel", "indentation_mm", message, "too deep");
        }
        ContactWheel {
            radius_m: from_mm(self.radius_mm),
            width_m: from_mm(self.width_mm),
            indentation_m: from_mm(indentation_mm),
            line_load_n_per_m: from_n_per_mm(self.line_load_n_per_mm),
            modulus_pa: from_mpa(self.modulus_mpa),
        }
    }
}

impl PathTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(&self, indentation_m: f64, check: &mut Check) -> Option<PathSetup> {
        let strategy = self.strategy(check);
        let (axis, gouge_limit_m) = match self.axis.unwrap_or(Axis::WidestSwath) {
            Axis::LeastCurvature => {
                let because = "axis = \"least_curvature\" looks at the curvature alone";
                check.ignored("path", &["edge_gap_limit_mm"], because);
                let who = "axis = \"least_curvature\", which bounds no edge gap,";
                let limit = check.needed("path", "gouge_limit_mm", self.gouge_limit_mm, who);
                (Some(AxisRule::LeastCurvature), limit.map(from_mm))
            }
            Axis::WidestSwath => {
                let who = "axis = \"widest_swath\"";
                let limit = check.needed("path", "edge_gap_limit_mm", self.edge_gap_limit_mm, who);
                let edge_gap_limit_m = limit.map(from_mm);
                let both = edge_gap_limit_m.map(|gap_m| indentation_m + gap_m);
                let axis = edge_gap_limit_m
                    .map(|edge_gap_limit_m| AxisRule::WidestSwath { edge_gap_limit_m });
                (axis, self.gouge_limit_mm.map(from_mm).or(both))
            }
        };
        Some(PathSetup {
            strategy: strategy?,
            along: self.feed_along.unwrap_or_default(),
            options: PathOptions {
                rule: axis?,
                overlap: self.overlap.unwrap_or(0.0),
                step_m: from_mm(self.step_mm),
                margin_m: from_mm(self.margin_mm.unwrap_or(0.0)),
            },
            lift_m: from_mm(self.lift_mm),
            feed_m_per_s: from_mm(self.feed_mm_per_s),
            gouge_limit_m: gouge_limit_m?,
        })
    }

    fn strategy(&self, check: &mut Check) -> Option<Strategy> {
        let idle = |keys: &[&str], name: &str, check: &mut Check| {
            let because = format!("strategy = \"{name}\" has no use for it");
            check.ignored("path", keys, &because);
        };
        match self.strategy {
            StrategyWord::IsoParametric => {
                idle(
                    &["scallop_mm", "plane_normal", "border_lines"],
                    "iso_parametric",
                    check,
                );
                Some(Strategy::IsoParametric)
            }
            StrategyWord::IsoScallop => {
                idle(&["plane_normal", "border_lines"], "iso_scallop", check);
                let who = "strategy = \"iso_scallop\"";
                let scallop = check.needed("path", "scallop_mm", self.scallop_mm, who)?;
                let scallop_m = from_mm(scallop);
                Some(Strategy::IsoScallop { scallop_m })
            }
            StrategyWord::ParallelPlane => {
                idle(&["scallop_mm", "feed_along"], "parallel_plane", check);
                let who = "strategy = \"parallel_plane\"";
                let normal = check.needed("path", "plane_normal", self.plane_normal, who)?;
                check.direction("path.plane_normal", normal)?;
                let normal = Unit::new_normalize(Vector3::from(normal));
                let along_borders = self.border_lines.unwrap_or(false);
                Some(Strategy::ParallelPlane {
                    normal,
                    along_borders,
                })
            }
        }
    }
}
