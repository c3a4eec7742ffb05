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
    pub(super) fn ends_cut(&self, at: &ToolPlace, passes: &Passes) -> bool {
        if self.cutter.centre_cutting && at.sinks {
            return true;
        }
        let lowest = self.engaged(at.place_m.z).next();
        lowest.is_some_and(|(layer, _)| self.dives(layer, passes))
    }

    /// Whether a flat end has come into a layer without cutting all of it, by more than hollow
    /// ground ends stand clear, or had until not longer ago than the stock is cut: what it took
    /// there earlier only the heights of the floor know.
    pub(super) fn dives(&self, layer: usize, passes: &Passes) -> bool {
        self.cutter.is_flat() && layer < self.stock().cut_by(passes.highest_m).start
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
        let dived_into = match self.cutter.is_flat() && !at.sinks {
            true => self.engaged(at.place_m.z).next().map(|(layer, _)| layer),
            false => None,
        };
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
                if !self.stock.block.contains(&place_m) {
                    continue;
                }
                let surface_m = self.passed_m(tooth, &place_m, passes);
                let (chip_m, share) = match dived_into {
                    None => (
                        self.end_chip_m(self.stock.nearest(&place_m), surface_m, at),
                        1.0,
                    ),
                    Some(layer) => {
                        let half_m = ray.outward * (0.5 * piece_m);
                        let share = self.left_share(layer, [place_m - half_m, place_m + half_m]);
                        (self.mean_chip_m(layer, &place_m, surface_m, at), share)
                    }
                };
                if chip_m > 0.0 && share > 0.0 {
                    *cuts = true;
                    loads.add_end(
                        &coefficients,
                        angle_rad,
                        [radius_m, piece_m * share],
                        chip_m,
                    );
                }
            }
        }
    }

    /// Which part of a way no longer than the grid's spacing lies in what is left of a layer.
    fn left_share(&self, layer: usize, ends_m: [Vector2<f64>; 2]) -> f64 {
        let [from, to] = ends_m.map(|end_m| self.stock.beyond_m(layer, &end_m));
        match (from > 0.0, to > 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (true, false) => from / (from - to),
            (false, true) => to / (to - from),
        }
    }

    /// How far an end stands below the surface by the nodes about a place that are left of a layer,
    /// m: the layer's outline is known better than by nodes, so those beyond it tell nothing.
    fn mean_chip_m(
        &self,
        layer: usize,
        place_m: &Vector2<f64>,
        surface_m: f64,
        at: &ToolPlace,
    ) -> f64 {
        let left = |node: usize| self.stock.layers()[layer].values()[node] > 0.0;
        let of_left = |value: &dyn Fn(usize) -> f64| {
            let value = |node| if left(node) { value(node) } else { 0.0 };
            self.stock.between_nodes(place_m, value)
        };
        let weight = of_left(&|_| 1.0);
        match weight > 0.0 {
            true => of_left(&|node| self.end_chip_m(node, surface_m, at)) / weight,
            false => 0.0,
        }
    }

    /// How far the end of a tooth stands below the surface at a node, m, of which earlier teeth of
    /// the last revolutions have left no more than a height.
    fn end_chip_m(&self, node: usize, passed_m: f64, at: &ToolPlace) -> f64 {
        let surface_m = self.floor_m[node].min(self.top_m[node]).min(passed_m);
        let chip_m = surface_m - at.place_m.z;
        // Below the block there is nothing to take.
        chip_m.min(surface_m - self.stock.block.least_m.z).max(0.0)
    }

    /// The lowest of the heights at which teeth of the last revolutions came by a place, m.
    fn passed_m(&self, tooth: usize, place_m: &Vector2<f64>, passes: &Passes) -> f64 {
        let teeth = self.cutter.teeth;
        let mut lowest_m = f64::INFINITY;
        for (index, (_, then_m)) in passes.earlier.iter().enumerate() {
            let before = (tooth + index + 1) % teeth;
            // What the tooth before did not stand over is the rim's from its height on.
            let rise_m = match index {
                0 => Some(0.0),
                _ => (self.cutter).tooth_rise_m(before, (place_m - then_m.xy()).norm()),
            };
            if let Some(rise_m) = rise_m {
                lowest_m = lowest_m.min(then_m.z + rise_m);
            }
        }
        lowest_m
    }
}
