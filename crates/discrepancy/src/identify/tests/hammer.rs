//! Modes from FRFs and blows.

use std::f64::consts::TAU;

use nalgebra::Complex;
use truecut_recording::measured::{Column, Table, TimeBase};
use truecut_recording::{Unit, UserUnit};
use truecut_scenario::identification::{FrameId, HammerPoint, ImpactSpec, MotionKind, Signal};

use super::normal;
use crate::identify::frf::Frf;
use crate::identify::impact::impact;
use crate::identify::modal::{ModalFit, fit};

/// Frequency, damping ratio, and participation in two FRFs.
type Mode = (f64, f64, [f64; 2]);

const THREE: [Mode; 3] = [
    (8.0, 0.02, [1.0, 0.6]),
    (13.0, 0.04, [0.5, -0.8]),
    (31.0, 0.015, [2.0, 1.0]),
];
const BAND: [f64; 2] = [3.0, 45.0];

const HERE: HammerPoint = HammerPoint {
    frame: FrameId::Tool,
    offset_m: [0.0; 3],
    direction: [1.0, 0.0, 0.0],
};

fn value(modes: &[Mode], which: usize, kind: MotionKind, hz: f64) -> Complex<f64> {
    let omega = TAU * hz;
    let of = |&(f, zeta, share): &Mode| {
        let own = TAU * f;
        Complex::from(share[which])
            / Complex::new(own * own - omega * omega, 2.0 * zeta * own * omega)
    };
    Frf::from_compliance(kind, hz) * modes.iter().map(of).sum::<Complex<f64>>()
}

/// Two FRFs of the modes and one above the band, with noise as a share of the largest value.
fn frfs(modes: &[Mode], kind: MotionKind, noise: f64, seed: u64) -> Vec<Frf> {
    let mut draw = normal(seed);
    let all: Vec<Mode> = modes
        .iter()
        .copied()
        .chain([(120.0, 0.02, [4.0, 3.0])])
        .collect();
    let curve = |which: usize| {
        let frequency_hz: Vec<f64> = (0..420).map(|i| 3.0 + 0.1 * f64::from(i)).collect();
        let exact: Vec<Complex<f64>> = frequency_hz
            .iter()
            .map(|f| value(&all, which, kind, *f))
            .collect();
        let size = exact.iter().fold(0.0_f64, |a, h| a.max(h.norm())) * noise;
        Frf {
            source: format!("{which}"),
            value: exact
                .iter()
                .map(|h| h + Complex::new(size * draw(), size * draw()))
                .collect(),
            frequency_hz,
            noise: None,
            coherence: None,
            kind,
            excitation: HERE,
            response: HERE,
            notes: Vec::new(),
        }
    };
    [0, 1].map(curve).into()
}

fn check(found: &ModalFit, modes: &[Mode], of_hz: f64, of_zeta: f64) {
    assert_eq!(found.modes.len(), modes.len(), "{:?}", found.modes);
    for (mode, (hz, zeta, share)) in found.modes.iter().zip(modes) {
        let (f, z) = (mode.frequency_hz[0], mode.damping_ratio[0]);
        assert!((f / hz - 1.0).abs() < of_hz, "{f} Hz for {hz}");
        assert!((z / zeta - 1.0).abs() < of_zeta, "{z} for {zeta}");
        for (found, share) in mode.participation.iter().zip(share) {
            assert!(
                (found - share).norm() < 3.0 * of_zeta * share.abs(),
                "{found} for {share}"
            );
        }
    }
}

#[test]
fn verify_exact_frfs_give_modes_damping_and_shares_back() {
    // The mode above the band is only approximated by the constant term.
    for kind in [
        MotionKind::Displacement,
        MotionKind::Velocity,
        MotionKind::Acceleration,
    ] {
        check(
            &fit(&frfs(&THREE, kind, 0.0, 0), BAND, Some(3), 0.0).unwrap(),
            &THREE,
            1e-4,
            5e-3,
        );
    }
}

