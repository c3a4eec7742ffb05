//! Passes of a process, and times of a clock that is off.

use super::*;

#[test]
fn passes_have_process_times_of_their_own() {
    let mut mapping = mapping();
    mapping.starts_s = vec![0.1, 0.4995];
    let data = measured(&table(1000), &mapping).unwrap();
    let samples: Vec<_> = data.passes().into_iter().map(|pass| pass.samples).collect();
    assert_eq!(samples, [100..500, 500..1000]);
    let process_s = data.process_time_s();
    let expected = [
        (0, -0.1),
        (100, 0.0),
        (499, 0.399),
        (500, 0.0005),
        (999, 0.4995),
    ];
    for (row, time) in expected {
        assert!(
            (process_s[row] - time).abs() < 1e-9,
            "{row}: {}",
            process_s[row]
        );
    }
    // What is simulated once stands at every pass, and before the first one what its start says.
    let stretches = data.stretches_s();
    assert_eq!(stretches.len(), 3);
    let simulated: Vec<f64> = (stretches.iter().flatten())
        .map(|t| 10.0 * t.max(0.0))
        .collect();
    assert!(
        (simulated[50], simulated.len()) == (0.0, 1000) && (simulated[510] - 0.105).abs() < 1e-9
    );
    assert!(data.notes.iter().any(|note| note.starts_with("2 passes")));
}

#[test]
fn one_pass_is_all_of_the_data() {
    let data = measured(&table(400), &mapping()).unwrap();
    assert_eq!(
        (data.passes().len(), data.passes()[0].samples.clone()),
        (1, 0..400)
    );
    assert_eq!(data.process_time_s(), data.time_s);
}

/// Those of the machine count, from the start of the data and of each pass. What is said in times
/// of the file stays.
#[test]
fn times_of_a_clock_that_is_off_become_those_of_the_machine() {
    let mut mapping = mapping();
    mapping.starts_s = vec![0.1, 0.5];
    mapping.window_s = [0.05, 0.95];
    let own = measured(&table(1000), &mapping).unwrap();
    mapping.clock_rate = 0.99;
    let told = measured(&table(1000), &mapping).unwrap();
    assert_eq!(told.channels, own.channels);
    let samples = |data: &Measured| -> Vec<_> {
        let passes = data.passes().into_iter();
        passes.map(|pass| pass.samples).collect()
    };
    assert_eq!(samples(&told), samples(&own));
    let times = told.process_time_s().into_iter().zip(own.process_time_s());
    for (row, (machine_s, file_s)) in times.enumerate() {
        assert!((machine_s - 0.99 * file_s).abs() < 1e-12, "{row}");
    }
    assert!((told.rate_hz() * 0.99 / own.rate_hz() - 1.0).abs() < 1e-12);
}

#[test]
fn a_pass_without_samples_is_refused() {
    let mut mapping = mapping();
    mapping.starts_s = vec![0.0, 0.98];
    let expected = "the pass that starts at 0.98 s has 20 samples, but at least 60 are needed";
    assert!(refusal(&table(1000), &mapping).contains(expected));
}
