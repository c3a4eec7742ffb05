//! A wheel in precession on a flat face, and the rule that keeps it from rubbing inward over an
//! edge.
//!
//! The wheel, a sphere of radius ρ pressed in by d, touches the face in a disc of radius r around
//! O1. Its spin axis leans by the tilt θ from the outward normal N towards the precession angle α,
//! which turns while the wheel travels. The frame of the face has z along N; angles count from its
//! x axis towards y.
//!
//! A point x of the patch (from O1) moves with v = ω1 cos θ ẑ × (x − x0), x0 = −h (cos α, sin α), h
//! = (ρ − d) tan θ: a rotation about x0. On an edge with outward normal n, at s along n turned by
//! −90°, the outward velocity therefore is
//!
//! v·n = ω1 cos θ (s + h cos β),   β the angle between the centre's velocity and n.
//!
//! It grows along the chord, so that its worse end decides. `cai2016precession` (eq. 7) asks for
//! cos β > ε with an ε that it leaves open; on the whole chord at distance δ what is needed is ε(δ)
//! = √(r² − δ²) / h, and on the chord that an edge of the face leaves of it, −s/h at its worse end.

mod angles;
mod boundary;

use nalgebra::{Vector2, Vector3};

pub use angles::{AngleSet, Arc, wrapped};
pub use boundary::{Boundary, Chord, Edge, PrecessionError};

/// Which part of an edge in the patch must move outward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChordExtent {
    /// The chord of the edge's line, beyond corners too: more than is needed there.
    Full,
    /// What of the chord is edge.
    Clipped,
}

/// How strictly the precession angle is held at edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EdgeRule {
    /// Not at all.
    None,
    /// The source's cos β ≥ ε at every edge in the patch.
    Paper { epsilon: f64 },
    /// No point of an edge in the patch moves inward.
    Exact(ChordExtent),
}

/// A spherical wheel whose spin axis leans from the normal of the face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrecessionWheel {
    radius_m: f64,
    compression_m: f64,
    tilt_rad: f64,
    spin_rad_s: f64,
    patch_radius_m: f64,
}

/// What the edges in the patch meet, at one angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeMotion {
    /// Edges in the patch.
    pub edges: usize,
    /// Least outward velocity on any of them, m/s; infinite without edges.
    pub least_outward_m_per_s: f64,
    /// Share of the chord that moves inward, the largest of all edges.
    pub inward_share: f64,
}

impl PrecessionWheel {
    /// A wheel of radius ρ pressed in by d, tilted by θ, spinning at ω1 about the axis that points
    /// away from the face (negative: about its opposite).
    ///
    /// # Errors
    /// Unless 0 < d < ρ, 0 < θ < π/2 and the spin is not 0.
    pub fn new(
        radius_m: f64,
        compression_m: f64,
        tilt_rad: f64,
        spin_rad_s: f64,
    ) -> Result<Self, PrecessionError> {
        let inside = |value: f64, end: f64| value > 0.0 && value < end;
        let rules = [
            (
                "the wheel's radius (m)",
                radius_m,
                inside(radius_m, f64::INFINITY),
                "above 0",
            ),
            (
                "the wheel's compression (m)",
                compression_m,
                inside(compression_m, radius_m),
                "above 0 and below the radius",
            ),
            (
                "the tilt (rad)",
                tilt_rad,
                inside(tilt_rad, std::f64::consts::FRAC_PI_2),
                "above 0 and below pi/2",
            ),
            (
                "the spin (rad/s)",
                spin_rad_s,
                spin_rad_s.is_finite() && spin_rad_s != 0.0,
                "finite and not 0",
            ),
        ];
        for (quantity, value, good, rule) in rules {
            if !good {
                return Err(PrecessionError::Wheel {
                    quantity,
                    value,
                    rule,
                });
            }
        }
        Ok(Self {
            radius_m,
            compression_m,
            tilt_rad,
            spin_rad_s,
            patch_radius_m: (compression_m * (2.0 * radius_m - compression_m)).sqrt(),
        })
    }

    /// Radius r of the contact patch, the circle that the face cuts from the undeformed sphere, m.
    pub fn patch_radius_m(&self) -> f64 {
        self.patch_radius_m
    }

    /// Height of the wheel's centre above the face, ρ − d, m.
    pub fn centre_height_m(&self) -> f64 {
        self.radius_m - self.compression_m
    }

    /// Distance h of the point of no sliding from the middle of the patch, (ρ − d) tan θ, m.
    pub fn lever_m(&self) -> f64 {
        self.centre_height_m() * self.tilt_rad.tan()
    }

    /// Direction of the spin axis away from the face, of length 1, z along the face's normal.
    pub fn axis(&self, angle_rad: f64) -> Vector3<f64> {
        let (sine, cosine) = self.tilt_rad.sin_cos();
        Vector3::new(sine * angle_rad.cos(), sine * angle_rad.sin(), cosine)
    }

