//! `[[process.milling.cutter.mode]]` and `[[process.milling.workpiece.mode]]`.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::chatter::AttachedMode;

use crate::check::Check;
use crate::units::from_n_per_um;

/// A mode: a mass on a spring and a damper.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ModeTable {
    /// Natural frequency with the foot of the spring held.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a mode vibrates"))]
    frequency_hz: f64,
    /// Damping ratio.
    #[schemars(extend(
        "minimum" = 0.0,
        "exclusiveMaximum" = 1.0,
        "x-rule" = "a mode vibrates, and negative damping would create energy"
    ))]
    damping_ratio: f64,
    /// Stiffness that a force at the tool tip meets along the direction.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a mode has a spring"))]
    stiffness_n_per_um: f64,
    /// Direction in which the mode moves, of any length: in the tool frame (it does not turn with
    /// the spindle) for a mode of the cutter, in the world for one of the workpiece.
    direction: [f64; 3],
}

/// The workpiece.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MilledWorkpieceTable {
    /// Modes of the workpiece where it is cut.
    #[schemars(extend("maxItems" = 6, "x-rule" = "a workpiece has at most 6 modes here"))]
    mode: Vec<ModeTable>,
}

impl MilledWorkpieceTable {
    pub(super) fn resolve(self, check: &mut Check) -> Vec<AttachedMode> {
        resolve(self.mode, "process.milling.workpiece.mode", check)
    }
}

/// The modes of a list without those that are refused.
pub(super) fn resolve(modes: Vec<ModeTable>, table: &str, check: &mut Check) -> Vec<AttachedMode> {
    let modes = modes.into_iter().enumerate();
    let resolved = modes.filter_map(|(index, mode)| {
        let key = format!("{table}.{index}.direction");
        Some(AttachedMode::new(
            mode.frequency_hz,
            mode.damping_ratio,
            from_n_per_um(mode.stiffness_n_per_um),
            check.direction(&key, mode.direction)?,
        ))
    });
    resolved.collect()
}
