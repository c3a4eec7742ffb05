//! Wheel and face at one instant, in the frame of the patch.

use super::SurfacePolishSetup;
use crate::process::ToolState;
use crate::process::belt::geometry::FaceGeometry;
use nalgebra::{Isometry2, Point3, Vector2, Vector3};
use truecut_core::wheel::curved::Curved;
use truecut_core::wheel::face::Face;
use truecut_core::wheel::force_control::Offset;
use truecut_core::wheel::patch::{Patch, Sliding};
use truecut_core::wheel::quadrature::Quadrature;

/// The patch in which the wheel touches. Its own frame: x along the face's first parameter, z the
/// normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct PolishTouch {
    pub uv: [f64; 2],
    pub axes: [Vector3<f64>; 2],
    pub first_m: [Vector3<f64>; 2],
    pub patch: Patch,
    pub sliding: Sliding,
}

/// Wheel and face at one instant.
#[derive(Debug, Clone, Default)]
pub(super) struct Touching {
    /// Place under the wheel's middle; none far from the face.
    pub uv: Option<[f64; 2]>,
    /// How far the undeformed wheel reaches in there; negative: how far it is off.
    pub indentation_m: f64,
    pub touch: Option<PolishTouch>,
    pub normal_n: f64,
    /// On the face, along its first parameter and across.
    pub friction_n: Vector2<f64>,
    /// `∫ p |v| dA`.
    pub sliding_w: f64,
    /// Where the spin axis leans, from the first parameter towards the second.
    pub lean_rad: f64,
    /// On the tool, in the patch's frame, about its point.
    pub force_n: Vector3<f64>,
    pub moment_n_m: Vector3<f64>,
}

/// The wheel's middle, and how it moves, in the frame of the patch.
struct Middle {
    tool_m: Point3<f64>,
    place_m: Point3<f64>,
    velocity_m_per_s: Vector3<f64>,
    /// Spin and turning of the tool.
    turning_rad_s: Vector3<f64>,
    /// The spin axis, away from the face.
    away: Vector3<f64>,
}

impl Middle {
    fn of(setup: &SurfacePolishSetup, state: &ToolState) -> Self {
        let patch_from_world = setup.world_from_patch.inverse();
        let turn = patch_from_world.rotation;
        let patch_from_tool = patch_from_world * state.world_from_tool;
        let away = -(patch_from_tool.rotation * Vector3::z());
        let velocity_in_world = setup.process_from_world.inverse() * state.tool.velocity_m_per_s;
        let tool_m = Point3::from(patch_from_tool.translation.vector);
        let mut middle = Self {
            tool_m,
            place_m: tool_m,
            velocity_m_per_s: turn * velocity_in_world,
            turning_rad_s: away * setup.spin_rad_s + turn * state.tool_turning_rad_s,
            away,
        };
        let [x, y] = setup.eccentricity_m;
        if [x, y] != [0.0; 2] {
            // The tool's z axis points towards the face: a positive spin turns from its y axis to
            // its x axis.
            let (sine, cosine) = (-setup.spin_rad_s * state.time_s).sin_cos();
            let place = Vector3::new(x * cosine - y * sine, x * sine + y * cosine, 0.0);
            let rate = Vector3::new(place.y, -place.x, 0.0) * setup.spin_rad_s;
            middle.place_m += patch_from_tool.rotation * place;
            middle.velocity_m_per_s += patch_from_tool.rotation * rate;
        }
        middle
    }
}

impl Touching {
    /// `seed` are the parameters under the wheel's middle a little before; without it the face's
    /// samples are searched.
    pub fn of(
        setup: &SurfacePolishSetup,
        (face, quadrature): (&FaceGeometry, &Quadrature),
        seed: Option<[f64; 2]>,
        state: &ToolState,
        carrier: &Offset,
    ) -> Self {
        let radius_m = setup.wheel.radius_m;
        let middle = Middle::of(setup, state);
        let reach_m = radius_m + carrier.offset_m.max(0.0);
        let near = seed.or_else(|| face.near(&middle.place_m, reach_m));
        let Some(foot) = near.and_then(|near| face.foot(&middle.place_m, near)) else {
            return Self::default();
        };
        let normal = foot.normal.into_inner();
        let x = foot.first_m[0].normalize();
        let y = normal.cross(&x);
        let height_m = foot.height_m - carrier.offset_m;
        let indentation_m = radius_m - height_m;
        let off_face = Self {
            uv: Some(foot.uv),
            indentation_m,
            lean_rad: middle.away.dot(&y).atan2(middle.away.dot(&x)),
            ..Self::default()
        };
        let curved = Curved::new(radius_m, foot.curvatures_per_m);
        let Some(curved) = curved.filter(|_| indentation_m > 0.0) else {
            return off_face;
        };
        let patch =
            (curved.wheel(&setup.wheel)).patch(&setup.shell, curved.indentation_m(indentation_m));
        let (velocity, turning) = (middle.velocity_m_per_s, middle.turning_rad_s);
        let at_contact = velocity - turning.cross(&(normal * height_m));
        let approach = carrier.rate_now_m_per_s() - velocity.dot(&normal);
        let sliding = Sliding {
            velocity_m_per_s: Vector2::new(at_contact.dot(&x), at_contact.dot(&y)),
            spin_rad_s: turning.dot(&normal),
            approach_m_per_s: curved.indentation_m(approach),
            mu: setup.abrasive.mu,
        };
        let whole = (Face::unbounded(), Isometry2::identity());
        let loads = patch.loads(&whole.0, &whole.1, &sliding, quadrature, |_| {});
        let in_patch = |along: f64, across: f64, out: f64| x * along + y * across + normal * out;
        let (friction, first) = (loads.friction_n, loads.first_moment_n_m);
        let carried_n = setup.control.carried_n(carrier, loads.normal_n);
        let force_n = in_patch(-friction.x, -friction.y, carried_n);
        let lever_m = foot.point_m - middle.tool_m;
        Self {
            touch: Some(PolishTouch {
                uv: foot.uv,
                axes: [x, y],
                first_m: foot.first_m,
                patch,
                sliding,
            }),
            normal_n: loads.normal_n,
            friction_n: friction,
            sliding_w: loads.sliding_w,
            force_n,
            moment_n_m: in_patch(first.y, -first.x, -loads.spin_moment_n_m)
                + lever_m.cross(&force_n),
            ..off_face
        }
    }
}
