//! A scenario text that moves to another folder: its relative paths must follow.

use std::path::{Component, Path, PathBuf};

use toml_edit::{DocumentMut, Item, Value};

/// Keys of every scenario that hold the path of a file, relative to its folder.
const PATHS: [&str; 4] = ["robot.urdf", "robot.config", "data.file", "cell"];

/// Rewrites relative paths of a text from folder `from` so that they hold in folder `to`. `files`
/// are the dotted keys of its process that hold paths.
pub(crate) fn relocate(document: &mut DocumentMut, files: &[String], from: &Path, to: &Path) {
    for key in PATHS.into_iter().chain(files.iter().map(String::as_str)) {
        let path: Vec<&str> = key.split('.').collect();
        rewrite(find_mut(document, &path), from, to);
    }
    let claims = document
        .get_mut("claim")
        .and_then(Item::as_array_of_tables_mut);
    for claim in claims.into_iter().flat_map(|claims| claims.iter_mut()) {
        let other = claim
            .get_mut("relative_to")
            .and_then(|item| item.get_mut("scenario"));
        rewrite(other, from, to);
    }
}

/// The item at a path. (`Item::get_mut` would make what is not there.)
pub(crate) fn find_mut<'a>(document: &'a mut DocumentMut, path: &[&str]) -> Option<&'a mut Item> {
    let mut item = Some(document.as_item_mut());
    for key in path {
        let table = item.and_then(Item::as_table_like_mut);
        item = table.and_then(|table| table.get_mut(key));
    }
    item
}

fn rewrite(item: Option<&mut Item>, from: &Path, to: &Path) {
    let Some(value) = item.and_then(Item::as_value_mut) else {
        return;
    };
    let Some(path) = value.as_str().map(PathBuf::from) else {
        return;
    };
    if path.is_absolute() {
        return;
    }
    let moved = relative(&absolute(&from.join(path)), &absolute(to));
    let decor = value.decor().clone();
    *value = Value::from(moved.to_string_lossy().into_owned());
    *value.decor_mut() = decor;
}

/// How a scenario in `folder` names a file. Links lead elsewhere: the paths are those without.
pub fn named_from(folder: &Path, file: &Path) -> PathBuf {
    relative(&absolute(file), &absolute(folder))
}

/// The path from the root, without `.` and `..`; links are left as they are.
fn absolute(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut clean = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                clean.pop();
            }
            Component::CurDir => {}
            part => clean.push(part),
        }
    }
    clean
}

/// How to get from folder `from` to `target`, both absolute.
fn relative(target: &Path, from: &Path) -> PathBuf {
    let shared = (target.components().zip(from.components()))
        .take_while(|(a, b)| a == b)
        .count();
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(target.components().skip(shared)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_to_the_same_files_and_comments_stay() {
        let text = "[robot]\nurdf = \"../robots/a.urdf\" # the arm\n[data]\nfile = \"/data/b.csv\"\n\
                    [[claim]]\nrelative_to = { scenario = \"other.toml\" }\n";
        let mut document: DocumentMut = text.parse().unwrap();
        relocate(
            &mut document,
            &[],
            Path::new("/project/scenarios"),
            Path::new("/project/out/run"),
        );
        let moved = document.to_string();
        assert!(
            moved.contains("urdf = \"../../robots/a.urdf\" # the arm"),
            "{moved}"
        );
        assert!(moved.contains("file = \"/data/b.csv\""), "{moved}");
        assert!(moved.contains("\"../../scenarios/other.toml\""), "{moved}");
    }

    #[test]
    fn a_file_beside_the_scenario_is_named_without_a_folder() {
        let named = |folder: &str, file: &str| named_from(Path::new(folder), Path::new(file));
        assert_eq!(named("/cell", "/cell/arm.urdf"), Path::new("arm.urdf"));
        assert_eq!(
            named("/cell/a", "/cell/arms/b.urdf"),
            Path::new("../arms/b.urdf")
        );
    }

    #[test]
    fn nothing_is_added() {
        let text = "[robot]\nurdf = \"/robots/a.urdf\"\n[process.chamfer]\nspindle_rpm = 300\n";
        let mut document: DocumentMut = text.parse().unwrap();
        relocate(&mut document, &[], Path::new("/a"), Path::new("/b"));
        assert_eq!(document.to_string(), text);
    }
}
