//! What SIGINT and SIGTERM leave of a run.

use std::process::{Child, Command, Stdio};
use std::time::Duration;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use truecut_recording::{Outcome, Summary};
use truecut_telemetry::read_parquet;

use super::{Desk, LONG, LONG_S, claim, sweep, wait_for_rows};

fn start(desk: &Desk, arguments: &[&str]) -> Child {
    let mut command = desk.command(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Sends a signal by its name.
fn send(child: &Child, name: &str) {
    let line = format!("kill -{name} {}", child.id());
    let sent = Command::new("sh").args(["-c", &line]).status().unwrap();
    assert!(sent.success());
}

/// Stops a child by a signal, upon which it must end with that code; what it printed.
fn ended_by(child: Child, name: &str, code: i32) -> String {
    send(&child, name);
    let output = child.wait_with_output().unwrap();
    let out = String::from_utf8_lossy(&output.stdout).into_owned();
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{out}{err}");
    out
}

#[test]
fn a_run_that_a_signal_stops_at_any_time_has_whole_files_that_agree() {
    let desk = Desk::new();
    let limit = claim("swings", "min = 1");
    desk.scenario("long", LONG, &limit);
    let mut draw = ChaCha8Rng::seed_from_u64(25);
    for trial in 0..6 {
        let mut child = start(&desk, &["run", "long.toml"]);
        wait_for_rows(&mut child, &desk.path("out/long/recording.arrows"), 200_000);
        std::thread::sleep(Duration::from_millis(u64::from(draw.next_u32() % 300)));
        let (name, code) = [("INT", 130), ("TERM", 143)][trial % 2];
        let out = ended_by(child, name, code);
        assert!(
            out.contains("✗ was interrupted") && out.contains("claims not judged: 1"),
            "{out}"
        );
        let read = read_parquet(&desk.path("out/long/recording.parquet")).unwrap();
        assert_eq!(read.outcome, Outcome::Interrupted);
        assert!(read.time_s.len() > 100 && *read.time_s.last().unwrap() < LONG_S);
        let text = std::fs::read_to_string(desk.path("out/long/summary.json")).unwrap();
        let summary: Summary = serde_json::from_str(&text).unwrap();
        assert_eq!(summary.outcome, Outcome::Interrupted);
        assert!(summary.claims.is_empty());
        assert!(desk.path("out/long/recording.rrd").exists());
        assert!(!desk.path("out/long/recording.arrows").exists());
        assert!(!desk.path("out/long/.part").exists());
    }
}

#[test]
fn what_has_not_begun_when_a_signal_comes_is_not_run_and_keeps_what_an_earlier_run_left() {
    let desk = Desk::new();
    desk.scenario("long", LONG, "");
    desk.scenario("swing", "duration_s = 0.1", "");
    desk.ends(0, &["run", "swing.toml", "--no-rrd"]);
    let before = std::fs::read(desk.path("out/swing/summary.json")).unwrap();
    // One job: the second scenario waits for the first.
    let arguments = ["run", "long.toml", "swing.toml", "--no-rrd", "--jobs", "1"];
    let mut child = start(&desk, &arguments);
    wait_for_rows(&mut child, &desk.path("out/long/recording.arrows"), 200_000);
    let out = ended_by(child, "INT", 130);
    assert!(
        out.contains("Rig swing\n  not run: stopped by a signal"),
        "{out}"
    );
    let after = std::fs::read(desk.path("out/swing/summary.json")).unwrap();
    assert_eq!(before, after);
}

#[test]
fn a_sweep_that_a_signal_stops_keeps_its_rows_and_goes_on() {
    let desk = Desk::new();
    let axis = sweep("run.duration_s", "0.1, 0.2, 300, 301");
    desk.scenario("swept", LONG, &axis);
    let journal = desk.path("out/swept/sweep.rows.jsonl");
    let mut child = start(&desk, &["run", "swept.toml", "--jobs", "1"]);
    while std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) < 3 {
        assert!(child.try_wait().unwrap().is_none(), "the sweep had ended");
        std::thread::sleep(Duration::from_millis(2));
    }
    let out = ended_by(child, "INT", 130);
    assert!(
        out.contains("stopped by a signal: 2 rows are kept"),
        "{out}"
    );
    assert!(!desk.path("out/swept/sweep.parquet").exists());
    let text = std::fs::read_to_string(&journal).unwrap();
    assert_eq!(text.lines().count(), 3, "no row of a run that was stopped");
}

#[test]
fn a_check_that_a_signal_stops_keeps_the_verdicts_that_there_are() {
    let desk = Desk::new();
    let limit = claim("swings", "min = 1");
    // One job: in this order.
    desk.scenario("a_swing", "duration_s = 0.1", &limit);
    desk.scenario("b_stands", "duration_s = 0.1", &claim("stands", "max = 0"));
    desk.scenario("c_long", LONG, &limit);
    desk.scenario("d_swept", LONG, &sweep("run.duration_s", "300, 301"));
    desk.scenario("e_swing", "duration_s = 0.1", &limit);
    let files =
        ["a_swing", "b_stands", "c_long", "d_swept", "e_swing"].map(|it| format!("{it}.toml"));
    let files = files.each_ref().map(String::as_str);
    let mut draw = ChaCha8Rng::seed_from_u64(2530);
    for trial in 0..4 {
        // The sweep is begun in every other trial, since the long run is then not asked for.
        let with_run = trial < 2;
        let asked: Vec<&str> = files
            .iter()
            .copied()
            .filter(|it| with_run || *it != "c_long.toml")
            .collect();
        let out = ["--out", "failed", "--jobs", "1"];
        let mut child = start(&desk, &[&["check"], &asked[..], &out].concat());
        // What fails is written as soon as it has its verdict.
        let failed = desk.path("failed/b_stands/summary.json");
        while !failed.exists() {
            assert!(child.try_wait().unwrap().is_none(), "it had ended");
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_millis(u64::from(draw.next_u32() % 400)));
        let (name, code) = [("INT", 130), ("TERM", 143)][trial % 2];
        let out = ended_by(child, name, code);
        std::fs::remove_file(&failed).unwrap();
        assert!(
            out.contains("✓ a_swing.toml") && out.contains("✗ b_stands.toml"),
            "{out}"
        );
        let left = asked.len() - 2;
        assert!(
            out.contains(&format!(
                "1 of {} scenarios hold, {left} without a verdict",
                asked.len()
            )),
            "{out}"
        );
        let line = |file: &str| {
            out.lines()
                .find(|line| line.contains(file))
                .unwrap()
                .to_owned()
        };
        assert!(
            line("e_swing").ends_with("not run: stopped by a signal"),
            "{out}"
        );
        let junit = std::fs::read_to_string(desk.path("out/junit.xml")).unwrap();
        let count = |what: &str| junit.matches(what).count();
        assert_eq!(
            (count("<testsuite "), count("<skipped"), count("<failure")),
            (asked.len(), left, 1),
            "{junit}"
        );
    }
}

/// The run that a claim refers to is stopped: nothing is judged on a part of it.
#[test]
fn a_claim_is_not_judged_on_a_part_of_the_run_that_it_refers_to() {
    let desk = Desk::new();
    let reference = "relative_to = { set = { \"run.duration_s\" = 300 } }\nmin = 0";
    let claim = claim("as far", reference).replace("\"um\"", "\"1\"");
    let length = "duration_s = 0.1\ntime_step_ms = 0.02\nrecord_interval_ms = 1";
    desk.scenario("short", length, &claim);
    let mut child = start(&desk, &["run", "short.toml", "--no-rrd"]);
    wait_for_rows(&mut child, &desk.path("out/short/recording.arrows"), 1);
    // The reference takes many seconds, the run itself a moment.
    std::thread::sleep(Duration::from_millis(700));
    let out = ended_by(child, "INT", 130);
    assert!(out.contains("claims not judged: 1"), "{out}");
    let out = desk.path("checked.xml");
    let arguments = ["check", "short.toml", "--junit", out.to_str().unwrap()];
    let mut child = start(&desk, &arguments);
    std::thread::sleep(Duration::from_millis(1000));
    assert!(child.try_wait().unwrap().is_none(), "it had ended");
    ended_by(child, "TERM", 143);
    let junit = std::fs::read_to_string(&out).unwrap();
    assert_eq!(junit.matches("<skipped").count(), 1, "{junit}");
}
