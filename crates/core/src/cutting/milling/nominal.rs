//! Forces of the nominal chip h = c sin φ in closed form.

use super::cutter::Cutter;
use super::engagement::Engagement;
use super::sweep::{Sweep, on_tool_n};
use crate::cutting::chamfer::CuttingCoefficients;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

/// A steady cut by a tool that does not vibrate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NominalCut {
    pub cutter: Cutter,
    pub coefficients: CuttingCoefficients,
    pub engagement: Engagement,
    pub axial_depth_m: f64,
    /// c, m.
    pub feed_per_tooth_m: f64,
}

impl NominalCut {
    /// Force on the tool, averaged over a revolution, N: `N b / 2π` times the integral of the
    /// tooth's force over the engagement (`altintas2012`, eqs. 2.42 f.). The helix has no part in
    /// it, it moves force in time; runout moves chips from one tooth to another, and takes
    /// edge forces off where it lifts teeth out.
    pub fn average_force_n(&self) -> Vector3<f64> {
        let sweep = Sweep::between(self.engagement.entry_rad, self.engagement.exit_rad);
        let scale = self.cutter.teeth as f64 * self.axial_depth_m / TAU;
        let edge = self.edge_sweep().edge_force_n_per_m(&self.coefficients);
        (self.chip_force_of(&sweep) + edge) * scale
    }

    /// Where edges cut, averaged over the teeth. Tooth e cuts at φ where it stands out beyond what
    /// each earlier tooth left, ρ_e > ρ_{e−p} − p c sin φ: where sin φ exceeds
    /// `max_p (ρ_{e−p} − ρ_e)/(p c)`.
    fn edge_sweep(&self) -> Sweep {
        let cutter = &self.cutter;
        let [entry, exit] = [self.engagement.entry_rad, self.engagement.exit_rad];
        if cutter.runout.offset_m == 0.0 {
            return Sweep::between(entry, exit);
        }
        let teeth = cutter.teeth;
        let mut sum = Sweep::default();
        for tooth in 0..teeth {
            let own_m = cutter.tooth_radius_m(tooth);
            let needed = (1..teeth).map(|passes| {
                let earlier_m = cutter.tooth_radius_m(tooth + teeth - passes);
                (earlier_m - own_m) / (passes as f64 * self.feed_per_tooth_m)
            });
            let least = needed.fold(0.0, f64::max);
            if least >= 1.0 {
                continue;
            }
            let (from, to) = (entry.max(least.asin()), exit.min(PI - least.asin()));
            if to > from {
                sum += Sweep::between(from, to);
            }
        }
        sum.times(1.0 / teeth as f64)
    }

    /// Moment on the tool about its tip, averaged over a revolution, N m: tooth forces at the
    /// radius and, every height contributing alike, half the depth above the tip; z brakes the
    /// spindle.
    pub fn average_moment_n_m(&self) -> Vector3<f64> {
        let sweep = Sweep::between(self.engagement.entry_rad, self.engagement.exit_rad);
        let edge = self.edge_sweep();
        let k = &self.coefficients;
        let c = self.feed_per_tooth_m;
        let radius_m = self.cutter.radius_m;
        let scale = self.cutter.teeth as f64 * self.axial_depth_m / TAU * radius_m;
        // Axial forces at (r sin φ, r cos φ).
        let axial_sin = k.axial_pa * c * sweep.sin_sin + k.edge_axial_n_per_m * edge.sin;
        let axial_cos = k.axial_pa * c * sweep.sin_cos + k.edge_axial_n_per_m * edge.cos;
        let braking = k.tangential_pa * c * sweep.sin + k.edge_tangential_n_per_m * edge.one;
        let up = Vector3::new(0.0, 0.0, 0.5 * self.axial_depth_m);
        up.cross(&self.average_force_n()) + Vector3::new(axial_cos, -axial_sin, braking) * scale
    }

    /// Force on the tool when the spindle has turned by `rotation_rad`, N. The helical edge is
    /// integrated in closed form: with lag κ per height, dz = dφ/κ.
    pub fn force_n(&self, rotation_rad: f64) -> Vector3<f64> {
        let teeth = 0..self.cutter.teeth;
        teeth
            .map(|tooth| self.tooth_force_n(self.cutter.tooth_angle_rad(tooth, rotation_rad)))
            .sum()
    }

