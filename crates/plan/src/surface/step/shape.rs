//! Surfaces of faces: points at parameters, and parameters of points.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Vector2, Vector3};

use super::super::{Domain, NurbsPatch, Surface as _};
use super::curve::Curve;
use super::entities::{Frame, Model, get, number, reference};
use super::part21::Fault;
use super::patch;

/// A surface, mm.
#[derive(Debug, Clone)]
pub(super) enum Shape {
    Plane(Frame),
    Cylinder {
        frame: Frame,
        radius: f64,
    },
    /// `slope`: what the radius grows by with z.
    Cone {
        frame: Frame,
        radius: f64,
        slope: f64,
    },
    Sphere {
        frame: Frame,
        radius: f64,
    },
    Torus {
        frame: Frame,
        radii: [f64; 2],
    },
    Spline {
        patch: Box<NurbsPatch>,
        periods: [Option<f64>; 2],
    },
    Extruded {
        curve: Curve,
        way: Vector3<f64>,
    },
    Revolved {
        curve: Curve,
        frame: Frame,
    },
    /// A surface moved along its normal.
    Offset {
        of: Box<Self>,
        by: f64,
    },
}

/// Names of the surfaces that are read.
const KNOWN: [&str; 9] = [
    "PLANE",
    "CYLINDRICAL_SURFACE",
    "CONICAL_SURFACE",
    "SPHERICAL_SURFACE",
    "TOROIDAL_SURFACE",
    "B_SPLINE_SURFACE_WITH_KNOTS",
    "SURFACE_OF_LINEAR_EXTRUSION",
    "SURFACE_OF_REVOLUTION",
    "OFFSET_SURFACE",
];
/// Surfaces moved from moved ones that are followed.
const DEEPEST: usize = 4;
/// Step of differences, rad or mm.
const STEP: f64 = 1e-5;

impl Shape {
    pub(super) fn read(model: &Model<'_>, number_of: u64) -> Result<Self, Fault> {
        Self::read_at(model, number_of, 0)
    }

    fn read_at(model: &Model<'_>, number_of: u64, depth: usize) -> Result<Self, Fault> {
        let entity = model.file.entity(number_of)?;
        let found = KNOWN
            .iter()
            .find_map(|name| Some((*name, entity.part(name)?)));
        let Some((name, values)) = found else {
            return Err(entity.fault(format_args!(
                "surfaces of this kind are not read; {} are",
                KNOWN.join(", ")
            )));
        };
        if name == "B_SPLINE_SURFACE_WITH_KNOTS" {
            return patch::read(model, &entity);
        }
        let second = reference(&entity, get(&entity, values, 1)?)?;
        let length = |k: usize| {
            let value = number(&entity, get(&entity, values, k)?)? * model.unit_mm;
            match value.is_finite() && value > 0.0 {
                true => Ok(value),
                false => Err(entity.fault("its radius must be above 0")),
            }
        };
        Ok(match name {
            "PLANE" => Self::Plane(model.frame(second)?),
            "CYLINDRICAL_SURFACE" => Self::Cylinder {
                frame: model.frame(second)?,
                radius: length(2)?,
            },
            "CONICAL_SURFACE" => {
                let angle = number(&entity, get(&entity, values, 3)?)? * model.unit_rad;
                let radius = number(&entity, get(&entity, values, 2)?)? * model.unit_mm;
                if radius < 0.0 || angle.abs() >= FRAC_PI_2 {
                    return Err(entity.fault(
                        "its radius must not be below 0, its half angle below a right one",
                    ));
                }
                Self::Cone {
                    frame: model.frame(second)?,
                    radius,
                    slope: angle.tan(),
                }
            }
            "SPHERICAL_SURFACE" => Self::Sphere {
                frame: model.frame(second)?,
                radius: length(2)?,
            },
            "TOROIDAL_SURFACE" => {
                let radii = [length(2)?, length(3)?];
                if radii[1] >= radii[0] {
                    return Err(entity.fault("a torus that meets itself is not read"));
                }
                let frame = model.frame(second)?;
                Self::Torus { frame, radii }
            }
            "OFFSET_SURFACE" if depth >= DEEPEST => {
                return Err(entity.fault("a surface moved from one that is moved, and so on"));
            }
            "OFFSET_SURFACE" => Self::Offset {
                of: Box::new(Self::read_at(model, second, depth + 1)?),
                by: number(&entity, get(&entity, values, 2)?)? * model.unit_mm,
            },
            "SURFACE_OF_LINEAR_EXTRUSION" => {
                let vector = model.follow(&entity, get(&entity, values, 2)?)?;
                let inner = model.simple(&vector, "VECTOR")?;
                let way = model.direction(reference(&vector, get(&vector, inner, 1)?)?)?;
                let curve = Curve::read(model, second)?;
                Self::Extruded { curve, way }
            }
            _ => {
                let frame = model.frame(reference(&entity, get(&entity, values, 2)?)?)?;
                let curve = Curve::read(model, second)?;
                Self::Revolved { curve, frame }
            }
        })
    }

