//! Stores of the viewer's file, written message by message.
//!
//! The library's recording stream does this as well, in a crate that brings clients, servers and
//! authentication. A file needs its types, chunks and encoder alone, which is a fifth fewer crates
//! to build.

use std::cell::RefCell;
use std::error::Error;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

use re_build_info::CrateVersion;
use re_chunk::{Chunk, ChunkComponents, ChunkId, ChunkResult, EntityPath, RowId, TimeColumn};
use re_log_encoding::{
    CachingApplicationIdInjector, Decodable, Encoder, EncodingOptions, StreamHeader, ToApplication,
};
use re_log_types::{
    ApplicationId, BlueprintActivationCommand, LogMsg, SetStoreInfo, StoreId, StoreInfo, StoreKind,
    StoreSource, TimeInt, TimePoint, Timeline,
};
use re_sdk_types::archetypes::RecordingInfo;
use re_sdk_types::components::Timestamp;
use re_sdk_types::{AsComponents, SerializedComponentColumn};

/// Describing, encoding and writing fail in ways of their own.
pub(super) type Failure = Box<dyn Error + Send + Sync>;
/// What writing into a store yields.
pub(super) type Logged<T> = Result<T, Failure>;

/// Messages that say what a recording is: its store, and its properties.
const OPENING: usize = 2;

/// A store and where its messages go.
pub(super) struct Store {
    id: StoreId,
    /// At which rows are logged that are not static.
    now: TimePoint,
    target: RefCell<Target>,
    /// What has been sent, for a file that is put into another order at its end.
    kept: RefCell<Option<Vec<Kept>>>,
}

enum Target {
    File {
        encoder: Box<Encoder<File>>,
        /// Bytes written.
        bytes: u64,
        /// Whether what was written can be read.
        is_read: bool,
    },
    Memory(Vec<LogMsg>),
}

/// A message that is written again.
enum Kept {
    Here(Box<LogMsg>),
    /// In the file, from this byte on, so many bytes: rows, which would take memory as they do.
    Written(u64, u64),
}

impl Store {
    /// The recording of a file. Every message is with the operating system once it is logged.
    pub(super) fn file(file: File, application: ApplicationId, name: &str) -> Logged<Store> {
        Store::recording(file, application, name, false)
    }

    /// The same, of which what comes last can be put first: see [`Store::finish_again`].
    pub(super) fn kept(file: File, application: ApplicationId, name: &str) -> Logged<Store> {
        Store::recording(file, application, name, true)
    }

    fn recording(
        file: File,
        application: ApplicationId,
        name: &str,
        is_kept: bool,
    ) -> Logged<Store> {
        let is_read = file.metadata()?.is_file();
        let mut encoder = Box::new(encoder(file)?);
        if is_kept {
            // The file that is written again has one.
            encoder.do_not_emit_footer();
        }
        let target = Target::File {
            encoder,
            bytes: StreamHeader::ENCODED_SIZE_BYTES as u64,
            is_read,
        };
        let kept = is_kept.then(Vec::new);
        let store = Store::begin(StoreKind::Recording, application, target, kept)?;
        let about = RecordingInfo::new()
            .with_start_time(Timestamp::now())
            .with_name(name);
        store.log_static(EntityPath::properties(), &about)?;
        Ok(store)
    }

    /// A layout, of which the viewer reads what stands at the first of its times.
    pub(super) fn layout(application: ApplicationId) -> Logged<Store> {
        let target = Target::Memory(Vec::new());
        let mut store = Store::begin(StoreKind::Blueprint, application, target, None)?;
        let timeline = Timeline::new_sequence("blueprint");
        store.now.insert(timeline, TimeInt::ZERO);
        Ok(store)
    }

    fn begin(
        kind: StoreKind,
        application: ApplicationId,
        target: Target,
        kept: Option<Vec<Kept>>,
    ) -> Logged<Store> {
        let id = StoreId::random(kind, application);
        let info = StoreInfo::new(id.clone(), StoreSource::Other("truecut".to_owned()));
        let store = Store {
            id,
            now: TimePoint::default(),
            target: RefCell::new(target),
            kept: RefCell::new(kept),
        };
        let opening = LogMsg::SetStoreInfo(SetStoreInfo {
            row_id: *RowId::new(),
            info,
        });
        store.send(opening, false)?;
        Ok(store)
    }

    /// Logs what holds at all times.
    pub(super) fn log_static(
        &self,
        entity: impl Into<EntityPath>,
        what: &(impl AsComponents + ?Sized),
    ) -> Logged<()> {
        self.row(entity.into(), TimePoint::default(), what)
    }

    /// Logs what holds from the store's present time on.
    pub(super) fn log(
        &self,
        entity: impl Into<EntityPath>,
        what: &(impl AsComponents + ?Sized),
    ) -> Logged<()> {
        self.row(entity.into(), self.now.clone(), what)
    }

