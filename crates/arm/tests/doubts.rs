//! Robot files in other units, and flanges that do not point out of the wrist.

use std::fmt::Write;
use std::path::Path;

use proptest::prelude::*;
use truecut_arm::Robot;

/// An arm with the last joint along x; offsets in the file's unit, limits in the file's unit, and
/// the turn of its flange.
fn urdf(offsets: &[f64], limits: &[(f64, f64)], flange_rpy: [f64; 3]) -> String {
    // Of a radius of gyration of 0.06 m: more than a ball of steel has, less than any arm drawn.
    let inertia = |mass: f64| {
        let [x, y, z] = [1.0, 1.2, 0.8].map(|share| share * 0.0024 * mass);
        format!("<inertia ixx=\"{x}\" iyy=\"{y}\" izz=\"{z}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>")
    };
    let mut text = "<robot name=\"drawn\">\n<link name=\"l0\"/>\n".to_owned();
    for (i, (offset, (lower, upper))) in offsets.iter().zip(limits).enumerate() {
        let axis = if i + 1 == offsets.len() {
            "1 0 0"
        } else {
            "0 1 0"
        };
        let mass = 5.0 + i as f64;
        let inertia = inertia(mass);
        let next = i + 1;
        writeln!(
            text,
            "<link name=\"l{next}\"><inertial><mass value=\"{mass}\"/>{inertia}</inertial></link>\n\
             <joint name=\"j{next}\" type=\"revolute\"><parent link=\"l{i}\"/><child link=\"l{next}\"/>\
             <origin xyz=\"{offset} 0 0\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"3\" effort=\"500\"/></joint>"
        )
        .unwrap();
    }
    let [r, p, y] = flange_rpy;
    let last = offsets.len();
    write!(
        text,
        "<link name=\"tool0\"/><joint name=\"end\" type=\"fixed\"><parent link=\"l{last}\"/>\
         <child link=\"tool0\"/><origin xyz=\"{} 0 0\" rpy=\"{r} {p} {y}\"/></joint>\n</robot>",
        0.1 * offsets[0]
    )
    .unwrap();
    text
}

fn notes(text: &str) -> Vec<String> {
    let robot = Robot::from_texts((text, Path::new("drawn.urdf")), None, None).unwrap();
    robot.chain.notes
}

fn told(notes: &[String], of: &str) -> bool {
    notes.iter().any(|note| note.contains(of))
}

/// Joints with their offset, m, and limits, rad, as arms have them.
fn arms() -> impl Strategy<Value = Vec<(f64, (f64, f64))>> {
    let joint = (0.05..0.9_f64, (-6.9..-0.7_f64, 0.7..6.9_f64));
    prop::collection::vec(joint, 4..=7)
}

/// The z axis along the last joint's, x.
const OUTWARDS: [f64; 3] = [0.0, std::f64::consts::FRAC_PI_2, 0.0];

/// Of a gantry travel is nearly all of its reach; of an arm on a track it makes no lighter arm.
#[test]
fn travel_of_slides_counts_as_reach() {
    let with_slides =
        |text: &str, count| text.replacen("type=\"revolute\"", "type=\"prismatic\"", count);
    let dense = urdf(&[0.04; 6], &[(-1.0, 1.0); 6], OUTWARDS);
    let of_arm = notes(&dense);
    let more = "45.000 kg move over a reach of 0.20 m, more than";
    assert!(told(&of_arm, more), "{of_arm:?}");
    let of_gantry = notes(&with_slides(&dense, 3));
    assert!(!told(&of_gantry, "move over a reach"), "{of_gantry:?}");
    let short = urdf(&[0.04; 6], &[(-0.002, 0.002); 6], OUTWARDS);
    let of_short = notes(&with_slides(&short, 1));
    let more = "over a reach of 0.20 m, 0.00 m of travel of its slides included, more than";
    assert!(told(&of_short, more), "{of_short:?}");
    let slim = urdf(&[0.5; 6], &[(-2.0, 2.0); 6], OUTWARDS);
    for slides in [0, 1, 3] {
        let on_track = notes(&with_slides(&slim, slides));
        assert!(!told(&on_track, "move over a reach"), "{on_track:?}");
    }
}

const SPEED: &str = "velocity=\"3\"";

