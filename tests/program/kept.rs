//! What stays of an earlier result when the next one does not come to its end.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use truecut_telemetry::{read_ipc_stream, read_parquet};

use super::{BAD_INPUT, Desk, LONG, sweep, wait_for_rows};

const GROWING: [&str; 2] = ["recording.arrows", "sweep.rows.jsonl"];

/// The files below a folder with their bytes, without what grows while a run or a sweep goes on.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries
        .map(|entry| (entry.file_name().into_string().unwrap(), entry.path()))
        .filter(|(name, path)| !GROWING.contains(&name.as_str()) && path.is_file())
        .map(|(name, path)| (name, std::fs::read(path).unwrap()))
        .collect()
}

/// Runs the program where no file can grow beyond a size, as on a disk that is full. Its code.
fn ends_where_files_end(desk: &Desk, arguments: &[&str], bytes: u64) -> (Option<i32>, String) {
    let kib = bytes / 1024;
    let line = format!("trap '' XFSZ; ulimit -f {kib}; exec \"$0\" \"$@\"");
    ends_behind(desk, &line, arguments)
}

/// Runs the program by a line of bash that ends with its `"$0" "$@"`. Its code.
fn ends_behind(desk: &Desk, line: &str, arguments: &[&str]) -> (Option<i32>, String) {
    let output = std::process::Command::new("bash")
        .args(["-c", line, env!("CARGO_BIN_EXE_truecut")])
        .args(arguments)
        .current_dir(desk.folder.path())
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), err)
}

#[test]
fn a_full_disk_leaves_the_earlier_result_whole() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.5", "");
    desk.ends(0, &["run", "swing.toml"]);
    let folder = desk.path("out/swing");
    let earlier = files(&folder);
    assert_eq!(earlier.len(), 4);
    let largest = earlier.values().map(Vec::len).max().unwrap() as u64;
    let mut draw = ChaCha8Rng::seed_from_u64(2025);
    for trial in 0..10 {
        // Another mass of rows, so that the files would differ.
        let arguments = ["run", "swing.toml", "--set", "run.duration_s=0.6"];
        let bytes = draw.next_u64() % largest;
        let (code, err) = ends_where_files_end(&desk, &arguments, bytes);
        assert_eq!(code, Some(BAD_INPUT), "{trial}: {bytes} bytes: {err}");
        assert!(err.contains("out/swing"), "the file is named: {err}");
        assert!(files(&folder) == earlier, "{trial}: {bytes} bytes");
        assert!(!folder.join(".part").exists());
    }
    desk.ends(0, &["run", "swing.toml", "--set", "run.duration_s=0.6"]);
    assert!(files(&folder) != earlier);
}

/// As a user who may not write where an earlier result lies: the superuser without its powers, else
/// whoever runs the tests.
#[cfg(unix)]
#[test]
fn a_read_only_folder_keeps_the_earlier_result() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.1", "");
    desk.ends(0, &["run", "swing.toml"]);
    let folder = desk.path("out/swing");
    let earlier = files(&folder);
    let allow = |mode| std::fs::set_permissions(&folder, PermissionsExt::from_mode(mode)).unwrap();
    let powerless = "if [ \"$(id -u)\" = 0 ]; then exec setpriv --inh-caps=-all --bounding-set=-all \"$0\" \"$@\"; fi; \
                     exec \"$0\" \"$@\"";
    let arguments = ["run", "swing.toml", "--set", "run.duration_s=0.2"];
    allow(0o555);
    let (code, err) = ends_behind(&desk, powerless, &arguments);
    allow(0o755);
    assert_eq!(code, Some(BAD_INPUT), "{err}");
    assert!(err.contains("out/swing") && err.contains("denied"), "{err}");
    assert!(files(&folder) == earlier);
    let (code, err) = ends_behind(&desk, powerless, &arguments);
    assert_eq!(code, Some(0), "{err}");
    assert!(files(&folder) != earlier);
}

/// What a command has read, by whatever name, it does not write over: the robot, its settings.
#[test]
fn what_was_read_is_not_written_over() {
    let desk = Desk::new();
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof");
    for name in ["robot.urdf", "robot.toml"] {
        std::fs::copy(robots.join(name), desk.path(name)).unwrap();
    }
    let text = "name = \"Own\"\n[robot]\nurdf = 'robot.urdf'\n[run]\nduration_s = 0.01\n\
                [process.load]\nrelease_n = [100, 0, 0]\n";
    std::fs::write(desk.path("own.toml"), text).unwrap();
    std::os::unix::fs::symlink("robot.toml", desk.path("alias")).unwrap();
    let earlier = files(desk.folder.path());
    let writing = [
        ["export-mjcf", "own.toml", "-o"],
        ["check", "own.toml", "--junit"],
    ];
    for call in writing {
        for target in ["robot.urdf", "robot.toml", "alias", "own.toml"] {
            desk.refused(
                &[&call[..], &[target]].concat(),
                &["cannot be what is written"],
            );
            assert!(files(desk.folder.path()) == earlier, "{target}");
        }
    }
    for call in writing {
        desk.ends(0, &[&call[..], &["another"]].concat());
    }
    let init = [
        "robot",
        "init",
        "robot.urdf",
        "--payload",
        "1",
        "--force",
        "--out",
    ];
    desk.refused(
        &[&init[..], &["robot.urdf"]].concat(),
        &["cannot be what is written"],
    );
}

