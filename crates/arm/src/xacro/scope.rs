//! Properties and macros by scope: a scope sees what those above it hold.

use std::collections::HashMap;
use std::rc::Rc;

use super::tree::Element;
use super::value::Value;

/// A property.
#[derive(Debug, Clone)]
pub(super) enum Property {
    Value(Value),
    /// As written; evaluated when it is first asked for.
    Text(String),
    /// Being evaluated: asked for again, it would depend on itself.
    Open,
}

/// A piece of XML that `insert_block` puts somewhere.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) element: Rc<Element>,
    /// Its children are inserted, rather than itself.
    pub(super) content_only: bool,
}

#[derive(Debug)]
pub(super) struct Parameter {
    pub(super) name: String,
    /// Takes the caller's property of the same name, if there is one.
    pub(super) forwards: bool,
    pub(super) default: Option<String>,
}

#[derive(Debug)]
pub(super) struct Macro {
    pub(super) parameters: Vec<Parameter>,
    pub(super) body: Rc<Element>,
}

#[derive(Debug, Default)]
pub(super) struct Scope {
    pub(super) parent: Option<usize>,
    /// Of an include with a namespace.
    pub(super) is_namespace: bool,
    pub(super) properties: HashMap<String, Property>,
    pub(super) blocks: HashMap<String, Block>,
    pub(super) macros: HashMap<String, Rc<Macro>>,
}

/// All scopes; number 0 is the outermost.
#[derive(Debug)]
pub(super) struct Scopes(Vec<Scope>);

impl Scopes {
    pub(super) fn new() -> Self {
        Self(vec![Scope::default()])
    }

    pub(super) fn open(&mut self, parent: usize, is_namespace: bool) -> usize {
        self.0.push(Scope {
            parent: Some(parent),
            is_namespace,
            ..Scope::default()
        });
        self.0.len() - 1
    }

    pub(super) fn get(&mut self, scope: usize) -> &mut Scope {
        &mut self.0[scope]
    }

    fn upwards(&self, from: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(from), |scope| self.0[*scope].parent)
    }

    /// The scope, from `from` upwards, that holds a property.
    pub(super) fn holder(&self, from: usize, name: &str) -> Option<usize> {
        (self.upwards(from)).find(|scope| self.0[*scope].properties.contains_key(name))
    }

    pub(super) fn block(&self, from: usize, name: &str) -> Option<Block> {
        (self.upwards(from)).find_map(|scope| self.0[scope].blocks.get(name).cloned())
    }

    /// A macro by its name, and the scope that its call sees.
    pub(super) fn find_macro(&self, from: usize, name: &str) -> Option<(Rc<Macro>, usize)> {
        let plain = self.upwards(from).find_map(|scope| {
            let found = self.0[scope].macros.get(name);
            found.map(|found| (found.clone(), from))
        });
        plain.or_else(|| {
            let (namespace, rest) = name.split_once('.')?;
            let holder = self.holder(from, namespace)?;
            match self.0[holder].properties.get(namespace) {
                Some(Property::Value(Value::Namespace(scope))) => self.find_macro(*scope, rest),
                _ => None,
            }
        })
    }

    /// Names of the macros that can be called, in order.
    pub(super) fn macro_names(&self, from: usize) -> Vec<String> {
        let scopes = self.upwards(from);
        let mut names: Vec<String> = scopes
            .flat_map(|scope| self.0[scope].macros.keys().cloned())
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Where a property with `scope="parent"` goes: the caller's, past namespaces if the asker is
    /// a macro's scope.
    pub(super) fn caller(&self, scope: usize) -> Option<usize> {
        let mut at = self.0[scope].parent?;
        while !self.0[scope].is_namespace && self.0[at].is_namespace {
            at = self.0[at].parent?;
        }
        Some(at)
    }

    /// Takes a property from its scope and all above.
    pub(super) fn remove(&mut self, from: usize, name: &str) {
        let scopes: Vec<usize> = self.upwards(from).collect();
        for scope in scopes {
            self.0[scope].properties.remove(name);
        }
    }
}
