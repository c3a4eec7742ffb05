//! Ends of the teeth of a cutter that sinks: edges from the axis to the rim.
//!
//! A tooth's end takes what lies between the tip's height and the lowest of the surfaces there: the
//! heights at which earlier teeth came by, the floor that is older, the stock's upper face. From
//! the height of the tooth before on upwards it is the rim that cuts. The chip is measured along
//! the axis; the force is that of a straight edge at a right angle to the spindle.

use super::cut::{LayeredCut, Passes, ToolPlace};
use crate::cutting::milling::earlier::Ray;
use crate::cutting::milling::slice::MillingLoads;
use nalgebra::Vector2;
use std::f64::consts::FRAC_PI_2;

/// An end is cut into pieces no longer than this part of the radius.
const LONGEST_PIECE: f64 = 1.0 / 24.0;

impl LayeredCut {
    /// Whether ends cut at a state: of a tool that is led down, or that swings into the floor.
    pub(super) fn ends_cut(&self, at: &ToolPlace) -> bool {
        let lowest = self.engaged(at.place_m.z).next();
        let dives = lowest.is_some_and(|(layer, _)| self.dives(layer, at.place_m.z));
        self.cutter.centre_cutting && at.sinks || dives
    }

    /// Whether a flat end has come into a layer without cutting all of it, by more than hollow
    /// ground ends stand clear: what it took there earlier only the heights of the floor know.
    pub(super) fn dives(&self, layer: usize, tip_m: f64) -> bool {
        self.cutter.is_flat() && layer < self.stock().cut_by(tip_m).start
    }

    /// Adds the forces of the ends; tells which teeth cut with theirs.
    pub(super) fn add_ends(
        &self,
        loads: &mut MillingLoads,
        at: &ToolPlace,
        passes: &Passes,
        in_cut: &mut [bool],
    ) {
        let coefficients = self.coefficients.of_straight_edge(FRAC_PI_2);
        for (tooth, cuts) in in_cut.iter_mut().enumerate() {
            let angle_rad = self.cutter.tooth_angle_rad(tooth, at.rotation_rad);
            let ray = Ray::at(angle_rad);
            // Beyond its flat end a round corner cuts as an edge that leans.
            let reach_m = self.cutter.tooth_radius_m(tooth) - self.cutter.corner_radius_m;
            if reach_m <= 0.0 {
                continue;
            }
            let longest_m = (LONGEST_PIECE * reach_m).min(self.stock.grid_m());
            let count = (reach_m / longest_m).ceil();
            let piece_m = reach_m / count;
            for k in 0..count as usize {
                let radius_m = piece_m * (k as f64 + 0.5);
                let place_m = at.place_m.xy() + ray.outward * radius_m;
                let chip_m = self.end_chip_m(tooth, &place_m, at, passes);
                if chip_m > 0.0 {
                    *cuts = true;
                    loads.add_end(&coefficients, angle_rad, [radius_m, piece_m], chip_m);
                }
            }
        }
    }

    /// How far the end of a tooth stands below the surface at a place, m.
    fn end_chip_m(
        &self,
        tooth: usize,
        place_m: &Vector2<f64>,
        at: &ToolPlace,
        passes: &Passes,
    ) -> f64 {
        if !self.stock.block.contains(place_m) {
            return 0.0;
        }
        let node = self.stock.nearest(place_m);
        let teeth = self.cutter.teeth;
        let mut surface_m = self.floor_m[node].min(self.top_m[node]);
        for (index, (_, then_m)) in passes.earlier.iter().enumerate() {
            let before = (tooth + index + 1) % teeth;
            // What the tooth before did not stand over is the rim's from its height on.
            let rise_m = match index {
                0 => Some(0.0),
                _ => (self.cutter).tooth_rise_m(before, (place_m - then_m.xy()).norm()),
            };
            if let Some(rise_m) = rise_m {
                surface_m = surface_m.min(then_m.z + rise_m);
            }
        }
        let chip_m = surface_m - at.place_m.z;
        // Below the block there is nothing to take.
        chip_m.min(surface_m - self.stock.block.least_m.z).max(0.0)
    }
}
