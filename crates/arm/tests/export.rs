//! What leaves the crate: MJCF, the report and the table of flange poses.

use std::path::Path;

use roxmltree::{Document, Node};
use truecut_arm::report::{fk_table, ik_csv, ik_rows, outside_limits_note};
use truecut_arm::{FrameId, MjcfDrive, MjcfOptions, Robot, standard_gravity_m_s2, to_mjcf};

const POSTURE_DEG: [f64; 6] = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95];

fn asset(name: &str) -> Robot {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    Robot::load(&root.join(name).join("robot.urdf"), None, None).expect("the asset loads")
}

fn options(posture: &[f64], command: &[f64]) -> MjcfOptions {
    MjcfOptions {
        posture: posture.to_vec(),
        command: command.to_vec(),
        gravity_m_s2: standard_gravity_m_s2(),
        drive: MjcfDrive::Position,
        time_step_s: 1e-4,
    }
}

fn numbers(node: &Node, attribute: &str) -> Vec<f64> {
    let text = node.attribute(attribute).expect(attribute);
    text.split(' ')
        .map(|v| v.parse().expect("a number"))
        .collect()
}

/// Every number that makes the mechanics comes back bit by bit.
#[test]
fn mjcf_holds_the_robot_exactly() {
    let robot = asset("irb6600_175_255");
    let q = POSTURE_DEG.map(f64::to_radians);
    let command = q.map(|q| q + 1e-4);
    let text = to_mjcf(&robot, &options(&q, &command)).expect("complete");
    let document = Document::parse(&text).expect("well-formed");
    let bodies: Vec<_> = document
        .descendants()
        .filter(|n| n.has_tag_name("body"))
        .collect();
    assert_eq!(bodies.len(), 6);
    for (i, body) in bodies.iter().enumerate() {
        let (joint, link) = (&robot.chain.joints[i], &robot.chain.links[i]);
        let child = |name: &str| {
            body.children()
                .find(|n| n.has_tag_name(name))
                .expect("present")
        };
        assert_eq!(body.attribute("name"), Some(link.name.as_str()));
        assert_eq!(
            numbers(body, "pos"),
            joint.parent_from_joint.translation.vector.as_slice()
        );
        let inertial = child("inertial");
        assert_eq!(numbers(&inertial, "mass"), [link.mass_kg]);
        assert_eq!(numbers(&inertial, "pos"), link.com_m.as_slice());
        let m = &link.inertia_about_com_kg_m2;
        let six = [
            m[(0, 0)],
            m[(1, 1)],
            m[(2, 2)],
            m[(0, 1)],
            m[(0, 2)],
            m[(1, 2)],
        ];
        assert_eq!(numbers(&inertial, "fullinertia"), six);
        let element = child("joint");
        assert_eq!(element.attribute("type"), Some("hinge"));
        assert_eq!(numbers(&element, "axis"), joint.axis.as_slice());
        assert_eq!(
            numbers(&element, "stiffness"),
            [joint.transmission.stiffness.expect("given")]
        );
        assert_eq!(numbers(&element, "springref"), [command[i]]);
        assert_eq!(numbers(&element, "damping"), [joint.transmission.damping]);
        for geom in body.children().filter(|n| n.has_tag_name("geom")) {
            assert_eq!(
                (geom.attribute("contype"), geom.attribute("mass")),
                (Some("0"), Some("0"))
            );
        }
    }
    let sites: Vec<_> = document
        .descendants()
        .filter(|n| n.has_tag_name("site"))
        .collect();
    let names: Vec<_> = sites.iter().filter_map(|n| n.attribute("name")).collect();
    assert_eq!(names, ["flange", "tool", "foot"]);
    let tool = robot.last_link_from_frame(FrameId::Tool);
    assert_eq!(
        numbers(&sites[1], "pos"),
        tool.translation.vector.as_slice()
    );
    let key = document
        .descendants()
        .find(|n| n.has_tag_name("key"))
        .expect("keyframe");
    assert_eq!(numbers(&key, "qpos"), q);
    let compiler = document
        .descendants()
        .find(|n| n.has_tag_name("compiler"))
        .expect("compiler");
    assert_eq!(compiler.attribute("angle"), Some("radian"));
}

#[test]
fn mjcf_of_free_joints_has_no_springs() {
    let robot = asset("rig_planar");
    let mut free = options(&[0.0; 3], &[0.0; 3]);
    free.drive = MjcfDrive::Free;
    let text = robot.to_mjcf(&free).expect("complete");
    assert!(!text.contains("stiffness") && !text.contains("damping"));
    assert_eq!(text.matches("type=\"slide\"").count(), 3);
}

