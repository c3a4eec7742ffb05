//! Files that an identification writes.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use truecut_discrepancy::identify::modes::ModesReport;
use truecut_discrepancy::identify::stiffness::{JointStiffness, StiffnessReport};
use truecut_discrepancy::identify::tool;
use truecut_recording::significant;

use super::figures;
use crate::failure::Failure;
use crate::text::json;
use truecut::outputs::write_file;

/// The report, the figure, and the stiffnesses as entries of robot.toml.
pub fn stiffness(folder: &Path, report: &StiffnessReport) -> Result<Vec<PathBuf>, Failure> {
    let figure = figures::stiffness(report).to_svg();
    let files = [
        ("stiffness.json", json(report)?),
        ("stiffness.svg", figure),
        ("stiffness.toml", entries(report)),
    ];
    write(folder, &files)
}

/// The report and the figure.
pub fn modes(folder: &Path, report: &ModesReport) -> Result<Vec<PathBuf>, Failure> {
    let figure = figures::modes(report).to_svg();
    let mut files = vec![("modes.json", json(report)?), ("modes.svg", figure)];
    if !report.tool.is_empty() {
        files.push(("tool_modes.toml", tool::entries(&report.tool)));
    }
    write(folder, &files)
}

fn write(folder: &Path, files: &[(&str, String)]) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    for (name, content) in files {
        let path = folder.join(name);
        write_file(&path, content.as_bytes())?;
        written.push(path);
    }
    Ok(written)
}

/// `[[joint]]` entries of robot.toml. Joints that could not be identified are comments.
pub fn entries(report: &StiffnessReport) -> String {
    let mut text = format!(
        "# Joint stiffness identified from {}; these entries take the place of those in \
         robot.toml.\n",
        report.source.escape_debug()
    );
    for joint in &report.joints {
        // Writing into a String cannot fail.
        let _ = match (joint.value, joint.low, joint.high) {
            (Some(value), Some(low), Some(high)) => writeln!(
                text,
                "\n[[joint]]\nname = {}\n{} = {}\n[joint.source]\nstiffness = {}",
                toml::Value::from(joint.name.as_str()),
                key(joint),
                number(value),
                toml::Value::from(source(report, low, high, joint.unit)),
            ),
            _ => writeln!(
                text,
                "\n# {}: not identified ({:?})",
                joint.name.escape_debug(),
                joint.status
            ),
        };
    }
    text
}

fn key(joint: &JointStiffness) -> &'static str {
    if joint.unit == "N/m" {
        "stiffness_n_per_m"
    } else {
        "stiffness_nm_per_rad"
    }
}

/// Six digits; a TOML float needs a point or an exponent.
fn number(value: f64) -> String {
    format!("{value:.5e}")
}

fn source(report: &StiffnessReport, low: f64, high: f64, unit: &str) -> String {
    let file = Path::new(&report.source).file_name();
    format!(
        "identified from {}: {} loadings in {} postures, 95 % interval {} to {} {unit}",
        file.map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        report.loadings,
        report.postures,
        significant(low, 4),
        significant(high, 4)
    )
}
