//! The program as a user meets it: outputs, exit codes, what is left after a kill.

mod results;

mod before;
mod cam;
mod clearance;
mod compare;
mod completions;
mod coupled;
mod diagnose;
mod edges;
mod excite;
mod fit;
mod identify;
mod kept;
mod maps;
mod milled;
mod new;
mod parts;
mod path;
mod same;
mod signals;
mod stability;
mod verdicts;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use tempfile::TempDir;
use truecut_recording::{Outcome, Summary};
use truecut_telemetry::{read_ipc_stream, read_parquet};

const CLAIM_FAILED: i32 = 1;
const BAD_INPUT: i32 = 2;
const DIVERGED: i32 = 3;
/// A run ended in chatter.
const CHATTER: i32 = 5;

/// The length of a run that goes on for many seconds, with small rows and few of them: what it may
/// take on the disk stays under 50 MB.
const LONG_S: f64 = 300.0;
const LONG: &str = "duration_s = 300\ntime_step_ms = 0.02\nrecord_interval_ms = 1";

/// A folder with scenarios, and the program run in it.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Desk {
        Desk {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a scenario of the rig with one joint that swings freely, with further lines.
    fn scenario(&self, name: &str, run: &str, rest: &str) {
        let urdf = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../assets/robots/rig_1dof/robot.urdf")
            .canonicalize()
            .unwrap();
        let text = format!(
            "name = \"Rig {name}\"\n[robot]\nurdf = '{}'\n[run]\n{run}\n[process.load]\nrelease_n = [100, 0, 0]\n{rest}",
            urdf.display()
        );
        std::fs::write(self.path(&format!("{name}.toml")), text).unwrap();
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truecut"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env("NO_COLOR", "1");
        command
    }

    fn truecut(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Standard output of a call that must end with `code`.
    fn ends(&self, code: i32, arguments: &[&str]) -> String {
        let output = self.truecut(arguments);
        let (out, err) = (
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr),
        );
        assert_eq!(
            output.status.code(),
            Some(code),
            "{arguments:?}\n{out}{err}"
        );
        out.into_owned()
    }

    /// Standard error of a call that must be refused, with these parts in it.
    fn refused(&self, arguments: &[&str], parts: &[&str]) -> String {
        let output = self.truecut(arguments);
        let err = String::from_utf8_lossy(&output.stderr);
        let code = output.status.code();
        assert_eq!(code, Some(BAD_INPUT), "{arguments:?}: {err}");
        for part in parts {
            assert!(err.contains(part), "`{part}` is not in: {err}");
        }
        err.into_owned()
    }
}

/// Waits until a run that is under way has so many bytes of rows on the disk.
fn wait_for_rows(child: &mut Child, stream: &Path, bytes: u64) {
    while stream.metadata().map_or(0, |meta| meta.len()) < bytes {
        let ended = child.try_wait().unwrap();
        assert!(ended.is_none(), "the run ended, {ended:?}, with fewer rows");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn claim(name: &str, bound: &str) -> String {
    format!(
        "[[claim]]\nname = \"{name}\"\nmetric = \"peak\"\nchannel = \"tool.displacement_x\"\n{bound}\n\
         unit = \"um\"\nreason = \"it is let go\"\n"
    )
}

/// A sweep over the values of a key, of how far the tool swings.
fn sweep(key: &str, values: &str) -> String {
    format!(
        "[[sweep.axis]]\nkey = \"{key}\"\nvalues = [{values}]\n\
         [[sweep.column]]\nname = \"swing\"\nmetric = \"peak\"\n\
         channel = \"tool.displacement_x\"\nunit = \"um\"\n"
    )
}

#[test]
fn a_run_prints_claims_and_leaves_its_files() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.5", &claim("swings", "min = 1"));
    let out = desk.ends(0, &["run", "swing.toml"]);
    assert!(
        out.contains("Rig swing\n  completed: 0.500 s simulated in"),
        "{out}"
    );
    assert!(out.contains("1 of 1 claims hold\n  ✓ swings"), "{out}");
    assert!(out.contains("out/swing/recording.rrd"), "{out}");
    for name in ["recording.parquet", "recording.rrd", "summary.json"] {
        assert!(
            desk.path("out/swing").join(name).metadata().unwrap().len() > 100,
            "{name}"
        );
    }
    // The stream has served once the Parquet file is whole.
    assert!(!desk.path("out/swing/recording.arrows").exists());
    let recording = read_parquet(&desk.path("out/swing/recording.parquet")).unwrap();
    let summary = std::fs::read_to_string(desk.path("out/swing/summary.json")).unwrap();
    let summary: Summary = serde_json::from_str(&summary).unwrap();
    assert_eq!(
        (summary.scenario.as_str(), summary.claims[0].holds),
        ("Rig swing", true)
    );
    assert_eq!(
        summary.claims[0].value,
        Some(
            recording
                .channel("tool.displacement_x")
                .unwrap()
                .iter()
                .fold(0.0, |peak: f64, x| peak.max(x.abs()))
        )
    );
}

#[test]
fn no_rrd_means_none_not_even_an_old_one() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.1", "");
    desk.ends(0, &["run", "swing.toml", "--out", "there"]);
    assert!(desk.path("there/swing/recording.rrd").exists());
    desk.ends(0, &["run", "swing.toml", "--out", "there", "--no-rrd"]);
    assert!(!desk.path("there/swing/recording.rrd").exists());
}

