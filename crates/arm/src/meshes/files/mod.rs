//! Triangles of the files that meshes come in: STL, OBJ, PLY, COLLADA.
//!
//! A count that a file declares is held against the file's length before anything of that size is
//! allocated, so that memory stays within a few times the file.

mod obj;
mod ply;
mod stl;

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

use nalgebra::Vector3;

use super::collada;

/// Endings of the formats that are read.
pub(super) const ENDINGS: [&str; 4] = ["stl", "obj", "ply", "dae"];
/// Endings of those that hold one mesh and nothing else.
pub(crate) const MESH_ENDINGS: [&str; 3] = ["stl", "obj", "ply"];

/// Three corners, counter-clockwise seen from outside.
pub(crate) type Triangle = [Vector3<f64>; 3];

/// Triangles of one colour.
#[derive(Debug, Default)]
pub(crate) struct Part {
    pub(crate) triangles: Vec<Triangle>,
    /// Red, green, blue, opacity, if the file says so.
    pub(crate) color_rgba: Option<[f32; 4]>,
}

/// Vertices and triangles as a file gives them, in its unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshData {
    /// An STL file repeats them for every triangle.
    pub vertices: Vec<Vector3<f64>>,
    /// Vertex indices, each below the number of vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles, from 0, whose normal as stated in an STL file is against their winding.
    pub against_stated_normal: Vec<u32>,
}

/// Why a mesh file cannot be read.
#[derive(Debug)]
pub struct MeshFileError {
    /// Line from 1, in text.
    pub line: Option<usize>,
    pub message: String,
}

impl MeshFileError {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self {
            line: None,
            message: message.into(),
        }
    }

    pub(super) fn at(line: usize, message: impl Into<String>) -> Self {
        Self {
            line: Some(line),
            message: message.into(),
        }
    }
}

impl fmt::Display for MeshFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for MeshFileError {}

impl MeshData {
    /// Reads an STL (binary or ASCII), OBJ or PLY file, told by its ending.
    ///
    /// # Errors
    /// If the file cannot be read, has another ending, is cut off or damaged, holds no triangle, or
    /// a coordinate that is not finite.
    pub fn load(path: &Path) -> Result<Self, MeshFileError> {
        let known = MESH_ENDINGS;
        let ending = ending(path);
        if !known.contains(&ending.as_str()) {
            let all = known.map(|ending| format!(".{ending}")).join(", ");
            return Err(MeshFileError::new(format!(
                "unknown ending \"{ending}\"; meshes are read from {all}"
            )));
        }
        let bytes = truecut_files::read(path)
            .map_err(|error| MeshFileError::new(format!("cannot read the file: {error}")))?;
        Self::parse(&ending, &bytes)
    }

    /// What the bytes of a file with this ending hold.
    fn parse(ending: &str, bytes: &[u8]) -> Result<Self, MeshFileError> {
        let mesh = match ending {
            "stl" => stl::read(bytes)?,
            "obj" => obj::read(bytes)?,
            _ => ply::read(bytes)?,
        };
        if mesh.triangles.is_empty() {
            return Err(MeshFileError::new("it holds no triangle"));
        }
        let is_finite = |v: &Vector3<f64>| v.iter().all(|x| x.is_finite());
        if let Some(index) = mesh.vertices.iter().position(|v| !is_finite(v)) {
            let v = mesh.vertices[index];
            return Err(MeshFileError::new(format!(
                "vertex {} is not finite: ({}, {}, {})",
                index + 1,
                v.x,
                v.y,
                v.z
            )));
        }
        Ok(mesh)
    }
}

pub(super) fn ending(path: &Path) -> String {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_lowercase())
        .unwrap_or_default()
}

/// The triangles of a file in the file's own frame; the reason if it cannot be read.
pub(crate) fn read(path: &Path) -> Result<Vec<Part>, String> {
    if ending(path) != "dae" {
        let mesh = MeshData::load(path).map_err(|error| error.to_string())?;
        let corners = |t: &[u32; 3]| t.map(|i| mesh.vertices[i as usize]);
        return Ok(vec![Part {
            triangles: mesh.triangles.iter().map(corners).collect(),
            color_rgba: None,
        }]);
    }
    let bytes = truecut_files::read(path).map_err(|error| error.to_string())?;
    let parts = collada::parts(&String::from_utf8_lossy(&bytes))?;
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

/// A polygon as triangles about its first corner.
pub(super) fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    let rest = corners.get(1..).unwrap_or_default();
    rest.windows(2).map(|pair| [corners[0], pair[0], pair[1]])
}

/// Lines of a text with their numbers, from 1. Names and comments may be in any encoding: bytes
/// that are no UTF-8 are replaced, so that a number which holds one is none.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    bytes
        .split(|byte| *byte == b'\n')
        .enumerate()
        .map(|(index, line)| (index + 1, String::from_utf8_lossy(line)))
}

/// A number of a line.
fn number(line: usize, word: Option<&str>, what: &str) -> Result<f64, MeshFileError> {
    let word = word.ok_or_else(|| MeshFileError::at(line, format!("{what} is missing")))?;
    word.parse()
        .map_err(|_| MeshFileError::at(line, format!("{what} is \"{word}\", which is no number")))
}

/// Numbers an index into the list that has room for it.
fn index_u32(count: usize) -> Result<u32, MeshFileError> {
    u32::try_from(count).map_err(|_| MeshFileError::new("it holds more than 2^32 vertices"))
}

#[cfg(test)]
mod tests;
