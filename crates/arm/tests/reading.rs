//! What is made of a good robot file: merging, choice of the tip, defaults, frames.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use truecut_arm::{FrameId, JointKind, Robot, Shape};

fn urdf(text: &str) -> Robot {
    urdf_with_tip(text, None)
}

fn urdf_with_tip(text: &str, tip: Option<&str>) -> Robot {
    let text = format!("<robot name=\"r\">{text}</robot>");
    Robot::from_texts((&text, Path::new("r.urdf")), None, tip).expect("a good file")
}

fn link(name: &str, mass_kg: f64, com: &str) -> String {
    format!(
        "<link name=\"{name}\"><inertial><origin xyz=\"{com}\"/><mass value=\"{mass_kg}\"/>\
         <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.2\" iyz=\"0\" izz=\"0.25\"/></inertial></link>"
    )
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, extra: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         <axis xyz=\"0 0 1\"/>{extra}</joint>"
    )
}

fn limit(lower: f64, upper: f64) -> String {
    format!("<limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"1\" effort=\"2\"/>")
}

/// Two bodies fixed to each other are one: masses add, the centre is their mean, and inertia
/// follows the parallel-axis theorem, here worked by hand for 1 kg and 3 kg, 0.4 m apart along x,
/// the second turned by 90° about z.
#[test]
fn verify_fixed_links_are_merged_by_the_parallel_axis_theorem() {
    let robot = urdf(
        &[
            "<link name=\"base\"/>".into(),
            joint("j", "continuous", "base", "a", ""),
            link("a", 1.0, "0 0 0"),
            joint(
                "weld",
                "fixed",
                "a",
                "b",
                "<origin xyz=\"0.4 0 0\" rpy=\"0 0 1.5707963267948966\"/>",
            ),
            link("b", 3.0, "0 0 0"),
        ]
        .concat(),
    );
    let merged = &robot.chain.links[0];
    assert_eq!(
        (robot.dof(), merged.name.as_str(), merged.mass_kg),
        (1, "a", 4.0)
    );
    assert!((merged.com_m - Vector3::new(0.3, 0.0, 0.0)).amax() <= 1e-15);
    // Own tensors (.1, .2, .25) and, turned, (.2, .1, .25); Steiner 1·.3² + 3·.1² = .12 about y and
    // z.
    let expected = Matrix3::from_diagonal(&Vector3::new(0.3, 0.3 + 0.12, 0.5 + 0.12));
    assert!((merged.inertia_about_com_kg_m2 - expected).amax() <= 1e-15);
    let flange = robot.world_from_frame(&[0.0], FrameId::Flange);
    assert!((flange.translation.vector - Vector3::new(0.4, 0.0, 0.0)).amax() <= 1e-15);
}

/// A gripper that opens is a side branch: it counts as mass at zero opening, and a note says so.
#[test]
fn side_branches_are_merged_at_zero_with_a_note() {
    let fingers = |mimic: &str| {
        [
            "<link name=\"base\"/>".into(),
            joint("j", "revolute", "base", "hand", &limit(-1.0, 1.0)),
            link("hand", 2.0, "0 0 0"),
            joint(
                "tcp_mount",
                "fixed",
                "hand",
                "tcp",
                "<origin xyz=\"0 0 0.1\"/>",
            ),
            "<link name=\"tcp\"/>".into(),
            joint(
                "open_left",
                "prismatic",
                "hand",
                "left",
                &(limit(0.0, 0.04) + "<origin xyz=\"0 0.02 0.1\"/>"),
            ),
            link("left", 0.5, "0 0 0"),
            joint(
                "open_right",
                "prismatic",
                "hand",
                "right",
                &(limit(0.0, 0.04) + mimic),
            ),
            link("right", 0.5, "0 0 0"),
        ]
        .concat()
    };
    let robot = urdf(&fingers("<mimic joint=\"open_left\"/>"));
    assert_eq!(robot.chain.tip, "tcp");
    assert_eq!(robot.dof(), 1);
    assert_eq!(robot.chain.links[0].mass_kg, 3.0);
    let notes = robot.chain.notes.join("\n");
    assert!(
        notes.contains("tip \"tcp\" was chosen as the frame at the end of the arm"),
        "{notes}"
    );
    assert!(notes.contains("side branch at link \"hand\""), "{notes}");
    assert!(
        notes.contains("open_left") && notes.contains("open_right (mimics open_left)"),
        "{notes}"
    );

    // The finger itself as tip: its joint is then on the chain, the other finger is the side
    // branch.
    let robot = urdf_with_tip(&fingers("<mimic joint=\"open_left\"/>"), Some("left"));
    assert_eq!(robot.dof(), 2);
    assert_eq!(robot.chain.joints[1].kind, JointKind::Prismatic);
    // A link in the middle: everything beyond it is merged.
    let robot = urdf_with_tip(&fingers(""), Some("hand"));
    assert_eq!((robot.dof(), robot.chain.links[0].mass_kg), (1, 3.0));
}

