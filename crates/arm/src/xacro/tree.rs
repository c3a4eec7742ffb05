//! Elements as they are expanded, each with the place where it was written.

use std::path::Path;
use std::rc::Rc;

use roxmltree::{Document, Node as XmlNode, ParsingOptions};

use crate::error::{ArmError, ArmErrorKind};
use crate::xml_bounds;

/// File, by its index in the list of files read, and 1-based line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) file: usize,
    pub(super) line: usize,
}

pub(super) type Attributes = Vec<(String, String)>;

#[derive(Debug, Clone)]
pub(super) enum Node {
    Element(Rc<Element>),
    Text(String),
}

#[derive(Debug, Clone)]
pub(super) struct Element {
    /// Of xacro, rather than of the file that is made.
    pub(super) is_xacro: bool,
    /// Without a prefix.
    pub(super) name: String,
    /// Those of xacro with the prefix `xacro:`, others without a prefix.
    pub(super) attributes: Attributes,
    pub(super) children: Vec<Node>,
    pub(super) place: Place,
}

impl Element {
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(own, _)| own == name);
        found.map(|(_, value)| value.as_str())
    }
}

/// Whether a text is written in xacro: it has an element of that language, or declares its
/// namespace and has expressions or substitutions, as a file that was expanded has not.
pub(crate) fn has_xacro(text: &str) -> bool {
    let is_declared = text.contains("xmlns:xacro");
    text.contains("<xacro:") || is_declared && (text.contains("${") || text.contains("$("))
}

fn is_of_xacro(namespace: Option<&str>) -> bool {
    namespace.is_some_and(|uri| uri.trim_end_matches('/').ends_with("xacro"))
}

/// The root element of the file at `path`, number `file` of those read.
pub(super) fn parse(text: &str, path: &Path, file: usize) -> Result<Element, ArmError> {
    if let Some((at, kind)) = xml_bounds::exceeded(text) {
        let line = text[..at].matches('\n').count() + 1;
        return Err(ArmError::in_file(path, line, kind));
    }
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let line = error.pos().row as usize;
        ArmError::in_file(path, line, ArmErrorKind::Xml(error.to_string()))
    })?;
    let starts: Vec<usize> = text.match_indices('\n').map(|(at, _)| at + 1).collect();
    Ok(element(&document.root_element(), &starts, file))
}

fn element(node: &XmlNode, line_starts: &[usize], file: usize) -> Element {
    let start = node.range().start;
    let line = line_starts.partition_point(|line| *line <= start) + 1;
    let attributes = node.attributes().map(|attribute| {
        let prefix = if is_of_xacro(attribute.namespace()) {
            "xacro:"
        } else {
            ""
        };
        let name = format!("{prefix}{}", attribute.name());
        (name, attribute.value().to_owned())
    });
    let child = |child: XmlNode| {
        if child.is_element() {
            Some(Node::Element(Rc::new(element(&child, line_starts, file))))
        } else if child.is_text() {
            child.text().map(|text| Node::Text(text.to_owned()))
        } else {
            None
        }
    };
    Element {
        is_xacro: is_of_xacro(node.tag_name().namespace()),
        name: node.tag_name().name().to_owned(),
        attributes: attributes.collect(),
        children: node.children().filter_map(child).collect(),
        place: Place { file, line },
    }
}

/// Writes an expanded element, every start tag in a line of its own, and where each line's element
/// was written.
pub(super) fn write(element: &Element, text: &mut String, places: &mut Vec<Place>) {
    text.push('<');
    text.push_str(&element.name);
    for (name, value) in &element.attributes {
        text.push_str(&format!(" {name}=\"{}\"", escaped(value)));
    }
    text.push_str(">\n");
    places.push(element.place);
    for child in &element.children {
        match child {
            Node::Element(child) => write(child, text, places),
            Node::Text(own) if own.trim().is_empty() => {}
            Node::Text(own) => {
                text.push_str(&escaped(own).replace('\n', " "));
                text.push('\n');
                places.push(element.place);
            }
        }
    }
    text.push_str(&format!("</{}>\n", element.name));
    places.push(element.place);
}

fn escaped(text: &str) -> String {
    (text.replace('&', "&amp;").replace('<', "&lt;")).replace('"', "&quot;")
}
