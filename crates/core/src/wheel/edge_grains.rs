//! Bonded grains of a soft wheel that run over the corner of a face.
//!
//! **On the face.** Grains are balls of radius a whose tops stand out of the rubber by g, normally
//! distributed (mean, spread σ), n of them per area. Each rests on the rubber like a disc of its
//! own radius on a half-space: `k_n = 2 E* a` along the normal, `k_t = k_n 2(1-ν)/(2-ν)` across.
//! With the rubber at the distance s from the face a grain is pressed in by `δ = (g - s)⁺`, and s
//! follows from the pressure, `n k_n E[δ] = p`, `E[δ] = σ (φ(t) + t Φ(t))`, `t = (g - s)/σ`. At `s
//! = 0` the rubber itself touches and bears what is left.
//!
//! **At the corner**, a fillet of radius r, `R = a + r`: a grain from outside stands lower by δ and
//! meets it where the corner's normal leans by θ0, `cos θ0 = 1 - δ/R`. What pulls it on is the
//! stretch of its rubber along the sliding velocity, across the edge and along it, `tan χ =
//! |v_along/v_across|`. It sticks if that lies within the cone of friction about the normal,
//! `cos²θ0 ≤ (μ² - tan²χ)/(1 + μ²)`, so it **jams** if
//!
//! `δ ≥ R (1 - G)`,   `G = √((μ² - tan²χ)⁺/(1 + μ²))`,
//!
//! G = sin ψ of the angle of friction straight across the edge. Its force then grows by `k_t |v|`
//! to the strength of its bond, `F`, in `T = F/(k_t |v|)`, and drops: the impulse `F²/(2 k_t |v|)`
//! against the motion of the wheel.
//!
//! **Else it climbs**: with `η = k_n R (cos θ - cos θ0) tan(θ + ψ)` from θ0 to 0, ψ = asin G, while
//! its rubber goes on by `R (sin θ0 - sin θ) + η/k_t`. Impulse `∫η R cos θ dθ + (k_n μ δ)²/2k_t`
//! over |v_across|, the integral in closed form. Running outward a grain slides off: no more than
//! what it bore goes.
//!
//! **Neighbours.** When a grain leaves or comes, its rubber sinks onto the others until the bed
//! bears again what it is pressed by: of the load nothing stays lost but the part `b/(b + n k_n
//! Φ)`, b the slope of the bed's pressure over its deflection and Φ the share of grains that touch,
//! and none at all where the rubber touches. What jams or climbs pushes in the plane besides, where
//! the others slide and take nothing over.
//!
//! Left out: the grain's mass (natural period some 10 µs, `v √(k m)` a tenth of the forces), the
//! layer's slope outside the edge (it delays the climb, and jams the same grains), the line
//! reaction of the edge as pressure on the grains next to it, and that a grain that slides along
//! the edge (`tan χ > μ`) is dragged up by a little friction.

use crate::roots::newton;
use statrs::function::erf::erfc;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// Distribution, strength and bedding of the grains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondedGrains {
    pub radius_m: f64,
    /// Mean of how far they stand out of the rubber, and its standard deviation.
    pub protrusion_m: f64,
    pub spread_m: f64,
    /// Force at which a bond breaks or a grain slips over, N.
    pub strength_n: f64,
    /// Stiffness of a grain's bedding along the normal and across it.
    pub normal_n_per_m: f64,
    pub tangential_n_per_m: f64,
}

/// A corner as a grain meets it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Of the fillet, m.
    pub radius_m: f64,
    pub mu: f64,
    /// Velocity of the wheel's surface over it: across the edge, inward negative, and along it.
    pub velocity_m_per_s: [f64; 2],
}

/// Force of a grain that meets a corner, over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulse {
    pub impulse_n_s: f64,
    pub length_s: f64,
    /// A ramp that drops; else half a sine.
    pub jams: bool,
}

impl Pulse {
    /// Impulse given up to a time after its beginning, N s.
    pub fn given_n_s(&self, time_s: f64) -> f64 {
        let part = (time_s / self.length_s).clamp(0.0, 1.0);
        let given = if self.jams {
            part * part
        } else {
            0.5 - 0.5 * (PI * part).cos()
        };
        self.impulse_n_s * given
    }

    /// `∫F² dt`, N² s.
    pub fn square_n2_s(&self) -> f64 {
        let shape = if self.jams { 4.0 / 3.0 } else { PI * PI / 8.0 };
        shape * self.impulse_n_s * self.impulse_n_s / self.length_s
    }
}

impl Corner {
    /// G: sine of the angle of friction that is left across the edge.
    fn grip(&self) -> f64 {
        let [across, along] = self.velocity_m_per_s;
        let slope = along / across;
        let squares = (self.mu * self.mu - slope * slope).max(0.0) / (1.0 + self.mu * self.mu);
        squares.sqrt()
    }
}

