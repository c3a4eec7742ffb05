//! Channels made of several columns, as a user meets them.

use super::diagnose::desk as elbow;
use super::*;

/// The wrist of the example measured in currents of its motors, A: torque 1 is 11.2 i₁ − 0.5 i₂ + 0.3
/// N m, torque 2 is 7.9 i₂ − 1.7 N m.
const TORQUES: [(&str, &str); 2] = [
    (
        "column = \"torque_1_n_m\"",
        "sum = { current_1 = 11.2, current_2 = -0.5 }\noffset = 0.3",
    ),
    (
        "column = \"torque_2_n_m\"",
        "sum = { current_2 = 0.79 }\nscale = 10\noffset = -1.7",
    ),
];

/// The example with currents in place of torques, and a scenario that makes torques of them.
fn coupled() -> Desk {
    let desk = elbow();
    let text = std::fs::read_to_string(desk.path("elbow.csv")).unwrap();
    let mut lines = text.lines();
    let head = lines.next().unwrap();
    let head = head
        .replace("torque_1_n_m", "current_1")
        .replace("torque_2_n_m", "current_2");
    let rows = lines.map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let torque = |place: usize| cells[place].parse::<f64>().unwrap();
        let second = (torque(4) + 1.7) / 7.9;
        let first = (torque(3) - 0.3 + 0.5 * second) / 11.2;
        (cells[3], cells[4]) = (first.to_string(), second.to_string());
        cells.join(",")
    });
    let lines: Vec<String> = std::iter::once(head).chain(rows).collect();
    std::fs::write(desk.path("currents.csv"), lines.join("\n")).unwrap();
    let mut text = std::fs::read_to_string(desk.path("elbow.toml")).unwrap();
    text = text.replace("elbow.csv", "currents.csv");
    for (column, sum) in TORQUES {
        assert!(text.contains(column), "{column}");
        text = text.replace(column, sum);
    }
    std::fs::write(desk.path("currents.toml"), text).unwrap();
    desk
}

/// All numbers of what `compare` writes of the measured channels, in their order.
fn numbers(desk: &Desk, arguments: &[&str]) -> Vec<f64> {
    fn gather(value: &serde_json::Value, found: &mut Vec<f64>) {
        match value {
            serde_json::Value::Number(number) => found.extend(number.as_f64()),
            serde_json::Value::Array(list) => list.iter().for_each(|one| gather(one, found)),
            serde_json::Value::Object(map) => map.values().for_each(|one| gather(one, found)),
            _ => {}
        }
    }
    let arguments = [&["compare"], arguments, &["--out", "compared"]].concat();
    desk.ends(0, &arguments);
    let folder = desk
        .path("compared")
        .join(arguments[1].replace(".toml", ""));
    let text = std::fs::read_to_string(folder.join("compare/compare.json"))
        .or_else(|_| std::fs::read_to_string(desk.path("compared/compare.json")))
        .unwrap();
    let mut found = Vec::new();
    gather(&serde_json::from_str(&text).unwrap(), &mut found);
    found
}

/// Whether two lists of numbers are equal to rounding.
fn agree(a: &[f64], b: &[f64]) -> bool {
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-7 * a.abs().max(b.abs()) + 1e-9;
    a.len() == b.len() && a.iter().zip(b).all(close)
}

#[test]
fn verify_currents_of_a_coupled_wrist_are_compared_as_its_torques() {
    let desk = coupled();
    let torques = numbers(&desk, &["elbow.toml"]);
    let currents = numbers(&desk, &["currents.toml"]);
    assert!(torques.len() > 50, "{torques:?}");
    assert!(agree(&torques, &currents), "{torques:?}\n{currents:?}");
    // Each number of the combination counts.
    for set in [
        "data.channel.2.sum.current_1=11.4",
        "data.channel.2.sum.current_2=-0.7",
        "data.channel.2.offset=0.5",
        "data.channel.3.sum.current_2=0.8",
        "data.channel.3.scale=10.2",
        "data.channel.3.offset=-1.5",
    ] {
        let other = numbers(&desk, &["currents.toml", "--set", set]);
        assert!(!agree(&torques, &other), "{set} changes nothing");
    }
}
