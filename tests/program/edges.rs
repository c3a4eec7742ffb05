//! Edges of a mesh that are brushed without teaching, and a face of one that is polished: `truecut
//! path` of a scenario.

use std::path::Path;

use super::path::{hp20, told};
use super::{BAD_INPUT, Desk};

/// The shipped scenario in the desk's folder, its bore alone, with a cell of its own.
fn bore(desk: &Desk, cell: &str) -> &'static str {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().unwrap();
    let shipped = root.join("scenarios/finishing/flange_edges.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    let text = text.replace("../..", root.to_str().unwrap());
    let (text, _) = text
        .split_once("[[process.brush.edge]]        # a pocket")
        .unwrap();
    let named = "flange_cell.toml";
    assert!(text.contains(named));
    std::fs::write(desk.path("bore.toml"), text.replace(named, "cell.toml")).unwrap();
    std::fs::write(desk.path("cell.toml"), cell).unwrap();
    "bore.toml"
}

const TABLE: &str =
    "[[fixture]]\nname = \"table\"\nshape = { box_mm = [500, 400, 40] }\nxyz_mm = [1200, 0, 375]\n";

#[test]
fn a_rim_becomes_a_program_that_reads_back() {
    let desk = Desk::new();
    let file = bore(&desk, TABLE);
    let dialect = ["--dialect", "jbi", "--option", "date=2026-01-31 12:00"];
    let output = desk.truecut(&[&["path", file, "--name", "BORE"][..], &dialect].concat());
    assert!(output.status.success(), "{}", told(&output));
    // The brush works on the part, and comes to it from its lift of 15 mm.
    let nearest = " mm  ✓ least, of \"brush\" from \"part\"";
    for wanted in [nearest, "edge 1", "157 mm of edge"] {
        assert!(
            told(&output).contains(wanted),
            "{wanted}: {}",
            told(&output)
        );
    }
    let points = std::fs::read_to_string(desk.path("out/bore/path.csv")).unwrap();
    assert!(points.starts_with("point,edge,"), "{points}");
    let robot = hp20();
    let read = [
        "program",
        "out/bore/BORE.JBI",
        "--robot",
        &robot,
        "--path",
        "out/bore/path.csv",
    ];
    let output = desk.truecut(&read);
    assert!(output.status.success(), "{}", told(&output));
}

#[test]
fn a_part_beside_the_scenarios_own_and_arguments_of_what_it_says_are_refused() {
    let desk = Desk::new();
    let part = "[part]\nshape = { box_mm = [20, 20, 20] }\nxyz_mm = [1300, 300, 400]\n";
    let file = bore(&desk, &format!("{TABLE}{part}"));
    for (command, whose) in [
        ("path", "the scenario gives"),
        ("run", "process.brush has its own"),
    ] {
        let output = desk.truecut(&[command, file]);
        assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
        let wanted = format!("`part` has no effect: {whose}");
        assert!(told(&output).contains(&wanted), "{}", told(&output));
    }
    for given in [["--spin-deg", "10"], ["--posture-deg", "0,0,0,0,90,0"]] {
        let output = desk.truecut(&[&["path", file][..], &given].concat());
        assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
        assert!(
            told(&output).contains("stand in its scenario"),
            "{}",
            told(&output)
        );
    }
}

/// A post within the bore: the brush meets it, in the run as in the program.
#[test]
fn what_stands_in_the_bore_is_met_and_no_program_is_written() {
    let desk = Desk::new();
    let post = "[[fixture]]\nname = \"post\"\nshape = { radius_mm = 4, length_mm = 80 }\nxyz_mm = [1200, 10, 440]\n";
    let file = bore(&desk, post);
    let output = desk.truecut(&["path", file]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let told_all = told(&output);
    let met = "\"brush\" collides with \"post\"";
    assert!(
        told_all.contains(met) && told_all.contains("no program is written"),
        "{told_all}"
    );
}

/// The shipped cover in the desk's folder, its lines far apart.
fn cover(desk: &Desk, changes: &[(&str, &str)]) -> &'static str {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().unwrap();
    let shipped = root.join("scenarios/finishing/cover_polish.toml");
    let mut text = std::fs::read_to_string(shipped).unwrap();
    let cell = format!("{}/scenarios/finishing/cover_cell.toml", root.display());
    let all = [
        ("../..", root.to_str().unwrap()),
        ("cover_cell.toml", cell.as_str()),
        ("line_spacing_mm = 4", "line_spacing_mm = 12"),
    ];
    for (from, to) in all.iter().chain(changes) {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(desk.path("cover.toml"), text).unwrap();
    "cover.toml"
}

#[test]
fn a_face_with_a_hole_becomes_a_program_that_reads_back_and_is_polished() {
    let desk = Desk::new();
    let file = cover(&desk, &[]);
    let dialect = ["--dialect", "jbi", "--option", "date=2026-01-31 12:00"];
    let output = desk.truecut(&[&["path", file, "--name", "COVER"][..], &dialect].concat());
    assert!(output.status.success(), "{}", told(&output));
    // Seven lines, one of which the hole cuts.
    for wanted in ["clearance", "8 pieces of lines", "relative radii"] {
        let told = told(&output);
        assert!(told.contains(wanted), "{wanted}: {told}");
    }
    let points = std::fs::read_to_string(desk.path("out/cover/path.csv")).unwrap();
    assert!(points.starts_with("point,line,"), "{points}");
    let robot = hp20();
    let program = ["program", "out/cover/COVER.JBI", "--robot", &robot];
    let table = ["--path", "out/cover/path.csv"];
    let output = desk.truecut(&[&program[..], &table].concat());
    assert!(output.status.success(), "{}", told(&output));

    let run = ["run", file, "--set", "run.duration_s=3"];
    let output = desk.truecut(&run);
    let told = told(&output);
    assert!(told.contains("surface_polish.mean_force"), "{told}");
    assert!(desk.path("out/cover/recording.parquet").is_file());
    assert!(desk.path("out/cover/recording.rrd").is_file(), "{told}");
}
