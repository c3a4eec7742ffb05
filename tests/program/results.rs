//! What a run and a sweep say of their results, and what they do not pass off as one.

use std::path::Path;

use super::{CHATTER, CLAIM_FAILED, DIVERGED, Desk};

#[test]
fn a_sweep_gives_a_table_a_drawing_and_claims_about_its_rows() {
    let desk = Desk::new();
    let sweep = "
        [[sweep.axis]]
        key = 'process.load.release_n.0'
        values = [50, 100]
        [[sweep.column]]
        name = 'far'
        metric = 'peak'
        channel = 'tool.displacement_x'
        unit = 'um'
        [[sweep.claim]]
        name = 'swings'
        column = 'far'
        min = 1
        reason = 'it is let go'
    ";
    desk.scenario("sweep", "duration_s = 0.1", sweep);
    let out = desk.ends(0, &["run", "sweep.toml", "--jobs", "2"]);
    assert!(
        out.contains("2 rows") && out.contains("far [um]") && out.contains("✓ swings"),
        "{out}"
    );
    let svg = std::fs::read_to_string(desk.path("out/sweep/sweep.svg")).unwrap();
    assert_eq!(svg.matches("<circle").count(), 2, "{svg}");
    let csv = std::fs::read_to_string(desk.path("out/sweep/sweep.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(
        lines.len() == 3 && lines[0].contains("far (um),outcome"),
        "{csv}"
    );
    assert!(lines[1].ends_with(",completed"), "{csv}");
    let parquet = std::fs::read(desk.path("out/sweep/sweep.parquet")).unwrap();
    assert_eq!(
        (&parquet[..4], &parquet[parquet.len() - 4..]),
        (&b"PAR1"[..], &b"PAR1"[..])
    );
    desk.ends(
        CLAIM_FAILED,
        &["run", "sweep.toml", "--set", "sweep.claim.0.min=1e9"],
    );
    desk.ends(0, &["check", "sweep.toml"]);
}

/// A run that diverges has no result: neither its row, nor a claim about it, nor a search may make
/// one of it.
#[test]
fn a_diverged_run_in_a_sweep_is_no_result() {
    let desk = Desk::new();
    let far = "metric = 'peak'\nchannel = 'tool.displacement_x'\nunit = 'mm'\n";
    let sweep = format!(
        "[[sweep.axis]]\nkey = 'process.load.constant_n.0'\nvalues = [1000, 1e6]\n\
         [[sweep.column]]\nname = 'far'\n{far}\
         [[sweep.claim]]\nname = 'stays near'\ncolumn = 'far'\nmax = 260\nreason = 'the slide ends'\n"
    );
    desk.scenario("sweep", "duration_s = 0.1", &sweep);
    let text = std::fs::read_to_string(desk.path("sweep.toml")).unwrap();
    let pushed = text.replace("release_n = [100, 0, 0]", "constant_n = [1000, 0, 0]");
    std::fs::write(desk.path("sweep.toml"), pushed).unwrap();
    let out = desk.ends(DIVERGED, &["run", "sweep.toml"]);
    assert!(out.contains("2 rows, ✗ 1 diverged"), "{out}");
    assert!(
        out.contains("✗ constant_n.0 = 1.000e6: diverged at"),
        "{out}"
    );
    assert!(
        out.contains("✗ stays near  worst row no value at constant_n.0 = 1.000e6"),
        "{out}"
    );
    desk.ends(DIVERGED, &["check", "sweep.toml"]);
    let junit = std::fs::read_to_string(desk.path("out/junit.xml")).unwrap();
    assert!(junit.contains("failures=\"2\""), "{junit}");

    // The trial at the upper end diverges before it has gone far, and would hold if it were judged.
    let bisect = format!(
        "[sweep.bisect]\nkey = 'process.load.constant_n.0'\nfrom = 1000\nto = 1e6\nlimit = 1000\n{far}"
    );
    desk.scenario("search", "duration_s = 0.1", &bisect);
    let text = std::fs::read_to_string(desk.path("search.toml")).unwrap();
    let pushed = text.replace("release_n = [100, 0, 0]", "constant_n = [1000, 0, 0]");
    std::fs::write(desk.path("search.toml"), pushed).unwrap();
    let out = desk.ends(DIVERGED, &["run", "search.toml"]);
    assert!(
        out.contains("the trial at process.load.constant_n.0 = 1000000 diverged at"),
        "{out}"
    );
}

/// Chatter that makes paths of teeth loop is an end of its own: for a run, its claims and files,
/// for the rows of a sweep and for a check.
#[test]
fn a_run_that_ends_in_chatter_says_so_everywhere() {
    let desk = Desk::new();
    let rig = Path::new(env!("CARGO_MANIFEST_DIR"));
    let rig = rig
        .join("../../assets/robots/rig_milling/robot.urdf")
        .canonicalize()
        .unwrap();
    let cut = format!(
        "name = 'Deep'\n[robot]\nurdf = '{}'\ngravity = false\n[process.milling]\nspindle_rpm = 7000\n\
         feed_mm_per_tooth = 0.1\naxial_depth_mm = 4\nengagement = 'up'\nradial_depth_mm = 6\nstart_angle_deg = 1\n\
         [process.milling.cutter]\ndiameter_mm = 20\nteeth = 2\n\
         [process.milling.cutting]\ntangential_mpa = 600\nradial_mpa = 200\n\
         [process.milling.path]\ndirection = [1, 0, 0]\nlength_mm = 9\n",
        rig.display()
    );
    let claim = "[[claim]]\nname = 'any growth'\nscalar = 'milling.growth_rate'\nunit = '1/s'\nmin = -1e9\n\
                 reason = 'a run that ends early holds nothing'\n";
    std::fs::write(desk.path("deep.toml"), format!("{cut}{claim}")).unwrap();
    let out = desk.ends(CHATTER, &["run", "deep.toml", "--no-rrd"]);
    assert!(
        out.contains("✗ ended in chatter at 0.")
            && out.contains("one moves backwards: paths of teeth loop"),
        "{out}"
    );
    assert!(
        out.contains("✗ any growth") && out.contains("the run ended in chatter at"),
        "{out}"
    );
    let summary = std::fs::read_to_string(desk.path("out/deep/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let amplitude_m = summary["outcome"]["chatter"]["amplitude_m"].as_f64();
    assert!(
        amplitude_m.is_some_and(|a| (0.8e-3..3e-3).contains(&a)),
        "{summary}"
    );
    desk.ends(CHATTER, &["check", "deep.toml"]);
    let junit = std::fs::read_to_string(desk.path("out/junit.xml")).unwrap();
    assert!(junit.contains("message=\"ended in chatter at"), "{junit}");

    let sweep = "[[sweep.axis]]\nkey = 'process.milling.axial_depth_mm'\nvalues = [0.2, 4]\n\
                 [[sweep.column]]\nname = 'growth'\nscalar = 'milling.growth_rate'\nunit = '1/s'\n";
    std::fs::write(desk.path("depths.toml"), format!("{cut}{sweep}")).unwrap();
    let out = desk.ends(CHATTER, &["run", "depths.toml"]);
    assert!(
        out.contains("2 rows, ✗ 1 ended in chatter") && out.contains("✗ chatter"),
        "{out}"
    );
    assert!(
        out.contains("✗ axial_depth_mm = 4: ended in chatter at"),
        "{out}"
    );
}

/// Climbing, the wheel rubs at its surface speed less the feed; against it, plus the feed.
/// Preston's law shows it.
#[test]
fn the_sense_of_the_wheel_shows_in_what_it_removes() {
    let desk = Desk::new();
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/wheel/plate.toml");
    let plate = plate.to_str().unwrap();
    let whole = desk.ends(0, &["run", plate, "--no-rrd"]);
    assert!(!whole.contains("unfinished"), "{whole}");
    let short = ["run", plate, "--no-rrd", "--set", "run.duration_s=3"];
    let short = String::from_utf8(desk.truecut(&short).stdout).unwrap();
    assert!(
        short.contains("run.duration_s is 3.0000 s") && short.contains("unfinished"),
        "{short}"
    );
    let checked = [
        "check",
        plate,
        "--set",
        "run.duration_s=3",
        "--junit",
        "short.xml",
    ];
    let checked = String::from_utf8(desk.truecut(&checked).stdout).unwrap();
    let junit = std::fs::read_to_string(desk.path("short.xml")).unwrap();
    assert!(
        checked.contains("of an unfinished process") && junit.contains("of an unfinished process"),
        "{checked}"
    );
    let against = ["--set", "process.wheel.spin=against"];
    let out = desk.ends(
        CLAIM_FAILED,
        &[&["run", plate, "--no-rrd"], &against[..]].concat(),
    );
    assert!(out.contains("✗ removes what Preston's law says"), "{out}");
}

#[test]
fn a_run_says_what_is_asked_of_the_drives_and_what_the_servo_gives_way() {
    let desk = Desk::new();
    desk.scenario("hold", "duration_s = 0.1", "");
    let out = desk.ends(0, &["run", "hold.toml", "--no-rrd"]);
    assert!(
        out.contains("largest drive torque: ") && out.contains("of its limit (joint `slide`"),
        "{out}"
    );
    let servo = desk.ends(
        0,
        &["run", "hold.toml", "--no-rrd", "--set", "robot.drive=servo"],
    );
    assert!(
        servo.contains("no integral action") && servo.contains("times as soft"),
        "{servo}"
    );
    let pushed = "process.load.release_n=[40000, 0, 0]";
    let out = desk.ends(6, &["run", "hold.toml", "--no-rrd", "--set", pushed]);
    assert!(out.contains("✗ DRIVE OVERLOADED: "), "{out}");
    // A servo is never asked for more than it has; that it gives all is told in its place.
    let driven = ["--set", "robot.drive=servo", "--set", pushed];
    let out = desk.ends(
        DIVERGED,
        &[&["run", "hold.toml", "--no-rrd"], &driven[..]].concat(),
    );
    assert!(out.contains("! SERVO SATURATED for "), "{out}");
    assert!(!servo.contains("SERVO SATURATED"), "{servo}");
}

#[test]
fn a_row_interval_that_is_no_multiple_of_the_step_is_told() {
    let desk = Desk::new();
    desk.scenario(
        "swing",
        "duration_s = 0.1\ntime_step_ms = 0.2\nrecord_interval_ms = 0.5",
        "",
    );
    let out = desk.ends(0, &["run", "swing.toml", "--no-rrd"]);
    assert!(
        out.contains("the 0.5 ms asked for are no whole number of steps"),
        "{out}"
    );
}

/// Poses are read in metres: of one at 700 m the units are told, of one that is near but has no
/// posture they are not.
#[test]
fn poses_in_millimetres_are_asked_about() {
    let desk = Desk::new();
    let urdf = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/robots/hp20/robot.urdf"
    );
    for (pose, is_asked) in [("700,0,900,0,3.14,0", true), ("0.1,0,0.1,0,3.14,0", false)] {
        let output = desk.truecut(&["robot", urdf, &format!("--ik={pose}")]);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains("have no posture within limits"), "{told}");
        assert_eq!(
            told.contains("poses are read in m and rad"),
            is_asked,
            "{told}"
        );
    }
}