/// Density of the normal distribution.
fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / TAU.sqrt()
}

/// Share of the normal distribution above x.
fn above(x: f64) -> f64 {
    0.5 * erfc(x * FRAC_1_SQRT_2)
}

/// `E[(t + z)⁺]` of a standard normal z.
fn mean_excess(t: f64) -> f64 {
    density(t) + t * above(-t)
}

impl BondedGrains {
    /// Stiffness of a disc of this radius on a half-space, along its normal and across (Johnson
    /// 1985, 3.4 and 3.7).
    pub fn bedding_n_per_m(radius_m: f64, contact_modulus_pa: f64, poisson: f64) -> [f64; 2] {
        let normal = 2.0 * contact_modulus_pa * radius_m;
        [normal, normal * 2.0 * (1.0 - poisson) / (2.0 - poisson)]
    }

    /// Distance s of the rubber from the face under a pressure that so many grains per area bear,
    /// m.
    pub fn gap_m(&self, pressure_pa: f64, per_m2: f64) -> f64 {
        let mean = pressure_pa / (per_m2 * self.normal_n_per_m * self.spread_m);
        let touching = self.protrusion_m / self.spread_m;
        if mean >= mean_excess(touching) {
            return 0.0;
        }
        // Convex and rising: Newton's iteration comes down from the right.
        let t = newton(mean + 0.4, 1e-9, |t| (mean - mean_excess(t)) / above(-t));
        self.protrusion_m - t * self.spread_m
    }

    /// Part of a grain's load on the face that its neighbours do not take over when it goes; `bed`
    /// is the slope of the bed's pressure, Pa/m.
    pub fn unshared(&self, bed_pa_per_m: f64, gap_m: f64, per_m2: f64) -> f64 {
        if gap_m <= 0.0 {
            return 0.0;
        }
        let layer = per_m2 * self.normal_n_per_m * self.share_beyond(gap_m, 0.0);
        bed_pa_per_m / (bed_pa_per_m + layer)
    }

    /// Depth from which grains jam, m.
    pub fn jam_depth_m(&self, corner: &Corner) -> f64 {
        (self.radius_m + corner.radius_m) * (1.0 - corner.grip())
    }

    /// Share of the grains over a gap that is pressed in by more than a depth.
    pub fn share_beyond(&self, gap_m: f64, depth_m: f64) -> f64 {
        above((depth_m + gap_m - self.protrusion_m) / self.spread_m)
    }

    /// Force that a grain of the face bears in the mean, and the part of it that those bear which
    /// are pressed in by more than a depth, N.
    pub fn mean_forces_n(&self, gap_m: f64, depth_m: f64) -> [f64; 2] {
        let t = (self.protrusion_m - gap_m) / self.spread_m;
        let z = depth_m / self.spread_m - t;
        let scale = self.normal_n_per_m * self.spread_m;
        [scale * mean_excess(t), scale * (density(z) + t * above(z))]
    }

    /// What a grain that is pressed in by `depth_m` on the face does to a corner that it runs over;
    /// nothing unless it runs inward.
    pub fn pulse(&self, depth_m: f64, corner: &Corner) -> Option<Pulse> {
        let [across, along] = corner.velocity_m_per_s;
        if across >= 0.0 || depth_m <= 0.0 {
            return None;
        }
        if depth_m >= self.jam_depth_m(corner) {
            let length_s = self.strength_n / (self.tangential_n_per_m * across.hypot(along));
            return Some(Pulse {
                impulse_n_s: 0.5 * self.strength_n * length_s,
                length_s,
                jams: true,
            });
        }
        let reach = self.radius_m + corner.radius_m;
        let (from, psi) = ((1.0 - depth_m / reach).acos(), corner.grip().asin());
        let softer = self.normal_n_per_m / self.tangential_n_per_m;
        let stretch = psi.tan() * depth_m / reach;
        let time_s = reach / across.abs();
        let impulse = climb(from, psi) + 0.5 * softer * stretch * stretch;
        Some(Pulse {
            impulse_n_s: self.normal_n_per_m * reach * time_s * impulse,
            length_s: time_s * (from.sin() + softer * stretch),
            jams: false,
        })
    }
}

/// `∫ (cos θ - cos θ0) tan(θ + ψ) cos θ dθ` from 0 to θ0, which with ψ stays below a right angle.
fn climb(from: f64, psi: f64) -> f64 {
    let (s, c) = psi.sin_cos();
    let until = |phi: f64| {
        let (sine, cosine) = phi.sin_cos();
        let log = -cosine.ln();
        let square = c * c * 0.5 * sine * sine
            + c * s * (phi - sine * cosine)
            + s * s * (log - 0.5 * sine * sine);
        let first = -c * cosine + s * (((1.0 + sine) / cosine).ln() - sine);
        square - from.cos() * first
    };
    until(from + psi) - until(psi)
}

#[cfg(test)]
mod tests;
