//! `[[tool.mode]]` and `[[workpiece.mode]]`; of milling `[[process.milling.cutter.mode]]` and
//! `[[process.milling.workpiece.mode]]`.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::chatter::{AttachedMode, AttachedModes, SpeedTable};

use crate::check::Check;
use crate::fault::Fault;
use crate::process::{Facts, ModesIn};
use crate::units::{from_n_per_um, from_rpm};

/// A mode: a mass on a spring and a damper.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModeTable {
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
    /// the spindle) for a mode of the tool, in the world for one of the workpiece.
    direction: [f64; 3],
    /// Of a mode of the tool: what it becomes as the spindle turns, by rising speeds; linear
    /// between them, from the mode's own values at standstill, and held beyond the last. Default:
    /// the same at all speeds.
    over_speed: Option<Vec<SpeedRow>>,
}

/// A mode at a spindle speed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SpeedRow {
    /// Spindle speed.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "at standstill it is the mode itself"))]
    spindle_rpm: f64,
    /// Natural frequency at that speed. Default: the mode's own.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a mode vibrates"))]
    frequency_hz: Option<f64>,
    /// Damping ratio at that speed. Default: the mode's own.
    #[schemars(extend(
        "minimum" = 0.0,
        "exclusiveMaximum" = 1.0,
        "x-rule" = "a mode vibrates, and negative damping would create energy"
    ))]
    damping_ratio: Option<f64>,
    /// Stiffness at that speed. Default: the mode's own.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a mode has a spring"))]
    stiffness_n_per_um: Option<f64>,
}

impl ModeTable {
    fn at_standstill(&self, direction: [f64; 3]) -> AttachedMode {
        AttachedMode::new(
            self.frequency_hz,
            self.damping_ratio,
            from_n_per_um(self.stiffness_n_per_um),
            direction,
        )
    }

    /// Of a mode that is the tool's `index`-th; `path` is its key.
    fn speed_table(
        &self,
        (index, path): (usize, &str),
        direction: [f64; 3],
        check: &mut Check,
    ) -> Option<SpeedTable> {
        let given = self.over_speed.as_ref().filter(|rows| !rows.is_empty())?;
        let mut rows = vec![(0.0, self.at_standstill(direction))];
        for (i, row) in given.iter().enumerate() {
            let before_rpm = i
                .checked_sub(1)
                .map_or(0.0, |before| given[before].spindle_rpm);
            if row.spindle_rpm <= before_rpm {
                let is = format!(
                    "is {}, but must be above {before_rpm}, the row before: speeds rise",
                    row.spindle_rpm
                );
                let table = format!("{path}.over_speed.{i}");
                check.wrong(&table, "spindle_rpm", is, "does not rise");
            }
            let stiffness = row.stiffness_n_per_um.unwrap_or(self.stiffness_n_per_um);
            let mode = AttachedMode::new(
                row.frequency_hz.unwrap_or(self.frequency_hz),
                row.damping_ratio.unwrap_or(self.damping_ratio),
                from_n_per_um(stiffness),
                direction,
            );
            rows.push((from_rpm(row.spindle_rpm), mode));
        }
        Some(SpeedTable { tool: index, rows })
    }
}

/// Tool, holder and spindle.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ToolTable {
    /// Modes at the tool point, the flange held.
    #[schemars(extend("maxItems" = 6, "x-rule" = "a tool has at most 6 modes here"))]
    mode: Vec<ModeTable>,
}

/// The workpiece.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WorkpieceTable {
    /// Modes of the workpiece where it is cut.
    #[schemars(extend("maxItems" = 6, "x-rule" = "a workpiece has at most 6 modes here"))]
    mode: Vec<ModeTable>,
}

impl WorkpieceTable {
    pub(crate) fn resolve(self, table: &str, check: &mut Check) -> Vec<AttachedMode> {
        for index in 0..self.mode.len() {
            let because = "a workpiece does not turn with the spindle";
            check.ignored(&format!("{table}.{index}"), &["over_speed"], because);
        }
        resolve(self.mode, table, check).0
    }
}

/// The modes of a list at standstill without those that are refused, and how they change with the
/// spindle's speed.
pub(crate) fn resolve(
    modes: Vec<ModeTable>,
    table: &str,
    check: &mut Check,
) -> (Vec<AttachedMode>, Vec<SpeedTable>) {
    let (mut resolved, mut over_speed) = (Vec::new(), Vec::new());
    for (index, mode) in modes.iter().enumerate() {
        let path = format!("{table}.{index}");
        let key = format!("{path}.direction");
        let Some(direction) = check.direction(&key, mode.direction) else {
            continue;
        };
        over_speed.extend(mode.speed_table((resolved.len(), &path), direction, check));
        resolved.push(mode.at_standstill(direction));
    }
    (resolved, over_speed)
}

/// The modes of `[[tool.mode]]` and `[[workpiece.mode]]` at the speed of what turns.
pub(crate) fn attached(
    tool: Option<ToolTable>,
    workpiece: Option<WorkpieceTable>,
    facts: &Facts,
    check: &mut Check,
) -> AttachedModes {
    let given = [
        ("tool.mode", tool.is_some()),
        ("workpiece.mode", workpiece.is_some()),
    ];
    for (key, _) in given.iter().filter(|(_, given)| *given) {
        if let ModesIn::Elsewhere(because) = facts.modes {
            let message = format!("`{key}` has no effect: {because}");
            check.refuse(Fault::key(key, message, "has no effect here"));
        }
    }
    let (tool, over_speed) = tool.map_or_else(Default::default, |tool| {
        resolve(tool.mode, "tool.mode", check)
    });
    let modes = AttachedModes {
        tool,
        workpiece: workpiece.map_or_else(Vec::new, |piece| piece.resolve("workpiece.mode", check)),
        over_speed,
    };
    modes.at(facts.rate_rad_s.unwrap_or(0.0))
}
