//! Heavy meshes thinned for drawing: vertices in one cell of a grid become one, at their mean
//! (`rossignac1993`); triangles that this collapses, or makes equal, are left out. No vertex moves
//! further than the diagonal of a cell.

use std::collections::{BTreeSet, HashMap};

use nalgebra::Vector3;

use super::DrawnMesh;
use crate::meshes::{Part, Triangle};
use crate::visual::DEFAULT_RGBA;

/// Most triangles of a file that are drawn as they are.
const MOST_TRIANGLES: usize = 2_500;
/// Cells along the diagonal of a heavier mesh, the first that leaves no more triangles.
const CELLS: [u32; 8] = [160, 120, 90, 70, 50, 36, 24, 12];
/// Of a mesh that is kept: corners closer than this part of its diagonal are one.
const SAME: f64 = 1e-7;

/// The parts of a file as they are drawn, in a colour given, else in their own.
pub(super) fn thinned(parts: Vec<Part>, color_rgba: Option<[f32; 4]>) -> Vec<DrawnMesh> {
    let count: usize = parts.iter().map(|part| part.triangles.len()).sum();
    let grids = CELLS.iter().map(|cells| 1.0 / f64::from(*cells));
    let with = |share: f64| -> Vec<DrawnMesh> {
        let grid = Grid::over(&parts, share);
        let drawn = parts.iter().map(|part| DrawnMesh {
            color_rgba: color_rgba.or(part.color_rgba).unwrap_or(DEFAULT_RGBA),
            ..grid.joined(&part.triangles)
        });
        drawn.filter(|mesh| !mesh.triangles.is_empty()).collect()
    };
    if count <= MOST_TRIANGLES {
        return with(SAME);
    }
    let mut coarsest = Vec::new();
    for share in grids {
        coarsest = with(share);
        let count: usize = coarsest.iter().map(|mesh| mesh.triangles.len()).sum();
        if count <= MOST_TRIANGLES {
            break;
        }
    }
    coarsest
}

/// Cubic cells over the bounding box of a file.
struct Grid {
    low: Vector3<f64>,
    cell_m: f64,
}

impl Grid {
    /// Cells of a share of the box's diagonal.
    fn over(parts: &[Part], share: f64) -> Self {
        let corners = || {
            parts
                .iter()
                .flat_map(|part| part.triangles.iter().flatten())
        };
        let first = corners().next().copied().unwrap_or_default();
        let low = corners().fold(first, |low, p| low.inf(p));
        let high = corners().fold(first, |high, p| high.sup(p));
        Self {
            low,
            cell_m: share * (high - low).norm().max(f64::MIN_POSITIVE.sqrt()),
        }
    }

    fn joined(&self, triangles: &[Triangle]) -> DrawnMesh {
        let mut known: HashMap<[i64; 3], u32> = HashMap::new();
        let mut sums: Vec<(Vector3<f64>, f64)> = Vec::new();
        let mut faces = BTreeSet::new();
        for triangle in triangles {
            let corners = triangle.map(|corner| {
                let at = ((corner - self.low) / self.cell_m).map(|x| x.round() as i64);
                let index = *known.entry(at.into()).or_insert_with(|| {
                    sums.push((Vector3::zeros(), 0.0));
                    sums.len() as u32 - 1
                });
                let (sum, count) = &mut sums[index as usize];
                *sum += corner - self.low;
                *count += 1.0;
                index
            });
            let [a, b, c] = corners;
            if a != b && b != c && c != a {
                // The same triangle however it is written.
                let first = corners.into_iter().min().unwrap_or(a);
                faces.insert(match first {
                    _ if first == a => [a, b, c],
                    _ if first == b => [b, c, a],
                    _ => [c, a, b],
                });
            }
        }
        let mean = |(sum, count): &(Vector3<f64>, f64)| self.low + sum / *count;
        DrawnMesh {
            vertices_m: sums.iter().map(mean).collect(),
            triangles: faces.into_iter().collect(),
            color_rgba: DEFAULT_RGBA,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of many triangles.
    fn ball(rings: usize) -> Part {
        let point = |i: usize, j: usize| {
            let (a, b) = (i as f64 / rings as f64, j as f64 / rings as f64);
            let (polar, about) = (a * std::f64::consts::PI, b * std::f64::consts::TAU);
            Vector3::new(
                polar.sin() * about.cos(),
                polar.sin() * about.sin(),
                polar.cos(),
            )
        };
        let quad = |i: usize, j: usize| {
            let [a, b] = [point(i, j), point(i + 1, j)];
            let [c, d] = [point(i + 1, j + 1), point(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let quads = (0..rings).flat_map(|i| (0..rings).map(move |j| (i, j)));
        Part {
            triangles: quads.flat_map(|(i, j)| quad(i, j)).collect(),
            color_rgba: None,
        }
    }

    #[test]
    fn a_light_mesh_keeps_its_triangles_and_shares_its_corners() {
        let part = ball(30);
        let drawn = thinned(vec![part], None);
        // Triangles at the poles have no area.
        assert_eq!(drawn[0].triangles.len(), 2 * 30 * 30 - 2 * 30);
        assert_eq!(drawn[0].vertices_m.len(), 29 * 30 + 2);
    }

    #[test]
    fn verify_a_heavy_mesh_is_light_and_stays_within_a_cell_of_itself() {
        let drawn = thinned(vec![ball(200)], Some([1.0, 0.0, 0.0, 1.0]));
        let count = drawn[0].triangles.len();
        assert!((500..=MOST_TRIANGLES).contains(&count), "{count}");
        assert_eq!(drawn[0].color_rgba, [1.0, 0.0, 0.0, 1.0]);
        let diagonal = 12.0_f64.sqrt();
        let furthest = (drawn[0].vertices_m.iter())
            .map(|p| (p.norm() - 1.0).abs())
            .fold(0.0, f64::max);
        assert!(furthest < diagonal / 24.0, "{furthest}");
        // Still wound outwards and closed: the volume of a ball, less what its facets cut off.
        let volume: f64 = (drawn[0].triangles.iter())
            .map(|t| t.map(|i| drawn[0].vertices_m[i as usize]))
            .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
            .sum();
        assert!(
            (0.95..1.0).contains(&(volume / (4.0 / 3.0 * std::f64::consts::PI))),
            "{volume}"
        );
    }
}
