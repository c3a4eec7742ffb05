//! The arm in rapier and the linearised arm under the same belt, rows alone.

use super::shared::belt;
use truecut_recording::Outcome;
use truecut_sim::run::{Engine, Run};

/// Down onto the first line and along half of it: force and removal of the reduced arm, whose mass
/// and compliance are renewed on the way, are those of rapier's. What is kept for the end of a run
/// is dropped, channels stay.
#[test]
fn reduced_arm_feels_the_same_belt() {
    let short = [("run.duration_s".to_owned(), "1.2".to_owned())];
    let scenario = belt(&short);
    let run = |engine| {
        let channels = ["belt.normal_force", "belt.removed_volume"];
        let run = Run {
            engine,
            ..Run::of(&scenario)
        };
        let rows = run.rows(&channels, None).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(rows.outcome, Outcome::Completed);
        let [force, volume] = [0, 1].map(|i| rows.columns[i].clone());
        (force[force.len() - 1], volume[volume.len() - 1])
    };
    let full = run(Engine::Rapier);
    let reduced = run(Engine::REDUCED);
    assert!(full.0 > 10.0 && full.1 > 0.0, "{full:?}");
    assert!(
        (reduced.0 / full.0 - 1.0).abs() < 5e-3,
        "{reduced:?} {full:?}"
    );
    assert!(
        (reduced.1 / full.1 - 1.0).abs() < 5e-3,
        "{reduced:?} {full:?}"
    );
}
