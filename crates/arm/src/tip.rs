//! Which link of a tree is the end of the chain.

use crate::error::{ArmError, ArmErrorKind};
use crate::model::MAX_JOINTS;
use crate::tree::{Freedom, Tree};
use crate::urdf::known_names;

/// A leaf lighter than this is a frame, not a body.
const FRAME_MASS_KG: f64 = 1e-6;
/// Names by which the end of an arm is known; `tool0` is ROS-Industrial's.
const CONVENTIONAL: [&str; 2] = ["flange", "tool0"];

/// Finds the tip link and, if it was chosen among several, a note that says how.
///
/// A name given decides. A tree with one leaf ends there. Otherwise the candidates are the leaves
/// that a supported chain leads to, and the tip is, in this order: a massless leaf (a frame, which
/// is how a URDF marks a tool point) with at most one moving joint less than the longest chain
/// (the gripper's); the leaf of the longest chain. If several remain, one called `flange` or
/// `tool0` is taken.
///
/// # Errors
/// If the name does not exist, or several candidates remain; they are listed.
pub(crate) fn choose_tip(
    tree: &Tree,
    name: Option<&str>,
) -> Result<(usize, Option<String>), ArmError> {
    if let Some(name) = name {
        return find_named(tree, name).map(|tip| (tip, None));
    }
    let is_leaf = |&i: &usize| tree.links[i].child_joints.is_empty();
    let leaves: Vec<usize> = (0..tree.links.len()).filter(is_leaf).collect();
    if let [leaf] = leaves[..] {
        return Ok((leaf, None));
    }
    let ends: Vec<(usize, usize)> = (leaves.iter())
        .filter_map(|&leaf| Some((leaf, moving_joints(tree, leaf)?)))
        .collect();
    let Some(longest) = ends.iter().map(|&(_, count)| count).max() else {
        // No leaf can be used: the chain to the first one says why.
        return Ok((leaves[0], None));
    };
    let frames = ends.iter().filter(|&&(leaf, count)| {
        tree.links[leaf].mass_kg <= FRAME_MASS_KG && count + 1 >= longest
    });
    let (count, rule) = match frames.clone().map(|&(_, count)| count).max() {
        Some(count) => (count, "the frame at the end of the arm"),
        None => (longest, "the end of the longest chain"),
    };
    let candidates: Vec<usize> = if rule.starts_with("the frame") {
        frames
            .filter(|&&(_, c)| c == count)
            .map(|&(leaf, _)| leaf)
            .collect()
    } else {
        ends.iter()
            .filter(|&&(_, c)| c == count)
            .map(|&(leaf, _)| leaf)
            .collect()
    };
    let by_name = CONVENTIONAL.iter().find_map(|name| {
        let named = |&&leaf: &&usize| tree.links[leaf].name == *name;
        candidates.iter().find(named).copied()
    });
    let tip = match candidates[..] {
        [tip] => tip,
        _ => by_name.ok_or_else(|| ambiguous(tree, &ends))?,
    };
    let others: Vec<_> = (leaves.iter())
        .filter(|&&leaf| leaf != tip)
        .map(|&leaf| tree.links[leaf].name.as_str())
        .collect();
    let note = format!(
        "tip \"{}\" was chosen as {rule}; other ends: {}",
        tree.links[tip].name,
        others.join(", ")
    );
    Ok((tip, Some(note)))
}

fn find_named(tree: &Tree, name: &str) -> Result<usize, ArmError> {
    let found = tree.links.iter().position(|link| link.name == name);
    found.ok_or_else(|| {
        let kind = ArmErrorKind::UnknownTip {
            tip: name.to_owned(),
            hint: known_names(tree.links.iter().map(|link| link.name.as_str())),
        };
        ArmError::in_file(&tree.path, None, kind)
    })
}

/// Number of moving joints on the way to `link`; `None` if a joint on it is not supported there, or
/// there are none or too many.
fn moving_joints(tree: &Tree, link: usize) -> Option<usize> {
    let mut count = 0;
    let mut at = link;
    while let Some(j) = tree.links[at].parent_joint {
        let joint = &tree.joints[j];
        if matches!(joint.freedom, Freedom::Other(_)) || joint.followed().is_some() {
            return None;
        }
        count += usize::from(joint.moves());
        at = joint.parent;
    }
    (1..=MAX_JOINTS).contains(&count).then_some(count)
}

fn ambiguous(tree: &Tree, ends: &[(usize, usize)]) -> ArmError {
    let mut ends = ends.to_vec();
    ends.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    let names: Vec<_> = (ends.iter())
        .map(|&(leaf, count)| {
            let plural = if count == 1 { "" } else { "s" };
            format!("\"{}\" ({count} joint{plural})", tree.links[leaf].name)
        })
        .collect();
    let kind = ArmErrorKind::AmbiguousTip {
        candidates: names.join(", "),
    };
    ArmError::in_file(&tree.path, None, kind)
}
