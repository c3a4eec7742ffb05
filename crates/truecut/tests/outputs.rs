//! Files of runs in a folder.

use std::path::Path;
use truecut::{Outputs, Scenario};

/// A folder has one writer: a second run is refused while the first holds it, whatever it would
/// write, and the first one's files stay.
#[test]
fn a_folder_takes_one_run_at_a_time() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenarios/arm/free_decay.toml"
    );
    let scenario = Scenario::load(Path::new(file), &[]).expect("a scenario");
    let out = tempfile::tempdir().expect("a folder");
    let first = Outputs::prepare(out.path(), &scenario, true).expect("nobody else is here");
    let kept = first.path("summary.json");
    std::fs::write(&kept, "{}").expect("written");
    let second = Outputs::prepare(out.path(), &scenario, false);
    let told = second.expect_err("the folder is taken").to_string();
    assert!(told.contains("another run is writing"), "{told}");
    assert!(told.contains("free_decay"), "{told}");
    assert!(kept.is_file());
    drop(first);
    let third = Outputs::prepare(out.path(), &scenario, false).expect("the first has ended");
    // What an earlier run left stays until there is something in its place.
    drop(third);
    assert!(kept.is_file());
}
