//! Mass, centre and inertia of bodies that are one.

use nalgebra::{Isometry3, Matrix3, Vector3};

/// Bodies, summed up about one origin.
#[derive(Default)]
pub(crate) struct MassSum {
    pub mass_kg: f64,
    first_moment_kg_m: Vector3<f64>,
    inertia_about_origin_kg_m2: Matrix3<f64>,
}

impl MassSum {
    /// Adds a body by the pose of its centre, and its inertia about that in the axes of the pose.
    pub fn add(&mut self, mass_kg: f64, pose: &Isometry3<f64>, inertia_kg_m2: &Matrix3<f64>) {
        let turn = *pose.rotation.to_rotation_matrix().matrix();
        let com_m = pose.translation.vector;
        let cross = com_m.cross_matrix();
        self.mass_kg += mass_kg;
        self.first_moment_kg_m += com_m * mass_kg;
        self.inertia_about_origin_kg_m2 +=
            turn * inertia_kg_m2 * turn.transpose() - cross * cross * mass_kg;
    }

    /// The centre, m, at the origin where there is no mass; the inertia about it, kg m².
    pub fn about_centre(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let com_m = if self.mass_kg > 0.0 {
            self.first_moment_kg_m / self.mass_kg
        } else {
            Vector3::zeros()
        };
        let cross = com_m.cross_matrix();
        let inertia_kg_m2 = self.inertia_about_origin_kg_m2 + cross * cross * self.mass_kg;
        (com_m, inertia_kg_m2)
    }
}