#[test]
fn verify_noisy_frfs_show_as_many_modes_as_there_are() {
    for seed in 0..20 {
        let found = fit(
            &frfs(&THREE, MotionKind::Acceleration, 0.01, seed),
            BAND,
            None,
            0.0,
        )
        .unwrap();
        check(&found, &THREE, 3e-3, 0.1);
    }
    // Two modes closer than their widths, separated by two FRFs.
    let close = [(10.0, 0.03, [1.0, 0.5]), (10.5, 0.03, [0.5, -1.0])];
    for seed in 0..5 {
        let found = fit(
            &frfs(&close, MotionKind::Displacement, 0.002, seed),
            [3.0, 20.0],
            None,
            0.0,
        );
        check(&found.unwrap(), &close, 3e-3, 0.03);
    }
}

#[test]
fn verify_intervals_of_modes_hold_the_truth_as_often_as_they_say() {
    let modes = &THREE[..2];
    let (mut held, mut all) = ([0, 0], 0);
    for seed in 0..200 {
        let mut frfs = frfs(modes, MotionKind::Displacement, 0.01, 1000 + seed);
        for frf in &mut frfs {
            frf.frequency_hz.truncate(200);
            frf.value.truncate(200);
        }
        let found = fit(&frfs, [3.0, 23.0], Some(2), 0.0).unwrap();
        for (mode, (hz, zeta, _)) in found.modes.iter().zip(modes) {
            let inside = |of: [f64; 3], truth: &f64| i32::from((of[1]..of[2]).contains(truth));
            held[0] += inside(mode.frequency_hz, hz);
            held[1] += inside(mode.damping_ratio, zeta);
            all += 1;
        }
    }
    for held in held {
        let share = f64::from(held) / f64::from(all);
        // Standard deviation of a rate of 95 % over 400 draws: 1.1 percentage points.
        assert!((0.917..0.983).contains(&share), "{share}");
    }
}

#[test]
fn noise_alone_has_no_mode() {
    let mut shown = 0;
    for seed in 0..20 {
        let mut frfs = frfs(&THREE, MotionKind::Acceleration, 0.0, seed);
        let with_modes = fit(&frfs, BAND, None, 0.0).expect("a fit of three modes");
        assert_eq!(with_modes.modes.len(), 3, "the same setup shows modes");
        let mut draw = normal(500 + seed);
        for frf in &mut frfs {
            frf.value
                .iter_mut()
                .for_each(|h| *h = Complex::new(draw(), draw()));
        }
        shown += fit(&frfs, BAND, None, 0.0).map_or(0, |fit| fit.modes.len());
    }
    assert_eq!(shown, 0);
}

/// Blows on the modes: half a sine of force, the response by convolution with the closed form.
fn blows(count: usize, seconds: f64, noise: f64) -> Table {
    const RATE: f64 = 400.0;
    let length = (seconds * RATE) as usize;
    let mut force = vec![0.0; count * length];
    for blow in 0..count {
        for k in 0..4 {
            force[blow * length + 20 + k] =
                300.0 * ((k as f64 + 0.5) / 4.0 * std::f64::consts::PI).sin();
        }
    }
    let mut motion = vec![0.0; force.len()];
    for (at, f) in force.iter().enumerate().filter(|(_, f)| **f > 0.0) {
        for (i, x) in motion.iter_mut().enumerate().skip(at) {
            let t = (i - at) as f64 / RATE;
            for (hz, zeta, share) in THREE {
                let own = TAU * hz;
                let damped = own * (1.0_f64 - zeta * zeta).sqrt();
                *x += f / RATE * share[0] / damped * (-zeta * own * t).exp() * (damped * t).sin();
            }
        }
    }
    let mut draw = normal(9);
    let size = motion.iter().fold(0.0_f64, |a, x| a.max(x.abs())) * noise;
    motion.iter_mut().for_each(|x| *x += size * draw());
    let column = |name: &str, values| Column {
        name: name.into(),
        values,
    };
    Table {
        source: "blows.csv".into(),
        columns: vec![column("f", force), column("x", motion)],
        ..Table::default()
    }
}

