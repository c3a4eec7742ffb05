//! Columns of robots' own recordings, by the names that their makers give them.
//!
//! RTDE of Universal Robots: fields and units of its guide (Universal Robots, *Real-Time Data
//! Exchange (RTDE) Guide*, "Robot controller outputs"), of which the client library writes each
//! element as a column, `actual_q_0` to `actual_q_5`. KUKA.RobotSensorInterface: the keywords of
//! its telegrams, `AIPos.A1`; their units are the reader's.

use truecut_recording::UserUnit;
use truecut_recording::measured::TableFacts;

/// The elements of a field of RTDE.
enum Elements {
    /// One a joint: unit, and the joint's channel that it is.
    Joints(&'static str, Option<&'static str>),
    /// Three along and three about the axes of the base: units, and the channel of the first.
    Spatial([&'static str; 2], Option<&'static str>),
    /// Three along axes: unit.
    Axes(&'static str),
    /// A number: unit.
    One(&'static str),
}

use Elements::{Axes, Joints, One, Spatial};

const RTDE: [(&str, Elements); 24] = [
    ("target_q", Joints("rad", Some("command"))),
    ("target_qd", Joints("rad/s", None)),
    ("target_qdd", Joints("rad/s^2", None)),
    ("target_current", Joints("A", None)),
    ("target_moment", Joints("N m", None)),
    ("actual_q", Joints("rad", Some("angle"))),
    ("actual_qd", Joints("rad/s", Some("velocity"))),
    ("actual_qdd", Joints("rad/s^2", None)),
    ("actual_current", Joints("A", None)),
    ("actual_current_window", Joints("A", None)),
    ("joint_control_output", Joints("A", None)),
    (
        "actual_TCP_pose",
        Spatial(["m", "rad"], Some("tool.position")),
    ),
    ("actual_TCP_speed", Spatial(["m/s", "rad/s"], None)),
    (
        "actual_TCP_force",
        Spatial(["N", "N m"], Some("tool.force")),
    ),
    ("target_TCP_pose", Spatial(["m", "rad"], None)),
    ("target_TCP_speed", Spatial(["m/s", "rad/s"], None)),
    ("ft_raw_wrench", Spatial(["N", "N m"], None)),
    ("actual_tool_accelerometer", Axes("m/s^2")),
    ("elbow_position", Axes("m")),
    ("elbow_velocity", Axes("m/s")),
    ("payload_cog", Axes("m")),
    ("payload", One("kg")),
    ("actual_robot_current", One("A")),
    ("timestamp", One("s")),
];

/// The field of a column, and which of its elements.
fn rtde(name: &str) -> Option<(&'static Elements, usize)> {
    RTDE.iter().find_map(|(field, elements)| {
        let index = match (elements, name.strip_prefix(field)?) {
            (One(_), "") => 0,
            (One(_), _) => return None,
            (_, rest) => rest.strip_prefix('_')?.parse().ok()?,
        };
        let count = match elements {
            Joints(..) | Spatial(..) => 6,
            Axes(_) => 3,
            One(_) => 1,
        };
        (index < count).then_some((elements, index))
    })
}

/// Units of the columns of a recording of RTDE, which files of it do not say. It is one if it has
/// all six elements of a field.
pub(super) fn say_units(facts: &mut TableFacts) {
    let names: Vec<&str> = facts.columns.iter().map(|one| one.name.as_str()).collect();
    let is_whole = |field: &str| (0..6).all(|k| names.contains(&&*format!("{field}_{k}")));
    if !RTDE.iter().any(|(field, _)| is_whole(field)) {
        return;
    }
    for column in &mut facts.columns {
        let found = rtde(&column.name).filter(|_| column.unit.is_none());
        column.unit = column.unit.take().or_else(|| {
            let (elements, index) = found?;
            let unit = match elements {
                Joints(unit, _) | Axes(unit) | One(unit) => unit,
                Spatial(units, _) => units[index / 3],
            };
            Some((*unit).to_owned())
        });
    }
    if let Some(time) = &mut facts.time
        && time.base.0 == "timestamp"
        && time.guessed.is_some()
        && UserUnit::parse("s").is_ok_and(|second| second == time.base.1)
    {
        time.guessed = None;
    }
    let note = "a recording of RTDE (Universal Robots): units and channels are those of its fields";
    facts.notes.push(note.to_owned());
}

/// Elements of the telegrams of RSI.
const RSI: [&str; 9] = [
    "RIst", "RSol", "AIPos", "ASPos", "EIPos", "ESPos", "MACur", "RKorr", "AKorr",
];

/// Whether a column is one of these recordings, so that nothing else is to be read into its name.
pub(super) fn knows(name: &str) -> bool {
    let is_rsi = |element: &str| RSI.contains(&element);
    rtde(name).is_some() || name.split_once('.').is_some_and(|(one, _)| is_rsi(one))
}

/// The simulation's channel that a column of these recordings is.
pub(super) fn channel(name: &str) -> Option<String> {
    if let Some((elements, index)) = rtde(name) {
        return match elements {
            Joints(_, Some(quantity)) => Some(format!("joint{}.{quantity}", index + 1)),
            Spatial(_, Some(first)) if index < 3 => {
                Some(format!("{first}_{}", ["x", "y", "z"][index]))
            }
            _ => None,
        };
    }
    let (element, attribute) = name.split_once('.')?;
    let joint = || {
        let number: u32 = attribute.strip_prefix('A')?.parse().ok()?;
        (1..=9).contains(&number).then_some(number)
    };
    match (element, attribute) {
        ("RIst", "X" | "Y" | "Z") => {
            Some(format!("tool.position_{}", attribute.to_ascii_lowercase()))
        }
        ("AIPos", _) => Some(format!("joint{}.angle", joint()?)),
        ("ASPos", _) => Some(format!("joint{}.command", joint()?)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_makers_names_are_known() {
        let is = |name: &str, found: Option<&str>| assert_eq!(channel(name).as_deref(), found);
        is("actual_q_0", Some("joint1.angle"));
        is("target_q_5", Some("joint6.command"));
        is("actual_q_6", None);
        is("actual_TCP_force_2", Some("tool.force_z"));
        is("actual_TCP_force_3", None);
        is("AIPos.A6", Some("joint6.angle"));
        is("ASPos.A1", Some("joint1.command"));
        is("RIst.Y", Some("tool.position_y"));
        is("RIst.A", None);
        is("MACur.A1", None);
        assert!(knows("MACur.A1") && knows("actual_TCP_pose_3") && !knows("joint_3"));
        assert!(RTDE.iter().all(|(_, elements)| {
            let units = match elements {
                Joints(unit, _) | Axes(unit) | One(unit) => vec![*unit],
                Spatial(units, _) => units.to_vec(),
            };
            units.iter().all(|unit| UserUnit::parse(unit).is_ok())
        }));
    }
}
