//! B-spline surfaces of faces.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::super::{Domain, NurbsPatch, Surface as _};
use super::entities::{Model, get, list, numbers, reference};
use super::part21::{Entity, Fault, Value};
use super::shape::{Shape, inside};
use super::spline::{degree, repeated, spline_parts};

/// Steps of Newton's method.
const STEPS: usize = 40;

/// Reads a B-spline surface.
pub(super) fn read(model: &Model<'_>, entity: &Entity) -> Result<Shape, Fault> {
    let parts = spline_parts(entity, "B_SPLINE_SURFACE", 7);
    let Some((basic, knots, rational)) = parts else {
        return Err(entity.fault("a B-spline surface without its points"));
    };
    let degree = [degree(entity, basic, 0)?, degree(entity, basic, 1)?];
    let row = |value: &Value| -> Result<Vec<Vector3<f64>>, Fault> {
        let points = list(entity, value)?.iter();
        points
            .map(|value| model.point(reference(entity, value)?))
            .collect()
    };
    let rows = list(entity, get(entity, basic, 2)?)?.iter();
    let points: Vec<Vec<Vector3<f64>>> = rows.map(row).collect::<Result<_, _>>()?;
    let columns = points.first().map_or(0, Vec::len);
    let limits = [points.len() + degree[0] + 1, columns + degree[1] + 1];
    let all = |k: usize| {
        let (times, knots) = (get(entity, knots, k)?, get(entity, knots, k + 2)?);
        repeated(entity, times, knots, limits[k])
    };
    let all = [all(0)?, all(1)?];
    let weights = match rational {
        Some(values) => (list(entity, get(entity, values, 0)?)?.iter())
            .map(|row| numbers(entity, row))
            .collect::<Result<Vec<_>, _>>()?,
        None => points.iter().map(|row| vec![1.0; row.len()]).collect(),
    };
    let patch =
        NurbsPatch::new(degree, all, &points, &weights).map_err(|fault| entity.fault(fault))?;
    let Domain { u, v } = patch.domain();
    let size = points.iter().flatten().map(|p| (p - points[0][0]).norm());
    let size = size.fold(0.0, f64::max);
    let closes = |k: usize| {
        (0..=16).all(|i| {
            let share = f64::from(i) / 16.0;
            let (a, b) = match k {
                0 => {
                    let at = v[0] + share * (v[1] - v[0]);
                    (patch.point_m(u[0], at), patch.point_m(u[1], at))
                }
                _ => {
                    let at = u[0] + share * (u[1] - u[0]);
                    (patch.point_m(at, v[0]), patch.point_m(at, v[1]))
                }
            };
            (a - b).norm() <= 1e-6 * size
        })
    };
    let periods = [
        closes(0).then_some(u[1] - u[0]),
        closes(1).then_some(v[1] - v[0]),
    ];
    Ok(Shape::Spline {
        patch: Box::new(patch),
        periods,
    })
}

/// Newton's method from a place near by; if that does not reach the point, from the nearest of a
/// grid.
pub(super) fn place(
    patch: &NurbsPatch,
    p: &Vector3<f64>,
    near: Option<[f64; 2]>,
    periods: [Option<f64>; 2],
) -> [f64; 2] {
    let Domain { u, v } = patch.domain();
    let ranges = [u, v];
    let near = near.map(|uv| [0, 1].map(|k| inside((uv[k], ranges[k], periods[k]))));
    let off = |uv: &[f64; 2]| (patch.point_m(uv[0], uv[1]) - p).norm_squared();
    let mut best = near.map(|uv| newton(patch, p, uv, ranges));
    let is_met = |uv: &[f64; 2]| off(uv) < 1e-8;
    if !best.as_ref().is_some_and(is_met) {
        const GRID: usize = 24;
        let at = |k: usize, i: usize| {
            ranges[k][0] + (ranges[k][1] - ranges[k][0]) * i as f64 / GRID as f64
        };
        let grid = (0..=GRID).flat_map(|i| (0..=GRID).map(move |j| [at(0, i), at(1, j)]));
        let mut starts: Vec<(f64, [f64; 2])> = grid.map(|uv| (off(&uv), uv)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, start) in starts.iter().take(6) {
            let found = newton(patch, p, *start, ranges);
            if best.as_ref().is_none_or(|best| off(&found) < off(best)) {
                best = Some(found);
            }
            if best.as_ref().is_some_and(is_met) {
                break;
            }
        }
    }
    best.unwrap_or([u[0], v[0]])
}

fn newton(
    patch: &NurbsPatch,
    p: &Vector3<f64>,
    mut uv: [f64; 2],
    ranges: [[f64; 2]; 2],
) -> [f64; 2] {
    for _ in 0..STEPS {
        let jet = patch.jet(uv[0], uv[1]);
        let way = p - jet.point_m;
        let [ru, rv] = jet.first_m;
        let (e, f, g) = (ru.norm_squared(), ru.dot(&rv), rv.norm_squared());
        let small = 1e-12 * (e + g);
        let matrix = Matrix2::new(e + small, f, f, g + small);
        let right = Vector2::new(way.dot(&ru), way.dot(&rv));
        let Some(inverse) = matrix.try_inverse() else {
            break;
        };
        let step = inverse * right;
        let mut moved = 0.0_f64;
        for k in 0..2 {
            let [low, high] = ranges[k];
            let next = (uv[k] + step[k]).clamp(low, high);
            moved = moved.max((next - uv[k]).abs() / (high - low));
            uv[k] = next;
        }
        if moved < 1e-13 {
            break;
        }
    }
    uv
}
