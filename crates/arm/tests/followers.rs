//! Joints that others take along (`<mimic>`), shapes that cannot be drawn, arguments that nobody
//! asks for: arms that have them are read as far as they are good.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Vector3;
use truecut_arm::{ArmError, FrameId, MjcfDrive, MjcfOptions, Reading, Robot, to_mjcf};

fn read(text: &str, config: Option<&str>) -> Result<Robot, ArmError> {
    let text = format!("<robot name=\"r\">{text}</robot>");
    let config = config.map(|config| (config, Path::new("robot.toml")));
    Robot::from_texts((&text, Path::new("r.urdf")), config, None)
}

fn link(name: &str, inner: &str) -> String {
    format!(
        "<link name=\"{name}\"><inertial><mass value=\"2\"/><inertia ixx=\"0.1\" ixy=\"0\" \
         ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial>{inner}</link>"
    )
}

fn joint(name: &str, parent: &str, child: &str, inner: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/>\
         <child link=\"{child}\"/><origin xyz=\"0 0 0.5\"/><axis xyz=\"0 1 0\"/>\
         <limit lower=\"-2\" upper=\"2\" velocity=\"1\" effort=\"9\"/>{inner}</joint>"
    )
}

/// Two rods of 0.5 m above a foot; the upper one is turned back by as much as the lower one leans.
fn parallelogram(mimic: &str) -> String {
    [
        link("base", ""),
        joint("lean", "base", "lower", ""),
        link("lower", ""),
        joint("level", "lower", "upper", mimic),
        link("upper", ""),
        "<joint name=\"end\" type=\"fixed\"><parent link=\"upper\"/><child link=\"tip\"/>\
         <origin xyz=\"0.4 0 0\"/></joint><link name=\"tip\"/>"
            .to_owned(),
    ]
    .concat()
}

const LEVEL: &str = "<mimic joint=\"lean\" multiplier=\"-1\"/>";

#[test]
fn verify_a_parallelogram_keeps_its_hand_level() {
    let robot = read(&parallelogram(LEVEL), None).expect("a good arm");
    assert_eq!(robot.dof(), 1);
    assert_eq!(robot.chain.tip, "tip");
    for q in [-1.9, -0.3, 0.0, 0.7, 1.4] {
        let flange = robot.world_from_frame(&[q], FrameId::Flange);
        let expected = Vector3::new(0.5 * q.sin() + 0.4, 0.0, 0.5 + 0.5 * q.cos());
        assert!((flange.translation.vector - expected).norm() < 1e-14);
        assert!(flange.rotation.angle() < 1e-14);
        // The hand is carried round a circle without turning: its mass counts as a point's, and the
        // lower rod adds its own inertia.
        let mass = robot.mass_matrix(&[q])[(0, 0)];
        assert!((mass - (0.1 + 2.0 * 0.25)).abs() < 1e-14, "{mass}");
        let jacobian = robot.jacobian(&[q], FrameId::Flange);
        assert!((jacobian[(0, 0)] - 0.5 * q.cos()).abs() < 1e-14);
        assert!(jacobian.fixed_rows::<3>(3).norm() < 1e-14);
    }
    let notes = robot.chain.notes.join("\n");
    assert!(notes.contains("\"level\" moves with \"lean\""), "{notes}");
}

/// A spring of 8000 N m/rad in the one joint: pushed sideways at a lever of 0.5 m it gives
/// 8000 / 0.25 = 32 kN/m.
#[test]
fn verify_a_follower_gives_way_with_the_joint_that_it_follows() {
    let config = "[[joint]]\nname = \"lean\"\nstiffness_nm_per_rad = 8e3\n\
                  [joint.source]\nstiffness = \"test\"\n";
    let robot = read(&parallelogram(LEVEL), Some(config)).expect("a good arm");
    let load = truecut_arm::Load::none();
    let compliance = robot.cartesian_compliance(&[0.0], FrameId::Flange, &load);
    let along_x = compliance.expect("it has a stiffness")[(0, 0)];
    assert!((1.0 / along_x - 32e3).abs() < 1e-6, "{along_x}");

    let own = config.replace("lean", "level");
    let error = read(&parallelogram(LEVEL), Some(&own)).expect_err("a follower has no spring");
    assert!(
        error.message().contains("no transmission of its own"),
        "{error}"
    );
}

/// Limits of what follows bound the joint that it follows.
#[test]
fn limits_of_a_follower_are_kept() {
    let text = parallelogram("<mimic joint=\"lean\" multiplier=\"3\" offset=\"0.5\"/>");
    let robot = read(&text, None).expect("a good arm");
    assert!(robot.check_posture(&[0.49]).is_ok());
    let error = robot
        .check_posture(&[0.51])
        .expect_err("3 · 0.51 + 0.5 > 2");
    assert!(error.message().contains("\"level\""), "{error}");
}

