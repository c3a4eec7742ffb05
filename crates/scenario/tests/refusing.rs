//! Every fault in a scenario gives an error with the place, the value and the rule.

use std::path::Path;

use truecut_scenario::{Problem, Scenario};

const TEXT: &str = include_str!("chamfer_d.toml");

fn problems(text: &str, set: &[(&str, &str)]) -> Vec<Problem> {
    let owned: Vec<(String, String)> = set
        .iter()
        .map(|(key, value)| ((*key).into(), (*value).into()))
        .collect();
    match Scenario::from_str(Path::new("d.toml"), text, &owned) {
        Ok(_) => panic!("accepted: {text}"),
        Err(error) => error.problems().cloned().collect(),
    }
}

/// The only problem of the text in which `from`, which stands alone on its line, is replaced by
/// `to`. It must be reported on the line of `to`.
fn fault(from: &str, to: &str) -> String {
    let text = TEXT.replacen(from, to, 1);
    assert_ne!(text, TEXT, "\"{from}\" is not in the scenario");
    let problems = problems(&text, &[]);
    let [problem] = &problems[..] else {
        panic!("{problems:?}")
    };
    let line = text
        .lines()
        .position(|line| line == to)
        .map(|index| index + 1);
    assert_eq!(problem.line(), line, "{problem}");
    problem.message.clone()
}

#[test]
fn values_out_of_range_quote_value_limit_and_rule() {
    assert_eq!(
        fault("half_angle_deg = 45", "half_angle_deg = 90"),
        "`process.chamfer.half_angle_deg` is 90, but must be less than 90: at 0 the edge is parallel to the \
         spindle, at 90 it is across it"
    );
    assert_eq!(
        fault("depth_mm = 1.0", "depth_mm = 0"),
        "`process.chamfer.depth_mm` is 0, but must be greater than 0: a chamfer has a depth, no more than a \
         metre"
    );
    for (from, to, limit) in [
        (
            "spindle_rpm = 300",
            "spindle_rpm = -300",
            "must be greater than 0",
        ),
        (
            "feed_mm_per_rev = 0.05",
            "feed_mm_per_rev = 0.0",
            "must be greater than 0",
        ),
        (
            "pressure_mpa = 0.45",
            "pressure_mpa = -0.1",
            "must be at least 0",
        ),
        ("mu = 0.15", "mu = -0.15", "must be at least 0"),
        (
            "time_step_ms = 0.25",
            "time_step_ms = -0.25",
            "must be greater than 0",
        ),
        (
            "inertia_scale = 0.82",
            "inertia_scale = 0",
            "must be greater than 0",
        ),
    ] {
        let message = fault(from, to);
        assert!(message.contains(limit), "{to}: {message}");
    }
    let set = |key: &str, value: &str| problems(TEXT, &[(key, value)])[0].message.clone();
    assert!(set("process.chamfer.edges", "0").contains("is 0, but must be at least 1"));
    assert!(set("process.chamfer.foot.axial_share", "1").contains("must be less than 1"));
}

#[test]
fn numbers_must_be_finite() {
    for bad in ["nan", "inf", "-inf"] {
        let message = fault("depth_mm = 1.0", &format!("depth_mm = {bad}"));
        assert!(message.contains("must be a finite number"), "{message}");
    }
    assert!(fault("depth_mm = 1.0", "depth_mm = 1e300").contains("must be at most 1e18"));
}

#[test]
fn an_unknown_key_names_the_nearest() {
    assert_eq!(
        fault("time_step_ms = 0.25", "time_stp_ms = 0.25"),
        "unknown key `time_stp_ms` in [run]; did you mean `time_step_ms`?"
    );
}

#[test]
fn a_key_without_its_unit_names_the_unit_key() {
    assert_eq!(
        fault("pressure_mpa = 0.45", "pressure = 0.45"),
        "unknown key `pressure` in [process.chamfer.foot]: the unit key is missing, write `pressure_mpa`"
    );
    assert!(fault("depth_mm = 1.0", "depth_um = 1000").contains("write `depth_mm`"));
}

