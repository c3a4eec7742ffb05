//! Programs written and read back: pose, attitude, branch and whole turns, for both dialects.
//!
//! A position is printed to 0.001 mm, so that the tool comes back within half of that on each axis:
//! √3 · 0.0005 mm. Rotations by three angles, each off by half of 0.0001°, are off by √5 of that at
//! most: with the middle angle at ±90° the outer two turn about one axis and add up, the middle one
//! about an axis at right angles to it. The parts of a quaternion are off by 0.5e-9 each, the
//! vector of four by 1e-9, the attitude by twice that. The inverse kinematics leave 1e-9 m and rad.

use crate::assets::robot;
use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{DMatrix, Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use truecut_arm::{FrameId, OpwGeometry, Robot, ToolLoad};
use truecut_plan::program::{
    Motion, Move, PathPoint, Program, Tool, TravelOptions, Zone, jbi, rapid,
};

const KINEMATICS: f64 = 1e-9;
const PLACE_M: f64 = 0.5e-6 * 1.732_050_808 + KINEMATICS;
const ROUND_DEG: f64 = 0.5e-4;

fn base() -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(0.4, -0.3, 0.2),
        UnitQuaternion::from_euler_angles(0.3, -0.2, 1.1),
    )
}

fn tool() -> Tool {
    Tool {
        name: "wheel".to_owned(),
        number: 3,
        flange_from_tool: Isometry3::from_parts(
            Translation3::new(0.03, -0.02, 0.25),
            UnitQuaternion::from_euler_angles(0.1, 0.7, -0.4),
        ),
        load: Some(ToolLoad {
            mass_kg: 6.5,
            centre_m: Vector3::new(0.01, 0.0, 0.12),
        }),
    }
}

/// A program of one move to a posture, with base, tool and turntable that are not simple.
fn at(robot: &Robot, posture: &[f64], base: Isometry3<f64>) -> Program {
    let tool = tool();
    let flange = robot.world_from_frame(posture, FrameId::Flange);
    Program {
        name: "ONE".to_owned(),
        comment: String::new(),
        world_from_base: base,
        moves: vec![Move {
            path_point: 0,
            base_from_tool: base.inverse() * flange * tool.flange_from_tool,
            motion: Motion::Joint { share: 0.25 },
            zone: Zone::default(),
            turntable_rad: Some(-1.234_567),
            posture: posture.to_vec(),
        }],
        spindle: Vec::new(),
        notes: Vec::new(),
        tool,
    }
}

fn options() -> jbi::JbiOptions {
    let date = jbi::JobDate::new(2026, 1, 31, 12, 0).unwrap();
    jbi::JbiOptions {
        station_pulses_per_deg: Some(1000.0),
        ..jbi::JbiOptions::new(date)
    }
}

fn through_jbi(program: &Program, robot: &Robot) -> Program {
    let files = jbi::write(program, robot, &options()).unwrap();
    let job = jbi::JbiJob::parse(&files[0].text, Path::new("ONE.JBI")).unwrap();
    job.program(robot, &program.tool, &program.world_from_base, Some(1000.0))
        .unwrap()
}

fn through_rapid(program: &Program, robot: &Robot) -> Program {
    let options = rapid::RapidOptions::default();
    let text = rapid::write(program, robot, &options).unwrap();
    let module = rapid::RapidModule::parse(&text, Path::new("ONE.MOD")).unwrap();
    module.program(robot, &options).unwrap()
}

/// Where a program's first posture puts the tool.
fn world_from_tool(program: &Program, robot: &Robot) -> Isometry3<f64> {
    let flange = robot.world_from_frame(&program.moves[0].posture, FrameId::Flange);
    flange * program.tool.flange_from_tool
}

/// Smallest singular value of the flange's Jacobian (m and rad together): a pose that is off by d
/// moves joints by no more than d over it.
fn least_gain(robot: &Robot, q: &[f64]) -> f64 {
    let jacobian = robot.jacobian(q, FrameId::Flange);
    let jacobian = DMatrix::from_fn(6, 6, |r, c| jacobian[(r, c)]);
    jacobian.singular_values().min()
}

/// Postures over the whole range of all joints, not at a singularity and not on a border between
/// flags.
fn postures(robot: &Robot) -> impl Strategy<Value = Vec<f64>> + use<> {
    let limits = robot.chain.joints.iter().map(|joint| joint.limits.unwrap());
    let ranges: Vec<_> = limits.map(|l| l.lower..l.upper).collect();
    let geometry = OpwGeometry::of(robot).unwrap();
    ranges.prop_filter("regular", move |q| {
        let distance = geometry.singularity_distance(q);
        let on_border = [0, 3, 5].iter().any(|&joint| {
            let quarter = q[joint].to_degrees() / 90.0;
            (quarter - quarter.round()).abs() * 90.0 < 0.05
        });
        let near = distance.wrist_rad < 0.02 || distance.elbow_rad < 0.02;
        !(near || on_border || distance.shoulder_m < 0.02)
    })
}

