//! The outline of an end mill in a plane through its axis: flat, bull-nose or ball.
//!
//! From the rim of a flat end, of radius R − r_c, an arc of the corner radius r_c leads up to the
//! upright part of radius R: flat at r_c = 0, a ball at r_c = R. At a height h above the tip, below
//! r_c, the edge stands on the radius `R − r_c + r_c sin κ`, where `h = r_c (1 − cos κ)` and κ, the
//! axial immersion angle, is that between the outward normal and the axis down to the tip: 0 at the
//! end, 90 degrees at the upright part (`engin2001`).

use super::cutter::Cutter;

/// Outline of the body that the edges of a turning cutter run on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// R, m.
    pub radius_m: f64,
    /// r_c, m; 0 of a flat cutter, R of a ball.
    pub corner_radius_m: f64,
}

/// Sine and cosine of the axial immersion angle κ of a piece of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lean {
    pub sin: f64,
    pub cos: f64,
}

impl Lean {
    /// Of an edge on a cylinder.
    pub const UPRIGHT: Self = Self { sin: 1.0, cos: 0.0 };

    /// Whether the surface is nearer to level than to upright.
    pub(super) fn is_shallow(&self) -> bool {
        self.cos > self.sin
    }
}

impl Profile {
    pub fn flat(radius_m: f64) -> Self {
        Self {
            radius_m,
            corner_radius_m: 0.0,
        }
    }

    pub fn ball(radius_m: f64) -> Self {
        Self {
            radius_m,
            corner_radius_m: radius_m,
        }
    }

    pub fn is_flat(&self) -> bool {
        self.corner_radius_m == 0.0
    }

    /// Radius of the flat end, m: 0 of a ball.
    pub fn end_radius_m(&self) -> f64 {
        self.radius_m - self.corner_radius_m
    }

    /// Radius at a height above the tip, m.
    pub fn radius_at_m(&self, height_m: f64) -> f64 {
        let corner_m = self.corner_radius_m;
        if height_m >= corner_m || self.is_flat() {
            return self.radius_m;
        }
        let below_m = corner_m - height_m.max(0.0);
        self.end_radius_m() + (corner_m * corner_m - below_m * below_m).sqrt()
    }

    /// κ at a height above the tip, rad.
    pub fn axial_angle_rad(&self, height_m: f64) -> f64 {
        if height_m >= self.corner_radius_m {
            return std::f64::consts::FRAC_PI_2;
        }
        (1.0 - height_m.max(0.0) / self.corner_radius_m).acos()
    }

    /// How high above the tip the outline stands at a distance from the axis, m; `None` beyond the
    /// rim.
    pub fn rise_m(&self, distance_m: f64) -> Option<f64> {
        if distance_m > self.radius_m {
            return None;
        }
        let beyond_m = (distance_m - self.end_radius_m()).max(0.0);
        let corner_m = self.corner_radius_m;
        Some(corner_m - (corner_m * corner_m - beyond_m * beyond_m).max(0.0).sqrt())
    }

    /// How far a place at a distance from the axis and a height above the tip lies outside of the
    /// body, m: negative within; the body goes on upwards.
    pub fn outside_m(&self, distance_m: f64, height_m: f64) -> f64 {
        let beside_m = distance_m - self.end_radius_m();
        let below_m = self.corner_radius_m - height_m;
        match beside_m > 0.0 && below_m > 0.0 {
            true => beside_m.hypot(below_m) - self.corner_radius_m,
            false => (distance_m - self.radius_m).max(-height_m),
        }
    }

    /// cos κ of the outline at a distance from the axis: 1 on the flat end, 0 at the rim.
    pub fn cos_at(&self, distance_m: f64) -> f64 {
        let beyond_m = (distance_m - self.end_radius_m()).max(0.0);
        if beyond_m == 0.0 {
            return 1.0;
        }
        let sin = (beyond_m / self.corner_radius_m).min(1.0);
        (1.0 - sin * sin).sqrt()
    }

    /// Height of the cusp that two passes this far apart leave between them on a level floor, m:
    /// with s = distance less the flat end's diameter `r_c − √(r_c² − s²/4)`, some s²/8r_c. `None`
    /// where they stand apart by more than the diameter.
    pub fn cusp_m(&self, apart_m: f64) -> Option<f64> {
        self.rise_m(0.5 * apart_m)
    }
}

impl Cutter {
    pub fn profile(&self) -> Profile {
        Profile {
            radius_m: self.radius_m,
            corner_radius_m: self.corner_radius_m,
        }
    }

    pub fn is_flat(&self) -> bool {
        self.corner_radius_m == 0.0
    }

    /// Radius on which a tooth runs at a height above the tip, m: its runout moves all of its edge.
    pub fn tooth_reach_m(&self, tooth: usize, height_m: f64) -> f64 {
        let rim_m = self.tooth_radius_m(tooth);
        if self.is_flat() {
            return rim_m;
        }
        (self.profile().radius_at_m(height_m) + (rim_m - self.radius_m)).max(0.0)
    }

    /// How high above the tip the edge of a tooth stands at a distance from the axis, m; `None`
    /// beyond its rim.
    pub fn tooth_rise_m(&self, tooth: usize, distance_m: f64) -> Option<f64> {
        let rim_m = self.tooth_radius_m(tooth);
        if self.is_flat() {
            return (distance_m <= rim_m).then_some(0.0);
        }
        self.profile().rise_m(distance_m - (rim_m - self.radius_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Radius, rise, κ and their slopes belong together, from flat ends to balls.
    #[test]
    fn verify_outline_is_an_arc_between_end_and_rim() {
        for share in [0.1, 0.37, 0.8, 1.0] {
            let profile = Profile {
                radius_m: 6e-3,
                corner_radius_m: 6e-3 * share,
            };
            let corner = profile.corner_radius_m;
            for k in 1..100 {
                let height_m = corner * f64::from(k) / 100.0;
                let radius_m = profile.radius_at_m(height_m);
                // On a circle about the corner's middle.
                let off = (radius_m - profile.end_radius_m()).hypot(height_m - corner);
                assert!((off - corner).abs() < 1e-15);
                let rise_m = profile.rise_m(radius_m).expect("within the rim");
                assert!((rise_m - height_m).abs() < 1e-15);
                let kappa = profile.axial_angle_rad(height_m);
                assert!((kappa.cos() - profile.cos_at(radius_m)).abs() < 1e-12);
                let slope = (profile.radius_at_m(height_m + 1e-9)
                    - profile.radius_at_m(height_m - 1e-9))
                    / 2e-9;
                assert!((slope * kappa.tan() - 1.0).abs() < 1e-4, "{share} {k}");
            }
            assert_eq!(profile.rise_m(6.001e-3), None);
            assert_eq!(profile.radius_at_m(corner), 6e-3);
        }
        assert_eq!(Profile::flat(6e-3).radius_at_m(0.0), 6e-3);
        assert_eq!(Profile::flat(6e-3).rise_m(6e-3), Some(0.0));
    }

    /// A ball of 5 mm, lines 0.5 mm apart: 6.25 um by s²/8R, 6.254 um exactly.
    #[test]
    fn verify_cusp_of_a_ball() {
        let cusp_m = Profile::ball(5e-3).cusp_m(0.5e-3).expect("they meet");
        assert!((cusp_m - 6.253911e-6).abs() < 1e-11, "{cusp_m}");
    }
}
