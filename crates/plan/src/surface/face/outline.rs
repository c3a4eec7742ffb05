//! The lines around a face.

use std::collections::{BTreeMap, HashSet};

use nalgebra::{Unit, Vector3};

use super::super::error::{SurfaceFault, place};

/// Corners of a closed line, none repeated; the face lies on its left seen from outside.
#[derive(Debug, Clone)]
pub(super) struct Loop {
    pub(super) points_m: Vec<Vector3<f64>>,
}

impl Loop {
    /// Area seen along a direction, positive if the line runs round counter-clockwise.
    fn area_m2(&self, along: &Unit<Vector3<f64>>) -> f64 {
        let first = self.points_m[0];
        let parts = (self.points_m.windows(2)).map(|w| (w[0] - first).cross(&(w[1] - first)));
        0.5 * parts.sum::<Vector3<f64>>().dot(along)
    }
}

/// The line around a face, and those around its holes.
pub(super) fn loops(
    vertices_m: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    normal: &Unit<Vector3<f64>>,
) -> Result<(Loop, Vec<Loop>), SurfaceFault> {
    let sides = || (triangles.iter()).flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]);
    let known: HashSet<(u32, u32)> = sides().collect();
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    for (from, to) in sides().filter(|(from, to)| !known.contains(&(*to, *from))) {
        if next.insert(from, to).is_some() {
            return Err(SurfaceFault::PinchedFace {
                at: place(&(vertices_m[from as usize] * 1e3)),
            });
        }
    }
    let mut found = Vec::new();
    while let Some((start, mut at)) = next.pop_first() {
        let mut points_m = vec![vertices_m[start as usize]];
        while at != start {
            points_m.push(vertices_m[at as usize]);
            // Every corner is left as often as it is reached.
            match next.remove(&at) {
                Some(to) => at = to,
                None => break,
            }
        }
        found.push(Loop { points_m });
    }
    let size = |line: &Loop| line.area_m2(normal);
    let outer = (0..found.len()).max_by(|a, b| size(&found[*a]).total_cmp(&size(&found[*b])));
    match outer {
        Some(outer) => {
            let line = found.swap_remove(outer);
            Ok((line, found))
        }
        None => Err(SurfaceFault::FewCorners { count: 0 }),
    }
}

/// Indices of the corners of a closed line that are left where those within a distance of the
/// straight line between their neighbours are left out (Douglas and Peucker).
pub(super) fn kept(points_m: &[Vector3<f64>], within_m: f64) -> Vec<usize> {
    let count = points_m.len();
    let away = |i: &usize| (points_m[*i] - points_m[0]).norm_squared();
    let farthest = (0..count).max_by(|a, b| away(a).total_cmp(&away(b)));
    let half = farthest.unwrap_or(0);
    let mut keep = vec![false; count];
    keep[0] = true;
    keep[half] = true;
    let mut spans = vec![(0, half), (half, count)];
    while let Some((from, to)) = spans.pop() {
        let (a, b) = (points_m[from], points_m[to % count]);
        let way = b - a;
        let off = |p: &Vector3<f64>| {
            let along = (p - a).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE);
            (p - a - way * along.clamp(0.0, 1.0)).norm()
        };
        let worst = (from + 1..to).map(|i| (off(&points_m[i]), i));
        let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, i)) = worst.filter(|(off_m, _)| *off_m > within_m) {
            keep[i] = true;
            spans.extend([(from, i), (i, to)]);
        }
    }
    (0..count).filter(|i| keep[*i]).collect()
}

pub(super) fn simplified(points_m: &[Vector3<f64>], within_m: f64) -> Vec<Vector3<f64>> {
    let places = kept(points_m, within_m);
    // A line so small that only two corners are left stays as it is.
    if places.len() < 3 {
        return points_m.to_vec();
    }
    places.iter().map(|i| points_m[*i]).collect()
}
