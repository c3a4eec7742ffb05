//! The wheel's unevenness under its patch.

use super::PolishSetup;
use crate::process::ToolState;
use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use truecut_core::wheel::texture::PatchTexture;

/// What the patch at the nominal indentation feels of the texture.
pub(super) fn under_patch(setup: &PolishSetup) -> Option<PatchTexture> {
    let spec = setup.spec.texture?;
    let mut rng = ChaCha8Rng::seed_from_u64(u64::from(spec.seed));
    let circumference_m = setup.spec.touching_circumference_m();
    let patch_m = setup
        .spec
        .wheel
        .patch(&setup.shell, setup.indentation_m)
        .contact_m();
    let normal = || StandardNormal.sample(&mut rng);
    Some((spec.texture).under_patch(circumference_m, patch_m, normal))
}

/// By how much the radius is larger under the patch, m, and at which rate it grows, m/s.
pub(super) fn at(texture: &PatchTexture, setup: &PolishSetup, state: &ToolState) -> [f64; 2] {
    let into_face = setup.world_from_face.rotation * -Vector3::z();
    let in_tool = state.world_from_tool.rotation.inverse() * into_face;
    let spin_rad_s = setup.spec.spin_rad_s;
    // A positive spin turns the wheel from the tool's y axis to its x axis, past a patch that
    // stays.
    let angle_rad = in_tool.y.atan2(in_tool.x) + spin_rad_s * state.time_s;
    texture.at(angle_rad, spin_rad_s)
}
