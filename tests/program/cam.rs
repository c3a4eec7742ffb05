//! `truecut path` of poses: where the arm begins, and which tool it has; `truecut program` with it.

use std::path::Path;

use super::path::{hp20, told};
use super::{BAD_INPUT, Desk};

/// Two poses straight down before the arm, the tool turned by -90 deg.
fn poses_before_the_arm(desk: &Desk) {
    let head = "x_mm,y_mm,z_mm,feed_mm_per_s,roll_deg,pitch_deg,yaw_deg\n";
    let rows = "900,0,500,,180,0,-90\n900,0,480,20,180,0,-90\n";
    std::fs::write(desk.path("poses.csv"), format!("{head}{rows}")).unwrap();
}

/// Joints of the first point of the path that was written.
fn first_posture(desk: &Desk) -> Vec<f64> {
    let table = std::fs::read_to_string(desk.path("out/poses/path.csv")).unwrap();
    let mut lines = table.lines();
    let heads: Vec<&str> = lines.next().unwrap().split(',').collect();
    let cells: Vec<&str> = lines.next().unwrap().split(',').collect();
    let joint = |j: usize| heads.iter().position(|head| *head == format!("j{j}"));
    let value = |j: usize| cells[joint(j).unwrap()].parse().unwrap();
    (1..=6).map(value).collect()
}

#[test]
fn poses_begin_at_rest_or_near_the_posture_given() {
    let desk = Desk::new();
    poses_before_the_arm(&desk);
    let path = |more: &[&str]| {
        let robot = hp20();
        let head = ["path", "poses.csv", "--robot", &robot];
        desk.truecut(&[&head, more].concat())
    };
    let output = path(&[]);
    assert!(output.status.success(), "{}", told(&output));
    let rest = first_posture(&desk);
    assert!(rest[0].abs() < 90.0 && rest[3].abs() < 90.0, "{rest:?}");
    assert!(rest[5].abs() <= 180.0, "{rest:?}");
    // Joint 6 a whole turn on.
    let turned = if rest[5] > 0.0 {
        rest[5] - 360.0
    } else {
        rest[5] + 360.0
    };
    let wish: Vec<String> = rest[..5]
        .iter()
        .chain(&[turned])
        .map(f64::to_string)
        .collect();
    let wish = wish.join(",");
    let output = path(&["--posture-deg", &wish]);
    assert!(output.status.success(), "{}", told(&output));
    let near = first_posture(&desk);
    assert!((near[5] - turned).abs() < 1e-3, "{near:?}");

    let spun = path(&["--spin-deg", "30"]);
    assert_eq!(spun.status.code(), Some(2));
    for part in ["poses.csv", "--spin-deg 30", "whole attitude"] {
        assert!(told(&spun).contains(part), "{}", told(&spun));
    }
    let short = path(&["--posture-deg", "1,2,3"]);
    assert_eq!(short.status.code(), Some(2));
    assert!(told(&short).contains("3 values"), "{}", told(&short));
    let far = path(&["--posture-deg", "0,0,0,0,0,999"]);
    assert_eq!(far.status.code(), Some(2));
    assert!(told(&far).contains("joint_6"), "{}", told(&far));
}

