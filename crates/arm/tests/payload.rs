//! What links carry beside their own mass: cables, dress packs.

use std::path::Path;

use proptest::prelude::*;
use truecut_arm::{ArmError, Load, Robot, standard_gravity_m_s2};

/// Two links about skew axes, each with its inertial frame turned, and further elements.
fn urdf(further: &str) -> String {
    let link = |name: &str, mass_kg: f64, at: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"{at}\" rpy=\"0.3 -0.2 0.5\"/><mass \
             value=\"{mass_kg}\"/><inertia ixx=\"0.4\" ixy=\"0.02\" ixz=\"0\" iyy=\"0.3\" iyz=\"-0.01\" \
             izz=\"0.2\"/></inertial></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str, axis: &str| {
        format!(
            "<joint name=\"{name}\" type=\"continuous\"><parent link=\"{parent}\"/><child \
             link=\"{child}\"/><origin xyz=\"0.1 0 0.4\" rpy=\"0.2 0 0\"/><axis xyz=\"{axis}\"/></joint>"
        )
    };
    format!(
        "<robot name=\"r\"><link name=\"base\"/>{}{}{}{}{further}</robot>",
        joint("lift", "base", "upper", "0 1 0"),
        link("upper", 20.0, "0.02 0.01 0.2"),
        joint("bend", "upper", "lower", "0.6 0 0.8"),
        link("lower", 8.0, "0 0.03 0.15"),
    )
}

fn read(urdf: &str, payloads: &str) -> Result<Robot, ArmError> {
    let stiff = |name: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\nstiffness_nm_per_rad = 1e5\nsource = {{ stiffness = \"test\" }}\n"
        )
    };
    let config = format!("{}{}{payloads}", stiff("lift"), stiff("bend"));
    let config = Some((config.as_str(), Path::new("robot.toml")));
    Robot::from_texts((urdf, Path::new("r.urdf")), config, Some("lower"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// A payload does what a link does that is fixed to the same one.
    #[test]
    fn verify_a_payload_is_a_link_fixed_to_another(
        on_upper in any::<bool>(), mass_kg in 0.5..30.0_f64,
        at in prop::array::uniform3(-0.3..0.3_f64), sides in prop::array::uniform3(0.05..0.4_f64),
        q in prop::array::uniform2(-3.0..3.0_f64),
    ) {
        let link = if on_upper { "upper" } else { "lower" };
        let [x, y, z] = sides.map(|side| side * side * mass_kg / 12.0);
        let (xx, yy, zz) = (y + z, x + z, x + y);
        let [a, b, c] = at;
        let fixed = format!(
            "<joint name=\"strap\" type=\"fixed\"><parent link=\"{link}\"/><child link=\"dress\"/></joint>\
             <link name=\"dress\"><inertial><origin xyz=\"{a} {b} {c}\"/><mass value=\"{mass_kg}\"/>\
             <inertia ixx=\"{xx}\" ixy=\"0\" ixz=\"0\" iyy=\"{yy}\" iyz=\"0\" izz=\"{zz}\"/></inertial></link>"
        );
        let payload = format!(
            "[[payload]]\nlink = \"{link}\"\nmass_kg = {mass_kg:?}\ncenter_m = [{a:?}, {b:?}, {c:?}]\n\
             inertia_kg_m2 = [{xx:?}, {yy:?}, {zz:?}, 0, 0, 0]\nsource = \"scales\"\n"
        );
        let payload = payload.replace(", 0, 0, 0]", ", 0.0, 0.0, 0.0]");
        let carried = read(&urdf(""), &payload).expect("a payload");
        let welded = read(&urdf(&fixed), "").expect("a fixed link");
        let apart = carried.mass_matrix(&q) - welded.mass_matrix(&q);
        prop_assert!(apart.amax() < 1e-11, "{apart}");
        let gravity = Load::gravity(standard_gravity_m_s2());
        let held = |robot: &Robot| robot.holding_command(&q, &gravity).expect("stiff");
        for (own, other) in held(&carried).iter().zip(held(&welded)) {
            prop_assert!((own - other).abs() < 1e-13, "{own} {other}");
        }
        let told = carried.chain.notes.iter();
        prop_assert_eq!(told.filter(|note| note.contains("more than its own mass: scales")).count(), 1);
    }
}

/// The stated sum is that of the arm alone; every wrong payload is told at its line.
#[test]
fn wrong_payloads_are_refused_each_at_its_line() {
    let good = "[[payload]]\nlink = \"lower\"\nmass_kg = 2.0\ncenter_m = [0.0, 0.0, 0.1]\nsource = \"scales\"\n";
    let robot = read(&urdf(""), &format!("{good}[masses]\ntotal_kg = 28.0\n")).expect("a sum");
    assert_eq!(robot.chain.links[1].mass_kg, 10.0);
    for (from, to, quote) in [
        ("\"lower\"", "\"lowr\"", "no link \"lowr\""),
        ("2.0", "0.0", "must be above 0"),
        ("2.0", "-2.0", "negative"),
        ("\"scales\"", "\" \"", "`source` is empty"),
        (
            "source",
            "inertia_kg_m2 = [1.0, 1.0, 5.0, 0.0, 0.0, 0.0]\nsource",
            "inertia",
        ),
    ] {
        let error = read(&urdf(""), &good.replace(from, to))
            .expect_err(quote)
            .to_string();
        assert!(
            error.contains(quote) && error.contains("robot.toml"),
            "{error}"
        );
        assert!(
            error.contains(":10") || error.contains("line 10"),
            "{error}"
        );
    }
    let bare = urdf("").replace("value=\"8\"", "value=\"0\"");
    let error = read(&bare, good).expect_err("no mass").to_string();
    assert!(error.contains("has no mass of its own"), "{error}");
}
