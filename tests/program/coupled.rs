//! Channels made of several columns, as a user meets them.

use super::diagnose::desk as elbow;
use super::*;

/// The wrist of the example measured in currents of its motors, A: torque 1 is
/// 11.2 i₁ − 0.5 i₂ + 0.3, torque 2 is 7.9 i₂ − 1.7, N m.
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

/// All numbers of an answer, in their order, but those of signals that nothing follows: these come
/// in the order of chances near 1, in which rounding exchanges two.
fn gather(value: &serde_json::Value, found: &mut Vec<f64>) {
    match value {
        serde_json::Value::Number(number) => found.extend(number.as_f64()),
        serde_json::Value::Array(list) => list.iter().for_each(|one| gather(one, found)),
        serde_json::Value::Object(map) => {
            let chance = map.get("p_value").and_then(serde_json::Value::as_f64);
            if chance.is_none_or(|p| p < 0.05) {
                map.values().for_each(|one| gather(one, found));
            }
        }
        _ => {}
    }
}

/// The numbers in a file of a desk.
fn numbers_in(file: &Path) -> Vec<f64> {
    let mut found = Vec::new();
    let text = std::fs::read_to_string(file).unwrap();
    gather(&serde_json::from_str(&text).unwrap(), &mut found);
    found
}

/// All numbers of what `compare` writes.
fn numbers(desk: &Desk, arguments: &[&str]) -> Vec<f64> {
    let name = arguments[0].trim_end_matches(".toml");
    desk.ends(0, &[&["compare"], arguments].concat());
    numbers_in(&desk.path(&format!("out/{name}/compare/compare.json")))
}

/// Whether two lists of numbers are equal to rounding.
fn agree(a: &[f64], b: &[f64]) -> bool {
    let far = |(a, b): &(&f64, &f64)| (*a - *b).abs() > 1e-7 * a.abs().max(b.abs()) + 1e-9;
    let first = a.iter().zip(b).find(far);
    if let Some(pair) = first {
        println!("{pair:?}");
    }
    a.len() == b.len() && first.is_none()
}

#[test]
fn verify_currents_of_a_coupled_wrist_are_compared_as_its_torques() {
    let desk = coupled();
    let torques = numbers(&desk, &["elbow.toml"]);
    let currents = numbers(&desk, &["currents.toml"]);
    assert!(torques.len() > 50);
    assert!(agree(&torques, &currents));
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

#[test]
fn verify_cells_of_a_force_sensor_identify_the_arm_as_its_forces() {
    let desk = Desk::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().unwrap();
    let shipped = root.join("scenarios/identification");
    let text = std::fs::read_to_string(shipped.join("arm.toml")).unwrap();
    let text = text.replace("../../assets", &root.join("assets").display().to_string());
    let text = text.split("[modes]").next().unwrap();
    std::fs::write(desk.path("forces.toml"), text).unwrap();
    let loads = std::fs::read_to_string(shipped.join("loads.csv")).unwrap();
    std::fs::write(desk.path("loads.csv"), &loads).unwrap();
    // Forces are 49.2 c₁ − 0.7 c₂ + 1.5 and 20 c₂, N.
    let mut lines = loads.lines();
    let head = lines.next().unwrap();
    let place = |name: &str| head.split(',').position(|one| one == name).unwrap();
    let [x, y] = ["force_x_n", "force_y_n"].map(place);
    let rows = lines.map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let [fx, fy] = [x, y].map(|at| cells[at].parse::<f64>().unwrap());
        let second = fy / 20.0;
        cells[x] = ((fx - 1.5 + 0.7 * second) / 49.2).to_string();
        cells[y] = second.to_string();
        cells.join(",")
    });
    let renamed = head
        .replace("force_x_n", "cell_1")
        .replace("force_y_n", "cell_2");
    let lines: Vec<String> = std::iter::once(renamed).chain(rows).collect();
    std::fs::write(desk.path("cells.csv"), lines.join("\n")).unwrap();
    let cells = |offset: f64| {
        let sum = format!("sum = {{ cell_1 = 49.2, cell_2 = -0.7 }}, offset = {offset:?}");
        text.replace("loads.csv", "cells.csv")
            .replace("column = \"force_x_n\"", &sum)
            .replace("column = \"force_y_n\"", "sum = { cell_2 = 20.0 }")
    };
    std::fs::write(desk.path("cells.toml"), cells(1.5)).unwrap();
    std::fs::write(desk.path("shifted.toml"), cells(3.0)).unwrap();
    let [forces, cells, shifted] = ["forces", "cells", "shifted"].map(|name| {
        desk.ends(0, &["identify", &format!("{name}.toml")]);
        numbers_in(&desk.path(&format!("out/{name}/stiffness.json")))
    });
    assert!(forces.len() > 50 && agree(&forces, &cells));
    assert!(!agree(&forces, &shifted), "the offset counts");
}

#[test]
fn columns_that_are_added_as_they_are_have_the_unit_that_the_scenario_says() {
    let desk = coupled();
    let text = std::fs::read_to_string(desk.path("currents.toml")).unwrap();
    let text = text.replace(
        "sum = { current_2 = 0.79 }\nscale = 10",
        "sum = { current_2 = -1.0 }",
    );
    std::fs::write(desk.path("currents.toml"), text).unwrap();
    let data = std::fs::read_to_string(desk.path("currents.csv")).unwrap();
    let (head, rows) = data.split_once('\n').unwrap();
    let with_units = format!("{head}\ns,deg,deg,A,A,mm\n{rows}");
    std::fs::write(desk.path("currents.csv"), with_units).unwrap();
    let output = desk.truecut(&["compare", "currents.toml"]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{told}");
    assert!(
        told.contains("the file gives its unit as \"A\", but the scenario as \"N m\""),
        "{told}"
    );
}
