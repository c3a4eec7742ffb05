//! A wheel brush deburrs edges of a mesh.
//!
//! The tool frame stands in the brush's centre, its y axis is the brush's, about which it turns
//! right-handed. Every step takes pose and motion of the tool as they are, deflection and rotation
//! of the arm included; bristles press where they meet the workpiece ([`contact`]), and what they
//! do to its edges follows from the dose that each place of them has had
//! ([`truecut_core::wheel::edge_wear`]).
//!
//! Burr and radius are small beside the bristles and do not act back on their forces. What brushing
//! takes off the faces is not counted.

mod contact;
mod fine;
mod layers;
mod report;
mod rows;
mod section;
pub(crate) mod setup;

use super::quantity::{self, Quantity};
use super::step_cache::StepCache;
use super::{ContactStiffness, Findings, Process, ToolState, slope_n_per_m};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use contact::BrushContact;
use nalgebra::{Isometry3, UnitQuaternion, UnitVector3, Vector3};
use report::Watch;
use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock};
use truecut_core::wheel::bristle::Bristle;
use truecut_core::wheel::brush::Brush;
use truecut_core::wheel::eccentricity::Eccentricity;
use truecut_core::wheel::edge_wear::EdgeWear;
use truecut_core::wheel::quadrature::Quadrature;
use truecut_plan::surface::Mesh;
use truecut_recording::{ChannelSpec, Field, Unit};

/// Eight nodes over a side of a row; a search makes thousands of brushes.
static RULES: LazyLock<Quadrature> = LazyLock::new(|| Quadrature::new(8));

/// A place of an edge, and the piece about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Which of the scenario's edges, from 0.
    pub edge: usize,
    /// In the mesh's frame.
    pub point_m: Vector3<f64>,
    pub length_m: f64,
    /// Outward normals of the faces that meet there, in the mesh's frame.
    pub normals: [UnitVector3<f64>; 2],
    pub wear: EdgeWear,
}

/// All that a brush run is made of.
#[derive(Debug, Clone)]
pub struct BrushSetup {
    pub brush: Brush,
    /// Law of its bristles.
    pub bristle: Bristle,
    /// Of the brush, along the tool's z axis.
    pub eccentricity: Eccentricity,
    /// Right-handed about the tool's y axis.
    pub spin_rad_s: f64,
    pub mesh: Arc<Mesh>,
    pub world_from_mesh: Isometry3<f64>,
    /// Places on the edges, edge after edge.
    pub stations: Vec<Station>,
    /// Turns world axes into process axes.
    pub process_from_world: UnitQuaternion<f64>,
    /// The tool's z axis at the start, world.
    pub approach: Vector3<f64>,
}

impl BrushSetup {
    /// The brush with its radius towards the work at this instant: an eccentric one turns its long
    /// side to the work once per revolution.
    fn brush_at(&self, time_s: f64) -> Brush {
        let spin = self.spin_rad_s;
        let [offset_m, _] = self.eccentricity.at(spin * time_s, spin);
        Brush {
            radius_m: self.brush.radius_m + offset_m,
            ..self.brush
        }
    }
}

/// The process.
#[derive(Debug, Clone)]
pub struct BrushProcess {
    setup: BrushSetup,
    /// `∫ ρ n v dt` of each station, J/m².
    dose_j_per_m2: Vec<f64>,
    watch: Watch,
    /// The contact of the last committed step, and its force on the tool in process axes, N.
    last: (BrushContact, Vector3<f64>),
    /// The contact state that the loads of this step were computed from.
    contact_state: StepCache<BrushContact>,
}

impl BrushProcess {
    pub fn new(setup: BrushSetup) -> Self {
        Self {
            dose_j_per_m2: vec![0.0; setup.stations.len()],
            watch: Watch::default(),
            last: Default::default(),
            contact_state: StepCache::default(),
            setup,
        }
    }

    fn to_process(&self, state: &ToolState, in_tool: &Vector3<f64>) -> Vector3<f64> {
        self.setup.process_from_world * (state.world_from_tool.rotation * in_tool)
    }

    /// What is recorded of the step last committed.
    fn quantities(&self) -> [Quantity; 7] {
        let last = &self.last.0;
        let friction_n = last.friction_n.norm();
        let (stations, dose) = (&self.setup.stations[..], &self.dose_j_per_m2[..]);
        let burred_m = report::burred_m(stations, dose);
        let removed_m3 = report::removed_m3(stations, dose);
        [
            Quantity::new("brush.bristle_force", Unit::Newton, last.bristle_n)
                .text("Sum of the forces with which the bristles press, each along itself"),
            Quantity::new("brush.friction_force", Unit::Newton, friction_n)
                .text("Friction of all tips together"),
            Quantity::new("brush.power", Unit::Watt, last.power_w)
                .text("Power that friction takes"),
            Quantity::new("brush.shortening", Unit::Metre, last.shortening_m)
                .text("By how much the bristle that is pressed in most is shortened"),
            Quantity::new("brush.contact_length", Unit::Metre, last.edge_m)
                .text("Length of edge under the brush"),
            Quantity::new("brush.burred_length", Unit::Metre, burred_m)
                .text("Length of edge on which a burr is left"),
            Quantity::new("brush.removed_volume", Unit::CubicMetre, removed_m3)
                .text("Volume removed from the edges so far, burrs included"),
        ]
    }
}

impl Process for BrushProcess {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let contact = BrushContact::of(&self.setup, state);
        let wrench = Wrench {
            frame: Attachment::Tool,
            force_n: self.to_process(state, &contact.force_n),
            moment_n_m: self.to_process(state, &contact.moment_n_m),
        };
        self.contact_state.set(state.time_s, contact);
        Loads::from(wrench)
    }

    fn commit(&mut self, state: &ToolState, _: &Loads, _: &ContactOutcomes, dt_s: f64) {
        // Removal and channels use the contact state of the loads, with its predicted velocity.
        let cached = self.contact_state.take(state.time_s);
        let contact = cached.unwrap_or_else(|| BrushContact::of(&self.setup, state));
        for (station, dose_w_per_m2) in &contact.doses_w_per_m2 {
            self.dose_j_per_m2[*station] += dose_w_per_m2 * dt_s;
        }
        self.watch.step(&contact, dt_s);
        let force_on_tool_n = self.to_process(state, &contact.force_n);
        self.last = (contact, force_on_tool_n);
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
    }

    fn finish(&mut self) -> Findings {
        report::findings(&self.setup, &self.dose_j_per_m2, &self.watch)
    }

    fn highest_frequency_hz(&self) -> Option<f64> {
        let p = &self.setup;
        (!p.eccentricity.is_none()).then(|| p.spin_rad_s.abs() / TAU)
    }

    /// Slope of the force over the depth on a flat face, where bristles are shortened by a
    /// twentieth.
    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        let p = &self.setup;
        let depth_m = 0.05 * p.brush.free_length_m;
        let reach_m = p.brush.radius_m;
        let force = |d: f64| {
            p.brush
                .normal_force_n(d, -reach_m, reach_m, (&p.bristle, &RULES))
        };
        vec![ContactStiffness {
            frame: Attachment::Tool,
            direction: p.process_from_world * p.approach,
            stiffness_n_per_m: slope_n_per_m(depth_m, force),
        }]
    }

    fn field(&self) -> Option<Field> {
        Some(report::field(&self.setup))
    }

    fn field_values(&self) -> Vec<f32> {
        report::field_values(&self.setup, &self.dose_j_per_m2)
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        vec![("brush contact", Attachment::Tool, self.last.1)]
    }
}
