//! Cutting force coefficients that are those of no metal.

use truecut_core::cutting::chamfer::CuttingCoefficients;
use truecut_recording::significant;

/// Force per chip area, Pa: soft foams have a tenth of a megapascal to some, boards, wax and wood
/// tens, plastics a hundred, metals 400 to 6000 MPa, of which the latter in GPa look like foam.
const FOAM_PA: f64 = 5e6;

/// That a workpiece is as soft as foam, if it is; one without force per area is a choice.
pub(crate) fn soft_note(coefficients: &CuttingCoefficients) -> Option<String> {
    let in_plane_pa = coefficients.tangential_pa.hypot(coefficients.radial_pa);
    (in_plane_pa > 0.0 && in_plane_pa < FOAM_PA).then(|| {
        format!(
            "cutting takes {} MPa (N/mm^2) across the chip's area, as of soft foam, and of metals 400 to 6000: are the \
             coefficients (tangential_mpa, radial_mpa, in_plane_mpa) given in GPa?",
            significant(1e-6 * in_plane_pa, 3)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(tangential_mpa: f64, radial_mpa: f64) -> Option<String> {
        soft_note(&CuttingCoefficients {
            axial_pa: 0.0,
            radial_pa: 1e6 * radial_mpa,
            tangential_pa: 1e6 * tangential_mpa,
            edge_axial_n_per_m: 0.0,
            edge_radial_n_per_m: 0.0,
            edge_tangential_n_per_m: 5e3,
        })
    }

    #[test]
    fn coefficients_in_gigapascals_are_told() {
        for tangential in [0.3, 0.7, 2.0, 3.5] {
            let note = told(tangential, 0.3 * tangential).expect("as soft as foam");
            assert!(note.contains("given in GPa?"), "{note}");
        }
        // Metals, plastics, wood, and edge forces alone.
        for (tangential, radial) in [
            (600.0, 200.0),
            (3550.0, 800.0),
            (90.0, 10.0),
            (12.0, 3.0),
            (0.0, 0.0),
        ] {
            assert_eq!(told(tangential, radial), None, "{tangential}");
        }
    }
}
