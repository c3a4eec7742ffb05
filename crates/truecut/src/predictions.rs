//! Diagnoses that go on where they were stopped: each prediction is on the disk as soon as it is
//! made.

use std::collections::HashMap;
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{BufRead, BufReader, Error, ErrorKind, Read, Result, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use truecut_discrepancy::model::{
    Candidate, Columns, CurveCandidate, Experiment, Model, PredictError, SetUp,
};
use truecut_files::continued;
use truecut_recording::ChannelSpec;
use truecut_scenario::UncertainSpec;
use truecut_scenario::effect::{Effect, ParameterInfo};

/// What takes less than ten times as long to make as a disk takes to hold it (1e8 bytes/s) is not
/// worth its room there: a search is slower by a tenth at most.
const BYTES_PER_S: f64 = 1e7;
/// The file grows no further than this.
const MOST_BYTES: u64 = 1 << 30;

/// A model whose predictions are kept in a file, so that a search that was stopped, by whatever,
/// goes on where it was: asked the same again, the model answers from the file, to the bit. Only
/// what takes much longer to predict than to write is kept, up to 1 GiB.
///
/// A line that says of which search the file is, then for each prediction a line of JSON and its
/// values, eight bytes for each. What was torn by a kill is no prediction.
pub struct KeptModel<'a> {
    model: &'a dyn Model,
    stop: Option<&'a AtomicBool>,
    kept: HashMap<String, Entry>,
    file: Mutex<Journal>,
    made: AtomicUsize,
}

struct Journal {
    file: File,
    bytes: u64,
    /// Set when the disk takes no more: the search goes on without.
    is_closed: bool,
}

/// The line before the values of a prediction.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Head {
    asked: String,
    columns: usize,
    samples: usize,
    /// Of the values' bytes.
    digest: u64,
    /// Why the prediction failed, in place of values.
    error: Option<String>,
}

/// A prediction in the file.
struct Entry {
    head: Head,
    /// Where its values begin.
    at: u64,
}

impl Head {
    /// How many bytes of values follow; `None` of a head that is damaged.
    fn bytes(&self) -> Option<u64> {
        // Columns without samples would take no room in the file, and any in memory.
        if (self.columns == 0) != (self.samples == 0) {
            return None;
        }
        let values = self.columns.checked_mul(self.samples)?;
        (values as u64).checked_mul(8)
    }
}

impl<'a> KeptModel<'a> {
    /// A model with a file of predictions, taken over if `identity` is that of the file. Once
    /// `stop` is set every prediction fails, which ends a search soon.
    ///
    /// # Errors
    /// A file that cannot be made.
    pub fn new(
        model: &'a dyn Model,
        path: &Path,
        identity: &str,
        stop: Option<&'a AtomicBool>,
    ) -> Result<KeptModel<'a>> {
        let mut file = continued(path)?;
        let first = format!("truecut predictions {identity}\n");
        let (kept, whole) = entries(&file, &first).unwrap_or_default();
        // What is left of a torn prediction goes, or all of it if it is of another search.
        file.set_len(whole)?;
        file.seek(SeekFrom::End(0))?;
        let mut bytes = whole;
        if whole == 0 {
            file.write_all(first.as_bytes())?;
            bytes = first.len() as u64;
        }
        Ok(KeptModel {
            model,
            stop,
            made: kept.len().into(),
            kept,
            file: Mutex::new(Journal {
                file,
                bytes,
                is_closed: false,
            }),
        })
    }

    /// How many predictions an earlier search has left.
    pub fn kept(&self) -> usize {
        self.kept.len()
    }

    /// How many predictions are in the file.
    pub fn made(&self) -> usize {
        self.made.load(Ordering::Relaxed)
    }

    fn file(&self) -> MutexGuard<'_, Journal> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn answer(
        &self,
        asked: String,
        predict: impl FnOnce() -> std::result::Result<Columns, PredictError>,
    ) -> std::result::Result<Columns, PredictError> {
        if self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(PredictError("stopped from outside".to_owned()));
        }
        // What cannot be read, or is damaged, is made again.
        if let Some(entry) = self.kept.get(&asked)
            && let Ok(known) = self.file().read(entry)
        {
            return known;
        }
        let begun = Instant::now();
        let answer = predict();
        if self.file().append(asked, &answer, begun.elapsed()) {
            self.made.fetch_add(1, Ordering::Relaxed);
        }
        answer
    }
}

impl Journal {
    fn read(&mut self, entry: &Entry) -> Result<std::result::Result<Columns, PredictError>> {
        if let Some(error) = &entry.head.error {
            return Ok(Err(PredictError(error.clone())));
        }
        let count = entry.head.columns * entry.head.samples;
        let mut bytes = vec![0; 8 * count];
        self.file.seek(SeekFrom::Start(entry.at))?;
        self.file.read_exact(&mut bytes)?;
        if digest(&bytes) != entry.head.digest {
            return Err(Error::from(ErrorKind::InvalidData));
        }
        let (values, _) = bytes.as_chunks::<8>();
        let columns = (0..entry.head.columns).map(|column| {
            let first = column * entry.head.samples;
            let own = values[first..first + entry.head.samples].iter();
            own.map(|value| f64::from_le_bytes(*value)).collect()
        });
        Ok(Ok(columns.collect()))
    }

