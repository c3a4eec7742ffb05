//! Meshes from STL, OBJ and PLY files, of which none says its unit, so that the caller does, and of
//! the bodies of STEP files, which say it themselves.

use std::path::{Path, PathBuf};

use truecut_arm::MeshData;

use super::error::{SurfaceError, SurfaceFault, place};
use super::mesh::Mesh;
use super::mesh_checks::MeshUse;
use super::step::{self, StepBody};

use crate::bounds::OutOfBounds;

/// A mesh on disk.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// STL, OBJ, PLY or STEP file.
    pub file: PathBuf,
    /// Length of the file's unit, m.
    pub unit_m: f64,
}

impl Mesh {
    /// Reads a mesh from an STL (binary or ASCII), OBJ, PLY or STEP file, by its ending. `unit_m`
    /// is the length of the file's unit, 1e-3 for mm and for STEP.
    ///
    /// # Errors
    /// If the file cannot be read, has another ending, or holds no good mesh; for STL also where
    /// the normal that a triangle states is against its winding.
    pub fn load(path: &Path, unit_m: f64, mesh_use: MeshUse) -> Result<Self, SurfaceError> {
        let error = |fault| SurfaceError::in_file(path, None, fault);
        let data = read_mesh(path, unit_m)?;
        if let Some(index) = data.against_stated_normal.first() {
            let corner = data.triangles[*index as usize][0];
            return Err(error(SurfaceFault::StatedNormal {
                index: *index as usize + 1,
                near: place(&data.vertices[corner as usize]),
            }));
        }
        let vertices: Vec<_> = data.vertices.iter().map(|v| v * unit_m).collect();
        let triangles: Vec<_> = (data.triangles.iter())
            .map(|t| t.map(|i| i as usize))
            .collect();
        Self::new(&vertices, &triangles, mesh_use).map_err(error)
    }
}

/// Vertices and triangles of a file, whatever they are, in its unit; of a STEP file in mm.
pub(crate) fn read_mesh(path: &Path, unit_m: f64) -> Result<MeshData, SurfaceError> {
    Ok(match read_step(path, unit_m)? {
        Some(body) => body.mesh,
        None => read_triangles(path, unit_m)?,
    })
}

/// Of a file whose ending is not that of STEP.
pub(super) fn read_triangles(path: &Path, unit_m: f64) -> Result<MeshData, SurfaceError> {
    check_unit(unit_m).map_err(|fault| SurfaceError::in_file(path, None, fault.into()))?;
    MeshData::load(path).map_err(|error| {
        let told = ", .step, .stp";
        let message = match error.message.strip_prefix("unknown ending") {
            Some(_) => error.message + told,
            None => error.message,
        };
        SurfaceError::in_file(path, error.line, SurfaceFault::Syntax(message))
    })
}

/// The body of a STEP file, lengths mm; `None` if the file's ending is another.
pub(super) fn read_step(path: &Path, unit_m: f64) -> Result<Option<StepBody>, SurfaceError> {
    let ending = path.extension().map(|e| e.to_ascii_lowercase());
    if !ending.is_some_and(|ending| ending == "step" || ending == "stp") {
        return Ok(None);
    }
    let error = |line, fault| SurfaceError::in_file(path, line, fault);
    let is_mm = (unit_m - 1e-3).abs() < 1e-12;
    let unit = "the length of the mesh's unit (m)";
    let rule = "0.001: a STEP file says its unit itself, and is read in mm";
    OutOfBounds::unless(is_mm, unit, unit_m, rule).map_err(|fault| error(None, fault.into()))?;
    let bytes = truecut_files::read(path).map_err(|fault| {
        let message = format!("cannot read the file: {fault}");
        error(None, SurfaceFault::Syntax(message))
    })?;
    let body = step::read(&bytes);
    body.map(Some)
        .map_err(|(line, message)| error(line, SurfaceFault::Syntax(message)))
}

pub(super) fn check_unit(unit_m: f64) -> Result<(), OutOfBounds> {
    let has_length = unit_m.is_finite() && unit_m > 0.0;
    let unit = "the length of the mesh's unit (m)";
    OutOfBounds::unless(has_length, unit, unit_m, "finite and above 0")
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
        assert!(told.contains("not finite"), "{told}");
        assert!(refuse("odd.obj", "v 0 0 0\nf 1 2 3\n").contains("odd.obj:2: "));
        assert!(refuse("block.ply", "").contains("PLY"));
        assert!(refuse("block.iges", "").contains("\"iges\""));
        assert!(refuse("block.step", "").contains("ISO-10303-21"));
    }
}
