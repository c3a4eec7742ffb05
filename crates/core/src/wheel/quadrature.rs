//! Gauss–Legendre rules, computed once and kept.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use crate::legendre::legendre;

/// Rows of a disc, and nodes in each: smooth pressures and a sliding that turns about a point
/// outside are met to 1e-5.
const DISC_ROWS: usize = 12;
/// Nodes of a disc; four of them are summed at a time.
pub(super) const DISC_NODES: usize = DISC_ROWS * DISC_ROWS;

/// Nodes of a disc of radius 1 and their weights, apart, so that a loop over them runs over numbers
/// side by side.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Disc {
    pub x: [f64; DISC_NODES],
    pub y: [f64; DISC_NODES],
    pub area: [f64; DISC_NODES],
}

/// Nodes across a narrow patch; four of them are summed at a time.
pub(super) const ACROSS_NODES: usize = 12;

/// Nodes on `[-1, 1]` by the sine of an angle, in which pressures that fall to zero like a root at
/// both ends are smooth.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Across {
    pub x: [f64; ACROSS_NODES],
    pub length: [f64; ACROSS_NODES],
}

/// Rules of one to `largest` nodes on `[-1, 1]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// `rules[n - 1]` holds n pairs (node, weight).
    rules: Vec<Vec<(f64, f64)>>,
    by_sine: Vec<(f64, f64)>,
    disc: Box<Disc>,
    across: Across,
}

impl Default for Quadrature {
    /// Sixteen rows of sixteen nodes over a whole patch.
    fn default() -> Self {
        // A search makes thousands of wheels.
        static RULES: LazyLock<Quadrature> = LazyLock::new(|| Quadrature::new(16));
        RULES.clone()
    }
}

impl Quadrature {
    /// Rules up to `largest` nodes; at least four.
    pub fn new(largest: usize) -> Self {
        let largest = largest.max(4);
        Self {
            rules: (1..=largest).map(legendre).collect(),
            by_sine: by_sine(&legendre(largest)),
            disc: Box::new(disc(&legendre(DISC_ROWS))),
            across: across(&by_sine(&legendre(ACROSS_NODES))),
        }
    }

    /// Nodes of a disc: rows and nodes along them by the sine of an angle, in which pressures that
    /// fall to zero like a root at the rim are smooth.
    pub(super) fn disc(&self) -> &Disc {
        &self.disc
    }

    /// Nodes across a narrow patch.
    pub(super) fn across(&self) -> &Across {
        &self.across
    }

    /// Nodes of the largest rule.
    pub fn largest(&self) -> usize {
        self.rules.len()
    }

    /// Nodes on `[-1, 1]` and weights of the largest rule.
    pub fn nodes(&self) -> &[(f64, f64)] {
        self.for_share(1.0)
    }

    /// As many as [`Self::nodes`] by the sine of an angle, in which what begins like a root at both
    /// ends is smooth.
    pub fn by_sine(&self) -> &[(f64, f64)] {
        &self.by_sine
    }

    /// The rule of two nodes.
    pub fn pair(&self) -> &[(f64, f64)] {
        &self.rules[1]
    }

    /// Rule for a part of the whole range: as many nodes as its share, but at least four, since a
    /// short part is no smoother than a long one.
    pub(super) fn for_share(&self, share: f64) -> &[(f64, f64)] {
        let n = self.largest();
        let nodes = (share * n as f64).ceil().clamp(4.0, n as f64) as usize;
        &self.rules[nodes - 1]
    }

    /// Integral of `f` over `[from, to]` with the largest rule.
    pub fn integrate(&self, from: f64, to: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        half * self
            .nodes()
            .iter()
            .map(|(x, w)| w * f(middle + half * x))
            .sum::<f64>()
    }
}

fn by_sine(rule: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let node = |(node, weight): &(f64, f64)| {
        let (sine, cosine) = (FRAC_PI_2 * node).sin_cos();
        (sine, FRAC_PI_2 * weight * cosine)
    };
    rule.iter().map(node).collect()
}

fn across(nodes: &[(f64, f64)]) -> Across {
    Across {
        x: std::array::from_fn(|k| nodes[k].0),
        length: std::array::from_fn(|k| nodes[k].1),
    }
}

fn disc(rule: &[(f64, f64)]) -> Disc {
    let zeros = [0.0; DISC_NODES];
    let mut disc = Disc {
        x: zeros,
        y: zeros,
        area: zeros,
    };
    let angle = |k: usize| {
        let (node, weight) = rule[k];
        ((FRAC_PI_2 * node).sin_cos(), FRAC_PI_2 * weight)
    };
    for k in 0..DISC_NODES {
        let ((y, half), row) = angle(k / DISC_ROWS);
        let ((sine, cosine), weight) = angle(k % DISC_ROWS);
        disc.x[k] = half * sine;
        disc.y[k] = y;
        disc.area[k] = row * half * weight * half * cosine;
    }
    disc
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Area, polar moment, and a hemisphere, whose height falls like a root at the rim.
    #[test]
    fn verify_disc_integrates_polynomials_and_a_root_at_the_rim() {
        let q = Quadrature::default();
        let over = |f: &dyn Fn(f64) -> f64| -> f64 {
            let d = q.disc();
            (0..DISC_NODES)
                .map(|k| d.area[k] * f(d.x[k] * d.x[k] + d.y[k] * d.y[k]))
                .sum()
        };
        assert!((over(&|_| 1.0) / PI - 1.0).abs() < 1e-12);
        assert!((over(&|square| square) / (0.5 * PI) - 1.0).abs() < 1e-12);
        let hemisphere = over(&|square| (1.0 - square).sqrt());
        assert!((hemisphere / (2.0 * PI / 3.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn verify_rule_of_n_nodes_is_exact_to_degree_two_n_less_one() {
        let q = Quadrature::new(16);
        for n in 4..=16 {
            let rule = &q.rules[n - 1];
            for degree in [2 * n - 2, 2 * n - 1] {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 {
                    2.0 / (degree as f64 + 1.0)
                } else {
                    0.0
                };
                assert!((sum - exact).abs() < 1e-13, "{n} {degree}: {sum}");
            }
        }
    }
}
