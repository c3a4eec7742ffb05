//! A planned path, written into the text of a scenario.

use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, TableLike, Value};

use crate::relocate::find_mut;

use super::path::{Elbow, Shoulder, TurnKnot, Wrist};

/// Postures along a straight path, as a plan chose them.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedPath {
    /// First tool point, in the robot's base frame.
    pub start_m: [f64; 3],
    /// Last tool point.
    pub end_m: [f64; 3],
    /// Direction of the tool's z axis.
    pub tool_axis: [f64; 3],
    /// Direction of the tool's x axis at redundancy angle 0.
    pub zero_direction: [f64; 3],
    /// Redundancy angles; one knot at least.
    pub turn: Vec<TurnKnot>,
    /// Side of the shoulder.
    pub shoulder: Shoulder,
    /// Side of the elbow.
    pub elbow: Elbow,
    /// Sense of the wrist.
    pub wrist: Wrist,
    /// Joint angles at the start, which choose among whole turns.
    pub posture_rad: Vec<f64>,
}

impl PlannedPath {
    /// Writes the path into a scenario: what says where it starts and how the tool stands is replaced.
    pub(crate) fn write(&self, document: &mut DocumentMut) {
        let posture = self.posture_rad.iter().map(|q| rounded(q.to_degrees(), 9));
        let robot = find_mut(document, &["robot"]).and_then(Item::as_table_like_mut);
        if let Some(robot) = robot {
            set(robot, "posture_deg", Value::Array(posture.collect()));
        }
        let item = find_mut(document, &["process", "milling", "path"]);
        if let Some(path) = item.and_then(Item::as_table_like_mut) {
            self.write_path(path);
        }
    }

    fn write_path(&self, path: &mut dyn TableLike) {
        for key in ["direction", "length_mm", "redundancy_deg", "turn"] {
            path.remove(key);
        }
        let millimetres = |p: &[f64; 3]| point(&p.map(|x| rounded(x * 1e3, 9)));
        set(path, "start_mm", millimetres(&self.start_m));
        set(path, "end_mm", millimetres(&self.end_m));
        set(path, "tool_axis", point(&self.tool_axis));
        set(path, "zero_direction", point(&self.zero_direction));
        let shoulder = match self.shoulder {
            Shoulder::Front => "front",
            Shoulder::Rear => "rear",
        };
        let elbow = match self.elbow {
            Elbow::Upper => "upper",
            Elbow::Lower => "lower",
        };
        let wrist = match self.wrist {
            Wrist::Positive => "positive",
            Wrist::Negative => "negative",
        };
        set(path, "shoulder", Value::from(shoulder));
        set(path, "elbow", Value::from(elbow));
        set(path, "wrist", Value::from(wrist));
        if let [only] = &self.turn[..] {
            let angle = rounded(only.redundancy_rad.to_degrees(), 9);
            set(path, "redundancy_deg", Value::from(angle));
            return;
        }
        let mut knots = ArrayOfTables::new();
        for knot in &self.turn {
            let mut table = Table::new();
            let angle = rounded(knot.redundancy_rad.to_degrees(), 9);
            set(
                &mut table,
                "at_mm",
                Value::from(rounded(knot.at_m * 1e3, 9)),
            );
            set(&mut table, "redundancy_deg", Value::from(angle));
            knots.push(table);
        }
        path.insert("turn", Item::ArrayOfTables(knots));
    }
}

/// Sets a value; comments behind an old one stay.
fn set(table: &mut dyn TableLike, key: &str, mut value: Value) {
    let old = table.get(key).and_then(Item::as_value);
    if let Some(old) = old {
        *value.decor_mut() = old.decor().clone();
    }
    table.insert(key, Item::Value(value));
}

fn point(p: &[f64; 3]) -> Value {
    Value::Array(p.iter().copied().collect::<Array>())
}

/// To so many decimals: what is written need not show rounding errors.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale
}
