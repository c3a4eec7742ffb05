//! The `[process.surface_polish]` table: a soft wheel in precession polishes a freeform face, of a
//! mesh or from a file, along lines that are laid on it.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::abrasive::Abrasive;
use truecut_core::wheel::force_control::ForceControl;
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_plan::polish_path::PolishLaying;
use truecut_plan::surface_path::SurfaceSetup;

use super::polish::PneumaticTable;
use crate::check::Check;
use crate::control::{ControlTable, Pressed};
use crate::path_job::SurfaceTable;
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room, WheelPart, hold};
use crate::roughness::RoughnessTable;
use crate::units::{from_deg, from_mm, from_rpm};

/// Polishing of a freeform face. The wheel's centre is the tool frame's origin, its spin axis the
/// frame's z, which points towards the face.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePolishSpec {
    /// The wheel.
    pub wheel: PneumaticWheel,
    /// Spin about the axis that points away from the face; negative: about its opposite.
    pub spin_rad_s: f64,
    /// What the wheel does to the face.
    pub abrasive: Abrasive,
    /// The face.
    pub surface: SurfaceSetup,
    /// Size of the cells on which removal is kept, as asked for.
    pub cell_m: f64,
    /// How the wheel is led over it.
    pub laying: PolishLaying,
    /// Speed from line to line.
    pub rapid_m_per_s: f64,
    /// Largest speed of a joint, share of its top speed.
    pub joint_share: f64,
    /// What holds the normal force.
    pub control: ForceControl,
}

/// Polishing of a freeform face with a soft wheel in precession.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SurfacePolishTable {
    /// Speed of the wheel about the axis that points away from the face; negative: about its
    /// opposite.
    spin_rpm: f64,
    /// Angle between spin axis and normal of the face.
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "maximum" = 60.0,
        "x-rule" = "an upright wheel does not slide in the middle of its patch, one that lies touches with its carrier"
    ))]
    tilt_deg: f64,
    /// Coefficient of friction between wheel and face.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes sliding"))]
    mu: f64,
    /// Preston coefficient.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "polishing removes material"))]
    preston_per_pa: f64,
    /// Largest size of the cells on which removal is kept. Default: 0.5.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cell has a size"))]
    cell_mm: Option<f64>,
    /// The wheel: an inflated rubber shell.
    wheel: PneumaticTable,
    /// The face that is polished.
    surface: SurfaceTable,
    /// The lines on it.
    path: LineTable,
    /// How the spin axis turns about the normal.
    precession: TurnTable,
    /// What holds the normal force: nothing but the path, or a carrier between tool and wheel that
    /// moves along the normal. Default: law = "position".
    control: Option<ControlTable>,
    /// How the surface smooths.
    roughness: RoughnessTable,
}

/// Lines along the face's first parameter, to and fro.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LineTable {
    /// How far the undeformed wheel reaches into the face along the path.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    indentation_mm: f64,
    /// Largest distance between lines: as many are laid as share the width evenly.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "lines lie apart"))]
    line_spacing_mm: f64,
    /// Distance of the middle of the contact from borders and holes. Default: the radius of the
    /// contact, so that it ends at the border.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the contact stays on the face"))]
    inset_mm: Option<f64>,
    /// Speed of the contact along the face.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is fed along the path"))]
    feed_mm_per_s: f64,
    /// Largest distance of points along a line. Default: 2.
    #[schemars(extend("minimum" = 0.02, "x-rule" = "programs print thousandths of a millimetre, by which nearer points would lose the line's direction"))]
    step_mm: Option<f64>,
    /// How far the wheel is lifted before and after each line. Default: its radius.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel leaves the face between lines"))]
    lift_mm: Option<f64>,
    /// Speed from line to line, the wheel lifted, on a straight way. Default: 100.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel gets on to the next line"))]
    rapid_mm_per_s: Option<f64>,
    /// Top speed of joints, a fraction of their limits: lines are slower than their feed where a
    /// joint would be faster. Default: 0.25.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0, "x-rule" = "a fraction of the top speed"))]
    joint_speed: Option<f64>,
}

/// How the spin axis turns about the normal.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TurnTable {
    /// Rate of the turn while the wheel is fed, from the face's first parameter towards its second;
    /// negative: the other way; 0: the axis keeps its side.
    turn_rpm: f64,
    /// Angle towards which the spin axis leans at the start, from the face's first parameter
    /// towards its second. Default: 0.
    start_deg: Option<f64>,
}

const TABLE: &str = "process.surface_polish";
const PATH: &str = "process.surface_polish.path";

/// Where a scenario does not say.
const DEFAULT_CELL_MM: f64 = 0.5;
const DEFAULT_STEP_MM: f64 = 2.0;
const DEFAULT_RAPID_MM_PER_S: f64 = 100.0;
const DEFAULT_JOINT_SHARE: f64 = 0.25;
/// Largest part of the wheel's radius that it may be pressed in by.
const DEEPEST: f64 = 0.5;