    /// Whether the prediction is in the file now.
    fn append(
        &mut self,
        asked: String,
        answer: &std::result::Result<Columns, PredictError>,
        took: Duration,
    ) -> bool {
        let none = Columns::new();
        let columns = answer.as_ref().unwrap_or(&none);
        let values: Vec<u8> = columns
            .iter()
            .flatten()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let head = Head {
            asked,
            columns: columns.len(),
            samples: columns.first().map_or(0, Vec::len),
            digest: digest(&values),
            error: answer.as_ref().err().map(ToString::to_string),
        };
        let is_even = columns.iter().all(|column| column.len() == head.samples);
        let Ok(line) = serde_json::to_string(&head) else {
            return false;
        };
        let bytes = (line.len() + 1 + values.len()) as u64;
        let is_cheap = took.as_secs_f64() * BYTES_PER_S < bytes as f64;
        if self.is_closed || is_cheap || !is_even || self.bytes + bytes > MOST_BYTES {
            return false;
        }
        // The file is open for appending: reading has not moved its end.
        let record = [line.as_bytes(), b"\n", &values].concat();
        let written = self.file.write_all(&record);
        self.is_closed = written.is_err();
        self.bytes += bytes;
        !self.is_closed
    }
}

fn digest(bytes: &[u8]) -> u64 {
    let mut digest = DefaultHasher::new();
    bytes.hash(&mut digest);
    digest.finish()
}

/// The predictions of a file by what was asked, and how many of its bytes they are. Nothing of a
/// file that begins otherwise.
fn entries(file: &File, first: &str) -> Result<(HashMap<String, Entry>, u64)> {
    let length = file.metadata()?.len();
    let mut reader = BufReader::new(file);
    reader.seek(SeekFrom::Start(0))?;
    let mut kept = HashMap::new();
    let mut line = Vec::new();
    // A line is short; of a damaged file it may be all of it.
    let mut next = |reader: &mut BufReader<&File>| -> Result<Vec<u8>> {
        line.clear();
        reader.by_ref().take(1 << 20).read_until(b'\n', &mut line)?;
        Ok(line.clone())
    };
    if next(&mut reader)? != first.as_bytes() {
        return Ok((kept, 0));
    }
    let mut whole = first.len() as u64;
    loop {
        let line = next(&mut reader)?;
        let Ok(head) = serde_json::from_slice::<Head>(&line) else {
            return Ok((kept, whole));
        };
        let at = whole + line.len() as u64;
        let end = head.bytes().and_then(|bytes| at.checked_add(bytes));
        let Some(end) = end.filter(|end| *end <= length) else {
            return Ok((kept, whole));
        };
        reader.seek_relative((end - at) as i64)?;
        whole = end;
        kept.insert(head.asked.clone(), Entry { head, at });
    }
}

impl Model for KeptModel<'_> {
    fn channels(&self) -> &[ChannelSpec] {
        self.model.channels()
    }

    fn nominal(&self) -> &[UncertainSpec] {
        self.model.nominal()
    }

    fn candidates(&self) -> Vec<Candidate> {
        self.model.candidates()
    }

    fn parameters(&self, candidate: &Candidate) -> Vec<ParameterInfo> {
        self.model.parameters(candidate)
    }

    fn additive(&self) -> Vec<usize> {
        self.model.additive()
    }

    fn curves(&self) -> Vec<CurveCandidate> {
        self.model.curves()
    }

    fn late(&self) -> Vec<usize> {
        self.model.late()
    }

    fn sizes_by_mode(&self, candidate: &Candidate, step_hz: f64) -> Vec<f64> {
        self.model.sizes_by_mode(candidate, step_hz)
    }

    fn slowest_mode_hz(&self) -> Option<f64> {
        self.model.slowest_mode_hz()
    }

    fn predict(
        &self,
        nominal: &[f64],
        effects: &[Effect],
    ) -> std::result::Result<Columns, PredictError> {
        // Numbers are written so that they are told apart to the last bit.
        let asked = format!("all {nominal:?} {effects:?}");
        self.answer(asked, || self.model.predict(nominal, effects))
    }

    fn predict_first(
        &self,
        samples: usize,
        nominal: &[f64],
        effects: &[Effect],
    ) -> std::result::Result<Columns, PredictError> {
        let asked = format!("first {samples} {nominal:?} {effects:?}");
        self.answer(asked, || {
            self.model.predict_first(samples, nominal, effects)
        })
    }

    fn may_be(&self, effects: &[Effect]) -> bool {
        self.model.may_be(effects)
    }

    fn is_steady(&self) -> bool {
        self.model.is_steady()
    }

    fn doubt(&self) -> Option<String> {
        self.model.doubt()
    }

    fn set_ups(&self) -> Vec<SetUp> {
        self.model.set_ups()
    }

    fn experiments(&self) -> Vec<Experiment> {
        self.model.experiments()
    }

    fn predict_experiment(
        &self,
        experiment: &Experiment,
        nominal: &[f64],
        effects: &[Effect],
    ) -> std::result::Result<Columns, PredictError> {
        let asked = format!("{experiment:?} {nominal:?} {effects:?}");
        self.answer(asked, || {
            (self.model).predict_experiment(experiment, nominal, effects)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_no_memory_for_columns_without_samples() {
        let head = |columns, samples| Head {
            asked: String::new(),
            columns,
            samples,
            digest: 0,
            error: None,
        };
        assert_eq!(head(3, 5).bytes(), Some(120));
        assert_eq!(head(0, 0).bytes(), Some(0));
        assert_eq!(head(1 << 60, 0).bytes(), None);
        assert_eq!(head(0, 1 << 60).bytes(), None);
        assert_eq!(head(1 << 40, 1 << 40).bytes(), None);
    }
}
