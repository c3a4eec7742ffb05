//! The pressure foot: pneumatic cylinders press a ring around the tool onto the workpiece.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::friction::{EquivalentViscous, FootFriction, FrictionLaw};
use truecut_core::pressure_foot::Cylinders;

use crate::check::Check;
use crate::units::{from_mm, from_mpa, from_n_per_um, from_um};

/// The pressure foot and its friction on the workpiece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FootSpec {
    /// The cylinders; without gas spring where `axial_share` says how stiff they are.
    pub cylinders: Cylinders,
    /// Share η = k/(k + k1) of an axial force that the foot carries, where k1 is the axial
    /// stiffness of the arm at the tool: the foot has a spring of this k in place of the gas.
    pub axial_share: Option<f64>,
    /// Seal friction that holds the rods, summed over all cylinders.
    pub seal_stiction_n: f64,
    /// Axial stiffness while the seals hold the rods, of the whole foot.
    pub rod_stiffness_n_per_m: f64,
    /// Friction between foot and workpiece, in the plane across the spindle.
    pub friction: FootFriction,
}

/// The pressure foot.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FootTable {
    /// Gauge pressure in the cylinders.
    #[schemars(extend(
        "minimum" = 0.0,
        "maximum" = 10.0,
        "x-rule" = "the cylinders push, 0 is a foot that only rests; compressed air has 0.4 to 1.6 MPa, and 1 MPa is 10 bar"
    ))]
    pressure_mpa: f64,
    /// Bore of one cylinder. Default: 32.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cylinder has a bore"))]
    bore_mm: Option<f64>,
    /// Number of cylinders. Default: 2.
    #[schemars(range(min = 1, max = 100), extend("x-rule" = "a foot has 1 to 100 cylinders"))]
    cylinders: Option<u32>,
    /// Length of the gas column in each cylinder. Default: 50.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a gas column has a length"))]
    gas_length_mm: Option<f64>,
    /// Exponent of the change of state. Default: 1.4 (adiabatic).
    #[schemars(
        range(min = 1.0, max = 1.67),
        extend("x-rule" = "1 is isothermal, 1.67 a monatomic gas without heat exchange")
    )]
    polytropic_exponent: Option<f64>,
    /// Share of an axial force that the foot's spring carries beside the arm; replaces the gas
    /// spring.
    #[schemars(extend(
        "minimum" = 0.0,
        "exclusiveMaximum" = 1.0,
        "x-rule" = "a share of 1 would need an infinitely stiff foot"
    ))]
    axial_share: Option<f64>,
    /// Seal friction that holds the rods, summed over all cylinders. Default: 97; 0 frees the rods.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a friction force has a magnitude"))]
    seal_stiction_n: Option<f64>,
    /// Axial stiffness while the seals hold the rods. Default: 50.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a rod is a spring"))]
    rod_stiffness_n_per_um: Option<f64>,
    /// Friction between foot and workpiece. Default: Coulomb with mu = 0.15.
    friction: Option<FrictionTable>,
}

/// Friction laws by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum LawName {
    /// No friction.
    None,
    /// Dry friction with sticking.
    #[default]
    Coulomb,
    /// The viscous law of equal energy; never sticks.
    EquivalentViscous,
    /// Dry friction that falls with speed.
    Stribeck,
}

/// Friction between foot and workpiece.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FrictionTable {
    /// Law. Default: "coulomb".
    law: Option<LawName>,
    /// Kinetic coefficient of friction. Default: 0.15.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes sliding"))]
    mu: Option<f64>,
    /// Static coefficient of friction (law "stribeck").
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes sliding"))]
    mu_static: Option<f64>,
    /// Speed over which friction falls (law "stribeck").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "friction falls over some speed"))]
    stribeck_speed_mm_per_s: Option<f64>,
    /// Smallest amplitude used in the law (law "equivalent_viscous"). Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the law divides by the amplitude"))]
    amplitude_floor_um: Option<f64>,
}

// An oiled steel foot on steel, two common Ø32 cylinders with some 10 % of their force in the
// seals.
const DEFAULT_MU: f64 = 0.15;
const DEFAULT_BORE_MM: f64 = 32.0;
const DEFAULT_CYLINDERS: u32 = 2;
const DEFAULT_GAS_LENGTH_MM: f64 = 50.0;
const DEFAULT_POLYTROPIC_EXPONENT: f64 = 1.4;
const DEFAULT_SEAL_STICTION_N: f64 = 97.0;
const DEFAULT_ROD_STIFFNESS_N_PER_UM: f64 = 50.0;
const DEFAULT_AMPLITUDE_FLOOR_UM: f64 = 1.0;

