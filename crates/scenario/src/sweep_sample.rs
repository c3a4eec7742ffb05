//! The `[sweep.sample]` table: rows that are drawn instead of all combinations.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use schemars::JsonSchema;
use serde::Deserialize;
use truecut_recording::UserUnit;

use crate::check::Check;
use crate::fault::{Fault, split_path};
use crate::structure;
use crate::sweep_check::MOST_ROWS;
use crate::sweep_spec::SweepAxis;
use crate::uncertain::UncertainSpec;
use crate::uncertain_law::UncertainLaw;
use crate::units::key_unit;

/// How rows are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Method {
    /// Each row by itself.
    Random,
    /// One row in each of `count` equal parts of every axis, in random order (McKay, Beckman,
    /// Conover 1979).
    LatinHypercube,
    /// A Sobol sequence with Owen's scrambling (Burley 2020): evenly over all axes together, best
    /// where `count` is a power of two.
    Sobol,
}

/// Rows that are drawn between the ends of the axes, in place of all combinations.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SampleTable {
    /// How rows are drawn.
    method: Method,
    /// Number of rows.
    #[schemars(range(min = 2, max = 100_000), extend("x-rule" = "each is a run"))]
    count: u32,
    /// Another seed draws other rows. Default: 0.
    seed: Option<u32>,
    /// Whether the values of `[[uncertain]]` are drawn too, each from a normal distribution about
    /// its nominal value that ends at three standard deviations, or where the key's range does.
    /// Default: false.
    uncertain: Option<bool>,
}

/// Longest Sobol sequence of the generator.
const MOST_SOBOL: u32 = 1 << 16;

/// Most values that a row may draw: dimensions of the Sobol sequence.
const MOST_DRAWN: usize = sobol_burley::NUM_DIMENSIONS as usize;

/// What an axis is drawn from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Drawn {
    /// Evenly from a first to a last value.
    Even(f64, f64),
    /// Evenly in the logarithm.
    Log(f64, f64),
    /// One of these.
    Among(Vec<f64>),
    /// As an uncertain value allows for, shown in the key's own unit.
    Uncertain(UncertainLaw, UserUnit),
}

impl Drawn {
    /// The value below which a share of all draws lies, 0 < share < 1.
    fn at(&self, share: f64) -> f64 {
        match self {
            Drawn::Even(from, to) => from + share * (to - from),
            Drawn::Log(from, to) => from * (to / from).powf(share),
            Drawn::Among(values) => values[(share * values.len() as f64) as usize],
            Drawn::Uncertain(law, unit) => unit.from_si(law.value_at(share)),
        }
    }
}

impl SampleTable {
    /// Who is to blame for keys that have no effect, and for keys that are missing.
    pub(crate) const BECAUSE: &'static str = "[sweep.sample] draws the rows";

    /// The axes with a value for each row, those of `[[uncertain]]` after the given ones.
    pub(crate) fn resolve(
        self,
        given: Vec<(String, Drawn)>,
        uncertain: &[UncertainSpec],
        check: &mut Check,
    ) -> Vec<SweepAxis> {
        let mut drawn = given;
        if self.uncertain.unwrap_or(false) {
            drawn.extend(from_uncertain(&drawn, uncertain, check));
        }
        let table = "sweep.sample";
        if self.method == Method::Sobol && self.count > MOST_SOBOL {
            let message = format!(
                "is {}, but a Sobol sequence has at most {MOST_SOBOL} rows",
                self.count
            );
            check.wrong(table, "count", message, "too many");
        }
        if drawn.len() > MOST_DRAWN {
            let message = format!(
                "{} values are drawn for each row, but at most {MOST_DRAWN} can be",
                drawn.len()
            );
            check.refuse(Fault::key(table, message, "too many values"));
            return Vec::new();
        }
        let count = (self.count as usize).min(MOST_ROWS);
        let seed = self.seed.unwrap_or(0);
        let axes = drawn.into_iter().enumerate().map(|(place, (key, drawn))| {
            let shares = self.method.shares(count, place as u32, seed);
            SweepAxis {
                unit: key_unit(&key),
                key,
                values: shares.into_iter().map(|share| drawn.at(share)).collect(),
            }
        });
        axes.collect()
    }
}

/// The uncertain values, in their keys' own units.
fn from_uncertain(
    given: &[(String, Drawn)],
    uncertain: &[UncertainSpec],
    check: &mut Check,
) -> Vec<(String, Drawn)> {
    if uncertain.is_empty() {
        let message = "is true, but there is no [[uncertain]]: nothing to draw".to_owned();
        check.wrong("sweep.sample", "uncertain", message, "nothing is uncertain");
    }
    let mut drawn = Vec::new();
    for (index, one) in uncertain.iter().enumerate() {
        if given.iter().any(|(key, _)| *key == one.key) {
            let at = format!("uncertain.{index}.key");
            let message = format!("`{at}` is \"{}\", which an axis draws already", one.key);
            check.refuse(Fault::value(&at, message, "drawn twice"));
            continue;
        }
        let unit = key_unit(&one.key);
        let range = structure::range(check.document().schema(), &split_path(&one.key));
        let law = UncertainLaw::of(one, range.map(|end| end * unit.si_factor));
        drawn.push((one.key.clone(), Drawn::Uncertain(law, unit)));
    }
    drawn
}

