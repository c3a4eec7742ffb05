//! The patch in which a soft wheel meets a face, whole or cut by the face's edges.
//!
//! Frame of the patch: origin at the middle of the undeformed contact, x along the running
//! direction of a line patch, y along its axis, z the outward normal of the workpiece. Indentation
//! of the wheel's bed: `u = u0 - x²/2R` (line), less `y²/2R` too (point). The layer's equation
//! (`bed`) gives three parts of what the face presses:
//!
//! 1. within the patch the pressure `q(u) - N ∇²u`;
//! 2. where the layer leaves freely nothing extra: the patch ends where it leaves without a kink;
//! 3. along an edge of the face a **line reaction**. The overhanging layer is not pressed and runs
//!    back to its free shape, so it leaves with the slope `|w'|` that its bed gives
//!    (`Bed::leaving_n_per_m`); on the face it has the slope of the indentation, `∂u/∂n = -x·n/R`.
//!    The edge holds the kink: `P = N (|w'| + ∂u/∂n)` per length.
//!
//! Part 3 is zero while the edge lies outside the patch, and grows as the patch moves over it: it
//! is the pressure rise at the edge, and comes from radius, pressure and bed alone. When the middle
//! is so far off the face that the layer rises from the edge on both sides (`∂u/∂n > |w'|`), the
//! edge presses like a knife with twice the leaving slope, until the wheel is clear.
//!
//! A line reaction is found in the plane across the edge: exact for a line patch along the edge; on
//! a point patch the edge bears the part of it that two dimensions leave (`edge_share`). The point
//! reaction that a corner of the face adds is neglected. The layer's mass per area m lowers its
//! tension to `N - m v²`: 3 % at 2.4 m/s for 5 mm of rubber at 0.1 MPa and 20 mm radius; it is left
//! out.

use super::bed::Bed;
use super::face::Face;
use super::quadrature::Quadrature;
use crate::roots::{bisect, newton, newton_within};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::PI;
use std::sync::LazyLock;

mod corner;
mod edge_share;
mod integrals;

/// The patch reaches at least so far out, as a part of the undeformed half length: where its
/// boundary is looked for.
const INNERMOST: f64 = 1e-3;
/// A step so small, as a part of the undeformed half length, is the last: convergence is quadratic.
const LAST_STEP: f64 = 1e-8;

/// Nodes across half a line patch; loads at rest are asked for by the hundred.
static RULES: LazyLock<Quadrature> = LazyLock::new(|| Quadrature::new(24));

/// In which directions the layer is stretched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// All: an inflated shell.
    Isotropic,
    /// Along x only: a belt.
    AlongX,
}

/// Shape of the undeformed contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A sphere of this radius.
    Point { radius_m: f64 },
    /// A cylinder about y of this radius (relative to the face), of this half width.
    Line { radius_m: f64, half_width_m: f64 },
}

impl Shape {
    fn radius_m(&self) -> f64 {
        match *self {
            Shape::Point { radius_m } | Shape::Line { radius_m, .. } => radius_m,
        }
    }
}

/// A wheel at a given indentation of its bed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    bed: Bed,
    layer: Layer,
    shape: Shape,
    bed_indentation_m: f64,
    bed_indentation_rate: f64,
    contact_m: f64,
}

/// How the wheel's surface moves over the workpiece, in the patch's frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sliding {
    /// Velocity of the wheel's surface relative to the workpiece at the middle of the patch, m/s.
    pub velocity_m_per_s: Vector2<f64>,
    /// Angular velocity about the normal, rad/s: `v(x) = v + ω ẑ × x`.
    pub spin_rad_s: f64,
    /// Rate of indentation, m/s.
    pub approach_m_per_s: f64,
    /// Friction coefficient.
    pub mu: f64,
}

impl Sliding {
    /// A wheel that turns by `spin` about the normal through the point `centre` of the patch's
    /// frame: `v(x) = ω ẑ × (x - x0)` (precession: `x0 = -(ρ - d) tan θ (cos α, sin α)`).
    pub fn about(centre_m: Point2<f64>, spin_rad_s: f64, mu: f64) -> Self {
        Self {
            velocity_m_per_s: spin_rad_s * Vector2::new(centre_m.y, -centre_m.x),
            spin_rad_s,
            approach_m_per_s: 0.0,
            mu,
        }
    }