/// A file that was mended in part: every joint counts for itself.
#[test]
fn single_joints_in_degrees_are_told() {
    let offsets = [0.4; 6];
    let mut limits = [(-2.0, 2.5); 6];
    limits[0] = (-178.0, 178.0);
    limits[4] = (-120.0, 2.0);
    let of_two = notes(&urdf(&offsets, &limits, OUTWARDS));
    let two = "2 of 6 joints with limits may turn by more than 12 times, the joint \"j1\" as far as 178 rad, \"j5\" 120 \
               rad: angles of a robot's file are radians, and these look like degrees";
    assert!(told(&of_two, two), "{of_two:?}");
    // A wrist that counts its turns has 96 of them.
    limits = [(-2.0, 2.5); 6];
    limits[5] = (-603.186, 603.186);
    let of_wrist = notes(&urdf(&offsets, &limits, OUTWARDS));
    assert!(!told(&of_wrist, "degrees"), "{of_wrist:?}");
}

#[test]
fn speeds_in_degrees_and_joints_without_a_speed_are_told() {
    let sound = urdf(&[0.4; 6], &[(-2.0, 2.5); 6], OUTWARDS);
    for of in ["deg/s", "no speed limit"] {
        assert!(!told(&notes(&sound), of), "{of}");
    }
    // As quick as the last joint of a small SCARA arm.
    assert!(!told(
        &notes(&sound.replacen(SPEED, "velocity=\"52\"", 1)),
        "deg/s"
    ));
    let quick = notes(&sound.replacen(SPEED, "velocity=\"114.6\"", 1));
    let one = "1 of 6 joints with a speed limit may turn faster than 60 rad/s (3438 deg/s), the joint \"j1\" at up to \
               114.6 rad/s: speeds of a robot's file are rad/s, and these look like deg/s";
    assert!(told(&quick, one), "{quick:?}");
    let none = "velocity=\"0\"";
    let one = notes(&sound.replacen(SPEED, none, 1));
    let unknown = "no speed limit is known of j1: speeds of these joints are not checked";
    assert!(told(&one, unknown), "{one:?}");
    // A file without any is told where speeds are asked for, and where the arm is looked at.
    let text = sound.replace(SPEED, none);
    let robot = Robot::from_texts((&text, Path::new("drawn.urdf")), None, None).unwrap();
    assert!(!told(&robot.chain.notes, "no speed limit"));
    let report = robot.report(&[0.0; 6]).unwrap();
    assert!(told(
        &report.notes,
        "no speed limit is known of j1, j2, j3, j4, j5, j6"
    ));
    assert!(told(
        &robot.motion_doubts(),
        "no speed limit is known of j1, j2"
    ));
}

/// Angles of frames that are radians to their digits, and measured ones that are none.
#[test]
fn angles_of_frames_in_radians_are_told() {
    let text = urdf(&[0.4; 6], &[(-2.0, 2.5); 6], OUTWARDS);
    let doubts = |rpy: &str| {
        let config = format!("[frames.tool]\nxyz_m = [0, 0, 0.1]\nrpy_deg = {rpy}\n");
        let settings = Some((config.as_str(), Path::new("robot.toml")));
        let robot = Robot::from_texts((&text, Path::new("drawn.urdf")), settings, None).unwrap();
        assert_eq!(
            told(&robot.chain.notes, "meant?"),
            told(&robot.motion_doubts(), "meant?")
        );
        robot.chain.notes
    };
    let of_right_angle = doubts("[0.0, 1.5708, 0.0]");
    let note = "frames.tool has rpy_deg = [0.0, 1.5708, 0.0], in degrees, of which 1.5708 is 90 deg in radians to its \
                digits: was 90 meant?";
    assert!(told(&of_right_angle, note), "{of_right_angle:?}");
    for radians in [
        "[3.14, 0, 0]",
        "[0, -0.7854, 3.14159265]",
        "[0, 1.5707963267948966, 0]",
        "[0.3, 2.094, 0]",
    ] {
        assert!(told(&doubts(radians), "meant?"), "{radians}");
    }
    for degrees in [
        "[0, 90, 0]",
        "[0.785, 91.3, -0.524]",
        "[1.5, 0, 3]",
        "[0.21, 0.78, 0.53]",
        "[0, 0, 0]",
    ] {
        assert!(!told(&doubts(degrees), "meant?"), "{degrees}");
    }
}