#[test]
fn two_runs_give_the_same_bytes() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.5", &claim("swings", "min = 1"));
    let files = ["recording.parquet", "summary.json"];
    let run = |out: &str| {
        desk.ends(0, &["run", "swing.toml", "--no-rrd", "--out", out]);
        files.map(|name| std::fs::read(desk.path(out).join("swing").join(name)).unwrap())
    };
    for (name, (first, second)) in files.iter().zip(run("a").into_iter().zip(run("b"))) {
        assert!(first == second, "{name} differs between two runs");
    }
}

#[test]
fn exit_codes_tell_a_failed_claim_from_a_run_that_diverged() {
    let desk = Desk::new();
    desk.scenario(
        "swing",
        "duration_s = 0.1",
        &claim("stands still", "max = 0"),
    );
    let out = desk.ends(CLAIM_FAILED, &["run", "swing.toml", "--no-rrd"]);
    assert!(
        out.contains("0 of 1 claims hold\n  ✗ stands still"),
        "{out}"
    );

    // Pushed by a constant force without a transmission, the slide runs into its end.
    desk.scenario("push", "duration_s = 60", "");
    let text = std::fs::read_to_string(desk.path("push.toml")).unwrap();
    let pushed = text.replace("release_n = [100, 0, 0]", "constant_n = [5000, 0, 0]");
    std::fs::write(desk.path("push.toml"), pushed).unwrap();
    let out = desk.ends(
        DIVERGED,
        &["run", "push.toml", "--no-rrd", "--set", "robot.drive=force"],
    );
    assert!(out.contains("✗"), "{out}");
    let recording = read_parquet(&desk.path("out/push/recording.parquet")).unwrap();
    assert!(
        matches!(recording.outcome, Outcome::Diverged { .. }),
        "{:?}",
        recording.outcome
    );
    assert!(
        !recording.time_s.is_empty(),
        "what was recorded until then is on disk"
    );
}

#[test]
fn a_claim_may_refer_to_another_run() {
    let desk = Desk::new();
    desk.scenario("other", "duration_s = 0.2", "");
    let relative = |reference: &str| {
        claim(
            "twice as far",
            &format!("relative_to = {reference}\nmin = 1.999\nmax = 2.001"),
        )
        .replace("\"um\"", "\"1\"")
    };
    let half = "{ set = { \"process.load.release_n\" = \"[50, 0, 0]\" } }";
    desk.scenario("itself", "duration_s = 0.2", &relative(half));
    desk.ends(0, &["run", "itself.toml", "--no-rrd"]);
    let other = "{ scenario = \"other.toml\", set = { \"process.load.release_n.0\" = 50 } }";
    desk.scenario("first", "duration_s = 0.2", &relative(other));
    desk.ends(0, &["run", "first.toml", "--no-rrd"]);
}

#[test]
fn check_finds_scenarios_and_one_bad_one_does_not_hide_the_others() {
    let desk = Desk::new();
    std::fs::create_dir_all(desk.path("a/b")).unwrap();
    std::fs::write(desk.path("a/robot.toml"), "name = \"no scenario\"\n").unwrap();
    desk.scenario("a/b/good", "duration_s = 0.1", &claim("swings", "min = 1"));
    desk.scenario(
        "a/fails",
        "duration_s = 0.1",
        &claim("stands still", "max = 0"),
    );
    let out = desk.ends(CLAIM_FAILED, &["check", "a"]);
    assert!(
        out.contains("✓ a/b/good.toml") && out.contains("✗ a/fails.toml"),
        "{out}"
    );
    assert!(out.contains("1 of 2 scenarios hold"), "{out}");
    let junit = std::fs::read_to_string(desk.path("out/junit.xml")).unwrap();
    assert!(
        junit.contains("tests=\"4\"") && junit.contains("failures=\"1\""),
        "{junit}"
    );

    std::fs::write(desk.path("a/bad.toml"), "[process.load]\nfrom = 1\n").unwrap();
    let out = desk.ends(BAD_INPUT, &["check", "a", "--junit", "j.xml"]);
    assert!(
        out.contains("✗ a/bad.toml") && out.contains("✓ a/b/good.toml"),
        "{out}"
    );
    let junit = std::fs::read_to_string(desk.path("j.xml")).unwrap();
    assert!(
        junit.contains("errors=\"1\"") && junit.contains("unknown key"),
        "{junit}"
    );
}

