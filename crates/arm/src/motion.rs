//! Motion of the links: energy and Jacobian of a frame.

use nalgebra::{Matrix3, Matrix6xX, Vector3};

use crate::dynamics::{Body, Dynamics, Energy};
use crate::model::FrameId;

impl Dynamics {
    /// Kinetic and potential energy at posture `q` and velocity `v`.
    ///
    /// # Panics
    /// If a slice does not have one value per joint.
    pub fn energy(&mut self, q: &[f64], v: &[f64], gravity_m_s2: &Vector3<f64>) -> Energy {
        let mut energy = Energy {
            kinetic_j: 0.0,
            potential_j: 0.0,
        };
        self.walk(q, v, |body, rotation, origin, velocity, omega| {
            let com = rotation * body.com_m;
            let speed = velocity + omega.cross(&com);
            let omega_in_link = rotation.transpose() * omega;
            let spin = body.inertia_about_com_kg_m2 * omega_in_link;
            energy.kinetic_j +=
                0.5 * (body.mass_kg * speed.norm_squared() + omega_in_link.dot(&spin));
            energy.potential_j -= body.mass_kg * gravity_m_s2.dot(&(origin + com));
        });
        energy
    }

    /// Geometric Jacobian of a frame, as [`Robot::jacobian`](crate::Robot::jacobian).
    ///
    /// # Panics
    /// If `q` or `jacobian` does not fit the number of joints.
    pub fn jacobian_into(&mut self, q: &[f64], frame: FrameId, jacobian: &mut Matrix6xX<f64>) {
        assert_eq!(jacobian.ncols(), self.dof(), "one column per joint");
        let (offset_m, _) = self.frame(frame);
        let zeros = std::mem::take(&mut self.zeros);
        let mut screws = std::mem::take(&mut self.screws);
        screws.clear();
        let mut point_m = Vector3::zeros();
        // First pass over the links stores axis and origin; the point is known at the end.
        self.walk(q, &zeros, |body, rotation, origin, _, _| {
            screws.push((rotation * body.axis, *origin));
            point_m = origin + rotation * offset_m;
        });
        self.zeros = zeros;
        jacobian.fill(0.0);
        for (body, (axis, origin)) in self.bodies.iter().zip(&screws) {
            let mut column = jacobian.column_mut(body.coordinate);
            let axis = axis * body.multiplier;
            let mut linear = column.fixed_rows_mut::<3>(0);
            if body.revolute {
                linear += axis.cross(&(point_m - origin));
                let mut angular = column.fixed_rows_mut::<3>(3);
                angular += axis;
            } else {
                linear += axis;
            }
        }
        self.screws = screws;
    }

    fn frame(&self, frame: FrameId) -> (Vector3<f64>, Matrix3<f64>) {
        match frame {
            FrameId::Flange => self.frames[0],
            FrameId::Tool => self.frames[1],
            FrameId::Foot => self.frames[2],
        }
    }

    /// Calls `visit(body, world_from_link, origin, velocity of the origin, angular velocity)` for
    /// each link, all in world axes.
    fn walk(
        &mut self,
        q: &[f64],
        v: &[f64],
        mut visit: impl FnMut(&Body, &Matrix3<f64>, &Vector3<f64>, &Vector3<f64>, &Vector3<f64>),
    ) {
        assert_eq!(v.len(), self.dof(), "one velocity per joint");
        self.place(q);
        let mut rotation = Matrix3::identity();
        let mut origin = Vector3::zeros();
        let mut velocity = Vector3::zeros();
        let mut omega = Vector3::zeros();
        for (body, state) in self.bodies.iter().zip(&self.states) {
            let rate = body.rate(v);
            let step = rotation * state.origin_m;
            velocity += omega.cross(&step);
            origin += step;
            rotation *= state.parent_from_link;
            let along = rotation * body.axis * rate;
            if body.revolute {
                omega += along;
            } else {
                velocity += along;
            }
            visit(body, &rotation, &origin, &velocity, &omega);
        }
    }
}
