//! A belt over a contact wheel finishes a freeform face.
//!
//! The tool frame stands in the wheel's centre, its y axis is the wheel's, z points into the face.
//! Every step takes the pose and the motion of the tool as they are, deflection and rotation of the
//! arm included. The wheel is cut into strips along its axis; each is nearest to the patch in its
//! own section ([`geometry`]) and presses there as a line patch ([`contact`]): rubber on a hub
//! under a belt of this tension ([`truecut_core::wheel::belt`]). Where no face is, beyond the
//! patch's borders or its boundary, nothing presses; along borders across the belt's run the belt
//! bends round the edge.
//!
//! The belt slides over the face at its own speed, along the tool's x axis, and with the tool.
//! Force and moment of all strips act on the tool: wheel, belt and its drive hang on the arm. A
//! force control has a carrier between tool and wheel, which moves along the tool's z axis; what of
//! the force lies along it reaches the tool through the carrier. Its mass counts as part of the
//! tool.

#[cfg(test)]
mod carrier_tests;
mod contact;
pub(super) mod geometry;
mod passes;
pub(super) mod report;
pub(crate) mod setup;
pub(super) mod surface;
#[cfg(test)]
mod tests;

pub(crate) use passes::{NoPasses, Passes};
pub use surface::{Cells, cells_within};

use super::quantity::{self, Quantity};
use super::step_cache::StepCache;
use super::{ContactStiffness, Findings, Process, ToolState, slope_n_per_m};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use contact::{BeltContact, Motion, Strip};
use geometry::FaceGeometry;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use report::Watch;
use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock};
use surface::Worn;
use truecut_core::wheel::abrasive::Abrasive;
use truecut_core::wheel::belt::BeltWheel;
use truecut_core::wheel::bonded::BondedLayer;
use truecut_core::wheel::eccentricity::Eccentricity;
use truecut_core::wheel::force_control::{ForceControl, Offset};
use truecut_core::wheel::patch::EdgePoint;
use truecut_core::wheel::quadrature::Quadrature;
use truecut_plan::motion::lines::CopyAt;
use truecut_plan::surface::PatchFile;
use truecut_recording::{ChannelSpec, Field, Unit};

/// Eight nodes across and along a strip; a search makes thousands of belts.
static RULES: LazyLock<Quadrature> = LazyLock::new(|| Quadrature::new(8));

/// All that a belt run is made of.
#[derive(Debug, Clone)]
pub struct BeltSetup {
    pub wheel: BeltWheel,
    /// The wheel's rubber.
    pub layer: Arc<BondedLayer>,
    pub control: ForceControl,
    /// Of the contact wheel's running surface.
    pub eccentricity: Eccentricity,
    /// Speed of the belt along the tool's x axis, m/s.
    pub belt_m_per_s: f64,
    pub abrasive: Abrasive,
    pub patch: Arc<PatchFile>,
    /// Copies in the order in which they are finished, one at least.
    pub copies: Vec<CopyAt>,
    /// Turns world axes into process axes.
    pub process_from_world: UnitQuaternion<f64>,
    pub cells: Cells,
    /// True areas of the cells, row by row.
    pub area_m2: Arc<Vec<f64>>,
    /// Which cells belong to the face.
    pub is_face: Arc<Vec<bool>>,
    /// Least and greatest u, and v, between the outermost lines and short of their ends, where
    /// every pass is whole.
    pub swept: [[f64; 2]; 2],
    /// How far the path reaches into the face.
    pub indentation_m: f64,
    /// Outward normal of the face where the first line begins, world.
    pub first_normal: Vector3<f64>,
    /// Largest distance of the straight lines that the job's program drives from the face that this
    /// run follows, m.
    pub chord_m: f64,
    /// Mean depth that the job's line load would leave, for the colours of the view, m.
    pub expected_depth_m: f64,
}

impl BeltSetup {
    /// The copy that is under the wheel.
    fn copy_at(&self, time_s: f64) -> usize {
        let begun = self.copies.partition_point(|copy| copy.from_s <= time_s);
        begun.saturating_sub(1)
    }

    /// How fast the belt turns the contact wheel, rad/s.
    fn wheel_rad_s(&self) -> f64 {
        self.belt_m_per_s / self.wheel.radius_m
    }

