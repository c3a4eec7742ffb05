//! Logs of robots: MCAP files with ROS 2 messages, one table a topic.
//!
//! The file's own definitions of its messages (`ros2msg`) say what is in them; where a file has
//! none, as bags of older recorders, those of five common types are built in. Messages are in CDR,
//! the encoding of DDS (OMG formal/2002-06-51, 15.3), in either byte order.

mod definitions;
mod file;
mod layout;
mod message;
mod record;
mod topic;

use std::collections::HashMap;
use std::path::Path;

use mcap::records::Record;
use truecut_recording::measured::Tables;

use crate::error::Reason;
use layout::Layout;
use topic::Topic;

/// The only encoding of messages that ROS 2 has.
const CDR: &str = "cdr";

/// Reads the topics of an MCAP file.
pub(crate) fn read(path: &Path) -> Result<Tables, Reason> {
    let mut log = Log::default();
    file::records(path, |record| log.take(record))?;
    log.finish()
}

/// What has been read so far.
#[derive(Default)]
struct Log {
    /// By their numbers in the file.
    schemas: HashMap<u16, Schema>,
    /// Topic of each channel, by the channel's number: its place in `topics` or `unread`.
    channels: HashMap<u16, Option<usize>>,
    topics: Vec<Topic>,
    unread: Vec<(String, String)>,
}

struct Schema {
    name: String,
    encoding: String,
    text: String,
}

impl Log {
    fn take(&mut self, record: Record) -> Result<(), Reason> {
        match record {
            Record::Schema { header, data } => {
                let schema = Schema {
                    name: header.name,
                    encoding: header.encoding,
                    text: String::from_utf8_lossy(&data).into_owned(),
                };
                self.schemas.insert(header.id, schema);
            }
            Record::Channel(channel) if !self.channels.contains_key(&channel.id) => {
                let place = self.place(&channel);
                self.channels.insert(channel.id, place);
            }
            Record::Message { header, data } => {
                let Some(place) = self.channels.get(&header.channel_id) else {
                    let number = header.channel_id;
                    let text = format!("a message is of channel {number}, which is not there");
                    return Err(Reason::Damaged(text));
                };
                if let Some(place) = *place {
                    self.topics[place].take(header.log_time, &data)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Where messages of a channel go. Several senders of one topic have a channel each.
    fn place(&mut self, channel: &mcap::records::Channel) -> Option<usize> {
        let schema = self.schemas.get(&channel.schema_id);
        let kind = schema.map_or("", |schema| schema.name.as_str()).to_owned();
        let same = |one: &Topic| one.name == channel.topic && one.kind == kind;
        if let Some(place) = self.topics.iter().position(same) {
            return Some(place);
        }
        match layout_of(&channel.message_encoding, schema) {
            Ok(layout) => {
                self.topics
                    .push(Topic::new(channel.topic.clone(), kind, layout));
                Some(self.topics.len() - 1)
            }
            Err(why) => {
                let told = (channel.topic.clone(), why);
                if !self.unread.contains(&told) {
                    self.unread.push(told);
                }
                None
            }
        }
    }

    fn finish(self) -> Result<Tables, Reason> {
        let heard: Vec<Topic> = self
            .topics
            .into_iter()
            .filter(|one| one.rows() > 0)
            .collect();
        let first = heard.iter().filter_map(Topic::first_ns).min();
        let Some(origin_ns) = first else {
            let unread = self
                .unread
                .iter()
                .map(|(topic, why)| format!("{topic} ({why})"));
            let unread: Vec<String> = unread.collect();
            return Err(Reason::Log(match &unread[..] {
                [] => "there is no message in it".to_owned(),
                unread => format!("no topic can be read: {}", unread.join("; ")),
            }));
        };
        Ok(Tables {
            source: String::new(),
            tables: heard
                .into_iter()
                .map(|topic| topic.table(origin_ns))
                .collect(),
            unread: self.unread,
        })
    }
}

/// How the messages of a channel lie in memory; else why they cannot be read.
fn layout_of(encoding: &str, schema: Option<&Schema>) -> Result<Layout, String> {
    let kind = schema.map_or("", |schema| schema.name.as_str());
    if encoding != CDR {
        return Err(format!(
            "its messages are encoded as \"{encoding}\", not as \"{CDR}\""
        ));
    }
    let own =
        schema.filter(|schema| schema.encoding == "ros2msg" && !schema.text.trim().is_empty());
    match own {
        Some(schema) => Layout::of(kind, &schema.text),
        None => match definitions::of(kind) {
            Some(text) => Layout::of(kind, text),
            None => Err(format!(
                "its type \"{kind}\" is not known, and the file does not define it as ros2msg; \
                 known without are {}",
                definitions::names().join(", ")
            )),
        },
    }
}
