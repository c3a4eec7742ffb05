//! Robots in xacro: what is wrong with them is told at its place, what is right is read like a
//! URDF.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use truecut_arm::{ArmError, Masses, Packages, Reading, Robot};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn kinematics(path: &Path, arguments: &[(&str, &str)]) -> Result<Robot, ArmError> {
    let arguments = arguments.iter();
    let reading = Reading {
        masses: Masses::NotNeeded,
        arguments: arguments
            .map(|(n, v)| ((*n).to_owned(), (*v).to_owned()))
            .collect(),
        ..Reading::default()
    };
    Robot::read(path, &reading)
}

/// Name, line and what the message must say.
const FAULTS: [(&str, usize, &[&str]); 17] = [
    ("unknown_macro", 13, &["no macro \"frmae\"", "known: frame"]),
    (
        "missing_package",
        13,
        &["no_such_package", "--package no_such_package=DIR"],
    ),
    ("recursion", 14, &["deep", "call itself"]),
    (
        "division_by_zero",
        13,
        &["division by zero", "length/(2 - 2)"],
    ),
    ("not_a_number", 13, &["0.4m", "three finite numbers"]),
    ("undefined_name", 13, &["\"lenght\" is not defined"]),
    ("missing_parameter", 13, &["\"frame\"", "\"name\""]),
    ("unknown_parameter", 13, &["\"frame\"", "\"parnet\""]),
    ("missing_block", 13, &["\"frame\"", "block \"origin\""]),
    ("no_condition", 13, &["perhaps", "neither true nor false"]),
    ("depends_on_itself", 15, &["depends on itself"]),
    ("environment", 13, &["$(env HOME)", "--arg"]),
    ("outside", 13, &["outside", "--package"]),
    (
        "missing_argument",
        13,
        &["\"prefix\"", "--arg prefix=VALUE"],
    ),
    (
        "missing_package_url",
        13,
        &["package://no_such_package", "--package no_such_package=DIR"],
    ),
    (
        "empty_argument",
        13,
        &["no file", "argument speeds is empty", "--arg speeds=FILE"],
    ),
    ("unclosed", 13, &["${length", "`}`"]),
];

/// A file may have expressions and no element of the language; one that was expanded has neither,
/// and is read as it stands though it still declares the namespace.
#[test]
fn expressions_alone_make_a_file_xacro() {
    let text = |x: &str| {
        format!(
            "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"k\"><link name=\"a\"/>\
             <link name=\"b\"/><joint name=\"j\" type=\"revolute\"><parent link=\"a\"/>\
             <child link=\"b\"/><origin xyz=\"{x} 0 0\"/><axis xyz=\"0 1 0\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>"
        )
    };
    let folder = tempfile::tempdir().expect("a folder");
    for (name, x) in [("k.xacro", "${0.25 + 0.5}"), ("k.urdf", "0.75")] {
        let path = folder.path().join(name);
        std::fs::write(&path, text(x)).expect("written");
        let robot = kinematics(&path, &[]).expect(name);
        let flange = robot.world_from_frame(&[0.0], truecut_arm::FrameId::Flange);
        assert!(
            (flange.translation.x - 0.75).abs() < 1e-15,
            "{name}: {flange}"
        );
    }
}

#[test]
fn every_faulty_xacro_is_refused_with_file_line_and_reason() {
    let folder = repository().join("tests/invalid_input/xacro");
    for (name, line, quotes) in FAULTS {
        let path = folder.join(name).with_extension("xacro");
        let error = kinematics(&path, &[]).expect_err(name);
        assert_eq!(error.path(), Some(path.as_path()), "{name}: {error}");
        assert_eq!(error.line(), Some(line), "{name}: {error}");
        for quote in quotes {
            assert!(
                error.message().contains(quote),
                "{name}: `{quote}` is not in: {error}"
            );
        }
    }
    let fixtures = std::fs::read_dir(folder)
        .expect("the folder exists")
        .count();
    assert_eq!(
        fixtures,
        FAULTS.len(),
        "a fixture without an entry is never read"
    );
}

/// A robot that uses properties, macros, blocks, includes, conditions and arguments.
#[test]
fn a_robot_of_macros_is_a_robot() {
    let file =
        repository().join("tests/crosscheck/xacro/slide_arm_description/urdf/slide_arm.xacro");
    let robot = Robot::load(&file, None, None).expect("it loads");
    assert_eq!(robot.dof(), 4);
    assert_eq!(robot.chain.tip, "gripper");
    // A rod of 0.4 m and a radius of 0.05 m with the density that was included.
    let rod_kg = 2700.0 * std::f64::consts::PI * 0.05 * 0.05 * 0.4;
    assert!((robot.chain.links[0].mass_kg - rod_kg).abs() < 1e-12);

    let short = kinematics(&file, &[("joints", "2"), ("with_gripper", "false")]);
    assert_eq!(short.expect("it loads").chain.tip, "bare");
}

/// A fault of the URDF that a macro wrote is told where the macro's text stands.
#[test]
fn a_fault_behind_a_macro_is_told_in_the_file_of_the_macro() {
    let folder = repository().join("tests/crosscheck/xacro/slide_arm_description/urdf");
    let reading = Reading {
        arguments: BTreeMap::from([("joints".to_owned(), "9".to_owned())]),
        packages: Packages::new([], Vec::new()),
        ..Reading::default()
    };
    let error = Robot::read(&folder.join("slide_arm.xacro"), &reading).expect_err("too short");
    assert!(error.message().contains("has no item 4"), "{error}");
    assert_eq!(error.path(), Some(folder.join("slide_arm.xacro").as_path()));
}

/// A few lines that come to more than any memory: each ends at once, with an error.
#[test]
fn what_doubles_without_end_is_refused() {
    let head = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"k\">\n";
    let doubled = |line: &dyn Fn(usize, usize) -> String| -> String {
        (1..39).map(|k| line(k, k - 1)).collect()
    };
    let properties = doubled(&|k, last| {
        format!("<xacro:property name=\"p{k}\" value=\"${{p{last}}}${{p{last}}}\"/>\n")
    });
    let macros = doubled(&|k, last| {
        format!("<xacro:macro name=\"m{k}\"><xacro:m{last}/><xacro:m{last}/></xacro:macro>\n")
    });
    let folder = tempfile::tempdir().unwrap();
    for (name, text, says) in [
        (
            "properties",
            format!(
                "<xacro:property name=\"p0\" value=\"ab\"/>\n{properties}<link name=\"${{p38}}\"/>"
            ),
            "grows beyond all bounds",
        ),
        (
            "macros",
            format!(
                "<xacro:macro name=\"m0\"><link name=\"a\"/></xacro:macro>\n{macros}<xacro:m38/>"
            ),
            "more than 200000 elements",
        ),
        (
            "text",
            "<link name=\"${'a' * 10000000000}\"/>".to_owned(),
            "too large",
        ),
    ] {
        let file = folder.path().join(format!("{name}.xacro"));
        std::fs::write(&file, format!("{head}{text}\n</robot>\n")).unwrap();
        let error = kinematics(&file, &[]).unwrap_err().to_string();
        assert!(error.contains(says), "{name}: {error}");
    }
}
