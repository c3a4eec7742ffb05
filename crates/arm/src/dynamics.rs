//! Inverse dynamics (recursive Newton–Euler), mass matrix (composite bodies).
//!
//! Both recursions run in link frames, after `featherstone2008`,
//! sections 5.3 and 6.2, written with 3-vectors. Transmissions are not part of it: no stiffness,
//! damping, friction or rotor inertia.

use nalgebra::{DMatrix, Isometry3, Matrix3, Vector3};

use crate::model::{FrameId, JointKind, Robot};

/// Kinetic and potential energy in J; the potential is zero with all masses at the world's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    pub kinetic_j: f64,
    pub potential_j: f64,
}

/// Constant data of one joint and its link.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) revolute: bool,
    /// Its joint's coordinate is `multiplier` times this one of the chain, and `offset`.
    pub(crate) coordinate: usize,
    pub(crate) multiplier: f64,
    offset: f64,
    pub(crate) axis: Vector3<f64>,
    axis_cross: Matrix3<f64>,
    axis_cross_squared: Matrix3<f64>,
    parent_from_joint: Matrix3<f64>,
    joint_origin_m: Vector3<f64>,
    slide: Vector3<f64>,
    pub(crate) mass_kg: f64,
    pub(crate) com_m: Vector3<f64>,
    pub(crate) inertia_about_com_kg_m2: Matrix3<f64>,
    inertia_about_origin_kg_m2: Matrix3<f64>,
}

/// State of one link during a recursion, in link axes unless it says otherwise.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct State {
    pub(crate) parent_from_link: Matrix3<f64>,
    /// Link origin in parent axes, from the parent's origin.
    pub(crate) origin_m: Vector3<f64>,
    angular_velocity: Vector3<f64>,
    angular_acceleration: Vector3<f64>,
    acceleration: Vector3<f64>,
    force: Vector3<f64>,
    moment: Vector3<f64>,
    composite_mass: f64,
    composite_first_moment: Vector3<f64>,
    composite_inertia: Matrix3<f64>,
}

/// Workspace for dynamics in a step loop: made once per robot, allocates nothing afterwards.
///
/// All slices must have one value per joint, in chain order; the methods panic otherwise.
#[derive(Debug, Clone)]
pub struct Dynamics {
    pub(crate) bodies: Vec<Body>,
    pub(crate) states: Vec<State>,
    pub(crate) zeros: Vec<f64>,
    pub(crate) frames: [(Vector3<f64>, Matrix3<f64>); 3],
    /// Axis and origin of each link's joint in the world, while a Jacobian is made.
    pub(crate) screws: Vec<(Vector3<f64>, Vector3<f64>)>,
    /// The posture that `states` hold; a step asks for several things at one posture.
    placed: Vec<f64>,
}