/// Tool and joints after a round trip. `attitude_rad` is what the decimals leave of the attitude.
fn compare(robot: &Robot, written: &Program, read: &Program, attitude_rad: f64) {
    // Base and tool are printed too; in a module their attitude is at the end of a lever.
    let (wanted, found) = (
        world_from_tool(written, robot),
        world_from_tool(read, robot),
    );
    let apart_m = (wanted.translation.vector - found.translation.vector).norm();
    let turned_rad = wanted.rotation.angle_to(&found.rotation);
    assert!(apart_m <= PLACE_M, "{apart_m} m");
    assert!(turned_rad <= attitude_rad + KINEMATICS, "{turned_rad} rad");
    assert!(PLACE_M <= 0.01e-3 && (attitude_rad + KINEMATICS).to_degrees() <= 0.01);
    let lever_m = written.tool.flange_from_tool.translation.vector.norm();
    let moved = (PLACE_M + attitude_rad * lever_m).hypot(attitude_rad);
    let (a, b) = (&written.moves[0].posture, &read.moves[0].posture);
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    // The gain changes a little over the way.
    let bound = 1.05 * moved / least_gain(robot, a) + 1e-8;
    assert!(apart.sqrt() <= bound, "{a:?} came back as {b:?}: {bound}");
}

fn jbi_round_trip(robot: &Robot, posture: &[f64]) {
    let written = at(robot, posture, base());
    let read = through_jbi(&written, robot);
    compare(
        robot,
        &written,
        &read,
        (5_f64.sqrt() * ROUND_DEG).to_radians(),
    );
    assert_eq!(read.tool, written.tool);
    assert_eq!(read.moves[0].motion, written.moves[0].motion);
    let angles = [&written, &read].map(|p| p.moves[0].turntable_rad.unwrap().to_degrees());
    assert!((angles[0] - angles[1]).abs() <= 0.5 / 1000.0 + 1e-12);
}

fn rapid_round_trip(robot: &Robot, posture: &[f64]) {
    // The base frame at the origin, as in the first bound: another one is printed to decimals of
    // its own.
    let written = at(robot, posture, Isometry3::identity());
    let read = through_rapid(&written, robot);
    let found = read.moves[0].base_from_tool;
    let wanted = written.moves[0].base_from_tool;
    let printed_m = (found.translation.vector - wanted.translation.vector).norm();
    assert!(printed_m <= PLACE_M, "{printed_m}");
    // Tool frame: 1e-3 mm and 1e-9 too, and it is read from the file, so that the flange carries
    // its error and the tool does not.
    compare(robot, &written, &read, 4e-9);
    let angles = [&written, &read].map(|p| p.moves[0].turntable_rad.unwrap().to_degrees());
    assert!((angles[0] - angles[1]).abs() <= ROUND_DEG + 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_job_brings_back_tool_and_joints_of_the_irb6600(q in postures(&robot("irb6600_175_255"))) {
        jbi_round_trip(&robot("irb6600_175_255"), &q);
    }

    #[test]
    fn a_job_brings_back_tool_and_joints_of_the_hp20(q in postures(&robot("hp20"))) {
        jbi_round_trip(&robot("hp20"), &q);
    }

    #[test]
    fn a_module_brings_back_tool_and_joints_of_the_irb6600(q in postures(&robot("irb6600_175_255"))) {
        rapid_round_trip(&robot("irb6600_175_255"), &q);
    }

    #[test]
    fn a_module_brings_back_tool_and_joints_of_the_hp20(q in postures(&robot("hp20"))) {
        rapid_round_trip(&robot("hp20"), &q);
    }
}

/// With the wrong branch the tool would be at the same place: only the joints tell.
#[test]
fn other_flags_give_another_posture() {
    let robot = robot("irb6600_175_255");
    let q = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95].map(f64::to_radians);
    let program = at(&robot, &q, base());
    let text = jbi::write(&program, &robot, &options())
        .unwrap()
        .remove(0)
        .text;
    assert!(text.contains("///RCONF 0,0,0,0,0,0\r\n"), "{text}");
    let other = text.replace("///RCONF 0,0,0", "///RCONF 1,0,0");
    let job = jbi::JbiJob::parse(&other, Path::new("ONE.JBI")).unwrap();
    let read = job.program(
        &robot,
        &program.tool,
        &program.world_from_base,
        Some(1000.0),
    );
    let found = &read.unwrap().moves[0].posture;
    let second = [-48.38, 54.82, 6.86, -125.84, -107.43, 158.05].map(f64::to_radians);
    for (a, b) in found.iter().zip(second) {
        assert!((a - b).abs() < 1e-5, "{found:?}");
    }
}

