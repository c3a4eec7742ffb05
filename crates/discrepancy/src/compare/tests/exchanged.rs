//! Columns that are each other's.

use super::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Channels of two units, and what each column holds: the signal of the channel at that place.
fn found(units: &[Unit], holds: &[usize], random: &mut ChaCha8Rng) -> Option<Exchange> {
    let mut draw =
        |low: f64, high: f64| low + (high - low) * (random.next_u32() as f64 / f64::from(u32::MAX));
    // Each in a band of its own: what looks alike cannot be told apart.
    let simulated: Vec<Vec<f64>> = (0..units.len())
        .map(|index| {
            let slow = 0.3 + 0.3 * index as f64 + draw(0.0, 0.1);
            let fast = draw(2.5, 7.0);
            let (size, share) = (draw(0.2, 5.0), draw(0.2, 1.0));
            of_time(|t| size * ((TAU * slow * t).sin() + share * (TAU * fast * t).cos()))
        })
        .collect();
    let specs: Vec<ChannelSpec> = (units.iter().enumerate())
        .map(|(index, unit)| ChannelSpec::new(format!("x{index}"), *unit, ""))
        .collect();
    let measured: Vec<Vec<f64>> = (holds.iter().enumerate())
        .map(|(index, from)| {
            let left = noise(Colour::White, SAMPLES, 10 + index as u64);
            let size = 0.1 * deviation(&simulated[*from]);
            let rows = simulated[*from].iter().zip(left);
            rows.map(|(x, e)| x + size * e + 1.0).collect()
        })
        .collect();
    let pairs: Vec<Pair<'_>> = (0..units.len())
        .map(|index| Pair {
            spec: &specs[index],
            measured: &measured[index],
            valid: &[true; SAMPLES],
            simulated: &simulated[index],
            noise: None,
        })
        .collect();
    exchange(&pairs)
}

/// Where every channel of a unit that is moved lies in one ring: it is named from its first on.
#[test]
fn columns_in_a_ring_are_named_with_where_they_belong() {
    const UNITS: [Unit; 6] = [
        Unit::NewtonMetre,
        Unit::NewtonMetre,
        Unit::Newton,
        Unit::NewtonMetre,
        Unit::Newton,
        Unit::NewtonMetre,
    ];
    const TORQUES: [usize; 4] = [0, 1, 3, 5];
    for seed in 0..40 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // Two to four of the torques, in any order.
        let mut ring = TORQUES.to_vec();
        for last in (1..ring.len()).rev() {
            ring.swap(last, random.next_u32() as usize % (last + 1));
        }
        ring.truncate(2 + seed as usize % 3);
        let mut holds: Vec<usize> = (0..UNITS.len()).collect();
        for (place, at) in ring.iter().enumerate() {
            holds[*at] = ring[(place + 1) % ring.len()];
        }
        let exchange = found(&UNITS, &holds, &mut random).unwrap_or_else(|| panic!("seed {seed}"));
        let first = *ring.iter().min().expect("two at least");
        let mut expected = vec![first];
        while expected.len() < ring.len() {
            expected.push(holds[*expected.last().expect("one")]);
        }
        let names: Vec<String> = expected.iter().map(|one| format!("x{one}")).collect();
        let told: Vec<&str> = (exchange.moved.iter()).map(|one| &*one.channel).collect();
        assert_eq!(told, names, "seed {seed}");
        assert_eq!(exchange.moved.last().expect("one").fits, names[0]);
    }
}

/// Columns in their places, a column that is there twice, and exchanged columns of different units.
#[test]
fn other_columns_are_not_called_exchanged() {
    let torque = Unit::NewtonMetre;
    let cases: [([Unit; 3], [usize; 3]); 3] = [
        ([torque; 3], [0, 1, 2]),
        ([torque; 3], [1, 1, 2]),
        ([torque, Unit::Newton, torque], [1, 0, 2]),
    ];
    for (units, holds) in cases {
        for seed in 0..10 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let found = found(&units, &holds, &mut random);
            assert_eq!(found, None, "{holds:?}, seed {seed}");
        }
    }
}
