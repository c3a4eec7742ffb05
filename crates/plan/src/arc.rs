//! Circular arcs and helices.

use nalgebra::{Unit, Vector3};

/// An arc about an axis, with an even advance along it: a helix if that is not zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arc {
    pub centre: Vector3<f64>,
    /// From the centre to the start.
    pub spoke: Vector3<f64>,
    /// From the centre to a quarter of a turn on, as long as the spoke.
    pub quarter: Vector3<f64>,
    /// Turn from start to end, rad.
    pub turn_rad: f64,
    /// By how much the radius grows on the way, m: what rounding leaves of it.
    pub growth_m: f64,
    /// Along the axis.
    pub advance: Vector3<f64>,
}

impl Arc {
    /// From the first point through the second to the third; `None` if they lie on a line.
    pub fn through([from, via, to]: [Vector3<f64>; 3]) -> Option<Self> {
        let (a, b) = (via - from, to - from);
        let normal = a.cross(&b);
        let square = normal.norm_squared();
        if square.is_nan() || square <= 1e-18 * a.norm_squared() * b.norm_squared() {
            return None;
        }
        let offset = (normal.cross(&a) * b.norm_squared() + b.cross(&normal) * a.norm_squared())
            / (2.0 * square);
        let centre = from + offset;
        // The three points follow one another right-handed about the normal.
        Some(Self::about(
            &Unit::new_normalize(normal),
            centre,
            from,
            to,
            false,
        ))
    }

    /// About an axis through `centre`, right-handed, a whole turn where start and end agree and
    /// `whole` is set; the end may lie further along the axis.
    pub fn about(
        axis: &Unit<Vector3<f64>>,
        centre: Vector3<f64>,
        from: Vector3<f64>,
        to: Vector3<f64>,
        whole: bool,
    ) -> Self {
        let across = |v: Vector3<f64>| v - axis.into_inner() * axis.dot(&v);
        let (spoke, end) = (across(from - centre), across(to - centre));
        let advance = axis.into_inner() * axis.dot(&(to - from));
        let quarter = axis.cross(&spoke);
        let angle = quarter.dot(&end).atan2(spoke.dot(&end));
        let closed = (end - spoke).norm() <= 1e-9;
        let turn_rad = match (closed, whole) {
            (true, true) => std::f64::consts::TAU,
            (true, false) => 0.0,
            (false, _) if angle < 0.0 => angle + std::f64::consts::TAU,
            (false, _) => angle,
        };
        Self {
            centre: from - spoke,
            spoke,
            quarter,
            turn_rad,
            growth_m: end.norm() - spoke.norm(),
            advance,
        }
    }

    pub fn radius_m(&self) -> f64 {
        self.spoke.norm()
    }

    /// The place at a share of the way.
    pub fn at(&self, share: f64) -> Vector3<f64> {
        let (sine, cosine) = (self.turn_rad * share).sin_cos();
        let radius_m = self.radius_m();
        let grown = (radius_m + self.growth_m * share) / radius_m;
        self.centre + (self.spoke * cosine + self.quarter * sine) * grown + self.advance * share
    }

    /// How many chords lie within a distance of the arc.
    pub fn chords(&self, within_m: f64) -> usize {
        // acos(1 - w/r) without the difference, which is lost where the radius is large.
        let half = 2.0 * (within_m / (2.0 * self.radius_m())).min(0.5).sqrt().asin();
        (self.turn_rad / (2.0 * half)).ceil().max(1.0) as usize
    }
}
