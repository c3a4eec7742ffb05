//! A workpiece as a body, and its files.

/// The surface of a workpiece as it is left, in its own frame.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PartMesh {
    /// Corners of triangles, seen from outside anticlockwise, in metres.
    pub triangles_m: Vec<[[f32; 3]; 3]>,
    /// Material left beyond the target at each corner, in metres; not a number where it was not to
    /// be cut.
    pub left_m: Vec<[f32; 3]>,
}

impl PartMesh {
    /// Binary STL in millimetres: a head of 80 bytes, the count, and 50 bytes a triangle.
    #[must_use]
    pub fn to_stl(&self) -> Vec<u8> {
        let mut bytes = vec![0; 80];
        bytes.extend((self.triangles_m.len() as u32).to_le_bytes());
        for triangle in &self.triangles_m {
            let normal = normal(triangle);
            for value in normal.iter().chain(millimetres(triangle).as_flattened()) {
                bytes.extend(value.to_le_bytes());
            }
            bytes.extend([0, 0]);
        }
        bytes
    }

    /// Binary PLY in millimetres, little end first: three corners a triangle, each with what is
    /// left there as `quality`, in micrometres.
    #[must_use]
    pub fn to_ply(&self) -> Vec<u8> {
        let count = self.triangles_m.len();
        let head = format!(
            "ply\nformat binary_little_endian 1.0\ncomment lengths in mm, quality: material left in um\n\
             element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float quality\n\
             element face {count}\nproperty list uchar int vertex_indices\nend_header\n",
            3 * count
        );
        let mut bytes = head.into_bytes();
        for (triangle, left_m) in self.triangles_m.iter().zip(&self.left_m) {
            for (corner, left_m) in millimetres(triangle).iter().zip(left_m) {
                let left_um = 1e6 * left_m;
                for value in corner.iter().chain([&left_um]) {
                    bytes.extend(value.to_le_bytes());
                }
            }
        }
        for first in (0..3 * count as i32).step_by(3) {
            bytes.push(3);
            for corner in first..first + 3 {
                bytes.extend(corner.to_le_bytes());
            }
        }
        bytes
    }
}

fn millimetres(triangle: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
    triangle.map(|corner| corner.map(|x| 1e3 * x))
}

/// Of length 1, or nothing where the triangle has no area.
fn normal([a, b, c]: &[[f32; 3]; 3]) -> [f32; 3] {
    let from = |p: &[f32; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v) = (from(b), from(c));
    let cross = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    let length = cross.iter().map(|x| x * x).sum::<f32>().sqrt();
    match length > 0.0 {
        true => cross.map(|x| x / length),
        false => [0.0; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes and places are those of the formats.
    #[test]
    fn files_hold_corners_normals_and_errors() {
        let part = PartMesh {
            triangles_m: vec![[[0.0; 3], [1e-3, 0.0, 0.0], [0.0, 2e-3, 0.0]]],
            left_m: vec![[1e-6, f32::NAN, -3e-6]],
        };
        let stl = part.to_stl();
        assert_eq!(stl.len(), 134);
        let at = |bytes: &[u8], k: usize| f32::from_le_bytes(bytes[k..k + 4].try_into().unwrap());
        assert_eq!([0, 4, 8].map(|k| at(&stl, 84 + k)), [0.0, 0.0, 1.0]);
        assert_eq!(at(&stl, 84 + 12 + 12), 1.0, "x of the second corner, mm");
        let ply = part.to_ply();
        let end = b"end_header\n";
        let head = ply.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        assert_eq!(ply.len() - head, 3 * 16 + 13);
        assert_eq!(at(&ply, head + 12), 1.0, "um at the first corner");
        assert!(at(&ply, head + 16 + 12).is_nan());
    }
}