/// A `robot.toml` that cannot be read is not taken for none.
#[test]
fn settings_that_cannot_be_read_are_an_error() {
    let desk = Desk::new();
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof");
    std::fs::copy(robots.join("robot.urdf"), desk.path("robot.urdf")).unwrap();
    desk.ends(0, &["robot", "robot.urdf"]);
    let settings = desk.path("robot.toml");
    let refused = || {
        desk.refused(
            &["robot", "robot.urdf"],
            &["robot.toml: cannot read the file"],
        )
    };
    std::os::unix::fs::symlink("nowhere", &settings).unwrap();
    refused();
    std::fs::remove_file(&settings).unwrap();
    std::fs::create_dir(&settings).unwrap();
    refused();
}

/// A run whose rows, and a file whose contents, would take more memory than may be used are refused
/// before anything is begun; with enough they go on.
#[test]
fn what_takes_more_memory_than_may_be_used_is_refused_beforehand() {
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.5", "");
    desk.ends(0, &["run", "swing.toml", "--max-memory", "1G"]);
    let earlier = files(&desk.path("out/swing"));
    let refused = |arguments: &[&str], parts: &[&str]| {
        desk.refused(arguments, parts);
        assert!(files(&desk.path("out/swing")) == earlier);
    };
    // All channels of so many rows take 32 MB, their times 1.6 MB.
    let longer = "run.duration_s=50";
    desk.ends(0, &["run", "swing.toml", "--set", longer, "--out", "all"]);
    let within = ["--max-memory", "2M", "--out", "within"];
    desk.ends(
        0,
        &[&["run", "swing.toml", "--set", longer][..], &within[..]].concat(),
    );
    for name in ["recording.parquet", "summary.json"] {
        let [all, within] = ["all", "within"].map(|out| desk.path(&format!("{out}/swing/{name}")));
        assert!(
            std::fs::read(all).unwrap() == std::fs::read(within).unwrap(),
            "{name}"
        );
    }
    refused(
        &["run", "swing.toml", "--set", longer, "--max-memory", "100k"],
        &[
            "run.record_interval_ms",
            "bytes in memory",
            "at most 100000",
        ],
    );
    let urdf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof/robot.urdf");
    std::fs::write(desk.path("places.csv"), "0.001\n".repeat(10_000)).unwrap();
    refused(
        &[
            "--max-memory",
            "400k",
            "robot",
            urdf.to_str().unwrap(),
            "--fk",
            "places.csv",
        ],
        &["places.csv", "it has 60000 bytes", "up to 50000"],
    );
    for size in ["0", "-1", "2X", "much", "1e30"] {
        let option = format!("--max-memory={size}");
        refused(&["run", "swing.toml", &option], &["2G or 500M", size]);
    }
}

#[test]
fn a_full_disk_leaves_the_earlier_table_of_a_sweep() {
    let desk = Desk::new();
    let axis = sweep("run.duration_s", "0.1, 0.2");
    desk.scenario("swept", "duration_s = 0.1", &axis);
    desk.ends(0, &["run", "swept.toml"]);
    let folder = desk.path("out/swept");
    let earlier = files(&folder);
    let arguments = [
        "run",
        "swept.toml",
        "--set",
        "process.load.release_n=[50,0,0]",
    ];
    let (code, err) = ends_where_files_end(&desk, &arguments, 1024);
    assert_eq!(code, Some(BAD_INPUT), "{err}");
    assert!(files(&folder) == earlier);
}