    /// Sliding velocity at a point of the patch, m/s.
    pub fn at_m_per_s(&self, x: f64, y: f64) -> Vector2<f64> {
        self.velocity_m_per_s + self.spin_rad_s * Vector2::new(-y, x)
    }
}

/// What the wheel does to the workpiece, in the patch's frame about its origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PatchLoads {
    /// Normal force, N; positive presses.
    pub normal_n: f64,
    /// Part of it that acts along edges, N.
    pub edge_n: f64,
    /// Where the normal force acts times itself, `∫ x p dA`, N m.
    pub first_moment_n_m: Vector2<f64>,
    /// Friction on the workpiece, along the sliding of the wheel's surface, N.
    pub friction_n: Vector2<f64>,
    /// Moment of friction about the normal, N m.
    pub spin_moment_n_m: f64,
    /// `∫ p |v| dA` over the patch and along edges, W: Preston's integral.
    pub sliding_w: f64,
    /// Part of it along edges, W.
    pub edge_sliding_w: f64,
}

impl PatchLoads {
    fn add(&mut self, at: Point2<f64>, force_n: f64, sliding: &Sliding) -> f64 {
        let v = sliding.at_m_per_s(at.x, at.y);
        let speed = v.norm();
        let rubbed = if speed > 0.0 {
            v * (sliding.mu * force_n / speed)
        } else {
            Vector2::zeros()
        };
        self.add_rubbed(at, force_n, speed, rubbed)
    }

    /// A force at a place over which the wheel's surface slides at a speed, and the force in the
    /// plane that goes with it.
    fn add_rubbed(
        &mut self,
        at: Point2<f64>,
        force_n: f64,
        speed_m_per_s: f64,
        in_plane_n: Vector2<f64>,
    ) -> f64 {
        self.normal_n += force_n;
        self.first_moment_n_m += force_n * at.coords;
        self.sliding_w += force_n * speed_m_per_s;
        self.friction_n += in_plane_n;
        self.spin_moment_n_m += at.coords.perp(&in_plane_n);
        force_n * speed_m_per_s
    }
}

/// A piece of edge with its reaction: where, and what it contributes to Preston's integral.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePoint {
    pub at_m: Point2<f64>,
    /// Length of the piece.
    pub length_m: f64,
    /// Normal of the edge out of the face.
    pub outward: Vector2<f64>,
    pub force_n: f64,
    pub sliding_w: f64,
}

impl Patch {
    /// A patch whose bed is indented by `u0` at its middle, m.
    pub(super) fn new(bed: Bed, layer: Layer, shape: Shape, bed_indentation_m: f64) -> Self {
        let mut patch = Self {
            bed,
            layer,
            shape,
            bed_indentation_m: bed_indentation_m.max(0.0),
            bed_indentation_rate: 1.0,
            contact_m: 0.0,
        };
        patch.contact_m = patch.free_boundary_m();
        patch
    }

    /// Rate of the bed's indentation per rate of the wheel's.
    pub(super) fn with_bed_indentation_rate(mut self, rate: f64) -> Self {
        self.bed_indentation_rate = rate;
        self
    }

    /// What it rests on.
    #[cfg(test)]
    pub(super) fn bed(&self) -> &Bed {
        &self.bed
    }

    /// Half the length over which the undeformed wheel lies in the face, m.
    pub fn undeformed_half_length_m(&self) -> f64 {
        (2.0 * self.shape.radius_m() * self.bed_indentation_m).sqrt()
    }

    /// Radius (half width, for a line) of the patch away from edges, m.
    pub fn contact_m(&self) -> f64 {
        self.contact_m
    }

