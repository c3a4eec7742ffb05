//! `truecut compare` as a user meets it.

use super::*;

/// The rig of [`Desk::scenario`] beside a file of its own deflection, and what is done to it.
fn desk(column_unit: &str, law: impl Fn(usize, f64) -> f64) -> Desk {
    let desk = Desk::new();
    let run = "duration_s = 4\nrecord_interval_ms = 2";
    let data = format!(
        "[data]\nfile = \"measured.csv\"\ntime = \"t\"\nresample_hz = 500\n[[data.channel]]\ncolumn = \"x\"\n\
         channel = \"tool.displacement_x\"\nunit = \"{column_unit}\"\n"
    );
    desk.scenario("rig", run, &data);
    // What the run itself records, as a file of measurements.
    desk.scenario("source", run, "");
    desk.ends(0, &["run", "source.toml"]);
    let recording = read_parquet(&desk.path("out/source/recording.parquet")).unwrap();
    let values = recording.channel("tool.displacement_x").unwrap();
    let rows = recording.time_s.iter().zip(values).enumerate();
    let lines = rows.map(|(row, (t, x))| format!("{t},{}\n", law(row, *x)));
    let text: String = std::iter::once("t,x\n".to_owned()).chain(lines).collect();
    std::fs::write(desk.path("measured.csv"), text).unwrap();
    desk
}

/// Uniform noise of ± 10 µm that is the same every time (a 32-bit xorshift of the row).
fn noise_m(row: usize) -> f64 {
    let mut state = (row as u32 + 1).wrapping_mul(2_654_435_769);
    for _ in 0..3 {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
    }
    1e-5 * (2.0 * f64::from(state) / f64::from(u32::MAX) - 1.0)
}

#[test]
fn compare_tells_writes_and_draws() {
    let line = |row: usize| 4e-5 * (std::f64::consts::TAU * 31.0 * row as f64 / 500.0).sin();
    let desk = desk("m", |row, x| x + noise_m(row) + line(row));
    let told = desk.ends(0, &["compare", "rig.toml", "--rpm", "930"]);
    assert!(told.contains("line at 31.0"), "{told}");
    assert!(
        told.contains("2 per revolution: ") && told.contains("the simulation lacks"),
        "{told}"
    );
    let folder = desk.path("out/rig/compare");
    let svg = std::fs::read_to_string(folder.join("tool.displacement_x.svg")).unwrap();
    assert!(
        svg.contains("measured") && svg.contains("2/rev"),
        "the line is marked"
    );
    let json = std::fs::read_to_string(folder.join("compare.json")).unwrap();
    assert!(
        json.contains("\"per_revolution\": 2") && json.contains("\"nrmse\""),
        "{json}"
    );
    // The same again, from a file named on the command line, into another folder.
    std::fs::rename(desk.path("measured.csv"), desk.path("other.csv")).unwrap();
    let again = [
        "compare",
        "rig.toml",
        "--data",
        "other.csv",
        "--out",
        "b",
        "--rpm",
        "930",
    ];
    assert!(desk.ends(0, &again).contains("2 per revolution"));
}

#[test]
fn compare_says_so_if_nothing_is_wrong() {
    let told = desk("m", |row, x| x + noise_m(row)).ends(0, &["compare", "rig.toml"]);
    assert!(told.contains("no pattern in what is left"), "{told}");
}

/// Standard error of a call that must be refused.
fn refused(desk: &Desk, arguments: &[&str]) -> String {
    let output = desk.truecut(arguments);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(
        output.status.code(),
        Some(BAD_INPUT),
        "{arguments:?}\n{text}"
    );
    text
}

