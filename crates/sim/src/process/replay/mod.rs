//! Measured forces on the tool.

pub(crate) mod setup;

use super::quantity::{self, Quantity};
use super::{ContactStiffness, Process, ToolState};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use nalgebra::Vector3;
use truecut_recording::{ChannelSpec, Unit};

/// A force sampled at a constant rate from t = 0 on.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSamples {
    pub interval_s: f64,
    pub values: Vec<f64>,
}

impl ForceSamples {
    /// The force at a time: on the straight line between samples, constant beyond both ends.
    pub fn at(&self, time_s: f64) -> f64 {
        let last = self.values.len().saturating_sub(1);
        let x = (time_s / self.interval_s).clamp(0.0, last as f64);
        let k = (x.floor() as usize).min(last.saturating_sub(1));
        let Some(from) = self.values.get(k) else {
            return 0.0;
        };
        let to = self.values.get(k + 1).unwrap_or(from);
        from + (to - from) * (x - k as f64)
    }
}

/// The process: forces on the tool along the process axes, and nothing else.
#[derive(Debug, Clone)]
pub struct Replay {
    forces: [Option<ForceSamples>; 3],
    last_force_n: Vector3<f64>,
}

impl Replay {
    /// One series for each process axis; those that are missing are zero.
    pub fn new(forces: [Option<ForceSamples>; 3]) -> Self {
        Self {
            forces,
            last_force_n: Vector3::zeros(),
        }
    }

    fn force_n(&self, time_s: f64) -> Vector3<f64> {
        let at = |series: &Option<ForceSamples>| series.as_ref().map_or(0.0, |one| one.at(time_s));
        Vector3::from(self.forces.each_ref().map(at))
    }

    fn is_idle(&self) -> bool {
        self.forces.iter().all(Option::is_none)
    }

    /// What is recorded of the step last committed: nothing where nothing was measured.
    fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let force = self.last_force_n;
        let measured = [
            Quantity::new("tool.force_x", Unit::Newton, force.x)
                .text("Measured force on the tool, process X"),
            Quantity::new("tool.force_y", Unit::Newton, force.y)
                .text("Measured force on the tool, process Y"),
            Quantity::new("tool.force_z", Unit::Newton, force.z)
                .text("Measured force on the tool, process Z"),
        ];
        measured.into_iter().filter(|_| !self.is_idle())
    }

    fn loads(&self, time_s: f64) -> Loads {
        if self.is_idle() {
            return Loads::default();
        }
        Loads::from(Wrench::force(Attachment::Tool, self.force_n(time_s)))
    }
}

impl Process for Replay {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        self.loads(state.time_s)
    }

    fn commit(&mut self, state: &ToolState, _: &Loads, _: &ContactOutcomes, _dt: f64) {
        self.last_force_n = self.force_n(state.time_s);
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
    }

    fn static_loads(&self) -> Loads {
        self.loads(0.0)
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        Vec::new()
    }

    fn is_idle(&self) -> bool {
        Replay::is_idle(self)
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        if self.is_idle() {
            return Vec::new();
        }
        vec![("measured", Attachment::Tool, self.last_force_n)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_lie_on_straight_lines_and_stay_beyond_the_ends() {
        let force = ForceSamples {
            interval_s: 0.5,
            values: vec![1.0, 3.0, -1.0],
        };
        for (time, expected) in [
            (-1.0, 1.0),
            (0.0, 1.0),
            (0.25, 2.0),
            (0.75, 1.0),
            (9.0, -1.0),
        ] {
            assert_eq!(force.at(time), expected, "{time}");
        }
    }
}
