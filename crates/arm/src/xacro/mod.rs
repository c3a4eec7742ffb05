//! Xacro, the language of macros in which robots are published: expanded to a URDF.
//!
//! Properties, macros with blocks and defaults, includes, conditions, arguments and the expressions
//! of Python that such files use. Files are read only from the robot's own package and from those
//! that are given or found beside it. Every element of the result knows the file and line it was
//! written in.

mod evaluate;
mod expand;
mod expression;
mod functions;
mod parameters;
mod scope;
mod tree;
mod value;
mod yaml;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::error::{ArmError, ArmErrorKind};
use crate::nearest::nearest;
use crate::packages::Packages;
use scope::Scopes;
use tree::Place;

pub(crate) use tree::has_xacro;

/// How deep macros, includes, blocks and properties may lead to each other.
const MOST_NESTED: usize = 100;
/// Most elements that a file may come to.
const MOST_ELEMENTS: usize = 200_000;

/// A text that was made, and where each of its lines was written.
pub(crate) struct Expanded {
    pub(crate) text: String,
    places: Vec<Place>,
    files: Vec<PathBuf>,
}

impl Expanded {
    /// The file and line that a line of the text comes from.
    pub(crate) fn origin(&self, line: usize) -> Option<(&Path, usize)> {
        let place = self.places.get(line.checked_sub(1)?)?;
        Some((&self.files[place.file], place.line))
    }
}

/// A fault that is not yet at a place, or already is.
pub(super) enum Fault {
    Here(String),
    Placed(ArmError),
}

impl Fault {
    fn of(text: impl Into<String>) -> Self {
        Self::Here(text.into())
    }

    /// The same with more said, where it has no place yet.
    fn within(self, say: impl FnOnce(&str) -> String) -> Self {
        match self {
            Self::Here(text) => Self::Here(say(&text)),
            placed => placed,
        }
    }
}

impl From<String> for Fault {
    fn from(text: String) -> Self {
        Self::Here(text)
    }
}

impl From<ArmError> for Fault {
    fn from(error: ArmError) -> Self {
        Self::Placed(error)
    }
}

/// A file under expansion.
struct Expander<'a> {
    packages: &'a Packages,
    arguments: BTreeMap<String, String>,
    /// Arguments that the file declares or asks for.
    asked: BTreeSet<String>,
    scopes: Scopes,
    /// All files read so far.
    files: Vec<PathBuf>,
    /// Files that are being read, the innermost last.
    open: Vec<usize>,
    allowed: Vec<PathBuf>,
    depth: usize,
    elements: usize,
}

/// Expands `text`, the file at `path`; `arguments` are those of `xacro:arg`.
pub(crate) fn expand(
    text: &str,
    path: &Path,
    packages: &Packages,
    arguments: &BTreeMap<String, String>,
) -> Result<Expanded, ArmError> {
    let folder = folder_of(path);
    let mut expander = Expander {
        packages,
        arguments: arguments.clone(),
        asked: BTreeSet::new(),
        scopes: Scopes::new(),
        files: vec![path.to_owned()],
        open: vec![0],
        allowed: packages.allowed(&folder),
        depth: 0,
        elements: 0,
    };
    let root = tree::parse(text, path, 0)?;
    let place = root.place;
    let made = expander
        .element(&root, 0)
        .map_err(|fault| expander.at(place, fault))?;
    refuse_unknown(path, arguments, &expander.asked)?;
    let (mut text, mut places) = (String::new(), Vec::new());
    tree::write(&made, &mut text, &mut places);
    Ok(Expanded {
        text,
        places,
        files: expander.files,
    })
}

/// An argument that the file does not know would change nothing, and nobody would see why.
pub(crate) fn refuse_unknown(
    path: &Path,
    given: &BTreeMap<String, String>,
    known: &BTreeSet<String>,
) -> Result<(), ArmError> {
    let Some(name) = given.keys().find(|name| !known.contains(*name)) else {
        return Ok(());
    };
    let names = || known.iter().map(String::as_str);
    let hint = match nearest(name, names()) {
        Some(own) => format!("; did you mean \"{own}\"?"),
        None if known.is_empty() => "; it has none".to_owned(),
        None => format!("; its arguments are {}", Vec::from_iter(names()).join(", ")),
    };
    let kind = ArmErrorKind::XacroArgument {
        name: name.clone(),
        message: format!("the file has no argument \"{name}\", which is given{hint}"),
    };
    Err(ArmError::in_file(path, None, kind))
}

fn unknown_package(asked: &str, name: &str) -> String {
    format!(
        "`{asked}`: no package \"{name}\" is known; give its folder with --package {name}=DIR or ROS_PACKAGE_PATH"
    )
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

impl Expander<'_> {
    /// Folder of the file that is being read.
    fn folder(&self) -> PathBuf {
        folder_of(&self.files[*self.open.last().unwrap_or(&0)])
    }

    /// Where a file lies that the file which is being read names; it must be in the robot's
    /// package, in one that was found by its name, or in one that was given.
    fn readable(&mut self, file: &str) -> Result<PathBuf, Fault> {
        let path = self.named(file)?;
        let real = path.canonicalize().map_err(|error| {
            Fault::of(format!("cannot read the file {}: {error}", path.display()))
        })?;
        if self.allowed.iter().any(|folder| real.starts_with(folder)) {
            return Ok(real);
        }
        Err(Fault::of(format!(
            "{} lies outside the robot's package and those that it names; give its folder with --package NAME=DIR",
            real.display()
        )))
    }

    /// The path that a file's name means: `package://NAME/…`, `file://…`, or a path from the file
    /// that names it.
    fn named(&mut self, file: &str) -> Result<PathBuf, Fault> {
        let folder = self.folder();
        let Some(rest) = file.strip_prefix("package://") else {
            return Ok(folder.join(file.strip_prefix("file://").unwrap_or(file)));
        };
        let (name, inner) = rest.split_once('/').unwrap_or((rest, ""));
        let found = self.packages.find(name, &folder);
        let found = found.ok_or_else(|| Fault::of(unknown_package(file, name)))?;
        self.allowed.extend(found.canonicalize().ok());
        Ok(found.join(inner))
    }

    fn at(&self, place: Place, fault: Fault) -> ArmError {
        match fault {
            Fault::Placed(error) => error,
            Fault::Here(text) => ArmError::in_file(
                &self.files[place.file],
                place.line,
                ArmErrorKind::Xacro(text),
            ),
        }
    }

    /// One level deeper, within bounds.
    fn descend<T>(&mut self, act: impl FnOnce(&mut Self) -> Result<T, Fault>) -> Result<T, Fault> {
        if self.depth >= MOST_NESTED {
            return Err(Fault::of(format!(
                "macros, includes or properties lead to each other more than {MOST_NESTED} deep: does one call itself?"
            )));
        }
        self.depth += 1;
        let made = act(self);
        self.depth -= 1;
        made
    }
}
