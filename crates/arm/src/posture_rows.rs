//! All postures for poses, as rows and as CSV.

use nalgebra::Isometry3;
use serde::Serialize;

use crate::ik_branches::BranchOptions;
use crate::model::{FrameId, Robot};
use crate::opw::ArmBranch;
use crate::table::IN_MEMORY;
use crate::turns::turned;

/// One posture for one pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IkRow {
    /// Number of the pose, from 1.
    pub pose: usize,
    /// Joint coordinates, rad or m.
    pub posture: Vec<f64>,
    pub within_limits: bool,
    /// Branch of an ortho-parallel arm with a spherical wrist, e.g. `front, upper, positive`;
    /// `None` for others.
    pub branch: Option<String>,
}

/// All postures for each pose of `frame`, revolute joints in (−π, π], or where that is out of
/// limits and a whole turn off it is not, there; see [`IkSolver::branches`].
///
/// [`IkSolver::branches`]: crate::IkSolver::branches
pub fn ik_rows(robot: &Robot, poses: &[Isometry3<f64>], frame: FrameId) -> Vec<IkRow> {
    let mut options = BranchOptions::default();
    if robot.dof() < 6 {
        // An arm of few joints reaches few attitudes: a pose that is written to seven digits lies
        // beside them.
        options.numeric.position_tolerance_m = 1e-8;
        options.numeric.angle_tolerance_rad = 1e-6;
    }
    let solver = robot.ik_solver(&options);
    let mut rows = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        let branches = solver.branches(pose, frame).into_iter();
        let postures = branches.map(|posture| least_turned(robot, posture));
        for posture in postures {
            let branch = solver.geometry().map(|geometry| {
                let ArmBranch {
                    shoulder,
                    elbow,
                    wrist,
                } = geometry.branch(&posture);
                format!("{shoulder:?} {elbow:?} {wrist:?}").to_lowercase()
            });
            rows.push(IkRow {
                pose: index + 1,
                within_limits: robot.check_posture(&posture).is_ok(),
                posture,
                branch,
            });
        }
    }
    rows
}

/// The posture, or the one within limits that is fewest whole turns off it, if it is beyond them
/// and there is one: a joint from −220 to 64 deg reaches by a turn what it does not beside 180 deg.
fn least_turned(robot: &Robot, posture: Vec<f64>) -> Vec<f64> {
    if robot.check_posture(&posture).is_ok() {
        return posture;
    }
    let off = |other: &Vec<f64>| -> f64 {
        let pairs = other.iter().zip(&posture);
        pairs.map(|(a, b)| (a - b).abs()).sum()
    };
    let within = turned(&robot.chain.joints, &posture).into_iter();
    let nearest = within.min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.unwrap_or(posture)
}

/// The rows as CSV with a heading.
pub fn ik_csv(robot: &Robot, rows: &[IkRow]) -> String {
    let mut out = csv::Writer::from_writer(Vec::new());
    let joints = robot.chain.joints.iter();
    let joints = joints.map(|joint| format!("{}_{}", joint.name, joint.kind.coordinate_unit()));
    let head = (["pose".to_owned()].into_iter()).chain(joints);
    let head = head.chain(["within_limits".to_owned(), "branch".to_owned()]);
    out.write_record(head).expect(IN_MEMORY);
    for row in rows {
        let values = row.posture.iter().map(|value| format!("{value:?}"));
        let last = [
            row.within_limits.to_string(),
            row.branch.clone().unwrap_or_default(),
        ];
        let cells = [row.pose.to_string()].into_iter().chain(values).chain(last);
        out.write_record(cells).expect(IN_MEMORY);
    }
    let bytes = out.into_inner().expect(IN_MEMORY);
    String::from_utf8(bytes).expect("numbers are text")
}