impl Dynamics {
    /// Takes the constant data out of `robot`.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let bodies: Vec<_> = (robot.chain.moving())
            .map(|joint| {
                let link = joint.link;
                let axis = joint.axis.into_inner();
                let parent_from_joint = *joint
                    .parent_from_joint
                    .rotation
                    .to_rotation_matrix()
                    .matrix();
                let com_cross = link.com_m.cross_matrix();
                Body {
                    revolute: joint.kind == JointKind::Revolute,
                    coordinate: joint.coordinate,
                    multiplier: joint.multiplier,
                    offset: joint.offset,
                    axis,
                    axis_cross: axis.cross_matrix(),
                    axis_cross_squared: axis.cross_matrix() * axis.cross_matrix(),
                    parent_from_joint,
                    joint_origin_m: joint.parent_from_joint.translation.vector,
                    slide: parent_from_joint * axis,
                    mass_kg: link.mass_kg,
                    com_m: link.com_m,
                    inertia_about_com_kg_m2: link.inertia_about_com_kg_m2,
                    inertia_about_origin_kg_m2: link.inertia_about_com_kg_m2
                        - com_cross * com_cross * link.mass_kg,
                }
            })
            .collect();
        let frame = |id| {
            let pose: Isometry3<f64> = robot.last_link_from_frame(id);
            let rotation = *pose.rotation.to_rotation_matrix().matrix();
            (pose.translation.vector, rotation)
        };
        Self {
            states: vec![State::default(); bodies.len()],
            zeros: vec![0.0; robot.dof()],
            screws: Vec::with_capacity(bodies.len()),
            frames: [FrameId::Flange, FrameId::Tool, FrameId::Foot].map(frame),
            placed: vec![f64::NAN; robot.dof()],
            bodies,
        }
    }

    /// Number of joints.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.placed.len()
    }

    pub(crate) fn place(&mut self, q: &[f64]) {
        assert_eq!(q.len(), self.dof(), "one coordinate per joint");
        // Never with a NaN in it.
        if self.placed == q {
            return;
        }
        self.placed.copy_from_slice(q);
        for (body, state) in self.bodies.iter().zip(&mut self.states) {
            let q = body.value(q);
            if body.revolute {
                let (sin, cos) = q.sin_cos();
                // Rodrigues: 1 + sin q [a]× + (1 − cos q) [a]×².
                let motion = Matrix3::identity()
                    + body.axis_cross * sin
                    + body.axis_cross_squared * (1.0 - cos);
                state.parent_from_link = body.parent_from_joint * motion;
                state.origin_m = body.joint_origin_m;
            } else {
                state.parent_from_link = body.parent_from_joint;
                state.origin_m = body.joint_origin_m + body.slide * q;
            }
        }
    }

    /// Joint torques (N m or N) that produce the acceleration `a` at posture `q` and velocity `v`
    /// under `gravity_m_s2` (world axes): M(q) a + h(q, v) + g(q).
    ///
    /// # Panics
    /// If a slice does not have one value per joint.
    pub fn inverse_dynamics_into(
        &mut self,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        gravity_m_s2: &Vector3<f64>,
        tau: &mut [f64],
    ) {
        let n = self.dof();
        assert!(
            v.len() == n && a.len() == n && tau.len() == n,
            "one value per joint"
        );
        self.place(q);
        self.accelerate(v, a, gravity_m_s2);
        self.gather(tau);
    }

    /// Outward pass: velocity, acceleration, and the force and moment (about its origin) that each
    /// link needs by itself.
    fn accelerate(&mut self, v: &[f64], a: &[f64], gravity_m_s2: &Vector3<f64>) {
        let mut parent = State {
            // Gravity enters as an upward acceleration of the base.
            acceleration: -gravity_m_s2,
            ..State::default()
        };
        for (body, state) in self.bodies.iter().zip(&mut self.states) {
            let link_from_parent = state.parent_from_link.transpose();
            let omega = link_from_parent * parent.angular_velocity;
            let alpha = link_from_parent * parent.angular_acceleration;
            let swing = parent.angular_velocity.cross(&state.origin_m);
            let acceleration = link_from_parent
                * (parent.acceleration
                    + parent.angular_acceleration.cross(&state.origin_m)
                    + parent.angular_velocity.cross(&swing));
            let rate = body.axis * body.rate(v);
            if body.revolute {
                state.angular_velocity = omega + rate;
                state.angular_acceleration = alpha + body.axis * body.rate(a) + omega.cross(&rate);
                state.acceleration = acceleration;
            } else {
                state.angular_velocity = omega;
                state.angular_acceleration = alpha;
                state.acceleration =
                    acceleration + body.axis * body.rate(a) + omega.cross(&rate) * 2.0;
            }
            let omega = state.angular_velocity;
            let alpha = state.angular_acceleration;
            let com_acceleration = state.acceleration
                + alpha.cross(&body.com_m)
                + omega.cross(&omega.cross(&body.com_m));
            let spin = body.inertia_about_com_kg_m2 * omega;
            state.force = com_acceleration * body.mass_kg;
            state.moment = body.inertia_about_com_kg_m2 * alpha
                + omega.cross(&spin)
                + body.com_m.cross(&state.force);
            parent = *state;
        }
    }

    /// Inward pass: each joint carries its link and all beyond it.
    fn gather(&mut self, tau: &mut [f64]) {
        tau.fill(0.0);
        for i in (0..self.bodies.len()).rev() {
            let state = self.states[i];
            let along = if self.bodies[i].revolute {
                state.moment
            } else {
                state.force
            };
            let body = &self.bodies[i];
            tau[body.coordinate] += body.multiplier * body.axis.dot(&along);
            if i > 0 {
                let force = state.parent_from_link * state.force;
                let moment = state.parent_from_link * state.moment + state.origin_m.cross(&force);
                self.states[i - 1].force += force;
                self.states[i - 1].moment += moment;
            }
        }
    }

    /// Coriolis, centrifugal and gravity torques h(q, v) + g(q).
    ///
    /// # Panics
    /// If a slice does not have one value per joint.
    pub fn bias_into(
        &mut self,
        q: &[f64],
        v: &[f64],
        gravity_m_s2: &Vector3<f64>,
        tau: &mut [f64],
    ) {
        let zeros = std::mem::take(&mut self.zeros);
        self.inverse_dynamics_into(q, v, &zeros, gravity_m_s2, tau);
        self.zeros = zeros;
    }

    /// Torques g(q) that hold the arm still against gravity.
    ///
    /// # Panics
    /// If a slice does not have one value per joint.
    pub fn gravity_torques_into(
        &mut self,
        q: &[f64],
        gravity_m_s2: &Vector3<f64>,
        tau: &mut [f64],
    ) {
        let zeros = std::mem::take(&mut self.zeros);
        self.inverse_dynamics_into(q, &zeros, &zeros, gravity_m_s2, tau);
        self.zeros = zeros;
    }

    /// Mass matrix M(q), n×n, symmetric (both triangles are written).
    ///
    /// # Panics
    /// If `q` or `mass` does not fit the number of joints.
    pub fn mass_matrix_into(&mut self, q: &[f64], mass: &mut DMatrix<f64>) {
        let n = self.dof();
        assert!(
            mass.nrows() == n && mass.ncols() == n,
            "one row and column per joint"
        );
        self.place(q);
        for (body, state) in self.bodies.iter().zip(&mut self.states) {
            state.composite_mass = body.mass_kg;
            state.composite_first_moment = body.com_m * body.mass_kg;
            state.composite_inertia = body.inertia_about_origin_kg_m2;
        }
        mass.fill(0.0);
        for i in (0..self.bodies.len()).rev() {
            let state = self.states[i];
            let axis = self.bodies[i].axis;
            let (mut force, mut moment) = if self.bodies[i].revolute {
                let moment = state.composite_inertia * axis;
                (axis.cross(&state.composite_first_moment), moment)
            } else {
                let moment = state.composite_first_moment.cross(&axis);
                (axis * state.composite_mass, moment)
            };
            for j in (0..=i).rev() {
                let along = if self.bodies[j].revolute {
                    moment
                } else {
                    force
                };
                let (one, other) = (&self.bodies[i], &self.bodies[j]);
                let inertia = one.multiplier * other.multiplier * other.axis.dot(&along);
                let (one, other) = (one.coordinate, other.coordinate);
                mass[(one, other)] += inertia;
                if i != j {
                    mass[(other, one)] += inertia;
                }
                let turn = self.states[j].parent_from_link;
                force = turn * force;
                moment = turn * moment + self.states[j].origin_m.cross(&force);
            }
            if i > 0 {
                self.states[i - 1].absorb(&state);
            }
        }
    }
}

