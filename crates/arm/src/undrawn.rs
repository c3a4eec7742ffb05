//! What a URDF holds that is not read: shapes that cannot be drawn, and elements of other programs.
//!
//! A shape is for looking at; one without a size is no reason to refuse an arm.

use roxmltree::{Document, Node, ParsingOptions};

use crate::xml_bounds;

/// Elements of a link and of a joint that the format knows.
const OF_LINK: [&str; 3] = ["inertial", "visual", "collision"];
const OF_JOINT: [&str; 7] = [
    "origin", "parent", "child", "axis", "limit", "dynamics", "mimic",
];

/// Shapes, with their attributes and how many numbers each of them holds.
const SHAPES: [(&str, &[(&str, usize)]); 5] = [
    ("box", &[("size", 3)]),
    ("cylinder", &[("radius", 1), ("length", 1)]),
    ("capsule", &[("radius", 1), ("length", 1)]),
    ("sphere", &[("radius", 1)]),
    ("mesh", &[]),
];

/// The text with those elements blanked, line for line, and a note on each shape that is not drawn
/// and each element that seems misspelt.
/// What is no XML is left as it is, for the reader to refuse.
pub(crate) fn taken_out(text: &str) -> (String, Vec<String>) {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let unchanged = || (text.to_owned(), Vec::new());
    if xml_bounds::exceeded(text).is_some() {
        return unchanged();
    }
    let Ok(document) = Document::parse_with_options(text, options) else {
        return unchanged();
    };
    let (mut kept, mut notes, mut from) = (String::with_capacity(text.len()), Vec::new(), 0);
    for owner in document.root_element().children() {
        let known: &[&str] = match owner.tag_name().name() {
            "link" => &OF_LINK,
            "joint" => &OF_JOINT,
            _ => continue,
        };
        for node in owner.children().filter(Node::is_element) {
            let name = node.tag_name().name();
            if name == "visual" {
                let Some(why) = fault(&node) else { continue };
                let link = owner.attribute("name").unwrap_or_default();
                notes.push(format!("a shape of link \"{link}\" is not drawn: {why}"));
            } else if known.contains(&name) || node.tag_name().namespace().is_some() {
                continue;
            } else if let Some(meant) = misspelt(name, known) {
                let (kind, owner) = (owner.tag_name().name(), owner.attribute("name"));
                notes.push(format!(
                    "<{name}> of {kind} \"{}\" is not read; did you mean <{meant}>?",
                    owner.unwrap_or_default()
                ));
            }
            let range = node.range();
            kept.push_str(&text[from..range.start]);
            kept.extend(text[range.clone()].matches('\n'));
            from = range.end;
        }
    }
    kept.push_str(&text[from..]);
    (kept, notes)
}

/// The element that a misspelt one is meant to be. Unlike an unknown key of our own tables, an
/// unknown element is most often another program's, with a longer name of the same beginning
/// (`collision_checking`): every letter that differs counts, wherever it stands.
fn misspelt<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let is_near = |own: &&&str| strsim::normalized_damerau_levenshtein(own, name) > 0.7;
    known.iter().find(is_near).copied()
}

/// Why a visual cannot be drawn.
fn fault(visual: &Node) -> Option<String> {
    let child = |of: &Node, name: &str| {
        let mut found = of.children().filter(|node| node.has_tag_name(name));
        found.next().map(|node| node.id())
    };
    let document = visual.document();
    let Some(geometry) = child(visual, "geometry").and_then(|id| document.get_node(id)) else {
        return Some("it has no <geometry>".to_owned());
    };
    let Some(shape) = geometry.children().find(Node::is_element) else {
        return Some("its <geometry> is empty".to_owned());
    };
    let name = shape.tag_name().name();
    let Some((_, numbers)) = SHAPES.iter().find(|(own, _)| *own == name) else {
        return Some(format!(
            "<{name}> is none of box, cylinder, capsule, sphere and mesh"
        ));
    };
    if name == "mesh" && shape.attribute("filename").is_none() {
        return Some("its <mesh> has no file".to_owned());
    }
    let sized = numbers
        .iter()
        .find_map(|&(attribute, count)| number_fault(&shape, attribute, count, true));
    let scaled = || number_fault(&shape, "scale", 3, false);
    let placed = || {
        let origin = document.get_node(child(visual, "origin")?)?;
        let parts = ["xyz", "rpy"];
        (parts.iter()).find_map(|part| number_fault(&origin, part, 3, false))
    };
    let coloured = || {
        let mut colors = visual.descendants().filter(|n| n.has_tag_name("color"));
        colors.find_map(|color| number_fault(&color, "rgba", 4, true))
    };
    sized.or_else(scaled).or_else(placed).or_else(coloured)
}

fn number_fault(node: &Node, attribute: &str, count: usize, is_needed: bool) -> Option<String> {
    let element = node.tag_name().name();
    let Some(value) = node.attribute(attribute) else {
        return is_needed.then(|| format!("its <{element}> has no {attribute}"));
    };
    let words: Vec<&str> = value.split_whitespace().collect();
    let is_number = |word: &&str| word.parse::<f64>().is_ok_and(f64::is_finite);
    let is_good = words.len() == count && words.iter().all(is_number);
    (!is_good).then(|| {
        format!(
            "the {attribute} of its <{element}> is \"{value}\", not {count} finite number{}",
            if count == 1 { "" } else { "s" }
        )
    })
}
