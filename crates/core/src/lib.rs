//! The analytic core of truecut: process physics as pure functions.
//!
//! Nothing here knows an engine, a file, a clock or a log. Every function takes SI values and
//! returns SI values; every state that a law must remember (the rim that earlier passes left, the
//! seal of a cylinder) is a plain value that the caller owns, so that a law can be evaluated as
//! often as one likes and its memory advanced exactly once per step.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`friction`] | planar friction laws and the impulse that sticks or slides |
//! | [`joint_law`] | play, hysteresis, ripple and friction of a joint |
//! | [`pressure_foot`] | gas spring, seal stiction, lift-off |
//! | [`cutting`] | chip area, cutting forces, milling, and the surface that cutting leaves |
//! | [`chatter`] | stability: mode coupling, regeneration, lobes |
//! | [`oscillator`] | one damped oscillator, stepped exactly |
//! | [`wheel`] | contact and removal of wheels, belts and brushes, also over edges |
//! | [`sensor`] | what a sensor makes of a channel |
//! | [`stiffness`] | the stiffness ellipsoid and its sections |
//! | [`roots`] | bisection, Newton's iteration, regula falsi |
//! | [`roughness`] | figures of a measured or simulated surface profile |
//!
//! ```
//! use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients};
//!
//! // Dong et al. 2018 at full depth: 1 mm chamfer, 45 degrees, 0.05 mm per revolution.
//! let chip = ChipArea::new(45f64.to_radians());
//! let area_m2 = chip.nominal_m2(1.0e-3, 0.05e-3);
//! let k = CuttingCoefficients::from_resultant(1.96e9, 2.14e9, 0.3);
//! assert!((k.in_plane_pa() * area_m2 - 109.68).abs() < 0.01); // newton
//! ```

pub mod chatter;
pub mod cutting;
pub mod friction;
pub mod joint_law;
mod legendre;
pub mod oscillator;
pub mod pressure_foot;
pub mod roots;
pub mod roughness;
pub mod sensor;
pub mod stiffness;
pub mod wheel;
