//! Quadrature of a patch over the face, and of the line reactions along its edges.

use super::edge_share::edge_share;
use super::{EdgePoint, Layer, Patch, PatchLoads, Shape, Sliding};
use crate::wheel::face::{Face, Side};
use crate::wheel::quadrature::{ACROSS_NODES, Across, DISC_NODES, Disc, Quadrature};
use nalgebra::{Point2, Vector2};
use std::f64::consts::FRAC_PI_2;

/// Points that are summed side by side.
const LANES: usize = 4;
/// The belt's velocity changes by at most this part over a narrow patch: there two rows are exact
/// to its fourth power.
const NARROW: f64 = 0.02;

/// Force, its first moments, Preston's integral, friction and its moment, each in lanes.
#[derive(Default)]
struct Sums([[f64; LANES]; 7]);

impl Sums {
    /// A force at a place over which the wheel's surface slides.
    #[inline]
    fn add(&mut self, lane: usize, [x, y]: [f64; 2], [u, v]: [f64; 2], force_n: f64, mu: f64) {
        let speed = (u * u + v * v).sqrt();
        let rubbed = if speed > 0.0 {
            mu * force_n / speed
        } else {
            0.0
        };
        let (fx, fy) = (u * rubbed, v * rubbed);
        let values = [
            force_n,
            force_n * x,
            force_n * y,
            force_n * speed,
            fx,
            fy,
            x * fy - y * fx,
        ];
        for (sum, value) in self.0.iter_mut().zip(values) {
            sum[lane] += value;
        }
    }
}

impl PatchLoads {
    fn add_sums(&mut self, sums: &Sums) {
        let [normal, first_x, first_y, power, fx, fy, moment] =
            sums.0.map(|lanes| lanes.iter().sum::<f64>());
        self.normal_n += normal;
        self.first_moment_n_m += Vector2::new(first_x, first_y);
        self.sliding_w += power;
        self.friction_n += Vector2::new(fx, fy);
        self.spin_moment_n_m += moment;
    }
}

