//! Peripheral milling with an end mill: linear-edge forces, the surface that earlier teeth left,
//! the finished walls.
//!
//! # Milling frame
//!
//! x is the feed of the tool relative to the workpiece, z the tool axis pointing from the tip up
//! into the spindle, y = z × x. The tool turns clockwise seen from above, as a right-hand cutter
//! does. The angle φ of a tooth is measured from +y towards +x, so that a tooth at φ points along
//! (sin φ, cos φ), cuts while sin φ > 0, and the nominal chip is `c sin φ` with c the feed per
//! tooth (`altintas2012`, section 2.5, whose axes these are).
//!
//! | engagement | angles |
//! | --- | --- |
//! | slot | 0 … π |
//! | up-milling, radial depth a, diameter D | 0 … acos(1 − 2a/D) |
//! | down-milling | acos(2a/D − 1) … π |
//!
//! Forces act on the tool: tangential against the motion of the tooth, radial towards the axis,
//! axial along +z. Publications differ in the sign of K_ac; here a positive one pushes the tool
//! into the spindle.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`cutter`] | teeth, helix, runout, flank |
//! | [`profile`] | flat, bull-nose and ball: the outline of the body of teeth |
//! | [`engagement`] | entry and exit angles, the stock |
//! | [`flank`] | the worn flank, which damps |
//! | [`nominal`] | forces of the nominal chip in closed form, at an angle and averaged |
//! | [`memory`] | where the tool stood when earlier teeth passed: the surface they left |
//! | [`cut`] | forces of a vibrating tool against that surface |
//! | [`dexel`] | the finished walls and floor as dexels |
//! | [`layered`] | a cut along any path in a body of stock |
//! | [`swivel`] | one whose axis turns on its way |
//! | [`finish`] | surface location error, roughness, chatter marks |

pub mod cut;
pub mod cutter;
pub mod dexel;
mod earlier;
pub mod engagement;
pub mod finish;
pub mod flank;
pub mod layered;
pub mod memory;
pub mod nominal;
mod parameters;
pub mod profile;
mod slice;
pub(crate) mod sweep;
pub mod swivel;

/// Why a milling cut cannot be what was asked for.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MillingError {
    #[error("the cutter has no teeth; it needs at least 1")]
    NoTeeth,
    #[error("the cutter radius is {radius_m} m; it must be positive and finite")]
    Radius { radius_m: f64 },
    #[error("the helix angle is {helix_angle_rad} rad; it must lie between -1.4 and 1.4 rad")]
    Helix { helix_angle_rad: f64 },
    #[error(
        "the runout of {runout_m} m is not smaller than half the cutter radius of {radius_m} m"
    )]
    Runout { runout_m: f64, radius_m: f64 },
    #[error(
        "the corner radius is {corner_radius_m} m; it must be from 0 to the cutter radius, {radius_m} m"
    )]
    Corner { corner_radius_m: f64, radius_m: f64 },
    #[error(
        "the radial depth of cut is {radial_depth_m} m; it must be positive and at most the cutter diameter, {diameter_m} m"
    )]
    RadialDepth {
        radial_depth_m: f64,
        diameter_m: f64,
    },
}

/// Inputs that several tests share.
#[cfg(test)]
pub(crate) mod examples {
    use crate::cutting::chamfer::CuttingCoefficients;

    /// Al 7075-T6 with edge forces on all three axes.
    pub(crate) fn aluminium() -> CuttingCoefficients {
        CuttingCoefficients {
            tangential_pa: 767.0e6,
            radial_pa: 168.8e6,
            axial_pa: 222.0e6,
            edge_tangential_n_per_m: 27.7e3,
            edge_radial_n_per_m: 26.6e3,
            edge_axial_n_per_m: 1.5e3,
        }
    }
}
