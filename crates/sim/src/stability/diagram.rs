//! The part of the plane that a stability diagram shows.

use truecut_core::chatter::TipMode;
use truecut_core::chatter::averaged::zero_order_limit;
use truecut_plan::lobes::LobeRequest;

use super::MillingStudy;

/// Default range of speeds, as fractions of the scenario's.
const RANGE: [f64; 2] = [0.1, 1.25];
/// Default largest depth, as a multiple of the limit at the scenario's speed, and of its depth.
const BEYOND_LIMIT: f64 = 1.2;
const BEYOND_DEPTH: f64 = 3.0;

impl MillingStudy {
    /// What is asked of a diagram of `size` speeds and depths. Without a range of speeds (slowest
    /// and fastest, rad/s), a tenth of the scenario's to one and a quarter of it; without a deepest
    /// cut (m), three times the scenario's, or a fifth more than its limit to zero order where
    /// `modes` are known.
    #[must_use]
    pub fn request(
        &self,
        spindle_rad_s: Option<[f64; 2]>,
        deepest_m: Option<f64>,
        size: usize,
        modes: &[TipMode],
    ) -> LobeRequest {
        let cut = &self.cut;
        let speed = cut.spindle_rad_s;
        let deepest = || {
            // Where limits are not known, that of the fastest speed at which they are.
            let known = self.known_to_rad_s(modes);
            let at = known.map_or(speed, |known| known.min(speed));
            let period_s = cut.nominal.cutter.tooth_period_s(at);
            let average = cut.directional().averaged(period_s);
            let limit = zero_order_limit(modes, average, period_s);
            let beyond = limit.map_or(0.0, |limit| BEYOND_LIMIT * limit.depth_m);
            beyond.max(BEYOND_DEPTH * cut.nominal.axial_depth_m)
        };
        LobeRequest {
            spindle_rad_s: spindle_rad_s.unwrap_or_else(|| RANGE.map(|part| part * speed)),
            deepest_m: deepest_m.unwrap_or_else(deepest),
            speeds: size,
            depths: size,
        }
    }
}