    /// After how much of either parameter it comes back to where it was.
    pub(super) fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Plane(_) => [None, None],
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => [Some(TAU), None],
            Self::Torus { .. } => [Some(TAU), Some(TAU)],
            Self::Spline { periods, .. } => *periods,
            Self::Extruded { curve, .. } => [curve.period(), None],
            Self::Revolved { curve, .. } => [Some(TAU), curve.period()],
            Self::Offset { of, .. } => of.periods(),
        }
    }

    pub(super) fn at(&self, [u, v]: [f64; 2]) -> Vector3<f64> {
        let round =
            |frame: &Frame, radius: f64, z: f64| frame.at(radius * u.cos(), radius * u.sin(), z);
        match self {
            Self::Plane(frame) => frame.at(u, v, 0.0),
            Self::Cylinder { frame, radius } => round(frame, *radius, v),
            Self::Cone {
                frame,
                radius,
                slope,
            } => round(frame, radius + v * slope, v),
            Self::Sphere { frame, radius } => round(frame, radius * v.cos(), radius * v.sin()),
            Self::Torus { frame, radii } => {
                round(frame, radii[0] + radii[1] * v.cos(), radii[1] * v.sin())
            }
            Self::Spline { patch, periods } => {
                let Domain { u: us, v: vs } = patch.domain();
                let [u, v] = [(u, us, periods[0]), (v, vs, periods[1])].map(inside);
                patch.point_m(u, v)
            }
            Self::Extruded { curve, way } => curve.at(along(curve, u)) + way * v,
            Self::Revolved { curve, frame } => {
                let p = frame.local(&curve.at(along(curve, v)));
                let (sin, cos) = u.sin_cos();
                frame.at(p.x * cos - p.y * sin, p.x * sin + p.y * cos, p.z)
            }
            Self::Offset { of, by } => of.at([u, v]) + of.normal([u, v]) * *by,
        }
    }

    /// Of length 1, or zero where there is none.
    fn normal(&self, [u, v]: [f64; 2]) -> Vector3<f64> {
        let [along_u, along_v] = match self {
            Self::Spline { patch, periods } => {
                let Domain { u: us, v: vs } = patch.domain();
                let [u, v] = [(u, us, periods[0]), (v, vs, periods[1])].map(inside);
                patch.jet(u, v).first_m
            }
            _ => [
                self.at([u + STEP, v]) - self.at([u - STEP, v]),
                self.at([u, v + STEP]) - self.at([u, v - STEP]),
            ],
        };
        along_u
            .cross(&along_v)
            .try_normalize(0.0)
            .unwrap_or_default()
    }

    /// The parameter that is any at a point, as a surface meets its axis there, or a side of its
    /// patch is drawn together.
    pub(super) fn pole(&self, point: &Vector3<f64>, uv: [f64; 2], within: f64) -> Option<usize> {
        match self {
            Self::Cone { frame, .. }
            | Self::Sphere { frame, .. }
            | Self::Revolved { frame, .. } => (frame_radius(frame, point) <= within).then_some(0),
            Self::Spline { patch, .. } => {
                let Domain { u, v } = patch.domain();
                let spans = [u[1] - u[0], v[1] - v[0]];
                let [u, v] = [(uv[0], u), (uv[1], v)].map(|(t, [low, high])| t.clamp(low, high));
                let jet = patch.jet(u, v);
                (0..2).find(|k| jet.first_m[*k].norm() * spans[*k] <= within)
            }
            Self::Offset { of, .. } => of.pole(point, uv, within),
            _ => None,
        }
    }

    /// Parameters of a point on it; near those of a point before where there are several.
    pub(super) fn place(&self, p: &Vector3<f64>, near: Option<[f64; 2]>, size: f64) -> [f64; 2] {
        match self {
            Self::Plane(frame) => {
                let local = frame.local(p);
                [local.x, local.y]
            }
            Self::Cylinder { frame, .. } => {
                let local = frame.local(p);
                [local.y.atan2(local.x), local.z]
            }
            Self::Cone {
                frame,
                radius,
                slope,
            } => {
                let local = frame.local(p);
                let is_beyond = radius + local.z * slope < 0.0;
                let sign = if is_beyond { -1.0 } else { 1.0 };
                [(sign * local.y).atan2(sign * local.x), local.z]
            }
            Self::Sphere { frame, .. } => {
                let local = frame.local(p);
                [local.y.atan2(local.x), local.z.atan2(local.xy().norm())]
            }
            Self::Torus { frame, radii } => {
                let local = frame.local(p);
                let out = local.xy().norm() - radii[0];
                [local.y.atan2(local.x), local.z.atan2(out)]
            }
            Self::Spline { patch, periods } => patch::place(patch, p, near, *periods),
            Self::Extruded { curve, way } => {
                let across = |q: &Vector3<f64>| {
                    let off = q - p;
                    (off - way * off.dot(way)).norm_squared()
                };
                let u = curve.least(size, near.map(|uv| uv[0]), &across);
                [u, (p - curve.at(u)).dot(way)]
            }
            Self::Revolved { curve, frame } => {
                let flat = |q: &Vector3<f64>| {
                    let local = frame.local(q);
                    Vector2::new(local.xy().norm(), local.z)
                };
                let wanted = flat(p);
                let near = near.map(|uv| uv[1]);
                let v = curve.least(size, near, &|q| (flat(q) - wanted).norm_squared());
                let angle = |q: &Vector3<f64>| {
                    let local = frame.local(q);
                    local.y.atan2(local.x)
                };
                [angle(p) - angle(&curve.at(v)), v]
            }
            // The nearest point of a surface lies along its normal.
            Self::Offset { of, .. } => of.place(p, near, size),
        }
    }

    /// What a face of it is called.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Plane(_) => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::Spline { .. } => "B-spline",
            Self::Extruded { .. } => "extrusion",
            Self::Revolved { .. } => "revolution",
            Self::Offset { .. } => "offset surface",
        }
    }

    /// The whole of a surface that is closed in both directions.
    pub(super) fn whole(&self) -> Option<[[f64; 2]; 2]> {
        match self {
            Self::Sphere { .. } => Some([[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]]),
            Self::Torus { .. } => Some([[0.0, TAU], [0.0, TAU]]),
            _ => None,
        }
    }

    /// Second parameters at which it meets its axis.
    pub(super) fn poles(&self) -> Vec<f64> {
        match self {
            Self::Sphere { .. } => vec![-FRAC_PI_2, FRAC_PI_2],
            Self::Cone { radius, slope, .. } if *slope != 0.0 => vec![-radius / slope],
            Self::Revolved { curve, frame } => (curve.range().into_iter().flatten())
                .filter(|t| frame_radius(frame, &curve.at(*t)) < 1e-6)
                .collect(),
            _ => Vec::new(),
        }
    }
}

fn frame_radius(frame: &Frame, point: &Vector3<f64>) -> f64 {
    frame.local(point).xy().norm()
}

/// A parameter within its range, from which it may be away by turns.
pub(super) fn inside((t, [low, high], period): (f64, [f64; 2], Option<f64>)) -> f64 {
    match period {
        Some(period) if t < low || t > high => low + (t - low).rem_euclid(period),
        _ => t.clamp(low, high),
    }
}

fn along(curve: &Curve, t: f64) -> f64 {
    match (curve.range(), curve.period()) {
        (Some(range), period) => inside((t, range, period)),
        (None, _) => t,
    }
}