/// A tool of 250 mm in a file beside: a program written with it is run through with it, and without
/// any the note says that the flange is the tool.
#[test]
fn the_tool_of_another_file_is_used_and_a_missing_one_told() {
    let desk = Desk::new();
    poses_before_the_arm(&desk);
    let bare = desk.path("robot_alone.urdf");
    std::fs::copy(hp20(), &bare).unwrap();
    std::fs::write(
        desk.path("tool.toml"),
        "[frames.tool]\nxyz_m = [0.0, 0.0, 0.25]\n",
    )
    .unwrap();
    let run = |verb: &str, file: &str, more: &[&str]| {
        let robot = ["--robot", "robot_alone.urdf"];
        desk.truecut(&[&[verb, file][..], &robot, more].concat())
    };
    let dialect = [
        "--dialect",
        "jbi",
        "--option",
        "date=2026-01-31 12:00",
        "--option",
        "tool_number=1",
    ];
    let written = run(
        "path",
        "poses.csv",
        &[&dialect[..], &["--config", "tool.toml"]].concat(),
    );
    assert!(written.status.success(), "{}", told(&written));
    assert!(
        !told(&written).contains("no robot.toml"),
        "{}",
        told(&written)
    );
    let path = ["--path", "out/poses/path.csv"];
    let read = run(
        "program",
        "out/poses/POSES.JBI",
        &[&path[..], &["--config", "tool.toml"]].concat(),
    );
    assert!(read.status.success(), "{}", told(&read));
    let without = run("program", "out/poses/POSES.JBI", &path);
    assert!(
        told(&without).contains("no robot.toml"),
        "{}",
        told(&without)
    );
}

/// A placement out of reach comes to no program, and that of an earlier placement goes, with the
/// parts of a long job; what is not of it stays. A fault of the file leaves everything.
#[test]
fn a_placement_out_of_reach_leaves_no_earlier_program() {
    let desk = Desk::new();
    let code = "G21 G90 G17\nG0 X0 Y0 Z20\nG1 Z0 F600\nG1 X40\nM30\n";
    let robot = hp20();
    let date = &["--option", "date=2026-01-31 12:00"][..];
    for (dialect, files, options) in [
        ("jbi", &["C.JBI"][..], date),
        ("rapid", &["C.mod"], &[]),
        ("krl", &["C.src", "C.dat"], &[]),
        ("urscript", &["C.script"], &[]),
        ("ls", &["C.LS"], &[]),
    ] {
        std::fs::write(desk.path("c.nc"), code).unwrap();
        let path = |place: &str| {
            let head = ["path", "c.nc", "--robot", &robot, "--dialect", dialect];
            let place = ["--work-xyz-mm", place];
            desk.truecut(&[&head[..], &place, options].concat())
        };
        let there = || {
            let paths = files.iter().map(|name| desk.path(&format!("out/c/{name}")));
            paths.filter(|path| path.is_file()).count()
        };
        let output = path("900,0,350");
        assert!(output.status.success(), "{dialect}: {}", told(&output));
        assert_eq!(there(), files.len(), "{dialect}");

        std::fs::write(desk.path("c.nc"), code.replace("X40", "X40 Q2")).unwrap();
        let output = path("900,0,350");
        assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
        assert!(told(&output).contains("`Q2`"), "{}", told(&output));
        assert_eq!(there(), files.len(), "{dialect}: a fault of the file");

        std::fs::write(desk.path("c.nc"), code).unwrap();
        let output = path("3000,0,350");
        assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
        assert!(told(&output).contains("reach"), "{}", told(&output));
        assert_eq!(there(), 0, "{dialect}: out of reach");
        // Nothing is left to take away, and the fault is the same.
        assert_eq!(told(&path("3000,0,350")), told(&output));
        assert!(desk.path("out/c/path.csv").is_file());
    }
    let job = |name: &str| desk.path(&format!("out/c/{name}.JBI"));
    let calls = "NOP\r\nCALL JOB:C01\r\nCALL JOB:C02\r\nCALL JOB:GRIP2\r\nEND\r\n";
    std::fs::write(job("C"), calls).unwrap();
    for name in ["C01", "C02", "C03", "GRIP2"] {
        std::fs::write(job(name), "NOP\r\nEND\r\n").unwrap();
    }
    let place = ["--work-xyz-mm", "3000,0,350", "--dialect", "jbi"];
    let head = ["path", "c.nc", "--robot", &robot];
    let output = desk.truecut(&[&head[..], &place, date].concat());
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
    let left = ["C", "C01", "C02", "C03", "GRIP2"].map(|name| job(name).is_file());
    assert_eq!(left, [false, false, false, true, true]);
}