impl Body {
    /// Coordinate of its joint at posture `q`.
    fn value(&self, q: &[f64]) -> f64 {
        self.multiplier * q[self.coordinate] + self.offset
    }

    /// Rate of its joint's coordinate, of those of the chain.
    pub(crate) fn rate(&self, rates: &[f64]) -> f64 {
        self.multiplier * rates[self.coordinate]
    }
}

impl State {
    /// Adds the composite body of `child` to this link's.
    fn absorb(&mut self, child: &Self) {
        let turn = child.parent_from_link;
        let shift = child.origin_m.cross_matrix();
        let first_moment = turn * child.composite_first_moment;
        let cross = first_moment.cross_matrix();
        let mass = child.composite_mass;
        self.composite_mass += mass;
        self.composite_first_moment += first_moment + child.origin_m * mass;
        self.composite_inertia += turn * child.composite_inertia * turn.transpose()
            - shift * cross
            - cross * shift
            - shift * shift * mass;
    }
}

impl Robot {
    /// Mass matrix M(q), n×n.
    ///
    /// # Panics
    /// If `q` does not have one value per joint.
    #[must_use]
    pub fn mass_matrix(&self, q: &[f64]) -> DMatrix<f64> {
        let mut mass = DMatrix::zeros(self.dof(), self.dof());
        Dynamics::new(self).mass_matrix_into(q, &mut mass);
        mass
    }
}