fn hammer(window_s: f64, exponential_s: Option<f64>) -> ImpactSpec {
    let signal = |name: &str| Signal {
        column: name.into(),
        factor: 1.0,
    };
    ImpactSpec {
        file: "blows.csv".into(),
        header: true,
        times: TimeBase::Rate { hz: 400.0 },
        is_time_unit_said: false,
        force: signal("f"),
        response: signal("x"),
        kind: MotionKind::Displacement,
        trigger_n: None,
        before_s: 0.01,
        window_s: Some(window_s),
        exponential_s,
        struck: HERE,
        observed: HERE,
    }
}

#[test]
fn verify_blows_give_the_modes_of_the_closed_form() {
    // Sampled displacement is exact; the constant and 1/ω² terms absorb aliasing. A
    // window much shorter than the decay needs the exponential; blows themselves wait until the arm
    // is quiet.
    for (window_s, exponential, shift) in [(11.9, None, 0.0), (2.5, Some(0.6), 1.0 / 0.6)] {
        let table = blows(3, 12.0, 1e-4);
        let spec = hammer(window_s, exponential);
        let found = impact(&table, &spec, BAND, "modes.impact.0").unwrap();
        assert!(found.coherence.as_ref().unwrap().iter().all(|c| *c > 0.9));
        let found = fit(&[found], BAND, None, shift).unwrap();
        assert_eq!(found.modes.len(), 3);
        for (mode, (hz, zeta, _)) in found.modes.iter().zip(THREE) {
            assert!(
                (mode.frequency_hz[0] / hz - 1.0).abs() < 1e-3,
                "{:?}",
                mode.frequency_hz
            );
            assert!(
                (mode.damping_ratio[0] / zeta - 1.0).abs() < 0.03,
                "{:?}",
                mode.damping_ratio
            );
        }
    }
}

#[test]
fn double_blows_are_left_out_and_short_windows_are_noted() {
    let mut table = blows(3, 3.0, 1e-4);
    table.columns[0].values[1200 + 20 + 60] = 250.0;
    let found = impact(&table, &hammer(2.9, None), BAND, "modes.impact.0").unwrap();
    assert!(
        found.notes[0].starts_with("2 blows averaged"),
        "{:?}",
        found.notes
    );
    assert!(
        found.notes[1].starts_with("1 of 3 blows are left out"),
        "{:?}",
        found.notes
    );
    let found = impact(&table, &hammer(0.8, None), BAND, "modes.impact.0").unwrap();
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.contains("damping comes out too large")),
        "{:?}",
        found.notes
    );
}

/// Blows whose times stand in ms in a column that is called `name`, in a unit of the file's, if
/// any.
fn in_milliseconds(name: &str, of_file: Option<&str>) -> (Table, ImpactSpec) {
    let mut table = blows(3, 3.0, 1e-4);
    let rows = table.rows();
    table.columns.push(Column {
        name: name.into(),
        values: (0..rows).map(|row| row as f64 * 2.5).collect(),
    });
    let unit = of_file.map(|unit| (name.to_owned(), unit.to_owned()));
    table.units.extend(unit);
    let spec = ImpactSpec {
        times: TimeBase::Column {
            column: name.into(),
            unit: UserUnit::from(Unit::Second),
        },
        ..hammer(2.9, None)
    };
    (table, spec)
}

#[test]
fn times_are_in_the_unit_that_the_file_gives_them() {
    let (table, spec) = (blows(3, 3.0, 1e-4), hammer(2.9, None));
    let expected = impact(&table, &spec, BAND, "modes.impact.0").unwrap();
    for (name, of_file) in [("t", Some("ms")), ("t_ms", None)] {
        let (table, spec) = in_milliseconds(name, of_file);
        let found = impact(&table, &spec, BAND, "modes.impact.0").unwrap();
        let pairs = found.frequency_hz.iter().zip(&expected.frequency_hz);
        assert_eq!(found.frequency_hz.len(), expected.frequency_hz.len());
        pairs.for_each(|(found, hz)| assert!((found - hz).abs() < 1e-9, "{found} for {hz}"));
        let note = format!("times are in ms, as the file says of `{name}`");
        assert!(found.notes.contains(&note), "{:?}", found.notes);
    }
}

