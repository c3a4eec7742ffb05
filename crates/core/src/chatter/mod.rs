//! Stability of cutting: mode coupling, regeneration, lobes.
//!
//! All of it is about small motions x of the tool point in the milling frame of
//! [`crate::cutting::milling`] under the force `F = b B(φ) (x(t) − x(t−T))`, with b the axial
//! depth, T the tooth period and B the directional matrix ([`DirectionalMatrix`], Pa). Without
//! regeneration (teeth meet the nominal surface) the delayed term is absent. A common factor ½K_t
//! is not taken out of B, so that `B = ½ K_t A` in the notation of `altintas1995`.
//!
//! | module | question |
//! | --- | --- |
//! | [`planar`] | two directions, equal mass and damping: do they flutter under a skew stiffness? |
//! | [`averaged`] | n modes under the averaged B: mode coupling, regeneration (zero-order) |
//! | [`spectral_elements`] | n modes under the periodic B: Floquet multipliers |
//! | [`growth`] | how fast a motion in the time domain grows |
//! | [`forced`] | what a motion is apart from what repeats with the teeth |
//! | [`limit`] | the depth at which a stable cut first becomes unstable |
//!
//! Each function answers for one point (one speed, one depth, one posture); whoever wants a diagram
//! calls it from as many threads as there are.

mod attached;
pub mod averaged;
mod directional;
pub mod forced;
pub mod growth;
mod krylov;
pub mod limit;
mod modes;
mod multiplier;
pub mod planar;
pub mod spectral_elements;

pub use attached::{AttachedMode, AttachedModes, SpeedTable};
pub use directional::{AveragedCut, DirectionalMatrix};
pub use modes::{TipMode, in_axes};
pub use multiplier::Multiplier;