/// A massless link may move if something with mass is fixed to it.
#[test]
fn a_massless_link_borrows_mass_from_what_is_fixed_to_it() {
    let robot = urdf(
        &[
            "<link name=\"base\"/><link name=\"frame\"/>".into(),
            joint("j", "continuous", "base", "frame", ""),
            joint("weld", "fixed", "frame", "body", ""),
            link("body", 5.0, "0.1 0 0"),
        ]
        .concat(),
    );
    assert_eq!(robot.chain.links[0].mass_kg, 5.0);
}

#[test]
fn the_tip_is_the_longest_chain_or_a_conventional_name() {
    let arm = |leaves: &str| {
        [
            "<link name=\"base\"/>".into(),
            joint("j1", "continuous", "base", "a", ""),
            link("a", 1.0, "0 0 0"),
            joint("j2", "continuous", "a", "b", ""),
            link("b", 1.0, "0 0 0"),
            leaves.to_owned(),
        ]
        .concat()
    };
    // One leaf.
    assert_eq!(urdf(&arm("")).chain.tip, "b");
    // A massive leaf on a shorter branch and a camera frame at the base: the longest chain.
    let camera = joint("c", "fixed", "base", "camera", "") + "<link name=\"camera\"/>";
    let elbow =
        joint("k", "fixed", "a", "counterweight", "") + &link("counterweight", 9.0, "0 0 0");
    assert_eq!(urdf(&arm(&(camera.clone() + &elbow))).chain.tip, "b");
    // Two frames at the end, one with a name that everybody knows.
    let frames = joint("f1", "fixed", "b", "ee", "")
        + "<link name=\"ee\"/>"
        + &joint("f2", "fixed", "b", "tool0", "")
        + "<link name=\"tool0\"/>";
    assert_eq!(urdf(&arm(&(camera + &frames))).chain.tip, "tool0");
}

#[test]
fn limits_and_dynamics_of_the_urdf_are_kept() {
    let robot = urdf(
        &[
            "<link name=\"base\"/>".into(),
            joint(
                "free",
                "continuous",
                "base",
                "a",
                "<dynamics damping=\"1.5\" friction=\"0.25\"/>",
            ),
            link("a", 1.0, "0 0 0"),
            joint(
                "bound",
                "revolute",
                "a",
                "b",
                "<limit lower=\"-1\" upper=\"2\" velocity=\"3\" effort=\"0\"/>",
            ),
            link("b", 1.0, "0 0 0"),
            joint(
                "bare",
                "revolute",
                "b",
                "c",
                "<limit velocity=\"3\" effort=\"4\"/>",
            ),
            link("c", 1.0, "0 0 0"),
        ]
        .concat(),
    );
    let [free, bound, bare] = &robot.chain.joints[..] else {
        panic!("three joints")
    };
    assert_eq!(free.limits, None);
    assert_eq!((free.urdf_damping, free.transmission.damping), (1.5, 1.5));
    assert_eq!(
        (free.urdf_friction, free.transmission.dry_friction),
        (0.25, 0.25)
    );
    assert_eq!(free.transmission.stiffness, None);
    let limits = bound.limits.expect("given");
    assert_eq!(
        (limits.lower, limits.upper, limits.velocity),
        (-1.0, 2.0, 3.0)
    );
    assert!(limits.effort.is_infinite(), "zero effort means not given");
    let limits = bare.limits.expect("speed given");
    assert!(limits.lower.is_infinite() && limits.upper.is_infinite());
    assert!(
        robot
            .chain
            .notes
            .iter()
            .any(|n| n.contains("\"bare\" has no position limits"))
    );
}

