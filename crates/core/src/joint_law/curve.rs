//! A law of a joint that has no name: a smooth curve through values at even places.

/// Natural cubic spline (`deboor2001`) through values evenly from one end to the other; beyond the
/// ends it stays as it is there.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    from: f64,
    to: f64,
    values: Vec<f64>,
    /// Second derivatives at the knots, per square of the distance between two of them.
    bending: Vec<f64>,
}

impl Curve {
    /// One value is a constant. `None` unless `from` is below `to` and there is a value.
    pub fn new(from: f64, to: f64, values: &[f64]) -> Option<Curve> {
        let values = match values {
            [one] => vec![*one; 2],
            several => several.to_vec(),
        };
        (from < to && !values.is_empty()).then(|| Curve {
            from,
            to,
            bending: bending(&values),
            values,
        })
    }

    /// Value at a place.
    pub fn value(&self, x: f64) -> f64 {
        let (i, u) = self.place(x);
        let (a, b) = (1.0 - u, u);
        let bent = (a.powi(3) - a) * self.bending[i] + (b.powi(3) - b) * self.bending[i + 1];
        a * self.values[i] + b * self.values[i + 1] + bent / 6.0
    }

    /// Slope at a place; none beyond the ends.
    pub fn slope(&self, x: f64) -> f64 {
        if !(self.from..=self.to).contains(&x) {
            return 0.0;
        }
        let (i, u) = self.place(x);
        let (a, b) = (1.0 - u, u);
        let bent =
            (3.0 * b * b - 1.0) * self.bending[i + 1] - (3.0 * a * a - 1.0) * self.bending[i];
        (self.values[i + 1] - self.values[i] + bent / 6.0) / self.spacing()
    }

    /// Integral from the first end to a place.
    pub fn integral(&self, x: f64) -> f64 {
        let h = self.spacing();
        let (last, u) = self.place(x);
        let whole = (0..last).map(|i| self.part(i, 1.0)).sum::<f64>();
        let inside = h * (whole + self.part(last, u));
        let beyond = (x - x.clamp(self.from, self.to)) * self.value(x);
        inside + beyond
    }

    /// Integral over the first part `u` of an interval of unit length.
    fn part(&self, i: usize, u: f64) -> f64 {
        let a = 1.0 - u;
        let linear = 0.5 * (1.0 - a * a) * self.values[i] + 0.5 * u * u * self.values[i + 1];
        // of (a³ - a) and of (u³ - u)
        let first = 0.25 * (1.0 - a.powi(4)) - 0.5 * (1.0 - a * a);
        let second = 0.25 * u.powi(4) - 0.5 * u * u;
        linear + (first * self.bending[i] + second * self.bending[i + 1]) / 6.0
    }

    fn intervals(&self) -> usize {
        self.values.len() - 1
    }

    fn spacing(&self) -> f64 {
        (self.to - self.from) / self.intervals() as f64
    }

    /// Interval of a place and how far into it, from 0 to 1.
    fn place(&self, x: f64) -> (usize, f64) {
        let along = ((x - self.from) / self.spacing()).clamp(0.0, self.intervals() as f64);
        let i = (along as usize).min(self.intervals() - 1);
        (i, along - i as f64)
    }
}

/// Second derivatives that make the first ones meet: `m₋ + 4 m + m₊ = 6 (y₋ - 2 y + y₊)`, none
/// at the ends; by elimination.
fn bending(y: &[f64]) -> Vec<f64> {
    let count = y.len();
    let (mut pivot, mut right) = (vec![1.0; count], vec![0.0; count]);
    for i in 1..count - 1 {
        let before = if i == 1 { 0.0 } else { 1.0 / pivot[i - 1] };
        pivot[i] = 4.0 - before;
        right[i] = 6.0 * (y[i - 1] - 2.0 * y[i] + y[i + 1]) - before * right[i - 1];
    }
    let mut bending = vec![0.0; count];
    for i in (1..count - 1).rev() {
        bending[i] = (right[i] - bending[i + 1]) / pivot[i];
    }
    bending
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Through its knots, with slopes and second derivatives that meet there.
        #[test]
        fn verify_a_curve_is_a_natural_cubic_spline(
            values in proptest::collection::vec(-10.0..10.0f64, 3..30), from in -3.0..3.0f64, length in 0.1..5.0f64,
        ) {
            let curve = Curve::new(from, from + length, &values).unwrap();
            let h = length / (values.len() - 1) as f64;
            let e = 1e-5 * h;
            for (i, value) in values.iter().enumerate() {
                let x = from + i as f64 * h;
                prop_assert!((curve.value(x) - value).abs() < 1e-9);
                if (1..values.len() - 1).contains(&i) {
                    let jump = curve.slope(x + e) - curve.slope(x - e);
                    prop_assert!(jump.abs() * h < 1e-2, "{jump}");
                }
            }
            // no bending at the ends, none beyond them
            let bend = |x: f64| (curve.slope(x + e) - curve.slope(x)) / e * h * h;
            prop_assert!(bend(from).abs() < 1e-2);
            prop_assert_eq!(curve.value(from - 1.0), values[0]);
            prop_assert_eq!(curve.slope(from + length + 1.0), 0.0);
        }

        /// Its slope is that of its values, its value that of its integral.
        #[test]
        fn verify_slope_and_integral_of_a_curve(
            values in proptest::collection::vec(-10.0..10.0f64, 3..30), at in -0.3..1.3f64,
        ) {
            let curve = Curve::new(0.0, 1.0, &values).unwrap();
            let e = 1e-6;
            let value = (curve.integral(at + e) - curve.integral(at - e)) / (2.0 * e);
            prop_assert!((value - curve.value(at)).abs() < 1e-3, "{value}");
            if !(-1e-5..1e-5).contains(&at) && !(1.0 - 1e-5..1.0 + 1e-5).contains(&at) {
                let slope = (curve.value(at + e) - curve.value(at - e)) / (2.0 * e);
                prop_assert!((slope - curve.slope(at)).abs() < 1e-2, "{slope}");
            }
        }
    }

    #[test]
    fn verify_a_straight_line_stays_one() {
        let values: Vec<f64> = (0..9).map(|i| 2.0 - 0.5 * f64::from(i)).collect();
        let curve = Curve::new(-1.0, 3.0, &values).unwrap();
        for x in [-1.0, -0.77, 0.1, 1.234, 2.9, 3.0] {
            assert!((curve.value(x) - (2.0 - (x + 1.0))).abs() < 1e-12);
        }
        assert!(Curve::new(1.0, 1.0, &values).is_none());
    }
}
