//! The `[process.path_milling.stock]` table: what is cut.

use std::path::Path;
use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::cutting::milling::layered::block::{Block, Hole};
use truecut_core::cutting::milling::layered::solid::Solid;
use truecut_core::cutting::milling::layered::way::{COARSEST, COARSEST_OF_CORNER, MOST_NODES};
use truecut_core::cutting::milling::profile::Profile;
use truecut_plan::surface::{Mesh, MeshUse};

use crate::check::Check;
use crate::fault::Fault;
use crate::units::from_mm;

/// Stock in the path's work frame.
#[derive(Debug, Clone, PartialEq)]
pub struct StockSpec {
    /// A box of it, or the box about the mesh.
    pub block: Block,
    /// Holes through it.
    pub holes: Vec<Hole>,
    /// The mesh, where it is one.
    pub solid: Option<Arc<Solid>>,
    /// Largest spacing of the grid on which it is kept.
    pub grid_m: f64,
}

/// A box or a closed mesh in the path's work frame (of a robot program: its base frame).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StockTable {
    /// Corner of a box with the least x, y and z.
    corner_mm: Option<[f64; 3]>,
    /// Its lengths along x, y and z.
    size_mm: Option<[f64; 3]>,
    /// In place of a box a closed mesh (.stl, .obj, .ply or .step), relative to this file, as it
    /// stands in the work frame; the part that an earlier run left is one.
    mesh: Option<String>,
    /// Length of the mesh's unit. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a unit has a length"))]
    unit_mm: Option<f64>,
    /// Largest spacing of the grid on which it is kept. Default: a fiftieth of the cutter's
    /// diameter, at most a quarter of its corner radius.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a grid has a spacing"))]
    grid_mm: Option<f64>,
    /// Round holes through it, along z. Default: none.
    hole: Option<Vec<HoleTable>>,
}

/// A round hole.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct HoleTable {
    /// Its middle.
    xy_mm: [f64; 2],
    /// Its diameter.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a hole has a diameter"))]
    diameter_mm: f64,
}

const STOCK: &str = "process.path_milling.stock";
/// Spacing of the grid where a scenario gives none, as a part of the diameter.
const DEFAULT_GRID: f64 = 0.02;
/// Most nodes of all layers of a mesh.
const MOST_LAYERED_NODES: f64 = 64e6;

impl StockTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(
        self,
        profile: &Profile,
        folder: &Path,
        check: &mut Check,
    ) -> Option<StockSpec> {
        let radius_m = profile.radius_m;
        let of_corner_m = match profile.is_flat() {
            true => f64::INFINITY,
            false => COARSEST_OF_CORNER * profile.corner_radius_m,
        };
        let of_itself_m = (2.0 * DEFAULT_GRID * radius_m).min(of_corner_m);
        let grid_m = (self.grid_mm).map_or(of_itself_m, from_mm);
        let coarsest_m = (COARSEST * radius_m).min(of_corner_m);
        let (block, solid) = match &self.mesh {
            Some(mesh) => {
                let because = "the stock is a mesh, which stands where it is";
                check.ignored(STOCK, &["corner_mm", "size_mm"], because);
                let unit_m = from_mm(self.unit_mm.unwrap_or(1.0));
                let solid = solid(mesh, folder, unit_m, check)?;
                (solid.block(grid_m), Some(Arc::new(solid)))
            }
            None => {
                check.ignored(STOCK, &["unit_mm"], "the stock is a box, in mm");
                (self.box_of(check)?, None)
            }
        };
        if grid_m > coarsest_m * (1.0 + 1e-9) {
            let of = match of_corner_m < COARSEST * radius_m {
                true => "a quarter of its corner radius: floors are told between nodes",
                false => {
                    "a sixteenth of the cutter's diameter: rims are told to the square of the spacing"
                }
            };
            let is = format!(
                "is {}, but must be at most {} mm, {of}",
                grid_m * 1e3,
                coarsest_m * 1e3
            );
            check.wrong(STOCK, "grid_mm", is, "too coarse for the cutter");
            return None;
        }
        let depths = solid.as_ref().map(|solid| solid.depths_m(grid_m));
        fits(&block, depths.as_deref(), grid_m, check)?;
        let hole = |hole: HoleTable| Hole {
            centre_m: Vector2::from(hole.xy_mm.map(from_mm)),
            radius_m: 0.5 * from_mm(hole.diameter_mm),
        };
        let holes = self.hole.unwrap_or_default().into_iter().map(hole);
        Some(StockSpec {
            block,
            holes: holes.collect(),
            solid,
            grid_m,
        })
    }

    /// `None` after recording a fault.
    fn box_of(&self, check: &mut Check) -> Option<Block> {
        let who = "a stock without `mesh` is a box, which";
        let corner = check.needed(STOCK, "corner_mm", self.corner_mm, who)?;
        let size = check.needed(STOCK, "size_mm", self.size_mm, who)?;
        if let Some(least) = size.iter().copied().find(|length| *length <= 0.0) {
            let is =
                format!("has the length {least}, but lengths must be above 0: a box is a body");
            check.wrong(STOCK, "size_mm", is, "no body");
            return None;
        }
        let least_m = Vector3::from(corner.map(from_mm));
        Some(Block {
            least_m,
            most_m: least_m + Vector3::from(size.map(from_mm)),
        })
    }
}

/// `None` after recording a fault.
fn solid(mesh: &str, folder: &Path, unit_m: f64, check: &mut Check) -> Option<Solid> {
    let file = folder.join(mesh);
    let read = Mesh::load(&file, unit_m, MeshUse::Body).map_err(|error| error.to_string());
    let made = read.and_then(|read| {
        let corners = |triangle: &[usize; 3]| triangle.map(|k| read.vertices_m()[k]);
        let solid = Solid::new(read.triangles().iter().map(corners).collect());
        solid.map_err(|fault| format!("{}: {fault}", file.display()))
    });
    match made {
        Ok(solid) => Some(solid),
        Err(why) => {
            let is = format!("cannot be stock: {why}");
            check.wrong(STOCK, "mesh", is, "no stock");
            None
        }
    }
}

/// `None` after recording a fault: the grid has too many nodes for a box or a mesh with layers
/// between these heights.
fn fits(block: &Block, depths_m: Option<&[f64]>, grid_m: f64, check: &mut Check) -> Option<()> {
    let size_mm = (block.most_m - block.least_m) * 1e3;
    let rounded = |length_mm: f64| (length_mm * 1e6).round() * 1e-6;
    let nodes = size_mm.x * size_mm.y * 1e-6 / (grid_m * grid_m);
    let layers = depths_m.map_or(1, |depths_m| depths_m.len() - 1);
    let (has, most) = match nodes > MOST_NODES {
        true => (nodes, MOST_NODES),
        false => (nodes * layers as f64, MOST_LAYERED_NODES),
    };
    if has <= most {
        return Some(());
    }
    let key = match depths_m {
        Some(_) => "mesh",
        None => "size_mm",
    };
    let in_layers = match has > nodes {
        true => format!(" in {layers} layers"),
        false => String::new(),
    };
    let message = format!(
        "a grid of {} mm over {} x {} mm{in_layers} has {has:.2e} nodes, but must have at most {most:.1e}: raise \
         `{STOCK}.grid_mm`",
        grid_m * 1e3,
        rounded(size_mm.x),
        rounded(size_mm.y)
    );
    check.refuse(Fault::value(
        &format!("{STOCK}.{key}"),
        message,
        "too fine for the stock",
    ));
    None
}
