//! What of a program the arm cannot do, or only badly: limits, singularities, speeds.

use truecut_arm::{OpwGeometry, Robot};

use super::moves::{Motion, Move, Program};
use crate::motion::joints::{JointSpeed, joint_speeds};
use crate::singularity::SingularityLimits;

/// By how much a joint may stand beyond its limits, rad: what printed decimals move it by.
const ROUNDING_RAD: f64 = 1e-3 * std::f64::consts::PI / 180.0;

/// Something to report of a program, with the path point and the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    pub path_point: usize,
    pub joint: String,
    pub kind: FindingKind,
}

/// What is found.
#[derive(Debug, Clone, PartialEq)]
pub enum FindingKind {
    /// The joint stands beyond its limits.
    OutsideLimits { excess_rad: f64 },
    /// The posture is nearer to a singularity than asked.
    NearSingularity {
        singularity: &'static str,
        distance: String,
        least: String,
    },
    /// On the line from the point before, at this share of it, no posture within limits reaches the
    /// pose. The joint is the first.
    LeavesReach { share: f64 },
    /// Followed from the posture before, the line ends in another posture than the point's, this
    /// joint so far from it.
    OtherPosture { by_rad: f64 },
    /// The tool's speed on the line from the point before asks more of the joint than it can turn.
    TooFast {
        speed_rad_per_s: f64,
        limit_rad_per_s: f64,
    },
}

impl FindingKind {
    /// Whether the arm cannot do what is asked, not only badly.
    #[must_use]
    pub fn is_grave(&self) -> bool {
        !matches!(self, Self::NearSingularity { .. })
    }

    /// A joint that is too fast.
    pub(super) fn of_speed(one: &JointSpeed) -> Self {
        Self::TooFast {
            speed_rad_per_s: one.speed,
            limit_rad_per_s: one.limit,
        }
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "path point {}: joint \"{}\" ",
            self.path_point, self.joint
        )?;
        match &self.kind {
            FindingKind::OutsideLimits { excess_rad } => {
                write!(
                    f,
                    "stands {:.3} deg beyond its limits",
                    excess_rad.to_degrees()
                )
            }
            FindingKind::NearSingularity {
                singularity,
                distance,
                least,
            } => write!(
                f,
                "is {distance} from the singularity of the {singularity}; at least {least} are asked"
            ),
            FindingKind::LeavesReach { share } => write!(
                f,
                "and the others cannot follow the line: {:.0} % of it are within reach and limits",
                share * 100.0
            ),
            FindingKind::OtherPosture { by_rad } => write!(
                f,
                "arrives {:.3} deg from the posture of the point: the line leads to another one",
                by_rad.to_degrees()
            ),
            FindingKind::TooFast {
                speed_rad_per_s,
                limit_rad_per_s,
            } => write!(
                f,
                "would have to turn at {:.1} deg/s; its limit is {:.1} deg/s",
                speed_rad_per_s.to_degrees(),
                limit_rad_per_s.to_degrees()
            ),
        }
    }
}

impl Program {
    /// All that a program asks beyond the robot's limits, and where it comes near a singularity.
    /// The speed of a joint is that between two path points at the programmed speed of the tool; a
    /// controller that is asked for more slows the tool down. Moves by joints, and turns on the
    /// spot, take the time that the joints need.
    #[must_use]
    pub fn inspect(&self, robot: &Robot, limits: &SingularityLimits) -> Vec<Finding> {
        let geometry = OpwGeometry::of(robot);
        let mut findings = Vec::new();
        let mut before: Option<&Move> = None;
        for step in &self.moves {
            let mut found = |joint: usize, kind| {
                findings.push(Finding {
                    path_point: step.path_point,
                    joint: robot.chain.joints[joint].name.clone(),
                    kind,
                });
            };
            for (i, (joint, q)) in robot.chain.joints.iter().zip(&step.posture).enumerate() {
                let beyond = joint.limits.map(|l| (q - l.upper).max(l.lower - q));
                if let Some(excess_rad) = beyond.filter(|by| *by > ROUNDING_RAD) {
                    found(i, FindingKind::OutsideLimits { excess_rad });
                }
            }
            if let Some(geometry) = &geometry
                && let Some((joint, kind)) = too_near(geometry, &step.posture, limits)
            {
                found(joint, kind);
            }
            if let Some(before) = before {
                for one in too_fast(robot, before, step) {
                    found(one.joint, FindingKind::of_speed(&one));
                }
            }
            before = Some(step);
        }
        findings
    }
}

/// The singularity that a posture is nearer to than asked, with its joint.
pub(super) fn too_near(
    geometry: &OpwGeometry,
    posture: &[f64],
    limits: &SingularityLimits,
) -> Option<(usize, FindingKind)> {
    let near = limits.nearest(&geometry.singularity_distance(posture));
    let kind = FindingKind::NearSingularity {
        singularity: near.kind,
        distance: near.distance,
        least: near.least,
    };
    (near.share < 1.0).then_some((near.joint, kind))
}

/// Moves no longer than this turn the tool on the spot, m: a thousandth of what programs tell
/// apart.
pub(super) const ON_THE_SPOT_M: f64 = 1e-9;

/// Joints of which a linear move asks too much.
fn too_fast(robot: &Robot, before: &Move, step: &Move) -> Vec<JointSpeed> {
    let Motion::Linear { speed_m_per_s } = step.motion else {
        return Vec::new();
    };
    let way = step.base_from_tool.translation.vector - before.base_from_tool.translation.vector;
    if way.norm() <= ON_THE_SPOT_M {
        return Vec::new();
    }
    let time_s = way.norm() / speed_m_per_s;
    let speeds = joint_speeds(robot, &before.posture, &step.posture, time_s);
    speeds.filter(JointSpeed::is_too_fast).collect()
}
