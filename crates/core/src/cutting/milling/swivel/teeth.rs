//! Stock as the teeth pass.

use super::cut::SwivelCut;
use super::way::turned_to;
use crate::cutting::milling::layered::stock::FAR;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, Vector3};

/// How far beyond a node's radius a body is looked at, in spacings, for what vibrates.
const MARGIN: f64 = 2.0;

impl SwivelCut {
    /// Cuts the stock by all of the motion.
    pub fn finish(&mut self) {
        if let Some((rotation_rad, _)) = self.tip.last() {
            self.cut_up_to(rotation_rad);
            let from_rad = self.cut_to_rad.unwrap_or(rotation_rad);
            self.cut_between([from_rad, rotation_rad]);
            self.cut_to_rad = Some(rotation_rad);
        }
    }

    /// Cuts by the motion up to a rotation, a whole number of pitches.
    pub(super) fn cut_up_to(&mut self, rotation_rad: f64) {
        let pitch_rad = self.cutter.pitch_rad();
        let mut from_rad = *self.cut_to_rad.get_or_insert(rotation_rad);
        while from_rad + pitch_rad <= rotation_rad {
            self.cut_between([from_rad, from_rad + pitch_rad]);
            from_rad += pitch_rad;
        }
        self.cut_to_rad = Some(from_rad);
    }

    /// Where the tool stood at a rotation, its axes turned from some but not about its axis.
    fn pose(&self, rotation_rad: f64, from: &Rotation3<f64>) -> Isometry3<f64> {
        let direction = self.direction.at(rotation_rad).displacement_m;
        let axes = turned_to(from, &Unit::new_normalize(direction));
        let tip_m = self.tip.at(rotation_rad).displacement_m;
        Isometry3::from_parts(Translation3::from(tip_m), axes.into())
    }

    /// Teeth have turned by a pitch at most: of each direction from the axis at most one has come
    /// by.
    fn cut_between(&mut self, [from_rad, to_rad]: [f64; 2]) {
        let half_rad = 0.5 * (to_rad - from_rad);
        if half_rad <= 0.0 {
            return;
        }
        let axes = self.axes_at(from_rad + half_rad);
        let middle = self.pose(from_rad + half_rad, &axes);
        let cutter = self.cutter;
        let (profile, pitch_rad) = (cutter.profile(), cutter.pitch_rad());
        let lag = cutter.lag_rad_per_m();
        let (known_m, far_m) = (self.stock.known_m(), FAR * self.stock.grid_m());
        // By how much a node may lie nearer to a tooth that passes it than to the body midway.
        let ends = [from_rad, to_rad].map(|at| self.pose(at, &axes));
        let reach_m = self.stock.block.most_m - self.stock.block.least_m;
        let moved_m = |end: &Isometry3<f64>| {
            let by = end.translation.vector - middle.translation.vector;
            by.norm() + (end.rotation * middle.rotation.inverse()).angle() * reach_m.norm()
        };
        let nearer_m = 1.1 * moved_m(&ends[0]).max(moved_m(&ends[1]))
            + cutter.runout.offset_m.abs()
            + MARGIN * self.stock.grid_m();
        let around_m = known_m + nearer_m;
        let Some(bounds) = self.stock.reached_by(&middle, cutter.radius_m, around_m) else {
            return;
        };
        let middle_from_work = middle.inverse();
        for at in self.stock.each(bounds) {
            let node = self.stock.node(at);
            let value_m = f64::from(self.stock.values()[node]);
            if value_m <= -known_m {
                continue;
            }
            let place = Point3::from(self.stock.place_at(at));
            let seen = middle_from_work * place;
            let body_m = profile.outside_m(seen.x.hypot(seen.y), seen.z);
            if body_m > around_m || body_m - nearer_m >= value_m {
                continue;
            }
            // tooth_angle = rotation - pitch tooth, and its edge lags.
            let tooth_0_rad = seen.x.atan2(seen.y) + lag * seen.z.max(0.0);
            let teeth = ((from_rad - tooth_0_rad) / pitch_rad).ceil();
            let then_rad = tooth_0_rad + pitch_rad * teeth;
            if then_rad >= to_rad {
                continue;
            }
            let tooth = teeth.rem_euclid(cutter.teeth as f64) as usize;
            let there = self.pose(then_rad, &axes).inverse_transform_point(&place);
            let runs_out_m = cutter.tooth_radius_m(tooth) - cutter.radius_m;
            let off_m = there.x.hypot(there.y) - runs_out_m;
            let beyond_m = profile.outside_m(off_m, there.z);
            if beyond_m < known_m {
                let value = self.stock.value_mut(node);
                *value = value.min(beyond_m.max(-far_m) as f32);
            }
        }
    }

    /// Axes at a rotation from which teeth are counted. Which way they point about the tool's axis
    /// is told by the axes of the state last committed, turned back.
    fn axes_at(&self, rotation_rad: f64) -> Rotation3<f64> {
        let direction: Vector3<f64> = self.direction.at(rotation_rad).displacement_m;
        turned_to(&self.axes, &Unit::new_normalize(direction))
    }
}
