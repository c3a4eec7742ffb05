//! Chains that fall freely keep their energy and their momentum about the vertical axis.

use rayon::prelude::*;
use truecut_arm::Robot;
use truecut_recording::{Outcome, Recording};

use super::drawn::draw_falling;
use super::{run, seeds};

/// With each test run.
const CHAINS: u64 = 60;
/// The longest default step.
const STEP_S: f64 = 0.25e-3;

/// What a fall has lost at its end, as parts of what it holds.
struct Lost {
    energy: f64,
    momentum: f64,
}

fn lost(recording: &Recording, robot: &Robot) -> Lost {
    let channel = |name: &str| recording.channel(name).unwrap();
    let (kinetic, potential) = (channel("energy.kinetic"), channel("energy.potential"));
    let total: Vec<f64> = kinetic.iter().zip(potential).map(|(k, p)| k + p).collect();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let drift = largest(&mut total.iter().map(|energy| (energy - total[0]).abs()));
    let rows = recording.time_s.len();
    let joints = |quantity: &str| -> Vec<&[f64]> {
        let one = |number| channel(&format!("joint{number}.{quantity}"));
        (1..=robot.dof()).map(one).collect()
    };
    let (angles, rates) = (joints("angle"), joints("velocity"));
    let (mut about_axis, mut size) = (0.0_f64, 0.0_f64);
    for row in (0..rows).step_by(rows.div_ceil(40)) {
        let at = |columns: &[&[f64]]| -> Vec<f64> { columns.iter().map(|it| it[row]).collect() };
        let (q, v) = (at(&angles), at(&rates));
        let mass = robot.mass_matrix(&q);
        let parts = v.iter().enumerate().map(|(joint, v)| mass[(0, joint)] * v);
        about_axis = about_axis.max(parts.clone().sum::<f64>().abs());
        size = size.max(parts.map(f64::abs).sum());
    }
    Lost {
        energy: drift / largest(&mut kinetic.iter().copied()),
        momentum: about_axis / size,
    }
}

/// How falls ended: what those lost that came to their end, with their seeds, and how many stopped.
struct Falls {
    lost: Vec<(u64, Lost)>,
    stopped: usize,
}

fn falls(step_s: Option<f64>) -> Falls {
    let fall = |seed: u64| {
        let folder = tempfile::tempdir().unwrap();
        let text = draw_falling(seed, folder.path());
        let robot = Robot::load(&folder.path().join("arm.urdf"), None, None).unwrap();
        let (recording, _) = run(&text, folder.path(), step_s).unwrap().unwrap();
        match recording.outcome {
            Outcome::Completed => Some((seed, lost(&recording, &robot))),
            Outcome::Diverged { ref quantity, .. } => {
                assert!(quantity.starts_with("energy"), "seed {seed}: {quantity}");
                None
            }
            outcome => panic!("seed {seed}: {outcome}"),
        }
    };
    let ends: Vec<_> = (seeds(CHAINS)).into_par_iter().map(fall).collect();
    let stopped = ends.iter().filter(|end| end.is_none()).count();
    Falls {
        lost: ends.into_iter().flatten().collect(),
        stopped,
    }
}

/// The middle of what the falls lost, of energy and momentum.
fn median(falls: &Falls) -> [f64; 2] {
    [|it: &Lost| it.energy, |it: &Lost| it.momentum].map(|of| {
        let mut values: Vec<f64> = falls.lost.iter().map(|(_, lost)| of(lost)).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    })
}

/// Both are kept to second order: half the step loses a quarter. A light link that is whipped
/// around by a heavy one may turn too fast for the step; such a fall stops with its energy.
#[test]
fn verify_falling_chains_keep_energy_and_momentum() {
    let (whole, half) = (falls(Some(STEP_S)), falls(Some(STEP_S / 2.0)));
    let (a, b) = (median(&whole), median(&half));
    let worst = |of: fn(&Lost) -> f64| {
        let all = whole.lost.iter().map(|(seed, lost)| (of(lost), *seed));
        all.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    };
    let worst = [worst(|it| it.energy), worst(|it| it.momentum)];
    println!(
        "falls {}, stopped {} (half the step {})",
        whole.lost.len(),
        whole.stopped,
        half.stopped
    );
    let names = ["energy", "momentum"];
    for (name, ((a, b), (most, seed))) in names.iter().zip(a.iter().zip(b).zip(worst)) {
        println!("{name}: median {a:.1e}, half the step {b:.1e}, most {most:.1e} (seed {seed})");
    }
    for (a, b) in a.iter().zip(b) {
        let order = (a / b).log2();
        assert!((1.7..2.3).contains(&order), "{order}");
    }
    assert!(a.iter().all(|lost| *lost < 1e-5), "{a:?}");
    assert!(half.stopped <= whole.stopped);
    assert!(whole.stopped * 20 <= whole.lost.len(), "{}", whole.stopped);
}