impl SurfacePolishTable {
    /// `None` after recording a fault. `folder` is that of the scenario file.
    fn resolve(self, folder: &Path, check: &mut Check) -> Option<SurfacePolishSpec> {
        if self.spin_rpm == 0.0 {
            let message = "is 0, but must not be: a wheel that stands still only rubs by its feed";
            check.wrong(TABLE, "spin_rpm", message, "does not spin");
        }
        let wheel = self.wheel.resolve(&format!("{TABLE}.wheel"), check);
        check.rim(TABLE, "spin_rpm", self.spin_rpm, wheel.radius_m);
        let surface = (self.surface).resolve(&format!("{TABLE}.surface"), folder, check);
        let polishing = self.roughness.resolve(TABLE, check);
        let (indentation_m, radius_m) = (from_mm(self.path.indentation_mm), wheel.radius_m);
        let lift_m = self.path.lift_mm.map_or(radius_m, from_mm);
        let control = match self.control {
            None => Some(ForceControl::Position),
            Some(table) => {
                let pressed = Pressed::ByPath {
                    indentation_m,
                    lift_m,
                    says: "process.surface_polish.path.indentation_mm",
                };
                let control = table.resolve(&format!("{TABLE}.control"), &pressed, check);
                control.map(|(control, _)| control)
            }
        };
        let held_m = control.as_ref().and_then(ForceControl::force_n);
        let held_m = held_m.map_or(0.0, |force_n| wheel.indentation_m(force_n));
        shallow(&self.path, [indentation_m, held_m], radius_m, check).then_some(())?;
        let deepest_m = indentation_m.max(held_m);
        let contact_m = wheel.patch(&wheel.shell(), deepest_m).contact_m();
        let inset_m = self.path.inset_m(contact_m, check);
        Some(SurfacePolishSpec {
            wheel,
            spin_rad_s: from_rpm(self.spin_rpm),
            abrasive: Abrasive {
                mu: self.mu,
                preston_per_pa: self.preston_per_pa,
                polishing,
            },
            surface: surface?,
            cell_m: from_mm(self.cell_mm.unwrap_or(DEFAULT_CELL_MM)),
            laying: PolishLaying {
                radius_m,
                indentation_m,
                tilt_rad: from_deg(self.tilt_deg),
                turn_rad_s: from_rpm(self.precession.turn_rpm),
                start_rad: from_deg(self.precession.start_deg.unwrap_or(0.0)),
                spacing_m: from_mm(self.path.line_spacing_mm),
                contact_m,
                inset_m: inset_m?,
                step_m: from_mm(self.path.step_mm.unwrap_or(DEFAULT_STEP_MM)),
                lift_m,
                feed_m_per_s: from_mm(self.path.feed_mm_per_s),
            },
            rapid_m_per_s: from_mm(self.path.rapid_mm_per_s.unwrap_or(DEFAULT_RAPID_MM_PER_S)),
            joint_share: self.path.joint_speed.unwrap_or(DEFAULT_JOINT_SHARE),
            control: control?,
        })
    }
}

/// Whether path and force press in by less than the contact law allows; a fault is recorded if not.
fn shallow(path: &LineTable, pressed_m: [f64; 2], radius_m: f64, check: &mut Check) -> bool {
    let most_mm = DEEPEST * radius_m * 1e3;
    let because = "the contact law holds for patches that are small beside the wheel";
    if pressed_m[0] >= DEEPEST * radius_m {
        let message = format!(
            "is {}, but must be less than half the wheel's radius, {most_mm} mm: {because}",
            path.indentation_mm
        );
        check.wrong(PATH, "indentation_mm", message, "too deep");
        return false;
    }
    if pressed_m[1] >= DEEPEST * radius_m {
        let message = format!(
            "presses the wheel in by {:.2} mm, but it must be less than half its radius, {most_mm} mm: {because}",
            pressed_m[1] * 1e3
        );
        check.wrong(&format!("{TABLE}.control"), "force_n", message, "too much");
        return false;
    }
    true
}

impl LineTable {
    /// At least the radius of the contact. `None` after recording a fault.
    fn inset_m(&self, contact_m: f64, check: &mut Check) -> Option<f64> {
        let Some(inset_mm) = self.inset_mm else {
            return Some(contact_m);
        };
        if from_mm(inset_mm) >= contact_m {
            return Some(from_mm(inset_mm));
        }
        let message = format!(
            "is {inset_mm}, but must be at least {:.4}, the radius of the contact: what a wheel does that runs over the border of a freeform \
             face is not modelled",
            (contact_m * 1e7).ceil() * 1e-4
        );
        check.wrong(PATH, "inset_mm", message, "over the border");
        None
    }
}

/// How far a polishing wheel is typically pressed in, as a part of its radius.
const TYPICAL_INDENTATION: f64 = 0.03;

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.surface_polish.spin_rpm", "spin", &[0.5, 2.0]),
    Knob::new(
        "process.surface_polish.path.feed_mm_per_s",
        "feed",
        &[0.5, 2.0],
    ),
    Knob::new(
        "process.surface_polish.control.force_n",
        "force",
        &[0.5, 2.0],
    ),
];

impl Room for SurfacePolishSpec {
    type Table = SurfacePolishTable;

    fn resolve(table: SurfacePolishTable, folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(folder, check)
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: Some(self.spin_rad_s.abs()).filter(|rate| *rate > 0.0),
            natural_duration_s: Some(f64::INFINITY),
            signals: &[
                "surface_polish.normal_force",
                "surface_polish.indentation",
                "surface_polish.position_u",
                "surface_polish.position_v",
                "tool.displacement_x",
            ],
            knobs: KNOBS,
            files: &["surface.patch", "surface.mesh.file", "surface.body"],
            needs_drive: Some("surface_polish"),
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: PostureFrom::Path,
            parts: Parts {
                wheel: Some(WheelPart {
                    hold: hold(&self.control),
                    shows_removal: true,
                    turns: true,
                    over_edges: false,
                    indentation_m: TYPICAL_INDENTATION * self.wheel.radius_m,
                }),
                ..Parts::NONE
            },
        }
    }
}
