//! Where packages of robot descriptions are found on disk.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What marks the root of a package.
const MANIFEST: &str = "package.xml";
/// Folders above a robot's file in which packages are looked for.
const MOST_ABOVE: usize = 6;

/// Folders of packages, as `$(find NAME)` and `package://NAME/…` ask for them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Packages {
    named: BTreeMap<String, PathBuf>,
    roots: Vec<PathBuf>,
}

impl Packages {
    /// Packages given by name and folder, and folders that hold packages, searched in their order.
    /// Relative folders lead from the current one.
    #[must_use]
    pub fn new(named: impl IntoIterator<Item = (String, PathBuf)>, roots: Vec<PathBuf>) -> Self {
        // A path that is relative would be read as one that starts at the robot's file.
        let absolute = |folder: PathBuf| std::path::absolute(&folder).unwrap_or(folder);
        let named = named.into_iter();
        Self {
            named: named.map(|(name, at)| (name, absolute(at))).collect(),
            roots: roots.into_iter().map(absolute).collect(),
        }
    }

    /// Packages given by name and folder, and those on `ROS_PACKAGE_PATH`.
    #[must_use]
    pub fn from_environment(named: impl IntoIterator<Item = (String, PathBuf)>) -> Self {
        let path = std::env::var_os("ROS_PACKAGE_PATH").unwrap_or_default();
        let roots = std::env::split_paths(&path).filter(|root| !root.as_os_str().is_empty());
        Self::new(named, roots.collect())
    }

    /// The folder of a package, for a file in `folder`: one given by name; one on the search path;
    /// one that `folder` lies in, or that lies beside a folder above it.
    #[must_use]
    pub fn find(&self, name: &str, folder: &Path) -> Option<PathBuf> {
        let is_plain = !name.is_empty() && !name.contains(['/', '\\']) && name != "..";
        if let Some(folder) = self.named.get(name) {
            return Some(folder.clone());
        }
        if !is_plain {
            return None;
        }
        let folder = folder.canonicalize().ok()?;
        let above = || folder.ancestors().take(MOST_ABOVE);
        let enclosing = above().find(|above| {
            above.file_name().is_some_and(|own| own == name) || declares(above, name)
        });
        let roots = self.roots.iter().map(PathBuf::as_path).chain(above());
        let beside = || {
            let mut found = roots.filter_map(|root| child(root, name));
            found.next()
        };
        enclosing.map(Path::to_owned).or_else(beside)
    }

    /// Folders that a file in `folder` may read from: its own package (its folder, if it is in
    /// none), packages given by name, and everything on the search path.
    pub(crate) fn allowed(&self, folder: &Path) -> Vec<PathBuf> {
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let own = folder.ancestors().take(MOST_ABOVE);
        let own = own.filter(|above| above.join(MANIFEST).is_file()).last();
        let own = own.unwrap_or(&folder).to_owned();
        let given = self.named.values().chain(&self.roots);
        let given = given.filter_map(|folder| folder.canonicalize().ok());
        std::iter::once(own).chain(given).collect()
    }
}

/// A package called `name` in a folder of packages: by its folder's name, or by its manifest.
fn child(root: &Path, name: &str) -> Option<PathBuf> {
    let own = root.join(name);
    if own.is_dir() {
        return Some(own);
    }
    if root.file_name().is_some_and(|own| own == name) || declares(root, name) {
        return Some(root.to_owned());
    }
    None
}

/// Whether the manifest in a folder names the package.
fn declares(folder: &Path, name: &str) -> bool {
    let text = truecut_files::read_text(&folder.join(MANIFEST)).unwrap_or_default();
    let Some((_, rest)) = text.split_once("<name>") else {
        return false;
    };
    rest.split('<').next().is_some_and(|own| own.trim() == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests run in the folder of their crate.
    #[test]
    fn a_relative_folder_leads_from_the_current_one() {
        let here = std::env::current_dir().expect("a folder");
        let named = [("mine".to_owned(), PathBuf::from("tests"))];
        let packages = Packages::new(named, vec![PathBuf::from("..")]);
        let elsewhere = std::env::temp_dir();
        assert_eq!(packages.find("mine", &elsewhere), Some(here.join("tests")));
        let beside = packages.find("sim", &elsewhere).expect("a crate beside");
        assert!(beside.is_absolute() && beside.join("Cargo.toml").is_file());
    }
}
