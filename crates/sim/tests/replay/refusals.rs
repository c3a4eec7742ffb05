//! Inputs that do not fit.

use super::*;

fn refusal(scenario: &Scenario, measured: &Measured) -> String {
    let run = Run {
        measured: Some(measured),
        ..Run::of(scenario)
    };
    run.rows(&[], None)
        .expect_err("must be refused")
        .to_string()
}

#[test]
fn inputs_that_do_not_fit_are_refused_with_their_place() {
    let forward = scenario("servo", "forward", "");
    let made = |name: &str, unit, values: Vec<f64>| {
        data(1000.0, 300, vec![(name, unit, Role::Input, values)])
    };
    let text = refusal(
        &forward,
        &made("joint1.command", Unit::Radian, vec![0.0; 300]),
    );
    assert!(
        text.starts_with("`data.channel.0.channel`") && text.contains("must be one of m"),
        "{text}"
    );
    let text = refusal(
        &forward,
        &made("joint1.comand", Unit::Metre, vec![0.0; 300]),
    );
    assert!(text.contains("did you mean \"joint1.command\"?"), "{text}");
    let text = refusal(
        &forward,
        &made("joint1.command", Unit::Metre, vec![2.0; 300]),
    );
    assert!(text.contains("is the column's unit right?"), "{text}");
    let mut gap = made("joint1.command", Unit::Metre, vec![0.0; 300]);
    gap.channels[0].valid[100..140].fill(false);
    let text = refusal(&forward, &gap);
    assert!(
        text.contains("no measurement from 0.100 s to 0.139 s (40 samples)"),
        "{text}"
    );
    let without = Run::of(&forward).rows(&[], None);
    let text = without.expect_err("no data").to_string();
    assert!(text.contains("a replay needs its measured data"), "{text}");
    let longer = [("run.duration_s".to_owned(), "5".to_owned())];
    let longer = forward.with_overrides(&longer).unwrap();
    let text = refusal(
        &longer,
        &made("joint1.command", Unit::Metre, vec![0.0; 300]),
    );
    assert!(
        text.contains("is 5 s, but the data takes 0.2990 s"),
        "{text}"
    );
    let text = refusal(&scenario("servo", "inverse", ""), &gap);
    assert!(text.contains("has no plant to run"), "{text}");
}

#[test]
fn the_robots_of_the_replays_load() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    for name in ["emps", "ur10e"] {
        truecut_arm::Robot::load(&assets.join(name).join("robot.urdf"), None, None)
            .unwrap_or_else(|error| panic!("{error}"));
    }
}
