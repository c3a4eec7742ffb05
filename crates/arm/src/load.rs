//! From files to a [`Robot`].

use std::path::{Path, PathBuf};

use crate::config::{self, Config};
use crate::error::{ArmError, ArmErrorKind};
use crate::merge::to_chain;
use crate::model::{Frames, Robot};
use crate::tip::choose_tip;
use crate::urdf::read_tree;

/// Name of the file beside a URDF that is read as its configuration.
pub const CONFIG_FILE_NAME: &str = "robot.toml";

impl Robot {
    /// Loads a URDF and its `robot.toml`.
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
        let urdf_text = read(urdf)?;
        let beside = urdf.with_file_name(CONFIG_FILE_NAME);
        let config_path = match config {
            Some(path) => Some(path.to_owned()),
            None => beside.is_file().then_some(beside),
        };
        let config = match config_path {
            Some(path) => Some((read(&path)?, path)),
            None => None,
        };
        let config = config
            .as_ref()
            .map(|(text, path)| (text.as_str(), path.as_path()));
        Self::from_texts((&urdf_text, urdf), config, tip)
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
        let tree = read_tree(urdf.0, urdf.1)?;
        let (tip, note) = choose_tip(&tree, tip)?;
        let (mut chain, last_link_from_flange) = to_chain(&tree, tip)?;
        chain.notes.splice(0..0, note);
        let (settings, config_path) = match config {
            Some((text, path)) => {
                let settings = config::apply(text, path, &mut chain)?;
                (settings, Some(PathBuf::from(path)))
            }
            None => (Config::default(), None),
        };
        Ok(Self {
            name: settings.name.unwrap_or_else(|| chain.name.clone()),
            frames: Frames {
                last_link_from_flange,
                flange_from_tool: settings.flange_from_tool,
                flange_from_foot: settings.flange_from_foot,
            },
            chain,
            urdf_path: urdf.1.to_owned(),
            config_path,
            damping_ratios: Vec::new(),
        })
    }
}

fn read(path: &Path) -> Result<String, ArmError> {
    std::fs::read_to_string(path)
        .map_err(|error| ArmError::in_file(path, None, ArmErrorKind::Unreadable(error)))
}
