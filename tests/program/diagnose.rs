//! `truecut diagnose` as a user meets it, on the example that is shipped. Its data come from MuJoCo
//! (`tests/hidden_effects/example.py`), with 1.2 mrad of play in the second joint.

use super::*;

use std::collections::BTreeMap;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use truecut_discrepancy::between::{self, Changes};
use truecut_discrepancy::diagnose::{Diagnosis, Verdict};
use truecut_scenario::Scenario;

/// Play that the data hold, rad.
const PLAY_RAD: f64 = 1.2e-3;
/// And later.
const WORN_RAD: f64 = 1.5e-3;

/// The example, copied to a desk.
pub(super) fn desk() -> Desk {
    let desk = Desk::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .unwrap();
    let folder = root.join("scenarios/diagnosis");
    let text = std::fs::read_to_string(folder.join("elbow.toml")).unwrap();
    let text = text.replace("../../assets", &root.join("assets").display().to_string());
    std::fs::write(desk.path("elbow.toml"), text).unwrap();
    for name in ["elbow.csv", "elbow_later.csv"] {
        std::fs::copy(folder.join(name), desk.path(name)).unwrap();
    }
    desk
}

/// All files of the desk's own folder, by name.
fn files(desk: &Desk) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = std::fs::read_dir(desk.folder.path()).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.is_file())
        .map(|path| (path.clone(), std::fs::read(&path).unwrap()))
        .collect()
}

#[test]
fn diagnose_names_what_the_example_hides() {
    let desk = desk();
    let told = desk.ends(0, &["diagnose", "elbow.toml"]);
    assert!(told.contains("CAUSE NAMED"), "{told}");
    let text = std::fs::read_to_string(desk.path("out/elbow/diagnosis.json")).unwrap();
    let found: Diagnosis = serde_json::from_str(&text).unwrap();
    assert_eq!(found.verdict, Verdict::Named);
    let [cause] = found.causes.as_slice() else {
        panic!("one cause, and no other: {:?}", found.causes);
    };
    assert_eq!(cause.kind, "joint_backlash");
    assert_eq!(cause.target.as_deref(), Some("joint2"));
    let gap = &cause.parameters["gap_rad"];
    assert!((gap.value / PLAY_RAD - 1.0).abs() < 0.02, "{gap:?}");
    // One set in twenty lies outside its 95 % interval, this one by a hair; how often intervals
    // hold the truth is for the benches. Three standard errors hold 997 of 1000.
    let error = (gap.high.unwrap() - gap.low.unwrap()) / (2.0 * 1.96);
    assert!((gap.value - PLAY_RAD).abs() < 3.0 * error, "{gap:?}");
    for (name, errors) in &found.channels {
        assert!(
            errors.after < 1.15 * errors.noise_floor && errors.after < errors.before,
            "{name}: {errors:?}"
        );
    }
    // The user's file with the cause added: comments are kept, and it runs.
    let extended = std::fs::read_to_string(desk.path("out/elbow/extended.toml")).unwrap();
    assert!(extended.contains("# What is wrong with this arm?"));
    assert!(extended.contains("kind = \"joint_backlash\""));
    desk.ends(0, &["check", "out/elbow/extended.toml"]);
    let report = std::fs::read_to_string(desk.path("out/elbow/report.html")).unwrap();
    assert!(report.contains("application/json") && report.contains("joint_backlash"));
    assert!(desk.path("out/elbow/diagnosis.rrd").exists());
}

