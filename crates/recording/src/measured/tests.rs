//! Columns become channels, and what cannot be used is refused with its place.

use super::*;
use crate::unit::{Unit, UserUnit};

mod passes;

fn column(name: &str, values: Vec<f64>) -> Column {
    Column {
        name: name.into(),
        values,
    }
}

/// A table at 1 kHz with a sine of 5 Hz in mm and a ramp.
fn table(rows: usize) -> Table {
    let time: Vec<f64> = (0..rows).map(|k| k as f64 * 1e-3).collect();
    let sine = time
        .iter()
        .map(|t| 3.0 * (std::f64::consts::TAU * 5.0 * t).sin());
    Table {
        source: "bench.csv".into(),
        columns: vec![
            column("sine", sine.collect()),
            column("ramp", time.iter().map(|t| 2.0 * t).collect()),
            column("t", time),
        ],
        lines: (2..rows + 2).collect(),
        ..Table::default()
    }
}

fn channel(column: &str, channel: &str, unit: &str) -> ChannelMapping {
    ChannelMapping {
        terms: vec![column.into()],
        channel: channel.into(),
        unit: UserUnit::parse(unit).unwrap(),
        scale: 1.0,
        offset: 0.0,
        role: Role::Output,
        noise: None,
        saturation: None,
    }
}

fn mapping() -> Mapping {
    Mapping {
        time: TimeBase::Column {
            column: "t".into(),
            unit: UserUnit::from(Unit::Second),
        },
        is_time_unit_said: true,
        clock_rate: 1.0,
        window_s: [f64::NEG_INFINITY, f64::INFINITY],
        resample_hz: None,
        starts_s: Vec::new(),
        max_gap_s: 0.0105,
        bridge_spikes: true,
        channels: vec![channel("sine", "joint1.position", "mm")],
    }
}

fn refusal(table: &Table, mapping: &Mapping) -> String {
    measured(table, mapping)
        .expect_err("must be refused")
        .to_string()
}

#[test]
fn units_and_scales_become_si_on_a_uniform_base() {
    let mut mapping = mapping();
    mapping.channels[0].scale = 2.0;
    let data = measured(&table(1000), &mapping).unwrap();
    let channel = data.channel("joint1.position").unwrap();
    assert_eq!(
        (channel.spec.unit, channel.values.len()),
        (Unit::Metre, 1000)
    );
    assert!(
        (channel.values[50] - 6e-3).abs() < 1e-12,
        "a quarter period"
    );
    assert!(channel.valid.iter().all(|valid| *valid));
    assert!((data.rate_hz() - 1000.0).abs() < 1e-6 && (data.duration_s() - 0.999).abs() < 1e-9);
}

#[test]
fn short_gaps_are_bridged_and_long_ones_masked() {
    let mut table = table(1000);
    // Nine samples are missing: the neighbours are 10 ms apart, within the 10.5 ms allowed. Then
    // nineteen.
    table.columns[1].values[100..109].fill(f64::NAN);
    table.columns[1].values[500..519].fill(f64::NAN);
    let mut mapping = mapping();
    mapping.channels = vec![channel("ramp", "joint1.position", "m")];
    let data = measured(&table, &mapping).unwrap();
    let ramp = &data.channels[0];
    assert!(ramp.valid[90..120].iter().all(|valid| *valid));
    assert_eq!(ramp.first_gap(), Some(500..519));
    assert!((ramp.values[104] - 0.208).abs() < 1e-12, "on the line");
    let notes = data.notes.join("\n");
    assert!(
        notes.contains("masked rows: 28 without a number, 0 saturated"),
        "{notes}"
    );
    assert!(
        notes.contains("19 of 1000 samples have no measurement"),
        "{notes}"
    );
}

/// Rows that a logger lost, one to three at a time: on what drives a model the cubic errs by less
/// than a thousandth of its size, where a line is off by a fiftieth; the rows are counted.
#[test]
fn verify_inputs_run_on_smoothly_over_missing_rows() {
    let mut table = table(1000);
    let lost = |k: &usize| matches!(k % 97, 40) || matches!(k % 211, 100..103);
    let kept: Vec<usize> = (0..1000).filter(|k| !lost(k)).collect();
    for column in &mut table.columns {
        column.values = kept.iter().map(|k| column.values[*k]).collect();
    }
    table.lines.truncate(kept.len());
    let off = |role: Role| {
        let mut mapping = mapping();
        mapping.channels[0].role = role;
        mapping
            .channels
            .push(channel("ramp", "joint2.position", "m"));
        let data = measured(&table, &mapping).unwrap();
        let count = format!("{} rows seem to be missing", 1000 - kept.len());
        assert!(data.notes.join("\n").contains(&count), "{:?}", data.notes);
        let rows = data.time_s.iter().zip(&data.channels[0].values);
        let wave = |t: &f64| 3e-3 * (std::f64::consts::TAU * 5.0 * t).sin();
        rows.fold(0.0_f64, |worst, (t, x)| worst.max((x - wave(t)).abs()))
    };
    assert!(off(Role::Input) < 3e-7, "{}", off(Role::Input));
    assert!(off(Role::Output) > 3e-6, "{}", off(Role::Output));
}

