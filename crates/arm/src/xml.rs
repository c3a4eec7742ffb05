//! Where things stand in a URDF, and whether its numbers are numbers.
//!
//! `urdf-rs` gives the data but no positions, so the text is read a second time as plain XML. Links
//! and joints keep their order in both, which is what joins the two.

use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use crate::error::{ArmError, ArmErrorKind};
use crate::xml_bounds;

/// Lines (1-based) of an element and of its first child of each name.
#[derive(Debug, Clone, Default)]
pub(crate) struct ElementLines {
    line: usize,
    children: Vec<(String, usize)>,
}

impl ElementLines {
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    pub(crate) fn has(&self, element: &str) -> bool {
        self.children.iter().any(|(name, _)| name == element)
    }

    /// Line of the first descendant called `element`, or of the element itself.
    pub(crate) fn of(&self, element: &str) -> usize {
        let found = self.children.iter().find(|(name, _)| name == element);
        found.map_or(self.line, |(_, line)| *line)
    }
}

/// Lines of all links and joints, in file order.
#[derive(Debug, Clone, Default)]
pub(crate) struct UrdfLines {
    pub(crate) links: Vec<ElementLines>,
    pub(crate) joints: Vec<ElementLines>,
}

/// How many numbers attributes of an element hold and whether they must be there.
struct NumberRule {
    element: &'static str,
    attributes: &'static [&'static str],
    count: usize,
    required: bool,
}

const fn rule(
    element: &'static str,
    attributes: &'static [&'static str],
    count: usize,
    required: bool,
) -> NumberRule {
    NumberRule {
        element,
        attributes,
        count,
        required,
    }
}

/// The element whose numbers may be infinite.
const BOUNDS: &str = "limit";

const NUMBER_RULES: &[NumberRule] = &[
    rule("mass", &["value"], 1, true),
    rule(
        "inertia",
        &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"],
        1,
        true,
    ),
    rule("origin", &["xyz", "rpy"], 3, false),
    rule("axis", &["xyz"], 3, true),
    rule("dynamics", &["damping", "friction"], 1, false),
    rule("mimic", &["multiplier", "offset"], 1, false),
    rule("box", &["size"], 3, true),
    rule("cylinder", &["radius", "length"], 1, true),
    rule("capsule", &["radius", "length"], 1, true),
    rule("sphere", &["radius"], 1, true),
    rule("color", &["rgba"], 4, true),
    rule(BOUNDS, &["lower", "upper", "velocity", "effort"], 1, false),
];

/// What an element must have within it.
const PARTS: [(&str, &[&str]); 1] = [("inertial", &["mass", "inertia"])];

/// Words that an element must say.
const WORDS: [(&str, &str); 3] = [
    ("mimic", "joint"),
    ("material", "name"),
    ("safety_controller", "k_velocity"),
];

const JOINT_TYPES: [&str; 7] = [
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
    "spherical",
];

/// Elements that have no part in what is read here. Published files are careless in them (textures
/// without a file, collision shapes without a size), so they are taken out before the data is read.
const IGNORED: [&str; 4] = ["collision", "texture", "gazebo", "transmission"];

/// Most links that are read; a chain of twelve joints with hands and mounts has a tenth of it.
const MOST_LINKS: usize = 1000;

/// Reads the positions and refuses broken XML, missing attributes and numbers that are none. Gives
/// the lines, and the text with all ignored elements blanked.
pub(crate) fn scan(text: &str, path: &Path) -> Result<(UrdfLines, String), ArmError> {
    if let Some((at, kind)) = xml_bounds::exceeded(text) {
        let line = text[..at].matches('\n').count() + 1;
        return Err(ArmError::in_file(path, Some(line), kind));
    }
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let line = error.pos().row as usize;
        ArmError::in_file(path, Some(line), ArmErrorKind::Xml(error.to_string()))
    })?;
    let scanner = Scanner {
        document,
        path,
        line_starts: (text.match_indices('\n').map(|(at, _)| at + 1)).collect(),
    };
    let root = scanner.document.root_element();
    if root.tag_name().name() != "robot" {
        let found = root.tag_name().name().to_owned();
        return Err(scanner.error(&root, ArmErrorKind::NotARobot { found }));
    }
    scanner.refuse_xacro(&root)?;
    let links = root.children().filter(|node| node.has_tag_name("link"));
    let count = links.count();
    if count > MOST_LINKS {
        let limit = MOST_LINKS;
        let kind = ArmErrorKind::TooManyLinks { count, limit };
        return Err(ArmError::in_file(path, None, kind));
    }
    let mut lines = UrdfLines::default();
    for element in root.children().filter(Node::is_element) {
        match element.tag_name().name() {
            "link" => {
                scanner.require(&element, "name")?;
                lines.links.push(scanner.check(&element)?);
            }
            "joint" => {
                scanner.check_joint(&element)?;
                lines.joints.push(scanner.check(&element)?);
            }
            _ => {}
        }
    }
    Ok((lines, without_ignored(text, &root)))
}

fn is_ignored(node: &Node) -> bool {
    node.is_element() && IGNORED.contains(&node.tag_name().name())
}

fn without_ignored(text: &str, root: &Node) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut from = 0;
    for node in root.descendants().filter(is_ignored) {
        let range = node.range();
        // An element inside one that is already gone starts before `from`.
        if range.start >= from {
            kept.push_str(&text[from..range.start]);
            from = range.end;
        }
    }
    kept.push_str(&text[from..]);
    kept
}

