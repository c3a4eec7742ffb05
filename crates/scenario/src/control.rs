//! The `control` tables of `[process.polish]`, `[process.surface_polish]` and `[process.belt]`:
//! what holds the normal force.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::force_control::ForceControl;

use crate::check::Check;
use crate::units::{from_mm, from_n_per_mm};

/// Laws by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum LawName {
    /// The wheel keeps its place on the tool.
    Position,
    /// A carrier holds the force.
    ConstantForce,
    /// A carrier on a spring and a damper.
    Compliant,
}

/// What holds the normal force.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ControlTable {
    /// What holds the normal force.
    law: LawName,
    /// How far the undeformed wheel would reach into the face (law "position" of process.polish; a
    /// belt's job and the path of process.surface_polish say it).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    indentation_mm: Option<f64>,
    /// Normal force that is held (law "constant_force"), or preload (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    force_n: Option<f64>,
    /// Missing force per speed of the carrier (law "constant_force"), or damping of the carrier
    /// (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a carrier that nothing holds back would have no speed, or never come to rest"))]
    damping_n_s_per_mm: Option<f64>,
    /// Largest speed of the carrier (law "constant_force").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the carrier moves"))]
    fastest_mm_per_s: Option<f64>,
    /// Mass that moves with the wheel (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "masses are positive"))]
    mass_kg: Option<f64>,
    /// Stiffness of the carrier's spring (law "compliant").
    #[schemars(extend("minimum" = 0.0, "x-rule" = "0 is a preload alone"))]
    stiffness_n_per_mm: Option<f64>,
    /// Stroke of the carrier to either side (law "compliant"; law "constant_force" of process.belt
    /// and process.surface_polish, whose wheel leaves the face between lines; of process.polish
    /// default: none).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the carrier moves"))]
    stroke_mm: Option<f64>,
}

/// What presses a wheel on where nothing but the path does.
pub(crate) enum Pressed {
    /// The table says how far; less than the wheel's radius.
    ByTable {
        /// Of the wheel.
        radius_m: f64,
    },
    /// The path does, and leaves the face between its lines.
    ByPath {
        /// How far the path reaches into the face.
        indentation_m: f64,
        /// How far it is lifted between lines.
        lift_m: f64,
        /// What says how far it reaches in.
        says: &'static str,
    },
}

impl ControlTable {
    /// The law, and with [`Pressed::ByTable`] how far the path reaches into the face where the
    /// table says it, m. `None` after recording a fault. `table` is the table's path.
    pub(crate) fn resolve(
        self,
        table: &str,
        pressed: &Pressed,
        check: &mut Check,
    ) -> Option<(ForceControl, Option<f64>)> {
        let (who, idle, because) = self.law.idle_keys();
        check.ignored(table, idle, because);
        if self.law == LawName::Position {
            let indentation_m = match *pressed {
                Pressed::ByTable { radius_m } => {
                    let given = check.needed(table, "indentation_mm", self.indentation_mm, who)?;
                    Some(indentation(table, given, radius_m, check)?)
                }
                Pressed::ByPath { says, .. } => {
                    let because = format!("{says} says how far the wheel is led in");
                    check.ignored(table, &["indentation_mm"], &because);
                    None
                }
            };
            return Some((ForceControl::Position, indentation_m));
        }
        let mut needed = |key, value| check.needed(table, key, value, who);
        let force = needed("force_n", self.force_n);
        let control = if self.law == LawName::Compliant {
            let mass = needed("mass_kg", self.mass_kg);
            let stiffness = needed("stiffness_n_per_mm", self.stiffness_n_per_mm);
            let damping = needed("damping_n_s_per_mm", self.damping_n_s_per_mm);
            let stroke = needed("stroke_mm", self.stroke_mm);
            ForceControl::Compliant {
                preload_n: force?,
                mass_kg: mass?,
                stiffness_n_per_m: from_n_per_mm(stiffness?),
                damping_n_s_per_m: from_n_per_mm(damping?),
                stroke_m: from_mm(stroke?),
                stiction_n: 0.0,
            }
        } else {
            let damping = needed("damping_n_s_per_mm", self.damping_n_s_per_mm);
            let fastest = needed("fastest_mm_per_s", self.fastest_mm_per_s);
            let stroke = match pressed {
                Pressed::ByTable { .. } => Some(self.stroke_mm.unwrap_or(f64::INFINITY)),
                Pressed::ByPath { .. } => needed("stroke_mm", self.stroke_mm),
            };
            ForceControl::ConstantForce {
                force_n: force?,
                damping_n_s_per_m: from_n_per_mm(damping?),
                fastest_m_per_s: from_mm(fastest?),
                stroke_m: from_mm(stroke?),
                stiction_n: 0.0,
            }
        };
        leaves_the_face(&control, table, pressed, check).then_some((control, None))
    }
}

impl LawName {
    /// As the file writes it; keys that it has no use for, and why.
    fn idle_keys(self) -> (&'static str, &'static [&'static str], &'static str) {
        match self {
            Self::Position => (
                "law = \"position\"",
                &[
                    "force_n",
                    "damping_n_s_per_mm",
                    "fastest_mm_per_s",
                    "mass_kg",
                    "stiffness_n_per_mm",
                    "stroke_mm",
                ],
                "law = \"position\" has no carrier",
            ),
            Self::ConstantForce => (
                "law = \"constant_force\"",
                &["indentation_mm", "mass_kg", "stiffness_n_per_mm"],
                "law = \"constant_force\" holds a force without mass",
            ),
            Self::Compliant => (
                "law = \"compliant\"",
                &["indentation_mm", "fastest_mm_per_s"],
                "law = \"compliant\" presses by its preload",
            ),
        }
    }
}

fn indentation(table: &str, indentation_mm: f64, radius_m: f64, check: &mut Check) -> Option<f64> {
    let indentation_m = from_mm(indentation_mm);
    if indentation_m >= radius_m {
        let message = format!(
            "is {indentation_mm}, but must be less than the wheel's radius of {} mm",
            radius_m * 1e3
        );
        check.wrong(table, "indentation_mm", message, "deeper than the wheel");
        return None;
    }
    Some(indentation_m)
}

/// Whether a carrier that stands out between lines is clear of the face there; a fault is recorded
/// if not.
fn leaves_the_face(
    control: &ForceControl,
    table: &str,
    pressed: &Pressed,
    check: &mut Check,
) -> bool {
    let Pressed::ByPath {
        indentation_m,
        lift_m,
        ..
    } = *pressed
    else {
        return true;
    };
    let clear_m = lift_m - indentation_m;
    let Some(stroke_m) = control.stroke_m().filter(|stroke_m| *stroke_m >= clear_m) else {
        return true;
    };
    let message = format!(
        "is {}, but must be less than {}: between lines the path lifts the wheel by {} mm, which reaches in by {} mm on them, and \
         there the carrier stands out",
        in_mm(stroke_m),
        in_mm(clear_m),
        in_mm(lift_m),
        in_mm(indentation_m)
    );
    check.wrong(table, "stroke_mm", message, "would stay on the face");
    false
}

/// As it was written, to the nanometre.
fn in_mm(length_m: f64) -> f64 {
    (length_m * 1e9).round() / 1e6
}
