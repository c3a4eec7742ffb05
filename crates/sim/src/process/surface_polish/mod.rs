//! A soft wheel in precession polishes a freeform face.
//!
//! The tool frame stands in the wheel's centre, its z axis is the spin axis and points towards the
//! face. Every step takes pose and motion of the tool as they are, deflection and rotation of the
//! arm included, and looks for the point of the face that is nearest to the wheel's middle
//! ([`FaceGeometry::foot`]). There the wheel presses as it does on a plane, by the curvatures of
//! the face at that point ([`truecut_core::wheel::curved`]). The patch is taken to lie on the face
//! whole: the planner keeps it off borders and holes.
//!
//! Force and moment of pressure and friction act on the tool; the drive of the spindle holds its
//! speed, so that the moment about the spin axis reaches the arm. A force control has a carrier
//! between tool and wheel, which moves along the normal of the face.

mod contact;
mod report;
pub(crate) mod setup;
#[cfg(test)]
mod tests;

use super::belt::geometry::FaceGeometry;
use super::belt::report::field;
use super::belt::surface::{Cells, placement};
use super::pending_removal::PendingRemoval;
use super::pressing::Pressing;
use super::quantity::{self, Quantity};
use super::step_cache::StepCache;
use super::{ContactStiffness, Findings, Process, ToolState, slope_n_per_m};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use contact::{PolishTouch, Touching};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::sync::Arc;
use truecut_core::wheel::abrasive::Abrasive;
use truecut_core::wheel::force_control::{ForceControl, Offset};
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_core::wheel::quadrature::Quadrature;
use truecut_core::wheel::removal::SurfaceGrid;
use truecut_core::wheel::shell::Shell;
use truecut_plan::surface::PatchFile;
use truecut_recording::{ChannelSpec, Field, Unit};

/// Depth at which the colours end, over the mean that is expected.
const FULL_SCALE: f64 = 3.0;

/// All that such a run is made of.
#[derive(Debug, Clone)]
pub struct SurfacePolishSetup {
    pub wheel: PneumaticWheel,
    /// The wheel's shell.
    pub shell: Arc<Shell>,
    /// Spin about the axis that points away from the face, rad/s.
    pub spin_rad_s: f64,
    /// Place of the wheel's middle at the start, along the tool's x and y axes, m.
    pub eccentricity_m: [f64; 2],
    pub abrasive: Abrasive,
    pub control: ForceControl,
    pub patch: Arc<PatchFile>,
    pub world_from_patch: Isometry3<f64>,
    /// Turns world axes into process axes.
    pub process_from_world: UnitQuaternion<f64>,
    pub cells: Cells,
    /// True areas of the cells, row by row, m².
    pub area_m2: Arc<Vec<f64>>,
    /// Which cells belong to the face, and which of those lie so far within that lines pass on
    /// either side.
    pub is_face: Arc<Vec<bool>>,
    pub is_inner: Arc<Vec<bool>>,
    /// How far the path reaches into the face, m.
    pub indentation_m: f64,
    /// Outward normal of the face where the first line begins, world.
    pub first_normal: Vector3<f64>,
    /// Mean depth that lines leave far from borders on a plane, for the colours of the view, m.
    pub expected_depth_m: f64,
}

/// The process.
#[derive(Debug, Clone)]
pub struct SurfacePolish {
    setup: SurfacePolishSetup,
    face: FaceGeometry,
    quadrature: Quadrature,
    /// Offset of the carrier towards the face.
    carrier: Offset,
    grid: SurfaceGrid,
    pending: PendingRemoval<PolishTouch>,
    scratch: Vec<(usize, f64)>,
    pressing: Pressing,
    /// `∫ p |v| dA dt`, J.
    preston_j: f64,
    last: PolishStep,
    /// Where the last step's contact is looked for in the next, if the wheel touched.
    seed: Option<[f64; 2]>,
    /// Whether nobody asks for the findings.
    rows_only: bool,
    /// The contact state that the loads of this step were computed from.
    contact_state: StepCache<Touching>,
}

/// The last committed step.
#[derive(Debug, Clone, Default)]
struct PolishStep {
    touching: Touching,
    /// Place under the wheel's middle; far from the face that of the last one.
    uv: [f64; 2],
    carrier_m: f64,
    /// Process axes.
    force_on_tool_n: Vector3<f64>,
}

impl SurfacePolish {
    pub fn new(setup: SurfacePolishSetup) -> Self {
        Self {
            face: FaceGeometry::new(setup.patch.clone()),
            quadrature: Quadrature::default(),
            // It comes from the air.
            carrier: Offset::at(setup.control.lifted_m()),
            grid: SurfaceGrid::new(setup.cells.count[0], setup.area_m2.to_vec()),
            pending: PendingRemoval::default(),
            scratch: Vec::new(),
            pressing: Pressing::default(),
            preston_j: 0.0,
            last: PolishStep::default(),
            seed: None,
            rows_only: false,
            contact_state: StepCache::default(),
            setup,
        }
    }

    fn contact(&self, state: &ToolState) -> Touching {
        Touching::of(
            &self.setup,
            (&self.face, &self.quadrature),
            self.seed,
            state,
            &self.carrier,
        )
    }

    fn to_process(&self, in_patch: &Vector3<f64>) -> Vector3<f64> {
        self.setup.process_from_world * (self.setup.world_from_patch.rotation * in_patch)
    }

