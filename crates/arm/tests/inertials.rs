//! Inertias and centres of mass in other units than kg m² and m, of arms drawn at random.

use std::fmt::Write;
use std::path::Path;

use proptest::prelude::*;
use truecut_arm::{ArmError, Robot};

/// A link that is a bar along x from its joint to the next.
#[derive(Debug, Clone)]
struct Bar {
    length_m: f64,
    /// Across over along.
    slender: f64,
    density_kg_per_m3: f64,
}

impl Bar {
    fn mass_kg(&self) -> f64 {
        self.density_kg_per_m3 * self.length_m.powi(3) * self.slender.powi(2)
    }

    /// About its centre, along x and across.
    fn inertia_kg_m2(&self) -> [f64; 2] {
        let across = (self.slender * self.length_m).powi(2);
        [2.0 * across, self.length_m.powi(2) + across].map(|square| self.mass_kg() * square / 12.0)
    }
}

/// In what the file's numbers are.
#[derive(Debug, Clone, Copy)]
struct Units {
    inertia_kg_m2: f64,
    center_m: f64,
}

const SI: Units = Units {
    inertia_kg_m2: 1.0,
    center_m: 1.0,
};

fn urdf(bars: &[Bar], units: Units) -> String {
    let mut text = "<robot name=\"drawn\">\n<link name=\"l0\"/>\n".to_owned();
    for (i, bar) in bars.iter().enumerate() {
        let next = i + 1;
        let [along, across] = bar.inertia_kg_m2().map(|own| own / units.inertia_kg_m2);
        let (mass, center) = (bar.mass_kg(), 0.5 * bar.length_m / units.center_m);
        let offset = if i == 0 { 0.0 } else { bars[i - 1].length_m };
        let axis = if i % 2 == 0 { "0 0 1" } else { "0 1 0" };
        writeln!(
            text,
            "<link name=\"l{next}\"><inertial><origin xyz=\"{center} 0 0\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{along}\" iyy=\"{across}\" izz=\"{across}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>\
             </inertial></link>\n\
             <joint name=\"j{next}\" type=\"revolute\"><parent link=\"l{i}\"/><child link=\"l{next}\"/>\
             <origin xyz=\"{offset} 0 0\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-2\" upper=\"2\" velocity=\"3\" effort=\"500\"/></joint>"
        )
        .unwrap();
    }
    let (last, end) = (bars.len(), bars[bars.len() - 1].length_m);
    text + &format!(
        "<link name=\"tool0\"/><joint name=\"end\" type=\"fixed\"><parent link=\"l{last}\"/><child link=\"tool0\"/>\
         <origin xyz=\"{end} 0 0\"/></joint>\n</robot>\n"
    )
}

fn read(text: &str, config: Option<&str>) -> Result<Robot, ArmError> {
    let config = config.map(|text| (text, Path::new("robot.toml")));
    Robot::from_texts((text, Path::new("drawn.urdf")), config, None)
}

fn arms() -> impl Strategy<Value = Vec<Bar>> {
    let bar = (0.05..0.9_f64, 0.1..0.6_f64, 300.0..8000.0_f64);
    let bar = bar.prop_map(|(length_m, slender, density_kg_per_m3)| Bar {
        length_m,
        slender,
        density_kg_per_m3,
    });
    prop::collection::vec(bar, 4..=7)
}

/// Unit of a file, its name, and what the message is to say.
const OTHERS: [(Units, &str, &str); 3] = [
    (
        Units {
            inertia_kg_m2: 1e-6,
            ..SI
        },
        "in kg mm^2 it were",
        "the whole arm is long",
    ),
    (
        Units {
            inertia_kg_m2: 1e-4,
            ..SI
        },
        "in kg cm^2 it were",
        "the whole arm is long",
    ),
    (
        Units {
            center_m: 1e-3,
            ..SI
        },
        "in mm it were",
        "the centre of mass is",
    ),
];

proptest! {
    #[test]
    fn bars_are_believed_and_told_in_other_units(bars in arms()) {
        let robot = read(&urdf(&bars, SI), None).unwrap();
        let doubts = robot.chain.notes.iter().filter(|note| note.contains("gyration"));
        prop_assert_eq!(doubts.count(), 0, "{:?}", robot.chain.notes);
        let dense = Units { inertia_kg_m2: 1e3, ..SI };
        let dense = read(&urdf(&bars, dense), None).unwrap();
        let told = |note: &String| note.contains("of osmium") && note.contains("in t m^2 it were");
        prop_assert!(dense.chain.notes.iter().any(told), "{:?}", dense.chain.notes);
        for (units, unit, rule) in OTHERS {
            let error = read(&urdf(&bars, units), None).unwrap_err().to_string();
            prop_assert!(error.contains(unit) && error.contains(rule), "{error}");
            prop_assert!(error.starts_with("drawn.urdf:"), "{error}");
        }
    }

    /// Given in `robot.toml`, they are refused at its line.
    #[test]
    fn links_of_robot_toml_are_told_at_their_line(bars in arms(), which in 0..4_usize) {
        let [along, across] = bars[which].inertia_kg_m2().map(|own| 1e6 * own);
        let config = format!(
            "\n[[link]]\nname = \"l{}\"\nmass_kg = {:?}\ncenter_m = [0.0, 0.0, 0.0]\n\
             inertia_kg_m2 = [{along:?}, {across:?}, {across:?}, 0.0, 0.0, 0.0]\nsource = \"CAD\"\n",
            which + 1,
            bars[which].mass_kg()
        );
        let error = read(&urdf(&bars, SI), Some(&config)).unwrap_err();
        prop_assert_eq!((error.path(), error.line()), (Some(Path::new("robot.toml")), Some(3)));
        prop_assert!(error.message().contains("in kg mm^2 it were"), "{error}");
    }

    /// Half of an arm's length is what a dumb-bell has: no error, and one of two signs of
    /// placeholders.
    #[test]
    fn what_no_link_has_is_a_sign_of_placeholders(bars in arms(), which in 0..4_usize) {
        let length_m: f64 = bars.iter().map(|bar| bar.length_m).sum();
        let mut text = urdf(&bars, SI);
        let [along, across] = bars[which].inertia_kg_m2();
        let old = format!("ixx=\"{along}\" iyy=\"{across}\" izz=\"{across}\"");
        let wide = 2.0 / 3.0 * bars[which].mass_kg() * (0.75 * length_m).powi(2);
        text = text.replacen(&old, &format!("ixx=\"{wide}\" iyy=\"{wide}\" izz=\"{wide}\""), 1);
        let robot = read(&text, None).unwrap();
        let told = |note: &&String| note.contains("dumb-bell") && note.contains("placeholder");
        prop_assert_eq!(robot.chain.notes.iter().filter(told).count(), 1, "{:?}", robot.chain.notes);
    }
}

/// A mass in a point is an idealisation, not a unit.
#[test]
fn a_point_mass_is_believed() {
    let bars = vec![
        Bar {
            length_m: 0.4,
            slender: 0.2,
            density_kg_per_m3: 2700.0,
        };
        4
    ];
    let [along, across] = bars[0].inertia_kg_m2();
    let own = format!("ixx=\"{along}\" iyy=\"{across}\" izz=\"{across}\"");
    let text = urdf(&bars, SI).replacen(&own, "ixx=\"0\" iyy=\"0\" izz=\"0\"", 1);
    assert_ne!(text, urdf(&bars, SI));
    let notes = read(&text, None).unwrap().chain.notes;
    assert!(
        !notes.iter().any(|note| note.contains("gyration")),
        "{notes:?}"
    );
}
