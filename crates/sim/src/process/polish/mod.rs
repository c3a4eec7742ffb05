//! A soft wheel in precession polishes a rectangular face.
//!
//! The tool frame stands in the wheel's centre, its z axis is the spin axis and points towards the
//! face. Every step takes the pose and the motion of the tool as they are, deflection and rotation
//! of the arm included. The wheel is an inflated sphere about the tool point, shifted by its
//! eccentricity, which turns with the spin, and by the carrier of a force control, which moves
//! along the normal. How far it reaches into the plane of the face gives the patch
//! ([`truecut_core::wheel::patch`]); what of it lies on the face presses, edges by their line
//! reactions. The surface slides by `v_centre + Ω × r`, Ω the spin and the tool's own turning.
//!
//! Force and moment of patch, edges and friction act on the tool; the drive of the spindle holds
//! its speed, so that the moment about the spin axis reaches the arm. The carrier's mass counts as
//! part of the tool. Where the scenario says so the wheel's surface is uneven ([`texture`]) and its
//! grains strike edges ([`edge_grains`]).

mod channels;
mod edge_grains;
mod report;
pub(crate) mod setup;
mod surface;
mod texture;

use super::quantity::{self, Quantity};
use super::step_cache::StepCache;
use super::{ContactStiffness, Findings, Process, ToolState, slope_n_per_m};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use edge_grains::{EdgeGrains, GrainLoad};
use nalgebra::{Isometry2, Isometry3, Point2, Point3, UnitQuaternion, Vector2, Vector3};
use report::Watch;
use std::sync::Arc;
use surface::Surface;
use truecut_core::wheel::face::Face;
use truecut_core::wheel::force_control::Offset;
use truecut_core::wheel::patch::{EdgePoint, Patch, PatchLoads, Sliding};
use truecut_core::wheel::quadrature::Quadrature;
use truecut_core::wheel::shell::Shell;
use truecut_core::wheel::texture::PatchTexture;
use truecut_recording::{ChannelSpec, Field};
use truecut_scenario::PolishSpec;

/// Height over the face at which the depth is drawn, so that the block does not shine through, m.
const DRAWN_ABOVE_M: f64 = 1e-4;
/// Depth at which the colours end, over the mean that is expected.
const FULL_SCALE: f64 = 3.0;

/// All that a polishing run is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct PolishSetup {
    /// What the scenario asks for, its effects included.
    pub spec: PolishSpec,
    /// The wheel's shell.
    pub shell: Arc<Shell>,
    pub world_from_face: Isometry3<f64>,
    /// Turns world axes into process axes.
    pub process_from_world: UnitQuaternion<f64>,
    pub face: Face,
    /// How far the path reaches into the face.
    pub indentation_m: f64,
    pub duration_s: f64,
    /// Mean depth that lines leave far from edges, for the colours of the view, m.
    pub expected_depth_m: f64,
    /// Force and moment on the tool of an arm that rests at the start, process axes.
    pub resting: Wrench,
    /// Mean force of jammed grains per normal force of an edge that is run over inward.
    pub jamming_share: f64,
}

/// The process.
#[derive(Debug, Clone)]
pub struct Polish {
    setup: PolishSetup,
    quadrature: Quadrature,
    /// Offset of the carrier towards the face.
    carrier: Offset,
    surface: Surface,
    texture: Option<PatchTexture>,
    grains: Option<EdgeGrains>,
    watch: Watch,
    last: PolishStep,
    /// Whether nobody asks for the findings.
    rows_only: bool,
    /// The contact state that the loads of this step were computed from.
    contact_state: StepCache<(PolishContact, Vec<EdgePoint>)>,
}

/// Values of the last committed step, face axes.
#[derive(Debug, Clone, Copy, Default)]
struct PolishStep {
    at_m: Vector2<f64>,
    indentation_m: f64,
    normal_n: f64,
    friction_n: Vector2<f64>,
    edge_n: f64,
    inward_n: f64,
    carrier_m: f64,
    acceleration_m_s2: Vector3<f64>,
    /// Part of it along the outward normal of the nearest edge.
    outward_m_s2: f64,
    force_on_tool_n: Vector3<f64>,
    lean_rad: f64,
}

