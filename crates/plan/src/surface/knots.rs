//! Knot vectors and B-spline basis functions (Piegl and Tiller, The NURBS Book, algorithms A2.1 to
//! A2.3).

use super::error::SurfaceFault;

use crate::bounds::OutOfBounds;

/// Highest degree that is read: modellers write no higher one.
pub(super) const MAX_DEGREE: usize = 25;

/// Values of the functions that do not vanish in a span, degree + 1 of them.
type Values = [f64; MAX_DEGREE + 1];

/// A checked knot vector of one direction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Knots {
    degree: usize,
    knots: Vec<f64>,
}

/// Basis functions at a parameter: the first control point that they weigh, values and two
/// derivatives.
pub(super) struct Basis {
    pub(super) first: usize,
    pub(super) derivatives: [Values; 3],
}

impl Knots {
    /// A knot vector for `points` control points.
    pub(super) fn new(
        direction: &'static str,
        degree: usize,
        knots: Vec<f64>,
        points: usize,
    ) -> Result<Self, SurfaceFault> {
        let what = format!("the degree in {direction}");
        OutOfBounds::unless(
            (1..=MAX_DEGREE).contains(&degree),
            what,
            degree,
            "from 1 to 25",
        )?;
        if points <= degree {
            return Err(SurfaceFault::TooFewPoints {
                direction,
                points,
                degree,
                least: degree + 1,
            });
        }
        let expected = points + degree + 1;
        if knots.len() != expected {
            return Err(SurfaceFault::KnotCount {
                direction,
                found: knots.len(),
                points,
                degree,
                expected,
            });
        }
        if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
            return Err(SurfaceFault::NotFinite {
                what: if direction == "u" {
                    "knot of u"
                } else {
                    "knot of v"
                },
                index: index + 1,
                value: knots[index].to_string(),
            });
        }
        if let Some(i) = knots.windows(2).position(|w| w[1] < w[0]) {
            return Err(SurfaceFault::KnotsFall {
                direction,
                index: i + 2,
                value: knots[i + 1],
                before: knots[i],
            });
        }
        for run in knots.chunk_by(|a, b| a == b) {
            let inside = run[0] > knots[0] && run[0] < knots[knots.len() - 1];
            let limit = if inside { degree } else { degree + 1 };
            if run.len() > limit {
                return Err(SurfaceFault::KnotRepeated {
                    direction,
                    value: run[0],
                    times: run.len(),
                    limit,
                    degree,
                });
            }
        }
        let known = Self { degree, knots };
        let [first, last] = known.range();
        if first >= last {
            let value = first;
            return Err(SurfaceFault::KnotsWithoutSpan { direction, value });
        }
        Ok(known)
    }

    /// First and last parameter.
    pub(super) fn range(&self) -> [f64; 2] {
        let last = self.knots.len() - 1 - self.degree;
        [self.knots[self.degree], self.knots[last]]
    }

    /// Index of the last knot at or below a parameter within the range; at the range's end that
    /// before it.
    fn span(&self, t: f64) -> usize {
        let inside = &self.knots[self.degree..self.knots.len() - self.degree];
        let above = inside.partition_point(|k| *k <= t);
        if above < inside.len() {
            // Of a parameter that is no number none is below: what comes of it is none either.
            return self.degree + above.max(1) - 1;
        }
        let end = inside[inside.len() - 1];
        self.degree + inside.partition_point(|k| *k < end) - 1
    }

    /// Basis functions and their derivatives; a parameter outside is taken at the end.
    pub(super) fn basis(&self, t: f64) -> Basis {
        let [low, high] = self.range();
        let t = t.clamp(low, high);
        let (p, span) = (self.degree, self.span(t));
        let mut second = [0.0; MAX_DEGREE + 1];
        if p >= 2 {
            second = self.differentiated(span, p - 1, &self.values(span, t, p - 2));
            second = self.differentiated(span, p, &second);
        }
        Basis {
            first: span - p,
            derivatives: [
                self.values(span, t, p),
                self.differentiated(span, p, &self.values(span, t, p - 1)),
                second,
            ],
        }
    }

    /// The degree + 1 functions of a degree that do not vanish in a span.
    fn values(&self, span: usize, t: f64, degree: usize) -> Values {
        let mut values = [0.0; MAX_DEGREE + 1];
        values[0] = 1.0;
        for d in 1..=degree {
            let mut carried = 0.0;
            for (r, value) in values[..d].iter_mut().enumerate() {
                let right = self.knots[span + r + 1];
                let left = self.knots[span + 1 + r - d];
                let share = *value / (right - left);
                *value = carried + (right - t) * share;
                carried = (t - left) * share;
            }
            values[d] = carried;
        }
        values
    }

    /// Derivatives of the functions of a degree from those of one degree less (or from derivatives
    /// of those).
    fn differentiated(&self, span: usize, degree: usize, lower: &Values) -> Values {
        let mut raised = [0.0; MAX_DEGREE + 1];
        for j in 0..=degree {
            let i = span + j - degree;
            let knots = |a: usize| self.knots[a + degree] - self.knots[a];
            let from = if j > 0 { lower[j - 1] / knots(i) } else { 0.0 };
            let to = if j < degree {
                lower[j] / knots(i + 1)
            } else {
                0.0
            };
            raised[j] = degree as f64 * (from - to);
        }
        raised
    }
}