    fn row(
        &self,
        entity: EntityPath,
        at: TimePoint,
        what: &(impl AsComponents + ?Sized),
    ) -> Logged<()> {
        let batches = what.as_serialized_batches();
        if batches.is_empty() {
            return Ok(());
        }
        let chunk = Chunk::builder(entity).with_serialized_batches(RowId::new(), at, batches);
        self.chunk(chunk.build(), false)
    }

    /// Logs columns over times.
    pub(super) fn send_columns(
        &self,
        entity: impl Into<EntityPath>,
        times: impl IntoIterator<Item = TimeColumn>,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Logged<()> {
        let times = times.into_iter();
        let columns = columns.into_iter();
        let components: ChunkComponents = columns
            .map(|column| (column.descriptor, column.list_array))
            .collect();
        let times = times.map(|column| (*column.timeline().name(), column));
        let (id, times) = (ChunkId::new(), times.collect());
        let chunk = Chunk::from_auto_row_ids(id, entity.into(), times, components);
        self.chunk(chunk, true)
    }

    /// Takes over a layout as the one that is shown.
    pub(super) fn show(&self, layout: Store) -> Logged<()> {
        // Activated once it is there as a whole.
        let activate = BlueprintActivationCommand::make_active(layout.id);
        if let Target::Memory(messages) = layout.target.into_inner() {
            messages
                .into_iter()
                .try_for_each(|message| self.send(message, false))?;
        }
        self.send(activate.into(), false)
    }

    /// Writes what the file's readers find their way by.
    pub(super) fn finish(self) -> Logged<()> {
        match self.target.into_inner() {
            Target::File { mut encoder, .. } => Ok(encoder.finish()?),
            Target::Memory(_) => Ok(()),
        }
    }

    /// How many messages are there.
    pub(super) fn count(&self) -> usize {
        self.kept.borrow().as_ref().map_or(0, Vec::len)
    }

    /// Writes the file anew: what the store is, then all from the message `last` on, then the rest
    /// but for `superseded`, which `last` says anew. A viewer shows a file while it loads, and so
    /// has the end's word from the first moment on.
    pub(super) fn finish_again(
        self,
        file: File,
        superseded: &Range<usize>,
        last: usize,
    ) -> Logged<()> {
        let messages = self.kept.into_inner().unwrap_or_default();
        let mut written = match self.target.into_inner() {
            Target::File { encoder, .. } => encoder.into_inner()?,
            Target::Memory(_) => return Ok(()),
        };
        let mut encoder = encoder(file)?;
        let opening = 0..OPENING;
        let order = opening.chain(last..messages.len()).chain(OPENING..last);
        for at in order.filter(|at| !superseded.contains(at)) {
            match &messages[at] {
                Kept::Here(message) => encoder.append(message)?,
                Kept::Written(from, bytes) => {
                    encoder.append(&read_again(&mut written, *from, *bytes)?)?
                }
            };
        }
        Ok(encoder.finish()?)
    }

    fn chunk(&self, chunk: ChunkResult<Chunk>, is_rows: bool) -> Logged<()> {
        let message = chunk?.to_arrow_msg()?;
        self.send(LogMsg::ArrowMsg(self.id.clone(), message), is_rows)
    }

    fn send(&self, message: LogMsg, is_rows: bool) -> Logged<()> {
        let mut from = None;
        match &mut *self.target.borrow_mut() {
            Target::File {
                encoder,
                bytes,
                is_read,
            } => {
                let more = encoder.append(&message)?;
                from = (is_rows && *is_read).then_some((*bytes, more));
                *bytes += more;
            }
            Target::Memory(messages) => messages.push(message.clone()),
        }
        if let Some(kept) = &mut *self.kept.borrow_mut() {
            kept.push(match from {
                Some((from, bytes)) => Kept::Written(from, bytes),
                None => Kept::Here(Box::new(message)),
            });
        }
        Ok(())
    }
}

/// A message of a file that is being written.
fn read_again(file: &mut File, from: u64, bytes: u64) -> Logged<LogMsg> {
    let mut message = vec![0; usize::try_from(bytes)?];
    file.seek(SeekFrom::Start(from))?;
    file.read_exact(&mut message)?;
    let message: Option<_> = Decodable::from_rrd_bytes(&message)?;
    let message = message.ok_or("the file ends before its last message")?;
    let mut ids = CachingApplicationIdInjector::default();
    Ok(message.to_application((&mut ids, None))?)
}

fn encoder(file: File) -> Logged<Encoder<File>> {
    let options = EncodingOptions::PROTOBUF_COMPRESSED;
    Ok(Encoder::new_eager(CrateVersion::LOCAL, options, file)?)
}