#[test]
fn mjcf_refuses_what_does_not_fit() {
    let robot = asset("rig_planar");
    let short = robot
        .to_mjcf(&options(&[0.0; 2], &[0.0; 3]))
        .expect_err("one short")
        .to_string();
    assert_eq!(short, "the posture has 2 values; the chain has 3 joints");
    let mut still = options(&[0.0; 3], &[0.0; 3]);
    still.time_step_s = 0.0;
    let message = robot.to_mjcf(&still).expect_err("no step").to_string();
    assert_eq!(
        message,
        "time step (s) is 0; it must be a finite number above zero"
    );
    let mut soft = robot;
    soft.chain.joints[1].transmission.stiffness = None;
    let message = soft
        .to_mjcf(&options(&[0.0; 3], &[0.0; 3]))
        .expect_err("no spring")
        .to_string();
    assert!(
        message.contains("\"slide_y\"") && message.contains("stiffness_n_per_m"),
        "{message}"
    );
}

#[test]
fn the_report_shows_what_was_understood() {
    let robot = asset("irb6600_175_255");
    let report = robot
        .report(&POSTURE_DEG.map(f64::to_radians))
        .expect("complete");
    let text = report.to_text();
    for expected in [
        "6 joints from \"base_link\" to flange \"flange\"",
        "955.300000 kg moving",
        "rotation free",
        "X 0.86476  Y 1.37290  Z 1.09067",
        "13.185 deg",
        "rotation clamped",
        "6.672",
        "-180.00 .. 180.00 deg",
        "2.1170e6 N m/rad",
        "underdetermined",
    ] {
        assert!(text.contains(expected), "`{expected}` is not in:\n{text}");
    }
    let json = serde_json::to_value(&report).expect("serialisable");
    assert_eq!(json["joints"][1]["name"], "joint_2");
    assert_eq!(json["joints"][1]["kind"], "revolute");
    assert!(json["joints"][1]["effort"].is_null());
    assert_eq!(json["modes"].as_array().map(Vec::len), Some(6));
    let k_x = json["stiffness"]["free"]["x_n_per_m"]
        .as_f64()
        .expect("a number");
    assert!((k_x / 0.86476e6 - 1.0).abs() <= 2e-4);
}

/// Without stiffness there are no modes, and the report says why instead of failing.
#[test]
fn the_report_of_a_bare_urdf_says_what_is_missing() {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/robots/irb6600_175_255/robot.urdf");
    let text = std::fs::read_to_string(&urdf).expect("readable");
    let robot = Robot::from_texts((&text, &urdf), None, None).expect("good without robot.toml");
    let report = robot
        .report(&[0.0, 0.0, 0.0, 0.0, 3.0, 0.0])
        .expect("a report");
    assert!(report.modes.is_none() && report.stiffness.is_none());
    assert_eq!(report.outside_limits, ["joint_5"]);
    let text = report.to_text();
    assert!(
        text.contains("no modes: joint \"joint_1\" has no transmission stiffness"),
        "{text}"
    );
    assert!(text.contains("outside the limits of joint_5"), "{text}");
    assert!(text.contains("config  none"), "{text}");
}

/// At the upright, singular posture nothing turns the tool sideways once its rotation is held.
#[test]
fn a_singular_posture_reads_as_rigid() {
    let robot = asset("irb6600_175_255");
    let text = robot
        .report(&robot.default_posture())
        .expect("a report")
        .to_text();
    assert!(text.contains("rigid") && !text.contains("inf"), "{text}");
}

/// Whatever rounding makes of a direction that is rigid, it is no large number of either sign.
#[test]
fn with_a_stretched_wrist_stiffness_is_sound_or_rigid() {
    for name in ["irb6600_175_255", "hp20"] {
        let robot = asset(name);
        for step in 0..50 {
            let turn = f64::from(step);
            let q = [0.1 * turn, 0.01 * turn, -0.2, 0.3 * turn, 0.0, 0.7];
            let report = robot.report(&q).expect("a report").stiffness;
            let Some(held) = report.and_then(|stiffness| stiffness.clamped) else {
                continue;
            };
            let all = [
                held.x_n_per_m,
                held.y_n_per_m,
                held.z_n_per_m,
                held.lateral.k_min_n_per_m,
                held.lateral.k_max_n_per_m,
            ];
            for k in all {
                assert!(
                    k == f64::INFINITY || (0.0..1e13).contains(&k),
                    "{name} {q:?}: {k}"
                );
            }
        }
    }
}

#[test]
fn the_table_of_flange_poses_reads_back_exactly() {
    let robot = asset("irb6600_175_255");
    let table = "q1,q2,q3,q4,q5,q6\n# a remark\n0.1, 0.2, 0.3, 0.4, 0.5, 0.6\n\n-1,0,0.5,0,1,2\n";
    let answer = fk_table(&robot, table).expect("good");
    let rows: Vec<_> = answer.lines().collect();
    assert_eq!(rows.len(), 3);
    assert_eq!(rows[0], "x_m,y_m,z_m,r11,r12,r13,r21,r22,r23,r31,r32,r33");
    let pose = robot.world_from_frame(&[-1.0, 0.0, 0.5, 0.0, 1.0, 2.0], FrameId::Flange);
    let matrix = pose.rotation.to_rotation_matrix();
    let values: Vec<f64> = rows[2]
        .split(',')
        .map(|v| v.parse().expect("a number"))
        .collect();
    assert_eq!(values[..3], pose.translation.vector.as_slice()[..]);
    assert_eq!(values[4], matrix[(0, 1)]);
    assert_eq!(values[9], matrix[(2, 0)]);
}