#[test]
fn a_long_axis_is_normalised_and_noted() {
    let text = "<link name=\"base\"/>".to_owned()
        + "<joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"a\"/><axis xyz=\"0 2 0\"/></joint>"
        + &link("a", 1.0, "0 0 0");
    let robot = urdf(&text);
    assert_eq!(robot.chain.joints[0].axis, Vector3::y_axis());
    assert!(
        robot.chain.notes[0].contains("length 2 was normalised"),
        "{:?}",
        robot.chain.notes
    );
}

/// Shapes are kept with their colour, meshes are counted, and careless collision or texture
/// elements do not matter.
#[test]
fn visuals_are_read_and_the_rest_is_forgiven() {
    let robot = urdf(
        "<material name=\"red\"><color rgba=\"1 0 0 1\"/><texture/></material>\
         <gazebo><collision/></gazebo>\
         <link name=\"base\"><visual><geometry><sphere radius=\"0.1\"/></geometry></visual></link>\
         <joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"a\"/><axis xyz=\"0 0 1\"/></joint>\
         <link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>\
         <visual><origin xyz=\"0 0 1\"/><geometry><box size=\"1 2 4\"/></geometry><material name=\"red\"/></visual>\
         <visual><geometry><mesh filename=\"package://nowhere/a.stl\"/></geometry></visual>\
         <collision><geometry><capsule/></geometry></collision></link>\
         <joint name=\"weld\" type=\"fixed\"><parent link=\"a\"/><child link=\"pin\"/>\
         <origin xyz=\"0.5 0 0\" rpy=\"0 0 1.5707963267948966\"/></joint>\
         <link name=\"pin\"><visual><origin xyz=\"0.2 0 0\"/><geometry><cylinder radius=\"0.1\" length=\"1\"/></geometry></visual></link>",
    );
    assert_eq!(robot.chain.base.visuals.len(), 1);
    let [visual, pin] = &robot.chain.links[0].visuals[..] else {
        panic!("two shapes")
    };
    let at = pin.link_from_visual.translation.vector;
    assert!(
        (at - Vector3::new(0.5, 0.2, 0.0)).amax() <= 1e-15,
        "shapes of fixed links move with them: {at}"
    );
    assert_eq!(
        visual.shape,
        Shape::Box {
            half_extents_m: Vector3::new(0.5, 1.0, 2.0)
        }
    );
    assert_eq!(visual.color_rgba, [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(visual.link_from_visual.translation.vector.z, 1.0);
    assert!(
        robot
            .chain
            .notes
            .iter()
            .any(|n| n.contains("package \"nowhere\" is not found")),
        "{:?}",
        robot.chain.notes
    );
}

const CONFIG: &str = r#"
name = "Two"
[frames.tool]
xyz_m = [0.0, 0.0, 0.25]
rpy_deg = [0.0, 90.0, 0.0]
[[joint]]
name = "j"
stiffness_nm_per_rad = 5e5
damping_nm_s_per_rad = 700
source = { stiffness = "data sheet", damping = "estimated" }
[joint.servo]
position_gain_per_s = 20
velocity_gain_nm_s_per_rad = 3e3
torque_limit_nm = 1e3
"#;

#[test]
fn the_config_sets_transmissions_and_frames() {
    let text = "<robot name=\"r\"><link name=\"base\"/>".to_owned()
        + &joint(
            "j",
            "continuous",
            "base",
            "a",
            "<dynamics damping=\"1.5\" friction=\"0.25\"/>",
        )
        + &link("a", 1.0, "0 0 0")
        + "</robot>";
    let read = |config: &str| {
        Robot::from_texts(
            (&text, Path::new("r.urdf")),
            Some((config, Path::new("robot.toml"))),
            None,
        )
    };
    let error = read(CONFIG)
        .expect_err("the servo has no source")
        .to_string();
    assert!(
        error.contains("has no source") && error.contains("servo = \"...\""),
        "{error}"
    );

    let robot = read(&CONFIG.replace("\"estimated\" }", "\"estimated\", servo = \"estimated\" }"))
        .expect("good");
    assert_eq!(robot.name, "Two");
    let transmission = &robot.chain.joints[0].transmission;
    assert_eq!(
        (transmission.stiffness, transmission.damping),
        (Some(5e5), 700.0)
    );
    assert_eq!(
        transmission.dry_friction, 0.25,
        "not in the config: the URDF's"
    );
    assert_eq!(robot.chain.joints[0].urdf_damping, 1.5);
    assert_eq!(transmission.sources.stiffness, "data sheet");
    assert_eq!(transmission.servo.expect("given").velocity_gain, 3e3);
    let tool = robot.world_from_frame(&[0.0], FrameId::Tool);
    assert!(
        (tool * Vector3::z() - Vector3::x()).amax() <= 1e-15,
        "z turned by 90 degrees about y"
    );
    assert_eq!(
        robot.world_from_frame(&[0.0], FrameId::Foot),
        tool,
        "the foot is the tool unless it is given"
    );
}

/// The format as the documentation of the module `config` shows it is a format that is read.
#[test]
fn the_documented_config_is_good() {
    let documentation = include_str!("../src/config.rs");
    let example: String = (documentation.lines())
        .skip_while(|line| !line.starts_with("//! ```toml"))
        .skip(1)
        .take_while(|line| !line.starts_with("//! ```"))
        .map(|line| line.trim_start_matches("//!").to_owned() + "\n")
        .collect();
    let text = "<robot name=\"r\"><link name=\"base\"/>".to_owned()
        + &joint("joint_1", "continuous", "base", "link_1", "")
        + &link("link_1", 1.0, "0 0 0")
        + &joint("mount", "fixed", "link_1", "rest", "")
        + &link("rest", 363.0, "0 0 0")
        + "</robot>";
    let config = (example.as_str(), Path::new("robot.toml"));
    let robot = Robot::from_texts((&text, Path::new("r.urdf")), Some(config), None)
        .unwrap_or_else(|error| panic!("{error}\n{example}"));
    let transmission = &robot.chain.joints[0].transmission;
    assert_eq!(transmission.stiffness, Some(2.117e6));
    assert_eq!(robot.chain.joints[0].linear_to(), 0.01);
    assert!(transmission.servo.is_some());
    assert_eq!(robot.chain.links[0].mass_kg, 425.0);
}

/// The process frame: X along the tool, Y horizontal, and a rule for a vertical tool.
#[test]
fn verify_process_frame() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    let load = |name: &str| {
        Robot::load(&root.join(name).join("robot.urdf"), None, None).expect("the asset loads")
    };
    let rig = load("rig_planar").world_from_process(&[0.01, 0.02, 0.03]);
    assert!(
        rig.rotation.angle() <= 1e-15,
        "the rig's process frame is the world's"
    );
    assert!((rig.translation.vector - Vector3::new(0.36, 0.02, 0.03)).amax() <= 1e-15);

    let arm = load("irb6600_175_255");
    let q = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95].map(f64::to_radians);
    let axes = arm.world_from_process(&q);
    let tool_z = arm.world_from_frame(&q, FrameId::Tool) * Vector3::z();
    assert!((axes * Vector3::x() - tool_z).amax() <= 1e-12);
    assert!((axes * Vector3::y()).z.abs() <= 1e-12);
    assert!(
        (axes * Vector3::z()).z > 0.99,
        "Z points up for a horizontal tool"
    );

    // Straight down: q2 + q3 + 90 degrees = 180 degrees with the wrist straight.
    let down = arm.world_from_process(&[0.0, 0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0]);
    assert!((down * Vector3::x() + Vector3::z()).amax() <= 1e-12);
    assert!(
        (down * Vector3::y() + Vector3::y()).amax() <= 1e-12,
        "X cross world x"
    );
}

/// Letters of other languages, in the encoding that the head of the file names; without a head
/// they are UTF-8.
#[test]
fn the_encoding_that_a_file_names_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("arm.urdf");
    let body = "<robot name=\"Gr\u{f6}\u{df}e\"><link name=\"base\"/><link name=\"arm\"/>\
                <joint name=\"j\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/>\
                <axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/>\
                </joint></robot>";
    let latin: Vec<u8> = body
        .chars()
        .map(|c| u8::try_from(c).expect("Latin-1"))
        .collect();
    for head in [
        "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n",
        "<?xml version='1.0' encoding='windows-1252'?>\n",
    ] {
        std::fs::write(&file, [head.as_bytes(), &latin].concat()).expect("a file");
        let robot = Robot::load_kinematics(&file, None, None).expect(head);
        assert_eq!(robot.chain.name, "Gr\u{f6}\u{df}e");
    }
    std::fs::write(&file, body).expect("a file");
    let robot = Robot::load_kinematics(&file, None, None).expect("UTF-8");
    assert_eq!(robot.chain.name, "Gr\u{f6}\u{df}e");
}