    /// Where the layer leaves without a kink: `N |w'| = N c / R`, by Newton's iteration on the
    /// difference of the squares times c, which is a smooth function down to the middle, kept
    /// between two bounds of the root. It begins where a straight line would leave a linear bed as
    /// stiff as this one at its deepest.
    fn free_boundary_m(&self) -> f64 {
        let (r, n) = (self.shape.radius_m(), self.bed.tension_n_per_m);
        let whole = self.undeformed_half_length_m();
        if n <= 0.0 || whole <= 0.0 {
            return whole;
        }
        let round = match self.shape {
            Shape::Line { .. } if self.bed.shell_m_per_pa == 0.0 => {
                return self.belt_boundary_m().max(INNERMOST * whole);
            }
            Shape::Point { .. } => 1.0,
            Shape::Line { .. } => 0.0,
        };
        // with its slope over c
        let kink = |c: f64| {
            let pull = (n * c / r).powi(2);
            let (straight, bending) =
                (self.bed).squares_with_slopes(self.bed_indentation_at_m(c, 0.0));
            let value = c * (straight[0] - pull) + round * bending[0];
            let slope = straight[0] - 3.0 * pull - (c * straight[1] + round * bending[1]) * c / r;
            (value, slope)
        };
        let (low, high) = (INNERMOST * whole, whole);
        if kink(low).0 <= 0.0 {
            return low;
        }
        let stiffness = self.bed.pressure_pa(self.bed_indentation_m) / self.bed_indentation_m;
        let fall = (n / stiffness).sqrt();
        let start = (fall * fall + whole * whole).sqrt() - fall;
        newton_within([high, low], start, LAST_STEP * whole, kink)
    }

    /// [`Self::free_boundary_m`] of a belt on Hertz's bed. With the indentation `w = s²` at the
    /// boundary, `2NΨ = (N c/R)²` is `2/(3√c2) s³ + N/R (s² - u0) = 0`, whose left side bends
    /// upwards: Newton's iteration comes down to the root.
    fn belt_boundary_m(&self) -> f64 {
        let (r, n) = (self.shape.radius_m(), self.bed.tension_n_per_m);
        let (u0, a) = (
            self.bed_indentation_m,
            2.0 / (3.0 * self.bed.tread_m_per_pa2.sqrt()),
        );
        let b = n / r;
        // The left side is positive where the indentation ends, and, with α = a √u0/b > 1, at the
        // fourth root of α further down.
        let stiff = (a * u0.sqrt() / b).max(1.0);
        let s = newton((u0 / stiff.sqrt()).sqrt(), LAST_STEP, |s| {
            -(a * s * s * s + b * (s * s - u0)) / (s * (3.0 * a * s + 2.0 * b))
        });
        (2.0 * r * (u0 - s * s)).max(0.0).sqrt()
    }

    /// Indentation of the bed by the undeformed wheel at a point, m; negative where there is a gap.
    pub fn bed_indentation_at_m(&self, x: f64, y: f64) -> f64 {
        let off = match self.shape {
            Shape::Point { .. } => x * x + y * y,
            Shape::Line { .. } => x * x,
        };
        self.bed_indentation_m - off / (2.0 * self.shape.radius_m())
    }

    /// Slope of the bed's pressure over its indentation at a point of the patch, Pa/m.
    pub fn bed_stiffness_pa_per_m(&self, x: f64, y: f64) -> f64 {
        let u = self.bed_indentation_at_m(x, y);
        let h = 1e-4 * u;
        (self.bed.pressure_pa(u + h) - self.bed.pressure_pa(u - h)) / (2.0 * h)
    }

    /// Pressure that the layer's tension gives the face within the patch, Pa: `-N ∇²u`.
    fn layer_pressure_pa(&self) -> f64 {
        let directions = match (self.layer, self.shape) {
            (Layer::Isotropic, Shape::Point { .. }) => 2.0,
            _ => 1.0,
        };
        directions * self.bed.tension_n_per_m / self.shape.radius_m()
    }

    fn touches(&self, x: f64, y: f64) -> bool {
        match self.shape {
            Shape::Point { .. } => x.hypot(y) < self.contact_m,
            Shape::Line { half_width_m, .. } => x.abs() < self.contact_m && y.abs() <= half_width_m,
        }
    }

    /// Pressure on the face at a point of it at rest, Pa, without the line reactions of edges.
    pub fn pressure_pa(&self, x: f64, y: f64) -> f64 {
        self.moving_pressure_pa(x, y, &Sliding::default())
    }