/// A run of an hour says before its first step how much it will be.
#[test]
fn a_long_run_tells_beforehand_what_it_takes() {
    let desk = Desk::new();
    desk.scenario("long", LONG, "");
    let mut child = desk
        .command(&["run", "long.toml"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut told = String::new();
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    lines.read_line(&mut told).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(told.contains(" steps, 300001 rows of "), "{told}");
    assert!(
        told.contains("MB on the disk while it runs, 2.4 MB in memory"),
        "{told}"
    );
}

/// Whether a drive saturates is known after the run only: what it cost to compute stays.
#[test]
fn a_claim_that_cannot_be_judged_does_not_cost_the_run() {
    let desk = Desk::new();
    let claim = "[[claim]]\nname = 'a slip'\nscalar = 'plant.torque_saturated'\nmax = 1\nunit = 's'\nreason = 'none'\n";
    desk.scenario("slip", "duration_s = 0.2", claim);
    let output = desk.truecut(&["run", "slip.toml", "--no-rrd"]);
    assert_eq!(output.status.code(), Some(BAD_INPUT));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains("plant.torque_saturated") && told.contains("slip.toml:"),
        "{told}"
    );
    assert!(
        told.contains("the run is kept: out/slip/recording.parquet"),
        "{told}"
    );
    let rows = read_parquet(&desk.path("out/slip/recording.parquet")).unwrap();
    assert!(rows.time_s.last().is_some_and(|end_s| *end_s > 0.19));
    assert!(desk.path("out/slip/summary.json").exists());
}

/// A path that the run does not finish is told, whatever process works along it.
#[test]
fn a_path_that_is_not_finished_is_told() {
    let desk = Desk::new();
    let belt = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenarios/finishing/crowned_block_belt.toml"
    );
    let arguments = ["run", belt, "--no-rrd", "--set", "run.duration_s=0.5"];
    let output = desk.truecut(&arguments);
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.contains("run.duration_s is 0.5000 s, the process takes "),
        "{told}"
    );
}