/// What `ik_csv` writes, and the columns of a `path.csv`, which has more and in degrees.
#[test]
fn tables_whose_headings_name_the_joints_are_read_among_other_columns() {
    let robot = asset("irb6600_175_255");
    let own = POSTURE_DEG.map(f64::to_radians);
    let pose = robot.world_from_frame(&own, FrameId::Flange);
    let postures = ik_csv(&robot, &ik_rows(&robot, &[pose], FrameId::Flange));
    let read = |table: &str| -> Vec<Vec<f64>> {
        let answer = fk_table(&robot, table).unwrap_or_else(|error| panic!("{error}"));
        let rows = answer.lines().skip(1);
        rows.map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
            .collect()
    };
    let found = read(&postures);
    assert_eq!(found.len() + 1, postures.lines().count());
    for row in &found {
        for (value, wanted) in row.iter().zip(pose.translation.vector.iter()) {
            assert!((value - wanted).abs() < 1e-9, "{row:?}");
        }
    }

    let [a, b, c, d, e, f] = POSTURE_DEG;
    let path = format!("point,qw,j6,j1,j2,j3,j4,j5,feed\n7,1,{f},{a},{b},{c},{d},{e},\n");
    let only = own.map(|value| format!("{value:?}")).join(",");
    assert_eq!(read(&path), read(&only));

    let slides = asset("rig_milling");
    for table in ["point,feed\n1,2\n", "point,j1,j1,feed\n1,2,3,4\n"] {
        let told = fk_table(&slides, table).unwrap_err().to_string();
        assert!(told.contains("does not name each joint once"), "{told}");
        assert!(told.contains("(point, "), "{told}");
    }
}

/// Degrees without a word of it are told by the limits that they break; a heading that says the
/// unit gives the poses of the same postures in radians.
#[test]
fn degrees_are_read_by_their_heading_and_told_without_one() {
    let robot = asset("irb6600_175_255");
    let rows = [[10.0, 20.0, -30.0, 40.0, 50.0, -60.0], [0.0; 6]];
    let table = |head: &str, unit: f64| {
        let cells = rows.map(|row| {
            row.map(|value: f64| format!("{:?}", value * unit))
                .join(",")
        });
        format!("{head}{}\n", cells.join("\n"))
    };
    let rad = table("", 1_f64.to_radians());
    let deg = table("j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg\n", 1.0);
    let read = |text: &str| fk_table(&robot, text).expect("good");
    assert_eq!(read(&rad), read(&deg));
    let note = |text: &str| outside_limits_note(&robot, text).expect("good");
    assert_eq!((note(&rad), note(&deg)), (None, None));
    let told = note(&table("", 1.0)).expect("degrees read as radians");
    let parts = [
        "row 1, value 1: ",
        "joint_1",
        "10",
        "1 of 2 rows",
        "rad",
        "j1_deg",
    ];
    for part in parts {
        assert!(told.contains(part), "`{part}` is not in: {told}");
    }
}

#[test]
fn a_bad_table_is_refused_with_its_row() {
    let robot = asset("irb6600_175_255");
    let short = fk_table(&robot, "0,0,0,0,0,0\n0,0,0\n")
        .expect_err("short")
        .to_string();
    assert_eq!(
        short,
        "row 2: 3 values, but the chain has 6 joints: none for joint \"joint_4\""
    );
    let long = fk_table(&robot, "0,0,0,0,0,0,1,2\n")
        .expect_err("long")
        .to_string();
    assert_eq!(
        long,
        "row 1: 8 values, but the chain has 6 joints: value 7 is of none"
    );
    let word = fk_table(&robot, "0,0,0,0,0,0\n0,0,x,0,0,0\n")
        .expect_err("a word")
        .to_string();
    let of_third = "value 3 of joint \"joint_3\"";
    assert_eq!(
        word,
        format!("row 2: {of_third}, \"x\", is not a finite number")
    );
    let nan = fk_table(&robot, "0,0,NaN,0,0,0\n")
        .expect_err("NaN")
        .to_string();
    assert_eq!(
        nan,
        format!("row 1: {of_third}, \"NaN\", is not a finite number")
    );
    // Among other columns the value stands in that of its joint.
    let among = "feed,j1,j2,j3,j4,j5,j6\n1,0,0,?,0,0,0\n";
    let among = fk_table(&robot, among).expect_err("a mark").to_string();
    assert_eq!(
        among,
        "row 2: value 4 of joint \"joint_3\", \"?\", is not a finite number"
    );
    let words = fk_table(&robot, "a,b,c,d,e,f")
        .expect_err("words")
        .to_string();
    assert!(
        words.contains("\"a, b, c, d, e, f\", has no number"),
        "{words}"
    );
    // A pose has no joints.
    let pose = truecut_arm::report::poses("0,0,0,0,up,0\n")
        .expect_err("a word")
        .to_string();
    assert_eq!(pose, "row 1: value 5, \"up\", is not a finite number");
}