impl Patch {
    /// Rows across the patch between the ordinates at which the face's boundary changes, parts of
    /// rows on the face; both by the sine of an angle, in which pressures that fall to zero like a
    /// root are smooth.
    pub(super) fn add_patch(
        &self,
        face: &Face,
        sides: &[Side],
        sliding: &Sliding,
        quadrature: &Quadrature,
        loads: &mut PatchLoads,
    ) {
        let c = self.contact_m;
        if c <= 0.0 {
            return;
        }
        if let Some(half_y) = self.is_narrow(face, sides, sliding) {
            self.add_narrow(half_y, sliding, quadrature, loads);
            return;
        }
        let mut crossings = Vec::new();
        if matches!(self.shape, Shape::Point { .. }) && is_whole(face, sides, c, &mut crossings) {
            self.add_disc(sliding, quadrature, loads);
            return;
        }
        let half_y = self.half_y_m();
        let ends = self.row_breaks(sides);
        for pair in ends.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            for (node, weight) in quadrature.for_share(half / FRAC_PI_2) {
                let (sin, cos) = (middle + half * node).sin_cos();
                let y = half_y * sin;
                let row_weight = weight * half * half_y * cos;
                let half_x = match self.shape {
                    Shape::Point { .. } => c * cos,
                    Shape::Line { .. } => c,
                };
                face.row(sides, y, half_x, &mut crossings, |from, to| {
                    let (a, b) = ((from / half_x).asin(), (to / half_x).asin());
                    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
                    for (node, weight) in quadrature.for_share(half / FRAC_PI_2) {
                        let (sin, cos) = (middle + half * node).sin_cos();
                        let x = half_x * sin;
                        let area = row_weight * weight * half * half_x * cos;
                        let pressure = self.moving_pressure_pa(x, y, sliding);
                        loads.add(Point2::new(x, y), pressure * area, sliding);
                    }
                });
            }
        }
    }

    /// Half width of a line patch without edges over which the wheel's surface slides alike.
    pub(super) fn is_narrow(&self, face: &Face, sides: &[Side], sliding: &Sliding) -> Option<f64> {
        let Shape::Line { half_width_m, .. } = self.shape else {
            return None;
        };
        let speed = sliding.velocity_m_per_s.norm();
        let changes = sliding.spin_rad_s.abs() * half_width_m.hypot(self.contact_m);
        let alike = changes <= NARROW * speed && speed > 0.0;
        (alike && sides.is_empty() && face.is_unbounded()).then_some(half_width_m)
    }

    /// A narrow patch: pressures across it once, four side by side, in two rows, which are exact up
    /// to the third power of the place.
    fn add_narrow(
        &self,
        half_y: f64,
        sliding: &Sliding,
        quadrature: &Quadrature,
        loads: &mut PatchLoads,
    ) {
        let (across, c) = (quadrature.across(), self.contact_m);
        let [vx, vy] = sliding.velocity_m_per_s.into();
        let rest_pa = self.at_rest_pa(across);
        let flatter = 1.0 / self.shape.radius_m();
        let approach = self.bed_indentation_rate * sliding.approach_m_per_s;
        let damping = self.bed.damping_pa_s_per_m;
        let mut sums = Sums::default();
        for (node, weight) in quadrature.pair() {
            let (y, width) = (node * half_y, weight * half_y);
            let u = vx - sliding.spin_rad_s * y;
            for k in (0..ACROSS_NODES).step_by(LANES) {
                for lane in 0..LANES {
                    let x = c * across.x[k + lane];
                    let v = vy + sliding.spin_rad_s * x;
                    let pressure = rest_pa[k + lane] + damping * (approach - u * x * flatter);
                    let pressed = if pressure > 0.0 { pressure } else { 0.0 };
                    let f = pressed * across.length[k + lane] * c * width;
                    sums.add(lane, [x, y], [u, v], f, sliding.mu);
                }
            }
        }
        loads.add_sums(&sums);
    }

    /// Pressure across a line patch at rest, Pa.
    fn at_rest_pa(&self, across: &Across) -> [f64; ACROSS_NODES] {
        let layer_pa = self.layer_pressure_pa();
        across.x.map(|x| {
            self.bed
                .pressure_pa(self.bed_indentation_at_m(self.contact_m * x, 0.0))
                + layer_pa
        })
    }

    /// A round patch that lies on the face as a whole: the same points every time, four of them
    /// side by side.
    fn add_disc(&self, sliding: &Sliding, quadrature: &Quadrature, loads: &mut PatchLoads) {
        let (disc, c) = (quadrature.disc(), self.contact_m);
        let force_n = self.disc_forces_n(disc, sliding);
        let [vx, vy] = sliding.velocity_m_per_s.into();
        let mut sums = Sums::default();
        for k in (0..DISC_NODES).step_by(LANES) {
            for lane in 0..LANES {
                let (x, y, f) = (
                    c * disc.x[k + lane],
                    c * disc.y[k + lane],
                    force_n[k + lane],
                );
                let (u, v) = (vx - sliding.spin_rad_s * y, vy + sliding.spin_rad_s * x);
                sums.add(lane, [x, y], [u, v], f, sliding.mu);
            }
        }
        loads.add_sums(&sums);
    }

    /// Pressure times area at the nodes of the disc, N.
    fn disc_forces_n(&self, disc: &Disc, sliding: &Sliding) -> [f64; DISC_NODES] {
        let c = self.contact_m;
        let flatter = 0.5 / self.shape.radius_m();
        let layer_pa = self.layer_pressure_pa();
        let damping = self.bed.damping_pa_s_per_m;
        let approach = self.bed_indentation_rate * sliding.approach_m_per_s;
        let [vx, vy] = sliding.velocity_m_per_s.into();
        let (c1, c2) = (self.bed.shell_m_per_pa, self.bed.tread_m_per_pa2);
        let mut force_n = [0.0; DISC_NODES];
        for (k, force_n) in force_n.iter_mut().enumerate() {
            let (x, y) = (c * disc.x[k], c * disc.y[k]);
            // Inside the rim the indentation is positive; its bed is
            // [`super::super::bed::Bed::pressure_pa`] without the question.
            let indentation = self.bed_indentation_m - (x * x + y * y) * flatter;
            let bed = 2.0 * indentation / (c1 + (c1 * c1 + 4.0 * c2 * indentation).sqrt());
            // The spin moves points around the middle, not outwards.
            let outwards = vx * x + vy * y;
            let viscous = damping * (approach - 2.0 * flatter * outwards);
            let pressure = bed + layer_pa + viscous;
            let pressed = if pressure > 0.0 { pressure } else { 0.0 };
            *force_n = pressed * disc.area[k] * c * c;
        }
        force_n
    }

    fn half_y_m(&self) -> f64 {
        match self.shape {
            Shape::Point { .. } => self.contact_m,
            Shape::Line { half_width_m, .. } => half_width_m,
        }
    }

    /// Angles between which rows are smooth: ends of sides, and where sides leave the patch.
    fn row_breaks(&self, sides: &[Side]) -> Vec<f64> {
        let (c, half_y) = (self.contact_m, self.half_y_m());
        let mut breaks = vec![-FRAC_PI_2, FRAC_PI_2];
        let mut push = |y: f64| {
            if y.abs() < half_y {
                breaks.push((y / half_y).asin());
            }
        };
        for side in sides {
            let along = side.to_m - side.from_m;
            push(side.from_m.y);
            let mut cut = |t: f64| {
                if (0.0..=1.0).contains(&t) {
                    push(side.from_m.y + t * along.y);
                }
            };
            match self.shape {
                Shape::Point { .. } => {
                    let (near, half) = chord(side, c);
                    if half > 0.0 {
                        cut(near - half);
                        cut(near + half);
                    }
                }
                Shape::Line { .. } if along.x != 0.0 => {
                    cut((c - side.from_m.x) / along.x);
                    cut((-c - side.from_m.x) / along.x);
                }
                Shape::Line { .. } => {}
            }
        }
        breaks.sort_unstable_by(f64::total_cmp);
        // a fine polygon brings more breaks than are worth their rows
        breaks.dedup_by(|later, kept| *later - *kept < 0.02 && *later < FRAC_PI_2);
        breaks
    }

    /// Line reaction per length at a point of an edge, N/m, and by how much the bisector of the
    /// layer's two directions there is turned from the face about the edge, rad.
    fn reaction_n_per_m(
        &self,
        at: Point2<f64>,
        outward: &Vector2<f64>,
        v: Vector2<f64>,
    ) -> (f64, f64) {
        let u = self.bed_indentation_at_m(at.x, at.y);
        let (share, normal) = match self.layer {
            Layer::Isotropic => (1.0, *outward),
            Layer::AlongX => (
                outward.x.abs(),
                Vector2::new(outward.x.signum() * f64::from(outward.x != 0.0), 0.0),
            ),
        };
        let off = match self.shape {
            Shape::Point { .. } => at.coords.dot(&normal),
            Shape::Line { .. } => at.x * normal.x,
        };
        let inward = -v.dot(&normal);
        let on_face = -self.bed.tension_n_per_m * off / self.shape.radius_m();
        let fall = match (self.layer, self.shape) {
            (Layer::Isotropic, Shape::Point { radius_m }) => 1.0 / radius_m,
            _ => 0.0,
        };
        let overhang = self.bed.leaving_edge_n_per_m(u, fall, inward);
        // the layer rises from the edge on the other side at most as it would there
        let knife = if on_face > 0.0 {
            self.bed.leaving_edge_n_per_m(u, fall, -inward)
        } else {
            0.0
        };
        let reaction = share * (overhang + on_face.min(knife)).max(0.0);
        let tilt_rad = match self.layer {
            Layer::Isotropic if reaction > 0.0 => {
                let falls = overhang + on_face + (on_face - knife).max(0.0);
                0.5 * falls / self.bed.tension_n_per_m
            }
            _ => 0.0,
        };
        (reaction, tilt_rad)
    }

    /// Of the reaction that planes across a side give, what the side bears.
    fn edge_share(&self, side: &Side) -> f64 {
        let Shape::Point { radius_m } = self.shape else {
            return 1.0;
        };
        let bed_pa = self.bed.pressure_pa(self.bed_indentation_m);
        let layer = self.bed.tension_n_per_m / (2.0 * radius_m * bed_pa);
        let distance_m = side.from_m.coords.dot(&side.outward);
        edge_share(layer, distance_m / self.undeformed_half_length_m())
    }

    pub(super) fn add_edge(
        &self,
        side: &Side,
        sliding: &Sliding,
        quadrature: &Quadrature,
        add: &mut impl FnMut(EdgePoint, f64),
    ) {
        let b = self.undeformed_half_length_m();
        let along = side.to_m - side.from_m;
        let length = along.norm();
        // the piece over the undeformed contact, as near ± half of the side's length
        let (near, half) = match self.shape {
            Shape::Point { .. } => chord(side, b),
            Shape::Line { half_width_m, .. } => {
                let (x0, x1) = within(side.from_m.x, along.x, b);
                let (y0, y1) = within(side.from_m.y, along.y, half_width_m);
                let (from, to) = (x0.max(y0), x1.min(y1));
                (0.5 * (from + to), 0.5 * (to - from))
            }
        };
        if half.is_nan() || half <= 0.0 {
            return;
        }
        let angle = |t: f64| ((t - near) / half).clamp(-1.0, 1.0).asin();
        let (from, to) = (angle(0.0), angle(1.0));
        let (middle, spread) = (0.5 * (from + to), 0.5 * (to - from));
        if spread <= 0.0 {
            return;
        }
        let share = self.edge_share(side);
        for (node, weight) in quadrature.for_share(1.0) {
            let (sin, cos) = (middle + spread * node).sin_cos();
            let at = side.from_m + (near + half * sin) * along;
            let piece = weight * spread * half * cos * length;
            let v = sliding.at_m_per_s(at.x, at.y);
            let (reaction, tilt_rad) = self.reaction_n_per_m(at, &side.outward, v);
            if reaction > 0.0 {
                let point = EdgePoint {
                    at_m: at,
                    length_m: piece,
                    outward: side.outward,
                    force_n: share * reaction * piece,
                    sliding_w: 0.0,
                };
                add(point, tilt_rad);
            }
        }
    }
}

