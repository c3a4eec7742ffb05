//! Sets of angles on the circle: arcs and their intersections.

use std::f64::consts::{PI, TAU};

/// From `from_rad` in [0, 2π) anticlockwise to `to_rad`, which may lie beyond 2π; both ends
/// included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    pub from_rad: f64,
    pub to_rad: f64,
}

impl Arc {
    fn new(from_rad: f64, to_rad: f64) -> Self {
        let turned = from_rad.rem_euclid(TAU);
        Self {
            from_rad: turned,
            to_rad: turned + (to_rad - from_rad),
        }
    }

    /// Size of the arc, rad.
    pub fn width_rad(&self) -> f64 {
        self.to_rad - self.from_rad
    }
}

/// Angles that an intersection of arcs leaves: the whole circle, or arcs that do not overlap, none
/// of them if it is empty.
#[derive(Debug, Clone, PartialEq)]
pub enum AngleSet {
    Circle,
    Arcs(Vec<Arc>),
}

impl AngleSet {
    /// All angles within `half_width_rad` of `middle_rad`. A half-width of π or more is the circle,
    /// one below 0 nothing.
    pub fn around(middle_rad: f64, half_width_rad: f64) -> Self {
        if half_width_rad >= PI {
            return Self::Circle;
        }
        if half_width_rad < 0.0 {
            return Self::Arcs(Vec::new());
        }
        let (from, to) = (middle_rad - half_width_rad, middle_rad + half_width_rad);
        Self::Arcs(vec![Arc::new(from, to)])
    }

    /// No angle at all.
    pub fn is_empty(&self) -> bool {
        matches!(self, Self::Arcs(arcs) if arcs.is_empty())
    }

    /// Size of all arcs together, rad.
    pub fn width_rad(&self) -> f64 {
        match self {
            Self::Circle => TAU,
            Self::Arcs(arcs) => arcs.iter().map(Arc::width_rad).sum(),
        }
    }

    /// What both hold.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let (Self::Arcs(own), Self::Arcs(others)) = (self, other) else {
            let smaller = if *self == Self::Circle { other } else { self };
            return smaller.clone();
        };
        let mut found = Vec::new();
        for a in own {
            for b in others {
                // Two arcs of less than a turn each may overlap at both ends.
                for turn in [-TAU, 0.0, TAU] {
                    let from = a.from_rad.max(b.from_rad + turn);
                    let to = a.to_rad.min(b.to_rad + turn);
                    if from <= to {
                        found.push(Arc::new(from, to));
                    }
                }
            }
        }
        Self::Arcs(found)
    }

    /// Whether an angle belongs to the set.
    pub fn contains(&self, angle_rad: f64) -> bool {
        match self {
            Self::Circle => true,
            Self::Arcs(arcs) => arcs
                .iter()
                .any(|arc| (angle_rad - arc.from_rad).rem_euclid(TAU) <= arc.to_rad - arc.from_rad),
        }
    }
}

/// An angle brought to [−π, π).
pub fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn two_wide_arcs_may_overlap_at_both_ends() {
        let both = AngleSet::around(0.0, 2.0).intersection(&AngleSet::around(PI, 2.0));
        let AngleSet::Arcs(arcs) = &both else {
            panic!("not all angles")
        };
        assert_eq!(arcs.len(), 2);
        assert!((both.width_rad() - 2.0 * (4.0 - PI)).abs() < 1e-12);
        assert!(both.contains(1.5) && both.contains(-1.5) && !both.contains(0.0));
    }

    #[test]
    fn half_widths_of_nothing_and_of_a_turn() {
        assert!(AngleSet::around(1.0, -0.1).is_empty());
        assert_eq!(AngleSet::around(1.0, PI), AngleSet::Circle);
    }

    proptest! {
        /// An angle is in the intersection if it is in every arc.
        #[test]
        fn an_intersection_holds_what_all_hold(
            arcs in prop::collection::vec((0.0..TAU, 0.3..3.1_f64), 1..4), angle in -9.0..9.0_f64,
        ) {
            let sets: Vec<AngleSet> = arcs.iter().map(|(m, h)| AngleSet::around(*m, *h)).collect();
            let all = sets.iter().fold(AngleSet::Circle, |a, b| a.intersection(b));
            let margin = |(middle, half): &(f64, f64)| half - wrapped(angle - middle).abs();
            let margins: Vec<f64> = arcs.iter().map(margin).collect();
            if margins.iter().all(|m| *m > 1e-9) {
                prop_assert!(all.contains(angle));
            }
            if margins.iter().any(|m| *m < -1e-9) {
                prop_assert!(!all.contains(angle));
            }
        }
    }
}
