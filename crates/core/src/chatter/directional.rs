//! The directional matrix: force on the tool per axial depth and displacement.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

use crate::cutting::chamfer::CuttingCoefficients;
use crate::cutting::milling::cutter::spindle_rad_s;
use crate::cutting::milling::engagement::Engagement;
use crate::cutting::milling::flank::Flank;
use crate::cutting::milling::nominal::NominalCut;
use crate::cutting::milling::sweep::Sweep;

/// A cut averaged over a revolution: force on the tool per axial depth, milling frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AveragedCut {
    /// By columns of displacement, Pa: the directional matrix.
    pub on_position_pa: Matrix3<f64>,
    /// By columns of velocity, Pa s: worn flanks.
    pub on_rate_pa_s: Matrix3<f64>,
}

impl From<&Matrix3<f64>> for AveragedCut {
    /// Sharp flanks.
    fn from(on_position_pa: &Matrix3<f64>) -> Self {
        Self {
            on_position_pa: *on_position_pa,
            on_rate_pa_s: Matrix3::zeros(),
        }
    }
}

/// What the directional matrix is made of: teeth, coefficients, engagement, worn flanks. Straight
/// edges. Edge forces have a part where teeth enter or leave with a chip that rises from nothing,
/// if the feed is known ([`Self::edge_kick_pa`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionalMatrix {
    pub teeth: usize,
    pub coefficients: CuttingCoefficients,
    pub engagement: Engagement,
    pub flank: Flank,
    /// Of the cutter, m; asked for with a worn flank only.
    pub radius_m: f64,
    /// c, m; infinite if edge forces shall have no part.
    pub feed_per_tooth_m: f64,
}

impl From<&NominalCut> for DirectionalMatrix {
    fn from(cut: &NominalCut) -> Self {
        Self {
            teeth: cut.cutter.teeth,
            coefficients: cut.coefficients,
            engagement: cut.engagement,
            flank: cut.cutter.flank,
            radius_m: cut.cutter.radius_m,
            feed_per_tooth_m: cut.feed_per_tooth_m,
        }
    }
}

impl DirectionalMatrix {
    /// From K_t (Pa) and the ratio K_r = K_rc/K_tc, without an axial part; flanks are sharp.
    pub fn planar(
        teeth: usize,
        tangential_pa: f64,
        radial_ratio: f64,
        engagement: Engagement,
    ) -> Self {
        let coefficients = CuttingCoefficients {
            axial_pa: 0.0,
            radial_pa: radial_ratio * tangential_pa,
            tangential_pa,
            edge_axial_n_per_m: 0.0,
            edge_radial_n_per_m: 0.0,
            edge_tangential_n_per_m: 0.0,
        };
        Self {
            teeth,
            coefficients,
            engagement,
            flank: Flank::default(),
            radius_m: f64::NAN,
            feed_per_tooth_m: f64::INFINITY,
        }
    }

    /// The cut averaged over a revolution at a tooth period, for small motions.
    pub fn averaged(&self, tooth_period_s: f64) -> AveragedCut {
        let sweep = Sweep::between(self.engagement.entry_rad, self.engagement.exit_rad);
        let share = self.teeth as f64 / TAU;
        AveragedCut {
            on_position_pa: self.average_pa(),
            on_rate_pa_s: self.on_rate_pa_s(&sweep, tooth_period_s) * share,
        }
    }

    /// Force per depth and velocity that worn flanks add, Pa s: the slope of a tooth's path is its
    /// velocity outwards over the cutting speed.
    fn on_rate_pa_s(&self, sweep: &Sweep, tooth_period_s: f64) -> Matrix3<f64> {
        if self.flank.is_sharp() {
            return Matrix3::zeros();
        }
        let speed_m_per_s = spindle_rad_s(self.teeth, tooth_period_s) * self.radius_m;
        sweep.chip_force_pa(&self.flank.per_slope()) / speed_m_per_s
    }

    /// Averaged over a revolution, Pa (N/m per m of axial depth): `½ K_t A0` with A0 = N/2π (α_ij)
    /// between entry and exit, α as in `altintas1995`, and what edge forces add; the third row is
    /// the axial force, the third column zero.
    pub fn average_pa(&self) -> Matrix3<f64> {
        let sweep = Sweep::between(self.engagement.entry_rad, self.engagement.exit_rad);
        let Engagement {
            entry_rad,
            exit_rad,
        } = self.engagement;
        let kicks = self.edge_kick_pa(entry_rad) + self.edge_kick_pa(exit_rad);
        (sweep.chip_force_pa(&self.coefficients) + kicks) * (self.teeth as f64 / TAU)
    }

