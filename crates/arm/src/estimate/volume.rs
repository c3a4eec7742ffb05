//! Volume, centre and second moments of bodies: closed meshes, and cylinders between joints.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};

use crate::meshes::{MeshReference, located, read};
use crate::packages::Packages;

/// Part of the area of its surface by which a mesh may gape and still count as closed.
const OPEN_PART: f64 = 1e-2;

/// A body of density 1 in a frame of its own.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Body {
    pub(super) volume_m3: f64,
    /// ∫ x dV.
    first_m4: Vector3<f64>,
    /// ∫ x xᵀ dV.
    second_m5: Matrix3<f64>,
}

impl Body {
    pub(super) fn center_m(&self) -> Vector3<f64> {
        self.first_m4 / self.volume_m3
    }

    /// Inertia about the centre, for a mass.
    pub(super) fn inertia_kg_m2(&self, mass_kg: f64) -> Matrix3<f64> {
        let center = self.center_m();
        let second = self.second_m5 / self.volume_m3 - center * center.transpose();
        (Matrix3::identity() * second.trace() - second) * mass_kg
    }

    fn join(&mut self, other: &Body) {
        self.volume_m3 += other.volume_m3;
        self.first_m4 += other.first_m4;
        self.second_m5 += other.second_m5;
    }

    /// A solid cylinder between two points.
    pub(super) fn cylinder(from_m: Vector3<f64>, to_m: Vector3<f64>, diameter_m: f64) -> Body {
        let along = to_m - from_m;
        let (length, center) = (along.norm(), (from_m + to_m) * 0.5);
        let axis = along / length;
        let volume_m3 = std::f64::consts::FRAC_PI_4 * diameter_m.powi(2) * length;
        let lengthwise = axis * axis.transpose();
        let across = Matrix3::identity() - lengthwise;
        let own = lengthwise * (length * length / 12.0) + across * (diameter_m.powi(2) / 16.0);
        Body {
            volume_m3,
            first_m4: center * volume_m3,
            second_m5: (own + center * center.transpose()) * volume_m3,
        }
    }

    /// The body inside a closed surface: the sum of the tetrahedra from the origin to each of its
    /// triangles. `None` if the surface gapes or holds no volume.
    pub(super) fn within(triangles: &[[Vector3<f64>; 3]]) -> Option<Body> {
        let mut body = Body::default();
        let (mut area, mut directed) = (0.0, Vector3::zeros());
        // Close to the surface, so that parts of it do not cancel far away.
        let origin = triangles.first()?[0];
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| corner - origin);
            let normal = (b - a).cross(&(c - a)) * 0.5;
            area += normal.norm();
            directed += normal;
            let volume = a.dot(&b.cross(&c)) / 6.0;
            let sum = a + b + c;
            body.volume_m3 += volume;
            body.first_m4 += sum * (volume / 4.0);
            let squares = [a, b, c, sum].map(|x| x * x.transpose());
            body.second_m5 += squares.iter().sum::<Matrix3<f64>>() * (volume / 20.0);
        }
        if body.volume_m3 < 0.0 {
            // Wound the other way round throughout.
            body.volume_m3 = -body.volume_m3;
            body.first_m4 = -body.first_m4;
            body.second_m5 = -body.second_m5;
        }
        let is_closed = directed.norm() <= OPEN_PART * area;
        let has_volume = body.volume_m3 > 1e-6 * area.powf(1.5);
        (is_closed && has_volume && body.is_real()).then(|| body.moved(&origin))
    }

    /// Whether no moment is that of a body turned inside out.
    fn is_real(&self) -> bool {
        let center = self.center_m();
        let spread = self.second_m5 / self.volume_m3 - center * center.transpose();
        spread
            .symmetric_eigenvalues()
            .iter()
            .all(|moment| *moment > 0.0)
    }

    /// The same body seen from a frame in which its own origin is at `by`.
    fn moved(&self, by: &Vector3<f64>) -> Body {
        let cross = self.first_m4 * by.transpose();
        Body {
            volume_m3: self.volume_m3,
            first_m4: self.first_m4 + by * self.volume_m3,
            second_m5: self.second_m5
                + cross
                + cross.transpose()
                + by * by.transpose() * self.volume_m3,
        }
    }
}