#[test]
fn saturated_readings_are_masked_in_the_files_own_numbers() {
    let mut mapping = mapping();
    mapping.max_gap_s = 1.5e-3;
    mapping.channels[0].saturation = Some([-2.9, 2.9]);
    let data = measured(&table(1000), &mapping).unwrap();
    let sine = &data.channels[0];
    for (value, valid) in sine.values.iter().zip(&sine.valid) {
        assert!(value.abs() < 2.9e-3);
        assert!(*valid || value.abs() > 2.85e-3, "masked at {value}");
    }
    assert!(!sine.valid[50] && sine.valid[20]);
}

/// 125 Hz, stamps off by up to a third of an interval; straight lines err by 3e-3 of the amplitude.
#[test]
fn verify_jittered_stamps_cost_next_to_nothing() {
    let wave = |t: f64| (std::f64::consts::TAU * 3.0 * t).sin();
    let mut state = 1_u32;
    let mut drawn = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1_u32 << 24) - 0.5
    };
    let time: Vec<f64> = (0..1000)
        .map(|k| 8e-3 * (f64::from(k) + 0.66 * drawn()))
        .collect();
    let table = Table {
        source: "jittered.csv".into(),
        columns: vec![
            column("sine", time.iter().map(|t| wave(*t)).collect()),
            column("t", time),
        ],
        lines: (2..1002).collect(),
        ..Table::default()
    };
    let mut mapping = mapping();
    mapping.resample_hz = Some(125.0);
    mapping.channels[0].unit = UserUnit::parse("m").unwrap();
    let data = measured(&table, &mapping).unwrap();
    let start_s = table.columns[1].values[0];
    let inside = 4..data.time_s.len() - 4;
    let error = inside.map(|k| {
        let value = data.channels[0].values[k];
        (value - wave(start_s + data.time_s[k])).abs()
    });
    let worst = error.fold(0.0, f64::max);
    assert!(worst < 3e-4, "{worst}");
}

/// Up to ten samples are made of one, no more.
#[test]
fn a_result_far_faster_than_its_file_is_refused() {
    let mut mapping = mapping();
    for (hz, refused) in [(10_000.0, false), (10_001.0, true), (1e5, true)] {
        mapping.resample_hz = Some(hz);
        let read = measured(&table(200), &mapping);
        assert_eq!(read.is_err(), refused, "{hz}");
        if let Err(error) = read {
            let message = error.to_string();
            assert!(message.contains("at most 10000"), "{message}");
        }
    }
}

/// A fifth of the rate: 5 Hz passes, 300 Hz, which would fold to 100 Hz, does not.
#[test]
fn a_slower_result_has_nothing_folded_into_it() {
    let mut table = table(2000);
    let disturbance = (0..2000).map(|k| (std::f64::consts::TAU * 0.3 * k as f64).sin());
    for (value, extra) in table.columns[0].values.iter_mut().zip(disturbance) {
        *value += extra;
    }
    let mut mapping = mapping();
    mapping.resample_hz = Some(200.0);
    let data = measured(&table, &mapping).unwrap();
    assert_eq!(data.time_s.len(), 400);
    for (t, value) in data
        .time_s
        .iter()
        .zip(&data.channels[0].values)
        .skip(10)
        .take(380)
    {
        let truth = 3e-3 * (std::f64::consts::TAU * 5.0 * t).sin();
        assert!((value - truth).abs() < 1e-5, "{t}: {value} beside {truth}");
    }
    assert!(
        data.notes
            .iter()
            .any(|note| note.contains("cutoff 80.00 Hz")),
        "{:?}",
        data.notes
    );
}