/// Wheel and face at one instant, face axes.
#[derive(Debug, Clone, Copy)]
struct PolishContact {
    /// Middle of the patch.
    at_m: Point2<f64>,
    indentation_m: f64,
    patch: Patch,
    sliding: Sliding,
    loads: PatchLoads,
    /// Part of the edge force on edges over which the wheel moves inward.
    inward_n: f64,
    force_on_tool_n: Vector3<f64>,
    /// About the tool point.
    moment_on_tool_n_m: Vector3<f64>,
}

impl Polish {
    pub fn new(setup: PolishSetup) -> Self {
        Self {
            quadrature: Quadrature::default(),
            carrier: Offset::default(),
            surface: Surface::new(&setup),
            texture: texture::under_patch(&setup),
            grains: EdgeGrains::new(&setup),
            watch: Watch::new(&setup),
            last: PolishStep::default(),
            rows_only: false,
            contact_state: StepCache::default(),
            setup,
        }
    }

    /// The contact and its reactions along edges.
    fn contact_state(&self, state: &ToolState) -> (PolishContact, Vec<EdgePoint>) {
        let mut edges = Vec::new();
        let contact = self.contact(state, |point| edges.push(*point));
        (contact, edges)
    }

    /// Place (m) and velocity (m/s) of the wheel's middle, face axes; the second place is the tool
    /// point.
    fn middle(&self, state: &ToolState) -> (Point3<f64>, Vector3<f64>, Point3<f64>) {
        let p = &self.setup;
        let into_face = p.world_from_face.inverse();
        let tool = into_face * Point3::from(state.world_from_tool.translation.vector);
        let velocity_in_world = p.process_from_world.inverse() * state.tool.velocity_m_per_s;
        let mut velocity = into_face.rotation * velocity_in_world;
        let mut middle = tool;
        if p.spec.eccentricity_m > 0.0 {
            // The tool's z axis points towards the face: a positive spin turns from its y axis to
            // its x axis.
            let angle = p.spec.eccentricity_angle_rad - p.spec.spin_rad_s * state.time_s;
            let (sine, cosine) = angle.sin_cos();
            let axes = into_face.rotation * state.world_from_tool.rotation;
            middle += axes * Vector3::new(cosine, sine, 0.0) * p.spec.eccentricity_m;
            let rate = -p.spec.spin_rad_s * p.spec.eccentricity_m;
            velocity += axes * Vector3::new(-sine, cosine, 0.0) * rate;
        }
        middle.z -= self.carrier.offset_m;
        velocity.z -= self.carrier.rate_now_m_per_s();
        (middle, velocity, tool)
    }

    /// Spin and turning of the tool, face axes, rad/s.
    fn turning_rad_s(&self, state: &ToolState) -> Vector3<f64> {
        let p = &self.setup;
        let away = -(state.world_from_tool.rotation * Vector3::z());
        p.world_from_face.rotation.inverse() * (away * p.spec.spin_rad_s + state.tool_turning_rad_s)
    }

