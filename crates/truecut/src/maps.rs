//! What a process left on a face as files of its own: a table and a mesh with values.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use truecut_recording::{Chunk, ClaimResult, Field, Header, Recording, Sink, SinkError};
use truecut_telemetry::{Column, write_columns};

use crate::outputs::write_file;

/// The map as a table with units in its first line, as a Parquet table, and as a mesh.
pub(crate) const MAP_TEXT: &str = "map.csv";
pub(crate) const MAP_TABLE: &str = "map.parquet";
pub(crate) const MAP_MESH: &str = "map.ply";

/// Keeps the last values of the face that a run shows, and writes them at its end. Places are
/// those of the cells' middles in the world, m in tables, mm in the mesh.
#[derive(Debug)]
pub(crate) struct MapSink {
    files: [PathBuf; 3],
    field: Option<Field>,
    scenario: String,
    values: Vec<f32>,
}

impl MapSink {
    /// Writes to a folder in which the names of maps are given.
    pub fn new(file: impl Fn(&str) -> PathBuf) -> Self {
        Self {
            files: [MAP_TEXT, MAP_TABLE, MAP_MESH].map(file),
            field: None,
            scenario: String::new(),
            values: Vec::new(),
        }
    }

    fn write(&self, field: &Field) -> Result<(), SinkError> {
        let name = field.name().to_owned();
        let places = field.places_m();
        let values: Vec<f64> = self.values.iter().map(|value| f64::from(*value)).collect();
        let [text, table, mesh] = &self.files;
        let bytes = csv(&name, field, &places, &values);
        let bytes = bytes.map_err(|error| failed(text, error))?;
        write_file(text, &bytes).map_err(|error| failed(text, error))?;
        let axis = |k: usize| places.iter().map(|place| place[k]).collect();
        let unit = field.unit.symbol();
        let columns = [
            Column::numbers("x", "m", axis(0)),
            Column::numbers("y", "m", axis(1)),
            Column::numbers("z", "m", axis(2)),
            Column::numbers(&name, unit, values.clone()),
        ];
        write_columns(table, &columns, &self.scenario).map_err(|error| failed(table, error))?;
        let ply = ply(&name, field, &places, &values);
        write_file(mesh, ply.as_bytes()).map_err(|error| failed(mesh, error))
    }
}

impl Sink for MapSink {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        self.field = header.scene.fields.first().cloned();
        self.scenario.clone_from(&header.scenario_text);
        Ok(())
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        let shown = chunk.frames.iter().rev();
        let mut values = shown.filter_map(|frame| frame.fields.first());
        if let Some(last) = values.find(|values| !values.is_empty()) {
            self.values.clone_from(last);
        }
        Ok(())
    }

    fn finish(&mut self, _: &Recording, _: &[ClaimResult]) -> Result<(), SinkError> {
        match &self.field {
            Some(field) if !self.values.is_empty() => self.write(field),
            _ => Ok(()),
        }
    }
}

fn failed(path: &Path, error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> SinkError {
    SinkError::new(path.display().to_string(), "write", error)
}

fn csv(
    name: &str,
    field: &Field,
    places: &[[f64; 3]],
    values: &[f64],
) -> Result<Vec<u8>, Box<dyn std::error::Error + Send + Sync>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let own = match field.unit.symbol() {
        "" | "1" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    };
    let heads = ["column", "row", "x (m)", "y (m)", "z (m)"].map(str::to_owned);
    out.write_record(heads.into_iter().chain([own]))?;
    let columns = field.cells[0].max(1);
    for (k, (place, value)) in places.iter().zip(values).enumerate() {
        let at = [k % columns, k / columns].map(|n| n.to_string());
        let place = place.map(|m| format!("{m:.7}"));
        // What is not there (a cell off the face) is an empty cell.
        let value = if value.is_finite() {
            format!("{value:e}")
        } else {
            String::new()
        };
        out.write_record(at.into_iter().chain(place).chain([value]))?;
    }
    Ok(out.into_inner().map_err(csv::IntoInnerError::into_error)?)
}

