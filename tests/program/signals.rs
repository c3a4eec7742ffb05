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
fn a_sweep_still_ends_at_the_first_signal() {
    let desk = Desk::new();
    let axis = sweep("run.duration_s", "300, 301");
    desk.scenario("swept", LONG, &axis);
    let mut child = start(&desk, &["run", "swept.toml"]);
    std::thread::sleep(Duration::from_millis(700));
    assert!(child.try_wait().unwrap().is_none(), "the sweep had ended");
    send(&child, "INT");
    // Ended by the signal itself, so that a shell's loop ends, too; or by the program, if it had
    // not come to the sweep.
    let code = child.wait().unwrap().code();
    assert!(matches!(code, None | Some(130)), "{code:?}");
}
