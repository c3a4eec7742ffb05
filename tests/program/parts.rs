//! Sweeps made in parts, and sweeps whose rows are drawn.

use std::path::Path;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::{BAD_INPUT, CLAIM_FAILED, Desk, LONG, sweep};

/// A sweep of nine rows.
fn swept(desk: &Desk, name: &str) {
    let axis = sweep(
        "process.load.release_n.0",
        "10, 20, 30, 40, 50, 60, 70, 80, 90",
    );
    desk.scenario(name, "duration_s = 0.1", &axis);
}

fn file(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

/// Makes rows of `swept.toml` as a part.
fn part(desk: &Desk, rows: &str, name: &str) -> String {
    desk.ends(0, &["sweep", "swept.toml", "--rows", rows, "-o", name])
}

#[test]
fn parts_in_any_cut_and_order_give_the_files_of_one_call() {
    let desk = Desk::new();
    swept(&desk, "swept");
    desk.ends(0, &["run", "swept.toml", "--out", "whole"]);
    let mut draw = ChaCha8Rng::seed_from_u64(27);
    for trial in 0..4 {
        let mut cuts: Vec<usize> = (1..9).filter(|_| draw.next_u32() % 3 == 0).collect();
        cuts.push(9);
        let (mut from, mut names) = (0, Vec::new());
        for to in cuts {
            let name = format!("parts/{trial}_{from}.jsonl");
            part(&desk, &format!("{from}..{to}"), &name);
            names.insert(draw.next_u32() as usize % (names.len() + 1), name);
            from = to;
        }
        // One that lies within others changes nothing.
        let within = format!("parts/{trial}_within.jsonl");
        part(&desk, "2..5", &within);
        names.push(within);
        let mut call = vec!["sweep", "swept.toml", "--out", "merged", "--merge"];
        call.extend(names.iter().map(String::as_str));
        desk.ends(0, &call);
        for name in ["sweep.parquet", "sweep.csv", "sweep.svg", "sweep.html"] {
            let (one, other) = (
                format!("whole/swept/{name}"),
                format!("merged/swept/{name}"),
            );
            assert!(
                file(&desk.path(&one)) == file(&desk.path(&other)),
                "{name}, {names:?}"
            );
        }
    }
}

#[test]
fn a_part_that_is_there_is_not_made_again() {
    let desk = Desk::new();
    swept(&desk, "swept");
    assert!(part(&desk, "3..5", "a.jsonl").contains("rows 3..5 of 9"));
    let made = desk.path("a.jsonl").metadata().unwrap().modified().unwrap();
    assert!(part(&desk, "3..5", "a.jsonl").contains("has rows 3..5 already"));
    assert_eq!(
        desk.path("a.jsonl").metadata().unwrap().modified().unwrap(),
        made
    );
    // Other rows, or a part that lost its end, are.
    let text = std::fs::read_to_string(desk.path("a.jsonl")).unwrap();
    std::fs::write(desk.path("a.jsonl"), &text[..text.len() - 20]).unwrap();
    assert!(part(&desk, "3..5", "a.jsonl").contains("rows 3..5 of 9"));
    assert_eq!(std::fs::read_to_string(desk.path("a.jsonl")).unwrap(), text);
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let desk = Desk::new();
    swept(&desk, "swept");
    swept(&desk, "other");
    part(&desk, "0..5", "a.jsonl");
    let merge = |parts: &[&str], said: &[&str]| {
        let call = [&["sweep", "swept.toml", "--merge"], parts].concat();
        desk.refused(&call, said);
        assert!(!desk.path("out/swept/sweep.parquet").exists());
    };
    merge(
        &["a.jsonl"],
        &["4 of 9 rows are in no part: 5..9", "--rows A..B"],
    );
    merge(&["missing.jsonl"], &["missing.jsonl"]);
    std::fs::write(desk.path("notes.txt"), "of mine\n").unwrap();
    merge(
        &["a.jsonl", "notes.txt"],
        &["notes.txt: is no part of a sweep"],
    );
    let further = |scenario: &str, rest: &[&str], name: &str| {
        let call = ["sweep", scenario, "--rows", "5..9", "-o", name];
        desk.ends(0, &[&call, rest].concat());
    };
    further("other.toml", &[], "b.jsonl");
    merge(
        &["a.jsonl", "b.jsonl"],
        &["b.jsonl: is a part of the sweep \"Rig other\", not of \"Rig swept\""],
    );
    for (rest, name) in [
        (&["--set", "run.duration_s=0.2"][..], "c.jsonl"),
        (&["--engine", "reduced"], "d.jsonl"),
    ] {
        further("swept.toml", rest, name);
        merge(&["a.jsonl", name], &[name, "make the part again"]);
    }
    // A row that differs between parts.
    part(&desk, "4..9", "e.jsonl");
    let text = std::fs::read_to_string(desk.path("e.jsonl")).unwrap();
    let line = text.lines().nth(1).unwrap();
    let other = line.replacen("\"50\"", "\"51\"", 1);
    assert_ne!(other, line);
    std::fs::write(desk.path("e.jsonl"), text.replace(line, &other)).unwrap();
    merge(
        &["a.jsonl", "e.jsonl"],
        &["e.jsonl: row 4 is not the same as in a.jsonl"],
    );
    // What is no part is not written over.
    let call = ["sweep", "swept.toml", "--rows", "0..2", "-o", "notes.txt"];
    desk.refused(&call, &["notes.txt: is no part of a sweep"]);
    assert_eq!(file(&desk.path("notes.txt")), b"of mine\n");
    let call = ["sweep", "swept.toml", "--rows", "0..2", "-o", "swept.toml"];
    desk.refused(&call, &["swept.toml"]);
}

#[test]
fn rows_and_options_that_make_no_sense_are_refused() {
    let desk = Desk::new();
    swept(&desk, "swept");
    desk.scenario("single", "duration_s = 0.1", "");
    for (call, said) in [
        (
            &["swept.toml", "--rows", "7..12", "-o", "a"][..],
            "rows 7..12 are asked for, but the sweep has 9: 0..9",
        ),
        (
            &["swept.toml", "--rows", "5..5", "-o", "a"],
            "whole numbers A below B",
        ),
        (
            &["swept.toml", "--rows", "3", "-o", "a"],
            "whole numbers A below B",
        ),
        (&["swept.toml", "--rows", "0..3"], "--part"),
        (&["single.toml"], "there is no [sweep] table"),
        (&["none.toml"], "none.toml"),
        (
            &["swept.toml", "--retries", "2"],
            "--retries has no effect without --workers-on hyperqueue",
        ),
        (&["swept.toml", "--limit-s", "2"], "--limit-s has no effect"),
        (
            &[
                "swept.toml",
                "--workers-on",
                "hyperqueue",
                "--rows",
                "0..3",
                "-o",
                "a",
            ],
            "cannot be used with",
        ),
    ] {
        desk.refused(&[&["sweep"], call].concat(), &[said]);
        assert!(!desk.path("a").exists());
    }
}

#[test]
fn a_part_that_takes_too_long_is_none() {
    let desk = Desk::new();
    let axis = sweep("process.load.release_n.0", "10, 20");
    desk.scenario("swept", LONG, &axis);
    let call = [
        "sweep",
        "swept.toml",
        "--rows",
        "0..2",
        "-o",
        "a",
        "--limit-s",
        "0.2",
    ];
    desk.refused(
        &call,
        &["rows 0..2 took longer than --limit-s 0.2: no part was written"],
    );
    assert!(!desk.path("a").exists());
}

/// A rig whose stiffness and load are drawn.
fn drawn(desk: &Desk, method: &str, seed: u32, share: &str) {
    let rest = format!(
        "[[uncertain]]\nkey = \"process.load.release_n.0\"\nrelative = 0.1\n\
         [sweep.sample]\nmethod = \"{method}\"\ncount = 64\nseed = {seed}\nuncertain = true\n\
         [[sweep.axis]]\nkey = \"process.load.release_n.1\"\nfrom = -20\nto = 20\n\
         [[sweep.axis]]\nkey = \"process.load.release_n.2\"\nvalues = [0, 10, 20]\n\
         [[sweep.axis]]\nkey = \"run.duration_s\"\nfrom = 0.05\nto = 0.2\nspacing = \"log\"\n\
         [[sweep.column]]\nname = \"swing\"\nmetric = \"peak\"\n\
         channel = \"tool.displacement_x\"\nunit = \"um\"\n\
         [[sweep.claim]]\nname = \"swings\"\ncolumn = \"swing\"\nmin = 0\n{share}\nreason = \"it is let go\"\n"
    );
    desk.scenario("drawn", "duration_s = 0.1", &rest);
}

/// The columns of a sweep's text, without its head.
fn columns(desk: &Desk) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(desk.path("out/drawn/sweep.csv")).unwrap();
    let rows = text.lines().skip(1).map(|line| line.split(','));
    let rows: Vec<Vec<String>> = rows.map(|row| row.map(str::to_owned).collect()).collect();
    let column = |index: usize| rows.iter().map(|row| row[index].clone()).collect();
    (0..rows[0].len()).map(column).collect()
}

