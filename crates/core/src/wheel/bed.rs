//! What a wheel's surface rests on: an elastic bed under a stretched layer.
//!
//! Seen from the face, the wheel's surface is a layer under tension N (N/m: the inflated shell, or
//! the belt) on a bed that answers a deflection w by a pressure q(w). Its equilibrium is
//!
//! `p = q(w) - N ∇²w`,
//!
//! p what the face presses; without the layer a Winkler bed, with it a Pasternak bed. Where the
//! face presses, w is the indentation, `u = u0 - x²/2R …`, whose curvature alone
//! gives `-N ∇²u` (N/R for a cylinder, 2N/R for a sphere: the air pressure of an inflated ball,
//! since there `N = pR/2`). Where it does not, p = 0 and the layer runs back to its free shape.
//!
//! The bed is two springs in series: `w = c1 q + c2 q²`. The second gives a whole patch Hertz's
//! pressure, a root of the indentation; wheels of rubber have it alone, as stiff as makes the force
//! of a whole patch that of the true body (see `pneumatic`, `belt`).

use crate::roots::newton;

/// Elastic bed, its damping, and the tension of the layer on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bed {
    /// c1, m/Pa: zero for Hertz's bed.
    pub shell_m_per_pa: f64,
    /// c2, m/Pa²: zero for a linear bed.
    pub tread_m_per_pa2: f64,
    /// Viscous pressure per rate of deflection, Pa s/m.
    pub damping_pa_s_per_m: f64,
    /// Tension of the layer, N/m.
    pub tension_n_per_m: f64,
}

impl Bed {
    /// Pressure of the bed at a deflection, Pa; zero when not deflected.
    pub fn pressure_pa(&self, deflection_m: f64) -> f64 {
        if deflection_m <= 0.0 {
            return 0.0;
        }
        let (c1, c2) = (self.shell_m_per_pa, self.tread_m_per_pa2);
        2.0 * deflection_m / (c1 + (c1 * c1 + 4.0 * c2 * deflection_m).sqrt())
    }

    /// Deflection under a pressure, m.
    pub fn deflection_m(&self, pressure_pa: f64) -> f64 {
        pressure_pa * (self.shell_m_per_pa + self.tread_m_per_pa2 * pressure_pa)
    }

    /// Energy per area of a deflection, J/m²: `Ψ = ∫ q dw = c1 q²/2 + 2 c2 q³/3`.
    pub fn energy_j_per_m2(&self, deflection_m: f64) -> f64 {
        self.energy_of_pressure_j_per_m2(self.pressure_pa(deflection_m))
    }

    fn energy_of_pressure_j_per_m2(&self, pressure_pa: f64) -> f64 {
        let q = pressure_pa;
        q * q * (0.5 * self.shell_m_per_pa + 2.0 / 3.0 * self.tread_m_per_pa2 * q)
    }

    /// `N |w'|` where the layer leaves the face at a deflection `w`, N/m: with it the layer pulls
    /// on the line along which it leaves.
    ///
    /// Off the face `N w'' = q(w)` has the first integral `½ N w'² = Ψ(w)`, so `N |w'| = √(2NΨ)`:
    /// on a linear bed `w √(N k)`, falling off over `√(N/k)`; on Hertz's bed the layer is back
    /// after a finite length.
    ///
    /// `curvature_per_m` is that of the line, positive when the layer leaves a disc outwards. It
    /// adds `N w'/ρ` to the equilibrium and `2 N |w'| ∫|w'|dw κ` to the square; against the exact
    /// `K1/K0` of a linear bed the slope is 1 % low when the radius equals the falling-off length
    /// and 3 % low at half of it.
    ///
    /// `inward_m_per_s` is the speed at which the wheel's surface runs over the line onto the face.
    /// Its elements are then pressed down within the falling-off length, at the rate `v |w'|`, and
    /// the bed's damping η answers: `N w'' = q + η v |w'|`. The root of `s² - η v w s - 2NΨ = 0`
    /// solves it exactly for a linear bed, and for any bed when the speed is high, where
    /// `N |w'| → η v w`. A surface that runs off the face (v < 0) relaxes on the way out and pulls
    /// less.
    pub fn leaving_n_per_m(
        &self,
        deflection_m: f64,
        curvature_per_m: f64,
        inward_m_per_s: f64,
    ) -> f64 {
        if deflection_m <= 0.0 {
            return 0.0;
        }
        let (straight, bending) = self.squares(deflection_m);
        self.with_damping(
            straight + bending * curvature_per_m,
            deflection_m,
            inward_m_per_s,
        )
    }