    /// Patch, loads and what reaches the tool. `edges` is given the reactions along edges.
    fn contact(&self, state: &ToolState, mut edges: impl FnMut(&EdgePoint)) -> PolishContact {
        let p = &self.setup;
        let (middle, velocity, tool) = self.middle(state);
        let turning = self.turning_rad_s(state);
        let (height_m, at_m) = (middle.z, middle.xy());
        let [higher_m, rising_m_per_s] =
            (self.texture.as_ref()).map_or([0.0; 2], |texture| texture::at(texture, p, state));
        let indentation_m = p.spec.wheel.radius_m - height_m + higher_m;
        let patch = p.spec.wheel.patch(&p.shell, indentation_m);
        let sliding = Sliding {
            velocity_m_per_s: Vector2::new(
                velocity.x - turning.y * height_m,
                velocity.y + turning.x * height_m,
            ),
            spin_rad_s: turning.z,
            approach_m_per_s: rising_m_per_s - velocity.z,
            mu: p.spec.abrasive.mu,
        };
        let patch_from_face = Isometry2::translation(-at_m.x, -at_m.y);
        let (mut inward_n, mut jamming) = (0.0, GrainLoad::default());
        let edge = |point: EdgePoint| {
            let outward = p.outward(at_m + point.at_m.coords);
            let v = sliding.at_m_per_s(point.at_m.x, point.at_m.y);
            let across = v.dot(&outward);
            if across < 0.0 {
                inward_n += point.force_n;
                let held = p.jamming_share * point.force_n * across / v.norm_squared();
                jamming.add(point.at_m, -v.push(0.0) * held);
            }
            edges(&point);
        };
        let mut loads = patch.loads(&p.face, &patch_from_face, &sliding, &self.quadrature, edge);
        if p.jamming_share > 0.0 {
            loads.friction_n += jamming.force_n.xy();
            loads.spin_moment_n_m += jamming.moment_about_n_m(&Vector3::zeros()).z;
        }
        let friction = loads.friction_n;
        let grains = self.grain_load();
        let on_wheel = Vector3::new(-friction.x, -friction.y, loads.normal_n) - grains.force_n;
        let first = loads.first_moment_n_m;
        let middle = Vector3::new(at_m.x, at_m.y, 0.0);
        let moment = Vector3::new(first.y, -first.x, -loads.spin_moment_n_m)
            - grains.moment_about_n_m(&middle);
        let lever = middle - tool.coords;
        let force_on_tool_n = self.through_carrier(on_wheel);
        PolishContact {
            at_m,
            indentation_m,
            patch,
            sliding,
            inward_n,
            force_on_tool_n,
            moment_on_tool_n_m: moment + lever.cross(&force_on_tool_n),
            loads,
        }
    }

    /// What grains do to the face in this step.
    fn grain_load(&self) -> GrainLoad {
        (self.grains.as_ref()).map_or_else(GrainLoad::default, |grains| grains.load)
    }

    /// What a carrier lets pass of the force on the wheel: across the normal all of it.
    fn through_carrier(&self, on_wheel_n: Vector3<f64>) -> Vector3<f64> {
        let carried_n = self
            .setup
            .spec
            .control
            .carried_n(&self.carrier, on_wheel_n.z);
        Vector3::new(on_wheel_n.x, on_wheel_n.y, carried_n)
    }

    /// Slope of the force over the indentation on a face without edges, N/m.
    fn stiffness_n_per_m(&self) -> f64 {
        let wheel = &self.setup.spec.wheel;
        slope_n_per_m(self.setup.indentation_m, |d| {
            wheel.patch(&self.setup.shell, d).free_force_n()
        })
    }

    /// What is recorded of the step last committed.
    fn quantities(&self) -> Vec<Quantity> {
        let mut quantities = self.last.quantities(self.surface.preston_m3(&self.setup));
        quantities.extend(self.grains.iter().flat_map(channels::of_grains));
        quantities
    }

    fn to_process(&self, in_face: Vector3<f64>) -> Vector3<f64> {
        self.setup.process_from_world * (self.setup.world_from_face.rotation * in_face)
    }
}

