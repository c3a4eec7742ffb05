//! A run that keeps rows alone: it does less, and its rows are those of the recording to the last
//! bit.

use crate::support::{chamfer, polish, run, wheel};
use truecut_sim::run::{Engine, Run};

#[test]
fn rows_are_those_of_the_recording() {
    for scenario in [chamfer(2, 0.3), wheel(), polish()] {
        let recording = run(&scenario, &[]);
        let rows = (Run::of(&scenario).rows(&[], None))
            .unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
        assert_eq!(rows.time_s, recording.time_s, "{}", scenario.name);
        assert!(!recording.scalars.is_empty(), "{}", scenario.name);
        for (channel, column) in rows.channels.iter().zip(&rows.columns) {
            let index = recording.header.index_of(&channel.name).expect("channel");
            assert_eq!(
                column, &recording.columns[index],
                "{}, {}",
                scenario.name, channel.name
            );
        }
    }
}

/// A run that ends early is the beginning of the whole one, to the bit, and goes a little further
/// than asked.
#[test]
fn a_run_that_ends_early_is_the_beginning_of_the_whole() {
    for scenario in [chamfer(2, 0.3), wheel(), polish()] {
        let reduced = Run {
            engine: Engine::REDUCED,
            ..Run::of(&scenario)
        };
        let run = |until_s| reduced.rows(&[], until_s);
        let whole = run(None).expect("runs");
        let until_s = 0.4 * whole.time_s[whole.time_s.len() - 1];
        let part = run(Some(until_s)).expect("runs");
        let count = part.time_s.len();
        assert!(part.time_s[count - 1] > until_s);
        assert!(count < whole.time_s.len() / 2, "{count}");
        assert_eq!(part.time_s, whole.time_s[..count]);
        for (part, whole) in part.columns.iter().zip(&whole.columns) {
            assert_eq!(*part, whole[..count]);
        }
    }
}
