//! The `[process.polish.path]` table: a raster over the face.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_plan::motion::polish::RectangularFace;
use truecut_plan::motion::raster::Raster;

use crate::check::Check;
use crate::units::from_mm;

/// Lines along the face's length, to and fro.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RasterTable {
    /// Largest distance between lines: as many are laid as share the width evenly.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "lines lie apart"))]
    line_spacing_mm: f64,
    /// Distance of the outermost lines and of the lines' ends from the edges; negative: beyond
    /// them. Default: 0, along the edges.
    inset_mm: Option<f64>,
    /// Radius of the corners.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "no arm turns a sharp corner at speed"))]
    corner_radius_mm: f64,
    /// Speed along the path.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is fed along the path"))]
    feed_mm_per_s: f64,
}

const TABLE: &str = "process.polish.path";

impl RasterTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(self, face: &RectangularFace, check: &mut Check) -> Option<Raster> {
        let corner_radius_mm = self.corner_radius_mm;
        let inset_m = from_mm(self.inset_mm.unwrap_or(0.0));
        let [length_m, width_m] = [face.length_m, face.width_m].map(|side| side - 2.0 * inset_m);
        if length_m <= 0.0 || width_m <= 0.0 {
            let message = format!(
                "is {}, but must be less than half of the face, {} by {} mm: lines have a \
                 length",
                inset_m * 1e3,
                face.length_m * 1e3,
                face.width_m * 1e3
            );
            check.wrong(TABLE, "inset_mm", message, "no path is left");
            return None;
        }
        let gaps = (width_m / from_mm(self.line_spacing_mm) - 1e-9)
            .ceil()
            .max(1.0);
        let spacing_m = width_m / gaps;
        let corner_radius_m = from_mm(corner_radius_mm);
        let largest_m = 0.5 * spacing_m.min(length_m);
        if corner_radius_m > largest_m * (1.0 + 1e-9) {
            let message = format!(
                "is {corner_radius_mm}, but must be at most {:.4}, half the distance \
                 between lines: two corners fit between them",
                largest_m * 1e3
            );
            check.wrong(TABLE, "corner_radius_mm", message, "corners overlap");
            return None;
        }
        Some(Raster {
            lines: gaps as usize + 1,
            inset_m,
            corner_radius_m,
            feed_m_per_s: from_mm(self.feed_mm_per_s),
        })
    }
}