    /// Pressure when the wheel's surface moves: the bed's damping answers `ẇ = u̇0 + v·∇u`.
    pub fn moving_pressure_pa(&self, x: f64, y: f64, sliding: &Sliding) -> f64 {
        if !self.touches(x, y) {
            return 0.0;
        }
        let mut pressure =
            self.bed.pressure_pa(self.bed_indentation_at_m(x, y)) + self.layer_pressure_pa();
        if self.bed.damping_pa_s_per_m > 0.0 {
            let v = sliding.at_m_per_s(x, y);
            let along = match self.shape {
                Shape::Point { .. } => v.x * x + v.y * y,
                Shape::Line { .. } => v.x * x,
            };
            let rate = self.bed_indentation_rate * sliding.approach_m_per_s
                - along / self.shape.radius_m();
            pressure += self.bed.damping_pa_s_per_m * rate;
        }
        pressure.max(0.0)
    }

    /// Normal force at rest on a face without edges nearby, N.
    pub fn free_force_n(&self) -> f64 {
        let (r, c) = (self.shape.radius_m(), self.contact_m);
        match self.shape {
            // ∫ q 2πρ dρ with ρ dρ = -R du
            Shape::Point { .. } => {
                let rim = self.bed_indentation_at_m(c, 0.0);
                let bed = self.bed.energy_j_per_m2(self.bed_indentation_m)
                    - self.bed.energy_j_per_m2(rim);
                2.0 * PI * r * bed + self.layer_pressure_pa() * PI * c * c
            }
            Shape::Line { half_width_m, .. } => {
                let b = self.undeformed_half_length_m();
                if b <= 0.0 {
                    return 0.0;
                }
                let end = (c / b).min(1.0).asin();
                let bed = RULES.integrate(0.0, end, |phi| {
                    self.bed
                        .pressure_pa(self.bed_indentation_m * phi.cos().powi(2))
                        * b
                        * phi.cos()
                });
                4.0 * half_width_m * (bed + self.layer_pressure_pa() * c)
            }
        }
    }

    /// Half lengths of the window that holds everything, m.
    pub fn window_m(&self) -> Vector2<f64> {
        let b = self.undeformed_half_length_m();
        match self.shape {
            Shape::Point { .. } => Vector2::new(b, b),
            Shape::Line { half_width_m, .. } => Vector2::new(b, half_width_m),
        }
    }

    /// Loads on the workpiece over the part of the patch that lies on the face. `patch_from_face`
    /// takes the face's coordinates to the patch's. Edge reactions are handed to `edge` one by one.
    pub fn loads(
        &self,
        face: &Face,
        patch_from_face: &Isometry2<f64>,
        sliding: &Sliding,
        quadrature: &Quadrature,
        mut edge: impl FnMut(EdgePoint),
    ) -> PatchLoads {
        let mut loads = PatchLoads::default();
        if self.bed_indentation_m <= 0.0 {
            return loads;
        }
        let sides = face.within(patch_from_face, self.window_m());
        self.add_patch(face, &sides, sliding, quadrature, &mut loads);
        for side in &sides {
            self.add_edge(side, sliding, quadrature, &mut |mut point, tilt_rad| {
                let v = sliding.at_m_per_s(point.at_m.x, point.at_m.y);
                let rubbed = corner::friction(&side.outward, tilt_rad, sliding.mu, v);
                point.sliding_w =
                    loads.add_rubbed(point.at_m, point.force_n, v.norm(), rubbed * point.force_n);
                loads.edge_n += point.force_n;
                loads.edge_sliding_w += point.sliding_w;
                edge(point);
            });
        }
        loads
    }
}

/// Indentation at which a growing force reaches `force_n`, m, sought up to `longest_m`.
pub(super) fn indentation_for(force_n: f64, longest_m: f64, force: impl Fn(f64) -> f64) -> f64 {
    let [low, high] = bisect([0.0, longest_m], 60, |depth_m| force(depth_m) >= force_n);
    0.5 * (low + high)
}

#[cfg(test)]
mod tests;
