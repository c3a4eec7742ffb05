//! The worn flank of a cutter: the wear land of `[process.milling.cutter]` or of the coefficients,
//! and how the workpiece resists it.

use truecut_core::cutting::milling::flank::Flank;

use crate::check::Check;
use crate::fault::Fault;
use crate::process::material::Indentation;

impl Indentation {
    /// The flank of a cutter in `cutter` that cuts along an arc, whose own wear land counts before
    /// that of the material.
    pub(in crate::process) fn resolve(
        &self,
        cutter: &str,
        own_wear_land_m: Option<f64>,
        arc_m: f64,
        check: &mut Check,
    ) -> Flank {
        let own = format!("{cutter}.wear_land_mm");
        let (key, wear_land_m) = match own_wear_land_m {
            Some(own_m) => (own.as_str(), own_m),
            None => (self.wear_land.as_str(), self.wear_land_m.unwrap_or(0.0)),
        };
        if wear_land_m == 0.0 {
            return Flank::default();
        }
        let Some(n_per_m3) = self.n_per_m3 else {
            let message = format!(
                "`{key}`: a wear land of {} mm is given, but the coefficients have no \
                 `indentation_n_per_mm3`: how the workpiece resists the flank is not known",
                wear_land_m * 1e3
            );
            check.refuse(Fault::value(key, message, "no resistance to it"));
            return Flank::default();
        };
        if wear_land_m >= arc_m {
            let message = format!(
                "`{key}`: the wear land is {} mm wide, but must be less than the {:.4} mm that a tooth \
                 cuts along: it would be wider than its contact",
                wear_land_m * 1e3,
                arc_m * 1e3
            );
            check.refuse(Fault::value(key, message, "wider than the contact"));
        }
        Flank::worn(n_per_m3, wear_land_m, self.mu.unwrap_or(0.0))
    }
}