proptest! {
    #[test]
    fn an_arm_in_metres_and_radians_is_believed_and_one_in_other_units_told(joints in arms()) {
        let (offsets, limits): (Vec<f64>, Vec<_>) = joints.into_iter().unzip();
        let plain = notes(&urdf(&offsets, &limits, OUTWARDS));
        for of in ["metres", "radians", "lies across"] {
            prop_assert!(!told(&plain, of), "{plain:?}");
        }
        let in_mm: Vec<f64> = offsets.iter().map(|x| 1e3 * x).collect();
        let other = notes(&urdf(&in_mm, &limits, OUTWARDS));
        prop_assert!(told(&other, "are metres; in millimetres it were"), "{other:?}");
        prop_assert!(!told(&other, "radians"), "{other:?}");
        let in_deg: Vec<_> = (limits.iter())
            .map(|(lower, upper)| (lower.to_degrees().min(-90.0), upper.to_degrees()))
            .collect();
        let other = notes(&urdf(&offsets, &in_deg, OUTWARDS));
        prop_assert!(told(&other, "these look like degrees"), "{other:?}");
        prop_assert!(!told(&other, "metres"), "{other:?}");
    }

    /// Origins in degrees, a tool in mm given as m, and springs a thousand times too soft.
    #[test]
    fn turns_in_degrees_long_tools_and_soft_springs_are_told(joints in arms(), turn in 7.0..360.0_f64) {
        let (offsets, limits): (Vec<f64>, Vec<_>) = joints.into_iter().unzip();
        let reach_m: f64 = offsets.iter().skip(1).sum();
        let turned = notes(&urdf(&offsets, &limits, [0.0, turn, 0.0]));
        prop_assert!(told(&turned, "turned by more than a whole turn"), "{turned:?}");

        let text = urdf(&offsets, &limits, OUTWARDS);
        // The weight of all links at the end of the arm, and its centre.
        let weight_n = 9.81 * (0..offsets.len()).map(|i| 5.0 + i as f64).sum::<f64>();
        let with = |tool_m: f64, windup_rad: f64| {
            let mut config = format!("[frames.tool]\nxyz_m = [0, 0, {tool_m}]\n");
            for joint in 1..=offsets.len() {
                let stiffness = weight_n * reach_m / windup_rad;
                write!(
                    config,
                    "[[joint]]\nname = \"j{joint}\"\nstiffness_nm_per_rad = {stiffness}\ndamping_nm_s_per_rad = 1.0\n\
                     source = {{ stiffness = \"drawn\", damping = \"drawn\" }}\n"
                )
                .unwrap();
            }
            let settings = Some((config.as_str(), Path::new("robot.toml")));
            Robot::from_texts((&text, Path::new("drawn.urdf")), settings, None).unwrap().chain.notes
        };
        let sound = with(0.9 * reach_m, 0.01);
        for of in ["whole turn", "off the flange", "would wind"] {
            prop_assert!(!told(&sound, of), "{sound:?}");
        }
        prop_assert!(told(&with(1.1 * reach_m, 0.01), "off the flange, and the joints reach"));
        // The first joint carries all, the centres of some links nearer than its end.
        prop_assert!(told(&with(0.1, 10.0), "would wind the joint"));
    }

    /// What the note asks for puts the z axis along the wrist, away from it.
    #[test]
    fn a_flange_across_the_wrist_is_told_with_the_turn_that_mends_it(
        joints in arms(),
        about_z in prop::sample::select(vec![0.0, 90.0, 180.0, -90.0]),
        about_y in prop::sample::select(vec![0.0, 180.0]),
    ) {
        let (offsets, limits): (Vec<f64>, Vec<_>) = joints.into_iter().unzip();
        let across = [0.0, f64::to_radians(about_y), f64::to_radians(about_z)];
        let text = urdf(&offsets, &limits, across);
        let notes = notes(&text);
        let note = notes.iter().find(|note| note.contains("lies across"));
        prop_assert!(note.is_some(), "{notes:?}");
        let turn = note.unwrap().split("rpy_deg = ").nth(1).unwrap();
        let config = format!("[frames.tool]\nrpy_deg = {turn}\n");
        let robot = Robot::from_texts(
            (&text, Path::new("drawn.urdf")),
            Some((&config, Path::new("robot.toml"))),
            None,
        )
        .unwrap();
        prop_assert!(!told(&robot.chain.notes, "lies across"));
        let frames = robot.frames;
        let z = (frames.last_link_from_flange * frames.flange_from_tool).rotation
            * nalgebra::Vector3::z();
        prop_assert!((z - nalgebra::Vector3::x()).norm() < 1e-9, "{z}");
    }
}