/// The example's answer to what changed.
fn changes(desk: &Desk) -> Changes {
    let text = std::fs::read_to_string(desk.path("out/elbow/between.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn crosscheck_mujoco_play_that_grew_is_named_with_its_values_before_and_after() {
    let desk = desk();
    let told = desk.ends(
        0,
        &[
            "diagnose",
            "elbow.toml",
            "--between",
            "elbow.csv",
            "elbow_later.csv",
        ],
    );
    assert!(told.contains("CHANGED: joint_backlash on joint2"), "{told}");
    let found = changes(&desk);
    assert_eq!(found.verdict, between::Verdict::Changed);
    assert!(found.compared.repeated);
    let [change] = found.changes.as_slice() else {
        panic!("one change, and no other: {:?}", found.changes);
    };
    assert_eq!(change.kind, "joint_backlash");
    assert_eq!(change.target.as_deref(), Some("joint2"));
    let gap = &change.parameters["gap_rad"];
    let grown = WORN_RAD - PLAY_RAD;
    assert!((gap.before / PLAY_RAD - 1.0).abs() < 0.02, "{gap:?}");
    assert!((gap.after / WORN_RAD - 1.0).abs() < 0.02, "{gap:?}");
    assert!((gap.change / grown - 1.0).abs() < 0.05, "{gap:?}");
    let (low, high) = (gap.low.unwrap(), gap.high.unwrap());
    assert!(low < grown && grown < high, "{gap:?}");
    // What is there in both is told, and is no change.
    assert_eq!(found.shared[0].kind, "joint_backlash");
    let report = std::fs::read_to_string(desk.path("out/elbow/report.html")).unwrap();
    assert!(report.contains("application/json") && report.contains("elbow_later.csv"));
    for (name, size) in [("before", PLAY_RAD), ("after", WORN_RAD)] {
        let path = format!("out/elbow/{name}.toml");
        let scenario = Scenario::load(&desk.path(&path), &[]).unwrap();
        let [effect] = scenario.effects.as_slice() else {
            panic!("{name}: {:?}", scenario.effects);
        };
        assert!((effect.values[0] / size - 1.0).abs() < 0.02, "{effect:?}");
        desk.ends(0, &["check", &path]);
    }
}

/// Errors of two sensors on one measurement, each drawn by itself: play is in both, and none is
/// told.
#[test]
fn what_is_in_both_recordings_is_no_change() {
    let desk = desk();
    let text = std::fs::read_to_string(desk.path("elbow.csv")).unwrap();
    for (name, seed) in [("first.csv", 31), ("second.csv", 32)] {
        let mut draw = ChaCha8Rng::seed_from_u64(seed);
        // Uniform, of four times the deviation of what the sensors err by already.
        let mut error = |most: f64| most * (f64::from(draw.next_u32()) / 2_f64.powi(31) - 1.0);
        let mut lines = vec![text.lines().next().unwrap().to_owned()];
        for line in text.lines().skip(1) {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let [t, a, b, one, two, height] = cells[..] else {
                panic!("{line}");
            };
            let (one, two) = (one + error(6.0), two + error(1.7));
            let height = height + error(0.5);
            lines.push(format!("{t},{a},{b},{one:.3},{two:.3},{height:.3}"));
        }
        std::fs::write(desk.path(name), lines.join("\n") + "\n").unwrap();
    }
    let command = [
        "diagnose",
        "elbow.toml",
        "--between",
        "first.csv",
        "second.csv",
    ];
    let told = desk.ends(0, &command);
    assert!(told.contains("NOTHING CHANGED BEYOND NOISE"), "{told}");
    let found = changes(&desk);
    assert_eq!(found.verdict, between::Verdict::NothingChanged);
    assert!(found.changes.is_empty() && !found.smallest_seen.is_empty());
    assert_eq!(found.shared[0].kind, "joint_backlash");
    assert!(!desk.path("out/elbow/after.toml").exists());
}

#[test]
fn diagnose_that_may_not_search_says_so() {
    let desk = desk();
    let told = desk.ends(0, &["diagnose", "elbow.toml", "--max-runs", "5"]);
    assert!(told.contains("limit of 5 simulations"), "{told}");
    let text = std::fs::read_to_string(desk.path("out/elbow/diagnosis.json")).unwrap();
    let found: Diagnosis = serde_json::from_str(&text).unwrap();
    assert_eq!(found.verdict, Verdict::FitFailed);
}

#[test]
fn diagnose_interrupted_leaves_the_users_files_as_they_are() {
    let desk = desk();
    let before = files(&desk);
    for milliseconds in [1, 30, 100, 300, 1000, 2500] {
        let mut child = desk
            .command(&["diagnose", "elbow.toml"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(files(&desk), before, "after {milliseconds} ms");
    }
}

/// The answer's files, without what takes another time each time.
fn answer(desk: &Desk, folder: &str) -> (Diagnosis, String) {
    let read = |name: &str| std::fs::read_to_string(desk.path(folder).join(name)).unwrap();
    let mut found: Diagnosis = serde_json::from_str(&read("diagnosis.json")).unwrap();
    found.work.seconds = 0.0;
    (found, read("extended.toml"))
}

/// A diagnosis that is stopped at random moments, by signals that it catches and by one that it
/// cannot, comes to the same answer, without the simulations that it had made; files of an earlier
/// answer stay until then.
#[cfg(unix)]
#[test]
fn a_diagnosis_that_is_stopped_goes_on_where_it_was() {
    let desk = desk();
    desk.ends(0, &["diagnose", "elbow.toml", "--out", "whole"]);
    let folder = desk.path("out/elbow");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("diagnosis.json"), "earlier").unwrap();
    let journal = folder.join("diagnosis.runs");
    let mut draw = ChaCha8Rng::seed_from_u64(25_25);
    let mut before = 0;
    for signal in ["INT", "KILL", "TERM"] {
        let mut child = desk
            .command(&["diagnose", "elbow.toml"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let bytes = || journal.metadata().map_or(0, |it| it.len());
        while bytes() <= before + 1000 {
            assert!(
                child.try_wait().unwrap().is_none(),
                "{signal}: it had ended"
            );
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(u64::from(draw.next_u32() % 50)));
        let line = format!("kill -{signal} {}", child.id());
        assert!(
            Command::new("sh")
                .args(["-c", &line])
                .status()
                .unwrap()
                .success()
        );
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&output.stdout);
        let code = match signal {
            "INT" => Some(130),
            "TERM" => Some(143),
            _ => None,
        };
        assert_eq!(output.status.code(), code, "{signal}: {told}");
        assert!(
            code.is_none() || told.contains("stopped by a signal, without an answer"),
            "{told}"
        );
        assert!(
            bytes() > before,
            "{signal}: {} bytes after {before}",
            bytes()
        );
        before = bytes();
        let kept = std::fs::read_to_string(folder.join("diagnosis.json")).unwrap();
        assert_eq!(kept, "earlier");
    }
    // A prediction torn by the kill, and one whose bytes were damaged: both are made again.
    let mut bytes = std::fs::read(&journal).unwrap();
    bytes.truncate(bytes.len() - 5);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x40;
    std::fs::write(&journal, &bytes).unwrap();
    let told = desk.ends(0, &["diagnose", "elbow.toml"]);
    assert!(
        told.contains("simulations were kept from a diagnosis that was stopped"),
        "{told}"
    );
    assert!(answer(&desk, "out/elbow") == answer(&desk, "whole/elbow"));
    assert!(!journal.exists() && !folder.join(".part").exists());
}

/// Of other data, or with another version of them, nothing is taken over.
#[cfg(unix)]
#[test]
fn simulations_of_another_diagnosis_are_not_taken_over() {
    let desk = desk();
    let journal = desk.path("out/elbow/diagnosis.runs");
    let mut child = desk.command(&["diagnose", "elbow.toml"]).spawn().unwrap();
    while journal.metadata().map_or(0, |it| it.len()) < 1000 {
        assert!(child.try_wait().unwrap().is_none(), "it had ended");
        std::thread::sleep(Duration::from_millis(1));
    }
    // One writer a folder.
    let told = refused(&desk, &["diagnose", "elbow.toml"]);
    assert!(
        told.contains("another run is writing into this folder"),
        "{told}"
    );
    child.kill().unwrap();
    child.wait().unwrap();
    let text = std::fs::read_to_string(desk.path("elbow.csv")).unwrap();
    std::fs::write(desk.path("elbow.csv"), format!("{text}\n")).unwrap();
    let told = desk.ends(0, &["diagnose", "elbow.toml", "--max-runs", "5"]);
    assert!(!told.contains("were kept"), "{told}");
}

#[test]
fn diagnose_does_not_write_over_what_it_reads() {
    let desk = desk();
    let folder = desk.path("out/extended");
    std::fs::create_dir_all(&folder).unwrap();
    let text = std::fs::read_to_string(desk.path("elbow.toml")).unwrap();
    let data = desk.path("elbow.csv").display().to_string();
    let own = folder.join("extended.toml");
    std::fs::write(&own, text.replace("elbow.csv", &data)).unwrap();
    let kept = std::fs::read(&own).unwrap();
    let told = refused(&desk, &["diagnose", "out/extended/extended.toml"]);
    assert!(
        told.contains("would replace") && told.contains("--out"),
        "{told}"
    );
    assert_eq!(std::fs::read(&own).unwrap(), kept);
}

/// Where the answer cannot be written, that is said before the search, and an earlier answer is
/// left alone.
#[test]
fn diagnose_looks_at_its_folder_first() {
    let desk = desk();
    let folder = desk.path("out/elbow");
    std::fs::create_dir_all(folder.join("report.html")).unwrap();
    std::fs::write(folder.join("diagnosis.json"), "earlier").unwrap();
    let told = refused(&desk, &["diagnose", "elbow.toml"]);
    assert!(told.contains("report.html: it is a folder"), "{told}");
    let kept = std::fs::read_to_string(folder.join("diagnosis.json")).unwrap();
    assert_eq!(kept, "earlier");
    assert!(!folder.join("diagnosis.rrd").exists());
    std::fs::write(desk.path("taken"), "a file").unwrap();
    let told = refused(&desk, &["diagnose", "elbow.toml", "--out", "taken"]);
    assert!(told.contains("taken/elbow"), "{told}");
    assert_eq!(
        std::fs::read_to_string(desk.path("taken")).unwrap(),
        "a file"
    );
}

/// The example with its motion prescribed and its drive torques asked for.
const BACKWARDS: [(&str, &str); 6] = [
    (
        "mode = \"forward\"",
        "mode = \"inverse\"\ndifferentiate_cutoff_hz = 20\ncompare_cutoff_hz = 15",
    ),
    ("joint1.command", "joint1.angle"),
    ("joint2.command", "joint2.angle"),
    ("joint1.transmission_torque", "joint1.drive_torque"),
    ("joint2.transmission_torque", "joint2.drive_torque"),
    (
        "[[data.channel]]\ncolumn = \"height_mm\"\nchannel = \"tool.position_z\"\nunit = \"mm\"\n",
        "[fit]\nunknowns = [\"coulomb\", \"offset\"]\n",
    ),
];

/// What acts beside measured data and is an estimate is told once by each command; what does not
/// act is not: a rotor beside a motor that follows its command, a spring in inverse dynamics.
#[test]
fn estimates_that_act_are_told_beside_measured_data() {
    let desk = desk();
    let scenario = std::fs::read_to_string(desk.path("elbow.toml")).unwrap();
    let arm = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/arm_2r");
    let known = std::fs::read_to_string(arm.join("robot.toml")).unwrap();
    let guessed = known.replace("chosen: about", "estimated: about");
    assert_ne!(guessed, known);
    std::fs::write(desk.path("guessed.toml"), guessed).unwrap();
    let with_guess = scenario.replace("posture_deg", "config = \"guessed.toml\"\nposture_deg");
    std::fs::write(desk.path("guess.toml"), &with_guess).unwrap();
    let backwards = (BACKWARDS.iter()).fold(with_guess, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    std::fs::write(desk.path("backwards.toml"), backwards).unwrap();
    let springs = "estimated, not measured: stiffness of all 2 joints";
    let rotors = "estimated, not measured: rotor inertia of all 2 joints";
    for (arguments, told) in [
        (&["compare", "elbow.toml"][..], None),
        (&["compare", "guess.toml"], Some(springs)),
        (
            &["diagnose", "guess.toml", "--max-runs", "5"],
            Some(springs),
        ),
        (&["compare", "backwards.toml"], Some(rotors)),
        (&["fit", "backwards.toml"], Some(rotors)),
        (
            &["diagnose", "backwards.toml", "--max-runs", "5"],
            Some(rotors),
        ),
    ] {
        let text = desk.ends(0, arguments);
        let all = text.matches("estimated, not measured").count();
        assert_eq!(all, usize::from(told.is_some()), "{arguments:?}: {text}");
        assert!(told.is_none_or(|told| text.contains(told)), "{text}");
    }
}

/// What is said with exit code 2.
fn refused(desk: &Desk, arguments: &[&str]) -> String {
    let output = desk.truecut(arguments);
    assert_eq!(output.status.code(), Some(BAD_INPUT));
    String::from_utf8_lossy(&output.stderr).into_owned()
}