    /// Spreads the pending removal.
    fn settle(&mut self) {
        let Some(dose) = self.pending.take() else {
            return;
        };
        let touch = dose.contact;
        let placement = placement(&self.setup.cells, &touch.first_m, touch.axes, dose.at_cells);
        let (patch, sliding) = (touch.patch, touch.sliding);
        self.grid.spread(
            &placement,
            patch.window_m(),
            dose.energy_j,
            self.setup.abrasive.preston_per_pa,
            &mut self.scratch,
            |x, y| patch.moving_pressure_pa(x, y, &sliding) * sliding.at_m_per_s(x, y).norm(),
        );
    }

    /// What is recorded of the step last committed.
    fn quantities(&self) -> [Quantity; 9] {
        let (last, touching) = (&self.last, &self.last.touching);
        let [u, v] = last.uv;
        let removed_m3 = self.setup.abrasive.preston_per_pa * self.preston_j;
        [
            Quantity::new("surface_polish.normal_force", Unit::Newton, touching.normal_n)
                .text("Force with which the wheel presses on the face, along its normal"),
            Quantity::new("surface_polish.friction_u", Unit::Newton, touching.friction_n.x)
                .text("Friction on the face along its first parameter"),
            Quantity::new("surface_polish.friction_v", Unit::Newton, touching.friction_n.y)
                .text("Friction on the face across its first parameter"),
            Quantity::new("surface_polish.indentation", Unit::Metre, touching.indentation_m.max(0.0))
                .text("How far the undeformed wheel reaches into the face; 0 when lifted"),
            Quantity::new("surface_polish.carrier_offset", Unit::Metre, last.carrier_m)
                .text("How far the carrier of a force control stands out towards the face; 0 without one"),
            Quantity::new("surface_polish.position_u", Unit::One, u)
                .text("First parameter of the face under the wheel's middle; far from the face that of the last place"),
            Quantity::new("surface_polish.position_v", Unit::One, v)
                .text("Second parameter of the face under the wheel's middle"),
            Quantity::new("surface_polish.precession_angle", Unit::Radian, touching.lean_rad)
                .text("Where the spin axis leans, from the face's first parameter towards its second, -180 to 180 degrees"),
            Quantity::new("surface_polish.removed_volume", Unit::CubicMetre, removed_m3)
                .text("Volume removed so far"),
        ]
    }

    /// Slope of the force over the indentation on a flat face, at the indentation of the path, N/m.
    fn stiffness_n_per_m(&self) -> f64 {
        let wheel = &self.setup.wheel;
        slope_n_per_m(self.setup.indentation_m, |d| {
            wheel.patch(&self.setup.shell, d).free_force_n()
        })
    }
}

impl Process for SurfacePolish {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let touching = self.contact(state);
        let wrench = Wrench {
            frame: Attachment::Tool,
            force_n: self.to_process(&touching.force_n),
            moment_n_m: self.to_process(&touching.moment_n_m),
        };
        self.contact_state.set(state.time_s, touching);
        Loads::from(wrench)
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, _: &ContactOutcomes, dt_s: f64) {
        // Removal and channels use the contact state of the loads, with its predicted velocity.
        let cached = self.contact_state.take(state.time_s);
        let touching = cached.unwrap_or_else(|| self.contact(state));
        self.preston_j += touching.sliding_w * dt_s;
        match touching.touch.filter(|_| !self.rows_only) {
            Some(touch) => {
                let at_cells = self.setup.cells.place(touch.uv);
                let energy_j = touching.sliding_w * dt_s;
                if self.pending.add(energy_j, at_cells, touch) {
                    self.settle();
                }
            }
            None => self.settle(),
        }
        let control = self.setup.control;
        self.pressing
            .step(touching.normal_n, control.is_at_stop(&self.carrier), dt_s);
        let uv = touching.uv.unwrap_or(self.last.uv);
        // Between steps a contact moves by less than any bump is wide; in the air the nearest place
        // may be another one.
        self.seed = touching.touch.map(|touch| touch.uv);
        let carrier_m = self.carrier.offset_m;
        self.carrier = control.step(&self.carrier, touching.normal_n, dt_s);
        self.last = PolishStep {
            touching,
            uv,
            carrier_m,
            force_on_tool_n: loads.wrenches[0].force_n,
        };
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
    }

    fn keep_rows_only(&mut self) {
        self.rows_only = true;
    }

    fn finish(&mut self) -> Findings {
        if self.rows_only {
            return Findings::default();
        }
        self.settle();
        report::findings(&self.setup, &self.grid, &self.pressing, self.preston_j)
    }

    /// Where an eccentric wheel turns, its frequency.
    fn highest_frequency_hz(&self) -> Option<f64> {
        let p = &self.setup;
        (p.eccentricity_m != [0.0; 2]).then(|| p.spin_rad_s.abs() / std::f64::consts::TAU)
    }

    fn quickest_s(&self) -> Option<f64> {
        self.setup.control.quickest_s(self.stiffness_n_per_m())
    }

    /// A carrier is softer, or follows within its own law.
    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        let p = &self.setup;
        vec![ContactStiffness {
            frame: Attachment::Tool,
            direction: p.process_from_world * p.first_normal,
            stiffness_n_per_m: self.stiffness_n_per_m(),
        }]
    }

    fn field(&self) -> Option<Field> {
        let p = &self.setup;
        let full_scale = FULL_SCALE * p.expected_depth_m;
        Some(field(&p.cells, &p.patch, &p.world_from_patch, full_scale))
    }

    fn field_values(&self) -> Vec<f32> {
        let depths = self.grid.removed_m().iter();
        depths.map(|depth| *depth as f32).collect()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        vec![("wheel contact", Attachment::Tool, self.last.force_on_tool_n)]
    }
}
