//! Cutting force coefficients: written in the scenario, or taken from a material file.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::cutting::chamfer::CuttingCoefficients;

use crate::check::Check;
use crate::fault::Fault;
use crate::schema::schema_of;
use crate::structure;
use crate::units::{from_mm, from_mpa, from_n_per_mm, from_n_per_mm3};

/// Coefficients of a material file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MaterialTable {
    /// Material file, relative to the scenario file.
    file: String,
    /// Which of its sets of coefficients. Default: the only one.
    set: Option<String>,
}

/// Coefficients of the linear-edge model.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CuttingTable {
    /// Tangential force per chip area.
    #[schemars(extend(
        "minimum" = 0.0,
        "maximum" = 1e5,
        "x-rule" = "cutting resists the rotation, by less than the hardness of diamond"
    ))]
    tangential_mpa: f64,
    /// Radial force per chip area; positive away from the surface.
    radial_mpa: f64,
    /// Axial force per chip area; positive into the spindle. Default: 0.
    axial_mpa: Option<f64>,
    /// Tangential edge force per length of engaged edge. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "cutting resists the rotation"))]
    edge_tangential_n_per_mm: Option<f64>,
    /// Radial edge force per length of engaged edge. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "an edge is pushed off, never drawn in"))]
    edge_radial_n_per_mm: Option<f64>,
    /// Axial edge force per length of engaged edge; positive into the spindle. Default: 0.
    edge_axial_n_per_mm: Option<f64>,
    /// Force per volume of workpiece that the worn flank displaces, K_sp: it damps vibration.
    /// Default: none.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "an indented surface pushes back"))]
    indentation_n_per_mm3: Option<f64>,
    /// Coefficient of friction between worn flank and workpiece. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes the motion"))]
    flank_friction: Option<f64>,
    /// Width of the wear land on the flank along the cutting speed. Default: 0, a sharp edge.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "0 is a sharp edge"))]
    wear_land_mm: Option<f64>,
}

/// A material: published sets of coefficients.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MaterialFile {
    /// Name of the material.
    #[serde(rename = "name")]
    _name: String,
    /// Sets of coefficients, each with its publication.
    set: Vec<SetTable>,
}

/// One publication's coefficients.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
struct SetTable {
    /// Name of the set.
    id: String,
    #[serde(flatten)]
    numbers: CuttingTable,
    /// "published", "recalled" or "estimated".
    #[serde(rename = "status")]
    _status: String,
    /// Where the numbers come from.
    #[serde(rename = "source")]
    _source: String,
    /// Key of the publication in literature.bib.
    #[serde(rename = "bib")]
    _bib: Option<String>,
}

/// Where cutting force coefficients come from.
pub(super) enum Given<T> {
    Material(MaterialTable),
    Cutting(T),
}

/// Exactly one of both tables of a process (`process.milling`); `None` after recording a fault.
pub(super) fn one_of<T>(
    process: &str,
    material: Option<MaterialTable>,
    cutting: Option<T>,
    check: &mut Check,
) -> Option<Given<T>> {
    match (material, cutting) {
        (Some(material), None) => Some(Given::Material(material)),
        (None, Some(cutting)) => Some(Given::Cutting(cutting)),
        (Some(_), Some(_)) => {
            let message = format!(
                "[{process}.cutting] has no effect: [{process}.material] already gives the coefficients"
            );
            let key = format!("{process}.cutting");
            check.refuse(Fault::key(&key, message, "given twice"));
            None
        }
        (None, None) => {
            let message = format!(
                "missing cutting force coefficients in [{process}]: they are given by \
                 [{process}.material] or [{process}.cutting]"
            );
            let key = format!("{process}.material");
            check.refuse(Fault::key(&key, message, "no coefficients"));
            None
        }
    }
}

/// What coefficients say of worn flanks.
#[derive(Debug, Clone)]
pub(super) struct Indentation {
    pub n_per_m3: Option<f64>,
    pub mu: Option<f64>,
    pub wear_land_m: Option<f64>,
    /// Key at which a wear land that is wrong is told.
    pub wear_land: String,
}

