//! The postures along a straight path of the tool: inverse kinematics on one branch, reach, limits, singularities.

use crate::error::SimError;
use nalgebra::{Isometry3, Translation3, Unit, Vector3};
use truecut_arm::{
    ArmErrorKind, BranchOptions, FrameId, IkOptions, IkSolver, PathOptions, Robot, tool_pose,
};
use truecut_scenario::{Elbow, MillingPathSpec, PathStart, ProcessSpec, Scenario, Shoulder, Wrist};

const PATH: &str = "process.milling.path";
/// Knots of a path lie at most this far apart, m. Cubic interpolation between them errs by less than 1e-9 m on the
/// posture changes of a machining path.
const KNOT_SPACING_M: f64 = 2e-3;
/// Nearest to a wrist or elbow singularity that a path may come, rad: joint speeds are some sixty times as high there.
const LEAST_ANGLE_RAD: f64 = 0.017_453_292_519_943_295;
/// Nearest that the wrist may come to the first axis, m.
const LEAST_SHOULDER_M: f64 = 5e-3;
/// What is nearer to the start than is printed, mm.
const START_MM: f64 = 0.05;

/// How errors name a path and the places on it.
pub(crate) struct Along<'a> {
    /// Key of the scenario that the path is written under.
    pub key: &'a str,
    /// Distance of a knot from the path's start, mm.
    pub at_mm: &'a dyn Fn(usize) -> f64,
}

/// Postures at even distances along a path, the first at its start, the last at its end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SolvedPath {
    pub spacing_m: f64,
    pub knots: Vec<Vec<f64>>,
}

impl SolvedPath {
    /// The path of a scenario whose process has one.
    pub(crate) fn of(
        scenario: &Scenario,
        robot: &Robot,
        posture: &[f64],
    ) -> Result<Option<Self>, SimError> {
        let ProcessSpec::Milling(milling) = &scenario.process else {
            return Ok(None);
        };
        Self::solve(&milling.path, robot, posture).map(Some)
    }

    /// Solves the postures of a path. `posture` is where the robot stands (a path without a start), or what the first posture is
    /// to be near.
    pub(crate) fn solve(
        spec: &MillingPathSpec,
        robot: &Robot,
        posture: &[f64],
    ) -> Result<Self, SimError> {
        let intervals = (spec.length_m / KNOT_SPACING_M).ceil().max(3.0);
        let spacing_m = spec.length_m / intervals;
        let poses = poses(spec, robot, posture, spacing_m, intervals as usize + 1)?;
        let along = Along {
            key: PATH,
            at_mm: &|k| spacing_m * k as f64 * 1e3,
        };
        let solver = robot.ik_solver(&BranchOptions::default());
        let knots = if solver.geometry().is_some() {
            on_a_branch(spec, &solver, &poses, posture, &along)?
        } else {
            near_the_posture(spec, robot, &poses, posture, &along)?
        };
        check_singularities(&solver, &knots, &along)?;
        Ok(Self { spacing_m, knots })
    }
}

/// Poses of the tool at the knots, world.
fn poses(
    spec: &MillingPathSpec,
    robot: &Robot,
    posture: &[f64],
    spacing_m: f64,
    count: usize,
) -> Result<Vec<Isometry3<f64>>, SimError> {
    let direction = Vector3::from(spec.direction);
    let here = robot.world_from_frame(posture, FrameId::Tool);
    (0..count)
        .map(|k| {
            let at_m = spacing_m * k as f64;
            let Some(start) = &spec.start else {
                return Ok(Translation3::from(direction * at_m) * here);
            };
            let point = Vector3::from(start.point_m) + direction * at_m;
            let axis = Unit::new_normalize(Vector3::from(start.tool_axis));
            let zero = Vector3::from(start.zero_direction);
            Ok(tool_pose(&point, &axis, &zero, start.redundancy_rad(at_m))?)
        })
        .collect()
}

/// All branches of an arm with a closed form: the start nearest to `posture` from which the path can be followed to its
/// end.
fn on_a_branch(
    spec: &MillingPathSpec,
    solver: &IkSolver<'_>,
    poses: &[Isometry3<f64>],
    posture: &[f64],
    along: &Along<'_>,
) -> Result<Vec<Vec<f64>>, SimError> {
    let follow =
        |start: &[f64]| solver.follow(poses, FrameId::Tool, start, &PathOptions::default());
    let Some(asked) = &spec.start else {
        return follow(posture).map_err(|error| leaves(error.kind(), along).1);
    };
    let mut starts = solver.within_limits(&poses[0], FrameId::Tool);
    if starts.is_empty() {
        // Following from anywhere says why.
        return follow(posture).map_err(|error| leaves(error.kind(), along).1);
    }
    let reached = starts.len();
    starts.retain(|q| is_of_branch(solver, asked, q));
    if starts.is_empty() {
        return Err(SimError::scenario(
            PATH,
            format!(
                "{reached} postures reach the start within the joint limits, but none with the shoulder, elbow and wrist \
                 asked for"
            ),
        ));
    }
    let distance = |q: &[f64]| {
        q.iter()
            .zip(posture)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
    };
    starts.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    let mut furthest: Option<(usize, SimError)> = None;
    for start in &starts {
        match follow(start) {
            Ok(knots) => return Ok(knots),
            Err(error) => {
                let (index, error) = leaves(error.kind(), along);
                if furthest.as_ref().is_none_or(|(best, _)| index > *best) {
                    furthest = Some((index, error));
                }
            }
        }
    }
    Err(furthest.map_or_else(
        || SimError::scenario(PATH, "no posture reaches the start"),
        |(_, error)| error,
    ))
}