    /// Depth feedback from the floor, averaged, N/m: force on the tool by columns of its
    /// displacement. A tool that sinks is engaged deeper at once, F̄ (b − z)/b, whatever the depth;
    /// in a slot ∂F/∂z per depth is (f_rev/4)(−K_rc, K_tc) without edge forces. It does not grow
    /// with the depth and is added to `b B` where that enters a stability question.
    pub fn floor_feedback_n_per_m(&self) -> Matrix3<f64> {
        let per_depth = self.average_force_n() / self.axial_depth_m;
        Matrix3::from_columns(&[Vector3::zeros(), Vector3::zeros(), -per_depth])
    }

    /// Force on the tool per axial depth while tooth 0 stands at φ = `angle_rad`, of the teeth in
    /// the cut that stand `behind_rad` behind it, N/m. Straight edges.
    pub fn force_per_depth_at(&self, angle_rad: f64, behind_rad: &[f64]) -> Vector3<f64> {
        self.force_of(&Sweep::at_teeth(angle_rad, behind_rad))
    }

    fn tooth_force_n(&self, tip_rad: f64) -> Vector3<f64> {
        let lag = self.cutter.lag_rad_per_m() * self.axial_depth_m;
        if lag.abs() < 1e-9 {
            if !self.engagement.contains(tip_rad) {
                return Vector3::zeros();
            }
            let chip = self.feed_per_tooth_m * tip_rad.sin();
            let b = self.axial_depth_m;
            let forces = self.coefficients.forces_n(chip * b, b);
            return on_tool_n(
                tip_rad,
                forces.tangential_n,
                forces.radial_n,
                forces.axial_n,
            );
        }
        let top_rad = tip_rad - lag;
        let mut sweep = Sweep::default();
        for (from, to) in self
            .engagement
            .overlaps(top_rad.min(tip_rad), top_rad.max(tip_rad))
        {
            sweep += Sweep::between(from, to);
        }
        self.force_of(&sweep) / self.cutter.lag_rad_per_m().abs()
    }

    fn force_of(&self, sweep: &Sweep) -> Vector3<f64> {
        self.chip_force_of(sweep) + sweep.edge_force_n_per_m(&self.coefficients)
    }

    fn chip_force_of(&self, sweep: &Sweep) -> Vector3<f64> {
        let feed = Vector3::new(self.feed_per_tooth_m, 0.0, 0.0);
        sweep.chip_force_pa(&self.coefficients) * feed
    }
}

