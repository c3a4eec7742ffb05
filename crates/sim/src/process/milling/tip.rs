//! Where the tip of a milling tool stands, with modes of tool and workpiece: counted from the path,
//! in the milling frame.

use nalgebra::Vector3;

use super::{CutState, Milling, MillingCut, report};
use crate::process::ToolState;
use crate::process::modes::{Modes, TipMotion};
use crate::process::quantity::Quantity;

impl Milling {
    /// Where the cut stands a time ahead of a state.
    pub(super) fn cut_state(&self, state: &ToolState, ahead_s: f64) -> CutState {
        let s = &self.setup;
        let (deflection_m, rate) = self.deflection(state);
        let time_s = state.time_s + ahead_s;
        let share = s.depth_share(s.distance_m(time_s));
        let mut displacement_m = deflection_m + rate * ahead_s;
        // On the wedge the stock's face is lower, which for the edge is the same as a tool that
        // stands higher.
        displacement_m.z += s.parameters.stock.top_m * (1.0 - share);
        if !s.parameters.regeneration {
            // The steady tool is deflected by its share of the force only.
            displacement_m += s.mean_deflection_m * (1.0 - share);
        }
        CutState {
            rotation_rad: self.rotation_rad(time_s),
            displacement_m,
            displacement_m_per_rad: rate / s.spec.spindle_rad_s,
        }
    }

    /// What is recorded of the step last committed. Chips are looked at in recorded steps alone;
    /// what a tooth meets was left half a pitch before, so that it is the same after the step.
    pub(super) fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let loads = self.last.at.map(|at| self.cut.evaluate(&at));
        report::quantities(&self.setup, &self.last, loads)
    }

    /// Deflection of the arm's tool point from its path and its rate, milling frame.
    pub(super) fn arm_motion(&self, state: &ToolState) -> TipMotion {
        let s = &self.setup;
        let feed = Vector3::x() * s.spec.feed_m_per_s;
        let moved = s.in_milling(&state.tool.displacement_m);
        let rate = s.in_milling(&state.tool.velocity_m_per_s);
        TipMotion {
            deflection_m: self.start_offset_m + moved - feed * state.time_s,
            rate_m_per_s: rate - feed,
        }
    }

    /// Modes as they start: at rest under the mean force where the cut is under way.
    pub(super) fn place_modes(&mut self, step_s: f64) {
        let s = &self.setup;
        let axes = [&s.milling_from_tool, &s.milling_from_world];
        self.modes = Modes::new(&s.spec.attached, axes, step_s);
        let force_n = if s.starts_in_cut() {
            s.mean_load.0
        } else {
            Vector3::zeros()
        };
        let foot = TipMotion {
            deflection_m: self.start_offset_m,
            ..TipMotion::default()
        };
        self.modes.rest(&foot, &force_n);
    }

    /// Modes over a step under the force of the cut.
    pub(super) fn move_modes(&mut self, state: &ToolState, force_n: &Vector3<f64>) {
        let arm = self.arm_motion(state);
        let axes = state.world_from_tool.rotation.to_rotation_matrix();
        (self.modes).turn(&(self.setup.milling_from_world * axes.matrix()));
        self.modes_m.clear();
        self.modes_m.extend(self.modes.each_m(&arm));
        self.modes.advance(&arm, force_n);
    }
}

/// A rule of the cut that vibration breaks.
pub(super) fn broken_rule(cut: &MillingCut, at: &CutState) -> Option<&'static str> {
    if cut.turns_back(at) {
        return Some(
            "teeth in the stock move forwards; here one moves backwards: paths of teeth loop",
        );
    }
    (cut.is_off_the_surface(at)).then_some("a tool stays within its radius of the nominal surface")
}