/// The columns of two displacements of an arm, each mapped to the other's channel.
#[test]
fn compare_names_columns_that_are_exchanged() {
    let desk = Desk::new();
    let shipped = super::path::repository().join("scenarios/arm/free_decay.toml");
    let shipped = std::fs::read_to_string(shipped).unwrap();
    let text = shipped.split("[[claim]]").next().unwrap();
    let assets = super::path::repository().join("assets");
    let text = text.replace("../../assets", assets.to_str().unwrap());
    let text = text.replace("duration_s = 4.0", "duration_s = 1\nrecord_interval_ms = 2");
    std::fs::write(desk.path("source.toml"), &text).unwrap();
    desk.ends(0, &["run", "source.toml"]);
    let recording = read_parquet(&desk.path("out/source/recording.parquet")).unwrap();
    let [x, y] = ["x", "y"].map(|axis| {
        recording
            .channel(&format!("tool.displacement_{axis}"))
            .unwrap()
    });
    let rows = recording.time_s.iter().zip(x.iter().zip(y)).enumerate();
    let rows = rows.map(|(row, (t, (x, y)))| {
        format!("{t},{},{}\n", x + noise_m(row), y + noise_m(row + 9000))
    });
    let csv: String = std::iter::once("t,first,second\n".to_owned())
        .chain(rows)
        .collect();
    std::fs::write(desk.path("measured.csv"), csv).unwrap();
    let mapped = |[first, second]: [&str; 2]| {
        let channel = |column: &str, axis: &str| {
            format!(
                "[[data.channel]]\ncolumn = \"{column}\"\nchannel = \"tool.displacement_{axis}\"\nunit = \"m\"\n"
            )
        };
        let data = "[data]\nfile = \"measured.csv\"\ntime = \"t\"\nresample_hz = 500\n".to_owned();
        let text = text.clone() + &data + &channel("first", first) + &channel("second", second);
        std::fs::write(desk.path("mapped.toml"), text).unwrap();
    };
    mapped(["x", "y"]);
    desk.ends(0, &["compare", "mapped.toml"]);
    mapped(["y", "x"]);
    let told = refused(&desk, &["compare", "mapped.toml"]);
    for part in [
        "mapped.toml:",
        "\"tool.displacement_x\"",
        "look whether their columns are exchanged",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn compare_refuses_what_cannot_be_compared() {
    // Millimetres said to be metres: the factor is named, at the line that is wrong.
    let desk = desk("m", |row, x| 1e3 * (x + noise_m(row)));
    let told = refused(&desk, &["compare", "rig.toml"]);
    assert!(
        told.contains("multiplied by 0.001") && told.contains("rig.toml:"),
        "{told}"
    );
    assert!(told.contains("unit = \"m\""), "{told}");
    assert!(!desk.path("out/rig").exists(), "nothing is written");

    let told = refused(&desk, &["compare", "source.toml"]);
    assert!(told.contains("there is no [data] table"), "{told}");
    let told = refused(&desk, &["compare", "rig.toml", "--data", "none.csv"]);
    assert!(told.contains("none.csv"), "{told}");
    let told = refused(&desk, &["compare", "rig.toml", "--rpm", "0"]);
    assert!(told.contains("must be a number above 0"), "{told}");

    let text = std::fs::read_to_string(desk.path("rig.toml")).unwrap();
    let write = |text: String| std::fs::write(desk.path("rig.toml"), text).unwrap();
    write(text.replace("tool.displacement_x", "tool.displacment_x"));
    let told = refused(&desk, &["compare", "rig.toml"]);
    assert!(
        told.contains("did you mean \"tool.displacement_x\"?"),
        "{told}"
    );
    write(text.replace("unit = \"m\"", "unit = \"N\""));
    let told = refused(&desk, &["compare", "rig.toml"]);
    assert!(
        told.contains("is measured in N, but simulated in m"),
        "{told}"
    );
    write(text.replace("column = \"x\"", "column = \"y\""));
    assert!(refused(&desk, &["compare", "rig.toml"]).contains("no column \"y\""));
    write(text.replace("duration_s = 4", "duration_s = 1"));
    assert!(refused(&desk, &["compare", "rig.toml"]).contains("it must cover at least half"));
}
