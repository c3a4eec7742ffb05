//! The lines around a face in the parameters of its surface.
//!
//! On a surface that comes back to where it was, a line is followed by the shortest way, so that a
//! seam is met twice, a turn apart. Lines that go round such a surface are joined: two of them by a
//! cut, one with a pole.

use nalgebra::Vector3;

use super::shape::Shape;

/// A corner: its vertex, and its parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    pub(super) uv: [f64; 2],
    /// The second of two places of a pole: what follows may be turned.
    after_pole: bool,
}

/// A closed line, the first corner not repeated.
pub(super) type Line = Vec<Corner>;

/// A line that has gone round in one of the parameters, by how much.
struct Round {
    line: Line,
    direction: usize,
    by: f64,
}

/// What is wrong with the lines of a face.
pub(super) enum Off {
    /// An edge lies off the surface, by mm.
    Edge(f64),
    /// Lines go round so that they bound nothing.
    Round,
}

/// Lays lines out. `vertices` are all of the part, `size` its diagonal, `is_along` whether the face
/// looks where its surface does.
pub(super) fn laid(
    shape: &Shape,
    lines: &[Vec<u32>],
    vertices: &mut Vec<Vector3<f64>>,
    size: f64,
    is_along: bool,
) -> Result<Vec<Line>, Off> {
    let mut closed = Vec::new();
    let mut rounds = Vec::new();
    for line in lines {
        match followed(shape, line, vertices, size, is_along)? {
            (line, None) => closed.push(line),
            (line, Some((direction, by))) => rounds.push(Round {
                line,
                direction,
                by,
            }),
        }
    }
    match (rounds.len(), lines.len()) {
        (0, 0) => closed.push(whole(shape, vertices).ok_or(Off::Round)?),
        (0, _) => {}
        (1, _) => {
            let round = rounds.remove(0);
            closed.push(to_pole(shape, round, vertices, is_along).ok_or(Off::Round)?);
        }
        (2, _) => {
            let (second, first) = (rounds.remove(1), rounds.remove(0));
            closed.push(joined(first, second).ok_or(Off::Round)?);
        }
        _ => return Err(Off::Round),
    }
    gathered(shape, &mut closed);
    Ok(closed)
}

fn followed(
    shape: &Shape,
    line: &[u32],
    vertices: &[Vector3<f64>],
    size: f64,
    is_along: bool,
) -> Result<(Line, Option<(usize, f64)>), Off> {
    let periods = shape.periods();
    let within = 1e-7 * size;
    let point = |k: usize| vertices[line[k % line.len()] as usize];
    // A line begins where both parameters are known.
    let first = (0..line.len()).find(|k| {
        let uv = shape.place(&point(*k), None, size);
        shape.pole(&point(*k), uv, within).is_none()
    });
    let first = first.ok_or(Off::Round)?;
    let mut corners: Line = Vec::with_capacity(line.len() + 2);
    let mut before: Option<[f64; 2]> = None;
    // A pole whose place on the way on is not known yet.
    let mut waits: Option<(u32, [f64; 2], usize)> = None;
    let mut closing = [0.0; 2];
    for k in first..=first + line.len() {
        let (vertex, p) = (line[k % line.len()], point(k));
        let mut uv = shape.place(&p, before, size);
        let off = (shape.at(uv) - p).norm();
        if off > 1e-3 * size {
            return Err(Off::Edge(off));
        }
        if let Some(before) = before {
            for k in 0..2 {
                if let Some(period) = periods[k] {
                    uv[k] += ((before[k] - uv[k]) / period).round() * period;
                }
            }
        }
        let pole = shape.pole(&p, uv, within);
        if let Some((vertex, mut at, direction)) = waits.take() {
            at[direction] = uv[direction];
            let after_pole = true;
            corners.push(Corner {
                vertex,
                uv: at,
                after_pole,
            });
        }
        if let (Some(direction), Some(before)) = (pole, before) {
            uv[direction] = before[direction];
            waits = Some((vertex, uv, direction));
        }
        if k == first + line.len() {
            closing = uv;
            break;
        }
        before = Some(uv);
        let after_pole = false;
        corners.push(Corner {
            vertex,
            uv,
            after_pole,
        });
    }
    let start = corners[0].uv;
    for k in 0..2 {
        let by = closing[k] - start[k];
        let Some(period) = periods[k].filter(|period| by.abs() > 0.5 * period) else {
            continue;
        };
        let by = (by / period).round() * period;
        // A pole takes it back: there the parameter is any.
        let Some(pole) = corners.iter().position(|corner| corner.after_pole) else {
            return Ok((corners, Some((k, by))));
        };
        corners[pole..].iter_mut().for_each(|c| c.uv[k] -= by);
    }
    turned_at_poles(&mut corners, periods[0], is_along);
    Ok((corners, None))
}

