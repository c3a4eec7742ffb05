//! The worn flank behind an edge: it is pressed into the surface that the edge has just left.
//!
//! A land of width V_B along the cutting speed v stands at the edge's radius. While the edge moves
//! outwards at ṙ, material behind it stands higher by up to V_B ṙ/v, so that the land displaces
//! `½ V_B² ṙ/v` per height of the edge, and is pushed off by K_sp times that; while the edge moves
//! inwards the land is free. That is the law of runs. Over a cycle of a vibration it takes out as
//! much energy as
//!
//! `F_r = ¼ K_sp V_B² b ṙ/v`
//!
//! in both directions (`wu1989`, `chiou1998`, `ahmadi2012`), which is the law of limits. Both come
//! with friction μ F_r along the tooth's motion (`docs/physics/milling_forces.md`, Process
//! damping).

use crate::cutting::chamfer::CuttingCoefficients;

/// Flank of a tooth in a material. By default it is sharp: no force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Flank {
    /// ¼ K_sp V_B²: radial force per height of the edge and slope ṙ/v of its path in the mean of
    /// both directions, N/m.
    pub per_slope_n_per_m: f64,
    /// μ between flank and workpiece.
    pub mu: f64,
}

impl Flank {
    /// From the force K_sp per volume indented (N/m³) and the width V_B of the wear land.
    pub fn worn(indentation_n_per_m3: f64, wear_land_m: f64, mu: f64) -> Self {
        Self {
            per_slope_n_per_m: 0.25 * indentation_n_per_m3 * wear_land_m * wear_land_m,
            mu,
        }
    }

    pub fn is_sharp(&self) -> bool {
        self.per_slope_n_per_m == 0.0
    }

    /// The law of runs, while the edge moves outwards.
    pub fn per_outward_slope(&self) -> CuttingCoefficients {
        let both_ways = Self {
            per_slope_n_per_m: 2.0 * self.per_slope_n_per_m,
            ..*self
        };
        both_ways.per_slope()
    }

    /// The law of limits as that of a chip whose place the slope takes: coefficients in N/m per
    /// slope.
    pub fn per_slope(&self) -> CuttingCoefficients {
        CuttingCoefficients {
            axial_pa: 0.0,
            radial_pa: self.per_slope_n_per_m,
            tangential_pa: self.mu * self.per_slope_n_per_m,
            edge_axial_n_per_m: 0.0,
            edge_radial_n_per_m: 0.0,
            edge_tangential_n_per_m: 0.0,
        }
    }
}
