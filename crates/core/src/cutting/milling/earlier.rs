//! Where an earlier tooth left the ray on which a tooth now stands.
//!
//! With the axis of now as the origin, the earlier tooth's tip ran on
//! `P(δ) = o(δ) + r n(φ + δ)`: o is where its axis stood, n the direction of a tooth, δ how much
//! further than φ it had turned. It crossed the ray along n(φ) where `o·t + r sin δ = 0`, t being
//! the direction of motion there, and left material beyond `o·n + r cos δ`. While the tip never
//! moves backwards, `r + o'·t > 0`, there is one crossing and Newton's method finds it to rounding.
//! A path that loops is searched for all its crossings, of which the outermost counts.

use super::cutter::Cutter;
use super::memory::{Passed, Trace};
use nalgebra::{Matrix3, Vector2, Vector3};
use std::f64::consts::FRAC_PI_2;

/// An earlier pass as the teeth of now see it.
#[derive(Debug, Clone, Copy)]
pub(super) struct EarlierPass<'a> {
    pub axis: Axis<'a>,
    /// Rotation at which the earlier tooth had the angle of now, rad.
    pub then_rad: f64,
    /// Displacement of the axis now, m.
    pub now_m: Vector2<f64>,
    /// Way of the nominal axis since then, along x, m.
    pub fed_m: f64,
    pub feed_m_per_rad: f64,
    /// How far to either side of φ crossings are looked for, rad.
    pub reach_rad: f64,
}

/// How the earlier axis was displaced.
#[derive(Debug, Clone, Copy)]
pub(super) enum Axis<'a> {
    Moved(&'a Trace),
    Steady(Vector2<f64>),
    /// Its direction changes: where it passes a height, less where it stands now.
    Swivelled(Swivelled<'a>),
}

/// A tool that moves and whose axis turns, from the frame of the tool of now.
#[derive(Debug, Clone, Copy)]
pub(super) struct Swivelled<'a> {
    /// Places of its tip, and directions of its axis.
    pub tip: &'a Trace,
    pub direction: &'a Trace,
    pub now_from_work: Matrix3<f64>,
    pub tip_now_m: Vector3<f64>,
    /// Above the tip of now, along its axis.
    pub height_m: f64,
}

impl Swivelled<'_> {
    /// Where the axis passed the height at a rotation, across the axis of now, and its change with
    /// rotation.
    fn at(&self, rotation_rad: f64) -> (Vector2<f64>, Vector2<f64>) {
        let (tip, direction) = (self.tip.at(rotation_rad), self.direction.at(rotation_rad));
        let off_m = self.now_from_work * (tip.displacement_m - self.tip_now_m);
        let leaning = self.now_from_work * direction.displacement_m;
        let above_m = (self.height_m - off_m.z) / leaning.z;
        let moved = tip.displacement_m_per_rad + direction.displacement_m_per_rad * above_m;
        let rate = self.now_from_work * moved;
        let passed_m = off_m + leaning * above_m;
        (passed_m.xy(), rate.xy() - leaning.xy() * rate.z / leaning.z)
    }
}

/// An earlier pass of a tool that turns, in the frame of the tool of now.
#[derive(Debug, Clone, Copy)]
pub(super) struct SwivelPass {
    pub then_rad: f64,
    pub tip_m: Vector3<f64>,
    pub direction: Vector3<f64>,
}

impl SwivelPass {
    /// Where its axis passed a height above the tip of now.
    pub fn off_m(&self, height_m: f64) -> Vector2<f64> {
        let above_m = (height_m - self.tip_m.z) / self.direction.z;
        (self.tip_m + self.direction * above_m).xy()
    }

    /// How far above the tip of then a place stands along the axis of then, m: at one height of a
    /// tool that has turned since, one side stands higher than the other.
    pub fn above_m(&self, place_m: &Vector3<f64>) -> f64 {
        (place_m - self.tip_m).dot(&self.direction)
    }
}

/// Where an earlier tooth stood when it had the angle of now.
pub(super) struct Then<'a> {
    pub axis: Axis<'a>,
    pub then_rad: f64,
    /// Axis then less axis now, across it, m.
    pub off_m: Vector2<f64>,
    /// How far above the tip of then the height stands that is asked for, m.
    pub above_m: f64,
}

/// What the tooth of now asks of the earlier ones.
pub(super) struct Asked<'a> {
    pub cutter: &'a Cutter,
    pub tooth: usize,
    pub ray: &'a Ray,
    /// Radius on which it runs.
    pub reach_m: f64,
    /// What is taken from the places of `Axis::Moved`.
    pub now_m: Vector2<f64>,
    /// Fastest motion of the axis.
    pub speed_m_per_rad: f64,
}

