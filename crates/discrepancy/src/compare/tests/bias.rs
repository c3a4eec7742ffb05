//! The error of a mean is what the means of many records scatter by.

use super::*;

/// The size of a residual that is all noise.
fn level_of(values: &[f64]) -> Level {
    let spec = ChannelSpec::new("x", Unit::One, "");
    let (valid, nothing) = (vec![true; values.len()], vec![0.0; values.len()]);
    let pair = Pair {
        spec: &spec,
        measured: values,
        valid: &valid,
        simulated: &nothing,
        noise: None,
    };
    let background = Background::of(values, &valid);
    level(&pair, values, background.as_ref())
}

/// The bias of a drawn record, and the record's own standard deviation over the root of its length.
fn bias(colour: Colour, samples: usize, seed: u64) -> (Estimate, f64) {
    let values = noise(colour, samples, seed);
    let found = level_of(&values);
    let least = deviation(&values) / (samples as f64).sqrt();
    assert!(found.effective_samples <= samples as f64, "{found:?}");
    (found.bias, least)
}

/// 1.96 standard errors hold 95 % of the means: at most three standard errors of a rate found in so
/// many records are more outside. With the line through the lowest bins alone, extrapolated to
/// frequency 0, 16 to 32 % of them were.
#[test]
fn verify_error_of_the_mean_as_it_is_read() {
    const RECORDS: u64 = 400;
    for samples in [239, 500, 6000] {
        for colour in [Colour::White, Colour::Ar1(0.5), Colour::Ar1(0.9)] {
            let records: Vec<_> = (0..RECORDS)
                .map(|seed| bias(colour, samples, seed))
                .collect();
            let is_outside =
                |(found, _): &&(Estimate, f64)| found.value.abs() > 1.96 * found.standard_error;
            let outside = records.iter().filter(is_outside).count() as f64 / RECORDS as f64;
            assert!(outside < 0.083, "{colour:?}, {samples}: {outside}");
            let short = |(found, least): &&(Estimate, f64)| found.standard_error < 0.999 * least;
            assert_eq!(records.iter().filter(short).count(), 0, "{colour:?}");
        }
    }
}

/// The error of white noise is that of independent samples, and in few records far more.
#[test]
fn verify_error_of_the_mean_of_white_noise_is_not_vague() {
    for samples in [500, 6000] {
        let mut sizes: Vec<f64> = (0..200)
            .map(|seed| bias(Colour::White, samples, seed))
            .map(|(found, least)| found.standard_error / least)
            .collect();
        sizes.sort_by(f64::total_cmp);
        assert!(sizes[100] < 1.15, "{samples}: {}", sizes[100]);
        assert!(sizes[180] < 1.6, "{samples}: {}", sizes[180]);
    }
}

/// Differences of white noise have no power at frequency 0: their mean is known better than is
/// told, never worse.
#[test]
fn verify_a_dip_at_frequency_zero_makes_no_bias() {
    let samples = 2000;
    let outside = (0..200).filter(|&seed| {
        let drawn = noise(Colour::White, samples + 1, seed);
        let values: Vec<f64> = drawn.windows(2).map(|two| two[1] - two[0]).collect();
        level_of(&values).bias.p_value < 0.05
    });
    assert_eq!(outside.count(), 0);
}
