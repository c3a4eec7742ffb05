//! Wheel and face at one instant: narrow line patches side by side along the wheel's axis.
//!
//! A straight wheel does not touch a curved face over its whole width. It is cut into strips, each
//! a line patch of its own with the indentation and the curvature of its section; they are as wide
//! on the face as the face leans along the axis. A strip's force stands along the normal of the
//! face, so that the sum is the derivative of the strips' energies: no work is gained on a closed
//! way. Strips do not hold one another: the rubber's stiffness along the axis is left out.

use super::geometry::{FaceGeometry, Section};
use super::{BeltSetup, RULES};
use crate::process::ToolState;
use nalgebra::{Isometry2, Isometry3, Point2, Point3, Vector2, Vector3};
use truecut_core::wheel::belt::BeltWheel;
use truecut_core::wheel::face::Face;
use truecut_core::wheel::force_control::Offset;
use truecut_core::wheel::patch::{EdgePoint, Patch, PatchLoads, Sliding};

/// Strips of a wheel.
pub(super) const STRIPS: usize = 9;
const MIDDLE: usize = STRIPS / 2;
/// Largest relative radius of wheel and section, wheel radii: where a section is as hollow as the
/// wheel is round, or more, the patch would have no end. The planner refuses lines there.
const LARGEST_RELATIVE_RADIUS: f64 = 100.0;

/// What a strip may overhang by as if it did not, of its size.
const FLUSH: f64 = 1e-9;

/// A strip that touches, in the patch's frame. Its own frame: x across the wheel's axis, y along
/// it, z the normal of the face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    /// Which one of [`STRIPS`].
    pub index: usize,
    pub uv: [f64; 2],
    pub point_m: Point3<f64>,
    pub x: Vector3<f64>,
    pub y: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub first_m: [Vector3<f64>; 2],
    /// Half of its width on the face.
    pub half_width_m: f64,
    /// How far the undeformed wheel reaches in.
    pub indentation_m: f64,
    pub patch: Patch,
    pub sliding: Sliding,
    pub loads: PatchLoads,
}

/// Motion of the wheel in the patch's frame, its axes those of the tool.
pub(super) struct Motion {
    pub patch_from_wheel: Isometry3<f64>,
    pub velocity_m_per_s: Vector3<f64>,
    pub turning_rad_s: Vector3<f64>,
}

/// Wheel and face at one instant.
#[derive(Debug, Clone, Default)]
pub(super) struct BeltContact {
    /// Which copy of the face.
    pub copy: usize,
    pub strips: Vec<Strip>,
    /// Nearest point under the wheel's middle, and how far the undeformed wheel reaches in there
    /// (negative: how far it is off); none far from the face.
    pub middle: Option<([f64; 2], f64)>,
    pub normal_n: f64,
    pub edge_n: f64,
    /// Friction on the face along x and y of the tool.
    pub friction_n: Vector2<f64>,
    /// `∫ p |v| dA`.
    pub sliding_w: f64,
    /// Width over which the wheel touches.
    pub width_m: f64,
    /// The tool's z axis in the patch's frame.
    pub forward: Vector3<f64>,
    /// On the wheel, in the patch's frame, about its centre.
    pub force_n: Vector3<f64>,
    pub moment_n_m: Vector3<f64>,
}

impl BeltContact {
    /// `seed` is a copy and the parameters under the wheel's middle a little before; without it the
    /// face's samples are searched. `edges` is given the reactions along borders of the face, with
    /// the strip that they belong to.
    pub fn of(
        setup: &BeltSetup,
        face: &FaceGeometry,
        seed: Option<(usize, [f64; 2])>,
        state: &ToolState,
        carrier: &Offset,
        mut edges: impl FnMut(&Strip, &EdgePoint),
    ) -> Self {
        let copy = setup.copy_at(state.time_s);
        let motion = setup.motion(copy, state, carrier);
        let mut contact = Self::none(copy, motion.patch_from_wheel.rotation * Vector3::z());
        let axis = motion.patch_from_wheel.rotation * Vector3::y();
        let tool_x = motion.patch_from_wheel.rotation * Vector3::x();
        let centre = Point3::from(motion.patch_from_wheel.translation.vector);
        let wheel = &setup.wheel;
        let spin = setup.wheel_rad_s();
        let [offset_m, offset_rate_m_per_s] = setup.eccentricity.at(spin * state.time_s, spin);
        let radius_m = wheel.radius_m + offset_m;
        let reach_m = radius_m.hypot(0.5 * wheel.width_m);
        let seed = seed.filter(|seed| seed.0 == copy).map(|seed| seed.1);
        let Some(near) = seed.or_else(|| face.near(&centre, reach_m)) else {
            return contact;
        };
        let sections = sections(face, &centre, &axis, wheel.width_m, near, reach_m);
        contact.middle = sections[MIDDLE].map(|found| (found.uv, radius_m - found.distance_m));
        let press = Press {
            setup,
            face,
            motion: &motion,
            axis,
            radius_m,
            offset_rate_m_per_s,
        };
        for (index, section) in sections.iter().enumerate() {
            let Some(section) = section else { continue };
            if let Some(strip) = press.strip(index, section, &mut edges) {
                contact.add(&strip, &motion, &tool_x, &axis, wheel.width_m);
            }
        }
        contact
    }

