//! What a tool whose axis turns leaves: the part with its error, the stock from above.

use super::report::spread;
use crate::process::Findings;
use nalgebra::Vector3;
use truecut_core::cutting::milling::swivel::cut::SwivelCut;
use truecut_core::cutting::milling::swivel::field::DistanceField;
use truecut_core::cutting::milling::swivel::way::SwivelMeant;
use truecut_recording::PartMesh;

/// The part with what is left beyond the target, and its figures.
pub(super) fn findings(cut: &SwivelCut, meant: &SwivelMeant, findings: &mut Findings) {
    let surface = cut.stock().surface();
    let left = |place: &Vector3<f64>| meant.left_m(place);
    let left_m: Vec<Option<f64>> = surface.places_m.iter().map(left).collect();
    let known: Vec<f64> = left_m.iter().copied().flatten().collect();
    spread(findings, "surface_error", "faces that were cut", &known);
    let mut part = PartMesh::default();
    for triangle in &surface.triangles {
        let corner = |k: usize| surface.places_m[k];
        part.triangles_m
            .push(triangle.map(|k| [corner(k).x, corner(k).y, corner(k).z].map(|x| x as f32)));
        part.left_m
            .push(triangle.map(|k| left_m[k].unwrap_or(f64::NAN) as f32));
    }
    findings.part = Some(part);
}

/// How deep below the stock's upper face it stands in a column of the grid, m.
pub(super) fn depth_m(stock: &DistanceField, [column, row]: [usize; 2]) -> f64 {
    let top = stock.nodes()[2] - 1;
    let is_left = |level: &usize| stock.values()[stock.node([column, row, *level])] > 0.0;
    let highest = (0..=top).rev().find(is_left);
    let cut = highest.map_or(top, |level| top - level);
    cut as f64 * stock.spacing_m().z
}
