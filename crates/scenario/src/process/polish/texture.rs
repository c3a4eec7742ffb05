//! The `[process.polish.texture]` table: unevenness of the wheel's running surface.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::texture::{MOST_WAVES, Texture};

use crate::check::Check;
use crate::units::{from_mm, from_um};

/// Texture of the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureSpec {
    /// Size and correlation.
    pub texture: Texture,
    /// Of the random numbers.
    pub seed: u32,
}

/// Unevenness that comes round with every turn.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TextureTable {
    /// Root of the mean square of the deviation of the wheel's radius along the circle that
    /// touches.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "an even wheel has no texture"))]
    rms_um: f64,
    /// Distance over which the correlation falls to 1/e.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "unevenness has a length"))]
    length_mm: f64,
    /// Seed of the random numbers. Default: 1.
    seed: Option<u32>,
}

const TABLE: &str = "process.polish.texture";

impl TextureTable {
    pub(super) fn resolve(self, circumference_m: f64, check: &mut Check) -> TextureSpec {
        let texture = Texture {
            rms_m: from_um(self.rms_um),
            length_m: from_mm(self.length_mm),
        };
        if texture.waves(circumference_m) > MOST_WAVES {
            let message = format!(
                "is {}, but must be larger: {MOST_WAVES} waves on the {:.1} mm of the circle that \
                 touches are summed in every step",
                self.length_mm,
                circumference_m * 1e3
            );
            check.wrong(TABLE, "length_mm", message, "too short");
        }
        TextureSpec {
            texture,
            seed: self.seed.unwrap_or(1),
        }
    }
}