/// A joint that follows one beside the chain stands at its offset, since that is held at zero.
#[test]
fn verify_a_follower_of_a_side_branch_stands_at_its_offset() {
    let text = parallelogram("<mimic joint=\"grip\" multiplier=\"2\" offset=\"0.3\"/>")
        + &joint("grip", "lower", "finger", "")
        + &link("finger", "");
    let text = format!("<robot name=\"r\">{text}</robot>");
    let robot = Robot::from_texts((&text, Path::new("r.urdf")), None, Some("tip"));
    let robot = robot.expect("a good arm");
    assert_eq!(robot.dof(), 1);
    let flange = robot.world_from_frame(&[0.0], FrameId::Flange);
    let turned = Vector3::new(0.4 * 0.3_f64.cos(), 0.0, 1.0 - 0.4 * 0.3_f64.sin());
    assert!(
        (flange.translation.vector - turned).norm() < 1e-14,
        "{flange}"
    );
    let notes = robot.chain.notes.join("\n");
    assert!(notes.contains("held at 0.3"), "{notes}");
}

#[test]
fn what_moves_every_joint_by_itself_refuses_followers() {
    let robot = read(&parallelogram(LEVEL), None).expect("a good arm");
    let options = MjcfOptions {
        posture: vec![0.0],
        command: vec![0.0],
        gravity_m_s2: Vector3::zeros(),
        drive: MjcfDrive::Free,
        time_step_s: 1e-3,
    };
    let error = to_mjcf(&robot, &options).expect_err("a follower");
    assert!(
        error.message().contains("\"level\" moves with \"lean\""),
        "{error}"
    );
}

#[test]
fn shapes_that_cannot_be_drawn_are_left_out_with_a_note() {
    let shape = |inner: &str| format!("<visual>{inner}</visual>");
    let shapes = [
        ("<geometry><capsule name=\"c\"/></geometry>", "no radius"),
        ("<geometry><torus radius=\"1\"/></geometry>", "<torus>"),
        ("<geometry><box size=\"1 1\"/></geometry>", "not 3 finite"),
        ("<geometry/>", "empty"),
        ("<origin xyz=\"0 0 0\"/>", "no <geometry>"),
        (
            "<geometry><sphere radius=\"1\"/></geometry><origin xyz=\"nan 0 0\"/>",
            "\"nan 0 0\"",
        ),
    ];
    let good = shape("<geometry><sphere radius=\"0.25\"/></geometry>");
    for (bad, why) in shapes {
        let text = [
            link("base", ""),
            joint("j", "base", "a", "<hardwareInterface/>"),
            link(
                "a",
                &(shape(bad)
                    + &good
                    + "<collision_checking><capsule name=\"t\"/></collision_checking>"),
            ),
        ]
        .concat();
        let robot = read(&text, None).expect(bad);
        assert_eq!(robot.chain.links[0].visuals.len(), 1, "{bad}");
        let notes = robot.chain.notes.join("\n");
        assert!(
            notes.contains("link \"a\" is not drawn") && notes.contains(why),
            "{bad}: {notes}"
        );
    }
}

#[test]
fn misspelt_elements_are_told_and_those_of_other_programs_are_not() {
    let text = |in_joint: &str| {
        [
            link("base", ""),
            joint("j", "base", "a", in_joint),
            link("a", "<collision_checking/>"),
        ]
        .concat()
    };
    let notes = |in_joint: &str| {
        let robot = read(&text(in_joint), None).expect(in_joint);
        robot.chain.notes.join("\n")
    };
    let told = notes("<dynamic damping=\"3\"/>");
    assert!(
        told.contains("<dynamic> of joint \"j\" is not read; did you mean <dynamics>?"),
        "{told}"
    );
    let others = notes("<hardwareInterface>x</hardwareInterface><safety_controller/>");
    assert!(!others.contains("not read"), "{others}");
}

#[test]
fn arguments_that_no_file_asks_for_are_told() {
    let xacro = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/crosscheck/xacro/slide_arm_description/urdf/slide_arm.xacro"
    );
    let urdf = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/robots/irb6600_175_255/robot.urdf"
    );
    for (file, name, said) in [
        (xacro, "jionts", "did you mean \"joints\"?"),
        (xacro, "xyz", "its arguments are"),
        (urdf, "joints", "no xacro"),
    ] {
        let reading = Reading {
            arguments: BTreeMap::from([(name.to_owned(), "2".to_owned())]),
            ..Reading::default()
        };
        let error = Robot::read(Path::new(file), &reading).expect_err(name);
        assert!(error.message().contains(said), "{error}");
        assert_eq!(error.path(), Some(Path::new(file)));
    }
}
