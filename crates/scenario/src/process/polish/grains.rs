//! The `[process.polish.grains]` table: bonded grains that run over the edges of the face.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::edge_grains::BondedGrains;
use truecut_core::wheel::pneumatic::PneumaticWheel;

use crate::check::Check;
use crate::units::from_um;

/// Grains of the wheel and the edges that they run over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrainSpec {
    /// Radius of a grain.
    pub radius_m: f64,
    /// Mean of how far grains stand out of the rubber, and its standard deviation.
    pub protrusion_m: f64,
    /// Standard deviation of the protrusion.
    pub spread_m: f64,
    /// Grains per area of a new wheel.
    pub per_m2: f64,
    /// Force at which a jammed grain comes free.
    pub strength_n: f64,
    /// Share of the jammed grains that the wheel loses.
    pub shed_share: f64,
    /// Radius of the edges at the start.
    pub edge_radius_m: f64,
    /// What a jammed grain breaks off its edge.
    pub chip_m3: f64,
    /// Of the random numbers.
    pub seed: u32,
}

impl GrainSpec {
    /// The law of the grains on a wheel's rubber.
    pub fn law(&self, wheel: &PneumaticWheel) -> BondedGrains {
        let modulus_pa = wheel.contact_modulus_pa();
        let [normal_n_per_m, tangential_n_per_m] =
            BondedGrains::bedding_n_per_m(self.radius_m, modulus_pa, wheel.poisson);
        BondedGrains {
            radius_m: self.radius_m,
            protrusion_m: self.protrusion_m,
            spread_m: self.spread_m,
            strength_n: self.strength_n,
            normal_n_per_m,
            tangential_n_per_m,
        }
    }
}

/// Bonded grains, and the edges that they run over.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct GrainTable {
    /// Radius of a grain.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a grain has a size"))]
    radius_um: f64,
    /// How far grains stand out of the rubber in the mean.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "grains stand out"))]
    protrusion_um: f64,
    /// Standard deviation of that.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "no two grains stand out alike"))]
    protrusion_spread_um: f64,
    /// Number of grains per area of the wheel.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a wheel has grains"))]
    number_per_mm2: f64,
    /// Force at which a grain that is held at an edge comes free.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a bond holds"))]
    strength_n: f64,
    /// Share of those that the wheel loses; the others slip over the edge. Default: 1.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1.0, "x-rule" = "a share"))]
    shed_share: Option<f64>,
    /// Radius of the face's edges at the start.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "0 is a sharp edge"))]
    edge_radius_um: f64,
    /// Way along which a grain that comes free ploughs through the edge at its strength. Default:
    /// its radius.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "0 leaves the edge as it is"))]
    ploughing_um: Option<f64>,
    /// Energy that breaks a volume off the edge.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "an edge takes energy to break"))]
    specific_energy_j_per_mm3: f64,
    /// Seed of the random numbers. Default: 1.
    seed: Option<u32>,
}

const TABLE: &str = "process.polish.grains";

/// Largest share of the wheel's surface that round grains cover.
const DENSEST: f64 = 0.9;

impl GrainTable {
    /// Grains on a wheel whose patch has the radius `reach_m`.
    pub(super) fn resolve(
        self,
        wheel: &PneumaticWheel,
        reach_m: f64,
        check: &mut Check,
    ) -> GrainSpec {
        let spec = GrainSpec {
            radius_m: from_um(self.radius_um),
            protrusion_m: from_um(self.protrusion_um),
            spread_m: from_um(self.protrusion_spread_um),
            per_m2: self.number_per_mm2 * 1e6,
            strength_n: self.strength_n,
            shed_share: self.shed_share.unwrap_or(1.0),
            edge_radius_m: from_um(self.edge_radius_um),
            chip_m3: self.strength_n * from_um(self.ploughing_um.unwrap_or(self.radius_um))
                / (self.specific_energy_j_per_mm3 * 1e9),
            seed: self.seed.unwrap_or(1),
        };
        let rubber_um = wheel.shell_thickness_m * 1e6;
        let covered = spec.per_m2 * std::f64::consts::PI * spec.radius_m.powi(2);
        let mut at_most = |key: &str, value: f64, most: f64, because: &str| {
            if value > most {
                let most = (most * 1e3).floor() / 1e3;
                let message = format!("is {value}, but must be at most {most}: {because}");
                check.wrong(TABLE, key, message, "too large");
            }
        };
        let because = "grains stand in the wheel's rubber, whose shell_thickness_mm they must not \
                       exceed with their diameter";
        at_most("radius_um", self.radius_um, 0.5 * rubber_um, because);
        let because = "a grain that stands out by more than its diameter is not bonded";
        let diameter_um = 2.0 * self.radius_um;
        at_most("protrusion_um", self.protrusion_um, diameter_um, because);
        let because = "with more spread than protrusion many grains would lie below the rubber";
        let (spread_um, mean_um) = (self.protrusion_spread_um, self.protrusion_um);
        at_most("protrusion_spread_um", spread_um, mean_um, because);
        let densest = DENSEST * self.number_per_mm2 / covered;
        let because = "grains of this radius do not fit side by side";
        at_most("number_per_mm2", self.number_per_mm2, densest, because);
        let because = "that is the radius of the patch, beyond which an edge is no corner to it";
        at_most(
            "edge_radius_um",
            self.edge_radius_um,
            reach_m * 1e6,
            because,
        );
        spec
    }
}
