//! Given forces at the tool: release, step, chirp, rotation; optionally with a pressure foot.

pub(crate) mod setup;

use super::quantity::{self, Quantity};
use super::{ContactStiffness, Foot, FootParameters, Process, ToolState};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_recording::{ChannelSpec, Unit};
use truecut_scenario::LoadSpec;

/// The process.
#[derive(Debug, Clone)]
pub struct Load {
    /// The forces, in process axes.
    forces: LoadSpec,
    /// Time from the first to the last frequency of the sweep, s.
    sweep_s: f64,
    foot: Option<Foot>,
    last_force_n: Vector3<f64>,
}

impl Load {
    /// Forces in process axes over a run of this length, s.
    pub fn new(forces: LoadSpec, run_s: f64, foot: Option<FootParameters>) -> Self {
        Self {
            foot: foot.map(Foot::new),
            forces,
            sweep_s: run_s,
            last_force_n: Vector3::zeros(),
        }
    }

    fn force_n(&self, t: f64) -> Vector3<f64> {
        let p = &self.forces;
        let mut force = p.constant_n;
        if let Some(s) = &p.sweep {
            // A sine whose frequency grows linearly over the run: sin(2π (f0 t + (f1-f0) t²/2T)).
            let cycles = s.from_hz * t + (s.to_hz - s.from_hz) * t * t / (2.0 * self.sweep_s);
            force += s.amplitude_n * (TAU * cycles).sin();
        }
        if let Some(r) = &p.rotating {
            let (sin, cos) = (r.start_angle_rad + TAU * r.frequency_hz * t).sin_cos();
            force += Vector3::new(0.0, cos, sin) * r.amplitude_n;
        }
        force
    }

    /// What is recorded of the step last committed, that of the foot included if there is one.
    fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let force = self.last_force_n;
        let given = [
            Quantity::new("load.force_x", Unit::Newton, force.x)
                .text("Given force on the tool, process X"),
            Quantity::new("load.force_y", Unit::Newton, force.y)
                .text("Given force on the tool, process Y"),
            Quantity::new("load.force_z", Unit::Newton, force.z)
                .text("Given force on the tool, process Z"),
        ];
        given
            .into_iter()
            .chain(self.foot.iter().flat_map(Foot::quantities))
    }
}

impl Process for Load {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let force = self.force_n(state.time_s);
        let mut loads = Loads::from(Wrench::force(Attachment::Tool, force));
        if let Some(foot) = &self.foot {
            foot.press(state, &mut loads);
        }
        loads
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, contacts: &ContactOutcomes, _dt: f64) {
        self.last_force_n = loads.wrenches[0].force_n;
        if let (Some(foot), Some(outcome)) = (&mut self.foot, contacts.first()) {
            foot.commit(state.time_s, &state.foot, outcome);
        }
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
    }

    fn static_loads(&self) -> Loads {
        let mut loads = Loads::from(Wrench::force(Attachment::Tool, self.forces.release_n));
        let preload = self.foot.iter().map(Foot::touch_down_wrench);
        loads.wrenches.extend(preload);
        loads
    }

    fn is_given(&self) -> bool {
        self.foot.is_none()
    }

    fn highest_frequency_hz(&self) -> Option<f64> {
        let sweep = self.forces.sweep.map(|s| s.from_hz.max(s.to_hz));
        let turning = self.forces.rotating.map(|r| r.frequency_hz.abs());
        let highest = sweep.unwrap_or(0.0).max(turning.unwrap_or(0.0));
        (highest > 0.0).then_some(highest)
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        self.foot.iter().map(Foot::contact_stiffness).collect()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        vec![("load", Attachment::Tool, self.last_force_n)]
    }
}