#[test]
fn times_of_an_unknown_or_of_another_unit_are_refused() {
    let refusal = |table: &Table, spec: &ImpactSpec| {
        let error = impact(table, spec, BAND, "modes.impact.0").unwrap_err();
        (error.key.clone(), error.to_string())
    };
    let (table, mut spec) = in_milliseconds("t", Some("ticks"));
    let (key, told) = refusal(&table, &spec);
    assert_eq!(key, "modes.impact.0.time");
    let unknown = "blows.csv: column \"t\" (the times): the file gives its unit as \"ticks\", which is not known";
    assert!(told.contains(unknown), "{told}");
    // Who says the unit knows it, whatever the file calls it.
    spec.is_time_unit_said = true;
    spec.times = TimeBase::Column {
        column: "t".into(),
        unit: UserUnit::parse("ms").unwrap(),
    };
    assert!(impact(&table, &spec, BAND, "modes.impact.0").is_ok());
    let (table, _) = in_milliseconds("t", Some("us"));
    let (key, told) = refusal(&table, &spec);
    assert_eq!(key, "modes.impact.0.time_unit");
    assert!(told.contains("but `time_unit` is \"ms\""), "{told}");
    // Nothing says it: seconds are assumed, and the message on what does not fit tells so.
    let (table, spec) = in_milliseconds("t", None);
    let (key, told) = refusal(&table, &spec);
    assert_eq!(key, "modes.band_hz");
    let assumed = "\"t\" are taken for s, since neither the file nor `time_unit` gives their unit";
    assert!(told.contains(assumed), "{told}");
}

/// Times as `%.7g` writes them, of a card that samples at 12.8 kHz: from 1 s on a millionth is
/// left, of 78 µs; and what is no rounding is refused with the key that helps.
#[test]
fn times_that_round_even_ones_are_even() {
    let of_seven_digits = |time: f64| -> f64 { format!("{time:.6e}").parse().unwrap() };
    let with = |round: &dyn Fn(usize) -> f64| {
        let mut table = blows(3, 3.0, 1e-4);
        let values = (0..table.rows()).map(round).collect();
        let name = "t_s".into();
        table.columns.push(Column { name, values });
        let times = TimeBase::Column {
            column: "t_s".into(),
            unit: UserUnit::from(Unit::Second),
        };
        let spec = ImpactSpec {
            times,
            ..hammer(0.09, None)
        };
        impact(&table, &spec, [95.0, 1395.0], "modes.impact.0")
    };
    let time = |row: usize| 0.95 + row as f64 / 12_800.0;
    let exact = with(&time).unwrap();
    assert!(
        !exact.notes.iter().any(|note| note.contains("rounded")),
        "{:?}",
        exact.notes
    );
    let rounded = with(&|row| of_seven_digits(time(row))).unwrap();
    let note = "blows.csv: times are rounded to 1e-6 s, and lie within it of even ones: taken as 12800.0 samples a second";
    assert!(
        rounded.notes.iter().any(|told| told == note),
        "{:?}",
        rounded.notes
    );
    let pairs = rounded.frequency_hz.iter().zip(&exact.frequency_hz);
    assert_eq!(rounded.frequency_hz.len(), exact.frequency_hz.len());
    pairs.for_each(|(found, hz)| assert!((found / hz - 1.0).abs() < 1e-5, "{found} for {hz}"));
    // A sample that is missing, and a clock that trembles by a tenth of the interval.
    let missing = |row: usize| of_seven_digits(time(row + usize::from(row > 500)));
    let trembling = |row: usize| of_seven_digits(time(row) + 8e-6 * (row as f64).sin());
    for uneven in [&missing as &dyn Fn(usize) -> f64, &trembling] {
        let error = with(uneven).unwrap_err();
        assert_eq!(error.key, "modes.impact.0.time");
        let told =
            "if the samples are evenly apart, give their rate as `rate_hz` in place of `time`";
        assert!(error.message.contains(told), "{error}");
    }
}