#[test]
fn a_wrong_type_says_what_is_wanted() {
    for (from, to, text) in [
        (
            "spindle_rpm = 300",
            "spindle_rpm = \"300\"",
            "must be a number, but is the text \"300\"",
        ),
        (
            "inertia_scale = 0.82",
            "inertia_scale = true",
            "must be a number, but is true",
        ),
        (
            "urdf = \"robots/arm.urdf\"",
            "urdf = 5",
            "must be a text in quotes, but is the integer 5",
        ),
        (
            "unit = \"mm\"",
            "unit = 1979-05-27",
            "must be a text in quotes, but is the date",
        ),
        (
            "direction = \"backward\"",
            "direction = \"sideways\"",
            "one of \"forward\", \"backward\"",
        ),
        (
            "depth_mm = 1.0",
            "depth_mm = [1.0]",
            "must be a number, but is a list",
        ),
        (
            "name = \"even width\"",
            "name = \"\"",
            "`claim.1.name` is empty",
        ),
    ] {
        let message = fault(from, to);
        assert!(message.contains(text), "{to}: {message}");
    }
}

#[test]
fn a_missing_key_is_reported_at_its_table() {
    let text = TEXT.replace("depth_mm = 1.0\n", "");
    let problem = &problems(&text, &[])[0];
    assert_eq!(
        problem.message,
        "missing key `depth_mm` in [process.chamfer]"
    );
    assert_eq!(
        problem.line(),
        text.lines()
            .position(|l| l == "[process.chamfer]")
            .map(|i| i + 1)
    );
    let text = TEXT.replace("pressure_mpa = 0.45\n", "");
    assert_eq!(
        problems(&text, &[])[0].message,
        "missing key `pressure_mpa` in [process.chamfer.foot]"
    );
}

#[test]
fn a_parameter_that_the_law_ignores_is_refused() {
    let message = fault("mu = 0.15", "mu_static = 0.18");
    assert!(
        message.contains("has no effect: law = \"coulomb\" has one coefficient, mu"),
        "{message}"
    );
    let law = "process.chamfer.foot.friction.law";
    let message = &problems(TEXT, &[(law, "none")])[0];
    assert!(
        message
            .message
            .contains("with law = \"none\" there is no friction"),
        "{message}"
    );
    assert_eq!(message.line(), Some(31));
    let share = [
        ("process.chamfer.foot.axial_share", "0.1"),
        ("process.chamfer.foot.gas_length_mm", "60"),
    ];
    assert!(
        problems(TEXT, &share)[0]
            .message
            .contains("axial_share replaces the gas spring")
    );
    let length = [
        ("run.duration_s", "4"),
        ("process.chamfer.dwell_revolutions", "1"),
    ];
    assert!(
        problems(TEXT, &length)[0]
            .message
            .contains("already says when the run ends")
    );
    let free = [("robot.drive", "force"), ("robot.stiffness_scale", "2")];
    assert!(
        problems(TEXT, &free)[0]
            .message
            .contains("the joints are free")
    );
    assert!(
        problems(TEXT, &[("claim.0.band_hz", "[1, 2]")])[0]
            .message
            .contains("have a band")
    );
}

#[test]
fn friction_must_fall_with_speed() {
    let stribeck = [
        ("process.chamfer.foot.friction.law", "stribeck"),
        ("process.chamfer.foot.friction.mu_static", "0.1"),
        ("process.chamfer.foot.friction.stribeck_speed_mm_per_s", "1"),
    ];
    assert!(
        problems(TEXT, &stribeck)[0]
            .message
            .contains("is 0.1, but must be at least mu = 0.15")
    );
    let missing = problems(TEXT, &stribeck[..1]);
    let messages: Vec<&str> = missing.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(
        messages[0].contains("law = \"stribeck\" needs it"),
        "{messages:?}"
    );
}

#[test]
fn there_is_exactly_one_process() {
    let text = format!("{TEXT}\n[process.load]\nconstant_n = [0, 0, 1]\n");
    let problem = &problems(&text, &[])[0];
    assert!(
        problem.message.starts_with("2 processes (chamfer, load)"),
        "{problem}"
    );
    let head = TEXT.split("[process.chamfer]").next().unwrap();
    assert_eq!(
        problems(head, &[])[0].message,
        "missing key `process` in the file"
    );
    let empty = format!("{head}[process]\n");
    assert!(problems(&empty, &[])[0].message.starts_with("no process"));
    let endless = format!("{head}[process.load]\n");
    assert!(
        problems(&endless, &[])[0]
            .message
            .contains("missing key `duration_s` in [run]")
    );
}

