//! A recording as an Arrow table, and back.
//!
//! One column per channel, named like it, of 64-bit floats without nulls, with `unit` and
//! `description` in the field's metadata; the first column is `time` in seconds. What else a
//! recording holds is in the schema's metadata: see the keys below. The 3-D scene is not kept: it
//! belongs to the `.rrd`.

use std::collections::HashMap;
use std::sync::Arc;

use arrow::array::{Array, ArrayRef, Float64Array, RecordBatch};
use arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use serde::{Deserialize, Serialize};
use truecut_recording::{ChannelSpec, Header, Outcome, Profile, Recording, Scalar, Unit};

/// Name of the time column.
const TIME: &str = "time";
/// Version of this layout.
const FORMAT: &str = "truecut.format";
/// The scenario's name.
const SCENARIO_NAME: &str = "truecut.scenario_name";
/// The scenario's text.
const SCENARIO_TEXT: &str = "truecut.scenario_text";
/// The notes, a JSON list of strings.
const NOTES: &str = "truecut.notes";
/// Outcome, scalars and profiles, a JSON object: [`Ending`].
pub(crate) const ENDING: &str = "truecut.ending";

/// What is known only after the last row.
#[derive(Serialize, Deserialize)]
pub(crate) struct Ending {
    pub(crate) outcome: Outcome,
    pub(crate) scalars: Vec<Scalar>,
    pub(crate) profiles: Vec<Profile>,
}

impl Ending {
    pub(crate) fn of(recording: &Recording) -> Ending {
        Ending {
            outcome: recording.outcome.clone(),
            scalars: recording.scalars.clone(),
            profiles: recording.profiles.clone(),
        }
    }

    /// One line of JSON. Map keys and floats are written the same way every time.
    pub(crate) fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self)
    }
}

/// The table's columns and metadata, without an ending.
pub(crate) fn schema(header: &Header) -> Schema {
    let field = |name: &str, unit: Unit, description: &str| {
        Field::new(name, DataType::Float64, false).with_metadata(HashMap::from([
            ("unit".to_owned(), unit.symbol().to_owned()),
            ("description".to_owned(), description.to_owned()),
        ]))
    };
    let time = field(TIME, Unit::Second, "simulated time");
    let channels = header
        .channels
        .iter()
        .map(|channel| field(&channel.name, channel.unit, &channel.description));
    let fields: Vec<Field> = std::iter::once(time).chain(channels).collect();
    let notes = serde_json::Value::from(header.notes.clone()).to_string();
    Schema::new(fields).with_metadata(HashMap::from([
        (FORMAT.to_owned(), "1".to_owned()),
        (SCENARIO_NAME.to_owned(), header.scenario_name.clone()),
        (SCENARIO_TEXT.to_owned(), header.scenario_text.clone()),
        (NOTES.to_owned(), notes),
    ]))
}

/// Rows as one batch.
pub(crate) fn batch<'a>(
    schema: &SchemaRef,
    time_s: &'a [f64],
    columns: impl Iterator<Item = &'a [f64]>,
) -> Result<RecordBatch, arrow::error::ArrowError> {
    let array = |values: &[f64]| Arc::new(Float64Array::from(values.to_vec())) as ArrayRef;
    let arrays = std::iter::once(time_s).chain(columns).map(array).collect();
    RecordBatch::try_new(Arc::clone(schema), arrays)
}

/// A recording's rows as one Arrow table: `time` in s, then one column a channel, 64-bit floats in
/// SI without nulls, `unit` and `description` in the metadata of each field.
///
/// # Errors
/// None of a recording whose columns are of one length.
pub fn record_batch(recording: &Recording) -> Result<RecordBatch, arrow::error::ArrowError> {
    let schema = Arc::new(schema(&recording.header));
    let columns = recording.columns.iter().map(Vec::as_slice);
    batch(&schema, &recording.time_s, columns)
}

/// What the schema says of a recording; its rows are still missing.
pub(crate) fn recording_from_schema(schema: &Schema) -> Result<Recording, String> {
    let text = |key: &str| schema.metadata.get(key).cloned().unwrap_or_default();
    let mut fields = schema.fields().iter();
    match fields.next() {
        Some(first) if first.name() == TIME => {}
        _ => return Err(format!("the first column must be \"{TIME}\"")),
    }
    let channels: Vec<ChannelSpec> = fields
        .map(|field| channel(field))
        .collect::<Result<_, _>>()?;
    let ending = match schema.metadata.get(ENDING) {
        Some(json) => ending_from_json(json)?,
        None => Ending {
            outcome: Outcome::Completed,
            scalars: Vec::new(),
            profiles: Vec::new(),
        },
    };
    let notes = match schema.metadata.get(NOTES) {
        Some(json) => {
            serde_json::from_str(json).map_err(|error| format!("metadata {NOTES}: {error}"))?
        }
        None => Vec::new(),
    };
    let header = Header {
        scenario_name: text(SCENARIO_NAME),
        scenario_text: text(SCENARIO_TEXT),
        channels,
        notes,
        ..Header::default()
    };
    let columns = vec![Vec::new(); header.channels.len()];
    let Ending {
        outcome,
        scalars,
        profiles,
    } = ending;
    Ok(Recording {
        header,
        time_s: Vec::new(),
        columns,
        profiles,
        scalars,
        outcome,
    })
}

fn channel(field: &Field) -> Result<ChannelSpec, String> {
    let name = field.name();
    if field.data_type() != &DataType::Float64 {
        return Err(format!(
            "column \"{name}\" holds {}, not 64-bit floats",
            field.data_type()
        ));
    }
    let unit = field
        .metadata()
        .get("unit")
        .ok_or_else(|| format!("column \"{name}\" has no unit"))?;
    let unit = unit
        .parse()
        .map_err(|error| format!("column \"{name}\": {error}"))?;
    let description = field
        .metadata()
        .get("description")
        .cloned()
        .unwrap_or_default();
    Ok(ChannelSpec {
        name: name.clone(),
        unit,
        description,
    })
}

/// Reads what [`Ending::to_json`] wrote.
pub(crate) fn ending_from_json(json: &str) -> Result<Ending, String> {
    serde_json::from_str(json).map_err(|error| format!("metadata {ENDING}: {error}"))
}

/// Appends a batch's rows.
pub(crate) fn append(recording: &mut Recording, batch: &RecordBatch) -> Result<(), String> {
    let targets = std::iter::once(&mut recording.time_s).chain(&mut recording.columns);
    for ((target, array), field) in targets
        .zip(batch.columns())
        .zip(batch.schema_ref().fields())
    {
        let values = array.as_any().downcast_ref::<Float64Array>();
        let values = values
            .ok_or_else(|| format!("column \"{}\" does not hold 64-bit floats", field.name()))?;
        if values.null_count() > 0 {
            return Err(format!("column \"{}\" has gaps", field.name()));
        }
        target.extend_from_slice(values.values());
    }
    Ok(())
}
