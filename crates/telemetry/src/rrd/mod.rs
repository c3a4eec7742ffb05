//! Recordings for the rerun viewer, `.rrd`.

mod before_after;
mod blueprint;
mod camera;
mod chart;
mod charts;
mod field;
mod layout;
mod outline;
mod part;
mod plan;
mod results;
mod scene;
mod seen;
mod series;
mod shapes;
mod store;
mod surface;
mod verdict;

use std::ops::Range;
use std::path::{Path, PathBuf};

use re_chunk::TimeColumn;
use re_log_types::ApplicationId;
use re_log_types::Timeline;
use re_sdk_types::archetypes::TextDocument;
use truecut_files::{fresh, write_whole};
use truecut_recording::{Chunk, ClaimResult, Header, Recording, Sink, SinkError};

use crate::display::{Group, groups};
use crate::error::failed;
pub use before_after::{BeforeAfter, ChannelBeforeAfter, write_before_after};
pub use chart::{Chart, Curve, CurveStyle};
pub use charts::{ChartPage, write_charts};
use layout::AtEnd;
pub use part::{FaceShown, PartShown, write_part};
pub use plan::{PlanShown, PlanStation, write_plan};
use scene::SceneLogger;
use seen::Seen;
use series::FootState;
use store::{Failure, Logged, Store};

/// The one time axis, in seconds.
const TIMELINE: &str = "time";
/// Above everything that has a place in space.
const SCENE: &str = "/scene";

/// Streams a run into a file for the rerun viewer (0.36): the scene in 3-D, curves, states, and at
/// the end spectra, profiles and claims, with a layout that shows them. Every chunk is with the
/// operating system when [`Sink::chunk`] returns, so that killing the program loses nothing of it.
pub struct RrdSink {
    path: PathBuf,
    open: Option<OpenRecording>,
}

struct OpenRecording {
    path: PathBuf,
    stream: Store,
    /// Messages that hold until the end is known: a word in place of the claims, a first layout.
    until_end: Range<usize>,
    header: Header,
    groups: Vec<Group>,
    seen: Seen,
    scene: SceneLogger,
    foot: Option<FootState>,
}

impl RrdSink {
    /// A sink for a file, which is made (or overwritten) when the run begins.
    pub fn new(path: impl Into<PathBuf>) -> RrdSink {
        RrdSink {
            path: path.into(),
            open: None,
        }
    }
}

impl Sink for RrdSink {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        self.open = Some(
            OpenRecording::begin(&self.path, header)
                .map_err(failed(&self.path, "begin the recording"))?,
        );
        Ok(())
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        let failed = failed(&self.path, "write rows");
        self.open
            .as_mut()
            .map_or(Ok(()), |open| open.chunk(chunk))
            .map_err(failed)
    }

    fn finish(&mut self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), SinkError> {
        let failed = failed(&self.path, "end the recording");
        self.open
            .take()
            .map_or(Ok(()), |open| open.finish(recording, claims))
            .map_err(failed)
    }
}

impl OpenRecording {
    fn begin(path: &Path, header: &Header) -> Result<OpenRecording, Failure> {
        let name = &header.scenario_name;
        let stream = Store::kept(fresh(path)?, application(name), name)?;
        let groups = groups(&header.channels);
        series::begin(&stream, &groups)?;
        let scene = SceneLogger::begin(&stream, &header.scene)?;
        let foot = FootState::begin(&stream, header)?;
        log_text(
            &stream,
            results::SCENARIO,
            results::scenario(&header.scenario_text),
        )?;
        let before = stream.count();
        log_text(&stream, verdict::CLAIMS, verdict::under_way(header))?;
        layout::send(&stream, header, &groups, foot.is_some(), None)?;
        Ok(OpenRecording {
            path: path.to_owned(),
            until_end: before..stream.count(),
            stream,
            seen: Seen::begin(header, &groups),
            header: header.clone(),
            groups,
            scene,
            foot,
        })
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), Failure> {
        if !chunk.time_s.is_empty() {
            series::chunk(&self.stream, &self.groups, chunk)?;
            self.seen.chunk(chunk);
            if let Some(foot) = &mut self.foot {
                foot.chunk(&self.stream, chunk)?;
            }
        }
        self.scene.frames(&self.stream, chunk.frames)
    }

    /// The end's word is put first, so that a viewer shows it while a large file still loads.
    fn finish(self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), Failure> {
        let stream = &self.stream;
        let last = stream.count();
        log_text(
            stream,
            verdict::CLAIMS,
            verdict::claims_table(recording, claims),
        )?;
        log_text(stream, results::ABOUT, results::about(recording))?;
        let times_s = &recording.time_s;
        let mut charts = results::log_spectra(stream, &self.groups, times_s, &self.seen)?;
        // After the first spectrum, that of the tool, if there is a line in it.
        let profiles = results::log_profiles(stream, &recording.profiles, &recording.scalars)?;
        let after_first = charts
            .iter()
            .take(1)
            .filter(|chart| !chart.says_little)
            .count();
        charts.splice(after_first..after_first, profiles);
        let at_end = AtEnd {
            charts: &charts,
            seen: &self.seen,
            time_s: [times_s.first(), times_s.last()].map(|t| t.copied().unwrap_or_default()),
        };
        layout::send(
            stream,
            &self.header,
            &self.groups,
            self.foot.is_some(),
            Some(&at_end),
        )?;
        self.scene.finish(stream)?;
        let (until_end, stream) = (self.until_end, self.stream);
        write_whole(&self.path, |file| {
            stream.finish_again(file.try_clone()?, &until_end, last)
        })
    }
}

/// Writes a viewer's file as a whole.
fn write_store(
    path: &Path,
    title: &str,
    log: impl FnOnce(&Store) -> Logged<()>,
) -> Result<(), Failure> {
    write_whole(path, |file| {
        let store = Store::file(file.try_clone()?, application(title), title)?;
        log(&store)?;
        store.finish()
    })
}

fn log_text(stream: &Store, entity: &str, markdown: String) -> Logged<()> {
    stream.log_static(entity, &TextDocument::from_markdown(markdown))
}

fn time_column(times_s: impl Iterator<Item = f64>) -> TimeColumn {
    let times: Vec<i64> = times_s.map(nanoseconds).collect();
    TimeColumn::new(None, Timeline::new_duration(TIMELINE), times.into())
}

fn nanoseconds(time_s: f64) -> i64 {
    (1e9 * time_s).round() as i64
}

/// The viewer keeps one layout for each application, so each scenario is one: two recordings opened
/// together then each keep their own.
fn application(scenario_name: &str) -> ApplicationId {
    let plain = |letter: char| {
        if letter.is_ascii_alphanumeric() {
            letter
        } else {
            '_'
        }
    };
    let name: String = scenario_name.chars().map(plain).take(100).collect();
    ApplicationId::new_or_unknown(format!("truecut_{name}"))
}