#[test]
fn claims_need_bounds_units_and_a_metric() {
    assert!(fault("unit = \"ms\"", "unit = \"furlong\"").contains("unknown unit \"furlong\""));
    let without = |line: &str| {
        problems(&TEXT.replacen(line, "", 1), &[])[0]
            .message
            .clone()
    };
    assert!(without("max = 3\n").contains("a claim needs `min`, `max` or both"));
    assert!(without("unit = \"ms\"\n").contains("missing key `unit` in [claim.0]"));
    assert!(without("channel = \"foot.sliding\"\n").contains("missing key `channel`"));
    assert!(without("threshold = 0.5\n").contains("missing key `threshold`"));
    assert!(without("scalar = \"chamfer.width_spread\"\n").contains("bounds nothing"));
    let itself = TEXT.replacen("max = 3", "relative_to = {}\nmax = 3", 1);
    assert!(
        problems(&itself, &[])[0]
            .message
            .contains("is this very run")
    );
    let bounds = [("claim.0.min", "4")];
    assert!(
        problems(TEXT, &bounds)[0]
            .message
            .contains("is 3, but must be at least min = 4")
    );
    let window = [("claim.0.from_s", "2"), ("claim.0.to_s", "1")];
    assert!(
        problems(TEXT, &window)[0]
            .message
            .contains("must be greater than from_s = 2")
    );
}

/// A sweep tabulates something.
const COLUMN: &str =
    "[[sweep.column]]\nname = \"width\"\nscalar = \"chamfer.width_mean\"\nunit = \"mm\"\n";

#[test]
fn sweeps_need_known_numeric_keys_and_rising_ends() {
    let head = TEXT.split("[[claim]]").next().unwrap();
    let sweep = |axis: &str| {
        let text = format!("{head}\n[[sweep.axis]]\n{axis}\n{COLUMN}");
        problems(&text, &[])[0].message.clone()
    };
    let near = sweep("key = \"process.chamfer.foot.presure_mpa\"\nvalues = [1]");
    assert!(near.contains("did you mean `pressure_mpa`?"), "{near}");
    assert!(sweep("key = \"process.chamfer.direction\"\nvalues = [1]").contains("is not a number"));
    assert!(
        sweep("key = \"claim.0.max\"\nvalues = [1]")
            .contains("below robot, run, process or effect")
    );
    let depth = "key = \"process.chamfer.depth_mm\"";
    assert!(sweep(&format!("{depth}\nfrom = 2\nto = 1\nsteps = 3")).contains("greater than from"));
    assert!(sweep(&format!("{depth}\nfrom = 1\nto = 2")).contains("missing key `steps`"));
    let twice = format!("{depth}\nvalues = [1]\n[[sweep.axis]]\n{depth}\nvalues = [2]");
    assert!(sweep(&twice).contains("swept already"));
    let beside = problems(
        &format!("{TEXT}\n[[sweep.axis]]\n{depth}\nvalues = [1]\n{COLUMN}"),
        &[],
    );
    assert!(
        beside[0].message.contains("its claims are [[sweep.claim]]"),
        "{beside:?}"
    );
}

#[test]
fn overrides_are_checked_like_the_file() {
    let set = |key: &str, value: &str| problems(TEXT, &[(key, value)]).remove(0);
    let unknown = set("process.chamfer.foot.presure_mpa", "0.3");
    assert!(
        unknown.message.contains("did you mean `pressure_mpa`?"),
        "{unknown}"
    );
    assert!(unknown.message.ends_with("(given by --set)"), "{unknown}");
    assert_eq!(unknown.line(), None);
    let negative = set("process.chamfer.foot.pressure_mpa", "-1");
    assert!(
        negative.message.contains("is -1, but must be at least 0"),
        "{negative}"
    );
    assert!(negative.message.ends_with("(given by --set)"), "{negative}");
    assert!(
        set("claim.7.max", "1")
            .message
            .contains("`claim` has no entry 7: it has 2")
    );
    assert!(
        set("robot.posture_deg.x", "1")
            .message
            .contains("no entry x")
    );
    assert!(
        set("process.chamfer.foot", "1")
            .message
            .contains("is a table, not a value")
    );
    assert!(set("", "1").message.contains("is a table"));
    assert!(
        set("process.chamfer.depth_mm.deep", "1")
            .message
            .contains("unknown key `deep`")
    );
    assert!(
        set("process.chamfer.depth_mm", "deep")
            .message
            .contains("but is the text \"deep\"")
    );
}