/// Between two poles a line may go round either way: that way round on which the face lies.
fn turned_at_poles(corners: &mut [Corner], period: Option<f64>, is_along: bool) {
    let poles: Vec<usize> = (0..corners.len())
        .filter(|k| corners[*k].after_pole)
        .collect();
    let ([one, other], Some(period)) = (poles.as_slice(), period) else {
        return;
    };
    let sign = if is_along { 1.0 } else { -1.0 };
    let small = 1e-6 * period;
    for by in [0.0, period, -2.0 * period] {
        corners[*one..*other].iter_mut().for_each(|c| c.uv[0] += by);
        if sign * area(corners) > small {
            return;
        }
    }
}

pub(super) fn area(line: &[Corner]) -> f64 {
    let next = line.iter().cycle().skip(1);
    let twice: f64 = (line.iter().zip(next))
        .map(|(a, b)| {
            let from = line[0].uv;
            let [x, y] = [a.uv[0] - from[0], a.uv[1] - from[1]];
            x * (b.uv[1] - from[1]) - y * (b.uv[0] - from[0])
        })
        .sum();
    0.5 * twice
}

/// Two lines that go round against each other, with a cut from one to the other.
fn joined(first: Round, second: Round) -> Option<Line> {
    let (k, by) = (first.direction, first.by);
    if second.direction != k || (second.by + by).abs() > 1e-6 * by.abs() {
        return None;
    }
    let start = first.line[0].uv[k] + by;
    let away = |corner: &Corner| {
        let off = (corner.uv[k] - start) / by;
        (off - off.round()).abs()
    };
    let nearest = (0..second.line.len())
        .min_by(|a, b| away(&second.line[*a]).total_cmp(&away(&second.line[*b])))?;
    let count = second.line.len();
    let mut other: Line = (0..count)
        .map(|i| {
            let mut corner = second.line[(nearest + i) % count];
            if nearest + i >= count {
                corner.uv[k] += second.by;
            }
            corner
        })
        .collect();
    let turns = ((start - other[0].uv[k]) / by).round() * by;
    other.iter_mut().for_each(|corner| corner.uv[k] += turns);
    let again = |corner: &Corner, by: f64| {
        let mut corner = *corner;
        corner.uv[k] += by;
        corner
    };
    let mut line = first.line;
    line.push(again(&line[0], by));
    let back = again(&other[0], -by);
    line.extend(other);
    line.push(back);
    Some(line)
}

/// One line that goes round, and the pole on the side of the face.
fn to_pole(
    shape: &Shape,
    round: Round,
    vertices: &mut Vec<Vector3<f64>>,
    is_along: bool,
) -> Option<Line> {
    if round.direction != 0 {
        return None;
    }
    let is_above = (round.by > 0.0) == is_along;
    let mean = round.line.iter().map(|c| c.uv[1]).sum::<f64>() / round.line.len() as f64;
    let poles = shape.poles();
    let pole = poles.into_iter().find(|v| (*v > mean) == is_above)?;
    let mut line = round.line;
    let start = line[0];
    let vertex = vertices.len() as u32;
    vertices.push(shape.at([start.uv[0], pole]));
    let corner = |vertex: u32, uv: [f64; 2]| Corner {
        vertex,
        uv,
        after_pole: false,
    };
    let far = start.uv[0] + round.by;
    line.push(corner(start.vertex, [far, start.uv[1]]));
    line.push(corner(vertex, [far, pole]));
    line.push(corner(vertex, [start.uv[0], pole]));
    Some(line)
}

