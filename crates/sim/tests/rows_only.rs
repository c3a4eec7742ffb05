//! A run that keeps rows alone: it does less, and its rows are those of the recording to the last bit.

mod support;

use support::{chamfer, polish, run, wheel};
use truecut_sim::{Engine, Robots, simulate};

#[test]
fn rows_are_those_of_the_recording() {
    for scenario in [chamfer(2, 0.3), wheel(), polish()] {
        let recording = run(&scenario, &[]);
        let rows = simulate(&scenario, None, &Robots::default(), Engine::Rapier, &[])
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
