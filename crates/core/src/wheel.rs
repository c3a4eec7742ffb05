//! A compliant wheel pressed onto a flat plate: normal spring, sliding friction, Preston removal.
//!
//! The submodules hold the tools of finishing: what their surfaces rest on ([`bed`]), how they
//! press ([`pneumatic`] by its [`shell`], [`belt`] on rubber that is [`bonded`], [`brush`] with its
//! [`bristle`]s), the patch over a face with edges ([`patch`], [`face`]), what they remove
//! ([`removal`], [`edge_wear`]), how they are held ([`force_control`]), how uneven they are
//! ([`eccentricity`], [`texture`]) and what their grains do to a corner ([`edge_grains`]).

pub mod abrasive;
pub mod bed;
pub mod belt;
pub mod bonded;
pub mod bristle;
pub mod brush;
pub mod curved;
pub mod eccentricity;
pub mod edge_grains;
pub mod edge_wear;
pub mod face;
pub mod force_control;
pub mod patch;
pub mod pneumatic;
pub mod quadrature;
pub mod removal;
pub mod shell;
pub mod texture;

pub mod precession;

/// Contact law of the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelContact {
    pub radius_m: f64,
    pub width_m: f64,
    /// Contact stiffness, N/m.
    pub stiffness_n_per_m: f64,
    /// Contact damping, N s/m.
    pub damping_n_s_per_m: f64,
    /// Friction coefficient between wheel and plate.
    pub mu: f64,
    /// Eccentricity of the running surface, a quarter of a turn after the wheel starts, m.
    pub eccentricity_m: f64,
    /// Eccentricity at the contact when the wheel starts, m.
    pub eccentricity_at_start_m: f64,
}

impl WheelContact {
    /// Indentation (m) and its rate (m/s) when the axis has advanced by `advance` from touch-down,
    /// the wheel was set down by `initial` and has turned by `angle`:
    /// `δ = δ0 + x + e sin φ + e0 cos φ`.
    pub fn indentation_m(
        &self,
        initial_m: f64,
        advance_m: f64,
        advance_rate_m_per_s: f64,
        angle_rad: f64,
        spin_rad_s: f64,
    ) -> (f64, f64) {
        let (s, c) = angle_rad.sin_cos();
        (
            initial_m + advance_m + self.eccentricity_m * s + self.eccentricity_at_start_m * c,
            advance_rate_m_per_s + self.eccentricity_m * spin_rad_s * c
                - self.eccentricity_at_start_m * spin_rad_s * s,
        )
    }

    /// Normal force, N: spring and damper, never pulling, and zero out of contact.
    pub fn normal_force_n(&self, indentation_m: f64, rate_m_per_s: f64) -> f64 {
        if indentation_m <= 0.0 {
            return 0.0;
        }
        (self.stiffness_n_per_m * indentation_m + self.damping_n_s_per_m * rate_m_per_s).max(0.0)
    }

    /// Half length of the contact along the strip, m: the chord that the undeformed wheel cuts,
    /// `√(2Rδ - δ²)`.
    pub fn half_length_m(&self, indentation_m: f64) -> f64 {
        let d = indentation_m.max(0.0);
        (2.0 * self.radius_m * d - d * d).max(0.0).sqrt()
    }
}

/// A strip of the plate along the path, with the depth removed so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    cell_m: f64,
    width_m: f64,
    removed_m: Vec<f64>,
}

impl Strip {
    /// A strip of `cells` equal cells over `length_m`, `width_m` wide.
    pub fn new(length_m: f64, width_m: f64, cells: usize) -> Self {
        Self {
            cell_m: length_m / cells as f64,
            width_m,
            removed_m: vec![0.0; cells],
        }
    }

    /// Removed depth by cell, m.
    pub fn removed_m(&self) -> &[f64] {
        &self.removed_m
    }

    /// Middle of a cell along the strip, m.
    pub fn position_m(&self, cell: usize) -> f64 {
        (cell as f64 + 0.5) * self.cell_m
    }

    /// Removed volume, m³.
    pub fn volume_m3(&self) -> f64 {
        self.removed_m.iter().sum::<f64>() * self.cell_m * self.width_m
    }

