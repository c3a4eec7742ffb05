//! Where the tool goes: straight legs, one tool axis.

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};
use truecut_arm::tool_pose;

use crate::error::PlanError;

/// Places closer than this are one, m.
const SAME_PLACE_M: f64 = 1e-12;

/// A path of straight legs that a tool with a constant axis follows, world frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolPath {
    vertices_m: Vec<Vector3<f64>>,
    /// Distance of each vertex from the start.
    along_m: Vec<f64>,
    /// The tool's z axis, from the spindle into the workpiece.
    tool_axis: Unit<Vector3<f64>>,
    /// Direction of the tool's x axis at redundancy angle 0.
    zero_direction: Vector3<f64>,
}

impl ToolPath {
    /// A path through `vertices_m`, the tool's z axis along `tool_axis`, its x axis along
    /// `zero_direction` (made square to the tool axis) where the redundancy angle is 0.
    ///
    /// # Errors
    /// If there are fewer than two points, two that follow each other are the same, a leg does not
    /// run across the tool axis, or the zero direction is parallel to it.
    pub fn new(
        vertices_m: &[Vector3<f64>],
        tool_axis: Unit<Vector3<f64>>,
        zero_direction: Vector3<f64>,
    ) -> Result<Self, PlanError> {
        let count = vertices_m.len();
        let lengths: Vec<f64> = vertices_m
            .windows(2)
            .map(|w| (w[1] - w[0]).norm())
            .collect();
        if lengths.is_empty() || !lengths.iter().all(|l| *l > 0.0 && l.is_finite()) {
            return Err(PlanError::PathPoints { count });
        }
        for (leg, pair) in vertices_m.windows(2).enumerate() {
            let cosine = (pair[1] - pair[0]).normalize().dot(&tool_axis);
            if cosine.abs() > 1e-6 {
                let angle_deg = cosine.clamp(-1.0, 1.0).acos().to_degrees();
                return Err(PlanError::FeedAlongTool {
                    leg: leg + 1,
                    angle_deg,
                });
            }
        }
        tool_pose(&vertices_m[0], &tool_axis, &zero_direction, 0.0)?;
        let mut along_m = vec![0.0];
        for length in lengths {
            along_m.push(along_m[along_m.len() - 1] + length);
        }
        Ok(Self {
            vertices_m: vertices_m.to_vec(),
            along_m,
            tool_axis,
            zero_direction,
        })
    }

    /// Length, m.
    pub fn length_m(&self) -> f64 {
        self.along_m[self.along_m.len() - 1]
    }

    /// Where each leg begins and ends, m from the start.
    pub fn legs_m(&self) -> impl Iterator<Item = (f64, f64)> {
        self.along_m.windows(2).map(|w| (w[0], w[1]))
    }

    /// The leg at a distance from the start; of two legs that meet there the later one. Beyond the
    /// ends the first or last.
    pub fn leg(&self, along_m: f64) -> usize {
        let begun = (self.along_m.iter()).filter(|begin| **begin <= along_m + SAME_PLACE_M);
        begun.count().clamp(1, self.along_m.len() - 1) - 1
    }

    /// The point at a distance from the start, m.
    pub fn point_m(&self, along_m: f64) -> Vector3<f64> {
        let leg = self.leg(along_m);
        self.vertices_m[leg] + self.feed(leg) * (along_m - self.along_m[leg])
    }

    /// Direction of the feed in a leg, of length 1.
    pub fn feed(&self, leg: usize) -> Vector3<f64> {
        (self.vertices_m[leg + 1] - self.vertices_m[leg]).normalize()
    }

    /// The tool's z axis.
    pub fn tool_axis(&self) -> Unit<Vector3<f64>> {
        self.tool_axis
    }

    /// The milling frame of a leg in the world: x the feed, z against the tool axis, y = z × x, as
    /// columns.
    pub fn world_from_milling(&self, leg: usize) -> Matrix3<f64> {
        let (x, z) = (self.feed(leg), -self.tool_axis.into_inner());
        Matrix3::from_columns(&[x, z.cross(&x), z])
    }

    /// Pose of the tool in the world at a distance from the start, at a redundancy angle (rad).
    ///
    /// # Errors
    /// None that [`ToolPath::new`] has not excluded.
    pub fn pose(&self, along_m: f64, angle_rad: f64) -> Result<Isometry3<f64>, PlanError> {
        let point = self.point_m(along_m);
        Ok(tool_pose(
            &point,
            &self.tool_axis,
            &self.zero_direction,
            angle_rad,
        )?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bent() -> ToolPath {
        let points = [[1.0, 0.0, 0.5], [1.3, 0.0, 0.5], [1.3, 0.4, 0.5]].map(Vector3::from);
        ToolPath::new(&points, -Vector3::z_axis(), Vector3::x()).expect("a path")
    }

    #[test]
    fn verify_points_legs_and_frames() {
        let path = bent();
        assert!((path.length_m() - 0.7).abs() < 1e-15);
        assert_eq!(
            (path.leg(-1.0), path.leg(0.1), path.leg(0.3), path.leg(9.0)),
            (0, 0, 1, 1)
        );
        assert!((path.point_m(0.5) - Vector3::new(1.3, 0.2, 0.5)).norm() < 1e-15);
        // Tool down: the milling frame stands upright, its y axis left of the feed.
        let second = path.world_from_milling(1);
        let expected = Matrix3::from_columns(&[Vector3::y(), -Vector3::x(), Vector3::z()]);
        assert!((second - expected).norm() < 1e-15);
        let pose = path.pose(0.5, 0.3).expect("square");
        let x = pose * Vector3::x();
        assert!((x - Vector3::new(0.3_f64.cos(), 0.3_f64.sin(), 0.0)).norm() < 1e-15);
    }

    #[test]
    fn paths_that_are_none_are_refused() {
        let refuse = |points: &[[f64; 3]], axis, zero| {
            let points: Vec<_> = points.iter().map(|p| Vector3::from(*p)).collect();
            let refused = ToolPath::new(&points, axis, zero).expect_err("not a path");
            refused.to_string()
        };
        let (down, x) = (-Vector3::z_axis(), Vector3::x());
        let (a, b) = ([0.0; 3], [0.1, 0.0, 0.0]);
        assert!(refuse(&[a], down, x).contains("has 1 points"));
        assert!(refuse(&[a, a, b], down, x).contains("no two the same"));
        assert!(refuse(&[a, [f64::NAN, 0.0, 0.0]], down, x).contains("finite"));
        let steep = refuse(&[a, b, [0.1, 0.1, -0.1]], down, x);
        assert!(
            steep.contains("leg 2") && steep.contains("45.00 deg"),
            "{steep}"
        );
        assert!(refuse(&[a, b], down, Vector3::z()).contains("zero direction"));
    }
}
