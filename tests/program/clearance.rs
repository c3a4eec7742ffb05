//! Cells: what `truecut path` and `truecut program` tell of clearances.

use std::path::Path;

use super::path::{hp20, told};
use super::{BAD_INPUT, CLAIM_FAILED, Desk};

/// The shipped job of the crowned block in the desk's folder, with a cell of its own.
fn job(desk: &Desk, cell: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().unwrap();
    let shipped = root.join("scenarios/finishing/crowned_block.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    let text = text.replace("../..", root.to_str().unwrap());
    let named = "crowned_block_cell.toml";
    assert!(text.contains(named));
    std::fs::write(desk.path("job.toml"), text.replace(named, "cell.toml")).unwrap();
    write(desk, cell);
    "job.toml".to_owned()
}

fn write(desk: &Desk, cell: &str) {
    std::fs::write(desk.path("cell.toml"), cell).unwrap();
}

/// A post beside the block's end, so high that the wheel meets it where it leaves a line.
const POST: &str = "[[fixture]]\nname = \"post\"\nshape = { radius_mm = 8, length_mm = 60 }\nxyz_mm = [1125, 0, 430]\n";

#[test]
fn a_job_that_collides_is_told_with_pair_and_place_and_gets_no_program() {
    let desk = Desk::new();
    let file = job(&desk, POST);
    let output = desk.truecut(&["path", &file]);
    assert_eq!(
        output.status.code(),
        Some(CLAIM_FAILED),
        "{}",
        told(&output)
    );
    for wanted in [
        "✗ \"wheel\" collides with \"post\"",
        "(segment ",
        "no program is written",
    ] {
        assert!(
            told(&output).contains(wanted),
            "{wanted}: {}",
            told(&output)
        );
    }
    assert!(desk.path("out/job/path.rrd").is_file() && desk.path("out/job/path.csv").is_file());
    assert!(!desk.path("out/job/CROWN.JBI").exists());

    // Shorter, it stands clear, but not by as much as is asked.
    let short = POST.replace("60 }", "12 }").replace("430", "406");
    write(&desk, &short);
    let output = desk.truecut(&["path", &file]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(desk.path("out/job/CROWN.JBI").is_file());
    // A path that is refused leaves no earlier program beside it.
    write(&desk, POST);
    let output = desk.truecut(&["path", &file]);
    assert_eq!(output.status.code(), Some(CLAIM_FAILED));
    assert!(!desk.path("out/job/CROWN.JBI").exists());
    write(&desk, &short);
    assert!(desk.truecut(&["path", &file]).status.success());
    write(&desk, &format!("clearance_mm = 25\n{short}"));
    let robot = hp20();
    let program = ["program", "out/job/CROWN.JBI", "--robot", &robot];
    let output = desk.truecut(&[&program[..], &["--cell", "cell.toml"]].concat());
    assert!(
        output.status.success(),
        "the cell holds no wheel: {}",
        told(&output)
    );
    let wheel = "[[carried]]\nname = \"disc\"\nframe = \"tool\"\nrpy_deg = [90, 0, 0]\n\
                 shape = { radius_mm = 40, length_mm = 12 }\n";
    write(&desk, &format!("clearance_mm = 25\n{short}{wheel}"));
    let output = desk.truecut(&[&program[..], &["--cell", "cell.toml"]].concat());
    assert_eq!(
        output.status.code(),
        Some(CLAIM_FAILED),
        "{}",
        told(&output)
    );
    let wanted = "✗ \"disc\" comes within";
    assert!(told(&output).contains(wanted), "{}", told(&output));
    let may_touch = format!(
        "clearance_mm = 25\n{}may_touch = [\"disc\"]\n{wheel}",
        short
    );
    write(&desk, &may_touch);
    let output = desk.truecut(&[&program[..], &["--cell", "cell.toml"]].concat());
    assert!(output.status.success(), "{}", told(&output));

    write(&desk, "[part]\nshape = { box_mm = [10, 10, 10] }\n");
    let output = desk.truecut(&["path", &file]);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{}", told(&output));
    let wanted = "`part` has no effect: the path job gives the part";
    assert!(told(&output).contains(wanted), "{}", told(&output));
}

/// The belt's wheel is at its size in a run, too, and the part of its job stands there. Beside a
/// post the wheel is what comes nearest, and fails a claim. With the post further off that is the
/// spindle, which belongs to the last link and may not touch the part, while the wheel works on it.
#[test]
fn a_run_whose_wheel_comes_near_a_post_fails_the_claim_on_clearance() {
    let desk = Desk::new();
    job(&desk, &POST.replace("[1125, 0, 430]", "[1060, -40, 450]"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().unwrap();
    let shipped = root.join("scenarios/finishing/crowned_block_belt.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    let text = text.replace("../..", root.to_str().unwrap());
    let text = text.replace("crowned_block_cell.toml", "cell.toml");
    let text = text.replace("crowned_block.toml", "job.toml");
    let (head, _) = text.split_once("[[claim]]").unwrap();
    let claim = "[[claim]]\nname = \"clear\"\nscalar = \"cell.clearance\"\nmin = 100\nunit = \"mm\"\nreason = \"asked\"\n";
    std::fs::write(desk.path("belt.toml"), format!("{head}{claim}")).unwrap();
    let nearest = |pair: &str| {
        let run = ["run", "belt.toml", "--no-rrd", "--set", "run.duration_s=1"];
        let output = desk.truecut(&run);
        let told = told(&output);
        assert_eq!(output.status.code(), Some(CLAIM_FAILED), "{told}");
        assert!(told.contains(pair), "{told}");
    };
    nearest("\"wheel\" from \"post\"");
    write(&desk, POST);
    nearest("\"link_6\" from \"part\"");
}

/// A clamp in the way of a rapid traverse is told with the line of the file; the cutter may touch
/// the part where it is fed, and not in rapid traverse.
#[test]
fn a_cutter_that_meets_a_clamp_is_told_with_the_line_of_the_file() {
    let desk = Desk::new();
    let code = "G21 G90 G17\nG0 X0 Y0 Z20\nG1 Z-2 F600\nG1 X40\nG0 Z20\nG0 X0\nM30\n";
    std::fs::write(desk.path("slot.nc"), code).unwrap();
    let robot = hp20();
    let cell = |clamp: &str| {
        let part = "[part]\nshape = { box_mm = [100, 60, 20] }\nxyz_mm = [920, 0, 310]\n";
        let cutter = "[[carried]]\nname = \"cutter\"\nframe = \"tool\"\ncuts = true\n\
                      shape = { radius_mm = 4, length_mm = 30 }\nxyz_mm = [0, 0, -15]\n";
        write(&desk, &format!("{part}{cutter}{clamp}"));
        let place = ["--work-xyz-mm", "900,0,350", "--cell", "cell.toml"];
        desk.truecut(&[&["path", "slot.nc", "--robot", &robot][..], &place].concat())
    };
    let output = cell("");
    assert!(output.status.success(), "{}", told(&output));
    let csv = desk.path("out/slot/path.csv");
    assert!(csv.is_file() && desk.path("out/slot/SLOT.mod").is_file());
    // 30 mm high, it ends 7 mm below the traverse.
    let clamp = |top_mm: f64| {
        format!(
            "[[fixture]]\nname = \"clamp\"\nshape = {{ box_mm = [10, 10, 40] }}\nxyz_mm = [920, 3, {}]\n",
            top_mm - 20.0
        )
    };
    let output = cell(&clamp(380.0));
    assert_eq!(
        output.status.code(),
        Some(CLAIM_FAILED),
        "{}",
        told(&output)
    );
    let wanted = "\"cutter\" collides with \"clamp\", first on the way to line 4, path point 2";
    assert!(told(&output).contains(wanted), "{}", told(&output));
}
