//! B-spline curves of edges.

use nalgebra::Vector3;

use super::super::knots::{Knots, MAX_DEGREE};
use super::entities::{Model, get, list, number, numbers, reference};
use super::part21::{Entity, Fault, Value};

/// A rational B-spline.
#[derive(Debug, Clone)]
pub(super) struct Spline {
    knots: Knots,
    degree: usize,
    points: Vec<Vector3<f64>>,
    weights: Vec<f64>,
    /// Knots, each once.
    pub(super) breaks: Vec<f64>,
}

/// Knots, each as often as it stands.
pub(super) fn repeated(
    entity: &Entity,
    times: &Value,
    knots: &Value,
    limit: usize,
) -> Result<Vec<f64>, Fault> {
    let (times, knots) = (numbers(entity, times)?, numbers(entity, knots)?);
    if times.len() != knots.len() {
        return Err(entity.fault(format_args!(
            "{} knots with {} multiplicities",
            knots.len(),
            times.len()
        )));
    }
    let mut all = Vec::new();
    for (knot, times) in knots.iter().zip(&times) {
        if !(1.0..=1e6).contains(times) || all.len() + *times as usize > limit {
            return Err(entity.fault("more knots than its control points have"));
        }
        all.extend(std::iter::repeat_n(*knot, *times as usize));
    }
    Ok(all)
}

/// A degree as the entity has it, one that can be.
pub(super) fn degree(entity: &Entity, values: &[Value], k: usize) -> Result<usize, Fault> {
    let degree = number(entity, get(entity, values, k)?)?;
    let is_whole = degree.fract() == 0.0 && (1.0..=MAX_DEGREE as f64).contains(&degree);
    let rule =
        format_args!("its degree is {degree}, but must be a whole number from 1 to {MAX_DEGREE}");
    is_whole
        .then_some(degree as usize)
        .ok_or_else(|| entity.fault(rule))
}

/// Parameters of a B-spline, whether it stands by itself or is complex: those of degree and points,
/// of knots, and weights.
pub(super) type SplineParts<'e> = (&'e [Value], &'e [Value], Option<&'e [Value]>);

pub(super) fn spline_parts<'e>(
    entity: &'e Entity,
    basic: &str,
    split: usize,
) -> Option<SplineParts<'e>> {
    let name = format!("{basic}_WITH_KNOTS");
    let knots = entity.part(&name)?;
    if entity.parts.len() == 1 {
        let (basic, knots) = knots.get(1..)?.split_at_checked(split)?;
        return Some((basic, knots, None));
    }
    let rational = entity.part(&format!("RATIONAL_{basic}"));
    Some((entity.part(basic)?, knots, rational))
}

impl Spline {
    pub(super) fn read(
        model: &Model<'_>,
        entity: &Entity,
        basic: &[Value],
        knots: &[Value],
        rational: Option<&[Value]>,
    ) -> Result<Self, Fault> {
        let degree = degree(entity, basic, 0)?;
        let points = list(entity, get(entity, basic, 1)?)?.iter();
        let points = points.map(|value| model.point(reference(entity, value)?));
        let points: Vec<Vector3<f64>> = points.collect::<Result<_, _>>()?;
        let limit = points.len() + degree + 1;
        let all = repeated(
            entity,
            get(entity, knots, 0)?,
            get(entity, knots, 1)?,
            limit,
        )?;
        let mut breaks = numbers(entity, get(entity, knots, 1)?)?;
        let weights = match rational {
            Some(values) => numbers(entity, get(entity, values, 0)?)?,
            None => vec![1.0; points.len()],
        };
        if weights.len() != points.len() || weights.iter().any(|w| *w <= 0.0) {
            return Err(entity.fault("weights must be above 0, one for each point"));
        }
        let knots =
            Knots::new("u", degree, all, points.len()).map_err(|fault| entity.fault(fault))?;
        let [first, last] = knots.range();
        breaks.retain(|t| (first..=last).contains(t));
        Ok(Self {
            knots,
            degree,
            points,
            weights,
            breaks,
        })
    }

    pub(super) fn at(&self, t: f64) -> Vector3<f64> {
        let [first, last] = self.knots.range();
        let basis = self.knots.basis(t.clamp(first, last));
        let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
        for k in 0..=self.degree {
            let share = basis.derivatives[0][k] * self.weights[basis.first + k];
            sum += self.points[basis.first + k] * share;
            weight += share;
        }
        sum / weight
    }

    /// First and last parameter.
    pub(super) fn range(&self) -> [f64; 2] {
        self.knots.range()
    }

    /// After how much it comes back to where it was.
    pub(super) fn period(&self) -> Option<f64> {
        let [first, last] = self.knots.range();
        let size = self.points.iter().map(|p| (p - self.points[0]).norm());
        let size = size.fold(0.0, f64::max);
        let gap = (self.at(first) - self.at(last)).norm();
        (gap <= 1e-6 * size).then_some(last - first)
    }
}
