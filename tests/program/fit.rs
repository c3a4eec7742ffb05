//! `truecut fit` as a user meets it: what the data do not show, and what no machine has.

use super::*;

/// The arm of two joints without gravity, of which one stands and one is driven by what a motor
/// that pushes along with the motion would give.
fn desk(second: impl Fn(f64, f64) -> f64) -> Desk {
    let desk = Desk::new();
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/robots/arm_2r/robot.urdf")
        .canonicalize()
        .unwrap();
    let channel = |joint: usize| {
        format!(
            "[[data.channel]]\ncolumn = \"q{joint}\"\nchannel = \"joint{joint}.angle\"\nunit = \"rad\"\nrole = \"input\"\n\
             [[data.channel]]\ncolumn = \"f{joint}\"\nchannel = \"joint{joint}.drive_torque\"\nunit = \"N m\"\n"
        )
    };
    let text = format!(
        "name = \"Stands\"\n[robot]\nurdf = '{}'\ngravity = false\n[process.replay]\nmode = \"inverse\"\n\
         [data]\nfile = \"stands.csv\"\ntime = \"t\"\n{}{}[fit]\nunknowns = [\"viscous\", \"coulomb\", \"offset\"]\n",
        urdf.display(),
        channel(1),
        channel(2)
    );
    std::fs::write(desk.path("stands.toml"), text).unwrap();
    let mut table = "t,q1,q2,f1,f2\n".to_owned();
    for k in 0..4000 {
        let t = f64::from(k) * 0.005;
        let (q, v) = (0.8 * (3.0 * t).sin(), 2.4 * (3.0 * t).cos());
        table += &format!(
            "{t:.3},0.3,{q},{},{}\n",
            1e-3 * f64::from(k % 7),
            second(q, v)
        );
    }
    std::fs::write(desk.path("stands.csv"), table).unwrap();
    desk
}

fn fitted(desk: &Desk) -> (String, serde_json::Value) {
    let told = desk.ends(0, &["fit", "stands.toml", "--out", "fits"]);
    let text = std::fs::read_to_string(desk.path("fits/stands/fit.json")).unwrap();
    (told, serde_json::from_str(&text).unwrap())
}

/// A joint that stands shows no friction: no estimate, and no interval.
#[test]
fn what_no_row_shows_has_no_interval() {
    let (told, fit) = fitted(&desk(|_, v| 3000.0 * v + 400.0 * v.signum()));
    for one in fit["parameters"].as_array().unwrap() {
        let is_first = one["name"].as_str().unwrap().ends_with('1');
        assert_eq!(one["seen"], !is_first, "{one}");
        assert_eq!(one["interval"].is_null(), is_first, "{one}");
        assert!(!is_first || one["value"] == one["nominal"], "{one}");
    }
    assert_eq!(told.matches("not seen in these data").count(), 3, "{told}");
    assert!(!told.contains("0 to 0"), "{told}");
    assert!(!told.contains("doubtful"), "{told}");
}

/// Friction that drives is told, with what it hints at.
#[test]
fn friction_below_nothing_is_told() {
    let (told, fit) = fitted(&desk(|_, v| -3000.0 * v + 400.0 * v.signum()));
    let warnings = fit["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    let warning = warnings[0].as_str().unwrap();
    for words in [
        "`viscous 2` is -",
        "never negative",
        "a delay between motion and drive force",
    ] {
        assert!(warning.contains(words), "{warning}");
    }
    assert!(told.contains(&format!("doubtful: {warning}")), "{told}");
}
