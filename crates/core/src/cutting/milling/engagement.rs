//! Where teeth meet material.

use super::MillingError;
use super::cutter::Cutter;
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// Angles between which teeth cut, measured as φ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engagement {
    /// φ_st, rad.
    pub entry_rad: f64,
    /// φ_ex, rad, larger than the entry.
    pub exit_rad: f64,
}

impl Engagement {
    /// A full slot, 0 to π.
    pub const SLOT: Self = Self {
        entry_rad: 0.0,
        exit_rad: PI,
    };

    /// Up-milling with radial depth `radial_depth_m`.
    ///
    /// # Errors
    /// If the radial depth is not positive or exceeds the diameter.
    pub fn up(radial_depth_m: f64, diameter_m: f64) -> Result<Self, MillingError> {
        check_depth(radial_depth_m, diameter_m)?;
        Ok(Self {
            entry_rad: 0.0,
            exit_rad: (1.0 - 2.0 * radial_depth_m / diameter_m).acos(),
        })
    }

    /// Down-milling with radial depth `radial_depth_m`.
    ///
    /// # Errors
    /// If the radial depth is not positive or exceeds the diameter.
    pub fn down(radial_depth_m: f64, diameter_m: f64) -> Result<Self, MillingError> {
        check_depth(radial_depth_m, diameter_m)?;
        Ok(Self {
            entry_rad: (2.0 * radial_depth_m / diameter_m - 1.0).acos(),
            exit_rad: PI,
        })
    }

    /// Whether a tooth at φ (rad, any turn) cuts.
    pub fn contains(&self, angle_rad: f64) -> bool {
        let past = (angle_rad - self.entry_rad).rem_euclid(TAU);
        past < self.exit_rad - self.entry_rad
    }

    /// Parts of the interval [from, to] (rad, not wrapped) in which a tooth cuts.
    pub fn overlaps(&self, from_rad: f64, to_rad: f64) -> impl Iterator<Item = (f64, f64)> + use<> {
        let Self {
            entry_rad,
            exit_rad,
        } = *self;
        let first = ((from_rad - exit_rad) / TAU).ceil() as i64;
        let last = ((to_rad - entry_rad) / TAU).floor() as i64;
        (first..=last).filter_map(move |turn| {
            let shift = TAU * turn as f64;
            let low = from_rad.max(entry_rad + shift);
            let high = to_rad.min(exit_rad + shift);
            (high > low).then_some((low, high))
        })
    }

    /// The stock that gives this engagement to a tool on its nominal path with axis at y = 0,
    /// unbounded along x.
    pub fn stock(&self, cutter: &Cutter, axial_depth_m: f64) -> Stock {
        Stock {
            x_min_m: f64::NEG_INFINITY,
            x_max_m: f64::INFINITY,
            y_min_m: bound(cutter.radius_m, self.exit_rad, PI, f64::NEG_INFINITY),
            y_max_m: bound(cutter.radius_m, self.entry_rad, 0.0, f64::INFINITY),
            top_m: axial_depth_m,
        }
    }
}

/// Lateral face of the stock where teeth enter or leave at `angle`; none if they do so on the wall
/// they make.
fn bound(radius_m: f64, angle: f64, wall_angle: f64, none: f64) -> f64 {
    if (angle - wall_angle).abs() < 1e-12 {
        none
    } else {
        radius_m * angle.cos()
    }
}

fn check_depth(radial_depth_m: f64, diameter_m: f64) -> Result<(), MillingError> {
    if radial_depth_m > 0.0 && radial_depth_m <= diameter_m {
        return Ok(());
    }
    Err(MillingError::RadialDepth {
        radial_depth_m,
        diameter_m,
    })
}

/// A block of stock in the milling frame. Its floor is where the tool's tip stands; bounds may be
/// infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stock {
    pub x_min_m: f64,
    pub x_max_m: f64,
    pub y_min_m: f64,
    pub y_max_m: f64,
    /// Height of the upper face above the nominal floor, the nominal axial depth of cut, m.
    pub top_m: f64,
}

