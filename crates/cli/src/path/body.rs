//! Whether a face lies on the body that the job says it is part of.

use nalgebra::Vector3;
use truecut_plan::surface::{Domain, Forms, Mesh, PatchFile};
use truecut_scenario::PathJob;

use crate::failure::Failure;

/// Places along each parameter at which the face is held against the body.
const PLACES: usize = 17;

/// Units that a mesh may have been written in.
const UNITS: [(&str, f64); 4] = [("mm", 1e-3), ("inches", 25.4e-3), ("cm", 1e-2), ("m", 1.0)];

/// The face must lie on the body to what the wheel may be pressed in: where it lies further off,
/// the wheel either does not reach the body or would be refused there.
///
/// # Errors
/// At the place that is furthest off, with the unit in which the body would fit, if there is one.
pub fn check(job: &PathJob, patch: &PatchFile, body: &Mesh) -> Result<(), Failure> {
    let limit_m = job.path.gouge_limit_m;
    let places = places(patch);
    // The farthest place for a body that is larger by a factor.
    let farthest = |factor: f64| {
        let off = |at: &Vector3<f64>| body.nearest(&(at / factor)).distance_m.abs() * factor;
        let each = places.iter().map(|at| (off(at), *at));
        each.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let Some((off_m, at)) = farthest(1.0).filter(|(off_m, _)| *off_m > limit_m) else {
        return Ok(());
    };
    let unit_m = job.surface.body.as_ref().map_or(1e-3, |body| body.unit_m);
    let fits = |factor: f64| farthest(factor).is_some_and(|(off_m, _)| off_m <= limit_m);
    let other = UNITS.iter().find(|(_, other_m)| fits(other_m / unit_m));
    let hint = match other {
        Some((name, other_m)) => format!(
            "; in {name} it would: `surface.body_unit_mm = {}`",
            other_m * 1e3
        ),
        None => "; is it another part, or has it another frame?".to_owned(),
    };
    let at = at * 1e3;
    let message = format!(
        "the face does not lie on the body: at ({:.3}, {:.3}, {:.3}) mm in the patch's frame it is \
         {:.3} mm from it, but must be within {:.3} mm, `path.gouge_limit_mm`{hint}",
        at.x,
        at.y,
        at.z,
        off_m * 1e3,
        limit_m * 1e3
    );
    Err(job.problem("surface.body", message).into())
}

/// Places of the face, even in its parameters.
fn places(patch: &PatchFile) -> Vec<Vector3<f64>> {
    let Domain { u, v } = patch.surface.domain();
    let at = |range: [f64; 2], k: usize| {
        range[0] + (range[1] - range[0]) * k as f64 / (PLACES - 1) as f64
    };
    let jets =
        (0..PLACES * PLACES).map(|k| (patch.surface).jet(at(u, k / PLACES), at(v, k % PLACES)));
    let on_face = jets.filter(|jet| {
        patch.boundary.as_ref().is_none_or(|boundary| {
            Forms::of(jet).is_some_and(|forms| {
                let along = jet.first_m[0].normalize();
                let axes = [along, forms.normal.cross(&along)];
                boundary.holds_rectangle(&jet.point_m, axes, [0.0; 2])
            })
        })
    });
    on_face.map(|jet| jet.point_m).collect()
}
