//! What each joint of the arm may do in a planned motion.

use truecut_plan::motion::excitation::{
    JointRange, JointSeries, SampledMotion, SeriesSpace, scaled,
};
use truecut_scenario::{ExciteSpec, JointLimits, Scenario};
use truecut_sim::facts::robot_facts;
use truecut_sim::{PlannedArm, SimError};

use super::report::JointUse;

/// Limits of all joints, each already the share that may be used.
pub(super) struct Limits {
    pub arm: PlannedArm,
    pub ranges: Vec<JointRange>,
    /// Of drive torques and forces; infinite where there is none.
    pub efforts: Vec<f64>,
    /// Part of the machine's own limits that they are.
    share: f64,
}

/// Halvings of the interval in which the largest motion within drive limits is looked for.
const HALVINGS: usize = 8;

impl Limits {
    /// Those of the robot's files and of `[excite]`, the tighter of both.
    ///
    /// # Errors
    /// A joint without a range, a speed, or both an acceleration and a drive limit; limits of a
    /// joint that the chain lacks, or in units of the other kind of joint.
    pub fn new(scenario: &Scenario) -> Result<Limits, SimError> {
        let spec = &scenario.excite;
        let arm = PlannedArm::new(scenario)?;
        let facts = robot_facts(scenario)?;
        let count = facts.joints.len();
        for (index, own) in spec.joints.iter().enumerate() {
            let key = format!("excite.joint.{index}.joint");
            let number = own.joint + 1;
            let Some(fact) = facts.joints.get(own.joint) else {
                let message = format!("`{key}` is {number}, but the chain has {count} joints");
                return Err(SimError::scenario(key, message));
            };
            if own.rotary.is_some_and(|rotary| rotary != fact.rotary) {
                let kind = if fact.rotary { "rotary" } else { "prismatic" };
                let message = format!("`{key}` is {number}, a {kind} joint, which has other keys");
                return Err(SimError::scenario(key, message));
            }
        }
        let joints = (0..count).map(|joint| bounds(spec, &arm, joint));
        let (ranges, efforts) = joints.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        Ok(Limits {
            arm,
            ranges,
            efforts,
            share: spec.limit_share,
        })
    }

    /// Largest part of its limit that a drive gives.
    pub fn effort(&self, motion: &SampledMotion) -> f64 {
        let drives = self.arm.drive_forces(motion);
        let each = drives.iter().zip(&self.efforts);
        each.flat_map(|(drive, limit)| drive.iter().map(move |force| force.abs() / limit))
            .fold(0.0, f64::max)
    }

    /// The motion, or as large a part of it about the middle of its way as the drives can give;
    /// where they cannot even hold the arm there, by how much they lack.
    pub fn within(
        &self,
        space: &SeriesSpace,
        series: Vec<JointSeries>,
    ) -> Result<(Vec<JointSeries>, SampledMotion), f64> {
        let at = |factor: f64| {
            let series = scaled(&series, factor);
            let motion = space.sampled(&series);
            (self.effort(&motion), series, motion)
        };
        let (effort, whole, motion) = at(1.0);
        if effort <= 1.0 {
            return Ok((whole, motion));
        }
        let (held, mut kept, mut motion) = at(0.0);
        if held >= 1.0 {
            return Err(held);
        }
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match at(middle) {
                (effort, series, sampled) if effort <= 1.0 => {
                    (low, kept, motion) = (middle, series, sampled);
                }
                _ => high = middle,
            }
        }
        match low > 0.0 {
            true => Ok((kept, motion)),
            // An arm at rest shows nothing.
            false => Err(effort),
        }
    }
}

/// Range and drive limit of a joint.
fn bounds(
    spec: &ExciteSpec,
    arm: &PlannedArm,
    joint: usize,
) -> Result<(JointRange, f64), SimError> {
    let own = spec.joints.iter().find(|own| own.joint == joint);
    let own = own.copied().unwrap_or(JointLimits {
        joint,
        ..JointLimits::default()
    });
    let (known, of_drive) = arm.bounds(joint);
    let infinite = f64::INFINITY;
    let least = |own: Option<f64>, file: f64| own.unwrap_or(infinite).min(file);
    let range = JointRange {
        lower: own.lower.unwrap_or(-infinite).max(known.lower),
        upper: least(own.upper, known.upper),
        speed: least(own.speed, known.speed),
        acceleration: own.acceleration.unwrap_or(infinite),
    };
    let effort = least(own.effort, of_drive);
    check(joint, arm.joint(joint), &range, effort)?;
    let share = spec.limit_share;
    let [middle, half] = [0.5, 0.5 * share].map(|part| part * (range.upper - range.lower));
    Ok((
        JointRange {
            lower: range.lower + middle - half,
            upper: range.lower + middle + half,
            speed: share * range.speed,
            acceleration: share * range.acceleration,
        },
        share * effort,
    ))
}

/// Refuses a joint that may do anything, or nothing.
fn check(
    joint: usize,
    (name, unit): (&str, &str),
    range: &JointRange,
    effort: f64,
) -> Result<(), SimError> {
    let number = joint + 1;
    let missing = |what: &str, rotary: &str, prismatic: &str| {
        let keys = if unit == "rad" { rotary } else { prismatic };
        let message = format!(
            "joint {number} `{name}` has no limit of its {what}, neither in the robot's files nor here: give {keys} in an \
             [[excite.joint]]"
        );
        Err(SimError::scenario("excite.joint", message))
    };
    let (lower, upper) = (range.lower, range.upper);
    if !(lower.is_finite() && upper.is_finite()) {
        let (rotary, prismatic) = ("lower_deg and upper_deg", "lower_mm and upper_mm");
        return missing("range", rotary, prismatic);
    }
    let zero = [
        ("speed", range.speed),
        ("acceleration", range.acceleration),
        ("drive", effort),
    ];
    if let Some((what, _)) = zero.iter().find(|(_, limit)| *limit <= 0.0) {
        let message = format!(
            "joint {number} `{name}` has a {what} limit of 0: it cannot move; a placeholder in the robot's files?"
        );
        return Err(SimError::scenario("excite.joint", message));
    }
    if lower >= upper {
        let message = format!(
            "joint {number} `{name}` may go from {lower:.4} to {upper:.4} {unit} only: nothing lies between"
        );
        return Err(SimError::scenario("excite.joint", message));
    }
    if range.speed.is_infinite() {
        return missing("speed", "speed_deg_per_s", "speed_mm_per_s");
    }
    if range.acceleration.is_infinite() && effort.is_infinite() {
        return missing(
            "acceleration or drive",
            "acceleration_deg_per_s2 or torque_n_m",
            "acceleration_m_per_s2 or force_n",
        );
    }
    Ok(())
}

impl Limits {
    /// What a motion takes of them.
    pub fn used(&self, motion: &SampledMotion) -> Vec<JointUse> {
        let drives = self.arm.drive_forces(motion);
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let joint = |(index, range): (usize, &JointRange)| {
            let (name, unit) = self.arm.joint(index);
            let place = &motion.position[index];
            let speed = largest(&motion.velocity[index]);
            let acceleration = largest(&motion.acceleration[index]);
            let effort = largest(&drives[index]);
            JointUse {
                joint: name.to_owned(),
                unit,
                range: [
                    place.iter().copied().fold(f64::INFINITY, f64::min),
                    place.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                ],
                speed,
                speed_share: self.share * speed / range.speed,
                acceleration,
                acceleration_share: self.share * acceleration / range.acceleration,
                effort,
                effort_share: self.share * effort / self.efforts[index],
            }
        };
        self.ranges.iter().enumerate().map(joint).collect()
    }
}