#[test]
fn channels_of_unequal_rates_come_to_one_base() {
    let mut table = table(2000);
    for (row, value) in table.columns[1].values.iter_mut().enumerate() {
        if row % 8 != 0 {
            *value = f64::NAN;
        }
    }
    let mut mapping = mapping();
    mapping
        .channels
        .push(channel("ramp", "joint2.position", "m"));
    let data = measured(&table, &mapping).unwrap();
    let slow = &data.channels[1];
    assert_eq!(slow.values.len(), data.channels[0].values.len());
    for (t, value) in data.time_s.iter().zip(&slow.values) {
        assert!((value - 2.0 * t).abs() < 1e-12);
    }
}

#[test]
fn a_window_cuts_and_times_begin_at_zero() {
    let mut mapping = mapping();
    mapping.window_s = [0.2, 0.7];
    mapping.channels = vec![channel("ramp", "joint1.position", "m")];
    let data = measured(&table(1000), &mapping).unwrap();
    assert_eq!((data.time_s.len(), data.time_s[0]), (501, 0.0));
    assert!((data.channels[0].values[0] - 0.4).abs() < 1e-12);
}

#[test]
fn a_rate_replaces_a_column_of_times() {
    let mut mapping = mapping();
    mapping.time = TimeBase::Rate { hz: 500.0 };
    let data = measured(&table(1000), &mapping).unwrap();
    assert!((data.rate_hz() - 500.0).abs() < 1e-9);
}

#[test]
fn a_missing_column_names_the_nearest() {
    let mut mapping = mapping();
    mapping.channels[0].terms = vec!["sin".into()];
    assert_eq!(
        refusal(&table(300), &mapping),
        "bench.csv: no column \"sin\"; did you mean \"sine\"?; the file has sine, ramp, t"
    );
}

#[test]
fn times_that_do_not_rise_are_refused_with_their_row() {
    let mut bad = table(300);
    bad.columns[2].values[41] = 0.040;
    assert_eq!(
        refusal(&bad, &mapping()),
        "bench.csv: row 42 (line 43): the time is 0.04 s after 0.04 s, but times must rise"
    );
    bad.columns[2].values[41] = f64::NAN;
    bad.lines.clear();
    assert_eq!(
        refusal(&bad, &mapping()),
        "bench.csv: row 42: the time is not a finite number"
    );
}

#[test]
fn outputs_that_never_change_are_left_out_and_refused_if_there_is_no_other() {
    let mut constant = table(300);
    constant.columns[0].values.fill(0.0);
    let text = refusal(&constant, &mapping());
    assert!(
        text.contains("every sample is 0 m, so that nothing was measured"),
        "{text}"
    );
    let mut driven = mapping();
    driven.channels[0].role = Role::Input;
    assert!(measured(&constant, &driven).is_ok());

    let mut two = mapping();
    two.channels.push(channel("ramp", "joint2.position", "m"));
    let found = measured(&constant, &two).unwrap();
    let names = found.channels.iter().map(|one| one.spec.name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["joint2.position"]);
    let told = "joint1.position: column \"sine\" is left out: every sample is 0 m";
    assert!(found.notes.iter().any(|note| note.starts_with(told)));

    constant.columns[1].values.fill(2.5);
    let text = refusal(&constant, &two);
    let all = "every sample is 0 m, so that nothing was measured; none of the 2 outputs changes";
    assert!(text.contains(all), "{text}");
}

/// A spike of 1e5 times the signal in a channel that is thinned: the result is that of the clean
/// channel up to a thousandth of it, where the process lets spikes be replaced.
#[test]
fn verify_spikes_do_not_spread_where_a_channel_is_thinned() {
    let clean = table(4000);
    let mut mapping = mapping();
    mapping.resample_hz = Some(100.0);
    let expected = measured(&clean, &mapping).unwrap();
    for at in [40, 1003, 3988] {
        let mut spiky = clean.clone();
        spiky.columns[0].values[at] += 3e5;
        let found = measured(&spiky, &mapping).unwrap();
        let pairs = found.channels[0]
            .values
            .iter()
            .zip(&expected.channels[0].values);
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 3e-6, "{worst}");
        assert!(
            found
                .notes
                .iter()
                .any(|note| note.contains("1 of 4000 samples are spikes"))
        );
    }
}

#[test]
fn too_few_samples_are_refused() {
    let text = refusal(&table(199), &mapping());
    assert!(
        text.contains("199 rows lie in the part that is used, but at least 200"),
        "{text}"
    );
    let mut holes = table(300);
    holes.columns[0].values[..150].fill(f64::NAN);
    let text = refusal(&holes, &mapping());
    assert!(
        text.contains("150 samples are left (150 without a number, 0 saturated)"),
        "{text}"
    );
}