#[test]
fn a_folder_is_no_recording() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("out")).unwrap();
    let output = desk.truecut(&["view", "out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(told(&output).contains("is a folder"), "{}", told(&output));
}

/// A head as posts write it, whose height comes after X and Y: no row of the path lies at a height
/// that no line says, and the retract between the pockets is in the program.
#[test]
fn a_path_through_the_machines_own_retract_stays_above_the_part() {
    let desk = Desk::new();
    let code = "G53 G0 Z0.\nG90 G21 G0 X10. Y10.\nG43 H1 Z50.\nG1 Z-8. F300.\nX30.\nG53 G0 Z0.\n\
                G0 X60. Y30.\nG43 H1 Z40.\nG1 Z-8.\nX70.\nG53 G0 Z0.\nM30\n";
    std::fs::write(desk.path("haas.nc"), code).unwrap();
    let robot = hp20();
    let place = ["--work-xyz-mm", "850,-30,400", "--dialect", "urscript"];
    let head = ["path", "haas.nc", "--robot", &robot];
    let output = desk.truecut(&[&head[..], &place].concat());
    assert!(output.status.success(), "{}", told(&output));
    for part in [
        "the path begins here",
        "G53: a move of the machine's own",
        "Z 50.000 mm",
    ] {
        assert!(told(&output).contains(part), "{}", told(&output));
    }
    let table = std::fs::read_to_string(desk.path("out/haas/path.csv")).unwrap();
    let work = |line: &str| -> Vec<f64> {
        let cells = line.split(',').skip(2).take(3);
        cells.map(|cell| cell.parse().unwrap()).collect()
    };
    let places: Vec<Vec<f64>> = table.lines().skip(1).map(work).collect();
    let heights: Vec<f64> = places.iter().map(|place| place[2]).collect();
    assert_eq!(
        heights,
        [50.0, -8.0, -8.0, 50.0, 50.0, 40.0, -8.0, -8.0, 50.0]
    );
    for pair in places
        .windows(2)
        .filter(|pair| (pair[0][1] - pair[1][1]).abs() > 1.0)
    {
        assert_eq!((pair[0][2], pair[1][2]), (50.0, 50.0), "{pair:?}");
    }
}

/// `[process.path_milling]` turns its cutter as the scenario says, and tells where the file says
/// something else.
#[test]
fn a_spindle_that_contradicts_the_scenario_is_told() {
    let desk = Desk::new();
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/irb6600_175_255");
    let scenario = format!(
        "name = \"Slot\"\n[robot]\nurdf = '{0}/robot.urdf'\nconfig = '{0}/milling.toml'\n\
         [process.path_milling]\nspindle_rpm = 6000\n[process.path_milling.cutter]\n\
         diameter_mm = 10\nteeth = 2\n[process.path_milling.cutting]\ntangential_mpa = 600\n\
         radial_mpa = 200\n[process.path_milling.path]\nfile = \"slot.nc\"\n\
         work_xyz_mm = [1050, -1450, 870]\n[process.path_milling.stock]\n\
         corner_mm = [0, -10, -10]\nsize_mm = [20, 20, 10]\ngrid_mm = 0.5\n\
         [run]\nduration_s = 0.02\n",
        robots.display()
    );
    std::fs::write(desk.path("slot.toml"), scenario).unwrap();
    for (words, quote) in [
        ("S6000 M3", None),
        (
            "",
            Some("line 2: a move with feed, before which the file does not start the spindle"),
        ),
        (
            "S6000 M4",
            Some("line 2: the file turns the spindle counter-clockwise"),
        ),
        (
            "S9000 M3",
            Some("line 2: the file turns the spindle at 9000 1/min, the scenario at 6000"),
        ),
    ] {
        let code = format!("G90 G21 {words} G0 X-8 Y0 Z-1\nG1 X25 F1200\nM30\n");
        std::fs::write(desk.path("slot.nc"), code).unwrap();
        let output = desk.truecut(&["run", "slot.toml", "--no-rrd"]);
        let told = told(&output);
        assert!(output.status.code() < Some(2), "{told}");
        match quote {
            Some(quote) => assert!(told.contains(quote), "{words}: {told}"),
            None => assert!(
                !told.contains("the file turns") && !told.contains("the spindle"),
                "{told}"
            ),
        }
    }
}

/// Notes quote words of the file, but not the control characters in them.
#[test]
fn what_is_left_aside_is_told_without_control_characters() {
    let desk = Desk::new();
    let program = "/PROG JOB\n/MN\n1:J P[1] 10% FINE ACC80\u{1f} ;\n/POS\nP[1]{\n GP1:\n UF : 0, UT : 0,\n \
                   J1= 0 deg, J2= 0 deg, J3= 0 deg,\n J4= 0 deg, J5= 10 deg, J6= 0 deg\n};\n/END\n";
    std::fs::write(desk.path("job.LS"), program).unwrap();
    let output = desk.truecut(&["program", "job.LS", "--robot", &hp20()]);
    let text = told(&output);
    assert!(
        text.contains("ACC80") && !text.contains('\u{1f}'),
        "{text:?}"
    );
}

/// A gantry is told at once that it follows no file, with slides that stand still or without.
#[test]
fn a_gantry_follows_no_file() {
    let desk = Desk::new();
    poses_before_the_arm(&desk);
    let joint = |name: &str, kind: &str, parent: &str, child: &str, axis: &str| {
        format!(
            "<link name=\"{child}\"/><joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/>\
             <child link=\"{child}\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-2\" upper=\"2\" velocity=\"1\" effort=\"9\"/></joint>"
        )
    };
    let joints = [
        joint("x", "prismatic", "bed", "bridge", "1 0 0"),
        joint("y", "prismatic", "bridge", "carriage", "0 1 0"),
        joint("z", "prismatic", "carriage", "column", "0 0 1"),
        joint("c", "revolute", "column", "head", "0 0 1"),
    ];
    let urdf = format!(
        "<robot name=\"gantry\"><link name=\"bed\"/>{}</robot>",
        joints.concat()
    );
    std::fs::write(desk.path("gantry.urdf"), urdf).unwrap();
    for slides in [&[][..], &["--slide-mm", "0,0,0"]] {
        let head = ["path", "poses.csv", "--robot", "gantry.urdf"];
        let output = desk.truecut(&[&head[..], slides].concat());
        assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
        let message = told(&output);
        for part in ["3 slides and 1 joints that turn", "at least 6", "a gantry"] {
            assert!(message.contains(part), "{message}");
        }
    }
}

/// Comments of a German shop, as its CAM system writes them: Latin-1.
#[test]
fn a_comment_in_latin_1_is_passed_over() {
    let desk = Desk::new();
    let text = "G21 G90 (Tasche f\u{fc}r Geh\u{e4}use)\nG0 X0 Y0 Z20\nG1 X20 F600\nM30\n";
    let latin: Vec<u8> = text.chars().map(|c| u8::try_from(c).unwrap()).collect();
    std::fs::write(desk.path("umlaut.nc"), latin).unwrap();
    let robot = hp20();
    let place = ["--work-xyz-mm", "900,0,350"];
    let output = desk.truecut(&[&["path", "umlaut.nc", "--robot", &robot][..], &place].concat());
    assert!(output.status.success(), "{}", told(&output));
    // A byte that no text has is told with its line.
    std::fs::write(desk.path("damaged.nc"), b"G21 G90\nG0 X0 (\xe4 \x81)\n").unwrap();
    let output = desk.truecut(&[&["path", "damaged.nc", "--robot", &robot][..], &place].concat());
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
    assert!(
        told(&output).contains("line 2: the byte 0x81"),
        "{}",
        told(&output)
    );
}