fn is_of_branch(solver: &IkSolver<'_>, asked: &PathStart, q: &[f64]) -> bool {
    let Some(branch) = solver.geometry().map(|geometry| geometry.branch(q)) else {
        return false;
    };
    let shoulder = asked
        .shoulder
        .is_none_or(|side| (side == Shoulder::Rear) == branch.rear_shoulder);
    let elbow = asked
        .elbow
        .is_none_or(|side| (side == Elbow::Lower) == branch.lower_elbow);
    let wrist = asked
        .wrist
        .is_none_or(|sense| (sense == Wrist::Negative) == branch.flipped_wrist);
    shoulder && elbow && wrist
}

/// Arms without a closed form: from posture to posture.
fn near_the_posture(
    spec: &MillingPathSpec,
    robot: &Robot,
    poses: &[Isometry3<f64>],
    posture: &[f64],
    along: &Along<'_>,
) -> Result<Vec<Vec<f64>>, SimError> {
    if let Some(start) = &spec.start {
        let given = [
            ("shoulder", start.shoulder.is_some()),
            ("elbow", start.elbow.is_some()),
            ("wrist", start.wrist.is_some()),
        ];
        if let Some((key, _)) = given.into_iter().find(|(_, given)| *given) {
            return Err(SimError::scenario(
                format!("{PATH}.{key}"),
                format!(
                    "`{PATH}.{key}` has no effect: {} is no arm of six joints with a spherical wrist",
                    robot.name
                ),
            ));
        }
    }
    let mut seed = posture.to_vec();
    let mut knots = Vec::with_capacity(poses.len());
    for (k, pose) in poses.iter().enumerate() {
        seed = robot
            .inverse_kinematics(pose, FrameId::Tool, &seed, &IkOptions::default())
            .map_err(|error| {
                let begins = cannot_follow((along.at_mm)(k));
                SimError::scenario(along.key, format!("{begins}: {error}"))
            })?;
        knots.push(seed.clone());
    }
    Ok(knots)
}

fn cannot_follow(at_mm: f64) -> String {
    if at_mm < START_MM {
        "the tool cannot be put to the start of the path".to_owned()
    } else {
        format!("the tool cannot follow the path beyond {at_mm:.1} mm from its start")
    }
}

/// At which knot the path cannot be followed, and why.
pub(crate) fn leaves(kind: &ArmErrorKind, along: &Along<'_>) -> (usize, SimError) {
    let (index, message) = match kind {
        ArmErrorKind::OnPath { index, source } => (
            *index,
            format!("{}: {source}", cannot_follow((along.at_mm)(*index))),
        ),
        ArmErrorKind::PathBreaks {
            index,
            joint,
            jump_rad,
            limit_rad,
        } => (
            *index,
            format!(
                "{}: joint `{joint}` would have to turn by {jump_rad:.3} rad within {:.1} mm, more than {limit_rad} rad: a \
                 singularity, or another branch",
                cannot_follow((along.at_mm)(*index)),
                (along.at_mm)(*index) - (along.at_mm)(index.saturating_sub(1))
            ),
        ),
        other => (0, other.to_string()),
    };
    (index, SimError::scenario(along.key, message))
}

pub(crate) fn check_singularities(
    solver: &IkSolver<'_>,
    knots: &[Vec<f64>],
    along: &Along<'_>,
) -> Result<(), SimError> {
    let Some(geometry) = solver.geometry() else {
        return Ok(());
    };
    let nearest = |of: &dyn Fn(usize) -> f64| {
        let all = (0..knots.len()).map(|k| (k, of(k)));
        all.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let distance = |k: usize| geometry.singularity_distance(&knots[k]);
    let deg = |rad: f64| format!("{:.3} degrees", rad.to_degrees());
    let millimetres = |m: f64| format!("{:.3} mm", m * 1e3);
    type Distance<'a> = (
        &'a str,
        &'a dyn Fn(usize) -> f64,
        f64,
        &'a dyn Fn(f64) -> String,
    );
    let kinds: [Distance<'_>; 3] = [
        (
            "wrist singularity (axes 4 and 6 in line)",
            &|k| distance(k).wrist_rad,
            LEAST_ANGLE_RAD,
            &deg,
        ),
        (
            "elbow singularity (arm stretched or folded)",
            &|k| distance(k).elbow_rad,
            LEAST_ANGLE_RAD,
            &deg,
        ),
        (
            "shoulder singularity (wrist over the first axis)",
            &|k| distance(k).shoulder_m,
            LEAST_SHOULDER_M,
            &millimetres,
        ),
    ];
    for (name, of, least, show) in kinds {
        if let Some((k, near)) = nearest(of)
            && near < least
        {
            return Err(SimError::scenario(
                along.key,
                format!(
                    "the path comes within {} of a {name} {:.1} mm from its start, but must stay {} away: joint speeds have \
                     no bound there",
                    show(near),
                    (along.at_mm)(k),
                    show(least)
                ),
            ));
        }
    }
    Ok(())
}