    /// Force that pushes the wheel back along the tool's z axis.
    pub fn pushed_n(&self) -> f64 {
        -self.force_n.dot(&self.forward)
    }

    fn none(copy: usize, forward: Vector3<f64>) -> Self {
        Self {
            copy,
            forward,
            strips: Vec::with_capacity(STRIPS),
            ..Self::default()
        }
    }

    fn add(
        &mut self,
        strip: &Strip,
        motion: &Motion,
        tool_x: &Vector3<f64>,
        axis: &Vector3<f64>,
        width_m: f64,
    ) {
        let loads = &strip.loads;
        let friction = strip.x * loads.friction_n.x + strip.y * loads.friction_n.y;
        let force_n = strip.normal * loads.normal_n - friction;
        let first = loads.first_moment_n_m;
        let about_point =
            strip.x * first.y - strip.y * first.x - strip.normal * loads.spin_moment_n_m;
        let lever = strip.point_m.coords - motion.patch_from_wheel.translation.vector;
        self.force_n += force_n;
        self.moment_n_m += about_point + lever.cross(&force_n);
        self.normal_n += loads.normal_n;
        self.edge_n += loads.edge_n;
        self.friction_n += Vector2::new(friction.dot(tool_x), friction.dot(axis));
        self.sliding_w += loads.sliding_w;
        self.width_m += width_m / STRIPS as f64;
        self.strips.push(*strip);
    }
}

/// Where the strips' sections are nearest to the face, from the middle outwards, each sought where
/// the ones before point to; failing that anew among the face's samples.
fn sections(
    face: &FaceGeometry,
    centre: &Point3<f64>,
    axis: &Vector3<f64>,
    width_m: f64,
    near: [f64; 2],
    reach_m: f64,
) -> [Option<Section>; STRIPS] {
    let strip_m = width_m / STRIPS as f64;
    let mut found = [None::<Section>; STRIPS];
    found[MIDDLE] = face.section(centre, axis, near);
    for side in [1, -1] {
        let (mut seed, mut before) = (near, None);
        if let Some(section) = &found[MIDDLE] {
            seed = section.moved_uv(&(axis * (f64::from(side) * strip_m)));
            before = Some(section.uv);
        }
        for off in 1..=MIDDLE as i32 {
            let place = centre + axis * (f64::from(side * off) * strip_m);
            let section = (face.section(&place, axis, seed))
                .or_else(|| face.section(&place, axis, face.near(&place, reach_m)?));
            if let Some(section) = &section {
                let uv = section.uv;
                seed = before.map_or(uv, |before| [0, 1].map(|i| 2.0 * uv[i] - before[i]));
                before = Some(uv);
            }
            found[(MIDDLE as i32 + side * off) as usize] = section;
        }
    }
    found
}

/// What a strip's loads are made from.
struct Press<'a> {
    setup: &'a BeltSetup,
    face: &'a FaceGeometry,
    motion: &'a Motion,
    axis: Vector3<f64>,
    /// With the radius offset of this instant.
    radius_m: f64,
    offset_rate_m_per_s: f64,
}

