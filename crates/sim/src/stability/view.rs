//! A plan as it is seen: the arm at every station.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use truecut_plan::Plan;
use truecut_recording::{Body, Frame, Geometry, Pose, Scene};

use super::MillingStudy;
use crate::scene::shapes::steel;
use crate::scene::{Surroundings, Tooling, arm_view, pose};

/// Size of the block of stock across the path and down, m.
const STOCK_M: [f64; 2] = [0.2, 0.05];

impl MillingStudy {
    /// The arm at the first station, a block of stock below the path, and a frame for each station,
    /// at the times at which the tool is there.
    pub fn view(&self, plan: &Plan) -> (Scene, Vec<Frame>) {
        let feed_m_per_s = self.cut.feed_m_per_s();
        let stops = plan.points.iter();
        let stops = stops.map(|point| (point.along_m / feed_m_per_s, point.posture.as_slice()));
        let about = Surroundings {
            standing: vec![self.stock(plan)],
            carried: Vec::new(),
        };
        arm_view(&self.robot, &self.tooling(), stops, about)
    }

    /// The cutter of the cut.
    fn tooling(&self) -> Tooling {
        let radius_m = self.cut.nominal.cutter.radius_m;
        Tooling::end_mill(radius_m, 4.0 * radius_m)
    }

    fn stock(&self, plan: &Plan) -> Body {
        let down = self.path.tool_axis().into_inner();
        let middle = self.path.point_m(0.5 * self.path.length_m()) + down * (0.5 * STOCK_M[1]);
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(self.path.world_from_milling(0));
        let at = Isometry3::from_parts(
            Translation3::from(middle),
            UnitQuaternion::from_rotation_matrix(&rotation),
        );
        let ends = [0, plan.points.len() - 1].map(|i| plan.points[i].point_m);
        let length_m: f64 = (ends[1] - ends[0]).norm();
        let half = Vector3::new(0.5 * length_m + 0.03, 0.5 * STOCK_M[0], 0.5 * STOCK_M[1]);
        let stock = Geometry::Box {
            half_extents_m: half.into(),
        };
        Body {
            path: "workpiece".into(),
            shapes: vec![steel(stock, Pose::IDENTITY)],
            initial_pose: pose(&at),
        }
    }
}