#[test]
fn rows_are_drawn_over_axes_and_what_is_uncertain() {
    let desk = Desk::new();
    let mut seen = Vec::new();
    for (method, seed) in [
        ("random", 1),
        ("latin_hypercube", 1),
        ("sobol", 1),
        ("sobol", 2),
    ] {
        drawn(&desk, method, seed, "");
        let out = desk.ends(0, &["sweep", "drawn.toml", "--engine", "reduced"]);
        assert!(out.contains("64 of 64") && out.contains("median"), "{out}");
        let found = columns(&desk);
        let numbers = |index: usize| -> Vec<f64> {
            found[index]
                .iter()
                .map(|text| text.parse().unwrap())
                .collect()
        };
        let within = |index: usize, low: f64, high: f64| {
            assert!(
                numbers(index).iter().all(|x| (low..=high).contains(x)),
                "{method} {index}"
            );
        };
        within(0, -20.0, 20.0);
        assert!(
            found[1]
                .iter()
                .all(|text| ["0", "10", "20"].contains(&text.as_str()))
        );
        within(2, 0.05, 0.2);
        // Three standard deviations of ten per cent about 100.
        within(3, 70.0, 130.0);
        let mean = numbers(3).iter().sum::<f64>() / 64.0;
        assert!(
            (mean - 100.0).abs() < if method == "random" { 5.0 } else { 0.7 },
            "{mean}"
        );
        assert!(!seen.contains(&found), "{method} {seed} draws other rows");
        // The same seed draws the same rows, in parts as well.
        let reduced = |rest: &[&str]| {
            let call = ["sweep", "drawn.toml", "--engine", "reduced"];
            desk.ends(0, &[&call, rest].concat());
        };
        reduced(&["--rows", "20..64", "-o", "b"]);
        reduced(&["--rows", "0..20", "-o", "a"]);
        reduced(&["--merge", "b", "a"]);
        assert_eq!(columns(&desk), found);
        for name in ["a", "b"] {
            std::fs::remove_file(desk.path(name)).unwrap();
        }
        seen.push(found);
    }
}