impl Press<'_> {
    /// The strip at a section; none where it does not press.
    fn strip(
        &self,
        index: usize,
        section: &Section,
        edges: &mut impl FnMut(&Strip, &EdgePoint),
    ) -> Option<Strip> {
        let wheel = &self.setup.wheel;
        let indentation_m = self.radius_m - section.distance_m;
        if indentation_m <= 0.0 {
            return None;
        }
        let normal = section.normal.into_inner();
        let x = self.axis.cross(&normal).normalize();
        let y = normal.cross(&x);
        if !self.face.is_within(section, &x, &y) {
            return None;
        }
        let lean = normal.dot(&section.to_axis);
        let half_width_m = 0.5 * wheel.width_m / STRIPS as f64 / lean;
        let largest_m = LARGEST_RELATIVE_RADIUS * wheel.radius_m;
        let radius_m = (wheel.relative_radius_m(section.curvature_per_m))
            .map_or(largest_m, |radius_m| radius_m.min(largest_m));
        let narrow = BeltWheel {
            width_m: 2.0 * half_width_m,
            // The same tension per width.
            tension_n: wheel.tension_n * 2.0 * half_width_m / wheel.width_m,
            ..*wheel
        };
        let mut strip = Strip {
            index,
            uv: section.uv,
            point_m: section.point_m,
            x,
            y,
            normal,
            first_m: section.first_m,
            half_width_m,
            indentation_m,
            patch: narrow.patch(&self.setup.layer, indentation_m, radius_m),
            sliding: self.sliding(section, &x, &y, lean),
            loads: PatchLoads::default(),
        };
        let borders = self.borders(&strip)?;
        let reported = strip;
        strip.loads = strip.patch.loads(
            &borders,
            &Isometry2::identity(),
            &strip.sliding,
            &RULES,
            |point| edges(&reported, &point),
        );
        Some(strip)
    }

    /// Motion of the belt over the face: it runs along the tool's x axis, against x of the strip,
    /// and goes with the tool.
    fn sliding(&self, section: &Section, x: &Vector3<f64>, y: &Vector3<f64>, lean: f64) -> Sliding {
        let motion = self.motion;
        let lever = section.point_m.coords - motion.patch_from_wheel.translation.vector;
        let velocity = motion.velocity_m_per_s + motion.turning_rad_s.cross(&lever);
        let normal = section.normal.into_inner();
        Sliding {
            velocity_m_per_s: Vector2::new(
                velocity.dot(x) - self.setup.belt_m_per_s,
                velocity.dot(y),
            ),
            spin_rad_s: motion.turning_rad_s.dot(&normal),
            approach_m_per_s: self.offset_rate_m_per_s - velocity.dot(&normal) / lean,
            mu: self.setup.abrasive.mu,
        }
    }

    /// The face's borders as the strip sees them, parameters straightened out about its nearest
    /// point: without borders if none is in reach, `None` if the strip is beyond one.
    fn borders(&self, strip: &Strip) -> Option<Face> {
        let domain = self.face.domain();
        let window_m = strip.patch.window_m();
        let [ru, rv] = strip.first_m;
        let area = ru.cross(&rv).norm();
        let ([u, v], [to_u, to_v]) = (strip.uv, [area / rv.norm(), area / ru.norm()]);
        // How far the window reaches towards borders along `border`.
        let reach_m = |border: &Vector3<f64>| {
            let square = strip.normal.cross(border) / border.norm();
            window_m.x * square.dot(&strip.x).abs() + window_m.y * square.dot(&strip.y).abs()
        };
        let (reach_u_m, reach_v_m) = (reach_m(&rv), reach_m(&ru));
        let clear_m = [
            (u - domain.u[0]) * to_u - reach_u_m,
            (domain.u[1] - u) * to_u - reach_u_m,
            (v - domain.v[0]) * to_v - reach_v_m,
            (domain.v[1] - v) * to_v - reach_v_m,
        ];
        // A wheel that moves flush with a border is within it, whatever rounding says.
        let flush_m = FLUSH * window_m.norm();
        if clear_m.into_iter().all(|clear_m| clear_m >= -flush_m) {
            return Some(Face::unbounded());
        }
        let beyond_m = [-2.0 * reach_u_m, -2.0 * reach_v_m];
        if (0..4).any(|side| clear_m[side] <= beyond_m[side / 2]) {
            return None;
        }
        let corner = |u_end: f64, v_end: f64| {
            let way = ru * (u_end - u) + rv * (v_end - v);
            Point2::new(way.dot(&strip.x), way.dot(&strip.y))
        };
        let ([u0, u1], [v0, v1]) = (domain.u, domain.v);
        let corners = vec![
            corner(u0, v0),
            corner(u1, v0),
            corner(u1, v1),
            corner(u0, v1),
        ];
        Face::new(&[corners]).ok()
    }
}
