//! OBJ: vertices and polygons; all else that it may hold is passed over.

use nalgebra::Vector3;

use super::{MeshData, MeshFileError, fan, index_u32, lines, number};

pub(super) fn read(bytes: &[u8]) -> Result<MeshData, MeshFileError> {
    let mut mesh = MeshData::default();
    let mut corners: Vec<u32> = Vec::new();
    for (at, text) in lines(bytes) {
        let mut words = text.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || number(at, words.next(), "a coordinate of the vertex");
                mesh.vertices.push(Vector3::new(next()?, next()?, next()?));
                index_u32(mesh.vertices.len())?;
            }
            Some("f") => {
                corners.clear();
                for word in words {
                    corners.push(index(at, word, mesh.vertices.len())?);
                }
                if corners.len() < 3 {
                    let count = corners.len();
                    return Err(MeshFileError::at(
                        at,
                        format!("the face has {count} vertices; it needs 3 at least"),
                    ));
                }
                mesh.triangles.extend(fan(&corners));
            }
            _ => {}
        }
    }
    Ok(mesh)
}

/// The vertex of a word such as `7`, `7/1/2` or `-1`: counted from 1, or back from the last one so
/// far.
fn index(at: usize, word: &str, count: usize) -> Result<u32, MeshFileError> {
    let written = word.split('/').next().unwrap_or_default();
    let number = written.parse::<i64>().ok();
    let place = number.and_then(|number| match number {
        1.. => usize::try_from(number - 1).ok(),
        0 => None,
        _ => count.checked_sub(usize::try_from(number.unsigned_abs()).ok()?),
    });
    match place {
        Some(place) if place < count => index_u32(place),
        _ => Err(MeshFileError::at(
            at,
            format!("the face names vertex \"{written}\"; there are {count} before it"),
        )),
    }
}
