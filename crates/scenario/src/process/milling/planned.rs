//! A planned path, written into the text of a scenario.

use serde_json::Value as Json;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, TableLike, Value};
use truecut_plan::motion::straight::PathStart;

use crate::relocate::find_mut;

/// Postures along a straight path, as a plan chose them.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedPath {
    /// Where it begins and how the tool stands; its branch is given.
    pub start: PathStart,
    /// Last tool point.
    pub end_m: [f64; 3],
    /// Joint angles at the start, which choose among whole turns.
    pub posture_rad: Vec<f64>,
}

impl PlannedPath {
    /// Writes the path into a scenario: what says where it starts and how the tool stands is
    /// replaced.
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
        let PathStart {
            point_m,
            tool_axis,
            zero_direction,
            turn,
            shoulder,
            elbow,
            wrist,
        } = &self.start;
        set(path, "start_mm", millimetres(point_m));
        set(path, "end_mm", millimetres(&self.end_m));
        set(path, "tool_axis", point(tool_axis));
        set(path, "zero_direction", point(zero_direction));
        let names = [
            ("shoulder", serde_json::to_value(shoulder)),
            ("elbow", serde_json::to_value(elbow)),
            ("wrist", serde_json::to_value(wrist)),
        ];
        for (key, name) in names {
            if let Ok(Json::String(name)) = name {
                set(path, key, Value::from(name));
            }
        }
        if let [only] = &turn[..] {
            let angle = rounded(only.redundancy_rad.to_degrees(), 9);
            set(path, "redundancy_deg", Value::from(angle));
            return;
        }
        let mut knots = ArrayOfTables::new();
        for knot in turn {
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
