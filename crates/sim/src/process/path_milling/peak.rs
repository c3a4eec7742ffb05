//! The largest value of what rises and falls with each tooth.
//!
//! An edge on a helix comes into the cut within less than a step or two, and its force has a kink
//! where all of it is in: the largest of values a step apart, or of means over steps, falls short
//! of it in proportion to the step. So where such values have a maximum, the peak about it is found
//! by golden section.

/// Sampled maxima that fall further short of the largest so far are not looked at. On cuts of 40
/// steps a tooth samples fall short of their peaks by up to a twentieth.
const MARGIN: f64 = 0.2;
/// Parts by which golden section narrows two steps: to a thousandth.
const NARROWED: usize = 15;

/// A value over the spindle's rotation.
#[derive(Debug, Clone, Default)]
pub(super) struct Peak {
    pub largest: f64,
    /// The last two samples: rotation, rad, and value.
    before: [Option<(f64, f64)>; 2],
}

impl Peak {
    /// Nothing is sampled for a while.
    pub fn pause(&mut self) {
        self.before = [None; 2];
    }

    /// A step later; `value_at` tells the value at rotations up to this one.
    pub fn add(&mut self, rotation_rad: f64, value: f64, value_at: impl Fn(f64) -> f64) {
        let [first, middle] = self.before;
        self.before = [middle, Some((rotation_rad, value))];
        self.largest = self.largest.max(value);
        let (Some((from, low)), Some((_, high))) = (first, middle) else {
            return;
        };
        let is_top = high > low && high >= value && high >= (1.0 - MARGIN) * self.largest;
        if is_top {
            let found = largest_between([from, rotation_rad], value_at);
            self.largest = self.largest.max(found);
        }
    }
}

/// Largest value met by golden section of what has one maximum between two places.
fn largest_between([mut from, mut to]: [f64; 2], value_at: impl Fn(f64) -> f64) -> f64 {
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (to - share * (to - from), from + share * (to - from));
    let (mut at_left, mut at_right) = (value_at(left), value_at(right));
    let mut largest = at_left.max(at_right);
    for _ in 0..NARROWED {
        if at_left < at_right {
            from = left;
            (left, at_left) = (right, at_right);
            right = from + share * (to - from);
            at_right = value_at(right);
        } else {
            to = right;
            (right, at_right) = (left, at_left);
            left = to - share * (to - from);
            at_left = value_at(left);
        }
        largest = largest.max(at_left).max(at_right);
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::Peak;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Uniform};

    /// Edges that come in within less than a step and leave slowly, as in down-milling: the kink is
    /// found to a part in a thousand wherever the steps fall, of which samples miss a hundredth.
    #[test]
    fn verify_kinks_between_steps_are_found() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut draw = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
        let mut missed = 0;
        for _ in 0..40 {
            let (step, comes, height) = (draw(0.04, 0.1), draw(0.02, 0.12), draw(1.0, 300.0));
            let (entry, leaves) = (draw(0.0, 3.0), draw(0.7, 1.5));
            let value = |at: f64| {
                let way = (at - entry).rem_euclid(3.2);
                let rises = (way / comes).min(1.0);
                height * rises * (1.0 - (way - comes).max(0.0) / leaves).max(0.0)
            };
            let (mut peak, mut sampled) = (Peak::default(), 0.0_f64);
            for k in 0..200 {
                let at = step * f64::from(k);
                sampled = sampled.max(value(at));
                peak.add(at, value(at), value);
            }
            missed += usize::from(sampled < 0.99 * height);
            let found = peak.largest / height;
            assert!((found - 1.0).abs() < 1e-3, "{found} of {height}");
        }
        assert!(missed > 5, "{missed}");
    }
}
