//! What can be wrong with a cell.

use thiserror::Error;

use crate::surface::SurfaceError;

/// A fault at a key of the cell's file.
#[derive(Debug, Error)]
#[error("{fault}")]
pub struct CellError {
    /// Dotted key, `fixture.1.shape.mesh`.
    pub key: String,
    #[source]
    pub fault: CellFault,
}

/// The faults.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CellFault {
    /// A mesh that cannot be read.
    #[error(transparent)]
    Mesh(#[from] SurfaceError),
    #[error(
        "\"{name}\" reaches {away_m:.3e} m from the origin of its frame or of the world; at most {limit_m} m are looked at"
    )]
    TooFar {
        name: String,
        away_m: f64,
        limit_m: f64,
    },
    #[error("the mesh has no size: none of its {triangles} triangles has an area")]
    NoSize { triangles: usize },
    #[error(
        "\"{inner}\" lies inside \"{outer}\": all {corners} corners of it that were looked at do; what stands beside a part must not be within it"
    )]
    Inside {
        inner: String,
        outer: String,
        corners: usize,
    },
    #[error("there is no link or carried body \"{name}\"; there are {known}")]
    UnknownBody { name: String, known: String },
    #[error("\"{name}\" is the name of something else already; each name stands once")]
    Twice { name: String },
}
