//! Which triangles meet at which edges.

use nalgebra::Vector3;

use super::Defects;
use super::weld::Welded;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// Neighbours, normals and areas of the triangles.
#[derive(Debug)]
pub(super) struct Topology {
    /// Across the side from corner k to corner k + 1; none where the edge is open or not manifold.
    pub(super) neighbours: Vec<[u32; 3]>,
    /// Of length 1; zero where a triangle is so low that it has none to trust. As most triangles
    /// of the piece are wound.
    pub(super) normals: Vec<Vector3<f32>>,
    pub(super) areas_m2: Vec<f64>,
    pub(super) shells: usize,
}

/// A side of a triangle: its vertices, the lower first, triangle × 3 + corner, and whether the
/// triangle goes round it from the lower to the higher.
struct Side {
    ends: [u32; 2],
    half: u32,
    rises: bool,
}

impl Topology {
    pub(super) fn of(mesh: &Welded, weld_m: f64, tiny_m: f64, defects: &mut Defects) -> Self {
        let (normals, areas_m2) = shapes(mesh, weld_m, tiny_m, defects);
        let mut sides = Vec::with_capacity(3 * mesh.triangles.len());
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            for k in 0..3 {
                let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
                sides.push(Side {
                    ends: [from.min(to), from.max(to)],
                    half: (3 * index + k) as u32,
                    rises: from < to,
                });
            }
        }
        sides.sort_unstable_by_key(|side| (side.ends, side.half));
        let mut topology = Self {
            neighbours: vec![[NONE; 3]; mesh.triangles.len()],
            normals,
            areas_m2,
            shells: 0,
        };
        // A set bit: the neighbour there is wound against this triangle.
        let mut against = vec![0_u8; mesh.triangles.len()];
        for users in sides.chunk_by(|one, other| one.ends == other.ends) {
            let middle = || {
                let ends = users[0].ends.map(|i| mesh.vertices_m[i as usize]);
                (ends[0] + ends[1]) / 2.0
            };
            match users {
                [_] => defects.open_edges.add(middle),
                [one, other] => {
                    for (here, there) in [(one, other), (other, one)] {
                        let (triangle, k) = (here.half as usize / 3, here.half as usize % 3);
                        topology.neighbours[triangle][k] = there.half / 3;
                        against[triangle] |= u8::from(one.rises == other.rises) << k;
                    }
                }
                _ => defects.non_manifold_edges.add(middle),
            }
        }
        drop(sides);
        topology.wind(mesh, &against, defects);
        topology
    }

    /// Goes through each piece; the lesser part of it, by number, is inverted where its triangles
    /// are not wound one way, and its normals are turned round.
    fn wind(&mut self, mesh: &Welded, against: &[u8], defects: &mut Defects) {
        let count = self.neighbours.len();
        // 0 not seen yet, 1 as the first of the piece, 2 against it.
        let mut sense = vec![0_u8; count];
        let mut piece = Vec::new();
        for first in 0..count {
            if sense[first] != 0 {
                continue;
            }
            self.shells += 1;
            piece.clear();
            piece.push(first as u32);
            sense[first] = 1;
            let mut done = 0;
            while let Some(triangle) = piece.get(done).map(|t| *t as usize) {
                done += 1;
                for k in 0..3 {
                    let next = self.neighbours[triangle][k];
                    if next != NONE && sense[next as usize] == 0 {
                        let turned = against[triangle] >> k & 1 == 1;
                        let same = sense[triangle];
                        sense[next as usize] = if turned { 3 - same } else { same };
                        piece.push(next);
                    }
                }
            }
            let turned = piece.iter().filter(|t| sense[**t as usize] == 2).count();
            let inverted = if 2 * turned > piece.len() { 1 } else { 2 };
            let mut wrong: Vec<u32> = (piece.iter().copied())
                .filter(|t| sense[*t as usize] == inverted)
                .collect();
            wrong.sort_unstable();
            for triangle in wrong {
                (defects.inverted_triangles).add(|| mesh.middle(triangle as usize));
                self.normals[triangle as usize] *= -1.0;
            }
        }
    }
}

fn shapes(
    mesh: &Welded,
    weld_m: f64,
    tiny_m: f64,
    defects: &mut Defects,
) -> (Vec<Vector3<f32>>, Vec<f64>) {
    let shape = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle);
        let square = (b - a).cross(&(c - a));
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let twice_m2 = square.norm();
        // The height over the longest side.
        let normal = if twice_m2 <= weld_m.max(1e-7 * longest) * longest {
            defects.degenerate_triangles.add(|| mesh.middle(triangle));
            Vector3::zeros()
        } else {
            if longest < tiny_m {
                defects.tiny_triangles.add(|| mesh.middle(triangle));
            }
            (square / twice_m2).cast::<f32>()
        };
        (normal, twice_m2 / 2.0)
    };
    (0..mesh.triangles.len()).map(shape).unzip()
}