#[test]
fn an_error_about_a_list_mentions_the_entries_that_were_set() {
    let set = [("robot.posture_deg.0".to_owned(), "500".to_owned())];
    let scenario = Scenario::from_str(Path::new("d.toml"), TEXT, &set).unwrap();
    let error = scenario.problem("robot.posture_deg", "joint 1 is outside its limits");
    let problem = error.problems().next().unwrap();
    assert_eq!(
        problem.message,
        "joint 1 is outside its limits (partly given by --set robot.posture_deg.0=500)"
    );
    assert_eq!(problem.line(), Some(6));
}

#[test]
fn several_problems_are_reported_together_in_the_order_of_the_file() {
    let text = TEXT
        .replace("depth_mm = 1.0", "depth_mm = -1.0")
        .replace("inertia_scale = 0.82", "inertia_scale = -1");
    let problems = problems(&text, &[]);
    let lines: Vec<Option<usize>> = problems.iter().map(Problem::line).collect();
    assert_eq!(lines, [Some(7), Some(17)]);
}

#[test]
fn intervals_fit_into_the_run_and_rows_into_memory() {
    let long_step = problems(TEXT, &[("run.time_step_ms", "5000")]);
    assert!(
        long_step[0].message.contains("must fit into the run"),
        "{long_step:?}"
    );
    assert!(
        fault("record_interval_ms = 1.0", "record_interval_ms = 0.1")
            .contains("must be at least the time step of 0.25 ms")
    );
    let long = problems(TEXT, &[("run.duration_s", "1e9")]);
    assert!(
        long[0].message.contains("must be at most 3600 s"),
        "{long:?}"
    );
    let slow = problems(TEXT, &[("process.chamfer.feed_mm_per_rev", "1e-9")]);
    let slow: Vec<String> = slow.iter().map(ToString::to_string).collect();
    assert!(
        slow.iter()
            .any(|one| one.contains("the time that the process takes")),
        "{slow:?}"
    );
    let shallow = problems(TEXT, &[("process.chamfer.depth_mm", "0.04")]);
    assert!(
        shallow[0]
            .message
            .contains("must be greater than the feed per tooth of 0.05 mm"),
        "{shallow:?}"
    );
    let dense = [
        ("run.time_step_ms", "1e-6"),
        ("run.record_interval_ms", "1e-6"),
    ];
    assert!(
        problems(TEXT, &dense)[0]
            .message
            .contains("a recording has at most 2e7")
    );
}

#[test]
fn broken_toml_names_the_line() {
    let problem = &problems("name = \"x\"\n[robot\nurdf = 1\n", &[])[0];
    assert!(problem.message.starts_with("not valid TOML"), "{problem}");
    assert_eq!(problem.line(), Some(2));
    let twice = &problems("name = \"x\"\nname = \"y\"\n", &[])[0];
    assert_eq!(twice.line(), Some(2), "{twice}");
}

#[test]
fn an_unreadable_file_is_named() {
    let error = Scenario::load(Path::new("no/such.toml"), &[]).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("cannot read scenario no/such.toml"),
        "{error}"
    );
}

/// Whatever a text says, reading it ends in a value or an error.
#[test]
fn mangled_texts_never_panic() {
    let mut accepted = 0;
    for (index, _) in TEXT.char_indices() {
        let cut = &TEXT[..index];
        accepted += usize::from(Scenario::from_str(Path::new("d.toml"), cut, &[]).is_ok());
        let without = format!("{}{}", &TEXT[..index], &TEXT[index + 1..]);
        accepted += usize::from(Scenario::from_str(Path::new("d.toml"), &without, &[]).is_ok());
    }
    assert!(accepted > 0 && accepted < 2 * TEXT.len(), "{accepted}");
}
