//! Bad robot files: one fault each, one error each, with place, value and rule.

use std::path::{Path, PathBuf};

use crate::urdf_faults::URDF_FAULTS;
use truecut_arm::{ArmError, ArmErrorKind, Robot};

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/invalid_input/urdf")
}

#[test]
fn every_faulty_urdf_is_refused_with_its_reason() {
    for (name, line, quotes) in URDF_FAULTS {
        let path = fixtures().join(name).with_extension("urdf");
        let error = Robot::load(&path, None, None).expect_err(name);
        assert_eq!(error.path(), Some(path.as_path()), "{name}");
        assert_eq!(error.line(), *line, "{name}: {error}");
        let message = error.message();
        for quote in *quotes {
            assert!(
                message.contains(quote),
                "{name}: `{quote}` is not in: {message}"
            );
        }
        assert!(!message.contains('\n'), "{name}: one line: {message}");
        let place = line.map_or(format!("{}: ", path.display()), |line| {
            format!("{}:{line}: ", path.display())
        });
        assert_eq!(error.to_string(), format!("{place}{message}"));
    }
}

/// A fixture without an entry in the table above would never be run.
#[test]
fn every_fixture_is_in_the_table() {
    let mut files: Vec<_> = (std::fs::read_dir(fixtures()).expect("the folder exists"))
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.extension().is_some_and(|e| e == "urdf"))
        .map(|path| {
            path.file_stem()
                .expect("a name")
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    files.sort();
    let mut table: Vec<_> = URDF_FAULTS
        .iter()
        .map(|(name, _, _)| (*name).to_owned())
        .collect();
    table.sort();
    assert_eq!(files, table);
}

#[test]
fn a_missing_file_is_named() {
    let path = fixtures().join("nowhere.urdf");
    let error = Robot::load(&path, None, None).expect_err("no such file");
    assert_eq!(error.path(), Some(path.as_path()));
    assert!(
        error.message().starts_with("cannot read the file"),
        "{error}"
    );

    let urdf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof/robot.urdf");
    let config = fixtures().join("nowhere.toml");
    let error = Robot::load(&urdf, Some(&config), None).expect_err("no such file");
    assert_eq!(error.path(), Some(config.as_path()));
}

const TWO_JOINTS: &str = r#"<robot name="two">
  <link name="base"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="0"/>
  </joint>
  <link name="arm"><inertial><mass value="3"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="slide" type="prismatic">
    <parent link="arm"/><child link="tip"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="0"/>
  </joint>
  <link name="tip"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
</robot>"#;

fn with_config(config: &str) -> Result<Robot, ArmError> {
    let urdf = (TWO_JOINTS, Path::new("two.urdf"));
    Robot::from_texts(urdf, Some((config, Path::new("robot.toml"))), None)
}

/// Text of a `robot.toml`, line of the fault, quotes.
const CONFIG_FAULTS: &[(&str, usize, &[&str])] = &[
    ("name = \"x\nnmae = 2", 1, &["string"]),
    (
        "\n\n[[joint]]\nname = \"turn\"\nstifness_nm_per_rad = 1.0",
        5,
        &[
            "unknown key `stifness_nm_per_rad` in [joint \"turn\"]",
            "did you mean `stiffness_nm_per_rad`?",
        ],
    ),
    (
        "[[joint]]\nname = \"turn\"\nstiffness_nm_per_rad = \"much\"",
        3,
        &[
            "`joint \"turn\".stiffness_nm_per_rad` is the text \"much\"",
            "must be a number",
        ],
    ),
    (
        "[[joint]]\nname = \"trun\"",
        2,
        &["no joint \"trun\"", "turn, slide"],
    ),
    (
        "[[joint]]\nname = \"turn\"\n\n[[joint]]\nname = \"turn\"",
        5,
        &["joint name \"turn\"", "twice", "line 2"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nstiffness_nm_per_rad = -5e6\nsource.stiffness = \"x\"",
        3,
        &[
            "\"turn\"",
            "`stiffness_nm_per_rad` is -5000000",
            "above zero",
        ],
    ),
    (
        "[[joint]]\nname = \"turn\"\nstiffness_nm_per_rad = 0\nsource.stiffness = \"x\"",
        3,
        &["is 0;", "above zero"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nstiffness_nm_per_rad = nan\nsource.stiffness = \"x\"",
        3,
        &["is NaN;", "finite"],
    ),
    (
        "[[joint]]\nname = \"turn\"\ndamping_nm_s_per_rad = -1\nsource.damping = \"x\"",
        3,
        &["`damping_nm_s_per_rad` is -1", "zero or above"],
    ),
    (
        "[[joint]]\nname = \"turn\"\ndry_friction_nm = inf\nsource.dry_friction = \"x\"",
        3,
        &["`dry_friction_nm` is inf", "finite"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nrotor_inertia_kg_m2 = -0.1\nsource.rotor_inertia = \"x\"",
        3,
        &["`rotor_inertia_kg_m2` is -0.1"],
    ),
    (
        "[[joint]]\nname = \"slide\"\nstiffness_nm_per_rad = 1e6\nsource.stiffness = \"x\"",
        3,
        &[
            "\"slide\" is prismatic",
            "use `stiffness_n_per_m` instead of `stiffness_nm_per_rad`",
        ],
    ),
    (
        "[[joint]]\nname = \"turn\"\ndamping_n_s_per_m = 1\nsource.damping = \"x\"",
        3,
        &["\"turn\" is revolute", "use `damping_nm_s_per_rad`"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nstiffness_nm_per_rad = 1e6",
        3,
        &[
            "`stiffness_nm_per_rad` has no source",
            "stiffness = \"...\"",
        ],
    ),
    (
        "[[joint]]\nname = \"turn\"\nstiffness_nm_per_rad = 1e6\nsource.stiffness = \"  \"",
        3,
        &["no source"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nsource.servo = \"x\"\n[joint.servo]\nposition_gain_per_s = 20\nvelocity_gain_nm_s_per_rad = 5",
        5,
        &["[joint.servo] lacks `torque_limit_nm`"],
    ),
    (
        "[[joint]]\nname = \"slide\"\nsource.servo = \"x\"\n[joint.servo]\nposition_gain_per_s = 20\nvelocity_gain_n_s_per_m = 5\ntorque_limit_nm = 3",
        7,
        &["use `force_limit_n`"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nsource.servo = \"x\"\n[joint.servo]\nposition_gain_per_s = 0\nvelocity_gain_nm_s_per_rad = 5\ntorque_limit_nm = 3",
        5,
        &["`position_gain_per_s` is 0", "above zero"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nlinear_to_rad = 0\nsource.linear_to = \"x\"",
        3,
        &["\"turn\"", "`linear_to_rad` is 0", "above zero"],
    ),
    (
        "[[joint]]\nname = \"turn\"\nlinear_to_rad = 0.01",
        3,
        &["`linear_to_rad` has no source", "linear_to = \"...\""],
    ),
    (
        "[[joint]]\nname = \"slide\"\nlinear_to_rad = 0.01\nsource.linear_to = \"x\"",
        3,
        &["\"slide\" is prismatic", "use `linear_to_m`"],
    ),
    (
        "[[joint]]\nname = \"turn\"\npulses_per_deg = 0\nsource.pulses = \"x\"",
        3,
        &["\"turn\"", "`pulses_per_deg` is 0", "above zero"],
    ),
    (
        "[[joint]]\nname = \"turn\"\npulses_per_deg = 1345.0",
        3,
        &["`pulses_per_deg` has no source", "pulses = \"...\""],
    ),
    (
        "[[joint]]\nname = \"turn\"\npulses_per_mm = 10\nsource.pulses = \"x\"",
        3,
        &["\"turn\" is revolute", "use `pulses_per_deg`"],
    ),
    (
        "[frames.tool]\nxyz_m = [0, nan, 0]",
        2,
        &["frame `tool`", "`xyz_m` holds NaN"],
    ),
    (
        "[frames.tool]\nxyz_m = [0, 1]",
        2,
        &["`frames.tool.xyz_m` has 2 entries", "must have 3"],
    ),
    (
        "[frames.tool]\nxyz_m = [0, \"far\", 1]",
        2,
        &["`frames.tool.xyz_m` is the text \"far\""],
    ),
    ("joint = 3", 1, &["`joint` is the number 3", "a list"]),
    (
        "[joint]\nname = \"turn\"",
        1,
        &["`joint` is a table", "a list"],
    ),
    (
        "name = \"x\"\n[[joint]]\nstiffness_nm_per_rad = 1e6",
        2,
        &["missing key `name` in [joint 1]: Name of the joint"],
    ),
    (
        "[tool_load]\nmas_kg = 3\ncenter_m = [0, 0, 0]",
        2,
        &["unknown key `mas_kg` in [tool_load]; did you mean `mass_kg`?"],
    ),
    (
        "[[joint]]\nname = \"turn\"\ndeflection_nm_per_rad = 3",
        3,
        &["unknown key `deflection_nm_per_rad`", "known keys are"],
    ),
    (
        "[frames.tool]\nxyz_m = [0, 0, 1]\nxyz_mm = [0, 0, 1]",
        3,
        &["frame `tool`", "twice"],
    ),
    (
        "[[link]]\nname = \"slidr\"\nmass_kg = 1\ncenter_m = [0, 0, 0]\ninertia_kg_m2 = [1, 1, 1, 0, 0, 0]\nsource = \"x\"",
        2,
        &["no link \"slidr\"", "known:"],
    ),
    (
        "[[link]]\nname = \"base\"\nmass_kg = -1\ncenter_m = [0, 0, 0]\ninertia_kg_m2 = [1, 1, 1, 0, 0, 0]\nsource = \"x\"",
        2,
        &["\"base\"", "-1 kg", "not be negative"],
    ),
    (
        "[[link]]\nname = \"base\"\nmass_kg = 1\ncenter_m = [0, 0, 0]\ninertia_kg_m2 = [1, 1, 3, 0, 0, 0]\nsource = \"x\"",
        2,
        &["\"base\"", "triangle rule"],
    ),
    (
        "[[link]]\nname = \"base\"\nmass_kg = 1\ncenter_m = [0, 0, 0]\ninertia_kg_m2 = [1, 1, -1, 0, 0, 0]\nsource = \"x\"",
        2,
        &["\"base\"", "none may be negative"],
    ),
    (
        "[[link]]\nname = \"base\"\nmass_kg = nan\ncenter_m = [0, 0, 0]\ninertia_kg_m2 = [1, 1, 1, 0, 0, 0]\nsource = \"x\"",
        2,
        &["\"base\"", "finite numbers"],
    ),
    (
        "[[link]]\nname = \"base\"\nmass_kg = 1\ncenter_m = [0, 0, 0]\ninertia_kg_m2 = [1, 1, 1, 0, 0, 0]\nsource = \" \"",
        2,
        &["\"base\"", "`source` is empty"],
    ),
    (
        "[masses]\ntotal_kg = 4000",
        2,
        &["sum to", "`total_kg` is 4000", "0.5 %"],
    ),
    (
        "[frames.grinder]\nxyz_m = [0, 0, 1]",
        1,
        &["unknown key `grinder` in [frames]"],
    ),
];

/// Faults of several tables, with their lines: all are told, in the order of the file.
#[test]
fn all_faults_of_a_config_are_told_at_once() {
    let structure = "naem = \"x\"\n[frames.tool]\nxyz_m = [0, 0]\n[[joint]]\nname = 3\n\
                     stifness_nm_per_rad = 1\n[masses]\ntotal_kg = \"heavy\"";
    let values = "[[link]]\nname = \"base\"\nmass_kg = -1\ncenter_m = [0, 0, 0]\n\
                  inertia_kg_m2 = [1, 1, 1, 0, 0, 0]\nsource = \"x\"\n\
                  [[joint]]\nname = \"turn\"\nstiffness_nm_per_rad = -1\n\
                  damping_nm_s_per_rad = -2\n[joint.source]\ndamping = \"x\"\n\
                  [[joint]]\nname = \"trun\"\n\
                  [[joint]]\nname = \"slide\"\nsource.servo = \"x\"\n[joint.servo]\n\
                  position_gain_per_s = 0\nvelocity_gain_n_s_per_m = 5\n\
                  [frames.foot]\nrpy_deg = [0, inf, 0]";
    for (text, lines) in [
        (structure, &[1, 3, 5, 6, 8][..]),
        (values, &[2, 9, 9, 10, 14, 19, 19, 22]),
    ] {
        let error = with_config(text).expect_err(text);
        assert_eq!(error.line(), Some(lines[0]), "{error}");
        let ArmErrorKind::Several(faults) = error.kind() else {
            panic!("{error}");
        };
        let told: Vec<usize> = faults.iter().filter_map(ArmError::line).collect();
        assert_eq!(told, lines, "{error}");
        for fault in faults {
            assert!(error.message().contains(&fault.message()), "{error}");
            for word in ["f64", "struct", "enum", "Spanned", "Vec<", "Option<", "Raw"] {
                assert!(!fault.message().contains(word), "{fault}");
            }
        }
    }
}

/// Each is shown within the text of its file: thousands would take minutes to print.
#[test]
fn of_very_many_faults_the_first_are_told() {
    let text = "[[joint]]\nname = \"trun\"\n".repeat(1000);
    let error = with_config(&text).expect_err("no such joint");
    let ArmErrorKind::Several(faults) = error.kind() else {
        panic!("{error}");
    };
    assert_eq!(faults.len(), 101, "{error}");
    assert_eq!(faults[99].line(), Some(200));
    assert_eq!(faults[100].message(), "900 more faults are not shown");
}

#[test]
fn every_faulty_config_is_refused_with_its_reason() {
    for (text, line, quotes) in CONFIG_FAULTS {
        let error = with_config(text).expect_err(text);
        assert_eq!(error.path(), Some(Path::new("robot.toml")), "{text}");
        assert_eq!(error.line(), Some(*line), "{text}: {error}");
        for quote in *quotes {
            assert!(
                error.message().contains(quote),
                "`{quote}` is not in: {error}"
            );
        }
    }
}

#[test]
fn an_unknown_tip_lists_the_links() {
    let error = Robot::from_texts((TWO_JOINTS, Path::new("two.urdf")), None, Some("hand"))
        .expect_err("no such link");
    assert_eq!(
        error.to_string(),
        "two.urdf: no link \"hand\"; known: arm, base, tip"
    );
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(400))]

    /// Whatever a file holds, reading it ends with a robot or an error, never with a panic: damage
    /// at random places.
    #[test]
    fn damaged_files_never_panic(at in 0..TWO_JOINTS.len(), length in 0_usize..40, patch in "[ -~]{0,6}") {
        let mut text = TWO_JOINTS.to_owned();
        let end = (at + length).min(text.len());
        text.replace_range(at..end, &patch);
        if let Ok(robot) = Robot::from_texts((&text, Path::new("two.urdf")), None, None) {
            let q = robot.default_posture();
            proptest::prop_assert!(robot.report(&q).is_ok());
        }
    }
}

#[test]
fn texts_that_would_exhaust_a_reader_are_refused_before_it_starts() {
    let read = |text: &str| {
        Robot::from_texts((text, Path::new("big.urdf")), None, None)
            .expect_err("too much")
            .to_string()
    };
    let nested = format!("<robot name=\"x\">\n{}", "<a>".repeat(10_000));
    let message = read(&nested);
    assert!(
        message.contains("big.urdf:2: elements are nested more than 256 deep"),
        "{message}"
    );
    // Parsers compare each attribute of an element with all before it: 40 000 took a minute.
    let attributes: String = (0..40_000).map(|i| format!(" a{i}=\"1\"")).collect();
    for element in ["link name=\"x\"", "xacro:property name=\"x\""] {
        let message = read(&format!(
            "<robot name=\"x\">\n<{element}{attributes}/></robot>"
        ));
        assert!(
            message.contains("big.urdf:2: an element has 40001 attributes; at most 256 are read"),
            "{message}"
        );
    }
    let links: String = (0..20_000)
        .map(|i| {
            format!(
                "<link name=\"l{i}\"/>\n<joint name=\"j{i}\" type=\"fixed\"><parent link=\"l{i}\"/>\
                 <child link=\"l{}\"/></joint>\n",
                i + 1
            )
        })
        .collect();
    let message = read(&format!("<robot name=\"x\">\n{links}</robot>"));
    assert!(message.contains("20000 links; at most 1000"), "{message}");
}

#[test]
fn a_table_without_postures_is_refused() {
    let robot = Robot::from_texts((TWO_JOINTS, Path::new("two.urdf")), None, None).unwrap();
    for table in ["", "\n\n", "shoulder,elbow\n", "# nothing\n"] {
        let error = truecut_arm::report::fk_table(&robot, table).expect_err("no row");
        assert!(error.to_string().contains("holds no posture"), "{error}");
    }
}