#[cfg(test)]
mod lifted;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cutting::milling::examples::aluminium;

    fn cuts() -> Vec<NominalCut> {
        let engagements = [
            Engagement::SLOT,
            Engagement::down(4e-3, 16e-3).expect("partial"),
            Engagement::up(11e-3, 16e-3).expect("partial"),
        ];
        let mut cuts = Vec::new();
        for engagement in engagements {
            for (helix_angle_rad, teeth) in [(0.0, 2), (0.52, 4), (0.7, 3), (-0.5, 2)] {
                let cutter = Cutter {
                    helix_angle_rad,
                    ..Cutter::straight(8e-3, teeth)
                };
                cuts.push(NominalCut {
                    cutter,
                    coefficients: aluminium(),
                    engagement,
                    axial_depth_m: 12e-3,
                    feed_per_tooth_m: 0.1e-3,
                });
            }
        }
        cuts
    }

    /// The average as printed: F̄x = N b c/8π [K_tc cos 2φ − K_rc (2φ − sin 2φ)] + N b/2π [−K_te
    /// sin φ + K_re cos φ], F̄y = N b c/8π [K_tc (2φ − sin 2φ) + K_rc cos 2φ] − N b/2π [K_te cos φ
    /// + K_re sin φ], F̄z = N b/2π [−K_ac c cos φ + K_ae φ].
    fn printed(cut: &NominalCut) -> Vector3<f64> {
        let k = &cut.coefficients;
        let (b, c, n) = (
            cut.axial_depth_m,
            cut.feed_per_tooth_m,
            cut.cutter.teeth as f64,
        );
        let at = |phi: f64| {
            let (s2, c2) = (2.0 * phi).sin_cos();
            let chip = n * b * c / (4.0 * TAU);
            let edge = n * b / TAU;
            Vector3::new(
                chip * (k.tangential_pa * c2 - k.radial_pa * (2.0 * phi - s2))
                    + edge
                        * (-k.edge_tangential_n_per_m * phi.sin()
                            + k.edge_radial_n_per_m * phi.cos()),
                chip * (k.tangential_pa * (2.0 * phi - s2) + k.radial_pa * c2)
                    - edge
                        * (k.edge_tangential_n_per_m * phi.cos()
                            + k.edge_radial_n_per_m * phi.sin()),
                edge * (-k.axial_pa * c * phi.cos() + k.edge_axial_n_per_m * phi),
            )
        };
        at(cut.engagement.exit_rad) - at(cut.engagement.entry_rad)
    }

    #[test]
    fn verify_average_force_as_printed() {
        for cut in cuts() {
            let (ours, book) = (cut.average_force_n(), printed(&cut));
            assert!((ours - book).norm() < 1e-9 * book.norm(), "{ours} {book}");
        }
    }

    /// `docs/physics/milling_forces.md`, Floor: (f_rev/4)(−K_rc, K_tc) per depth, 2e5 N/m in steel
    /// of K_t 2 GPa at 0.4 mm per revolution.
    #[test]
    fn verify_floor_feedback_of_a_slot() {
        let cut = NominalCut {
            cutter: Cutter::straight(8e-3, 4),
            coefficients: CuttingCoefficients {
                tangential_pa: 2e9,
                radial_pa: 0.6e9,
                axial_pa: 0.0,
                edge_axial_n_per_m: 0.0,
                edge_radial_n_per_m: 0.0,
                edge_tangential_n_per_m: 0.0,
            },
            engagement: Engagement::SLOT,
            axial_depth_m: 0.3e-3,
            feed_per_tooth_m: 0.1e-3,
        };
        let feedback = cut.floor_feedback_n_per_m();
        let expected = -Vector3::new(-0.25 * 0.4e-3 * 0.6e9, 0.25 * 0.4e-3 * 2e9, 0.0);
        assert!((feedback.column(2) - expected).norm() < 1e-6);
        assert!((feedback.column(2).y + 2e5).abs() < 1e-6);
    }

    /// The force at an angle, averaged numerically over a revolution. 7200 samples meet an entry to
    /// 0.9 mrad, which is 1e-3 of the shortest engagement at most; with helix the force is
    /// continuous and the sum far better.
    #[test]
    fn verify_mean_of_the_force_over_a_revolution() {
        for cut in cuts() {
            let samples = 7200;
            let mean = (0..samples)
                .map(|i| cut.force_n(TAU * (i as f64 + 0.5) / samples as f64))
                .sum::<Vector3<f64>>()
                / samples as f64;
            let expected = cut.average_force_n();
            for axis in 0..3 {
                let error = (mean[axis] - expected[axis]).abs();
                assert!(
                    error <= 1e-3 * expected[axis].abs(),
                    "{mean} instead of {expected}"
                );
            }
        }
    }

    /// The moment at an angle, summed over thin discs and averaged numerically over a revolution.
    #[test]
    fn verify_mean_of_the_moment_over_a_revolution() {
        for cut in cuts() {
            let (discs, samples) = (20, 3600);
            let thin = NominalCut {
                cutter: Cutter {
                    helix_angle_rad: 0.0,
                    ..Cutter::straight(cut.cutter.radius_m, 1)
                },
                axial_depth_m: cut.axial_depth_m / f64::from(discs),
                ..cut
            };
            let mut mean = Vector3::zeros();
            for disc in 0..discs {
                let height = cut.axial_depth_m * (f64::from(disc) + 0.5) / f64::from(discs);
                for i in 0..samples {
                    let angle = TAU * (f64::from(i) + 0.5) / f64::from(samples);
                    let (sin, cos) = angle.sin_cos();
                    let reach = cut.cutter.radius_m;
                    let arm = Vector3::new(reach * sin, reach * cos, height);
                    mean += arm.cross(&thin.force_n(angle)) / f64::from(samples);
                }
            }
            mean *= cut.cutter.teeth as f64;
            let expected = cut.average_moment_n_m();
            let error = (mean - expected).amax();
            assert!(
                error < 2e-3 * expected.amax(),
                "{mean} instead of {expected}"
            );
            assert!(expected.z > 0.0);
        }
    }

    /// Closed form along the helix against a sum over thin discs.
    #[test]
    fn verify_helical_edge_is_the_sum_of_its_discs() {
        for cut in cuts().iter().filter(|c| c.cutter.helix_angle_rad != 0.0) {
            let discs = 4000;
            let thin = NominalCut {
                cutter: Cutter {
                    helix_angle_rad: 0.0,
                    ..cut.cutter
                },
                axial_depth_m: cut.axial_depth_m / discs as f64,
                ..*cut
            };
            for rotation in [0.3, 1.1, 2.9, 4.4] {
                let sum: Vector3<f64> = (0..discs)
                    .map(|i| {
                        let height = cut.axial_depth_m * (i as f64 + 0.5) / discs as f64;
                        thin.force_n(rotation - cut.cutter.lag_rad_per_m() * height)
                    })
                    .sum();
                let closed = cut.force_n(rotation);
                assert!((sum - closed).norm() < 2e-3 * closed.norm().max(10.0));
            }
        }
    }
}
