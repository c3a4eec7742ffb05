//! Why a path on a surface cannot be planned or followed.

use nalgebra::Vector3;
use thiserror::Error;

use crate::bounds::OutOfBounds;
use crate::program::ProgramError;
use crate::surface::SurfaceFault;

/// Why a path on a surface cannot be planned or followed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SurfacePathError {
    #[error(transparent)]
    OutOfBounds(#[from] OutOfBounds),
    #[error(
        "the wheel gouges at u = {u:.4}, v = {v:.4}, {at}: its radius is {radius_mm:.3} mm, the surface's concave radius across its axis {concave_mm:.3} mm; the wheel must be smaller",
        at = point(point_m)
    )]
    Gouge {
        u: f64,
        v: f64,
        point_m: Vector3<f64>,
        radius_mm: f64,
        concave_mm: f64,
    },
    #[error(
        "no axis at u = {u:.4}, v = {v:.4}, {at}, keeps the wheel from gouging and its edge gap within {limit_mm:.4} mm; the least gap is {least_mm:.4} mm",
        at = point(point_m)
    )]
    NoAxis {
        u: f64,
        v: f64,
        point_m: Vector3<f64>,
        limit_mm: f64,
        least_mm: f64,
    },
    #[error(
        "the contact patch is wider than the face: nowhere along v does a patch {swath_mm:.3} mm wide lie within its borders"
    )]
    WiderThanFace { swath_mm: f64 },
    #[error(
        "a line of {length_mm:.1} mm would have {contacts:.3e} contacts, but at most {most} are planned; take longer steps"
    )]
    TooFine {
        length_mm: f64,
        contacts: f64,
        most: usize,
    },
    #[error(
        "lines would stand {part:.1e} of the face apart, but at most {most} are planned; take a wider swath, less overlap or higher ridges"
    )]
    TooClose { part: f64, most: usize },
    #[error(
        "the planes do not cut the face into lines from side to side: at {at} they run along the face; choose a normal that lies across it",
        at = point(point_m)
    )]
    PlaneAlong { point_m: Vector3<f64> },
    #[error(
        "taught postures cannot be carried to another copy by the arm: they do not turn with the part; a turntable brings the copies to them"
    )]
    TaughtTurned,
    #[error("segment {segment}, counted from 1: {source}")]
    Travel {
        segment: usize,
        source: ProgramError,
    },
    #[error("{file}:{line}: {message}")]
    Taught {
        file: String,
        line: usize,
        message: String,
    },
    #[error(transparent)]
    Surface(#[from] SurfaceFault),
}

fn point(p: &Vector3<f64>) -> String {
    format!("({:.3}, {:.3}, {:.3}) mm", p.x * 1e3, p.y * 1e3, p.z * 1e3)
}
