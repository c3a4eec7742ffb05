//! A compliant wheel run along a flat plate.

pub(crate) mod setup;

use super::quantity::{self, Quantity};
use super::{ContactStiffness, Findings, Process, ToolState};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use nalgebra::Vector3;
use truecut_core::wheel::Strip;
use truecut_recording::{ChannelSpec, Profile, Unit};
use truecut_scenario::WheelSpec;

/// The process. The plate is at right angles to process X, the pass runs along process Y.
#[derive(Debug, Clone)]
pub struct Wheel {
    parameters: WheelSpec,
    /// None where nobody asks for it.
    strip: Option<Strip>,
    removal_work_j: f64,
    last: WheelStep,
}

/// Values of the last committed step.
#[derive(Debug, Clone, Copy, Default)]
struct WheelStep {
    normal_n: f64,
    friction_on_wheel_n: f64,
    indentation_m: f64,
    position_m: f64,
}

/// The contact at one instant.
struct WheelContactState {
    indentation_m: f64,
    normal_n: f64,
    /// Speed of the wheel's surface over the plate, along Y.
    sliding_m_per_s: f64,
}

impl Wheel {
    pub fn new(parameters: WheelSpec) -> Self {
        Self {
            strip: Some(Strip::new(
                parameters.strip_length_m,
                parameters.contact.width_m,
                parameters.strip_cells,
            )),
            parameters,
            removal_work_j: 0.0,
            last: WheelStep::default(),
        }
    }

    fn contact(&self, state: &ToolState) -> WheelContactState {
        let p = &self.parameters;
        let (indentation_m, rate) = p.contact.indentation_m(
            p.normal_force_n / p.contact.stiffness_n_per_m,
            state.tool.displacement_m.x,
            state.tool.velocity_m_per_s.x,
            p.spin_rad_s * state.time_s,
            p.spin_rad_s,
        );
        let surface = p.surface_sign * p.spin_rad_s * p.contact.radius_m;
        WheelContactState {
            indentation_m,
            normal_n: p.contact.normal_force_n(indentation_m, rate),
            sliding_m_per_s: surface + state.tool.velocity_m_per_s.y,
        }
    }

    fn friction_on_wheel_n(&self, contact: &WheelContactState) -> f64 {
        -self.parameters.contact.mu * contact.normal_n * contact.sliding_m_per_s.signum()
    }

    /// What is recorded of the step last committed.
    fn quantities(&self) -> [Quantity; 4] {
        let last = &self.last;
        [
            Quantity::new("wheel.normal_force", Unit::Newton, last.normal_n)
                .text("Force with which the wheel presses on the plate"),
            Quantity::new(
                "wheel.friction_force",
                Unit::Newton,
                last.friction_on_wheel_n,
            )
            .text("Friction on the wheel, process Y"),
            Quantity::new("wheel.indentation", Unit::Metre, last.indentation_m)
                .text("Flattening of the wheel, eccentricity included"),
            Quantity::new("wheel.position", Unit::Metre, last.position_m)
                .text("Position along the strip"),
        ]
    }
}

impl Process for Wheel {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let contact = self.contact(state);
        let friction = self.friction_on_wheel_n(&contact);
        // The tool frame sits at the contact; what the friction turns about the wheel's axis is
        // borne by the spindle's drive and reaches the arm through the same frame.
        let force = Vector3::new(-contact.normal_n, friction, 0.0);
        Loads::from(Wrench::force(Attachment::Tool, force))
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, _: &ContactOutcomes, dt_s: f64) {
        let p = &self.parameters;
        let contact = self.contact(state);
        let position_m = state.tool.displacement_m.y;
        let line_load = contact.normal_n / p.contact.width_m;
        let dose = p.preston_per_pa * line_load * contact.sliding_m_per_s.abs() * dt_s;
        let half_length = p.contact.half_length_m(contact.indentation_m);
        if let Some(strip) = &mut self.strip {
            strip.remove(position_m, half_length, dose);
        }
        self.removal_work_j += contact.normal_n * contact.sliding_m_per_s.abs() * dt_s;
        self.last = WheelStep {
            normal_n: contact.normal_n,
            friction_on_wheel_n: loads.wrenches[0].force_n.y,
            indentation_m: contact.indentation_m,
            position_m,
        };
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
    }

    fn keep_rows_only(&mut self) {
        self.strip = None;
    }

    fn finish(&mut self) -> Findings {
        let Some(strip) = self.strip.take() else {
            return Findings::default();
        };
        let removed = strip.removed_m();
        let inner = &removed[removed.len() / 4..(removed.len() * 3 / 4).max(removed.len() / 4 + 1)];
        let mean_m = inner.iter().sum::<f64>() / inner.len() as f64;
        let spread_m = truecut_core::roughness::spread(inner);
        let removed_m3 = strip.volume_m3();
        let preston_m3 = self.parameters.preston_per_pa * self.removal_work_j;
        Findings {
            scalars: quantity::scalars([
                Quantity::new("wheel.removed_volume", Unit::CubicMetre, removed_m3)
                    .text("Volume removed from the strip"),
                Quantity::new("wheel.preston_volume", Unit::CubicMetre, preston_m3)
                    .text("Preston's integral k_p ∫ N v dt, on and off the strip"),
                Quantity::new("wheel.removed_depth_mean", Unit::Metre, mean_m)
                    .text("Mean depth removed over the middle half of the strip"),
                Quantity::new("wheel.removed_depth_spread", Unit::Metre, spread_m)
                    .text("Deepest minus shallowest over the middle half of the strip"),
            ]),
            profiles: vec![Profile {
                name: "wheel.removed_depth".into(),
                description: "Depth removed along the strip".into(),
                axis_name: "strip_position".into(),
                axis_unit: Unit::Metre,
                axis: (0..removed.len()).map(|i| strip.position_m(i)).collect(),
                unit: Unit::Metre,
                values: removed.to_vec(),
            }],
            ..Findings::default()
        }
    }

    fn static_loads(&self) -> Loads {
        let contact = &self.parameters.contact;
        let swing = contact.stiffness_n_per_m * contact.eccentricity_at_start_m;
        let normal_n = (self.parameters.normal_force_n + swing).max(0.0);
        let preload = Vector3::new(-normal_n, 0.0, 0.0);
        Loads::from(Wrench::force(Attachment::Tool, preload))
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        vec![ContactStiffness {
            frame: Attachment::Tool,
            direction: Vector3::x(),
            stiffness_n_per_m: self.parameters.contact.stiffness_n_per_m,
        }]
    }

    fn feed_along_y_m_per_s(&self) -> f64 {
        self.parameters.feed_m_per_s
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        vec![(
            "wheel contact",
            Attachment::Tool,
            Vector3::new(-self.last.normal_n, self.last.friction_on_wheel_n, 0.0),
        )]
    }
}