impl CuttingTable {
    pub(super) fn coefficients(&self) -> CuttingCoefficients {
        let edge = |value: Option<f64>| from_n_per_mm(value.unwrap_or(0.0));
        CuttingCoefficients {
            tangential_pa: from_mpa(self.tangential_mpa),
            radial_pa: from_mpa(self.radial_mpa),
            axial_pa: from_mpa(self.axial_mpa.unwrap_or(0.0)),
            edge_tangential_n_per_m: edge(self.edge_tangential_n_per_mm),
            edge_radial_n_per_m: edge(self.edge_radial_n_per_mm),
            edge_axial_n_per_m: edge(self.edge_axial_n_per_mm),
        }
    }

    /// What is said of worn flanks; `wear_land` is where a wear land that is wrong is told.
    pub(super) fn indentation(&self, wear_land: String) -> Indentation {
        Indentation {
            n_per_m3: self.indentation_n_per_mm3.map(from_n_per_mm3),
            mu: self.flank_friction,
            wear_land_m: self.wear_land_mm.map(from_mm),
            wear_land,
        }
    }
}

impl MaterialTable {
    /// Its coefficients; `None` after recording a fault.
    pub(super) fn read(
        self,
        process: &str,
        folder: &Path,
        check: &mut Check,
    ) -> Option<CuttingTable> {
        let table = format!("{process}.material");
        let file = folder.join(&self.file);
        let text = match truecut_files::read_text(&file) {
            Ok(text) => text,
            Err(error) => {
                check.refuse(not_found(&table, &self.file, &file, &error));
                return None;
            }
        };
        match parse(&text) {
            Ok(material) => self.choose(material, &table, check),
            Err(reason) => {
                let key = format!("{table}.file");
                let message = format!("`{key}`: {} is no material file: {reason}", self.file);
                check.refuse(Fault::value(&key, message, "no material file"));
                None
            }
        }
    }

    fn choose(
        self,
        material: MaterialFile,
        table: &str,
        check: &mut Check,
    ) -> Option<CuttingTable> {
        let key = format!("{table}.set");
        let ids: Vec<&str> = material.set.iter().map(|set| set.id.as_str()).collect();
        let known = ids.join(", ");
        let index = match &self.set {
            Some(wanted) => ids.iter().position(|id| id == wanted),
            None if ids.len() == 1 => Some(0),
            None => None,
        };
        let Some(index) = index else {
            check.refuse(match &self.set {
                Some(wanted) => {
                    let message = format!(
                        "`{key}` is \"{wanted}\", but {} has only the sets {known}",
                        self.file
                    );
                    Fault::value(&key, message, "no such set")
                }
                None => {
                    let message = format!(
                        "missing key `set` in [{table}]: {} has the sets {known}",
                        self.file
                    );
                    Fault::key(&key, message, "which of its sets?")
                }
            });
            return None;
        };
        let set = material.set.into_iter().nth(index)?;
        Some(set.numbers)
    }
}

/// Reads a material file, or says what is wrong with it.
fn parse(text: &str) -> Result<MaterialFile, String> {
    if truecut_files::too_deep(text).is_some() {
        return Err(crate::document::nested());
    }
    let document: toml_edit::DocumentMut = text
        .parse()
        .map_err(|error: toml_edit::TomlError| error.message().trim().to_owned())?;
    let faults = structure::check_against(&schema_of::<MaterialFile>(), document.as_table());
    if let Some(fault) = faults.into_iter().next() {
        return Err(fault.message);
    }
    serde_json::from_value(structure::to_json(document.as_table()))
        .map_err(|error| error.to_string())
}

/// A file that cannot be read, with the material files beside it.
fn not_found(table: &str, written: &str, file: &Path, error: &std::io::Error) -> Fault {
    let beside = file.parent().map(Path::to_owned).unwrap_or_default();
    let mut names: Vec<String> = std::fs::read_dir(&beside)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path: &PathBuf| path.extension().is_some_and(|found| found == "toml"))
        .filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    let key = format!("{table}.file");
    let message = format!("`{key}`: cannot read material {written}: {error}");
    let fault = Fault::value(&key, message, "no such material");
    if names.is_empty() {
        fault.with_help(format!("{} holds no material file", beside.display()))
    } else {
        fault.with_help(format!("beside it are {}", names.join(", ")))
    }
}