    /// Motion of the wheel, which a carrier moves along the tool's z axis, in the frame of a copy's
    /// patch.
    fn motion(&self, copy: usize, state: &ToolState, carrier: &Offset) -> Motion {
        let patch_from_world = self.copies[copy].world_from_patch.inverse();
        let turn = patch_from_world.rotation;
        let velocity_in_world = self.process_from_world.inverse() * state.tool.velocity_m_per_s;
        let turning_rad_s = turn * state.tool_turning_rad_s;
        let patch_from_tool = patch_from_world * state.world_from_tool;
        let forward = patch_from_tool.rotation * Vector3::z();
        let out_m = forward * carrier.offset_m;
        Motion {
            patch_from_wheel: Translation3::from(out_m) * patch_from_tool,
            velocity_m_per_s: turn * velocity_in_world
                + turning_rad_s.cross(&out_m)
                + forward * carrier.rate_now_m_per_s(),
            turning_rad_s,
        }
    }

    fn to_process(&self, copy: usize, in_patch: &Vector3<f64>) -> Vector3<f64> {
        self.process_from_world * (self.copies[copy].world_from_patch.rotation * in_patch)
    }
}

/// The process.
#[derive(Debug, Clone)]
pub struct Belt {
    setup: BeltSetup,
    face: FaceGeometry,
    /// Offset of the carrier towards the face.
    carrier: Offset,
    /// One a copy; none where only rows are asked for.
    worn: Vec<Worn>,
    watch: Watch,
    last: BeltStep,
    /// Where the last step's contact is looked for in the next, if the wheel touched.
    seed: Option<(usize, [f64; 2])>,
    /// The contact state that the loads of this step were computed from.
    contact_state: StepCache<(BeltContact, Edges)>,
}

/// Reactions along borders, with the strip that they belong to.
type Edges = Vec<(Strip, EdgePoint)>;

/// The last committed step.
#[derive(Debug, Clone, Default)]
struct BeltStep {
    contact: BeltContact,
    /// Place under the wheel's middle; far from the face that of the last one.
    uv: [f64; 2],
    indentation_m: f64,
    carrier_m: f64,
    /// Process axes.
    force_on_tool_n: Vector3<f64>,
}

impl Belt {
    pub fn new(setup: BeltSetup) -> Self {
        Self {
            face: FaceGeometry::new(setup.patch.clone()),
            // It comes from the air.
            carrier: Offset::at(setup.control.lifted_m()),
            worn: setup.copies.iter().map(|_| Worn::new(&setup)).collect(),
            watch: Watch::default(),
            last: BeltStep::default(),
            seed: None,
            contact_state: StepCache::default(),
            setup,
        }
    }

    fn contact_state(&self, state: &ToolState) -> (BeltContact, Edges) {
        let mut edges = Edges::new();
        let add = |strip: &Strip, point: &EdgePoint| edges.push((*strip, *point));
        let (setup, carrier) = (&self.setup, &self.carrier);
        let contact = BeltContact::of(setup, &self.face, self.seed, state, carrier, add);
        (contact, edges)
    }

    /// Force and moment about its point that the contact gives the tool, process axes.
    fn on_tool(&self, contact: &BeltContact) -> (Vector3<f64>, Vector3<f64>) {
        let (setup, carrier) = (&self.setup, &self.carrier);
        let pushed_n = contact.pushed_n();
        let carried_n = setup.control.carried_n(carrier, pushed_n);
        let force_n = contact.force_n + contact.forward * (pushed_n - carried_n);
        let lever_m = contact.forward * carrier.offset_m;
        let moment_n_m = contact.moment_n_m + lever_m.cross(&force_n);
        let to_process = |in_patch| setup.to_process(contact.copy, &in_patch);
        (to_process(force_n), to_process(moment_n_m))
    }

