//! Triangles as they are shaded, and their sharp edges.

use std::collections::BTreeMap;

use nalgebra::Vector3;

/// Faces that meet at less than this angle are shaded as one round surface; others at an edge.
const CREASE_DEG: f64 = 35.0;

type Point = [f64; 3];

/// Triangles with their normals. A triangle that names a corner which is not there, or that has no
/// area, is left out.
pub(super) struct Surface<'a> {
    vertices_m: &'a [Point],
    faces: Vec<Face>,
}

struct Face {
    corners: [u32; 3],
    /// Of length 1.
    normal: Vector3<f64>,
    /// At its corners, rad.
    angles: [f64; 3],
}

impl<'a> Surface<'a> {
    pub(super) fn new(vertices_m: &'a [Point], triangles: &[[u32; 3]]) -> Self {
        let face = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| vertices_m.get(corner as usize));
            let [a, b, c] = [a?, b?, c?].map(|p| Vector3::from(*p));
            let square = (b - a).cross(&(c - a));
            Some(Face {
                corners: *corners,
                normal: square.try_normalize(0.0)?,
                angles: [
                    (b - a).angle(&(c - a)),
                    (c - b).angle(&(a - b)),
                    (a - c).angle(&(b - c)),
                ],
            })
        };
        Self {
            vertices_m,
            faces: triangles.iter().filter_map(face).collect(),
        }
    }

    /// Corners, their normals, and triangles of them. A corner has the mean normal of the faces
    /// about it that meet the triangle's own without a crease, weighed by their angles there
    /// (`thurmer1998`), so that it does not depend on how faces are cut into triangles; corners of
    /// equal place and normal are one.
    pub(super) fn shaded(&self) -> (Vec<Point>, Vec<Point>, Vec<[u32; 3]>) {
        let mut about: Vec<Vec<(&Face, f64)>> = vec![Vec::new(); self.vertices_m.len()];
        for face in &self.faces {
            for (corner, angle) in face.corners.into_iter().zip(face.angles) {
                about[corner as usize].push((face, angle));
            }
        }
        let least = CREASE_DEG.to_radians().cos();
        let (mut corners, mut normals) = (Vec::new(), Vec::new());
        let mut known: BTreeMap<(u32, [i32; 3]), u32> = BTreeMap::new();
        let faces = self.faces.iter().map(|face| {
            face.corners.map(|corner| {
                let round = about[corner as usize].iter();
                let round = round.filter(|(other, _)| other.normal.dot(&face.normal) >= least);
                let sum: Vector3<f64> = round.map(|(other, angle)| other.normal * *angle).sum();
                let normal = sum.try_normalize(0.0).unwrap_or(face.normal);
                // Sums in another order differ in their last digits.
                let key = (corner, normal.map(|x| (x * 1e4).round() as i32).into());
                *known.entry(key).or_insert_with(|| {
                    corners.push(self.vertices_m[corner as usize]);
                    normals.push(normal.into());
                    corners.len() as u32 - 1
                })
            })
        });
        let faces = faces.collect();
        (corners, normals, faces)
    }

    /// Edges at which faces meet in a crease, or at which the surface ends.
    pub(super) fn sharp_edges(&self) -> Vec<[Point; 2]> {
        let mut beside: BTreeMap<[u32; 2], Vec<Vector3<f64>>> = BTreeMap::new();
        for face in &self.faces {
            let [a, b, c] = face.corners;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let edge = beside.entry([from.min(to), from.max(to)]);
                edge.or_default().push(face.normal);
            }
        }
        let least = CREASE_DEG.to_radians().cos();
        let is_sharp = |normals: &[Vector3<f64>]| match normals {
            [one, other] => one.dot(other) < least,
            _ => true,
        };
        let edges = beside.iter().filter(|(_, normals)| is_sharp(normals));
        let place = |corner: u32| self.vertices_m[corner as usize];
        edges.map(|(edge, _)| edge.map(place)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube, or a prism of many sides, along z.
    fn prism(sides: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
        let rim = |z: f64| {
            (0..sides).map(move |i| {
                let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(sides)).sin_cos();
                [c, s, z]
            })
        };
        let vertices = rim(0.0).chain(rim(1.0)).collect();
        let walls = (0..sides).flat_map(|i| {
            let next = (i + 1) % sides;
            [[i, next, sides + next], [i, sides + next, sides + i]]
        });
        let lids = (1..sides - 1).flat_map(|i| [[0, i + 1, i], [sides, sides + i, sides + i + 1]]);
        (vertices, walls.chain(lids).collect())
    }

    #[test]
    fn verify_a_cube_keeps_its_faces_flat_and_has_twelve_edges() {
        let (vertices, triangles) = prism(4);
        let surface = Surface::new(&vertices, &triangles);
        let (corners, normals, faces) = surface.shaded();
        assert_eq!((corners.len(), faces.len()), (24, 12));
        for face in faces {
            let [a, b, c] = face.map(|i| Vector3::from(corners[i as usize]));
            let flat = (b - a).cross(&(c - a)).normalize();
            for i in face {
                assert!((flat - Vector3::from(normals[i as usize])).norm() < 1e-12);
            }
        }
        assert_eq!(surface.sharp_edges().len(), 12);
    }

    #[test]
    fn verify_a_round_wall_is_shaded_as_round() {
        let (vertices, triangles) = prism(24);
        let surface = Surface::new(&vertices, &triangles);
        let (corners, normals, _) = surface.shaded();
        assert_eq!(corners.len(), 2 * 48);
        for (p, n) in corners.iter().zip(&normals) {
            let off = (p[0] * n[0] + p[1] * n[1]).abs();
            assert!(off.min((1.0 - off).abs()) < 1e-9, "{p:?} {n:?}");
        }
        assert_eq!(surface.sharp_edges().len(), 48);
    }

    #[test]
    fn bad_triangles_are_left_out() {
        let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let surface = Surface::new(&vertices, &[[0, 1, 2], [0, 1, 1], [0, 1, 9]]);
        let (corners, normals, faces) = surface.shaded();
        assert_eq!((corners.len(), faces.len()), (3, 1));
        assert_eq!(normals, [[0.0, 0.0, 1.0]; 3]);
    }
}
