//! Texts with `${…}` and `$(…)` in them, and what they come to.

use super::expression::{self, Expression};
use super::functions;
use super::scope::Property;
use super::value::{Outcome, Value};
use super::{Expander, Fault, unknown_package, yaml};

/// Longest text that an attribute or an element may come to, bytes.
const LONGEST_TEXT: usize = 1 << 20;

impl Expander<'_> {
    /// A text as a text.
    pub(super) fn text(&mut self, text: &str, scope: usize) -> Result<String, Fault> {
        Ok(self.value(text, scope)?.to_string())
    }

    /// A text that is one expression alone keeps the type of its value.
    pub(super) fn value(&mut self, text: &str, scope: usize) -> Result<Value, Fault> {
        if !text.contains('$') {
            return Ok(Value::Text(text.to_owned()));
        }
        let mut pieces: Vec<Value> = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            if at > 0 {
                pieces.push(Value::Text(rest[..at].to_owned()));
            }
            rest = &rest[at..];
            let dollars = rest.len() - rest.trim_start_matches('$').len();
            let opens = rest[dollars..].starts_with(['{', '(']);
            let length = if !opens {
                pieces.push(Value::Text(rest[..dollars].to_owned()));
                dollars
            } else if dollars > 1 {
                // A dollar before another escapes it.
                pieces.push(Value::Text(rest[1..=dollars].to_owned()));
                dollars + 1
            } else {
                let is_expression = rest.starts_with("${");
                let close = if is_expression { '}' } else { ')' };
                let end = (rest.find(close))
                    .ok_or_else(|| Fault::of(format!("`{rest}` lacks its `{close}`")))?;
                let inner = &rest[2..end];
                pieces.push(if is_expression {
                    self.expression(inner, scope)?
                } else {
                    Value::Text(self.substitution(inner, scope)?)
                });
                end + 1
            };
            rest = &rest[length..];
        }
        if !rest.is_empty() {
            pieces.push(Value::Text(rest.to_owned()));
        }
        if pieces.len() == 1 {
            return Ok(pieces.remove(0));
        }
        let joined: String = pieces.iter().map(Value::to_string).collect();
        if joined.len() > LONGEST_TEXT {
            return Err(Fault::of("a text grows beyond all bounds"));
        }
        Ok(Value::Text(joined))
    }

    fn expression(&mut self, inner: &str, scope: usize) -> Result<Value, Fault> {
        self.descend(|this| {
            let text = this.text(inner, scope)?;
            let parsed = expression::parse(&text);
            let named = |fault: String| Fault::of(format!("`${{{text}}}`: {fault}"));
            let parsed = parsed.map_err(named)?;
            this.evaluate(&parsed, scope)
                .map_err(|fault| fault.within(|fault| format!("`${{{text}}}`: {fault}")))
        })
    }

    /// `$(find NAME)`, `$(arg NAME)` and their like.
    fn substitution(&mut self, inner: &str, scope: usize) -> Result<String, Fault> {
        let text = self.text(inner, scope)?;
        let words: Vec<&str> = text.split_whitespace().collect();
        match words[..] {
            ["find", name] => {
                let found = self.packages.find(name, &self.folder());
                let found = found
                    .ok_or_else(|| Fault::of(unknown_package(&format!("$(find {name})"), name)))?;
                self.allowed.extend(found.canonicalize().ok());
                Ok(found.display().to_string())
            }
            ["arg", name] => self.argument(name),
            ["cwd"] | ["dirname"] => Ok(self.folder().display().to_string()),
            ["env" | "optenv", ..] => Err(Fault::of(format!(
                "`$({text})` reads the environment, which a robot's file may not: give the value with --arg"
            ))),
            _ => Err(Fault::of(format!(
                "`$({text})` is not known; find, arg, cwd and dirname are"
            ))),
        }
    }

    fn argument(&mut self, name: &str) -> Result<String, Fault> {
        self.asked.insert(name.to_owned());
        self.arguments.get(name).cloned().ok_or_else(|| {
            Fault::of(format!(
                "the argument \"{name}\" has no value; give it with --arg {name}=VALUE, or with \
                 `arguments` of [robot] in a scenario"
            ))
        })
    }

    /// The value of a property, evaluated where it stands the first time it is asked for.
    pub(super) fn property(&mut self, name: &str, scope: usize) -> Result<Option<Value>, Fault> {
        let Some(holder) = self.scopes.holder(scope, name) else {
            return Ok(None);
        };
        let slot = self.scopes.get(holder).properties.get_mut(name);
        let text = match slot {
            None => return Ok(None),
            Some(Property::Value(value)) => return Ok(Some(value.clone())),
            Some(Property::Open) => {
                return Err(Fault::of(format!(
                    "the property \"{name}\" depends on itself"
                )));
            }
            Some(slot) => match std::mem::replace(slot, Property::Open) {
                Property::Text(text) => text,
                other => {
                    *slot = other;
                    return Ok(None);
                }
            },
        };
        let value = self.descend(|this| this.value(&text, holder))?;
        let value = literal(value);
        let properties = &mut self.scopes.get(holder).properties;
        properties.insert(name.to_owned(), Property::Value(value.clone()));
        Ok(Some(value))
    }

    fn evaluate(&mut self, expression: &Expression, scope: usize) -> Result<Value, Fault> {
        Ok(match expression {
            Expression::Value(value) => value.clone(),
            Expression::Name(name) => self.name(name, scope)?,
            Expression::List(values) => Value::List(self.all(values, scope)?),
            Expression::Dict(entries) => {
                let mut all = Vec::with_capacity(entries.len());
                for (key, value) in entries {
                    all.push((self.evaluate(key, scope)?, self.evaluate(value, scope)?));
                }
                Value::Dict(all)
            }
            Expression::Negated(value) => self.evaluate(value, scope)?.negated()?,
            Expression::Not(value) => Value::Bool(!self.evaluate(value, scope)?.is_true()),
            Expression::Arithmetic(left, op, right) => {
                let left = self.evaluate(left, scope)?;
                left.combined(op, &self.evaluate(right, scope)?)?
            }
            Expression::Comparison(first, others) => self.comparison(first, others, scope)?,
            Expression::And(left, right) => match self.evaluate(left, scope)? {
                left if !left.is_true() => left,
                _ => self.evaluate(right, scope)?,
            },
            Expression::Or(left, right) => match self.evaluate(left, scope)? {
                left if left.is_true() => left,
                _ => self.evaluate(right, scope)?,
            },
            Expression::Choice {
                condition,
                then,
                otherwise,
            } => {
                let holds = self.evaluate(condition, scope)?.is_true();
                self.evaluate(if holds { then } else { otherwise }, scope)?
            }
            Expression::Attribute(owner, name) => self.attribute(owner, name, scope)?,
            Expression::Item(owner, key) => {
                let owner = self.evaluate(owner, scope)?;
                owner.item(&self.evaluate(key, scope)?)?
            }
            Expression::Call(function, given) => self.function_call(function, given, scope)?,
        })
    }

    fn all(&mut self, values: &[Expression], scope: usize) -> Result<Vec<Value>, Fault> {
        (values.iter())
            .map(|value| self.evaluate(value, scope))
            .collect()
    }

    fn name(&mut self, name: &str, scope: usize) -> Result<Value, Fault> {
        let property = self.property(name, scope)?;
        (property.or_else(|| functions::constant(name)))
            .ok_or_else(|| Fault::of(format!("the name \"{name}\" is not defined")))
    }

    fn comparison(
        &mut self,
        first: &Expression,
        others: &[(&'static str, Expression)],
        scope: usize,
    ) -> Result<Value, Fault> {
        let mut left = self.evaluate(first, scope)?;
        for (op, right) in others {
            let right = self.evaluate(right, scope)?;
            let holds = match *op {
                "==" => left.equals(&right),
                "!=" => !left.equals(&right),
                "in" => left.is_in(&right)?,
                "not in" => !left.is_in(&right)?,
                "<" => left.compare(&right)?.is_some_and(std::cmp::Ordering::is_lt),
                "<=" => left.compare(&right)?.is_some_and(std::cmp::Ordering::is_le),
                ">" => left.compare(&right)?.is_some_and(std::cmp::Ordering::is_gt),
                _ => left.compare(&right)?.is_some_and(std::cmp::Ordering::is_ge),
            };
            if !holds {
                return Ok(Value::Bool(false));
            }
            left = right;
        }
        Ok(Value::Bool(true))
    }

    fn attribute(&mut self, owner: &Expression, name: &str, scope: usize) -> Result<Value, Fault> {
        if is_library(owner)
            && let Some(constant) = functions::constant(name)
        {
            return Ok(constant);
        }
        match self.evaluate(owner, scope)? {
            Value::Namespace(inner) => self.name(name, inner),
            dict @ Value::Dict(_) => Ok(dict.item(&Value::Text(name.to_owned()))?),
            other => Err(Fault::of(format!("`{other}` has no attribute \"{name}\""))),
        }
    }

    fn function_call(
        &mut self,
        function: &Expression,
        given: &[(Option<String>, Expression)],
        scope: usize,
    ) -> Result<Value, Fault> {
        let name = match function {
            Expression::Name(name) => name,
            Expression::Attribute(owner, name) if is_library(owner) => name,
            _ => return Err(Fault::of("only functions can be called")),
        };
        if name == "dict" {
            return self.dict(given, scope);
        }
        if given.iter().any(|(named, _)| named.is_some()) {
            return Err(Fault::of(format!("{name}() takes no arguments by name")));
        }
        let values = given.iter().map(|(_, value)| self.evaluate(value, scope));
        let given: Vec<Value> = values.collect::<Result<_, Fault>>()?;
        match (name.as_str(), &given[..]) {
            ("arg", [Value::Text(asked)]) => return Ok(Value::Text(self.argument(asked)?)),
            ("load_yaml", [Value::Text(file)]) => return self.load_yaml(file),
            _ => {}
        }
        let value: Option<Outcome> = functions::call(name, &given);
        let value = value.ok_or_else(|| {
            let text = format!("the function {name}() is not known, or not with these arguments");
            Fault::of(text)
        })?;
        Ok(value?)
    }

    /// `dict(a=1, b=2)`, or a copy of a dictionary.
    fn dict(
        &mut self,
        given: &[(Option<String>, Expression)],
        scope: usize,
    ) -> Result<Value, Fault> {
        let mut entries = Vec::new();
        for (named, value) in given {
            match (named, self.evaluate(value, scope)?) {
                (Some(name), value) => entries.push((Value::Text(name.clone()), value)),
                (None, Value::Dict(others)) => entries.extend(others),
                (None, other) => {
                    return Err(Fault::of(format!("dict() takes no `{other}`")));
                }
            }
        }
        Ok(Value::Dict(entries))
    }

    /// Which arguments of the file have this value, for a message about it.
    fn given_by(&self, value: &str) -> String {
        let own = self.arguments.iter().filter(|(_, own)| *own == value);
        let names: Vec<&str> = own.map(|(name, _)| name.as_str()).collect();
        if names.is_empty() {
            return String::new();
        }
        let value = if value.trim().is_empty() {
            "empty".to_owned()
        } else {
            format!("\"{value}\"")
        };
        format!(
            "; the argument {} is {value}: give it with {}, or with `arguments` of [robot] in a scenario",
            names.join(" or "),
            (names.iter())
                .map(|name| format!("--arg {name}=FILE"))
                .collect::<Vec<_>>()
                .join(" or ")
        )
    }

    /// The values of a YAML file, which must lie where includes may.
    fn load_yaml(&mut self, file: &str) -> Result<Value, Fault> {
        let given = self.given_by(file);
        if file.trim().is_empty() {
            let text = format!("load_yaml() is given no file{given}");
            return Err(Fault::of(text));
        }
        let named = |fault: Fault| fault.within(|text| format!("{text}{given}"));
        let path = self.readable(file).map_err(named)?;
        let text = truecut_files::read_text(&path).map_err(|error| {
            Fault::of(format!("cannot read {}: {error}{given}", path.display()))
        })?;
        Ok(yaml::parse(&text).map_err(|fault| format!("{}: {fault}", path.display()))?)
    }
}

/// The namespaces of functions that every file sees.
fn is_library(owner: &Expression) -> bool {
    matches!(owner, Expression::Name(name) if ["math", "python", "xacro"].contains(&name.as_str()))
}

/// A value that is a text, as what it stands for.
pub(super) fn literal(value: Value) -> Value {
    match value {
        Value::Text(text) => Value::literal(text),
        other => other,
    }
}
