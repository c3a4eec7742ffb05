//! STL, binary and ASCII.

use nalgebra::Vector3;

use super::{MeshData, MeshFileError, index_u32, lines, number};

/// A head of 80 bytes and the number of triangles.
const HEAD: usize = 84;
/// Normal and corners in single precision, and two bytes without meaning.
const TRIANGLE: usize = 50;

/// Binary if it is exactly as long as the number of triangles in its head says; else ASCII if it
/// begins with `solid` and holds text.
pub(super) fn read(bytes: &[u8]) -> Result<MeshData, MeshFileError> {
    let declared = (bytes.get(80..HEAD)).and_then(|count| count.try_into().ok());
    let declared = declared.map(|count| u64::from(u32::from_le_bytes(count)));
    let length = |count: u64| HEAD as u64 + count * TRIANGLE as u64;
    if declared.is_some_and(|count| length(count) == bytes.len() as u64) {
        return binary(bytes);
    }
    let is_text = bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0);
    match declared {
        _ if is_text => ascii(bytes),
        None => Err(MeshFileError::new(format!(
            "not a valid STL file: it has {} bytes, and does not begin with \"solid\"; a binary \
             file has {HEAD} at least",
            bytes.len()
        ))),
        Some(count) => Err(MeshFileError::new(format!(
            "not a valid STL file: it declares {count} triangles at byte 81, which take {} bytes, \
             but has {}",
            length(count),
            bytes.len()
        ))),
    }
}

fn binary(bytes: &[u8]) -> Result<MeshData, MeshFileError> {
    let triangles = bytes[HEAD..].chunks_exact(TRIANGLE);
    let mut mesh = Gathered::with_capacity(triangles.len());
    for triangle in triangles {
        let mut numbers = triangle.chunks_exact(4).map(|b| {
            let single = b.try_into().map(f32::from_le_bytes);
            f64::from(single.unwrap_or(f32::NAN))
        });
        let mut vector = || {
            let mut next = || numbers.next().unwrap_or(f64::NAN);
            Vector3::new(next(), next(), next())
        };
        let normal = vector();
        mesh.add(normal, [vector(), vector(), vector()])?;
    }
    Ok(mesh.0)
}

fn ascii(bytes: &[u8]) -> Result<MeshData, MeshFileError> {
    let mut mesh = Gathered::with_capacity(0);
    let (mut normal, mut corners) = (None, Vec::with_capacity(3));
    let mut last = 0;
    for (at, text) in lines(bytes) {
        let mut words = text.split_ascii_whitespace();
        let Some(key) = words.next() else { continue };
        last = at;
        let mut vector = |what: &str| -> Result<Vector3<f64>, MeshFileError> {
            let mut next = || number(at, words.next(), what);
            Ok(Vector3::new(next()?, next()?, next()?))
        };
        match key.to_ascii_lowercase().as_str() {
            "facet" if normal.is_none() => {
                let mut after = text.split_ascii_whitespace().skip(2);
                let mut next = || number(at, after.next(), "a component of the facet's normal");
                normal = Some(Vector3::new(next()?, next()?, next()?));
            }
            "vertex" if normal.is_some() => corners.push(vector("a coordinate of the vertex")?),
            "endfacet" if normal.is_some() => {
                let three = <[Vector3<f64>; 3]>::try_from(std::mem::take(&mut corners));
                let three = three.map_err(|found| {
                    let count = found.len();
                    MeshFileError::at(at, format!("the facet has {count} vertices; it needs 3"))
                })?;
                mesh.add(normal.take().unwrap_or_default(), three)?;
            }
            "outer" | "endloop" | "solid" | "endsolid" => {}
            _ => {
                return Err(MeshFileError::at(
                    at,
                    format!("not a valid STL file: \"{key}\" cannot stand here"),
                ));
            }
        }
    }
    if normal.is_some() {
        return Err(MeshFileError::at(last, "the file ends within a facet"));
    }
    Ok(mesh.0)
}

struct Gathered(MeshData);

impl Gathered {
    fn with_capacity(triangles: usize) -> Self {
        Self(MeshData {
            vertices: Vec::with_capacity(3 * triangles),
            triangles: Vec::with_capacity(triangles),
            against_stated_normal: Vec::new(),
        })
    }

    fn add(
        &mut self,
        normal: Vector3<f64>,
        [a, b, c]: [Vector3<f64>; 3],
    ) -> Result<(), MeshFileError> {
        let first = index_u32(self.0.vertices.len() + 2)? - 2;
        // Many writers leave the normal zero; then the winding alone counts.
        if (b - a).cross(&(c - a)).dot(&normal) < 0.0 {
            (self.0.against_stated_normal).push(index_u32(self.0.triangles.len())?);
        }
        self.0.vertices.extend([a, b, c]);
        self.0.triangles.push([first, first + 1, first + 2]);
        Ok(())
    }
}
