//! Triangles of the files that meshes come in: STL, OBJ, PLY, COLLADA.

use std::io::Cursor;
use std::path::Path;

use nalgebra::Vector3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::collada;

/// Endings of the formats that are read.
pub(super) const ENDINGS: [&str; 4] = ["stl", "obj", "ply", "dae"];

/// Three corners, counter-clockwise seen from outside.
pub(crate) type Triangle = [Vector3<f64>; 3];

/// Triangles of one colour.
#[derive(Debug, Default)]
pub(crate) struct Part {
    pub(crate) triangles: Vec<Triangle>,
    /// Red, green, blue, opacity, if the file says so.
    pub(crate) color_rgba: Option<[f32; 4]>,
}

pub(super) fn ending(path: &Path) -> String {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_lowercase())
        .unwrap_or_default()
}

/// The triangles of a file in the file's own frame; the reason if it cannot be read.
pub(crate) fn read(path: &Path) -> Result<Vec<Part>, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    let parts = match ending(path).as_str() {
        "stl" => stl(&bytes)?,
        "obj" => obj(&bytes)?,
        "ply" => ply(&bytes)?,
        "dae" => collada::parts(&String::from_utf8_lossy(&bytes))?,
        _ => return Err(format!("its ending is none of {}", ENDINGS.join(", "))),
    };
    let corners = || {
        parts
            .iter()
            .flat_map(|part| part.triangles.iter().flatten())
    };
    if corners().next().is_none() {
        return Err("it holds no triangle".to_owned());
    }
    let is_finite = |corner: &Vector3<f64>| corner.iter().all(|x| x.is_finite());
    if !corners().all(is_finite) {
        return Err("not all its coordinates are finite".to_owned());
    }
    Ok(parts)
}

fn stl(bytes: &[u8]) -> Result<Vec<Part>, String> {
    let read = stl_io::read_stl(&mut Cursor::new(bytes));
    let mesh = read.map_err(|error| format!("not a valid STL file: {error}"))?;
    let vector = |v: &stl_io::Vector<f32>| Vector3::new(v[0], v[1], v[2]).cast::<f64>();
    let vertices: Vec<_> = mesh.vertices.iter().map(vector).collect();
    let faces = mesh.faces.iter().map(|face| face.vertices);
    one_part(&vertices, faces)
}

fn obj(bytes: &[u8]) -> Result<Vec<Part>, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ..tobj::LoadOptions::default()
    };
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let read = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials);
    let (models, _) = read.map_err(|error| format!("not a valid OBJ file: {error}"))?;
    let parts = models.iter().map(|model| {
        let positions = model.mesh.positions.chunks_exact(3);
        let vertices: Vec<_> = positions.map(|p| Vector3::new(p[0], p[1], p[2])).collect();
        let corners = model.mesh.indices.chunks_exact(3);
        let faces = corners.map(|c| [c[0], c[1], c[2]].map(|i| i as usize));
        one_part(&vertices, faces)
    });
    let parts: Result<Vec<_>, String> = parts.collect();
    Ok(parts?.into_iter().flatten().collect())
}

fn ply(bytes: &[u8]) -> Result<Vec<Part>, String> {
    let read = Parser::<DefaultElement>::new().read_ply(&mut Cursor::new(bytes));
    let file = read.map_err(|error| format!("not a valid PLY file: {error}"))?;
    let elements = |name: &str| {
        file.payload
            .get(name)
            .map(Vec::as_slice)
            .unwrap_or_default()
    };
    let coordinate = |vertex: &DefaultElement, axis: &str| match vertex.get(axis) {
        Some(Property::Float(x)) => Ok(f64::from(*x)),
        Some(Property::Double(x)) => Ok(*x),
        _ => Err(format!("a vertex has no floating-point `{axis}`")),
    };
    let vertices = elements("vertex").iter().map(|vertex| {
        let [x, y, z] = ["x", "y", "z"].map(|axis| coordinate(vertex, axis));
        Ok(Vector3::new(x?, y?, z?))
    });
    let vertices: Vec<_> = vertices.collect::<Result<_, String>>()?;
    let mut faces = Vec::new();
    for face in elements("face") {
        let list = face.get("vertex_indices").or(face.get("vertex_index"));
        let corners = list
            .and_then(indices)
            .ok_or("a face has no vertex_indices")?;
        faces.extend(fan(&corners));
    }
    one_part(&vertices, faces.into_iter())
}

fn indices(list: &Property) -> Option<Vec<usize>> {
    fn all<T: Copy + TryInto<usize>>(list: &[T]) -> Option<Vec<usize>> {
        list.iter().map(|index| (*index).try_into().ok()).collect()
    }
    match list {
        Property::ListChar(list) => all(list),
        Property::ListUChar(list) => all(list),
        Property::ListShort(list) => all(list),
        Property::ListUShort(list) => all(list),
        Property::ListInt(list) => all(list),
        Property::ListUInt(list) => all(list),
        _ => None,
    }
}

/// A polygon as triangles about its first corner.
pub(super) fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    let rest = corners.get(1..).unwrap_or_default();
    rest.windows(2).map(|pair| [corners[0], pair[0], pair[1]])
}

fn one_part(
    vertices: &[Vector3<f64>],
    faces: impl Iterator<Item = [usize; 3]>,
) -> Result<Vec<Part>, String> {
    let triangles = faces.map(|face| {
        let [a, b, c] = face.map(|index| vertices.get(index).copied());
        let missing = || format!("a face names vertices {face:?} of {}", vertices.len());
        Ok([
            a.ok_or_else(missing)?,
            b.ok_or_else(missing)?,
            c.ok_or_else(missing)?,
        ])
    });
    let part = Part {
        triangles: triangles.collect::<Result<_, String>>()?,
        color_rgba: None,
    };
    Ok(vec![part])
}
