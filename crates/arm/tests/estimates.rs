//! Estimates from a data sheet, held against arms that are known.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use truecut_arm::estimate::{DataSheet, Estimated, robot_toml};
use truecut_arm::{ArmError, Masses, Packages, Reading, Robot, TransmissionValue};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn sheet(mass_kg: Option<f64>, payload_kg: f64) -> DataSheet {
    DataSheet {
        mass_kg,
        payload_kg,
        reach_m: None,
        repeatability_mm: None,
    }
}

fn by_sheet(urdf: &Path, sheet: DataSheet) -> Result<Estimated, ArmError> {
    robot_toml(urdf, None, &Packages::default(), &BTreeMap::new(), sheet)
}

fn estimated(urdf: &Path, mass_kg: Option<f64>, payload_kg: f64) -> Result<String, ArmError> {
    Ok(by_sheet(urdf, sheet(mass_kg, payload_kg))?.text)
}

fn six_axis() -> PathBuf {
    repository().join("tests/crosscheck/xacro/six_axis_description/urdf/six_axis.xacro")
}

/// The robot at `urdf` with the text as its `robot.toml`.
fn with(urdf: &Path, text: &str) -> Robot {
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("robot.toml");
    std::fs::write(&config, text).expect("written");
    let reading = Reading {
        config: Some(&config),
        ..Reading::default()
    };
    Robot::read(urdf, &reading).unwrap_or_else(|error| panic!("{error}\n{text}"))
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
        ("irb6600_175_255", 1700.0, 175.0, posture, 8.01, 1.20),
        ("hp20", 268.0, 20.0, level, 12.69, 1.09),
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
    let urdf = six_axis();
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
    let told = robot
        .estimates(&TransmissionValue::ALL)
        .expect("it says so");
    let of_joints = "; stiffness, damping, rotor inertia and servo of all 6 joints; ";
    assert!(
        told.starts_with("estimated, not measured: masses of base_link, link_1, ")
            && told.contains(of_joints),
        "{told}"
    );
    // Values that nobody asks about are not told, and one that is measured is not either.
    let mut robot = robot;
    robot.chain.joints[2].transmission.sources.stiffness = "hammer test".to_owned();
    let told = robot
        .estimates(&[TransmissionValue::Stiffness])
        .expect("five are");
    let five = "; stiffness of joint_1, joint_2, joint_4, joint_5, joint_6; ";
    assert!(told.contains(five) && !told.contains("damping"), "{told}");
    let notes = robot
        .report(&robot.default_posture())
        .expect("a report")
        .notes;
    let lines = notes
        .iter()
        .filter(|note| note.contains("masses of base_link"));
    assert_eq!(lines.count(), 1, "{notes:?}");
    // Every mode is damped as the rule's interval has it, the fastest, too.
    let modes = robot.modes(&robot.default_posture(), None).expect("modes");
    let is_usual = |ratio: &f64| (0.01..0.06).contains(ratio);
    assert!(modes.damping_ratio.iter().all(is_usual), "{modes:?}");
}

#[test]
fn an_impossible_data_sheet_is_refused() {
    for (mass_kg, payload_kg, quotes) in [
        (None, 20.0, &["give the arm's mass with --mass"][..]),
        (Some(20.0), 250.0, &["no arm carries more than it weighs"]),
        (Some(-250.0), 20.0, &["above 0"]),
        (Some(250.0), f64::NAN, &["above 0"]),
        (
            Some(0.001),
            0.0005,
            &["--mass 0.001 kg", "kg/m^2", "below 1.5"],
        ),
        (
            Some(1e5),
            2e4,
            &["--mass 100000 kg", "above 2400", "5 to 800"],
        ),
        (
            Some(250.0),
            1.0,
            &["--payload 1 kg", "0.004 of the arm's 250 kg", "0.03 to 0.5"],
        ),
    ] {
        let error = estimated(&six_axis(), mass_kg, payload_kg).expect_err(quotes[0]);
        for quote in quotes {
            assert!(error.message().contains(quote), "{error}");
        }
    }
    let good = sheet(Some(250.0), 20.0);
    let with_reach = |reach_m| DataSheet {
        reach_m: Some(reach_m),
        ..good
    };
    let with_scatter = |mm| DataSheet {
        repeatability_mm: Some(mm),
        ..good
    };
    for (sheet, quote) in [
        (with_reach(3.5), "--reach 3.5 m is "),
        (with_reach(0.3), "below 0.4"),
        (with_scatter(60.0), "--repeatability 60 mm"),
        (with_scatter(1e-5), "below 0.0005"),
    ] {
        let error = by_sheet(&six_axis(), sheet).expect_err(quote);
        assert!(error.message().contains(quote), "{error}");
    }
}