    /// The same along an edge on which the deflection is given and falls off to either side as
    /// `w - y²/2R`, `fall_per_m = 1/R`. The level lines of the layer then have the curvature
    /// `1/(R |w'|)`, which makes the slope the root of a cubic.
    pub fn leaving_edge_n_per_m(
        &self,
        deflection_m: f64,
        fall_per_m: f64,
        inward_m_per_s: f64,
    ) -> f64 {
        if deflection_m <= 0.0 || self.tension_n_per_m <= 0.0 || fall_per_m <= 0.0 {
            return self.leaving_n_per_m(deflection_m, 0.0, inward_m_per_s);
        }
        let (straight, bending) = self.squares(deflection_m);
        // s = N|w'|: s³ - straight s - k = 0 by Newton's iteration from above, where it is monotone
        let k = bending * self.tension_n_per_m * fall_per_m;
        let s = newton(straight.sqrt() + k.cbrt(), 1e-6, |s| {
            (k - s * (s * s - straight)) / (3.0 * s * s - straight)
        });
        self.with_damping(s * s, deflection_m, inward_m_per_s)
    }

    /// `2NΨ`, and what a curvature of one per metre of the level lines adds to `(N w')²`.
    fn squares(&self, deflection_m: f64) -> (f64, f64) {
        let n = self.tension_n_per_m;
        let q = self.pressure_pa(deflection_m);
        let straight = 2.0 * n * self.energy_of_pressure_j_per_m2(q);
        (straight, n * self.bent_m(deflection_m, q) * straight.sqrt())
    }

    /// The same at a positive deflection, each with its slope over the deflection.
    pub(super) fn squares_with_slopes(&self, deflection_m: f64) -> ([f64; 2], [f64; 2]) {
        let n = self.tension_n_per_m;
        let (c1, c2) = (self.shell_m_per_pa, self.tread_m_per_pa2);
        let series = (c1 * c1 + 4.0 * c2 * deflection_m).sqrt();
        let q = 2.0 * deflection_m / (c1 + series);
        let straight = 2.0 * n * self.energy_of_pressure_j_per_m2(q);
        let (bent_m, root) = (self.bent_m(deflection_m, q), straight.sqrt());
        // dq/dw = 1 / (c1 + 2 c2 q), and that sum is the root
        let bent_slope = 1.0 + 2.0 / 7.0 * c2 * q / series;
        let straight_slope = 2.0 * n * q;
        let bending_slope = n * (bent_slope * root + bent_m * n * q / root);
        (
            [straight, straight_slope],
            [n * bent_m * root, bending_slope],
        )
    }

    /// `2 ∫|w'|dw / |w'|`: w where |w'| grows as w (linear), 8/7 w as w^(3/4) (Hertz); between by
    /// share.
    fn bent_m(&self, deflection_m: f64, pressure_pa: f64) -> f64 {
        deflection_m + self.tread_m_per_pa2 * pressure_pa * pressure_pa / 7.0
    }

