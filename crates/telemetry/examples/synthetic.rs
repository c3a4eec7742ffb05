//! Writes a made-up run into a folder, to look at and to see what recording costs:
//!
//! ```sh
//! cargo run --release -p truecut-telemetry --example synthetic -- out/synthetic [CASE]
//! ```
//!
//! CASE is a part of the name of one of the cases below.

#[path = "../tests/recordings/synthetic/mod.rs"]
mod synthetic;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use truecut_recording::{Chunk, ClaimResult, Header, Recording, Sink, SinkError};
use truecut_telemetry::{Background, IpcSink, ParquetSink, RrdSink};

/// What a step of a real run costs.
const STEP_COST: Duration = Duration::from_micros(10);

/// Keeps the processor busy, as a simulation does.
fn busy(time: Duration) {
    let start = Instant::now();
    while start.elapsed() < time {
        std::hint::spin_loop();
    }
}

/// Tells how long a sink takes.
struct Timed<S> {
    sink: S,
    begin_s: f64,
    chunks_s: f64,
}

impl<S: Sink> Sink for Timed<S> {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        let start = Instant::now();
        let result = self.sink.begin(header);
        self.begin_s = start.elapsed().as_secs_f64();
        result
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        let start = Instant::now();
        let result = self.sink.chunk(chunk);
        self.chunks_s += start.elapsed().as_secs_f64();
        result
    }

    fn finish(&mut self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), SinkError> {
        let start = Instant::now();
        let result = self.sink.finish(recording, claims);
        let ms = |seconds: f64| 1e3 * seconds;
        println!(
            "    begin {:.1} ms, chunks {:.1} ms, finish {:.1} ms",
            ms(self.begin_s),
            ms(self.chunks_s),
            ms(start.elapsed().as_secs_f64())
        );
        result
    }
}

fn timed(sink: impl Sink + Send + 'static) -> Box<dyn Sink + Send> {
    Box::new(Timed {
        sink,
        begin_s: 0.0,
        chunks_s: 0.0,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(
        std::env::args()
            .nth(1)
            .unwrap_or_else(|| "out/synthetic".to_owned()),
    );
    std::fs::create_dir_all(&folder)?;
    let rrd = || RrdSink::new(folder.join("recording.rrd"));
    let ipc = || IpcSink::new(folder.join("recording.arrows"));
    let parquet = || ParquetSink::new(folder.join("recording.parquet"));
    let all: Vec<Box<dyn Sink + Send>> = vec![timed(rrd()), timed(ipc()), timed(parquet())];
    let cases: Vec<(&str, Vec<Box<dyn Sink + Send>>)> = vec![
        ("no sink", Vec::new()),
        (".arrows", vec![timed(ipc())]),
        (".rrd", vec![timed(rrd())]),
        (".parquet", vec![timed(parquet())]),
        (
            "all three in the background",
            vec![timed(Background::new(all))],
        ),
    ];
    let wanted = std::env::args().nth(2).unwrap_or_default();
    let (duration_s, step_s) = (4.4, 2.5e-4);
    for (name, sinks) in cases.into_iter().filter(|(name, _)| name.contains(&wanted)) {
        let start = Instant::now();
        synthetic::run(duration_s, step_s, sinks, || busy(STEP_COST))?;
        println!("{name}: {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    }
    println!(
        "{duration_s} s at {step_s} s a step, in {}",
        folder.display()
    );
    Ok(())
}
