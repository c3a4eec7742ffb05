//! The `control` tables of `[process.polish]` and `[process.belt]`: what holds the normal force.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::document::Fault;
use crate::units::{from_mm, from_n_per_mm};

/// What holds the normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ControlSpec {
    /// The wheel keeps its place on the tool; the path reaches into the face.
    Position {
        /// How far the undeformed wheel would reach into the face.
        penetration_m: f64,
    },
    /// A carrier moves the wheel along the normal, without mass, at a speed in proportion to what is missing of the force.
    ConstantForce {
        /// Force that is held.
        force_n: f64,
        /// Missing force per speed of the carrier.
        damping_n_s_per_m: f64,
        /// Largest speed of the carrier.
        fastest_m_per_s: f64,
        /// Stroke to either side; infinite where none is given.
        stroke_m: f64,
    },
    /// A carrier on a spring, a damper and a preload.
    Compliant {
        /// Preload: the force where the carrier stands in its middle.
        force_n: f64,
        /// Mass that moves with the wheel.
        mass_kg: f64,
        /// Stiffness of the spring.
        stiffness_n_per_m: f64,
        /// Damping of the damper.
        damping_n_s_per_m: f64,
        /// Stroke to either side.
        stroke_m: f64,
    },
}

impl ControlSpec {
    /// Stroke of the carrier to either side; none without one.
    pub fn stroke_m(&self) -> Option<f64> {
        match *self {
            Self::Position { .. } => None,
            Self::ConstantForce { stroke_m, .. } | Self::Compliant { stroke_m, .. } => {
                Some(stroke_m)
            }
        }
    }

    /// The force that is held, or the preload; none where the path alone presses.
    pub fn force_n(&self) -> Option<f64> {
        match *self {
            Self::Position { .. } => None,
            Self::ConstantForce { force_n, .. } | Self::Compliant { force_n, .. } => Some(force_n),
        }
    }
}

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
    /// How far the undeformed wheel would reach into the face (law "position" of process.polish; a belt's job says it).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    penetration_mm: Option<f64>,
    /// Normal force that is held (law "constant_force"), or preload (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    force_n: Option<f64>,
    /// Missing force per speed of the carrier (law "constant_force"), or damping of the carrier (law "compliant").
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
    /// Stroke of the carrier to either side (law "compliant"; law "constant_force" of process.belt, whose wheel leaves the face between
    /// lines; of process.polish default: none).
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
    },
}

impl ControlTable {
    /// `None` after recording a fault. `table` is the table's path.
    pub(crate) fn resolve(
        self,
        table: &str,
        pressed: &Pressed,
        check: &mut Check,
    ) -> Option<ControlSpec> {
        let control = match self.law {
            LawName::Position => self.position(table, pressed, check),
            LawName::ConstantForce => self.constant_force(table, pressed, check),
            LawName::Compliant => self.compliant(table, check),
        }?;
        leaves_the_face(&control, table, pressed, check).then_some(control)
    }

    fn position(self, table: &str, pressed: &Pressed, check: &mut Check) -> Option<ControlSpec> {
        let because = "law = \"position\" has no carrier";
        let others = ["force_n", "damping_n_s_per_mm", "fastest_mm_per_s"];
        check.ignored(table, &others, because);
        let others = ["mass_kg", "stiffness_n_per_mm", "stroke_mm"];
        check.ignored(table, &others, because);
        let penetration_m = match *pressed {
            Pressed::ByTable { radius_m } => {
                let who = "law = \"position\"";
                let given = check.needed(table, "penetration_mm", self.penetration_mm, who);
                penetration(table, given?, radius_m, check)?
            }
            Pressed::ByPath { indentation_m, .. } => {
                let because =
                    "the path job's wheel.indentation_mm says how far the wheel is led in";
                check.ignored(table, &["penetration_mm"], because);
                indentation_m
            }
        };
        Some(ControlSpec::Position { penetration_m })
    }