impl Stock {
    /// Whether a point (x, y) lies within the faces.
    pub fn contains(&self, point_m: Vector2<f64>) -> bool {
        (self.x_min_m..=self.x_max_m).contains(&point_m.x)
            && (self.y_min_m..=self.y_max_m).contains(&point_m.y)
    }

    /// Length of the segment between two points (x, y) that lies within the stock, m.
    pub fn inside_m(&self, from_m: Vector2<f64>, to_m: Vector2<f64>) -> f64 {
        let along = to_m - from_m;
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        let faces = [
            (from_m.x, along.x, self.x_min_m, self.x_max_m),
            (from_m.y, along.y, self.y_min_m, self.y_max_m),
        ];
        for (start, rate, min, max) in faces {
            if rate == 0.0 {
                if start < min || start > max {
                    return 0.0;
                }
                continue;
            }
            let (a, b) = ((min - start) / rate, (max - start) / rate);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        along.norm() * (high - low).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn verify_engagement_angles_from_radial_immersion() {
        let half = Engagement::down(5e-3, 10e-3).expect("half immersion");
        assert!((half.entry_rad - FRAC_PI_2).abs() < 1e-15 && half.exit_rad == PI);
        let half = Engagement::up(5e-3, 10e-3).expect("half immersion");
        assert!((half.exit_rad - FRAC_PI_2).abs() < 1e-15 && half.entry_rad == 0.0);
        assert_eq!(Engagement::up(1.0, 1.0), Ok(Engagement::SLOT));
        assert_eq!(Engagement::down(1.0, 1.0), Ok(Engagement::SLOT));
        // A radial depth of 5 % of the diameter: 25.84 degrees of contact.
        let narrow = Engagement::down(0.05, 1.0).expect("narrow");
        let contact = (narrow.exit_rad - narrow.entry_rad).to_degrees();
        assert!((contact - 25.842).abs() < 1e-3, "{contact}");
    }

    #[test]
    fn engagement_beyond_the_diameter_is_refused() {
        let message = Engagement::down(1.2e-2, 1e-2)
            .expect_err("wider than the cutter")
            .to_string();
        assert!(message.contains("0.012") && message.contains("0.01 m"));
        assert!(Engagement::up(0.0, 1e-2).is_err());
        assert!(Engagement::up(f64::NAN, 1e-2).is_err());
    }

    #[test]
    fn verify_overlaps_find_every_turn() {
        let slot = Engagement::SLOT;
        let parts: Vec<_> = slot.overlaps(-1.0, 3.0 * PI).collect();
        assert_eq!(parts, [(0.0, PI), (TAU, 3.0 * PI)]);
        assert_eq!(
            slot.overlaps(3.5, 6.0).count(),
            0,
            "between exit and the next entry"
        );
        let total: f64 = slot.overlaps(-10.0, 10.0 * TAU).map(|(a, b)| b - a).sum();
        let samples = 400_000;
        let span = 10.0 * TAU + 10.0;
        let inside = (0..samples)
            .filter(|i| slot.contains(-10.0 + span * (*i as f64 + 0.5) / samples as f64))
            .count();
        assert!((total - span * inside as f64 / samples as f64).abs() < 1e-3);
    }

    #[test]
    fn verify_segments_are_clipped_by_the_faces() {
        let stock = Stock {
            x_min_m: 0.0,
            x_max_m: f64::INFINITY,
            y_min_m: f64::NEG_INFINITY,
            y_max_m: 1.0,
            top_m: 1.0,
        };
        let length = |a: [f64; 2], b: [f64; 2]| stock.inside_m(a.into(), b.into());
        assert!((length([-1.0, 0.0], [1.0, 0.0]) - 1.0).abs() < 1e-15);
        assert!((length([1.0, 0.0], [4.0, 4.0]) - 1.25).abs() < 1e-15);
        assert_eq!(length([1.0, 2.0], [4.0, 2.0]), 0.0);
        assert_eq!(length([-3.0, 0.0], [-1.0, 0.0]), 0.0);
        assert!(stock.contains([0.5, -7.0].into()) && !stock.contains([0.5, 1.5].into()));
        assert!(!stock.contains([-0.5, 0.0].into()));
    }
}
