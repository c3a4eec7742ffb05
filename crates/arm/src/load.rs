//! From files to a [`Robot`].

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::bounds::Masses;
use crate::config::{Config, ConfigFile};
use crate::doubts;
use crate::error::{ArmError, ArmErrorKind, several};
use crate::estimated::is_estimate;
use crate::merge::to_chain;
use crate::meshes;
use crate::model::{Chain, Frames, Robot};
use crate::packages::Packages;
use crate::tip::choose_tip;
use crate::tree::{Tree, TreeLink};
use crate::urdf::read_tree;
use crate::xacro::{self, Expanded};
use crate::xml_text;

/// Name of the file beside a URDF that is read as its configuration.
pub const CONFIG_FILE_NAME: &str = "robot.toml";

/// How a robot is read; write what differs from the default.
#[derive(Debug, Clone, Default)]
pub struct Reading<'a> {
    /// The configuration; without it, a `robot.toml` beside the URDF if there is one.
    pub config: Option<&'a Path>,
    /// The link whose frame is the flange; without it, the end of the chain.
    pub tip: Option<&'a str>,
    /// Whether masses are needed.
    pub masses: Masses,
    /// Where packages are.
    pub packages: Packages,
    /// Arguments of a xacro file, by name.
    pub arguments: BTreeMap<String, String>,
}

impl Robot {
    /// Loads a URDF, or a xacro file that comes to one, and its `robot.toml`.
    ///
    /// Without `config`, a `robot.toml` beside the URDF is read if there is one; without any, the
    /// transmissions have no stiffness and the tool is the flange. `tip` names the URDF link whose
    /// frame is the flange. Without it, a tree with one leaf ends there; otherwise a massless leaf
    /// (a frame) with at most one moving joint less than the longest chain is taken, then the leaf
    /// of the longest chain, then among equals one called `flange` or `tool0`; else the candidates
    /// are listed in an error.
    ///
    /// # Errors
    /// One error, with file, line and rule, for the first fault found.
    pub fn load(urdf: &Path, config: Option<&Path>, tip: Option<&str>) -> Result<Self, ArmError> {
        let reading = Reading {
            config,
            tip,
            packages: Packages::from_environment([]),
            ..Reading::default()
        };
        Self::read(urdf, &reading)
    }

    /// As [`Robot::load`], for questions of kinematics alone: masses may be missing.
    ///
    /// # Errors
    /// As [`Robot::load`].
    pub fn load_kinematics(
        urdf: &Path,
        config: Option<&Path>,
        tip: Option<&str>,
    ) -> Result<Self, ArmError> {
        let reading = Reading {
            config,
            tip,
            masses: Masses::NotNeeded,
            packages: Packages::from_environment([]),
            ..Reading::default()
        };
        Self::read(urdf, &reading)
    }

    /// As [`Robot::load`], with everything that may differ.
    ///
    /// # Errors
    /// As [`Robot::load`].
    pub fn read(urdf: &Path, reading: &Reading) -> Result<Self, ArmError> {
        let beside = urdf.with_file_name(CONFIG_FILE_NAME);
        let config_path = match reading.config {
            Some(path) => Some(path.to_owned()),
            // Whatever has its name is meant to be it: a link that leads nowhere is not passed by.
            None => beside.symlink_metadata().is_ok().then_some(beside),
        };
        let config = match config_path {
            Some(path) => Some((read(&path)?, path)),
            None => None,
        };
        let config = config
            .as_ref()
            .map(|(text, path)| (text.as_str(), path.as_path()));
        let source = Source::read(urdf, &reading.packages, &reading.arguments)?;
        Self::assemble((source.text(), urdf), config, reading)
            .map_err(|error| source.at_origin(urdf, error))
    }

    /// As [`Robot::load`], from texts already read; each comes with the path that errors name.
    ///
    /// # Errors
    /// As [`Robot::load`].
    pub fn from_texts(
        urdf: (&str, &Path),
        config: Option<(&str, &Path)>,
        tip: Option<&str>,
    ) -> Result<Self, ArmError> {
        let reading = Reading {
            tip,
            ..Reading::default()
        };
        Self::assemble(urdf, config, &reading)
    }

