//! Arguments of `part`.

use std::path::PathBuf;

use clap::Args;

use super::number::{above_zero, number};

#[derive(Debug, Args)]
pub struct PartArguments {
    /// Mesh of the part: .stl (binary or ASCII), .obj or .ply; or a body, .step
    pub file: PathBuf,
    /// Unit of the file's lengths
    #[arg(long, value_parser = ["mm", "inch", "m"], default_value = "mm")]
    pub unit: String,
    /// Triangles that turn by this or more from one to the next belong to two faces
    #[arg(long, value_name = "DEG", value_parser = angle, default_value = "30")]
    pub crease_deg: f64,
    /// Vertices this close count as one [default: a millionth of the part's diagonal]
    #[arg(long, value_name = "MM", value_parser = not_negative, allow_negative_numbers = true)]
    pub weld_mm: Option<f64>,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
    /// Folder for outputs; the part gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

impl PartArguments {
    pub fn unit_m(&self) -> f64 {
        match self.unit.as_str() {
            "inch" => 0.0254,
            "m" => 1.0,
            _ => 1e-3,
        }
    }
}

/// An angle between 0 and 180 degrees.
fn angle(text: &str) -> Result<f64, String> {
    let deg = above_zero(text)?;
    number(text, |deg| deg < 180.0, "must be below 180").map(|_| deg)
}

fn not_negative(text: &str) -> Result<f64, String> {
    number(text, |value| value >= 0.0, "must be a number from 0 on")
}
