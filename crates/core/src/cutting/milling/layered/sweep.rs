//! Stock, walls and floor as the teeth pass.

use super::arc::ToothArc;
use super::cut::LayeredCut;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Arcs by which the stock is cut are no longer, rad.
const LONGEST_ARC_RAD: f64 = 0.15;

impl LayeredCut {
    /// Cuts by the motion up to a rotation.
    pub(super) fn cut_up_to(&mut self, rotation_rad: f64) {
        let (from_rad, from_m) = match self.cut_to {
            Some(from) if from.0 < rotation_rad => from,
            Some(_) => return,
            None => {
                self.cut_to = Some((rotation_rad, self.trace.at(rotation_rad).displacement_m));
                return;
            }
        };
        let parts = ((rotation_rad - from_rad) / LONGEST_ARC_RAD)
            .ceil()
            .max(1.0);
        let mut before = (from_rad, from_m);
        for part in 1..=parts as usize {
            let at_rad = from_rad + (rotation_rad - from_rad) * part as f64 / parts;
            let now = (at_rad, self.trace.at(at_rad).displacement_m);
            self.cut_between(before, now);
            before = now;
        }
        self.cut_to = Some(before);
    }

    fn cut_between(&mut self, from: (f64, Vector3<f64>), to: (f64, Vector3<f64>)) {
        let tip_m = to.1.z;
        let largest_m = self.cutter.radius_m + 4.0 * self.stock.grid_m();
        if tip_m >= self.stock.block.most_m.z
            || self.stock.block.outside_m(&to.1.xy()) > 1.1 * largest_m
        {
            return;
        }
        let profile = self.cutter.profile();
        let layers = self.stock.taken_by(tip_m, &profile);
        let before = self.stock.taken_by(from.1.z, &profile).start;
        // Of a flat end that dives all is gone below it, too.
        if self.cutter.centre_cutting || profile.is_flat() {
            for layer in layers.start..before {
                let middle_m = self.stock.layers()[layer].middle_m();
                let radius_m = profile.radius_at_m(middle_m - tip_m);
                self.stock.cut_disc(layer..layer + 1, &to.1.xy(), radius_m);
            }
        }
        let earlier_m = self.trace.at(to.0 - self.cutter.pitch_rad()).displacement_m;
        let travel_m = (earlier_m - to.1).xy().norm();
        let lag = self.cutter.lag_rad_per_m();
        for tooth in 0..self.cutter.teeth {
            let arc = |height_m: f64, radius_m: f64| {
                let angle_rad =
                    self.cutter.tooth_angle_rad(tooth, from.0) - lag * (height_m - tip_m);
                ToothArc::new(
                    [angle_rad % TAU, angle_rad % TAU + (to.0 - from.0)],
                    [from.1.xy(), to.1.xy()],
                    radius_m,
                )
            };
            for layer in layers.clone() {
                let one = &self.stock.layers()[layer];
                let height_m = match profile.is_flat() {
                    true => 0.5 * (one.bottom_m.max(tip_m) + one.top_m),
                    false => one.middle_m(),
                };
                let reach_m = self.cutter.tooth_reach_m(tooth, height_m - tip_m);
                let arc = arc(height_m, reach_m);
                self.stock.cut_arc(layer, &arc, travel_m);
                self.walls.cut(layer, &arc);
            }
            let rim_m = self.cutter.tooth_radius_m(tooth);
            self.sweep_floor(tooth, &arc(tip_m, rim_m), [from.1.z, tip_m]);
        }
    }

    /// The end of a tooth, from the axis to its rim, has run over the floor.
    fn sweep_floor(&mut self, tooth: usize, arc: &ToothArc, [from_m, tip_m]: [f64; 2]) {
        let range = self.stock.between(arc.bounds([0.0, arc.radius_m]));
        for node in self.stock.each(range) {
            // Most teeth run over a floor that lies as deep already.
            if self.floor_m[node] <= tip_m {
                continue;
            }
            let place = self.stock.place(node);
            let Some((share, axis_m)) = arc.at(&place) else {
                continue;
            };
            if self.cutter.is_flat() {
                if (place - axis_m).norm_squared() <= arc.radius_m * arc.radius_m {
                    self.floor_m[node] = tip_m;
                }
            } else if let Some(rise_m) = self.cutter.tooth_rise_m(tooth, (place - axis_m).norm()) {
                let then_m = from_m + (tip_m - from_m) * share.clamp(0.0, 1.0);
                self.floor_m[node] = self.floor_m[node].min(then_m + rise_m);
            }
        }
    }
}
