//! Points of a face, with the parameters at which a patch shall pass them.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::super::error::{SurfaceFault, place};
use super::chart::Chart;

/// What a point within a triangle counts beside a vertex: vertices lie on the face that was meshed,
/// chords between them do not. A long triangle holds thousands of points, which must not outweigh
/// the vertices about it.
const INNER_WEIGHT: f64 = 1e-4;
/// Triangles are looked at as finely as this share of the face's longer side.
const FINE_SHARE: f64 = 1.0 / 64.0;

/// A point of the face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) uv: [f64; 2],
    pub(super) point_m: Vector3<f64>,
    /// What it counts in the fit; 0 if only the deviation is looked at.
    pub(super) weight: f64,
    pub(super) is_vertex: bool,
}

/// All vertices, and points within triangles.
pub(super) fn taken(
    vertices_m: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    chart: &Chart,
) -> Result<Vec<Sample>, SurfaceFault> {
    let mut own: Vec<u32> = triangles.iter().flatten().copied().collect();
    own.sort_unstable();
    own.dedup();
    let mut points: Vec<(Vector3<f64>, f64, bool)> = own
        .iter()
        .map(|i| (vertices_m[*i as usize], 1.0, true))
        .collect();
    let [along_u, along_v] = chart.lengths_m();
    let fine_m = FINE_SHARE * along_u.max(along_v);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| vertices_m[i as usize]);
        let longest_m = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let parts = (longest_m / fine_m).ceil().clamp(1.0, 2.0 / FINE_SHARE) as usize;
        if parts == 1 {
            // Vertices stand as near as that: they tell the face without its chords.
            points.push(((a + b + c) / 3.0, 0.0, false));
            continue;
        }
        let share = |k: usize| k as f64 / parts as f64;
        for i in 0..=parts {
            for j in 0..=parts - i {
                let is_corner = [i, j, parts - i - j].contains(&parts);
                if !is_corner {
                    let at = a + (b - a) * share(i) + (c - a) * share(j);
                    points.push((at, INNER_WEIGHT, false));
                }
            }
        }
    }
    let laid = points.par_iter().map(|(point_m, weight, is_vertex)| {
        let uv = chart
            .place(point_m)
            .ok_or_else(|| SurfaceFault::FaceFolds {
                at: format!("{} mm", place(&(point_m * 1e3))),
            })?;
        Ok(Sample {
            uv,
            point_m: *point_m,
            weight: *weight,
            is_vertex: *is_vertex,
        })
    });
    laid.collect()
}