    fn assemble(
        urdf: (&str, &Path),
        config: Option<(&str, &Path)>,
        reading: &Reading,
    ) -> Result<Self, ArmError> {
        let mut tree = read_tree(urdf.0, urdf.1)?;
        let (tip, note) = choose_tip(&tree, reading.tip)?;
        let not_drawn = meshes::find(&mut tree, urdf.1, &reading.packages);
        let silent = config.filter(|(text, _)| says_nothing(text));
        let silent = silent.map(|(_, path)| format!("{} says nothing", path.display()));
        let config = config.map(|(text, path)| ConfigFile::parse(text, path));
        let config = config.transpose()?;
        let mut faults = Vec::new();
        if let Some(config) = &config {
            config.give_masses(&mut tree, &mut faults);
        }
        // With a fault in the masses the rest of the file is looked through, still.
        let masses = if faults.is_empty() {
            reading.masses
        } else {
            Masses::NotNeeded
        };
        let (mut chain, last_link_from_flange) = match to_chain(&mut tree, tip, masses) {
            Ok(made) => made,
            Err(error) => return Err(several(faults).unwrap_or(error)),
        };
        chain.notes.splice(0..0, note.into_iter().chain(silent));
        chain.notes.append(&mut tree.notes);
        chain.notes.extend(not_drawn);
        let (settings, config_path) = match config {
            Some(config) => (
                config.apply(&mut chain, &mut faults),
                Some(PathBuf::from(config.path)),
            ),
            None => (Config::default(), None),
        };
        if let Some(error) = several(faults) {
            return Err(error);
        }
        chain.estimated_masses = estimated_masses(&tree);
        let frames = Frames {
            last_link_from_flange,
            flange_from_tool: settings.flange_from_tool,
            flange_from_foot: settings.flange_from_foot,
        };
        tree.doubts.extend(settings.doubts);
        enter_doubts(&mut chain, &frames, tree.doubts, tree.signs);
        Ok(Self {
            name: settings.name.unwrap_or_else(|| chain.name.clone()),
            frames,
            chain,
            urdf_path: urdf.1.to_owned(),
            config_path,
            damping_ratios: Vec::new(),
            tool_load: settings.tool_load,
        })
    }
}

/// Adds what speaks against the arm to its notes, with what its files have told of angles and of
/// placeholders.
fn enter_doubts(chain: &mut Chain, frames: &Frames, of_angles: Vec<String>, signs: Vec<String>) {
    let of_geometry = doubts::of_geometry(chain, frames);
    let doubts = doubts::of(chain, frames, signs);
    chain.notes.extend(of_angles.iter().cloned());
    chain.notes.extend(doubts.notes);
    chain.motion_doubts = of_angles.into_iter().chain(of_geometry).collect();
    chain.placeholders = doubts.placeholders;
}

/// Whether a file of settings holds no more than remarks.
fn says_nothing(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    lines.all(|line| line.is_empty() || line.starts_with('#'))
}

/// Links whose masses are estimates.
fn estimated_masses(tree: &Tree) -> Vec<String> {
    let is_estimated = |link: &&TreeLink| {
        let source = link.mass_source.as_deref();
        link.mass_kg > 0.0 && source.is_some_and(is_estimate)
    };
    let links = tree.links.iter().filter(is_estimated);
    links.map(|link| link.name.clone()).collect()
}

/// A robot's file as it is read: its own text, or what its xacro comes to.
pub(crate) enum Source {
    Urdf(String),
    Xacro(Expanded),
}

impl Source {
    pub(crate) fn read(
        path: &Path,
        packages: &Packages,
        arguments: &BTreeMap<String, String>,
    ) -> Result<Self, ArmError> {
        let text = xml_text::read(path)?;
        if xacro::has_xacro(&text) {
            return xacro::expand(&text, path, packages, arguments).map(Self::Xacro);
        }
        if let Some(name) = arguments.keys().next() {
            let message =
                format!("the argument \"{name}\" is given, but the file is no xacro and has none");
            let name = name.clone();
            let kind = ArmErrorKind::XacroArgument { name, message };
            return Err(ArmError::in_file(path, None, kind));
        }
        Ok(Self::Urdf(text))
    }

    pub(crate) fn text(&self) -> &str {
        match self {
            Self::Urdf(text) => text,
            Self::Xacro(expanded) => &expanded.text,
        }
    }

    /// An error about the text of the file at `path`, at the place where its line was written.
    pub(crate) fn at_origin(&self, path: &Path, error: ArmError) -> ArmError {
        match self {
            Self::Xacro(expanded) => error.moved(path, |line| expanded.origin(line)),
            Self::Urdf(_) => error,
        }
    }

    /// The tree of the file at `path`, and the link that is its tip.
    pub(crate) fn tree(&self, path: &Path, tip: Option<&str>) -> Result<(Tree, usize), ArmError> {
        let read = || {
            let tree = read_tree(self.text(), path)?;
            let (tip, _) = choose_tip(&tree, tip)?;
            Ok((tree, tip))
        };
        read().map_err(|error| self.at_origin(path, error))
    }
}

/// The URDF that a xacro file comes to, as text; a URDF as it is.
///
/// # Errors
/// As [`Robot::load`].
pub fn expanded_urdf(
    path: &Path,
    packages: &Packages,
    arguments: &BTreeMap<String, String>,
) -> Result<String, ArmError> {
    Ok(Source::read(path, packages, arguments)?.text().to_owned())
}

fn read(path: &Path) -> Result<String, ArmError> {
    truecut_files::read_text(path)
        .map_err(|error| ArmError::in_file(path, None, ArmErrorKind::Unreadable(error)))
}