/// What no data sheet known says, but might, is told and goes on.
#[test]
fn a_rare_data_sheet_is_told() {
    let good = sheet(Some(250.0), 20.0);
    assert_eq!(by_sheet(&six_axis(), good).expect("good").notes, [""; 0]);
    for (sheet, quote) in [
        (sheet(Some(250.0), 4.0), "0.016 of the arm's 250 kg"),
        (sheet(Some(2500.0), 100.0), "kg/m^2"),
        (
            DataSheet {
                reach_m: Some(0.8),
                ..good
            },
            "--reach 0.8 m",
        ),
        (
            DataSheet {
                repeatability_mm: Some(2.0),
                ..good
            },
            "--repeatability 2 mm",
        ),
    ] {
        let notes = by_sheet(&six_axis(), sheet).expect(quote).notes.join("\n");
        assert!(
            notes.contains(quote) && notes.contains("right unit?"),
            "{notes}"
        );
    }
}

/// A reach is never beyond the stretched chain: what the forward kinematics come to at drawn
/// postures is accepted as a reach, and what is further than all links in a row is not.
#[test]
fn a_reach_that_the_chain_has_is_taken() {
    let reading = Reading {
        masses: Masses::NotNeeded,
        ..Reading::default()
    };
    let robot = Robot::read(&six_axis(), &reading).expect("an arm");
    let first = robot.chain.joints[0].parent_from_joint;
    let postures = prop::collection::vec(-3.0..3.0_f64, robot.dof());
    let mut runner = TestRunner::deterministic();
    let mut reach_m: f64 = 0.0;
    for _ in 0..2000 {
        let q = postures.new_tree(&mut runner).expect("a posture").current();
        let flange = robot.world_from_frame(&q, truecut_arm::FrameId::Flange);
        let at = first.inverse() * flange.translation.vector;
        reach_m = reach_m.max(at.x.hypot(at.y));
    }
    let good = sheet(Some(250.0), 20.0);
    let reach = |reach_m| {
        by_sheet(
            &six_axis(),
            DataSheet {
                reach_m: Some(reach_m),
                ..good
            },
        )
    };
    assert_eq!(reach(reach_m).expect("it reaches so far").notes, [""; 0]);
    let message = reach(5.0 * reach_m).expect_err("too far").message();
    let stretched = message
        .split("of the ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let stretched: f64 = stretched.expect("told").parse().expect("a length");
    assert!(
        stretched >= reach_m && reach(stretched + 0.01).is_err(),
        "{message}"
    );
}

/// What the tool moves by under the force that is told is the repeatability.
#[test]
fn verify_the_force_that_a_repeatability_hides() {
    let sheet = DataSheet {
        repeatability_mm: Some(0.06),
        ..sheet(Some(250.0), 20.0)
    };
    let text = by_sheet(&six_axis(), sheet).expect("good").text;
    let told = text.split("as much under ").nth(1).expect("told");
    let force_n: f64 = told.split(' ').next().expect("a word").parse().expect("N");
    let robot = with(&six_axis(), &text);
    let q = robot.default_posture();
    let load = truecut_arm::Load::none();
    let compliance = robot.cartesian_compliance(&q, truecut_arm::FrameId::Tool, &load);
    let compliance = compliance
        .expect("elastic")
        .fixed_view::<3, 3>(0, 0)
        .into_owned();
    // No force of this size moves the tool further, and one does move it so far.
    let furthest_m = (0..20_000).map(|i| {
        let (z, turn) = (
            2.0 * (f64::from(i) + 0.5) / 20_000.0 - 1.0,
            2.399_963_f64 * f64::from(i),
        );
        let radius = (1.0 - z * z).sqrt();
        let direction = nalgebra::Vector3::new(radius * turn.cos(), radius * turn.sin(), z);
        (compliance * direction * force_n).norm()
    });
    let furthest_m = furthest_m.fold(0.0, f64::max);
    // The force is told with two digits.
    assert!((furthest_m / 0.06e-3 - 1.0).abs() < 0.05, "{furthest_m} m");
}

/// What comes of the HP20's data sheet if its file has these efforts, by the joint's number.
fn with_efforts(effort: impl Fn(usize) -> String) -> Estimated {
    let text = std::fs::read_to_string(asset("hp20")).expect("the asset");
    let mut parts = text.split("effort=\"");
    let mut changed = parts.next().expect("a head").to_owned();
    for (index, part) in parts.enumerate() {
        let rest = part.split_once('"').expect("a value").1;
        changed += &format!("effort=\"{}\"{rest}", effort(index));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let urdf = folder.path().join("weak.urdf");
    std::fs::write(&urdf, changed).expect("written");
    by_sheet(&urdf, sheet(None, 20.0)).expect("estimated")
}

/// A mass that is spread over all links takes the place of what the file gives, which is said.
#[test]
fn masses_of_the_file_that_are_not_used_are_told() {
    let notes = |mass_kg| {
        let estimated = by_sheet(&asset("hp20"), sheet(mass_kg, 20.0));
        estimated.expect("estimated").notes.join("\n")
    };
    let told = notes(Some(268.0));
    for of_file in ["link_2 (32.0000 kg)", "end_effector (9.0000 kg)"] {
        assert!(told.contains(of_file), "{of_file}: {told}");
    }
    assert!(!notes(None).contains("not used"));
}

/// An effort that is far from holding the arm is a placeholder and no limit; one that holds it in
/// some postures only is kept, and told.
#[test]
fn efforts_that_do_not_hold_the_arm_are_told() {
    let of_second = |effort: &str| {
        let effort = effort.to_owned();
        with_efforts(move |index| {
            if index == 1 {
                effort.clone()
            } else {
                "1e5".into()
            }
        })
    };
    let estimated = of_second("100");
    let second = &Robot::load(&asset("hp20"), None, None)
        .expect("the asset")
        .chain
        .joints[1]
        .name;
    let [note] = &estimated.notes[..] else {
        panic!("{:?}", estimated.notes);
    };
    let (what, held) = note
        .split_once(&format!(": {second} (100 of "))
        .expect("the joint");
    assert!(what.contains("are not used"), "{note}");
    let replaced = "since the URDF's 100 does not hold the arm";
    assert!(estimated.text.contains(replaced));
    assert_eq!(estimated.text.matches("limit of the URDF").count(), 5);

    let held: f64 = held.trim_end_matches(')').parse().expect("a torque");
    for (share, told) in [
        (0.32, "are not used"),
        (0.35, "are kept"),
        (0.98, "are kept"),
    ] {
        let effort = format!("{:.1}", share * held);
        let estimated = of_second(&effort);
        let [note] = &estimated.notes[..] else {
            panic!("{share}: {:?}", estimated.notes);
        };
        assert!(
            note.contains(told) && note.contains(&effort),
            "{share}: {note}"
        );
    }
    assert_eq!(of_second(&format!("{:.1}", 1.02 * held)).notes, [""; 0]);

    // Gravity hardly loads the axes of a wrist: a small drive is enough, and no placeholder. A
    // little smaller, it is kept.
    let of_wrist = |effort: &str| {
        let effort = effort.to_owned();
        with_efforts(move |index| {
            if index >= 3 {
                effort.clone()
            } else {
                "1e5".into()
            }
        })
    };
    assert_eq!(of_wrist("45").notes, [""; 0]);
    let [note] = &of_wrist("40").notes[..] else {
        panic!("one note");
    };
    assert!(note.contains("are kept") && note.contains("joint_4 (40 of 42), joint_5 (40 of 42)"));
}

/// Names as XML allows them: quotes, backslashes, breaks, letters of any script.
fn name() -> impl Strategy<Value = String> {
    let one = prop::sample::select(vec![
        "a", "J", "7", "-", "_", " ", ".", "#", "=", "[", "]", "{", "\"", "'", "\\", "\\u", "\t",
        "\n", "ß", "漢", "µ", "\u{7f}", "\u{85}",
    ]);
    prop::collection::vec(one, 1..6).prop_map(|parts| parts.concat())
}

fn as_xml(name: &str) -> String {
    name.chars()
        .map(|letter| format!("&#{};", u32::from(letter)))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// What is estimated for an arm of any names reads back: every joint and link has its values.
    #[test]
    fn an_estimate_reads_back_whatever_the_names(
        names in prop::collection::vec(name(), 6),
        arm in name(),
        mass_kg in prop::option::of(150.0..400.0_f64),
        payload_kg in 5.0..40.0_f64,
    ) {
        let text = std::fs::read_to_string(asset("hp20")).expect("the asset");
        let mut text = text.replace("<robot name=\"hp20\"", &format!("<robot name=\"{}\"", as_xml(&arm)));
        for (index, name) in names.iter().enumerate() {
            // A number makes them differ.
            for what in ["joint", "link"] {
                let old = format!("\"{what}_{}\"", index + 1);
                text = text.replace(&old, &format!("\"{}{index}\"", as_xml(name)));
            }
        }
        let folder = tempfile::tempdir().expect("a folder");
        let urdf = folder.path().join("arm.urdf");
        std::fs::write(&urdf, text).expect("written");
        let nameless = Robot::load(&asset("hp20"), None, None).expect("the asset");
        let estimated = by_sheet(&urdf, sheet(mass_kg, payload_kg));
        // What a sheet refuses for its numbers it refuses for the asset, too.
        let plain = by_sheet(&asset("hp20"), sheet(mass_kg, payload_kg));
        prop_assert_eq!(estimated.is_ok(), plain.is_ok());
        if let (Ok(estimated), Ok(plain)) = (estimated, plain) {
            let robot = with(&urdf, &estimated.text);
            let expected = with(&asset("hp20"), &plain.text);
            prop_assert_eq!(masses(&robot), masses(&expected));
            for (index, (joint, other)) in robot.chain.joints.iter().zip(&expected.chain.joints).enumerate() {
                prop_assert_eq!(&joint.name, &format!("{}{index}", names[index]));
                prop_assert_eq!(&joint.transmission, &other.transmission);
                prop_assert!(joint.transmission != nameless.chain.joints[index].transmission);
            }
        }
    }
}
