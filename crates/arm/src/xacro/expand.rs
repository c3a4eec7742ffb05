//! Elements of xacro, one by one.

use std::rc::Rc;

use super::evaluate::literal;
use super::parameters::parameters;
use super::scope::{Block, Macro, Parameter, Property};
use super::tree::{self, Attributes, Element, Node};
use super::value::Value;
use super::{Expander, Fault, MOST_ELEMENTS};
use crate::error::ArmError;
use crate::xml_text;

type Made = Result<(), Fault>;

impl Expander<'_> {
    /// An element that is none of xacro, with everything in it expanded.
    pub(super) fn element(&mut self, element: &Element, scope: usize) -> Result<Element, Fault> {
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(Fault::of(format!(
                "the file comes to more than {MOST_ELEMENTS} elements"
            )));
        }
        let mut attributes = Attributes::new();
        for (name, value) in &element.attributes {
            if !name.starts_with("xacro:") {
                attributes.push((name.clone(), self.text(value, scope)?));
            }
        }
        let mut children = Vec::new();
        self.children(&element.children, scope, &mut attributes, &mut children)?;
        Ok(Element {
            is_xacro: false,
            name: element.name.clone(),
            attributes,
            children,
            place: element.place,
        })
    }

    /// Expands `nodes` to `made`; `attributes` are those of the element that they stand in.
    fn children(
        &mut self,
        nodes: &[Node],
        scope: usize,
        attributes: &mut Attributes,
        made: &mut Vec<Node>,
    ) -> Made {
        for node in nodes {
            match node {
                Node::Text(text) => made.push(Node::Text(self.text(text, scope)?)),
                Node::Element(element) => {
                    let one = self.one(element, scope, attributes, made);
                    one.map_err(|fault| self.at(element.place, fault))?;
                }
            }
        }
        Ok(())
    }

    fn one(
        &mut self,
        element: &Rc<Element>,
        scope: usize,
        attributes: &mut Attributes,
        made: &mut Vec<Node>,
    ) -> Made {
        if !element.is_xacro {
            let own = self.element(element, scope)?;
            made.push(Node::Element(Rc::new(own)));
            return Ok(());
        }
        match element.name.as_str() {
            "property" => self.define_property(element, scope),
            "macro" => self.define_macro(element, scope),
            "arg" => self.define_argument(element, scope),
            "include" => self.include(element, scope, made),
            "insert_block" => self.insert_block(element, scope, made),
            "if" | "unless" => self.condition(element, scope, made),
            "attribute" => {
                let name = self.text(needed(element, "name")?, scope)?;
                let value = self.text(needed(element, "value")?, scope)?;
                check_name(&name)?;
                match attributes.iter_mut().find(|(own, _)| *own == name) {
                    Some((_, own)) => *own = value,
                    None => attributes.push((name, value)),
                }
                Ok(())
            }
            "element" => {
                let name = self.text(needed(element, "xacro:name")?, scope)?;
                check_name(&name)?;
                let renamed = Element {
                    is_xacro: false,
                    name,
                    ..Element::clone(element)
                };
                let own = self.element(&renamed, scope)?;
                made.push(Node::Element(Rc::new(own)));
                Ok(())
            }
            "call" => {
                let name = self.text(needed(element, "macro")?, scope)?;
                self.call(&name, element, scope, made)
            }
            name => self.call(name, element, scope, made),
        }
    }

    fn truth(&mut self, text: &str, scope: usize) -> Result<bool, Fault> {
        let value = self.value(text, scope)?;
        (value.condition()).ok_or_else(|| {
            Fault::of(format!(
                "the condition \"{text}\" comes to \"{value}\", which is neither true nor false"
            ))
        })
    }

    fn condition(&mut self, element: &Element, scope: usize, made: &mut Vec<Node>) -> Made {
        let holds = self.truth(needed(element, "value")?, scope)?;
        if holds == (element.name == "if") {
            self.children(&element.children, scope, &mut Attributes::new(), made)?;
        }
        Ok(())
    }

    fn define_property(&mut self, element: &Rc<Element>, scope: usize) -> Made {
        let name = self.text(needed(element, "name")?, scope)?;
        let is_identifier = name.chars().all(|c| c.is_alphanumeric() || c == '_')
            && name.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && !name.starts_with("__");
        if !is_identifier {
            return Err(Fault::of(format!(
                "the property name \"{name}\" is no identifier"
            )));
        }
        if let Some(remove) = element.get("remove")
            && self.truth(remove, scope)?
        {
            self.scopes.remove(scope, &name);
            return Ok(());
        }
        let value = match (element.get("value"), element.get("default")) {
            (Some(_), Some(_)) => {
                let text = format!("the property \"{name}\" has both a value and a default");
                return Err(Fault::of(text));
            }
            (None, Some(_)) if self.scopes.holder(scope, &name).is_some() => return Ok(()),
            (value, default) => value.or(default),
        };
        let is_lazy =
            (element.get("lazy_eval")).map_or(Ok(true), |lazy| self.truth(lazy, scope))?;
        let (target, is_lazy) = match element.get("scope") {
            Some("global") => (0, false),
            Some("parent") => (self.scopes.caller(scope).unwrap_or(0), false),
            _ => (scope, is_lazy),
        };
        let Some(text) = value else {
            let block = Block {
                element: element.clone(),
                content_only: true,
            };
            self.scopes.get(target).blocks.insert(name, block);
            return Ok(());
        };
        let property = match Value::literal(text.to_owned()) {
            Value::Text(text) if is_lazy => Property::Text(text),
            Value::Text(text) => Property::Value(literal(self.value(&text, scope)?)),
            value => Property::Value(value),
        };
        self.scopes.get(target).properties.insert(name, property);
        Ok(())
    }

    fn define_argument(&mut self, element: &Element, scope: usize) -> Made {
        let name = needed(element, "name")?;
        self.asked.insert(name.to_owned());
        if !self.arguments.contains_key(name) {
            let value = self.text(needed(element, "default")?, scope)?;
            self.arguments.insert(name.to_owned(), value);
        }
        Ok(())
    }

    fn define_macro(&mut self, element: &Rc<Element>, scope: usize) -> Made {
        let name = needed(element, "name")?;
        let name = name.strip_prefix("xacro:").unwrap_or(name).to_owned();
        if name.contains('.') || name == "call" {
            return Err(Fault::of(format!("a macro cannot be called \"{name}\"")));
        }
        let own = Macro {
            parameters: parameters(element.get("params").unwrap_or_default()),
            body: element.clone(),
        };
        self.scopes.get(scope).macros.insert(name, Rc::new(own));
        Ok(())
    }

    fn insert_block(&mut self, element: &Element, scope: usize, made: &mut Vec<Node>) -> Made {
        let name = needed(element, "name")?;
        let block = self.scopes.block(scope, name);
        let block =
            block.ok_or_else(|| Fault::of(format!("there is no block called \"{name}\"")))?;
        self.descend(|this| {
            if block.content_only {
                let content = &block.element.children;
                return this.children(content, scope, &mut Attributes::new(), made);
            }
            let own = this.element(&block.element, scope)?;
            made.push(Node::Element(Rc::new(own)));
            Ok(())
        })
    }

    fn include(&mut self, element: &Element, scope: usize, made: &mut Vec<Node>) -> Made {
        let file = self.text(needed(element, "filename")?, scope)?;
        let path = self.named(&file)?;
        let is_optional =
            (element.get("optional")).map_or(Ok(false), |text| self.truth(text, scope))?;
        if is_optional && !path.is_file() {
            return Ok(());
        }
        let real = self.readable(&file)?;
        let text = xml_text::read(&real).map_err(|error| {
            let line = error.line();
            ArmError::in_file(&path, line, error.into_kind())
        })?;
        let scope = match element.get("ns") {
            Some(name) => {
                let name = self.text(name, scope)?;
                let inner = self.scopes.open(scope, true);
                let namespace = Property::Value(Value::Namespace(inner));
                self.scopes.get(scope).properties.insert(name, namespace);
                inner
            }
            None => scope,
        };
        self.files.push(path.clone());
        let number = self.files.len() - 1;
        let root = tree::parse(&text, &path, number)?;
        self.open.push(number);
        let read =
            self.descend(|this| this.children(&root.children, scope, &mut Attributes::new(), made));
        self.open.pop();
        read
    }

    fn call(&mut self, name: &str, element: &Element, scope: usize, made: &mut Vec<Node>) -> Made {
        let (definition, seen) = self.scopes.find_macro(scope, name).ok_or_else(|| {
            let known = self.scopes.macro_names(scope).join(", ");
            Fault::of(format!("there is no macro \"{name}\"; known: {known}"))
        })?;
        let inner = self.scopes.open(seen, false);
        let mut given: Vec<&str> = Vec::new();
        for (attribute, value) in &element.attributes {
            if element.name == "call" && attribute == "macro" {
                continue;
            }
            if !definition.parameters.iter().any(|p| p.name == *attribute) {
                let text = format!("the macro \"{name}\" has no parameter \"{attribute}\"");
                return Err(Fault::of(text));
            }
            let value = literal(self.value(value, scope)?);
            let properties = &mut self.scopes.get(inner).properties;
            properties.insert(attribute.clone(), Property::Value(value));
            given.push(attribute);
        }
        let mut blocks = Vec::new();
        self.children(
            &element.children,
            scope,
            &mut Attributes::new(),
            &mut blocks,
        )?;
        self.take_blocks(name, &definition, blocks, inner)?;
        let open = |p: &&Parameter| !p.name.starts_with('*') && !given.contains(&p.name.as_str());
        for parameter in definition.parameters.iter().filter(open) {
            let value = self.default(name, parameter, scope)?;
            let properties = &mut self.scopes.get(inner).properties;
            properties.insert(parameter.name.clone(), Property::Value(value));
        }
        self.descend(|this| {
            let body = &definition.body.children;
            this.children(body, inner, &mut Attributes::new(), made)
        })
    }

    fn take_blocks(
        &mut self,
        name: &str,
        definition: &Macro,
        blocks: Vec<Node>,
        scope: usize,
    ) -> Made {
        let mut blocks = blocks.into_iter().filter_map(|node| match node {
            Node::Element(element) => Some(element),
            Node::Text(_) => None,
        });
        for parameter in &definition.parameters {
            let Some(own) = parameter.name.strip_prefix('*') else {
                continue;
            };
            let element = blocks.next().ok_or_else(|| {
                Fault::of(format!("the macro \"{name}\" needs a block \"{own}\""))
            })?;
            let content_only = own.starts_with('*');
            let own = own.trim_start_matches('*').to_owned();
            let block = Block {
                element,
                content_only,
            };
            self.scopes.get(scope).blocks.insert(own, block);
        }
        match blocks.next() {
            Some(element) => Err(Fault::of(format!(
                "the macro \"{name}\" takes no further block <{}>",
                element.name
            ))),
            None => Ok(()),
        }
    }

    fn default(&mut self, name: &str, parameter: &Parameter, scope: usize) -> Result<Value, Fault> {
        if parameter.forwards
            && let Some(value) = self.property(&parameter.name, scope)?
        {
            return Ok(value);
        }
        match &parameter.default {
            Some(default) => Ok(literal(self.value(default, scope)?)),
            None => Err(Fault::of(format!(
                "the macro \"{name}\" needs its parameter \"{}\"",
                parameter.name
            ))),
        }
    }
}

fn needed<'e>(element: &'e Element, name: &str) -> Result<&'e str, Fault> {
    (element.get(name)).ok_or_else(|| Fault::of(format!("<xacro:{}> lacks `{name}`", element.name)))
}

/// A name that an element or attribute may have, so that what is written can be read.
fn check_name(name: &str) -> Made {
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ':');
    if name.starts_with(|c: char| c.is_alphabetic() || c == '_') && name.chars().all(is_part) {
        return Ok(());
    }
    Err(Fault::of(format!(
        "\"{name}\" is no name for an element or attribute"
    )))
}