    fn constant_force(
        self,
        table: &str,
        pressed: &Pressed,
        check: &mut Check,
    ) -> Option<ControlSpec> {
        let others = ["penetration_mm", "mass_kg", "stiffness_n_per_mm"];
        let because = "law = \"constant_force\" holds a force without mass";
        check.ignored(table, &others, because);
        let who = "law = \"constant_force\"";
        let force = check.needed(table, "force_n", self.force_n, who);
        let damping = check.needed(table, "damping_n_s_per_mm", self.damping_n_s_per_mm, who);
        let fastest = check.needed(table, "fastest_mm_per_s", self.fastest_mm_per_s, who);
        let stroke = match pressed {
            Pressed::ByTable { .. } => Some(self.stroke_mm.unwrap_or(f64::INFINITY)),
            Pressed::ByPath { .. } => check.needed(table, "stroke_mm", self.stroke_mm, who),
        };
        Some(ControlSpec::ConstantForce {
            force_n: force?,
            damping_n_s_per_m: from_n_per_mm(damping?),
            fastest_m_per_s: from_mm(fastest?),
            stroke_m: from_mm(stroke?),
        })
    }

    fn compliant(self, table: &str, check: &mut Check) -> Option<ControlSpec> {
        let others = ["penetration_mm", "fastest_mm_per_s"];
        check.ignored(table, &others, "law = \"compliant\" presses by its preload");
        let who = "law = \"compliant\"";
        let force = check.needed(table, "force_n", self.force_n, who);
        let mass = check.needed(table, "mass_kg", self.mass_kg, who);
        let stiffness = check.needed(table, "stiffness_n_per_mm", self.stiffness_n_per_mm, who);
        let damping = check.needed(table, "damping_n_s_per_mm", self.damping_n_s_per_mm, who);
        let stroke = check.needed(table, "stroke_mm", self.stroke_mm, who);
        Some(ControlSpec::Compliant {
            force_n: force?,
            mass_kg: mass?,
            stiffness_n_per_m: from_n_per_mm(stiffness?),
            damping_n_s_per_m: from_n_per_mm(damping?),
            stroke_m: from_mm(stroke?),
        })
    }
}

fn penetration(table: &str, penetration_mm: f64, radius_m: f64, check: &mut Check) -> Option<f64> {
    let penetration_m = from_mm(penetration_mm);
    if penetration_m >= radius_m {
        let path = format!("{table}.penetration_mm");
        let message = format!(
            "`{path}` is {penetration_mm}, but must be less than the wheel's radius of {} mm",
            radius_m * 1e3
        );
        check.refuse(Fault::value(&path, message, "deeper than the wheel"));
        return None;
    }
    Some(penetration_m)
}

/// Whether a carrier that stands out between lines is clear of the face there; a fault is recorded if not.
fn leaves_the_face(
    control: &ControlSpec,
    table: &str,
    pressed: &Pressed,
    check: &mut Check,
) -> bool {
    let Pressed::ByPath {
        indentation_m,
        lift_m,
    } = *pressed
    else {
        return true;
    };
    let clear_m = lift_m - indentation_m;
    let Some(stroke_m) = control.stroke_m().filter(|stroke_m| *stroke_m >= clear_m) else {
        return true;
    };
    let path = format!("{table}.stroke_mm");
    let message = format!(
        "`{path}` is {}, but must be less than {}: between lines the path job lifts the wheel by {} mm, which reaches in by {} mm on them, and \
         there the carrier stands out",
        in_mm(stroke_m),
        in_mm(clear_m),
        in_mm(lift_m),
        in_mm(indentation_m)
    );
    check.refuse(Fault::value(&path, message, "would stay on the face"));
    false
}

/// As it was written, to the nanometre.
fn in_mm(length_m: f64) -> f64 {
    (length_m * 1e9).round() / 1e6
}