    /// Where a tooth enters or leaves at φ with a chip that rises from nothing, `c sin φ + Δ·n(φ)`,
    /// a displacement Δ lets it cut over Δ·n/c more of its arc. Its edge force acts that much
    /// longer: the impulse on the tool is this, per depth and columns of Δ, over the spindle's rate
    /// (Pa). Zero where teeth enter or leave through a face of the stock.
    pub fn edge_kick_pa(&self, angle_rad: f64) -> Matrix3<f64> {
        let (sin, cos) = angle_rad.sin_cos();
        if sin.abs() > 1e-9 {
            return Matrix3::zeros();
        }
        let edge = Sweep::at(angle_rad).edge_force_n_per_m(&self.coefficients);
        edge * Vector3::new(sin, cos, 0.0).transpose() / self.feed_per_tooth_m
    }

    /// While tooth 0 stands at φ = `angle_rad`, of the teeth in the cut that stand `behind_rad`
    /// behind it, Pa.
    pub fn at_pa(&self, angle_rad: f64, behind_rad: &[f64]) -> Matrix3<f64> {
        Sweep::at_teeth(angle_rad, behind_rad).chip_force_pa(&self.coefficients)
    }

    /// The part of worn flanks, as [`Self::at_pa`], per velocity, Pa s; `None` if they are sharp.
    pub fn flank_at_pa_s(
        &self,
        angle_rad: f64,
        behind_rad: &[f64],
        tooth_period_s: f64,
    ) -> Option<Matrix3<f64>> {
        let sweep = Sweep::at_teeth(angle_rad, behind_rad);
        (!self.flank.is_sharp()).then(|| self.on_rate_pa_s(&sweep, tooth_period_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix2;
    use std::f64::consts::FRAC_PI_2;

    /// α_ij of Altintas and Budak between entry and exit.
    fn alpha(kr: f64, engagement: &Engagement) -> Matrix2<f64> {
        let at = |p: f64| {
            let (s, c) = (2.0 * p).sin_cos();
            0.5 * Matrix2::new(
                c - 2.0 * kr * p + kr * s,
                -s - 2.0 * p + kr * c,
                -s + 2.0 * p + kr * c,
                -c - 2.0 * kr * p - kr * s,
            )
        };
        at(engagement.exit_rad) - at(engagement.entry_rad)
    }

    /// `docs/physics/stability.md`, Directional matrix: A for K_r = 0.07 between 0 and π/2, to
    /// three decimals; and the formulas as printed for several engagements.
    #[test]
    fn verify_altintas_budak_matrix() {
        let quarter = Engagement {
            entry_rad: 0.0,
            exit_rad: FRAC_PI_2,
        };
        let printed = Matrix2::new(-1.110, -1.641, 1.501, 0.890);
        assert!((alpha(0.07, &quarter) - printed).amax() < 6e-4);
        for engagement in [
            quarter,
            Engagement::SLOT,
            Engagement::down(0.3, 1.0).expect("partial"),
        ] {
            let b = DirectionalMatrix::planar(3, 6e8, 0.07, engagement).average_pa();
            let expected = alpha(0.07, &engagement) * (0.5 * 6e8 * 3.0 / TAU);
            let planar = b.fixed_view::<2, 2>(0, 0).into_owned();
            assert!((planar - expected).amax() < 1e-9 * expected.amax());
            assert_eq!(b.column(2).amax(), 0.0);
        }
    }

    /// Two hundred Gauss nodes over the engagement: the mean over a revolution.
    #[test]
    fn verify_the_matrix_at_an_angle_averages_to_the_whole() {
        let down = Engagement::down(0.35, 1.0).expect("partial");
        let matrix = DirectionalMatrix::planar(4, 6e8, 0.3, down);
        let half = 0.5 * (down.exit_rad - down.entry_rad);
        let mean: Matrix3<f64> = (crate::legendre::legendre(200).iter())
            .map(|(x, weight)| {
                let angle = down.entry_rad + half * (1.0 + x);
                matrix.at_pa(angle, &[0.0]) * (half * weight * 4.0 / TAU)
            })
            .sum();
        assert!((mean - matrix.average_pa()).amax() < 1e-12 * mean.amax());
    }
}