impl Asked<'_> {
    /// How far from the axis the surface begins that earlier teeth have left, m: those of one, two
    /// and more pitches before.
    pub fn surface_m<'a>(&self, passes: impl Iterator<Item = Then<'a>>) -> f64 {
        let (cutter, ray, speed) = (self.cutter, self.ray, self.speed_m_per_rad);
        let (teeth, pitch_rad) = (cutter.teeth, cutter.pitch_rad());
        // What stands under a flat end is not the corner's.
        let mut surface_m = match cutter.is_flat() {
            true => 0.0_f64,
            false => cutter.profile().end_radius_m(),
        };
        for (index, then) in passes.enumerate() {
            let m = index + 1;
            if then.above_m < 0.0 {
                continue;
            }
            let before = (self.tooth + teeth - m % teeth) % teeth;
            let radius_m = cutter.tooth_reach_m(before, then.above_m);
            if self.misses(&then.off_m, radius_m) {
                continue;
            }
            // |δ| <= π/2 (|o| + V |δ|)/r bounds where the ray is crossed.
            let slack = 1.0 - FRAC_PI_2 * speed / radius_m;
            if slack > 0.5 {
                let shift_rad = FRAC_PI_2 * then.off_m.norm() / radius_m / slack;
                if radius_m + then.off_m.dot(&ray.outward) + speed * shift_rad <= surface_m {
                    continue;
                }
            }
            let pass = EarlierPass {
                axis: then.axis,
                then_rad: then.then_rad,
                now_m: self.now_m,
                fed_m: 0.0,
                feed_m_per_rad: 0.0,
                reach_rad: (pitch_rad * m as f64).min(FRAC_PI_2),
            };
            if let Some(left_m) = pass.left_m(radius_m, ray) {
                surface_m = surface_m.max(left_m);
            }
            if surface_m >= self.reach_m {
                break;
            }
        }
        surface_m
    }

    /// Whether an earlier tooth on a radius cannot have come by the ray: the axis stood further
    /// aside than it reached.
    fn misses(&self, off_m: &Vector2<f64>, radius_m: f64) -> bool {
        let beside_m = off_m.dot(&self.ray.along).abs();
        !self.cutter.is_flat() && beside_m - self.speed_m_per_rad * FRAC_PI_2 > radius_m
    }
}

/// A direction from the axis and the one in which a tooth there moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub outward: Vector2<f64>,
    pub along: Vector2<f64>,
}

impl Ray {
    /// Of a tooth at φ.
    pub fn at(angle_rad: f64) -> Ray {
        let (sin, cos) = angle_rad.sin_cos();
        Ray {
            outward: Vector2::new(sin, cos),
            along: Vector2::new(cos, -sin),
        }
    }
}

/// The step of Newton's method that is the last: it leaves an error of the order of its square.
const LAST_STEP_RAD: f64 = 1e-5;
const MOST_STEPS: usize = 12;
/// Part of its undisturbed speed below which a tip counts as nearly turning back.
const SLOW: f64 = 0.1;
/// Intervals in which the crossings of a path that loops are looked for.
const INTERVALS: usize = 256;

