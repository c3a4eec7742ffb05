//! Meshes from STL and OBJ files. Neither says its unit, so the caller does.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::error::{SurfaceError, SurfaceFault, place};
use super::mesh::Mesh;
use super::mesh_checks::MeshUse;

use crate::bounds::OutOfBounds;

/// Vertices and triangles as a file gives them.
type Triangles = (Vec<Vector3<f64>>, Vec<[usize; 3]>);

/// A mesh on disk.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// STL or OBJ file.
    pub file: PathBuf,
    /// Length of the file's unit, m.
    pub unit_m: f64,
}

impl Mesh {
    /// Reads a mesh from an STL (binary or ASCII) or OBJ file, by its ending. `unit_m` is the
    /// length of the file's unit, 1e-3 for mm.
    ///
    /// # Errors
    /// If the file cannot be read, has another ending, or holds no good mesh; for STL also where
    /// the normal that a triangle states is against its winding.
    pub fn load(path: &Path, unit_m: f64, mesh_use: MeshUse) -> Result<Self, SurfaceError> {
        let error = |fault| SurfaceError::in_file(path, None, fault);
        let bytes = std::fs::read(path).map_err(|e| error(SurfaceFault::Unreadable(e)))?;
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let raw = match ending.as_deref() {
            Some("stl") => stl(&bytes),
            Some("obj") => obj(&bytes),
            other => Err(SurfaceFault::UnknownEnding {
                ending: other.unwrap_or_default().to_owned(),
            }),
        };
        let (mut vertices, triangles) = raw.map_err(error)?;
        let has_length = unit_m.is_finite() && unit_m > 0.0;
        let unit = "the length of the mesh's unit (m)";
        OutOfBounds::unless(has_length, unit, unit_m, "finite and above 0")
            .map_err(|fault| error(fault.into()))?;
        vertices.iter_mut().for_each(|v| *v *= unit_m);
        Self::new(&vertices, &triangles, mesh_use).map_err(error)
    }
}

fn stl(bytes: &[u8]) -> Result<Triangles, SurfaceFault> {
    let read = stl_io::read_stl(&mut Cursor::new(bytes));
    let mesh = read.map_err(|e| SurfaceFault::Syntax(format!("not a valid STL file: {e}")))?;
    let vector = |v: &stl_io::Vector<f32>| Vector3::new(v[0], v[1], v[2]).cast::<f64>();
    let vertices: Vec<_> = mesh.vertices.iter().map(vector).collect();
    for (index, face) in mesh.faces.iter().enumerate() {
        let [a, b, c] = face.vertices.map(|i| vertices[i]);
        let stated = vector(&face.normal);
        // Many writers leave the normal zero; then the winding alone counts.
        if (b - a).cross(&(c - a)).dot(&stated) < 0.0 {
            return Err(SurfaceFault::StatedNormal {
                index: index + 1,
                near: place(&a),
            });
        }
    }
    Ok((vertices, mesh.faces.iter().map(|f| f.vertices).collect()))
}

fn obj(bytes: &[u8]) -> Result<Triangles, SurfaceFault> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ..tobj::LoadOptions::default()
    };
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let read = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials);
    let (models, _) =
        read.map_err(|e| SurfaceFault::Syntax(format!("not a valid OBJ file: {e}")))?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for model in models {
        let first = vertices.len();
        let positions = model.mesh.positions.chunks_exact(3);
        vertices.extend(positions.map(|p| Vector3::new(p[0], p[1], p[2])));
        let corners = model.mesh.indices.chunks_exact(3);
        triangles.extend(corners.map(|c| [c[0], c[1], c[2]].map(|i| first + i as usize)));
    }
    Ok((vertices, triangles))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::mesh::tests::block;
    use std::fmt::Write as _;

    fn ascii_stl(turned: Option<usize>) -> String {
        let (vertices, triangles) = block();
        let mut text = String::from("solid block\n");
        for (index, triangle) in triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|i| vertices[i] * 1e3);
            let normal = (b - a).cross(&(c - a)).normalize();
            let normal = if turned == Some(index) {
                -normal
            } else {
                normal
            };
            let _ = writeln!(
                text,
                "facet normal {} {} {}\nouter loop",
                normal.x, normal.y, normal.z
            );
            for p in [a, b, c] {
                let _ = writeln!(text, "vertex {} {} {}", p.x, p.y, p.z);
            }
            text.push_str("endloop\nendfacet\n");
        }
        text + "endsolid block\n"
    }

    fn load(name: &str, text: &str) -> Result<Mesh, SurfaceError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        Mesh::load(&path, 1e-3, MeshUse::Body)
    }

    #[test]
    fn stl_and_obj_give_the_same_block() {
        let stl = load("block.stl", &ascii_stl(None)).expect("a block");
        assert_eq!((stl.vertices_m().len(), stl.triangles().len()), (8, 12));
        assert!(
            (stl.volume_m3() / 1.2e-4 - 1.0).abs() < 1e-6,
            "single precision"
        );

        let (vertices, triangles) = block();
        let mut text = String::new();
        for v in vertices {
            let _ = writeln!(text, "v {} {} {}", v.x * 1e3, v.y * 1e3, v.z * 1e3);
        }
        for t in triangles {
            let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
        }
        let obj = load("block.obj", &text).expect("a block");
        assert!((obj.volume_m3() / 1.2e-4 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bad_files_are_refused_by_name() {
        let refuse = |name: &str, text: &str| load(name, text).expect_err("bad").to_string();
        let turned = refuse("turned.stl", &ascii_stl(Some(5)));
        assert!(
            turned.contains("turned.stl: ") && turned.contains("triangle 6"),
            "{turned}"
        );
        let nan = ascii_stl(None).replacen("vertex 0 60 0", "vertex nan 60 0", 1);
        let told = refuse("nan.stl", &nan);
        assert!(
            told.contains("not finite") || told.contains("not a valid STL"),
            "{told}"
        );
        assert!(refuse("odd.obj", "v 0 0 0\nf 1 2 3\n").contains("OBJ"));
        assert!(refuse("block.ply", "").contains("\"ply\""));
    }
}