/// Below this springs and forces are divided by what rounding leaves.
const LEAST_PRESSURE_MPA: f64 = 1e-6;

impl FootTable {
    /// `table` is the dotted path of this table, `frequency_rad_s` that of the force that shakes
    /// the foot.
    pub(crate) fn resolve(self, table: &str, frequency_rad_s: f64, check: &mut Check) -> FootSpec {
        if self.axial_share.is_some() {
            let because = "axial_share replaces the gas spring";
            check.ignored(table, &["gas_length_mm", "polytropic_exponent"], because);
        }
        if self.pressure_mpa > 0.0 && self.pressure_mpa < LEAST_PRESSURE_MPA {
            let message = format!(
                "is {:e}, but must be 0 or at least {LEAST_PRESSURE_MPA:e}: a pascal is next to nothing",
                self.pressure_mpa
            );
            check.wrong(table, "pressure_mpa", message, "neither 0 nor a pressure");
        }
        let (gas_length_m, polytropic_exponent) = match self.axial_share {
            Some(_) => (f64::INFINITY, 1.0),
            None => (
                from_mm(self.gas_length_mm.unwrap_or(DEFAULT_GAS_LENGTH_MM)),
                self.polytropic_exponent
                    .unwrap_or(DEFAULT_POLYTROPIC_EXPONENT),
            ),
        };
        let friction = self.friction.unwrap_or_default();
        FootSpec {
            cylinders: Cylinders {
                count: f64::from(self.cylinders.unwrap_or(DEFAULT_CYLINDERS)),
                bore_m: from_mm(self.bore_mm.unwrap_or(DEFAULT_BORE_MM)),
                gas_length_m,
                pressure_pa: from_mpa(self.pressure_mpa),
                polytropic_exponent,
            },
            axial_share: self.axial_share,
            seal_stiction_n: self.seal_stiction_n.unwrap_or(DEFAULT_SEAL_STICTION_N),
            rod_stiffness_n_per_m: from_n_per_um(
                self.rod_stiffness_n_per_um
                    .unwrap_or(DEFAULT_ROD_STIFFNESS_N_PER_UM),
            ),
            friction: friction.resolve(&format!("{table}.friction"), frequency_rad_s, check),
        }
    }
}

impl FrictionTable {
    fn resolve(self, table: &str, frequency_rad_s: f64, check: &mut Check) -> FootFriction {
        let stribeck_only = ["mu_static", "stribeck_speed_mm_per_s"];
        let viscous_only = ["amplitude_floor_um"];
        let mu = self.mu.unwrap_or(DEFAULT_MU);
        match self.law.unwrap_or_default() {
            LawName::None => {
                let because = "with law = \"none\" there is no friction";
                check.ignored(table, &["mu"], because);
                check.ignored(table, &stribeck_only, because);
                check.ignored(table, &viscous_only, because);
                FootFriction::Law(FrictionLaw::None)
            }
            LawName::Coulomb => {
                let because = "law = \"coulomb\" has one coefficient, mu";
                check.ignored(table, &stribeck_only, because);
                check.ignored(table, &viscous_only, because);
                FootFriction::Law(FrictionLaw::Coulomb { mu })
            }
            LawName::EquivalentViscous => {
                let because = "law = \"equivalent_viscous\" does not use it";
                check.ignored(table, &stribeck_only, because);
                let floor_um = self
                    .amplitude_floor_um
                    .unwrap_or(DEFAULT_AMPLITUDE_FLOOR_UM);
                FootFriction::Equivalent(EquivalentViscous {
                    mu,
                    frequency_rad_s,
                    amplitude_floor_m: from_um(floor_um),
                })
            }
            LawName::Stribeck => self.stribeck(mu, table, check),
        }
    }

    fn stribeck(&self, mu: f64, table: &str, check: &mut Check) -> FootFriction {
        check.ignored(
            table,
            &["amplitude_floor_um"],
            "law = \"stribeck\" does not use it",
        );
        let who = "law = \"stribeck\"";
        let mu_static = check.needed(table, "mu_static", self.mu_static, who);
        let speed = check.needed(
            table,
            "stribeck_speed_mm_per_s",
            self.stribeck_speed_mm_per_s,
            who,
        );
        if let Some(mu_static) = mu_static.filter(|mu_static| *mu_static < mu) {
            let message = format!(
                "is {mu_static}, but must be at least mu = {mu}: friction falls once sliding starts"
            );
            check.wrong(table, "mu_static", message, format!("less than mu = {mu}"));
        }
        FootFriction::Law(FrictionLaw::Stribeck {
            mu,
            mu_static: mu_static.unwrap_or(mu),
            stribeck_speed_m_per_s: from_mm(speed.unwrap_or(1.0)),
        })
    }
}
