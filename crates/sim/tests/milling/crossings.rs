//! Edges that leave the stock with a chip: their force jumps within a step.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use truecut_sim::run::{Engine, Run};

use super::support::{RIG, scenario};

/// Steps of runs that are held against each other, ms.
const STEPS_MS: [f64; 6] = [0.2, 0.1, 0.05, 0.025, 0.0125, 0.00625];

/// Of a heavy slide with drawn cuts, up and down, a run with half the step is nearer by a factor of
/// four: where a tooth enters or leaves within a step does not matter.
#[test]
fn verify_jumps_at_faces_are_met_to_second_order() {
    let mut orders = Vec::new();
    for seed in 0..24 {
        let mut draw = ChaCha8Rng::seed_from_u64(seed);
        let mut between = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut draw);
        let overrides = [
            ("robot.inertia_scale", between(600.0, 4000.0)),
            ("robot.stiffness_scale", between(0.5, 4.0)),
            ("robot.damping_scale", between(20.0, 200.0)),
            ("process.milling.spindle_rpm", between(700.0, 3000.0)),
            ("process.milling.radial_depth_mm", between(3.0, 17.0)),
            ("process.milling.start_angle_deg", between(0.0, 360.0)),
        ];
        let mut overrides = overrides
            .map(|(key, value)| (key, value.to_string()))
            .to_vec();
        let engagement = if between(0.0, 1.0) < 0.5 {
            "\"up\""
        } else {
            "\"down\""
        };
        overrides.push(("process.milling.engagement", engagement.to_owned()));
        // a run that begins with a full chip has half of its first one
        overrides.push(("process.milling.ramp_mm", "0.01".to_owned()));
        overrides.push(("run.duration_s", "0.12".to_owned()));
        let positions = STEPS_MS.map(|step_ms| {
            let step = ("run.time_step_ms", step_ms.to_string());
            let cut = scenario(RIG, &[overrides.as_slice(), &[step]].concat());
            let run = Run {
                engine: Engine::REDUCED,
                ..Run::of(&cut)
            };
            let rows = run.rows(&["joint1.position"], None).unwrap();
            let every = (STEPS_MS[0] / step_ms).round() as usize;
            let rows = rows.columns[0].iter().step_by(every);
            rows.copied().collect::<Vec<f64>>()
        });
        let apart = |pair: &[Vec<f64>]| {
            let rows = pair[0].iter().zip(&pair[1]);
            rows.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let apart: Vec<f64> = positions.windows(2).map(apart).collect();
        // the size of what is left depends on where in the step the edge crosses
        let halvings = apart.len() as f64 - 1.0;
        let order = (apart[0] / apart[apart.len() - 1]).log2() / halvings;
        assert!(order > 1.5, "seed {seed}: {order}, {apart:?}");
        orders.push(order);
    }
    let mean = orders.iter().sum::<f64>() / orders.len() as f64;
    assert!((1.9..2.2).contains(&mean), "{mean}: {orders:?}");
}
