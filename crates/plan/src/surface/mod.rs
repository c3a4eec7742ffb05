//! Workpiece surfaces: parametric patches with exact derivatives, triangle meshes, closed
//! boundaries.
//!
//! A patch gives point, first and second derivatives ([`Jet`]) at a pair of parameters; everything
//! else about its shape follows from those ([`Forms`], [`Curvatures`]). Parameters are
//! dimensionless, lengths are m, curvatures 1/m, positive where the surface is convex seen from
//! outside. The outward normal is r_u × r_v, normalised.
//!
//! Meshes ([`Mesh`]) have no curvature; they serve for sections, nearest points and depths.

mod boundary;
#[cfg(test)]
pub(crate) mod cylinder;
mod depth;
#[cfg(test)]
pub(crate) mod drawn;
mod edge_chain;
mod error;
mod face;
mod file;
mod forms;
mod knots;
mod mesh;
mod mesh_checks;
mod mesh_edges;
mod mesh_files;
mod nurbs;
pub mod part;
mod primitives;
#[cfg(test)]
pub(crate) mod spoke;
mod step;

pub use boundary::Boundary;
pub(crate) use depth::to_parry as to_parry_pose;
pub use edge_chain::{EdgeChain, EdgeFault};
pub use error::{SurfaceError, SurfaceFault};
pub use face::{FaceFit, MeshFace};
pub use file::PatchFile;
pub use forms::{Curvatures, Forms, continue_line};
#[cfg(test)]
pub(crate) use mesh::tests as mesh_tests;
pub use mesh::{Mesh, NearestPoint};
pub use mesh_checks::MeshUse;
pub use mesh_edges::{LEAST_TURN_RAD, SharpEdge};
pub use mesh_files::MeshFile;
pub(crate) use mesh_files::read_mesh;
pub use nurbs::NurbsPatch;
pub use primitives::PlanePatch;
pub use step::StepFace;

use nalgebra::Vector3;

/// Ranges of the two parameters of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    pub u: [f64; 2],
    pub v: [f64; 2],
}

impl Domain {
    /// From 0 to 1 in both.
    pub const UNIT: Self = Self {
        u: [0.0, 1.0],
        v: [0.0, 1.0],
    };
}

/// Point and derivatives of a surface at one pair of parameters, all m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    pub point_m: Vector3<f64>,
    /// r_u and r_v, m per parameter.
    pub first_m: [Vector3<f64>; 2],
    /// r_uu, r_uv and r_vv, m per parameter squared.
    pub second_m: [Vector3<f64>; 3],
}

/// A patch of a surface over a rectangle of parameters, twice differentiable within.
pub trait Surface: Sync {
    fn domain(&self) -> Domain;

    /// Point and derivatives; parameters outside the domain are taken at its border.
    fn jet(&self, u: f64, v: f64) -> Jet;

    fn point_m(&self, u: f64, v: f64) -> Vector3<f64> {
        self.jet(u, v).point_m
    }
}

/// Sides of the patch's outline, along each border.
const OUTLINE: usize = 64;

/// The borders of a patch as a closed polyline, once round.
#[must_use]
pub fn outline(surface: &dyn Surface) -> Vec<Vector3<f64>> {
    let Domain { u, v } = surface.domain();
    let share = |k: usize| k as f64 / OUTLINE as f64;
    let at = |range: [f64; 2], t: f64| range[0] + (range[1] - range[0]) * t;
    let mut points = Vec::with_capacity(4 * OUTLINE + 1);
    for side in 0..4 {
        for k in 0..OUTLINE {
            let t = share(k);
            let (s, w) = match side {
                0 => (t, 0.0),
                1 => (1.0, t),
                2 => (1.0 - t, 1.0),
                _ => (0.0, 1.0 - t),
            };
            points.push(surface.point_m(at(u, s), at(v, w)));
        }
    }
    points.push(points[0]);
    points
}
