//! The `[process.polish.face]` table: a rectangle in the world.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_plan::motion::polish::RectangularFace;

use crate::check::Check;
use crate::units::from_mm;

/// A rectangular face in the world.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FaceTable {
    /// Corner at which the raster begins, in the robot's base frame.
    origin_mm: [f64; 3],
    /// Direction of the length, of any length. Default: [1, 0, 0].
    x_axis: Option<[f64; 3]>,
    /// Direction of the outward normal, of any length. Default: [0, 0, 1], up.
    normal: Option<[f64; 3]>,
    /// Length, along x_axis.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a face has a length"))]
    length_mm: f64,
    /// Width, along normal × x_axis.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a face has a width"))]
    width_mm: f64,
    /// Largest size of the cells on which removal is kept. Default: 0.5.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cell has a size"))]
    cell_mm: Option<f64>,
}

const TABLE: &str = "process.polish.face";

/// Size of the cells where a scenario does not give one, mm.
const DEFAULT_CELL_MM: f64 = 0.5;

/// Most cells of a face: a map of them fits into memory and onto a screen.
const MOST_CELLS: f64 = 4e6;

/// Largest cosine between the two directions.
const LARGEST_COSINE: f64 = 1e-6;

impl FaceTable {
    /// The face, and the largest size of its cells (m). `None` after recording a fault.
    pub(super) fn resolve(self, check: &mut Check) -> Option<(RectangularFace, f64)> {
        let mut unit = |key, given| check.direction(&format!("{TABLE}.{key}"), given);
        let x_axis = unit("x_axis", self.x_axis.unwrap_or([1.0, 0.0, 0.0]));
        let normal = unit("normal", self.normal.unwrap_or([0.0, 0.0, 1.0]));
        let (x_axis, normal) = (x_axis?, normal?);
        let cosine: f64 = x_axis.iter().zip(&normal).map(|(a, b)| a * b).sum();
        if cosine.abs() > LARGEST_COSINE {
            let key = match self.x_axis {
                Some(_) => "x_axis",
                None => "normal",
            };
            let message = format!(
                "stands {:.4} degrees off a right angle to the other direction of the face, \
                 but length and normal must be square",
                cosine.clamp(-1.0, 1.0).asin().to_degrees().abs()
            );
            check.wrong(TABLE, key, message, "not square");
            return None;
        }
        let cell_mm = self.cell_mm.unwrap_or(DEFAULT_CELL_MM);
        let cells = (self.length_mm / cell_mm).ceil() * (self.width_mm / cell_mm).ceil();
        if cells > MOST_CELLS {
            let message = format!(
                "is {cell_mm}, which makes {cells:.2e} cells, but a face has at most \
                 {MOST_CELLS:.0e}: their map fits into memory"
            );
            check.wrong(TABLE, "cell_mm", message, "too fine");
            return None;
        }
        let face = RectangularFace {
            origin_m: self.origin_mm.map(from_mm),
            x_axis,
            normal,
            length_m: from_mm(self.length_mm),
            width_m: from_mm(self.width_mm),
        };
        Some((face, from_mm(cell_mm)))
    }
}