/// The body of a link's meshes, in its frame: those for collision if they can be had, else those to
/// be seen. `None` if a mesh cannot be read, is not closed, or there is none.
pub(super) fn of_meshes(
    meshes: &[MeshReference],
    folder: &Path,
    packages: &Packages,
) -> Option<Body> {
    [true, false].into_iter().find_map(|is_collision| {
        let mut all = Body::default();
        let mut own = meshes
            .iter()
            .filter(|mesh| mesh.is_collision == is_collision);
        own.try_for_each(|mesh| {
            all.join(&of_mesh(mesh, folder, packages)?);
            Some(())
        })?;
        (all.volume_m3 > 0.0).then_some(all)
    })
}

fn of_mesh(mesh: &MeshReference, folder: &Path, packages: &Packages) -> Option<Body> {
    let path = located(&mesh.file, folder, packages).ok()?;
    let place = |corner: Vector3<f64>| {
        let scaled = corner.component_mul(&mesh.scale);
        mesh.link_from_mesh.rotation * scaled + mesh.link_from_mesh.translation.vector
    };
    // A closed surface may be of several colours, so of several parts.
    let parts = read(&path).ok()?.into_iter();
    let triangles = parts.flat_map(|part| part.triangles);
    let triangles: Vec<_> = triangles.map(|triangle| triangle.map(place)).collect();
    Body::within(&triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with a corner at `at`, its triangles wound outwards or inwards.
    fn box_of(at: Vector3<f64>, size: Vector3<f64>, inwards: bool) -> Vec<[Vector3<f64>; 3]> {
        let corner = |i: usize| {
            let bit = |k: usize| ((i >> k) & 1) as f64;
            at + Vector3::new(bit(0) * size.x, bit(1) * size.y, bit(2) * size.z)
        };
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let split = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
        let turned = |[a, b, c]: [usize; 3]| if inwards { [a, c, b] } else { [a, b, c] };
        let triangles = quads.into_iter().flat_map(split).map(turned);
        triangles.map(|t| t.map(corner)).collect()
    }

    #[test]
    fn verify_box_has_its_volume_centre_and_inertia() {
        let (at, size) = (Vector3::new(3.0, -2.0, 0.5), Vector3::new(0.4, 0.2, 1.1));
        for inwards in [false, true] {
            let body = Body::within(&box_of(at, size, inwards)).expect("it is closed");
            assert!((body.volume_m3 / size.product() - 1.0).abs() < 1e-12);
            assert!((body.center_m() - (at + size * 0.5)).norm() < 1e-12);
            let inertia = body.inertia_kg_m2(12.0);
            let squares = size.component_mul(&size);
            let expected = Matrix3::from_diagonal(&Vector3::new(
                squares.y + squares.z,
                squares.x + squares.z,
                squares.x + squares.y,
            ));
            assert!((inertia - expected).norm() < 1e-10, "{inertia}");
        }
    }

    #[test]
    fn verify_cylinder_has_its_inertia() {
        let (from, to) = (Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.1, 0.2, 1.3));
        let body = Body::cylinder(from, to, 0.2);
        let inertia = body.inertia_kg_m2(3.0);
        let (across, along) = (3.0 * (3.0 * 0.01 + 1.0) / 12.0, 3.0 * 0.01 / 2.0);
        let expected = Matrix3::from_diagonal(&Vector3::new(across, across, along));
        assert!((inertia - expected).norm() < 1e-12);
        assert!((body.center_m() - (from + to) * 0.5).norm() < 1e-12);
    }

    #[test]
    fn a_surface_with_a_hole_or_without_volume_is_none() {
        let mut open = box_of(Vector3::zeros(), Vector3::repeat(1.0), false);
        open.truncate(10);
        assert_eq!(Body::within(&open), None);
        let flat = box_of(Vector3::zeros(), Vector3::new(1.0, 1.0, 0.0), false);
        assert_eq!(Body::within(&flat), None);
        assert_eq!(Body::within(&[]), None);
    }
}