#[test]
fn a_killed_run_leaves_the_earlier_result_and_its_own_rows() {
    let desk = Desk::new();
    desk.scenario("long", LONG, "");
    desk.ends(0, &["run", "long.toml", "--set", "run.duration_s=0.2"]);
    let folder = desk.path("out/long");
    let earlier = files(&folder);
    let mut draw = ChaCha8Rng::seed_from_u64(9);
    for _ in 0..4 {
        let mut child = desk
            .command(&["run", "long.toml"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let stream = folder.join("recording.arrows");
        wait_for_rows(&mut child, &stream, 100_000);
        std::thread::sleep(Duration::from_millis(u64::from(draw.next_u32() % 200)));
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(files(&folder) == earlier);
        assert!(read_ipc_stream(&stream).unwrap().time_s.len() > 100);
        std::fs::remove_file(&stream).unwrap();
    }
    desk.ends(0, &["run", "long.toml", "--set", "run.duration_s=0.3"]);
    let recording = read_parquet(&folder.join("recording.parquet")).unwrap();
    assert!((recording.time_s.last().unwrap() - 0.3).abs() < 2e-3);
    assert!(!folder.join("recording.arrows").exists() && !folder.join(".part").exists());
}

#[cfg(unix)]
#[test]
fn links_that_lie_where_files_go_are_not_followed() {
    use std::os::unix::fs::symlink;
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.1", "");
    let own = |name: &str| {
        let path = desk.path(name);
        std::fs::write(&path, "mine").unwrap();
        path
    };
    std::fs::create_dir_all(desk.path("out/swing")).unwrap();
    std::fs::create_dir_all(desk.path("precious")).unwrap();
    let names = [
        "recording.parquet",
        "recording.rrd",
        "summary.json",
        "recording.arrows",
    ];
    for name in names {
        symlink(
            own(&format!("own.{name}")),
            desk.path("out/swing").join(name),
        )
        .unwrap();
    }
    own("precious/recording.parquet");
    symlink(desk.path("precious"), desk.path("out/swing/.part")).unwrap();
    desk.ends(0, &["run", "swing.toml"]);
    let mine = |name: &str| std::fs::read_to_string(desk.path(name)).unwrap() == "mine";
    assert!(names.iter().all(|name| mine(&format!("own.{name}"))));
    assert!(mine("precious/recording.parquet"));
    assert!(read_parquet(&desk.path("out/swing/recording.parquet")).is_ok());

    // The folder of a scenario that is a link is refused; the folder given may be one.
    std::fs::create_dir_all(desk.path("other")).unwrap();
    symlink(desk.path("precious"), desk.path("other/swing")).unwrap();
    let output = desk.truecut(&["run", "swing.toml", "--out", "other"]);
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{err}");
    assert!(err.contains("other/swing: it is a link"), "{err}");
    assert_eq!(files(&desk.path("precious")).len(), 1);
    symlink(desk.path("precious"), desk.path("given")).unwrap();
    desk.ends(0, &["run", "swing.toml", "--out", "given"]);
    assert!(desk.path("precious/swing/summary.json").exists());
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_input() {
    use std::os::unix::fs::symlink;
    let desk = Desk::new();
    desk.scenario("swing", "duration_s = 0.1", "");
    let pipe = desk.path("pipe.toml");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    for ending in ["urdf", "csv", "stl", "jbi", "gcode", "parquet", "arrows"] {
        symlink("/dev/zero", desk.path(&format!("endless.{ending}"))).unwrap();
    }
    let refused = |arguments: &[&str], what: &str| desk.refused(arguments, &[what]);
    refused(&["run", "pipe.toml"], "it is a pipe, not a file");
    refused(&["check", "pipe.toml"], "it is a pipe, not a file");
    let device = "it is a device, not a file";
    refused(&["robot", "endless.urdf"], device);
    refused(&["part", "endless.stl"], device);
    let robot = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/robots/hp20/robot.urdf"
    );
    refused(&["program", "endless.jbi", "--robot", robot], device);
    refused(&["view", "endless.parquet"], device);
    refused(&["view", "endless.arrows"], device);
    let urdf = "robot.urdf=endless.urdf";
    refused(&["run", "swing.toml", "--set", urdf], device);
    let data = "[data]\nfile = \"endless.csv\"\ntime = \"t\"\n[[data.channel]]\ncolumn = \"x\"\n\
                channel = \"tool.position_x\"\nunit = \"m\"\n";
    desk.scenario("measured", "duration_s = 0.1", data);
    refused(&["compare", "measured.toml"], device);
}

/// A sweep of rows that take a moment each.
fn swept(desk: &Desk, rows: usize) {
    let values: Vec<String> = (1..=rows).map(|row| format!("{}", 10 * row)).collect();
    let axis = sweep("process.load.release_n.0", &values.join(", "));
    // A second column has no value in any row.
    let never = "[[sweep.column]]\nname = \"never\"\nmetric = \"first_time_above\"\n\
                 channel = \"tool.displacement_x\"\nthreshold = 1e9\nthreshold_unit = \"m\"\n\
                 unit = \"s\"\n";
    desk.scenario("swept", "duration_s = 4", &(axis + never));
}

#[test]
fn a_killed_sweep_goes_on_where_it_was() {
    let desk = Desk::new();
    swept(&desk, 24);
    desk.ends(0, &["run", "swept.toml", "--out", "whole"]);
    let whole = files(&desk.path("whole/swept"));
    let journal = desk.path("out/swept/sweep.rows.jsonl");
    let rows = || std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    let mut draw = ChaCha8Rng::seed_from_u64(11);
    let mut before = 0;
    for _ in 0..3 {
        let mut child = desk
            .command(&["run", "swept.toml"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while rows() <= before.max(1) + 2 && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_millis(u64::from(draw.next_u32() % 30)));
        child.kill().unwrap();
        child.wait().unwrap();
        let now = rows();
        assert!(now > before, "{now} lines after {before}");
        before = now;
    }
    // The last line as a kill tears it.
    let text = std::fs::read_to_string(&journal).unwrap();
    std::fs::write(&journal, &text[..text.len() - 9]).unwrap();
    let out = desk.ends(0, &["run", "swept.toml"]);
    let kept = before - 2;
    assert!(
        out.contains(&format!("{kept} of 24 rows were kept")),
        "{out}"
    );
    assert!(files(&desk.path("out/swept")) == whole);
    assert!(!journal.exists());
}

#[test]
fn rows_of_another_sweep_are_not_taken_over() {
    let desk = Desk::new();
    swept(&desk, 3);
    let folder = desk.path("out/swept");
    let run = |arguments: &[&str]| desk.ends(0, &[&["run", "swept.toml"], arguments].concat());
    let journal = folder.join("sweep.rows.jsonl");
    let stopped = |arguments: &[&str]| {
        let arguments = [&["run", "swept.toml"], arguments].concat();
        let mut child = desk.command(&arguments).spawn().unwrap();
        while std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) < 2 {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    };
    stopped(&[]);
    let left = std::fs::read(&journal).unwrap();
    let again = || std::fs::write(&journal, &left).unwrap();
    assert!(
        run(&["--set", "run.duration_s=3"])
            .find("were kept")
            .is_none()
    );
    again();
    assert!(run(&[]).contains("were kept"));
    // The robot's file has changed, by a comment only: who knows what else.
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof");
    for name in ["robot.urdf", "robot.toml"] {
        std::fs::copy(urdf.join(name), desk.path(name)).unwrap();
    }
    let own = ["--set", "robot.urdf=robot.urdf"];
    stopped(&own);
    let toml = desk.path("robot.toml");
    let text = std::fs::read_to_string(&toml).unwrap();
    std::fs::write(&toml, format!("{text}\n# touched\n")).unwrap();
    assert!(run(&own).find("were kept").is_none());
}