    /// What is recorded of the step last committed.
    fn quantities(&self) -> [Quantity; 10] {
        let (last, contact, [u, v]) = (&self.last, &self.last.contact, self.last.uv);
        let removed_m3 = self.watch.preston_m3(&self.setup);
        [
            Quantity::new("belt.normal_force", Unit::Newton, contact.normal_n)
                .text("Force with which the belt presses on the face, along its normals"),
            Quantity::new("belt.edge_force", Unit::Newton, contact.edge_n)
                .text("Part of the normal force that acts along borders of the face"),
            Quantity::new("belt.friction_run", Unit::Newton, contact.friction_n.x)
                .text("Friction on the face along the tool's x axis, the belt's run"),
            Quantity::new("belt.friction_axis", Unit::Newton, contact.friction_n.y)
                .text("Friction on the face along the wheel's axis"),
            Quantity::new("belt.indentation", Unit::Metre, last.indentation_m)
                .text("How far the undeformed wheel reaches into the face in its middle; 0 when lifted"),
            Quantity::new("belt.contact_width", Unit::Metre, contact.width_m)
                .text("Width over which the wheel touches the face"),
            Quantity::new("belt.carrier_offset", Unit::Metre, last.carrier_m)
                .text("How far the carrier of a force control stands out towards the face; 0 without one"),
            Quantity::new("belt.position_u", Unit::One, u)
                .text("First parameter of the face under the wheel's middle; far from the face that of the last place"),
            Quantity::new("belt.position_v", Unit::One, v)
                .text("Second parameter of the face under the wheel's middle"),
            Quantity::new("belt.removed_volume", Unit::CubicMetre, removed_m3)
                .text("Volume removed so far"),
        ]
    }

    /// Slope of the force over the indentation on a flat face, at the indentation of the path, N/m.
    fn stiffness_n_per_m(&self) -> f64 {
        let wheel = &self.setup.wheel;
        slope_n_per_m(self.setup.indentation_m, |d| {
            wheel.normal_force_n(d, wheel.radius_m)
        })
    }
}

impl Process for Belt {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let (contact, edges) = self.contact_state(state);
        let (force_n, moment_n_m) = self.on_tool(&contact);
        self.contact_state.set(state.time_s, (contact, edges));
        Loads::from(Wrench {
            frame: Attachment::Tool,
            force_n,
            moment_n_m,
        })
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, _: &ContactOutcomes, dt_s: f64) {
        // Removal and channels use the contact state of the loads, with its predicted velocity.
        let cached = self.contact_state.take(state.time_s);
        let (contact, edges) = cached.unwrap_or_else(|| self.contact_state(state));
        if let Some(worn) = self.worn.get_mut(contact.copy) {
            worn.grind(&self.setup, &contact.strips, &edges, dt_s);
        }
        let control = self.setup.control;
        self.watch
            .step(&contact, control.is_at_stop(&self.carrier), dt_s);
        let (uv, indentation_m) = contact.middle.unwrap_or((self.last.uv, 0.0));
        // Between steps a contact moves by less than any bump is wide; in the air the nearest place
        // may be another one.
        let touched = contact.middle.is_some() && !contact.strips.is_empty();
        self.seed = touched.then_some((contact.copy, uv));
        let carrier_m = self.carrier.offset_m;
        self.carrier = control.step(&self.carrier, contact.pushed_n(), dt_s);
        self.last = BeltStep {
            contact,
            uv,
            indentation_m: indentation_m.max(0.0),
            carrier_m,
            force_on_tool_n: loads.wrenches[0].force_n,
        };
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
    }

    fn keep_rows_only(&mut self) {
        self.worn.clear();
    }

    fn finish(&mut self) -> Findings {
        for worn in &mut self.worn {
            worn.settle_all(&self.setup);
        }
        report::findings(&self.setup, &self.worn, &self.watch)
    }

    fn highest_frequency_hz(&self) -> Option<f64> {
        let p = &self.setup;
        (!p.eccentricity.is_none()).then(|| p.wheel_rad_s().abs() / TAU)
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

    /// Of copies that the arm goes to, the first one's is drawn; a turntable brings all to where
    /// that is.
    fn field(&self) -> Option<Field> {
        let p = &self.setup;
        let full_scale = report::FULL_SCALE * p.expected_depth_m;
        let world_from_patch = p.copies[0].world_from_patch;
        Some(report::field(
            &p.cells,
            &p.patch,
            &world_from_patch,
            full_scale,
        ))
    }

    fn field_values(&self) -> Vec<f32> {
        let p = &self.setup;
        let brought = (p.copies)
            .iter()
            .all(|copy| copy.world_from_patch == p.copies[0].world_from_patch);
        let drawn = if brought { self.last.contact.copy } else { 0 };
        let depths = self.worn.get(drawn).map(|worn| worn.grid.removed_m());
        (depths.unwrap_or_default().iter())
            .map(|depth| *depth as f32)
            .collect()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        vec![("belt contact", Attachment::Tool, self.last.force_on_tool_n)]
    }
}