#[test]
fn a_claim_may_ask_for_a_share_of_the_rows() {
    let desk = Desk::new();
    drawn(&desk, "sobol", 5, "");
    desk.ends(0, &["sweep", "drawn.toml", "--engine", "reduced"]);
    let mut swings: Vec<f64> = columns(&desk)[4]
        .iter()
        .map(|text| text.parse().unwrap())
        .collect();
    swings.sort_by(f64::total_cmp);
    // 48 of 64 rows lie at or above the 17th.
    let least = swings[16];
    for (share, code) in [("0.75", 0), ("0.76", CLAIM_FAILED), ("1", CLAIM_FAILED)] {
        drawn(&desk, "sobol", 5, &format!("share = {share}"));
        let text = std::fs::read_to_string(desk.path("drawn.toml")).unwrap();
        std::fs::write(
            desk.path("drawn.toml"),
            text.replace("min = 0\n", &format!("min = {least}\n")),
        )
        .unwrap();
        let out = desk.ends(code, &["sweep", "drawn.toml", "--engine", "reduced"]);
        assert!(out.contains("48 of 64 rows at least"), "{out}");
    }
    // It is a share, not a number of rows.
    drawn(&desk, "sobol", 5, "share = 0");
    desk.ends(BAD_INPUT, &["sweep", "drawn.toml"]);
}
