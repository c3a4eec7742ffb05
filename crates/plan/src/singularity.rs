//! Distances from singularities that are asked of postures.

use truecut_arm::SingularityDistance;

/// How far postures must stay from singularities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingularityLimits {
    pub wrist_rad: f64,
    pub elbow_rad: f64,
    pub shoulder_m: f64,
}

/// The singularity that a posture is nearest to, in shares of the distance asked.
pub(crate) struct Near {
    pub kind: &'static str,
    /// The joint that the singularity is of.
    pub joint: usize,
    pub share: f64,
    pub distance: String,
    pub least: String,
}

impl Default for SingularityLimits {
    /// 5° and 50 mm: at 5° from a wrist singularity joints 4 and 6 turn eleven times as fast as the
    /// tool.
    fn default() -> Self {
        Self {
            wrist_rad: 5_f64.to_radians(),
            elbow_rad: 5_f64.to_radians(),
            shoulder_m: 0.05,
        }
    }
}

impl SingularityLimits {
    /// Whether a posture at this distance stays away from all of them.
    pub(crate) fn allow(&self, distance: &SingularityDistance) -> bool {
        distance.wrist_rad >= self.wrist_rad
            && distance.elbow_rad >= self.elbow_rad
            && distance.shoulder_m >= self.shoulder_m
    }

    /// The singularity that a posture at this distance is nearest to.
    pub(crate) fn nearest(&self, distance: &SingularityDistance) -> Near {
        let angle = |rad: f64| format!("{:.2} deg", rad.to_degrees());
        let length = |m: f64| format!("{:.1} mm", m * 1e3);
        let near = |kind, joint, has: f64, least: f64, text: &dyn Fn(f64) -> String| Near {
            kind,
            joint,
            // A limit of zero asks nothing.
            share: if least > 0.0 {
                has / least
            } else {
                f64::INFINITY
            },
            distance: text(has),
            least: text(least),
        };
        let wrist = near("wrist", 4, distance.wrist_rad, self.wrist_rad, &angle);
        let elbow = near("elbow", 2, distance.elbow_rad, self.elbow_rad, &angle);
        let shoulder = near("shoulder", 0, distance.shoulder_m, self.shoulder_m, &length);
        let least = if elbow.share < wrist.share {
            elbow
        } else {
            wrist
        };
        if shoulder.share < least.share {
            shoulder
        } else {
            least
        }
    }
}