impl EarlierPass<'_> {
    /// The axis then minus the axis now, and its change with rotation.
    fn offset(&self, shift_rad: f64) -> (Vector2<f64>, Vector2<f64>) {
        let (displacement_m, rate) = match self.axis {
            Axis::Steady(displacement_m) => (displacement_m, Vector2::zeros()),
            Axis::Moved(trace) => {
                let Passed {
                    displacement_m,
                    displacement_m_per_rad,
                } = trace.at(self.then_rad + shift_rad);
                (displacement_m.xy(), displacement_m_per_rad.xy())
            }
            Axis::Swivelled(swivelled) => swivelled.at(self.then_rad + shift_rad),
        };
        let fed_m = self.feed_m_per_rad * shift_rad - self.fed_m;
        (
            displacement_m - self.now_m + Vector2::new(fed_m, 0.0),
            rate + Vector2::new(self.feed_m_per_rad, 0.0),
        )
    }

    /// No crossing lies further from the axis of now than this, m, by the places that the axis has
    /// been to: a crossing's shift has `r |sin δ| <= |o|`, and its distance is `o·n + r cos δ`.
    pub fn at_most_m(&self, radius_m: f64, ray: &Ray) -> f64 {
        let Axis::Moved(trace) = self.axis else {
            return f64::INFINITY;
        };
        let across = ray.outward.x.abs();
        let off_m =
            trace.furthest_from_m(self.now_m) + self.fed_m + self.feed_m_per_rad * FRAC_PI_2;
        // asin x <= x π/2
        let shift_rad = FRAC_PI_2 * (off_m / radius_m).min(1.0);
        let moved_m = trace.furthest_m(ray.outward) - self.now_m.dot(&ray.outward);
        radius_m + moved_m - self.fed_m * ray.outward.x + self.feed_m_per_rad * shift_rad * across
    }

    /// Distance from the axis of now beyond which a tooth at `radius_m` left material on a ray;
    /// `None` if it did not cross it.
    pub fn left_m(&self, radius_m: f64, ray: &Ray) -> Option<f64> {
        // Where a tool that does not vibrate crossed it, but for terms of third order.
        let across_m = ray.along.x * self.fed_m;
        let speed_m = radius_m + ray.along.x * self.feed_m_per_rad;
        let mut shift = (across_m / speed_m).clamp(-self.reach_rad, self.reach_rad);
        for _ in 0..MOST_STEPS {
            let (offset_m, rate) = self.offset(shift);
            let (sin, cos) = shift.sin_cos();
            let speed = radius_m * cos + rate.dot(&ray.along);
            if speed < SLOW * radius_m {
                break;
            }
            let step = -(offset_m.dot(&ray.along) + radius_m * sin) / speed;
            if step.abs() < LAST_STEP_RAD {
                let outward = rate.dot(&ray.outward) - radius_m * sin;
                return Some(offset_m.dot(&ray.outward) + radius_m * cos + outward * step);
            }
            shift += step;
            if shift.abs() > self.reach_rad {
                break;
            }
        }
        self.outermost_m(radius_m, ray)
    }

    fn distance_m(&self, shift: f64, radius_m: f64, ray: &Ray) -> f64 {
        self.offset(shift).0.dot(&ray.outward) + radius_m * shift.cos()
    }

    /// The outermost of all crossings.
    fn outermost_m(&self, radius_m: f64, ray: &Ray) -> Option<f64> {
        let beside_m = |shift: f64| self.offset(shift).0.dot(&ray.along) + radius_m * shift.sin();
        let at = |i: usize| self.reach_rad * (2.0 * i as f64 / INTERVALS as f64 - 1.0);
        let mut outermost: Option<f64> = None;
        let mut low = (at(0), beside_m(at(0)));
        for i in 1..=INTERVALS {
            let high = (at(i), beside_m(at(i)));
            if (low.1 <= 0.0) != (high.1 <= 0.0) {
                let shift = bisect(beside_m, low, high.0);
                let left_m = self.distance_m(shift, radius_m, ray);
                outermost = Some(outermost.map_or(left_m, |known| known.max(left_m)));
            }
            low = high;
        }
        outermost
    }
}

/// Where a function changes sign, to rounding.
fn bisect(of: impl Fn(f64) -> f64, (mut low, at_low): (f64, f64), mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if (of(middle) <= 0.0) == (at_low <= 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use std::f64::consts::TAU;

    /// Whatever the axis has done, no crossing lies further out than the bound by which passes are
    /// left out; for small motion the bound is no more than the box of the motion away.
    #[test]
    fn verify_no_pass_reaches_beyond_its_bound() {
        let (radius_m, feed_m) = (6e-3, 0.1e-3);
        for (turn, size_m) in [(1.0, 5e-6), (2.3, 60e-6), (3.7, 0.8e-3), (0.6, 3e-3)] {
            let mut trace = Trace::new(20.0, Vector3::zeros());
            let at = |k: u32| 0.02 * f64::from(k);
            for k in 0..1200 {
                let wave = Vector3::new((turn * at(k)).sin(), (1.7 * turn * at(k)).cos(), 0.0);
                trace.commit(at(k), size_m * wave);
            }
            let mut nearest_m = f64::INFINITY;
            for k in 0..4000_u32 {
                let now_rad = 14.0 + 0.0023 * f64::from(k);
                let m = f64::from(1 + k % 8);
                let pass = EarlierPass {
                    axis: Axis::Moved(&trace),
                    then_rad: now_rad - 0.5 * TAU / 2.0 * m * 0.5,
                    now_m: trace.at(now_rad).displacement_m.xy(),
                    fed_m: feed_m * m,
                    feed_m_per_rad: feed_m * 4.0 / TAU,
                    reach_rad: FRAC_PI_2,
                };
                let (sin, cos) = (0.37 * f64::from(k)).sin_cos();
                let ray = Ray {
                    outward: Vector2::new(sin, cos),
                    along: Vector2::new(cos, -sin),
                };
                let most_m = pass.at_most_m(radius_m, &ray);
                if let Some(left_m) = pass.left_m(radius_m, &ray) {
                    assert!(left_m <= most_m + 1e-12, "{size_m} {k}: {left_m} {most_m}");
                    nearest_m = nearest_m.min(most_m - left_m);
                }
            }
            assert!(nearest_m < 5.0 * size_m, "{size_m}: {nearest_m}");
        }
    }
}