/// Whether a disc about the origin lies on the face.
fn is_whole(face: &Face, sides: &[Side], radius_m: f64, crossings: &mut Vec<f64>) -> bool {
    let cut = sides.iter().any(|side| {
        let (near, half) = chord(side, radius_m);
        half > 0.0 && near + half > 0.0 && near - half < 1.0
    });
    let mut whole = false;
    face.row(sides, 0.0, radius_m, crossings, |from, to| {
        whole = from <= -radius_m && to >= radius_m;
    });
    whole && !cut
}

/// Nearest point to the origin and half the chord within a circle, as parts of the side's length.
fn chord(side: &Side, radius_m: f64) -> (f64, f64) {
    let along = side.to_m - side.from_m;
    let square = along.norm_squared();
    let near = -side.from_m.coords.dot(&along) / square;
    let distance = side.from_m.coords.dot(&side.outward);
    let half = ((radius_m * radius_m - distance * distance).max(0.0) / square).sqrt();
    (near, half)
}

/// Where `start + t step` lies within `±half`, as a range of t in `[0, 1]`; empty if nowhere.
fn within(start: f64, step: f64, half: f64) -> (f64, f64) {
    if step == 0.0 {
        return if start.abs() <= half {
            (0.0, 1.0)
        } else {
            (1.0, 0.0)
        };
    }
    let (a, b) = ((-half - start) / step, (half - start) / step);
    (a.min(b).max(0.0), a.max(b).min(1.0))
}