impl Process for Polish {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let (contact, edges) = self.contact_state(state);
        self.contact_state.set(state.time_s, (contact, edges));
        Loads::from(Wrench {
            frame: Attachment::Tool,
            force_n: self.to_process(contact.force_on_tool_n),
            moment_n_m: self.to_process(contact.moment_on_tool_n_m),
        })
    }

    fn commit(&mut self, state: &ToolState, _: &Loads, _: &ContactOutcomes, dt_s: f64) {
        // Removal and channels use the contact state of the loads, with its predicted velocity.
        let cached = self.contact_state.take(state.time_s);
        let (contact, edges) = cached.unwrap_or_else(|| self.contact_state(state));
        self.surface.preston_j += contact.loads.sliding_w * dt_s;
        if !self.rows_only {
            self.surface.polish(&self.setup, &contact, &edges, dt_s);
        }
        let p = &self.setup;
        let world_velocity = p.process_from_world.inverse() * state.tool.velocity_m_per_s;
        let velocity = p.world_from_face.rotation.inverse() * world_velocity;
        let acceleration_m_s2 = self.watch.acceleration_m_s2(velocity, dt_s);
        let lean =
            p.world_from_face.rotation.inverse() * (state.world_from_tool.rotation * -Vector3::z());
        self.last = PolishStep {
            at_m: contact.at_m.coords,
            indentation_m: contact.indentation_m,
            normal_n: contact.loads.normal_n,
            friction_n: contact.loads.friction_n,
            edge_n: contact.loads.edge_n,
            inward_n: contact.inward_n,
            carrier_m: self.carrier.offset_m,
            acceleration_m_s2,
            outward_m_s2: acceleration_m_s2.xy().dot(&p.outward(contact.at_m)),
            force_on_tool_n: self.to_process(contact.force_on_tool_n),
            lean_rad: lean.y.atan2(lean.x),
        };
        if !self.rows_only {
            let inside_m = p.inside_m(contact.at_m);
            self.watch.step(&self.last, inside_m, dt_s);
        }
        if let Some(grains) = &mut self.grains {
            grains.step(&contact, &edges, dt_s);
        }
        self.carrier = p
            .spec
            .control
            .step(&self.carrier, contact.loads.normal_n, dt_s);
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
        self.surface.settle(&self.setup);
        let mut findings = report::findings(&self.setup, &self.surface, &self.watch);
        if let Some(grains) = &self.grains {
            findings
                .scalars
                .extend(quantity::scalars(grains.quantities()));
            findings.profiles.push(grains.profile());
        }
        findings
    }

    fn static_loads(&self) -> Loads {
        Loads::from(self.setup.resting)
    }

    /// Where an eccentric or uneven wheel turns, its frequency, or that of its shortest waves.
    fn highest_frequency_hz(&self) -> Option<f64> {
        let p = &self.setup;
        let eccentric = usize::from(p.spec.eccentricity_m > 0.0);
        let uneven = (self.texture.as_ref()).map_or(0, PatchTexture::highest_harmonic);
        let order = eccentric.max(uneven);
        (order > 0).then(|| order as f64 * p.spec.spin_rad_s.abs() / std::f64::consts::TAU)
    }

    fn quickest_s(&self) -> Option<f64> {
        self.setup.spec.control.quickest_s(self.stiffness_n_per_m())
    }

    /// A carrier is softer, or follows within its own law.
    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        vec![ContactStiffness {
            frame: Attachment::Tool,
            direction: self.to_process(Vector3::z()),
            stiffness_n_per_m: self.stiffness_n_per_m(),
        }]
    }

    fn field(&self) -> Option<Field> {
        let p = &self.setup;
        let ridge = Isometry3::translation(0.0, 0.0, DRAWN_ABOVE_M);
        Some(Field {
            path: "removed_depth".into(),
            world_from_field: crate::scene::pose(&(p.world_from_face * ridge)),
            size_m: [p.spec.face.length_m, p.spec.face.width_m],
            cells: p.spec.cells(),
            full_scale: FULL_SCALE * p.expected_depth_m,
            unit: truecut_recording::Unit::Metre,
            vertices_m: Vec::new(),
        })
    }

    fn field_values(&self) -> Vec<f32> {
        (self.surface.grid.removed_m().iter())
            .map(|depth| *depth as f32)
            .collect()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        vec![("wheel contact", Attachment::Tool, self.last.force_on_tool_n)]
    }
}