    fn with_damping(&self, square: f64, deflection_m: f64, inward_m_per_s: f64) -> f64 {
        let viscous = self.damping_pa_s_per_m * inward_m_per_s * deflection_m;
        let root = (viscous * viscous + 4.0 * square).sqrt();
        if viscous >= 0.0 {
            0.5 * (viscous + root)
        } else if root > viscous.abs() {
            // the same number without cancellation
            2.0 * square / (root - viscous)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roots::bisect;

    fn bed(c1: f64, c2: f64) -> Bed {
        Bed {
            shell_m_per_pa: c1,
            tread_m_per_pa2: c2,
            damping_pa_s_per_m: 0.0,
            tension_n_per_m: 800.0,
        }
    }

    #[test]
    fn verify_pressure_and_deflection_are_inverse_and_energy_is_their_integral() {
        for (c1, c2) in [(2e-8, 0.0), (0.0, 1e-15), (2e-9, 1e-15)] {
            let b = bed(c1, c2);
            for w in [1e-6, 1e-4, 1e-3] {
                assert!((b.deflection_m(b.pressure_pa(w)) / w - 1.0).abs() < 1e-12);
                let h = 1e-4 * w;
                let slope = (b.energy_j_per_m2(w + h) - b.energy_j_per_m2(w - h)) / (2.0 * h);
                assert!((slope / b.pressure_pa(w) - 1.0).abs() < 1e-7);
            }
        }
    }

    /// Reaction from the layer's equation off the face, `N w'' + N w'/ρ = q - η v w'` (v inward),
    /// shot from the edge so that w runs out to zero with zero slope.
    fn shot(b: &Bed, w0: f64, radius: f64, v: f64) -> f64 {
        let run = |slope: f64| {
            let (mut w, mut g, mut s) = (w0, -slope, 0.0);
            let h = 2e-6;
            while s < 0.2 && w > 0.0 && g < 0.0 {
                let a = |w: f64, g: f64, s: f64| {
                    (b.pressure_pa(w) - b.damping_pa_s_per_m * v * g) / b.tension_n_per_m
                        - g / (radius + s)
                };
                let (wm, gm) = (w + 0.5 * h * g, g + 0.5 * h * a(w, g, s));
                (w, g) = (w + h * gm, g + h * a(wm, gm, s + 0.5 * h));
                s += h;
            }
            w <= 0.0 // too steep: it crosses zero
        };
        b.tension_n_per_m * bisect([0.0, 20.0], 50, run)[0]
    }

    #[test]
    fn verify_layer_leaves_as_its_equation_says() {
        let (k, w) = (4e7_f64, 5e-4);
        let linear = bed(1.0 / k, 0.0);
        let straight = linear.leaving_n_per_m(w, 0.0, 0.0);
        assert!((straight / (w * (800.0 * k).sqrt()) - 1.0).abs() < 1e-12);
        for b in [linear, bed(0.0, 1e-15), bed(1e-9, 1e-15)] {
            let far = shot(&b, w, 1e6, 0.0);
            let ours = b.leaving_n_per_m(w, 0.0, 0.0);
            assert!((ours / far - 1.0).abs() < 2e-3, "{ours} {far}");
            let disc = shot(&b, w, 4.5e-3, 0.0);
            let ours = b.leaving_n_per_m(w, 1.0 / 4.5e-3, 0.0);
            assert!((ours / disc - 1.0).abs() < 2e-2, "{ours} {disc}");
        }
    }

    #[test]
    fn verify_running_onto_the_edge_presses_harder_than_running_off() {
        let w = 5e-4;
        for (c1, c2, tolerance) in [(1.0 / 4e7, 0.0, 2e-3), (0.0, 1e-15, 3e-2)] {
            let b = Bed {
                damping_pa_s_per_m: 1e5,
                ..bed(c1, c2)
            };
            for v in [-1.0, 0.5, 3.0] {
                let exact = shot(&b, w, 1e6, v);
                let ours = b.leaving_n_per_m(w, 0.0, v);
                assert!(
                    (ours / exact - 1.0).abs() < tolerance,
                    "{v}: {ours} {exact}"
                );
            }
            let (on, off) = (
                b.leaving_n_per_m(w, 0.0, 2.0),
                b.leaving_n_per_m(w, 0.0, -2.0),
            );
            assert!(((on - off) / (1e5 * 2.0 * w) - 1.0).abs() < 1e-9);
        }
    }
}
