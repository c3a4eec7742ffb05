//! Up to which speed the modes that a scenario has can say where a cut becomes unstable.

use std::f64::consts::TAU;

use truecut_core::chatter::{AttachedModes, TipMode};

use super::MillingStudy;

/// Regeneration has its fastest lobe where teeth pass at twice a mode's frequency, by doubling of
/// the period; above that for the fastest mode, all that is left of the modes is their mass.
pub(super) const FASTEST_LOBE: f64 = 2.0;

/// The same of any modes.
pub(crate) fn beyond_table(modes: &AttachedModes, fastest_rad_s: f64) -> Option<String> {
    let known_rad_s = modes
        .known_to_rad_s()
        .filter(|known| *known < fastest_rad_s)?;
    Some(format!(
        "a mode of the cutter is given up to {:.0} rpm (over_speed): above that speed its last row holds",
        known_rad_s * 60.0 / TAU
    ))
}

impl MillingStudy {
    /// Fastest spindle speed, rad/s, up to which `modes` have lobes of their own, where the
    /// scenario gives no modes of tool, holder and spindle. Above it these limit the cut, and
    /// limits with the arm alone would be far too deep. `None` where they are given, or teeth do
    /// not meet their own surface.
    pub fn known_to_rad_s(&self, modes: &[TipMode]) -> Option<f64> {
        if !self.cut.attached.tool.is_empty() || !self.regeneration() {
            return None;
        }
        let rates = modes.iter().map(|mode| mode.natural_frequency_rad_s);
        let fastest = rates.fold(0.0, f64::max);
        Some(FASTEST_LOBE * fastest / self.cut.nominal.cutter.teeth as f64)
    }

    /// What is to be said where speeds up to `fastest_rad_s` are asked for, and a tool mode is
    /// given up to a slower one.
    pub fn beyond_table(&self, fastest_rad_s: f64) -> Option<String> {
        beyond_table(&self.cut.attached, fastest_rad_s)
    }

    /// What is to be said of a speed beyond [`Self::known_to_rad_s`].
    pub fn beyond_modes(&self, modes: &[TipMode], known_to_rad_s: f64) -> String {
        let rates = modes.iter().map(|mode| mode.natural_frequency_rad_s);
        let fastest_hz = rates.fold(0.0, f64::max) / TAU;
        format!(
            "above {:.0} rpm teeth pass at more than twice the frequency of the fastest mode, {fastest_hz:.1} Hz: tool, holder and \
             spindle limit the cut there, and the scenario gives no modes of theirs ([[process.milling.cutter.mode]])",
            known_to_rad_s * 60.0 / TAU
        )
    }
}
