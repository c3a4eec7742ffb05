//! Estimates from a data sheet, held against arms that are known.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use truecut_arm::estimate::{DataSheet, robot_toml};
use truecut_arm::{ArmError, Masses, Packages, Reading, Robot};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn estimated(urdf: &Path, mass_kg: Option<f64>, payload_kg: f64) -> Result<String, ArmError> {
    let sheet = DataSheet {
        mass_kg,
        payload_kg,
    };
    robot_toml(urdf, None, &Packages::default(), &BTreeMap::new(), sheet)
}

/// The robot at `urdf` with the text as its `robot.toml`.
fn with(urdf: &Path, text: &str) -> Robot {
    let folder = std::env::temp_dir().join(format!("truecut-estimates-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let name = urdf
        .with_extension("toml")
        .display()
        .to_string()
        .replace(['/', '\\'], "_");
    let config = folder.join(name);
    std::fs::write(&config, text).expect("written");
    let reading = Reading {
        config: Some(&config),
        ..Reading::default()
    };
    let robot = Robot::read(urdf, &reading).unwrap_or_else(|error| panic!("{error}\n{text}"));
    std::fs::remove_file(config).expect("removed");
    robot
}

fn asset(name: &str) -> PathBuf {
    repository()
        .join("assets/robots")
        .join(name)
        .join("robot.urdf")
}

fn masses(robot: &Robot) -> Vec<f64> {
    robot.chain.links.iter().map(|link| link.mass_kg).collect()
}

/// The table of `docs/physics/estimates.md`: what the rules give for arms whose parameters are
/// known, and how far off that is.
#[test]
fn regress_estimates_of_known_arms() {
    let posture = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95].map(f64::to_radians);
    let level = [0.0, 20.0, -20.0, 0.0, -60.0, 0.0].map(f64::to_radians);
    for (name, mass_kg, payload_kg, q, hz, factor) in [
        ("irb6600_175_255", 1700.0, 175.0, posture, 11.29, 1.70),
        ("hp20", 268.0, 20.0, level, 13.67, 1.01),
    ] {
        let urdf = asset(name);
        let text = estimated(&urdf, Some(mass_kg), payload_kg).expect("it is estimated");
        let robot = with(&urdf, &text);
        let known = Robot::load(&urdf, None, None).expect("the asset");
        let first = |robot: &Robot| robot.modes(&q, None).expect("modes").frequency_hz[0];
        let (estimate, true_hz) = (first(&robot), first(&known));
        assert!((estimate / hz - 1.0).abs() < 1e-3, "{name}: {estimate} Hz");
        let off = (estimate / true_hz).max(true_hz / estimate);
        assert!(
            (off / factor - 1.0).abs() < 1e-2,
            "{name}: a factor of {off}"
        );
    }
}

/// Of the UR10e every link is within a factor of 2 of its known mass.
#[test]
fn masses_of_a_known_arm_are_within_a_factor_of_two() {
    let urdf = asset("ur10e");
    let text = estimated(&urdf, Some(33.5), 12.5).expect("it is estimated");
    let known = Robot::load(&urdf, None, None).expect("the asset");
    for (own, known) in masses(&with(&urdf, &text)).iter().zip(masses(&known)) {
        assert!(
            (0.5..=2.0).contains(&(own / known)),
            "{own} kg for {known} kg"
        );
    }
}

#[test]
fn an_arm_without_masses_gets_them_and_runs() {
    let urdf = repository().join("tests/crosscheck/xacro/six_axis_description/urdf/six_axis.xacro");
    let refused = Robot::load(&urdf, None, None).expect_err("it has no masses");
    assert!(
        refused.message().contains("truecut robot init"),
        "{refused}"
    );
    let reading = Reading {
        masses: Masses::NotNeeded,
        ..Reading::default()
    };
    let kinematics = Robot::read(&urdf, &reading).expect("kinematics need none");
    assert!(
        kinematics
            .chain
            .notes
            .iter()
            .any(|note| note.contains("no mass is known of link_1"))
    );

    let text = estimated(&urdf, Some(250.0), 20.0).expect("it is estimated");
    let robot = with(&urdf, &text);
    let total = masses(&robot).iter().sum::<f64>() + robot.chain.base.mass_kg;
    assert!((total / 250.0 - 1.0).abs() < 1e-6, "{total} kg");
    for joint in &robot.chain.joints {
        let sources = &joint.transmission.sources;
        for source in [
            &sources.stiffness,
            &sources.damping,
            &sources.rotor_inertia,
            &sources.servo,
        ] {
            assert!(source.starts_with("estimated: "), "{source}");
        }
    }
    assert!(
        robot
            .chain
            .notes
            .iter()
            .any(|note| note.contains("are estimated"))
    );
    // The rule for damping holds at the posture that it is made at.
    let modes = robot.modes(&robot.default_posture(), None).expect("modes");
    assert!((modes.damping_ratio[0] / 0.02 - 1.0).abs() < 1e-3);
}

#[test]
fn an_impossible_data_sheet_is_refused() {
    let urdf = repository().join("tests/crosscheck/xacro/six_axis_description/urdf/six_axis.xacro");
    for (mass_kg, payload_kg, quote) in [
        (None, 20.0, "give the arm's mass with --mass"),
        (Some(20.0), 250.0, "no arm carries more than it weighs"),
        (Some(-250.0), 20.0, "above 0"),
        (Some(250.0), f64::NAN, "above 0"),
    ] {
        let error = estimated(&urdf, mass_kg, payload_kg).expect_err(quote);
        assert!(error.message().contains(quote), "{error}");
    }
}
