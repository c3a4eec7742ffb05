//! What is wrong with the input is told before the work, not after it; what a path must not ask of
//! an arm gets no program.

use super::path::{hp20, repository, told};
use super::{BAD_INPUT, CLAIM_FAILED, Desk, LONG};

/// A run of 300 s with a claim, which is refused before it has begun: one so long says what it will
/// take before its first step (`kept.rs`), and leaves what it has recorded.
fn refused_before(claim: &str, parts: &[&str]) {
    let desk = Desk::new();
    let claim = format!("[[claim]]\nname = \"one\"\nreason = \"a test\"\n{claim}\n");
    desk.scenario("long", LONG, &claim);
    let output = desk.truecut(&["run", "long.toml", "--no-rrd"]);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
    assert!(!told(&output).contains(" steps, "), "{}", told(&output));
    let left = std::fs::read_dir(desk.path("out/long")).unwrap();
    assert_eq!(
        left.count(),
        0,
        "nothing is left of a run that did not begin"
    );
    for part in parts {
        assert!(told(&output).contains(part), "{part}: {}", told(&output));
    }
}

#[test]
fn a_misspelt_scalar_is_told_before_the_run() {
    let claim = "scalar = \"plant.mode1_freqency\"\nmin = 1\nunit = \"Hz\"";
    refused_before(
        claim,
        &["plant.mode1_freqency", "plant.mode1_frequency", "long.toml"],
    );
}

#[test]
fn a_scalar_in_a_unit_of_another_dimension_is_told_before_the_run() {
    let claim = "scalar = \"run.time_step\"\nmin = 0\nunit = \"mm\"";
    refused_before(claim, &["run.time_step", "mm", "long.toml"]);
}

/// Runs that are too short to cost anything are told the same as long ones.
#[test]
fn a_misspelt_scalar_of_a_short_run_is_told_before_it() {
    let desk = Desk::new();
    let claim = "[[claim]]\nname = \"one\"\nreason = \"a test\"\nscalar = \"load.force_x\"\n\
                 max = 1\nunit = \"N\"\n";
    desk.scenario("short", "duration_s = 0.01", claim);
    let parts = [
        "unknown scalar \"load.force_x\"",
        "known: run.time_step",
        "short.toml:",
    ];
    let told = desk.refused(&["run", "short.toml", "--no-rrd"], &parts);
    assert!(!told.contains("the run is kept"), "{told}");
}

/// A sweep over long runs, by a column and by a search for a threshold.
#[test]
fn a_misspelt_scalar_of_a_sweep_is_told_before_its_runs() {
    let desk = Desk::new();
    let axis = "[[sweep.axis]]\nkey = \"process.load.release_n.0\"\nvalues = [50, 100]\n";
    let scalar = "scalar = \"plant.mode1_freqency\"\nunit = \"Hz\"\n";
    let column = format!("[[sweep.column]]\nname = \"first\"\n{scalar}");
    let search = format!(
        "[sweep.bisect]\nkey = \"robot.damping_scale\"\nfrom = 1\nto = 2\nlimit = 1\n{scalar}"
    );
    for table in [column, search] {
        desk.scenario("long", LONG, &format!("{axis}{table}"));
        let parts = [
            "plant.mode1_freqency",
            "plant.mode1_frequency",
            "long.toml:",
        ];
        desk.refused(&["sweep", "long.toml"], &parts);
        assert!(!desk.path("out/long/sweep.rows.jsonl").exists());
    }
}