/// The outline of a surface that is a whole body.
fn whole(shape: &Shape, vertices: &mut Vec<Vector3<f64>>) -> Option<Line> {
    const STEPS: usize = 72;
    let [us, vs] = shape.whole()?;
    let is_ball = matches!(shape, Shape::Sphere { .. });
    let mut add = |uv: [f64; 2]| {
        vertices.push(shape.at(uv));
        vertices.len() as u32 - 1
    };
    let at =
        |range: [f64; 2], k: usize| range[0] + (range[1] - range[0]) * (k as f64 / STEPS as f64);
    // Vertices of the seam along v, and of the one along u, which a ball has not.
    let mut seam: Vec<u32> = (0..STEPS).map(|k| add([us[0], at(vs, k)])).collect();
    let top = if is_ball {
        add([us[0], vs[1]])
    } else {
        seam[0]
    };
    seam.push(top);
    let mut ring: Vec<u32> = (0..STEPS)
        .map(|k| {
            if is_ball || k == 0 {
                seam[0]
            } else {
                add([at(us, k), vs[0]])
            }
        })
        .collect();
    ring.push(seam[0]);
    let mut line = Vec::new();
    let mut push = |vertex: u32, uv: [f64; 2]| {
        line.push(Corner {
            vertex,
            uv,
            after_pole: false,
        });
    };
    let rings = if is_ball {
        vec![0, STEPS]
    } else {
        (0..=STEPS).collect()
    };
    let above = |k: usize| if is_ball { top } else { ring[k] };
    rings
        .iter()
        .for_each(|k| push(ring[*k], [at(us, *k), vs[0]]));
    (1..STEPS).for_each(|k| push(seam[k], [us[1], at(vs, k)]));
    (rings.iter().rev()).for_each(|k| push(above(*k), [at(us, *k), vs[1]]));
    (1..STEPS)
        .rev()
        .for_each(|k| push(seam[k], [us[0], at(vs, k)]));
    Some(line)
}

/// Lines about holes are brought within the outer one.
fn gathered(shape: &Shape, lines: &mut [Line]) {
    let size = |line: &Line| area(line).abs();
    let largest = (0..lines.len()).max_by(|a, b| size(&lines[*a]).total_cmp(&size(&lines[*b])));
    let Some(largest) = largest else {
        return;
    };
    let outer = lines[largest].clone();
    let turns = shape.periods().map(|period| match period {
        Some(period) => vec![0.0, period, -period, 2.0 * period, -2.0 * period],
        None => vec![0.0],
    });
    for (_, line) in lines.iter_mut().enumerate().filter(|(k, _)| *k != largest) {
        let at = line[0].uv;
        let by = (turns[0].iter())
            .flat_map(|u| turns[1].iter().map(move |v| [*u, *v]))
            .find(|by| is_within(&outer, [at[0] + by[0], at[1] + by[1]]));
        if let Some(by) = by {
            line.iter_mut().for_each(|corner| {
                corner.uv[0] += by[0];
                corner.uv[1] += by[1];
            });
        }
    }
}

fn is_within(line: &[Corner], [u, v]: [f64; 2]) -> bool {
    let next = line.iter().cycle().skip(1);
    let crossed = line.iter().zip(next).filter(|(a, b)| {
        (a.uv[1] > v) != (b.uv[1] > v) && {
            let share = (v - a.uv[1]) / (b.uv[1] - a.uv[1]);
            u < a.uv[0] + share * (b.uv[0] - a.uv[0])
        }
    });
    crossed.count() % 2 == 1
}