    /// Precession angles that a rule allows with the middle of the patch at `point_m`.
    pub fn allowed(&self, boundary: &Boundary, point_m: &Vector2<f64>, rule: EdgeRule) -> AngleSet {
        self.allowed_around(boundary, point_m, 0.0, rule)
    }

    /// Precession angles that a rule allows at every point within `reach_m` of `point_m`, or fewer:
    /// those that suit a patch larger by the reach with its middle off by it. So a stretch of a
    /// path is held as a whole, not at samples.
    pub fn allowed_around(
        &self,
        boundary: &Boundary,
        point_m: &Vector2<f64>,
        reach_m: f64,
        rule: EdgeRule,
    ) -> AngleSet {
        if rule == EdgeRule::None {
            return AngleSet::Circle;
        }
        let chords = boundary.chords(point_m, self.patch_radius_m + reach_m);
        chords.fold(AngleSet::Circle, |set, chord| {
            let (needed, outward_rad) = self.needed(&chord, reach_m, rule);
            let half_rad = if needed > 1.0 {
                -1.0
            } else {
                needed.max(-1.0).acos()
            };
            set.intersection(&AngleSet::around(outward_rad, half_rad))
        })
    }

    /// The cosine that a rule asks for at an edge, and the angle from which it counts.
    fn needed(&self, chord: &Chord, reach_m: f64, rule: EdgeRule) -> (f64, f64) {
        // With the spin reversed the velocity points straight outward at the opposite angle and
        // falls along the chord.
        let (turn, worse_m) = if self.spin_rad_s > 0.0 {
            (0.0, -chord.from_m)
        } else {
            (std::f64::consts::PI, chord.to_m)
        };
        let needed = match rule {
            EdgeRule::None => -1.0,
            EdgeRule::Paper { epsilon } => epsilon,
            EdgeRule::Exact(ChordExtent::Full) => (chord.half_m + reach_m) / self.lever_m(),
            EdgeRule::Exact(ChordExtent::Clipped) => (worse_m + reach_m) / self.lever_m(),
        };
        (needed, chord.outward_angle_rad() + turn)
    }

    /// As [`Self::allowed`], where it must not be empty.
    ///
    /// # Errors
    /// If no angle is left.
    pub fn require_allowed(
        &self,
        boundary: &Boundary,
        point_m: &Vector2<f64>,
        rule: EdgeRule,
    ) -> Result<AngleSet, PrecessionError> {
        let set = self.allowed(boundary, point_m, rule);
        if !set.is_empty() {
            return Ok(set);
        }
        let chords: Vec<Chord> = boundary.chords(point_m, self.patch_radius_m).collect();
        let worst = (chords.iter().map(|c| self.needed(c, 0.0, rule).0)).fold(-1.0, f64::max);
        let (lever_mm, patch_mm) = (self.lever_m() * 1e3, self.patch_radius_m * 1e3);
        let reason = if worst > 1.0 {
            format!(
                "one alone asks for cos beta >= {worst:.3}; the patch of {patch_mm:.3} mm is too large for a lever (rho - d) tan theta of {lever_mm:.3} mm"
            )
        } else {
            format!(
                "each leaves some, together none; edges that face each other must be 2 r = {:.3} mm apart at least",
                2.0 * patch_mm
            )
        };
        Err(PrecessionError::NoAngle {
            x_mm: point_m.x * 1e3,
            y_mm: point_m.y * 1e3,
            edges: chords.len(),
            reason,
        })
    }

    /// What the edges in the patch meet at an angle, on the parts of them that are edge.
    pub fn edge_motion(
        &self,
        boundary: &Boundary,
        point_m: &Vector2<f64>,
        angle_rad: f64,
    ) -> EdgeMotion {
        let none = EdgeMotion {
            edges: 0,
            least_outward_m_per_s: f64::INFINITY,
            inward_share: 0.0,
        };
        let per_m = self.spin_rad_s * self.tilt_rad.cos();
        let chords = boundary.chords(point_m, self.patch_radius_m);
        chords.fold(none, |motion, chord| {
            // Where on the edge's line the velocity is along it.
            let still_m = -self.lever_m() * (angle_rad - chord.outward_angle_rad()).cos();
            let (worse_m, inward_m) = if per_m > 0.0 {
                (chord.from_m, still_m - chord.from_m)
            } else {
                (chord.to_m, chord.to_m - still_m)
            };
            let share = (inward_m / chord.length_m()).clamp(0.0, 1.0);
            let outward = per_m * (worse_m - still_m);
            EdgeMotion {
                edges: motion.edges + 1,
                least_outward_m_per_s: motion.least_outward_m_per_s.min(outward),
                inward_share: motion.inward_share.max(share),
            }
        })
    }
}

#[cfg(test)]
mod tests;