struct Scanner<'a> {
    document: Document<'a>,
    path: &'a Path,
    /// First byte of every line but the first, ascending.
    line_starts: Vec<usize>,
}

impl Scanner<'_> {
    fn line(&self, node: &Node) -> usize {
        let start = node.range().start;
        self.line_starts.partition_point(|line| *line <= start) + 1
    }

    /// A template for URDF files is often taken for one.
    fn refuse_xacro(&self, root: &Node) -> Result<(), ArmError> {
        let is_read = |node: &Node| node.is_element() && !node.ancestors().any(|a| is_ignored(&a));
        for node in root.descendants().filter(is_read) {
            let of_xacro = |space: &str| space.ends_with("/xacro");
            let what = if node.tag_name().namespace().is_some_and(of_xacro) {
                Some(format!("<xacro:{}>", node.tag_name().name()))
            } else {
                let values = node.attributes().map(|attribute| attribute.value());
                let mut templates = values.filter(|value| value.contains("${"));
                templates
                    .next()
                    .map(|value| format!("the value \"{value}\""))
            };
            if let Some(what) = what {
                return Err(self.error(&node, ArmErrorKind::XacroInUrdf { what }));
            }
        }
        Ok(())
    }

    fn error(&self, node: &Node, kind: ArmErrorKind) -> ArmError {
        ArmError::in_file(self.path, Some(self.line(node)), kind)
    }

    fn require<'n>(&self, node: &Node<'n, '_>, attribute: &str) -> Result<&'n str, ArmError> {
        node.attribute(attribute).ok_or_else(|| {
            let kind = ArmErrorKind::MissingAttribute {
                element: node.tag_name().name().to_owned(),
                attribute: attribute.to_owned(),
            };
            self.error(node, kind)
        })
    }

    fn check_joint(&self, joint: &Node) -> Result<(), ArmError> {
        let name = self.require(joint, "name")?;
        let kind = self.require(joint, "type")?;
        if !JOINT_TYPES.contains(&kind) {
            let message = format!("joint \"{name}\" has the unknown type \"{kind}\"");
            return Err(self.error(joint, ArmErrorKind::Urdf(message)));
        }
        for role in ["parent", "child"] {
            let Some(end) = joint.children().find(|c| c.has_tag_name(role)) else {
                let message = format!("joint \"{name}\" has no <{role} link=...>");
                return Err(self.error(joint, ArmErrorKind::Urdf(message)));
            };
            self.require(&end, "link")?;
        }
        if let Some(limit) = joint.children().find(|c| c.has_tag_name("limit"))
            && self.document.root_element().attribute("version").is_none()
        {
            self.require(&limit, "velocity")?;
        }
        Ok(())
    }

    /// Checks all numbers below a link or joint and collects the lines.
    fn check(&self, owner: &Node) -> Result<ElementLines, ArmError> {
        let mut lines = ElementLines {
            line: self.line(owner),
            children: Vec::new(),
        };
        let ignored = |node: &Node| node.ancestors().any(|a| is_ignored(&a));
        let below = owner.descendants().skip(1).filter(Node::is_element);
        for node in below.filter(|node| !ignored(node)) {
            let element = node.tag_name().name();
            for rule in NUMBER_RULES.iter().filter(|rule| rule.element == element) {
                for attribute in rule.attributes {
                    self.check_number(owner, &node, rule, attribute)?;
                }
            }
            self.check_parts(owner, &node)?;
            lines.children.push((element.to_owned(), self.line(&node)));
        }
        Ok(lines)
    }

    fn check_parts(&self, owner: &Node, node: &Node) -> Result<(), ArmError> {
        let element = node.tag_name().name();
        for (_, attribute) in WORDS.iter().filter(|(name, _)| *name == element) {
            self.require(node, attribute)?;
        }
        let parts = PARTS.iter().filter(|(name, _)| *name == element);
        for part in parts.flat_map(|(_, parts)| *parts) {
            if !node.children().any(|child| child.has_tag_name(*part)) {
                let of = owner.tag_name().name();
                let name = owner.attribute("name").unwrap_or_default();
                let message = format!("<{element}> of {of} \"{name}\" has no <{part}>");
                return Err(self.error(node, ArmErrorKind::Urdf(message)));
            }
        }
        Ok(())
    }

    fn check_number(
        &self,
        owner: &Node,
        node: &Node,
        rule: &NumberRule,
        attribute: &str,
    ) -> Result<(), ArmError> {
        let Some(value) = node.attribute(attribute) else {
            if rule.required {
                self.require(node, attribute)?;
            }
            return Ok(());
        };
        let good = |token: &str| {
            token
                .parse::<f64>()
                .is_ok_and(|v| v.is_finite() || (rule.element == BOUNDS && v.is_infinite()))
        };
        let tokens: Vec<_> = value.split_whitespace().collect();
        if tokens.len() == rule.count && tokens.iter().all(|token| good(token)) {
            return Ok(());
        }
        let kind = ArmErrorKind::BadNumber {
            owner: format!(
                "{} \"{}\"",
                owner.tag_name().name(),
                owner.attribute("name").unwrap_or_default()
            ),
            element: rule.element.to_owned(),
            attribute: attribute.to_owned(),
            value: value.to_owned(),
            expected: match rule.count {
                1 => "one finite number",
                3 => "three finite numbers",
                _ => "four finite numbers",
            },
        };
        Err(self.error(node, kind))
    }
}