#[test]
fn a_killed_run_leaves_what_it_had_recorded() {
    let desk = Desk::new();
    desk.scenario("long", LONG, "");
    let arguments = ["run", "long.toml", "--no-rrd"];
    let mut child = desk
        .command(&arguments)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let stream = desk.path("out/long/recording.arrows");
    wait_for_rows(&mut child, &stream, 500_000);
    child.kill().unwrap();
    assert!(
        !child.wait().unwrap().success(),
        "the run ended before it was killed"
    );
    let out = desk.ends(0, &["view", "out/long/recording.arrows"]);
    assert!(
        out.contains("was interrupted") && out.contains("tool.displacement_x"),
        "{out}"
    );
    let recording = read_ipc_stream(&stream).unwrap();
    assert!(recording.time_s.len() > 1000, "{}", recording.time_s.len());
    desk.ends(0, &["view", "out/long/recording.arrows", "--rrd"]);
    assert!(desk.path("out/long/recording.arrows.rrd").exists());
}

#[test]
fn a_converted_recording_does_not_replace_that_of_the_run() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.1", "");
    desk.ends(0, &["run", "swing.toml"]);
    let own = std::fs::read(desk.path("out/swing/recording.rrd")).unwrap();
    let out = desk.ends(0, &["view", "out/swing/recording.parquet", "--rrd"]);
    assert_eq!(out.trim(), "out/swing/recording.parquet.rrd");
    assert!(desk.path(out.trim()).exists());
    assert_eq!(
        std::fs::read(desk.path("out/swing/recording.rrd")).unwrap(),
        own
    );
}

#[test]
fn two_scenarios_do_not_write_into_one_folder() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("b")).unwrap();
    desk.scenario("swing", "duration_s = 0.1", "");
    desk.scenario("b/swing", "duration_s = 0.1", "");
    desk.scenario("b/SWING", "duration_s = 0.1", "");
    desk.ends(BAD_INPUT, &["run", "swing.toml", "b/swing.toml"]);
    desk.ends(BAD_INPUT, &["run", "swing.toml", "b/SWING.toml"]);
    assert!(!desk.path("out").exists());
}

/// A file's name that would lead out of the folder, or that no folder can have.
#[test]
fn what_a_file_is_called_does_not_lead_out_of_the_folder() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.01", "");
    for (name, folder) in [("..", "scenario"), ("a\tb", "a_b"), ("con", "con_")] {
        let file = format!("{name}.toml");
        std::fs::copy(desk.path("swing.toml"), desk.path(&file)).unwrap();
        desk.ends(0, &["run", &file, "--no-rrd", "--out", "out"]);
        assert!(desk.path("out").join(folder).join("summary.json").is_file());
    }
    assert!(!desk.path("summary.json").exists());
    assert_eq!(std::fs::read_dir(desk.path("out")).unwrap().count(), 3);
}

#[test]
fn the_schema_is_json_and_robots_are_described() {
    let desk = Desk::new();
    let schema: serde_json::Value = serde_json::from_str(&desk.ends(0, &["schema"])).unwrap();
    assert_eq!(schema["title"], "truecut scenario");

    let urdf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_planar/robot.urdf");
    let urdf = urdf.to_str().unwrap();
    let text = desk.ends(0, &["robot", urdf, "--posture-deg", "-1,2,3"]);
    assert!(
        text.contains("3 joints") && text.contains("-1.00 mm"),
        "{text}"
    );
    let json: serde_json::Value =
        serde_json::from_str(&desk.ends(0, &["robot", urdf, "--json"])).unwrap();
    assert_eq!(json["joints"].as_array().map(Vec::len), Some(3));
    std::fs::write(desk.path("postures.csv"), "0,0,0\n0.01,0,0\n").unwrap();
    let table = desk.ends(0, &["robot", urdf, "--fk", "postures.csv"]);
    let x: Vec<f64> = table
        .lines()
        .skip(1)
        .map(|row| row.split(',').next().unwrap().parse().unwrap())
        .collect();
    assert!((x[1] - x[0] - 0.01).abs() < 1e-12, "{table}");
    // One posture is written beside the option.
    for (posture, row) in [("0,0,0", 1), ("0.01,0,0", 2)] {
        let one = desk.ends(0, &["robot", urdf, "--fk", posture]);
        assert_eq!(one.lines().nth(1), table.lines().nth(row), "{one}");
    }
    for (posture, parts) in [
        (
            "0,0",
            &["--fk", "2 values", "3 joints", "none for joint"][..],
        ),
        ("0,0,0,1", &["--fk", "4 values", "3 joints", "value 4"]),
        ("0,half,0", &["--fk", "value 2 of joint", "\"half\""]),
        ("0,0,inf", &["--fk", "value 3 of joint", "\"inf\""]),
        ("a,b,c", &["--fk", "a, b, c", "each of the 3 joints"]),
    ] {
        desk.refused(&["robot", urdf, "--fk", posture], parts);
    }
    desk.refused(&["robot", urdf, "--fk", "none.csv"], &["none.csv"]);
}

#[test]
fn a_mujoco_model_is_written_where_it_is_asked_for() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.1", "");
    let arguments = ["export-mjcf", "swing.toml", "-o", "models/swing.xml"];
    // A folder that is not there is a slip in the file's name.
    desk.ends(BAD_INPUT, &arguments);
    std::fs::create_dir(desk.path("models")).unwrap();
    desk.ends(0, &arguments);
    let mjcf = std::fs::read_to_string(desk.path("models/swing.xml")).unwrap();
    assert!(mjcf.starts_with("<mujoco"), "{mjcf}");
}