/// ASCII PLY, mm: cells as vertices with their value, between them triangles where all corners have
/// one.
fn ply(name: &str, field: &Field, places: &[[f64; 3]], values: &[f64]) -> String {
    let [columns, rows] = field.cells;
    let mut triangles = Vec::new();
    for row in 1..rows {
        for column in 1..columns {
            let corner = row * columns + column;
            let [a, b, c, d] = [corner - columns - 1, corner - columns, corner, corner - 1];
            for triangle in [[a, b, c], [a, c, d]] {
                let is_there = |k: &usize| values.get(*k).is_some_and(|value| value.is_finite());
                if triangle.iter().all(is_there) {
                    triangles.push(triangle);
                }
            }
        }
    }
    let unit = match field.unit.symbol() {
        "" => "1",
        unit => unit,
    };
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment x, y, z in mm, world; {name} in {unit}\nelement vertex {}\n\
         property double x\nproperty double y\nproperty double z\nproperty double {name}\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        places.len(),
        triangles.len()
    );
    for ([x, y, z], value) in places.iter().map(|p| p.map(|m| m * 1e3)).zip(values) {
        let value = if value.is_finite() { *value } else { 0.0 };
        let _ = writeln!(text, "{x:.5} {y:.5} {z:.5} {value:e}");
    }
    for [a, b, c] in triangles {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::{Frame, Outcome, Pose, Unit};

    /// A field of 3 by 2 cells, turned by 90° about z and moved.
    fn field() -> Field {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        Field {
            path: "removed_depth".to_owned(),
            world_from_field: Pose {
                translation_m: [1.0, 2.0, 3.0],
                rotation_xyzw: [0.0, 0.0, half, half],
            },
            size_m: [0.3, 0.2],
            cells: [3, 2],
            full_scale: 1e-5,
            unit: Unit::Metre,
            vertices_m: Vec::new(),
        }
    }

    #[test]
    fn the_last_values_of_a_face_are_written_at_their_places() {
        let folder = tempfile::tempdir().unwrap();
        let mut sink = MapSink::new(|name| folder.path().join(name));
        let mut header = Header::default();
        header.scene.fields = vec![field()];
        sink.begin(&header).unwrap();
        let frame = |time_s: f64, values: Vec<f32>| Frame {
            time_s,
            poses: Vec::new(),
            arrows: Vec::new(),
            fields: vec![values],
        };
        let last: Vec<f32> = vec![1e-6, 2e-6, 3e-6, 4e-6, 5e-6, f32::NAN];
        let frames = [
            frame(0.0, vec![0.0; 6]),
            frame(1.0, last),
            frame(2.0, Vec::new()),
        ];
        let chunk = Chunk {
            time_s: &[0.0, 1.0, 2.0],
            columns: Vec::new(),
            frames: &frames,
        };
        sink.chunk(&chunk).unwrap();
        let recording = Recording {
            header,
            time_s: Vec::new(),
            columns: Vec::new(),
            profiles: Vec::new(),
            scalars: Vec::new(),
            outcome: Outcome::Completed,
        };
        sink.finish(&recording, &[]).unwrap();
        let text = std::fs::read_to_string(folder.path().join(MAP_TEXT)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "column,row,x (m),y (m),z (m),removed_depth (m)");
        // The middle of the first cell, (0.05, 0.05), turned by 90°: (-0.05, 0.05).
        assert!(
            lines[1].starts_with("0,0,0.9500000,2.0500000,3.0000000,"),
            "{}",
            lines[1]
        );
        assert!(lines[6].starts_with("2,1,0.8500000,2.2500000,") && lines[6].ends_with(','));
        let mesh = std::fs::read_to_string(folder.path().join(MAP_MESH)).unwrap();
        // Four triangles, but those at the cell that has no value.
        assert!(
            mesh.contains("element vertex 6") && mesh.contains("element face 2"),
            "{mesh}"
        );
        let table = truecut_telemetry::read_table(&folder.path().join(MAP_TABLE), true).unwrap();
        let depths = table.column("removed_depth").unwrap();
        assert!((depths[4] - 5e-6).abs() < 1e-12 && depths[5].is_nan());
        let y = table.column("y").unwrap();
        assert!((y[1] - 2.15).abs() < 1e-12);
    }
}