impl Method {
    /// For each row a share above 0 and below 1, for one of the values that are drawn.
    fn shares(self, count: usize, place: u32, seed: u32) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(u64::from(seed));
        random.set_stream(u64::from(place));
        match self {
            Method::Random => (0..count).map(|_| share(&mut random)).collect(),
            Method::LatinHypercube => {
                let mut parts: Vec<usize> = (0..count).collect();
                for last in (1..count).rev() {
                    parts.swap(last, (share(&mut random) * (last + 1) as f64) as usize);
                }
                let within = |part| (part as f64 + share(&mut random)) / count as f64;
                parts.into_iter().map(within).collect()
            }
            Method::Sobol => (0..count as u32)
                .map(|row| f64::from(sobol_burley::sample(row, place, seed)) + HALF_STEP)
                .collect(),
        }
    }
}

/// Half of the distance between two numbers of the Sobol sequence, which has 0 but not 1.
const HALF_STEP: f64 = 1.0 / (1 << 25) as f64;

/// Above 0 and below 1.
fn share(random: &mut ChaCha8Rng) -> f64 {
    ((random.next_u64() >> 12) as f64 + 0.5) / (1u64 << 52) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Method; 3] = [Method::Random, Method::LatinHypercube, Method::Sobol];

    /// How many rows lie in each of `count` equal parts.
    fn filled(shares: &[f64], count: usize) -> Vec<usize> {
        let mut parts = vec![0; count];
        for share in shares {
            parts[(share * count as f64) as usize] += 1;
        }
        parts
    }

    /// A Latin hypercube has one row in each part; so has a Sobol sequence of a power of two, and
    /// in two dimensions one in each box of any grid of as many boxes (a net of base 2).
    #[test]
    fn verify_rows_are_spread_as_their_method_says() {
        for seed in [0, 1, 77, 4_000_000_000] {
            for place in 0..40 {
                let shares = Method::LatinHypercube.shares(37, place, seed);
                assert_eq!(filled(&shares, 37), [1; 37], "{seed}, {place}");
                let shares = Method::Sobol.shares(64, place, seed);
                assert_eq!(filled(&shares, 64), [1; 64], "{seed}, {place}");
            }
            let (x, y) = (
                Method::Sobol.shares(256, 0, seed),
                Method::Sobol.shares(256, 1, seed),
            );
            for bits in 0..=8 {
                let (wide, high) = (1 << bits, 1 << (8 - bits));
                let boxes = x.iter().zip(&y);
                let boxes = boxes.map(|(x, y)| {
                    let (column, row) = ((x * wide as f64) as usize, (y * high as f64) as usize);
                    (column * high + row) as f64 / 256.0
                });
                let boxes: Vec<f64> = boxes.collect();
                assert_eq!(filled(&boxes, 256), [1; 256], "{seed}, {wide} x {high}");
            }
        }
    }

    #[test]
    fn seeds_and_values_draw_apart_and_equal_ones_alike() {
        for method in ALL {
            let one = method.shares(100, 3, 5);
            assert_eq!(one, method.shares(100, 3, 5));
            assert_ne!(one, method.shares(100, 3, 6));
            assert_ne!(one, method.shares(100, 4, 5));
            assert!(one.iter().all(|share| 0.0 < *share && *share < 1.0));
        }
    }

    /// Mean and standard deviation of what is drawn, against those of the distributions.
    #[test]
    fn verify_moments_of_what_is_drawn() {
        let moments = |drawn: Drawn| {
            let shares = Method::Sobol.shares(4096, 2, 9);
            let values: Vec<f64> = shares.into_iter().map(|share| drawn.at(share)).collect();
            let mean = values.iter().sum::<f64>() / 4096.0;
            let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 4096.0;
            (mean, square.sqrt())
        };
        let close = |found: (f64, f64), mean: f64, deviation: f64| {
            assert!((found.0 - mean).abs() < 2e-3 * deviation, "{found:?}");
            assert!((found.1 / deviation - 1.0).abs() < 2e-3, "{found:?}");
        };
        close(moments(Drawn::Even(2.0, 8.0)), 5.0, 6.0 / 12f64.sqrt());
        // A normal distribution that ends at three standard deviations has 0.973 of the variance.
        let (key, value, sigma) = ("robot.stiffness_scale".to_owned(), 40.0, 3.0);
        let law = UncertainLaw::of(&UncertainSpec { key, value, sigma }, [0.0, 1e18]);
        let unit = key_unit("robot.stiffness_scale");
        let spread = 3.0 * 0.973_327_f64.sqrt();
        close(moments(Drawn::Uncertain(law, unit)), 40.0, spread);
        // Of a variable whose logarithm is even from 0 to ln 10.
        let ln = 10f64.ln();
        let (mean, square) = (9.0 / ln, 99.0 / (2.0 * ln));
        close(
            moments(Drawn::Log(1.0, 10.0)),
            mean,
            (square - mean * mean).sqrt(),
        );
        let (mean, _) = moments(Drawn::Among(vec![1.0, 2.0, 6.0]));
        assert!((mean - 3.0).abs() < 0.01, "{mean}");
    }
}