/// A job of the mould's top with changed lines: refused soon, at the line.
fn job_refused(changes: &[(&str, &str)], more: &str, parts: &[&str]) {
    let desk = Desk::new();
    let shipped = repository().join("scenarios/finishing/mould_top.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    let (text, _) = text.split_once("[[taught]]").unwrap();
    let program = "[program]\ndialect = \"jbi\"\nname = \"MOULD\"\ndate = \"2026-01-31 12:00\"\n";
    let mut text = format!("{more}{text}{program}");
    text = text.replace("../..", repository().to_str().unwrap());
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(desk.path("job.toml"), text).unwrap();
    std::fs::write(desk.path("cell.toml"), "clearance_mm = -1\n").unwrap();
    let fixture = "[[fixture]]\nname = \"post\"\nshape = { mesh = \"none.stl\" }\n";
    std::fs::write(desk.path("mesh.toml"), fixture).unwrap();
    std::fs::write(desk.path("key.toml"), "clearence_mm = 1\n").unwrap();
    let output = desk.truecut(&["path", "job.toml"]);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
    for part in parts {
        assert!(told(&output).contains(part), "{part}: {}", told(&output));
    }
    // Nothing was planned: not even a word of how far it is.
    assert!(!told(&output).contains("% after"), "{}", told(&output));
}

#[test]
fn a_jobs_cell_name_and_step_are_told_before_planning() {
    let cell = |file: &str| format!("cell = \"{file}\"\n");
    job_refused(
        &[],
        &cell("cell.toml"),
        &["clearance_mm", "-1", "cell.toml"],
    );
    job_refused(&[], &cell("key.toml"), &["clearence_mm", "key.toml"]);
    job_refused(&[], &cell("mesh.toml"), &["none.stl"]);
    let name = ("name = \"MOULD\"", "name = \"mould top\"");
    job_refused(&[name], "", &["mould top", "A-Z", "job.toml"]);
    let step = ("step_mm = 2", "step_mm = 0.001");
    job_refused(&[step], "", &["step_mm", "0.001", "0.02", "job.toml"]);
}

#[test]
fn a_path_that_is_too_fast_for_a_joint_gets_no_program() {
    let desk = Desk::new();
    let path = |mm_per_min: u32| {
        let code =
            format!("G21 G90\nG0 X0 Y-200 Z50\nG1 Z0 F1200\nG1 Y200 F{mm_per_min}\nG0 Z50\nM2\n");
        std::fs::write(desk.path("2_edge.nc"), code).unwrap();
        let place = ["--work-xyz-mm", "900,0,350", "--dialect", "rapid"];
        let robot = hp20();
        desk.truecut(&[&["path", "2_edge.nc", "--robot", &robot][..], &place].concat())
    };
    let program = desk.path("out/2_edge/P2EDGE.mod");
    let slow = path(3000);
    assert!(slow.status.success(), "{}", told(&slow));
    let text = std::fs::read_to_string(&program).unwrap();
    assert!(text.contains("PERS tooldata tool:="), "{text}");
    let fast = path(540_000);
    assert_eq!(fast.status.code(), Some(CLAIM_FAILED), "{}", told(&fast));
    for part in ["would have to turn at", "no program is written"] {
        assert!(told(&fast).contains(part), "{}", told(&fast));
    }
    // The one of the call before is gone; where it is too fast can be seen.
    assert!(!program.exists() && desk.path("out/2_edge/path.rrd").is_file());
    let robot = hp20();
    let named = desk.truecut(&["path", "2_edge.nc", "--robot", &robot, "--name", "2 edge"]);
    assert_eq!(named.status.code(), Some(BAD_INPUT));
    for part in ["--name", "2 edge", "a letter"] {
        assert!(told(&named).contains(part), "{}", told(&named));
    }
}

#[test]
fn a_folder_in_the_place_of_the_report_is_told_before_the_runs() {
    let desk = Desk::new();
    desk.scenario("long", LONG, "");
    // A fault of the first scenario would be told if any was looked at.
    desk.scenario("faulty", "duration_s = -1", "");
    let output = desk.truecut(&["check", "faulty.toml", "long.toml", "--junit", "."]);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
    assert!(told(&output).contains("is a folder"), "{}", told(&output));
    assert!(!told(&output).contains("faulty"), "{}", told(&output));
    let checked = desk.truecut(&["check", "faulty.toml", "--junit", "report.xml"]);
    assert!(told(&checked).contains("faulty"), "{}", told(&checked));
}

#[test]
fn a_scenario_that_is_named_twice_is_checked_once() {
    let desk = Desk::new();
    desk.scenario("short", "duration_s = 0.01", "");
    let output = desk.truecut(&["check", "short.toml", ".", "./short.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let report = std::fs::read_to_string(desk.path("out/junit.xml"));
    let report = report.or_else(|_| std::fs::read_to_string(desk.path("junit.xml")));
    assert_eq!(
        report.unwrap().matches("<testsuite ").count(),
        1,
        "{}",
        told(&output)
    );
}

#[test]
fn poses_in_millimetres_or_degrees_are_noted() {
    let desk = Desk::new();
    let ik = |pose: &str| told(&desk.truecut(&["robot", &hp20(), "--ik", pose]));
    let far = ik("900,0,350,0,0,0");
    assert!(
        far.contains("m from the first joint") && far.contains("in m and rad"),
        "{far}"
    );
    let turned = ik("0.9,0,0.35,180,0,0");
    assert!(
        turned.contains("180 rad, more than a whole turn"),
        "{turned}"
    );
    let plain = ik("0.9,0,0.35,3.14,0,0");
    assert!(!plain.contains("in m and rad"), "{plain}");
}

/// The block stands 300 mm further than the brush is led.
#[test]
fn a_brush_that_never_touches_has_an_outcome_of_its_own() {
    let desk = Desk::new();
    let file = repository().join("scenarios/finishing/block_edge_brush.toml");
    let file = file.to_str().unwrap();
    let away = "process.brush.workpiece.xyz_mm=[1300,-30,400]";
    let output = desk.truecut(&["run", file, "--no-rrd", "--set", away]);
    assert_eq!(output.status.code(), Some(8), "{}", told(&output));
    assert!(
        told(&output).contains("clear of the workpiece is 1"),
        "{}",
        told(&output)
    );
    // A coefficient ten thousand times too large rounds the edge away.
    let sharp = "process.brush.preston_per_pa=1e-7";
    let output = desk.truecut(&["run", file, "--no-rrd", "--set", sharp]);
    assert_eq!(output.status.code(), Some(8), "{}", told(&output));
    assert!(told(&output).contains("rounding"), "{}", told(&output));
    let sharper = "process.brush.preston_per_pa=1";
    let output = desk.truecut(&["run", file, "--no-rrd", "--set", sharper]);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
}

/// An empty file beside the arm, and an empty cell: each is told.
#[test]
fn files_that_say_nothing_are_noted() {
    let desk = Desk::new();
    std::fs::copy(hp20(), desk.path("robot.urdf")).unwrap();
    std::fs::write(desk.path("robot.toml"), "# to be filled in\n").unwrap();
    std::fs::write(desk.path("cell.toml"), "").unwrap();
    let robot = told(&desk.truecut(&["robot", "robot.urdf"]));
    assert!(robot.contains("robot.toml says nothing"), "{robot}");
    std::fs::write(desk.path("way.nc"), "G0 X0 Y0 Z50\nG1 Z0 F1200\nM2\n").unwrap();
    let place = ["--work-xyz-mm", "900,0,350", "--cell", "cell.toml"];
    let path = desk.truecut(&[&["path", "way.nc", "--robot", "robot.urdf"][..], &place].concat());
    let path = told(&path);
    for part in ["gives no tool frame", "names no part, no fixture"] {
        assert!(path.contains(part), "{part}: {path}");
    }
}
