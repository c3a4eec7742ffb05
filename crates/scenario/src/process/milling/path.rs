//! The `[process.milling.path]` table: a straight line, and how the tool stands along it.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_arm::{Elbow, Shoulder, Wrist};
use truecut_plan::motion::straight::{PathStart, StraightPath, TurnKnot};

use crate::check::Check;
use crate::units::{from_deg, from_mm};

/// A straight line, and how the tool stands along it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PathTable {
    /// First tool point, in the robot's base frame. Default: the tool point at the robot's posture.
    start_mm: Option<[f64; 3]>,
    /// Last tool point; or give direction and length_mm.
    end_mm: Option<[f64; 3]>,
    /// Direction of the line, of any length.
    direction: Option<[f64; 3]>,
    /// Length of the line.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a path has a length"))]
    length_mm: Option<f64>,
    /// Direction of the tool's z axis, of any length (with start_mm). Default: [0, 0, -1], down.
    tool_axis: Option<[f64; 3]>,
    /// Direction of the tool's x axis at redundancy angle 0 (with start_mm). Default: [1, 0, 0].
    zero_direction: Option<[f64; 3]>,
    /// Redundancy angle: the tool turned about its axis, counted from above, anticlockwise, with
    /// the tool down (with start_mm).
    redundancy_deg: Option<f64>,
    /// Redundancy angles along the path, instead of one (with start_mm).
    #[schemars(extend("minItems" = 2))]
    turn: Option<Vec<TurnTable>>,
    /// Side of the shoulder (with start_mm). Default: that of the posture nearest to the robot's.
    shoulder: Option<Shoulder>,
    /// Side of the elbow (with start_mm). Default: that of the posture nearest to the robot's.
    elbow: Option<Elbow>,
    /// Sense of the wrist (with start_mm). Default: that of the posture nearest to the robot's.
    wrist: Option<Wrist>,
}

/// Redundancy angle at a distance from the start.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TurnTable {
    /// Distance from the start of the path.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "the path begins at 0"))]
    at_mm: f64,
    /// Redundancy angle there.
    redundancy_deg: f64,
}

const TABLE: &str = "process.milling.path";

/// Largest cosine between feed and tool axis: teeth cut sideways.
const LARGEST_COSINE: f64 = 1e-6;

impl PathTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(self, check: &mut Check) -> Option<StraightPath> {
        let (direction, length_m) = self.line(check)?;
        if self.start_mm.is_none() {
            let because = "the path starts at the robot's posture, and start_mm is not given";
            let keys = [
                "tool_axis",
                "zero_direction",
                "redundancy_deg",
                "turn",
                "shoulder",
                "elbow",
                "wrist",
            ];
            check.ignored(TABLE, &keys, because);
            return Some(StraightPath {
                start: None,
                direction,
                length_m,
            });
        }
        let mut unit = |key, given| check.direction(&format!("{TABLE}.{key}"), given);
        let tool_axis = unit("tool_axis", self.tool_axis.unwrap_or([0.0, 0.0, -1.0]))?;
        let zero = self.zero_direction.unwrap_or([1.0, 0.0, 0.0]);
        let zero_direction = unit("zero_direction", zero)?;
        self.check_square(&direction, &tool_axis, &zero_direction, check)?;
        let turn = self.turn(length_m, check)?;
        Some(StraightPath {
            start: Some(PathStart {
                point_m: self.start_mm?.map(from_mm),
                tool_axis,
                zero_direction,
                turn,
                shoulder: self.shoulder,
                elbow: self.elbow,
                wrist: self.wrist,
            }),
            direction,
            length_m,
        })
    }

    /// Direction and length of the line.
    fn line(&self, check: &mut Check) -> Option<([f64; 3], f64)> {
        let Some(end) = self.end_mm else {
            let who = "a path without end_mm";
            let direction = check.needed(TABLE, "direction", self.direction, who);
            let length_mm = check.needed(TABLE, "length_mm", self.length_mm, who);
            let direction = check.direction(&format!("{TABLE}.direction"), direction?)?;
            return Some((direction, from_mm(length_mm?)));
        };
        let because = "end_mm already says where the path ends";
        check.ignored(TABLE, &["direction", "length_mm"], because);
        let start = check.needed(TABLE, "start_mm", self.start_mm, "a path with end_mm")?;
        let along: [f64; 3] = std::array::from_fn(|i| from_mm(end[i] - start[i]));
        let length_m = norm(&along);
        if length_m == 0.0 {
            let message = "is where the path starts: it has no length";
            check.wrong(TABLE, "end_mm", message, "no path");
            return None;
        }
        Some((along.map(|x| x / length_m), length_m))
    }

    fn check_square(
        &self,
        direction: &[f64; 3],
        tool_axis: &[f64; 3],
        zero_direction: &[f64; 3],
        check: &mut Check,
    ) -> Option<()> {
        let cosine = dot(direction, tool_axis);
        if cosine.abs() > LARGEST_COSINE {
            let key = if self.end_mm.is_some() {
                "end_mm"
            } else {
                "direction"
            };
            let message = format!(
                "leads {:.4} degrees out of the plane across the tool axis, but must lie in it: an end mill is \
                 fed sideways",
                cosine.asin().to_degrees().abs()
            );
            check.wrong(TABLE, key, message, "along the tool axis");
            return None;
        }
        if dot(zero_direction, tool_axis).abs() > 1.0 - 1e-9 {
            let message =
                "is along the tool axis, but must lie across it: redundancy angles count from it";
            check.wrong(TABLE, "zero_direction", message, "along the tool axis");
            return None;
        }
        Some(())
    }

    fn turn(&self, length_m: f64, check: &mut Check) -> Option<Vec<TurnKnot>> {
        let Some(turn) = &self.turn else {
            let who = "a path with start_mm";
            let angle = check.needed(TABLE, "redundancy_deg", self.redundancy_deg, who)?;
            return Some(vec![TurnKnot {
                at_m: 0.0,
                redundancy_rad: from_deg(angle),
            }]);
        };
        let because = "[[process.milling.path.turn]] already gives the angles";
        check.ignored(TABLE, &["redundancy_deg"], because);
        let knots: Vec<TurnKnot> = (turn.iter())
            .map(|knot| TurnKnot {
                at_m: from_mm(knot.at_mm),
                redundancy_rad: from_deg(knot.redundancy_deg),
            })
            .collect();
        for (index, pair) in knots.windows(2).enumerate() {
            if pair[0].at_m >= pair[1].at_m {
                let message = format!(
                    "is {}, but must be greater than the one before it, {}",
                    pair[1].at_m * 1e3,
                    pair[0].at_m * 1e3
                );
                let table = format!("{TABLE}.turn.{}", index + 1);
                check.wrong(&table, "at_mm", message, "distances must rise");
                return None;
            }
        }
        let beyond = knots
            .iter()
            .position(|knot| knot.at_m > length_m * (1.0 + 1e-9));
        if let Some(index) = beyond {
            let message = format!(
                "is {}, but must be at most the path's length of {} mm",
                knots[index].at_m * 1e3,
                length_m * 1e3
            );
            let table = format!("{TABLE}.turn.{index}");
            check.wrong(&table, "at_mm", message, "behind the path's end");
            return None;
        }
        Some(knots)
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
