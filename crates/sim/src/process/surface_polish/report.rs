//! What such a run ends with: force, removal and its evenness, roughness.

use super::SurfacePolishSetup;
use crate::process::Findings;
use crate::process::belt::report::Sums;
use crate::process::pressing::Pressing;
use crate::process::quantity::{self, Quantity};
use truecut_core::wheel::force_control::ForceControl;
use truecut_core::wheel::removal::SurfaceGrid;
use truecut_recording::Unit;

pub(super) fn findings(
    setup: &SurfacePolishSetup,
    grid: &SurfaceGrid,
    pressing: &Pressing,
    preston_j: f64,
) -> Findings {
    let (mut face, mut inner) = (Sums::default(), Sums::default());
    for (cell, depth) in grid.removed_m().iter().enumerate() {
        let ra_m = setup.abrasive.polishing.ra_m(grid.dose_j_per_m2()[cell]);
        if setup.is_face[cell] {
            face.add(setup.area_m2[cell], *depth, ra_m);
        }
        if setup.is_inner[cell] {
            inner.add(setup.area_m2[cell], *depth, ra_m);
        }
    }
    let preston_m3 = setup.abrasive.preston_per_pa * preston_j;
    let mut quantities = pressed(setup, pressing);
    quantities.extend(removed(grid.volume_m3(), preston_m3));
    quantities.extend(left(&face, &inner));
    Findings {
        scalars: quantity::scalars(quantities),
        overload: pressing.at_stop(&setup.control),
        ..Findings::default()
    }
}

/// How the wheel pressed.
fn pressed(setup: &SurfacePolishSetup, pressing: &Pressing) -> Vec<Quantity> {
    let force = |name, value| Quantity::new(name, Unit::Newton, value);
    let mut quantities = vec![
        force("surface_polish.mean_force", pressing.mean_n())
            .text("Mean normal force while the wheel is on the face"),
        force("surface_polish.force_spread", pressing.spread_n())
            .text("Standard deviation of the normal force while the wheel is on the face, setting down and lifting included"),
        force("surface_polish.largest_force", pressing.largest_n).text("Largest normal force"),
        Quantity::new("surface_polish.contact_time", Unit::Second, pressing.contact_s)
            .text("Time that the wheel is on the face"),
    ];
    if setup.control != ForceControl::Position {
        let stopped = pressing.stopped();
        quantities.push(Quantity::new("surface_polish.carrier_at_stop", Unit::One, stopped)
            .text("Part of the time on the face during which the carrier stands at an end of its stroke, and the force is not the one asked for"));
    }
    quantities
}

fn removed(volume_m3: f64, preston_m3: f64) -> [Quantity; 2] {
    [
        Quantity::new("surface_polish.removed_volume", Unit::CubicMetre, volume_m3)
            .text("Volume removed from the face"),
        Quantity::new(
            "surface_polish.preston_volume",
            Unit::CubicMetre,
            preston_m3,
        )
        .text("Preston's integral k_p ∫ p v dA dt"),
    ]
}

/// What is left: depths and roughness.
fn left(face: &Sums, inner: &Sums) -> [Quantity; 7] {
    let length = |name, value| Quantity::new(name, Unit::Metre, value);
    let share = |name, value| Quantity::new(name, Unit::One, value);
    [
        length("surface_polish.depth_mean", face.mean_m()).text("Mean depth over the whole face"),
        length("surface_polish.depth_inner", inner.mean_m())
            .text("Mean depth further than twice the inset from borders and holes"),
        length("surface_polish.depth_largest", face.largest).text("Largest depth of a cell"),
        share("surface_polish.unevenness", inner.unevenness())
            .text("Standard deviation of the depth over its mean, further than twice the inset from borders and holes"),
        share("surface_polish.untouched", face.untouched / face.area)
            .text("Share of the whole face from which nothing is taken"),
        length("surface_polish.roughness_mean", face.roughness / face.area)
            .text("Mean Ra over the whole face"),
        length("surface_polish.roughness_inner", inner.roughness / inner.area)
            .text("Mean Ra further than twice the inset from borders and holes"),
    ]
}