    /// Preston's law over one step: `ż = k_p p v`. The pressure is semi-elliptic over the contact
    /// `centre ± half_length`, so that its integral is the line load; each cell receives its exact
    /// part of that integral, whatever its size. What falls beyond the strip's ends is not on the
    /// plate.
    ///
    /// `dose_m2` is `k_p · (N / width) · v_s · dt`: the cross-section removed in the step, m².
    pub fn remove(&mut self, centre_m: f64, half_length_m: f64, dose_m2: f64) {
        if dose_m2 <= 0.0 {
            return;
        }
        let n = self.removed_m.len();
        let cell_of = |x: f64| (x / self.cell_m).floor().clamp(-1.0, n as f64);
        let first = cell_of(centre_m - half_length_m).max(0.0) as usize;
        let last = cell_of(centre_m + half_length_m) as isize;
        let until = |edge: usize| {
            semi_ellipse_cdf((edge as f64 * self.cell_m - centre_m) / half_length_m.max(1e-12))
        };
        let mut from = until(first);
        for cell in first..=(last.min(n as isize - 1).max(-1) + 1) as usize {
            if cell >= n {
                break;
            }
            let to = until(cell + 1);
            self.removed_m[cell] += dose_m2 * (to - from) / self.cell_m;
            from = to;
        }
    }
}

/// Integral of the normalised semi-ellipse `2/π √(1-x²)` from -1 to `x`.
fn semi_ellipse_cdf(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wheel() -> WheelContact {
        WheelContact {
            radius_m: 0.075,
            width_m: 0.025,
            stiffness_n_per_m: 4e4,
            damping_n_s_per_m: 50.0,
            mu: 0.4,
            eccentricity_m: 20e-6,
            eccentricity_at_start_m: -7e-6,
        }
    }

    /// `docs/physics/removal.md`, line pass: depth = k_p v_s F' / v_f, and on any grid.
    #[test]
    fn verify_pass_depth_is_prestons_integral_on_any_grid() {
        let (k_p, v_s, load, v_f, width) = (4e-11, 20.0, 30.0, 0.05, 0.025);
        let expected = k_p * v_s * (load / width) / v_f;
        for cells in [37, 200, 1000] {
            let mut strip = Strip::new(0.2, width, cells);
            let dt = 1e-4;
            for i in 0..40_000 {
                // from 20 mm before the strip to 20 mm beyond
                let at = -0.02 + v_f * dt * (i as f64 + 0.5) * 1.2;
                strip.remove(at, 3e-3, k_p * v_s * load / width * dt);
            }
            let middle = strip.removed_m()[cells / 2];
            assert!(
                (middle * 1.2 / expected - 1.0).abs() < 2e-3,
                "{cells}: {middle}"
            );
            let volume = strip.volume_m3();
            let whole = expected / 1.2 * 0.2 * width;
            assert!((volume / whole - 1.0).abs() < 2e-3, "{cells}");
        }
    }

    #[test]
    fn verify_dose_is_kept_whole_on_the_strip() {
        let mut strip = Strip::new(0.1, 0.02, 64);
        strip.remove(0.05, 4e-3, 1e-9);
        assert!((strip.volume_m3() / (1e-9 * 0.02) - 1.0).abs() < 1e-12);
        strip.remove(-1.0, 4e-3, 1e-9);
        strip.remove(1.0, 4e-3, 1e-9);
        assert!((strip.volume_m3() / (1e-9 * 0.02) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn wheel_never_pulls() {
        let w = wheel();
        assert_eq!(w.normal_force_n(-1e-6, 10.0), 0.0);
        assert_eq!(w.normal_force_n(1e-6, -10.0), 0.0);
        assert!((w.normal_force_n(1e-3, 0.0) - 40.0).abs() < 1e-12);
    }

    #[test]
    fn verify_indentation_rate_is_the_derivative() {
        let w = wheel();
        let (spin, h) = (125.0, 1e-7);
        let at = |t: f64| w.indentation_m(7e-4, 1e-4 * t, 1e-4, spin * t, spin);
        let rate = (at(0.3 + h).0 - at(0.3 - h).0) / (2.0 * h);
        assert!((rate - at(0.3).1).abs() < 1e-8);
    }

    #[test]
    fn verify_contact_length_is_the_chord() {
        let w = wheel();
        let d = 1e-3;
        let half = w.half_length_m(d);
        assert!((half.hypot(w.radius_m - d) - w.radius_m).abs() < 1e-12);
    }
}