/// The NX100 turns the base by Rz, then Ry, then Rx about the axes as they have turned: Rz · Ry ·
/// Rx.
#[test]
fn verify_angles_of_a_job_are_rz_ry_rx() {
    let robot = robot("irb6600_175_255");
    let q = [-0.8, 0.9, 0.1, 0.9, 1.8, -0.4];
    let program = at(&robot, &q, base());
    let files = jbi::write(&program, &robot, &options()).unwrap();
    let line = files[0]
        .text
        .lines()
        .find(|l| l.starts_with("C00000="))
        .unwrap();
    let numbers: Vec<f64> = line[7..].split(',').map(|n| n.parse().unwrap()).collect();
    let turn = |axis: &Vector3<f64>, deg: f64| nalgebra::Rotation3::new(axis * deg.to_radians());
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let rotation = turn(&z, numbers[5]) * turn(&y, numbers[4]) * turn(&x, numbers[3]);
    let wanted = program.moves[0].base_from_tool;
    let apart = (rotation.matrix() - wanted.rotation.to_rotation_matrix().matrix()).amax();
    assert!(apart < 4e-6, "{apart}");
    for (printed, wanted) in numbers.iter().zip(wanted.translation.vector.iter()) {
        assert!((printed - wanted * 1e3).abs() <= 0.5e-3 + 1e-9);
    }
}

/// Pulses: half a pulse on each joint, at the arm's reach.
#[test]
fn pulses_bring_back_joints_to_half_a_pulse() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/hp20");
    let urdf = std::fs::read_to_string(path.join("robot.urdf")).unwrap();
    let names: Vec<String> = robot("hp20")
        .chain
        .joints
        .iter()
        .map(|j| j.name.clone())
        .collect();
    let per_deg: [f64; 6] = [1300.0, 1250.5, 1100.25, 900.0, 850.0, 500.0];
    let config: String = names.iter().zip(per_deg).map(|(name, pulses)| {
        format!("[[joint]]\nname = \"{name}\"\npulses_per_deg = {pulses}\nsource.pulses = \"made up for this test\"\n")
    }).collect();
    let robot = Robot::from_texts(
        (&urdf, &path.join("robot.urdf")),
        Some((&config, Path::new("robot.toml"))),
        None,
    )
    .unwrap();
    let q = [0.3, 0.2, -0.4, 1.9, -0.8, 4.1];
    let program = at(&robot, &q, base());
    let pulse = jbi::JbiOptions {
        format: jbi::PositionFormat::Pulse,
        ..options()
    };
    let text = jbi::write(&program, &robot, &pulse).unwrap().remove(0).text;
    assert!(
        !text.contains("RECTAN") && text.contains("///PULSE"),
        "{text}"
    );
    let job = jbi::JbiJob::parse(&text, Path::new("ONE.JBI")).unwrap();
    let read = job
        .program(&robot, &program.tool, &base(), pulse.station_pulses_per_deg)
        .unwrap();
    let mut swept_m = 0.0;
    for ((a, b), per_deg) in q.iter().zip(&read.moves[0].posture).zip(per_deg) {
        let half = (0.5 / per_deg).to_radians();
        assert!((a - b).abs() <= half + 1e-12, "{a} {b}");
        swept_m += half * 2.2;
    }
    let apart = world_from_tool(&read, &robot).translation.vector
        - world_from_tool(&program, &robot).translation.vector;
    assert!(apart.norm() <= swept_m && apart.norm() > 0.0, "{apart}");
    let without = jbi::write(&program, &self::robot("hp20"), &pulse);
    let refusal = without.unwrap_err().to_string();
    assert!(refusal.contains("`pulses_per_deg` of joint"), "{refusal}");
}

