//! Noise of known colour, the same in every run; a milling scenario.

use std::path::Path;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use truecut_recording::measured::{MeasuredChannel, Role};
use truecut_recording::{ChannelSpec, Unit};
use truecut_scenario::Scenario;

/// A slot on one spring, whose force and slide are measured, with other values of some keys.
pub fn milling(changes: &[(&str, &str)]) -> Scenario {
    let text = r#"
name = "milled"
[robot]
urdf = "../../assets/robots/rig_milling/robot.urdf"
gravity = false
[process.milling]
spindle_rpm = 300
feed_mm_per_tooth = 0.1
axial_depth_mm = 1.0
engagement = "slot"
start_angle_deg = 20
[process.milling.cutter]
diameter_mm = 16
teeth = 4
[process.milling.cutting]
tangential_mpa = 800
radial_mpa = 240
[process.milling.path]
direction = [1, 0, 0]
length_mm = 100
[run]
duration_s = 1.0
[data]
time = "t"
[[data.channel]]
column = "fx"
channel = "milling.force_x"
unit = "N"
[[data.channel]]
column = "x"
channel = "joint1.position"
unit = "m"
"#;
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/milling/test.toml");
    let own = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    let changes: Vec<_> = changes.iter().map(own).collect();
    Scenario::from_str(&at, text, &changes).unwrap_or_else(|error| panic!("{error:?}"))
}

/// An angle that is measured at all times, and drives what is simulated.
pub fn channel(values: Vec<f64>) -> MeasuredChannel {
    MeasuredChannel {
        spec: ChannelSpec::new("joint1.angle", Unit::Radian, "drawn"),
        role: Role::Input,
        valid: vec![true; values.len()],
        values,
        noise: None,
        white_kept: 1.0,
    }
}

/// Kinds of noise.
#[derive(Clone, Copy, Debug)]
pub enum Colour {
    White,
    /// First order, with this coefficient.
    Ar1(f64),
    /// Power density as 1/f over all frequencies of the record, and a decade below its lowest.
    Pink,
}

/// `count` samples of unit innovation variance (white, AR).
pub fn noise(colour: Colour, count: usize, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    match colour {
        Colour::White => (0..count).map(|_| draw()).collect(),
        Colour::Ar1(a) => first_order(a, count, &mut draw),
        // First-order processes of equal variance, their time constants a factor 3 apart.
        Colour::Pink => {
            let mut sum = vec![0.0; count];
            let mut time_constant: f64 = 0.5;
            while time_constant < 2.0 * count as f64 {
                let a = (-1.0 / time_constant).exp();
                let share = first_order(a, count, &mut draw);
                let scale = (1.0 - a * a).sqrt();
                for (total, one) in sum.iter_mut().zip(share) {
                    *total += scale * one;
                }
                time_constant *= 3.0;
            }
            sum
        }
    }
}

/// Starts in the stationary state.
fn first_order(a: f64, count: usize, draw: &mut impl FnMut() -> f64) -> Vec<f64> {
    let mut state = draw() / (1.0 - a * a).sqrt();
    let step = |_| {
        state = a * state + draw();
        state
    };
    (0..count).map(step).collect()
}