/// Flags and quadrants of postures whose angles are on either side of every border.
#[test]
fn verify_manipulator_type_and_confdata_follow_their_tables() {
    let robot = robot("irb6600_175_255");
    let geometry = OpwGeometry::of(&robot).unwrap();
    let with = |joint: usize, deg: f64| {
        let mut q = [0.0, 10.0, 10.0, 0.0, 40.0, 0.0].map(f64::to_radians);
        q[joint] = deg.to_radians();
        q
    };
    // Angle of R; flip is 0, no flip 1; R < 180 is 0.
    for (deg, no_flip, over) in [
        (0.0, false, false),
        (89.9, false, false),
        (90.1, true, false),
        (179.9, true, false),
        (180.1, true, true),
        (269.9, true, true),
        (270.1, false, true),
        (299.0, false, true),
        (-89.9, false, false),
        (-90.1, true, false),
        (-179.9, true, false),
        (-180.1, true, true),
        (-269.9, true, true),
        (-270.1, false, true),
    ] {
        let rconf = jbi::Rconf::of(&geometry, &with(3, deg));
        assert_eq!((rconf.no_flip, rconf.r_over), (no_flip, over), "R {deg}");
        let rconf = jbi::Rconf::of(&geometry, &with(5, deg));
        assert_eq!((rconf.r_over, rconf.t_over), (false, over), "T {deg}");
        let quadrant = if deg >= 0.0 {
            (deg / 90.0) as i32
        } else {
            (deg / 90.0) as i32 - 1
        };
        let confdata = rapid::Confdata::of(&geometry, &with(5, deg));
        assert_eq!(
            (confdata.cf1, confdata.cf4, confdata.cf6),
            (0, 0, quadrant),
            "{deg}"
        );
    }
    let cfx = |q: [f64; 6]| rapid::Confdata::of(&geometry, &q.map(f64::to_radians)).cfx;
    assert_eq!(cfx([0.0, 10.0, 10.0, 0.0, 40.0, 0.0]), 0);
    assert_eq!(cfx([0.0, 10.0, 10.0, 0.0, -40.0, 0.0]), 1);
    assert_eq!(cfx([0.0, 70.0, -130.0, 0.0, 40.0, 0.0]), 2);
    assert_eq!(cfx([0.0, 70.0, -130.0, 0.0, -40.0, 0.0]), 3);
    assert_eq!(cfx([0.0, -60.0, -50.0, 0.0, 40.0, 0.0]), 4);
    assert_eq!(cfx([0.0, -60.0, -50.0, 0.0, -40.0, 0.0]), 5);
    assert_eq!(cfx([0.0, -40.0, -150.0, 0.0, 40.0, 0.0]), 6);
    assert_eq!(cfx([0.0, -40.0, -150.0, 0.0, -40.0, 0.0]), 7);
}

/// A tool that turns once about a tilted axis winds joint 6 past half a turn: the poses repeat,
/// only the flags tell the turns apart.
#[test]
fn whole_turns_come_back_along_a_path() {
    let robot = robot("irb6600_175_255");
    let points: Vec<PathPoint> = (0..60)
        .map(|i| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.12 * f64::from(i));
            let tilted = turn * UnitQuaternion::from_euler_angles(PI, 0.35, 0.0);
            PathPoint {
                base_from_tool: Isometry3::from_parts(Translation3::new(1.5, 0.0, 0.9), tilted),
                motion: Motion::Joint { share: 0.5 },
                turntable_rad: Some(0.0),
            }
        })
        .collect();
    let travel = TravelOptions::default();
    let base = Isometry3::identity();
    let tool = Tool::of(&robot, "wheel", 1);
    let written = Program::along(&robot, "WIND", tool, base, &points, &travel).unwrap();
    let sixth = |program: &Program, i: usize| program.moves[i].posture[5];
    let wound = sixth(&written, 59) - sixth(&written, 0);
    assert!(wound.abs() > 5.0, "{wound}");
    let over: Vec<f64> = (0..60).map(|i| sixth(&written, i).abs()).collect();
    assert!(over.iter().any(|q| *q > PI) && over.iter().any(|q| *q < 0.5 * PI));
    let attitude_rad = (5_f64.sqrt() * ROUND_DEG).to_radians();
    let lever_m = written.tool.flange_from_tool.translation.vector.norm();
    let moved = (PLACE_M + attitude_rad * lever_m).hypot(attitude_rad);
    for read in [
        through_jbi(&written, &robot),
        through_rapid(&written, &robot),
    ] {
        assert_eq!(read.moves.len(), 60);
        for (a, b) in written.moves.iter().zip(&read.moves) {
            assert_eq!(a.path_point, b.path_point);
            let bound = 1.05 * moved / least_gain(&robot, &a.posture);
            let apart = a.posture.iter().zip(&b.posture).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) <= bound, "{a:?} {b:?}");
        }
    }
}
