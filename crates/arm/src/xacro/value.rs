//! Values of xacro's expressions, with the arithmetic of Python, in which they are written.

use std::cmp::Ordering;
use std::fmt::{self, Display, Formatter};

/// What an expression comes to.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    List(Vec<Value>),
    Dict(Vec<(Value, Value)>),
    /// The properties of a file included with a namespace, by the index of their scope.
    Namespace(usize),
}

use Value::{Bool, Dict, Float, Int, List, Text};

/// A fault without its place.
pub(super) type Outcome = Result<Value, String>;

impl Display for Value {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let listed = |f: &mut Formatter<'_>, values: &[Value]| {
            let shown: Vec<String> = values.iter().map(Value::repr).collect();
            f.write_str(&shown.join(", "))
        };
        match self {
            Value::None => f.write_str("None"),
            Bool(true) => f.write_str("True"),
            Bool(false) => f.write_str("False"),
            Int(value) => write!(f, "{value}"),
            Float(value) if value.is_nan() => f.write_str("nan"),
            Float(value) => write!(f, "{value:?}"),
            Text(value) => f.write_str(value),
            List(values) => {
                f.write_str("[")?;
                listed(f, values)?;
                f.write_str("]")
            }
            Dict(entries) => {
                let shown = entries.iter();
                let shown = shown.map(|(key, value)| format!("{}: {}", key.repr(), value.repr()));
                write!(f, "{{{}}}", shown.collect::<Vec<_>>().join(", "))
            }
            Value::Namespace(_) => f.write_str("a namespace"),
        }
    }
}

impl Value {
    fn repr(&self) -> String {
        match self {
            Text(text) => format!("'{text}'"),
            other => other.to_string(),
        }
    }

    /// What a text stands for where a property or an argument is given as one: a text in single
    /// quotes, a number, a truth value, or itself.
    pub(super) fn literal(text: String) -> Value {
        if text.len() >= 2 && text.starts_with('\'') && text.ends_with('\'') {
            return Text(text[1..text.len() - 1].to_owned());
        }
        if text.contains('_') {
            return Text(text);
        }
        let trimmed = text.trim();
        if let Ok(value) = trimmed.parse::<i64>() {
            return Int(value);
        }
        if let Ok(value) = trimmed.parse::<f64>() {
            return Float(value);
        }
        match text.as_str() {
            "true" | "True" => Bool(true),
            "false" | "False" => Bool(false),
            _ => Text(text),
        }
    }

    /// Truth as of a condition: of a text only `true`, `false` and whole numbers have one.
    pub(super) fn condition(&self) -> Option<bool> {
        match self {
            Text(text) => match text.as_str() {
                "true" | "True" => Some(true),
                "false" | "False" => Some(false),
                other => other.trim().parse::<i64>().ok().map(|value| value != 0),
            },
            other => Some(other.is_true()),
        }
    }

    /// Truth as of Python's `bool`.
    pub(super) fn is_true(&self) -> bool {
        match self {
            Value::None => false,
            Bool(value) => *value,
            Int(value) => *value != 0,
            Float(value) => *value != 0.0,
            Text(text) => !text.is_empty(),
            List(values) => !values.is_empty(),
            Dict(entries) => !entries.is_empty(),
            Value::Namespace(_) => true,
        }
    }

    pub(super) fn number(&self) -> Result<f64, String> {
        match self {
            Bool(value) => Ok(f64::from(u8::from(*value))),
            Int(value) => Ok(*value as f64),
            Float(value) => Ok(*value),
            other => Err(format!("{} is not a number", other.repr())),
        }
    }

    fn whole(&self) -> Option<i64> {
        match self {
            Bool(value) => Some(i64::from(*value)),
            Int(value) => Some(*value),
            _ => None,
        }
    }

    /// An entry of a list, a letter of a text, or the value of a key.
    pub(super) fn item(&self, key: &Value) -> Outcome {
        let missing = || format!("{} has no item {}", self.repr(), key.repr());
        let nth = |length: usize| {
            let index = key.whole().ok_or_else(missing)?;
            let from_end = if index < 0 { length as i64 } else { 0 };
            usize::try_from(index + from_end).map_err(|_| missing())
        };
        match self {
            List(values) => (values.get(nth(values.len())?).cloned()).ok_or_else(missing),
            Text(text) => {
                let letter = text.chars().nth(nth(text.chars().count())?);
                letter.map(|c| Text(c.to_string())).ok_or_else(missing)
            }
            Dict(entries) => {
                let found = entries.iter().find(|(own, _)| own.equals(key));
                found.map(|(_, value)| value.clone()).ok_or_else(missing)
            }
            _ => Err(missing()),
        }
    }

    pub(super) fn equals(&self, other: &Value) -> bool {
        match (self.number(), other.number()) {
            (Ok(a), Ok(b)) => a == b,
            _ => self == other,
        }
    }

    /// Whether `self` is among the entries, keys or letters of `other`.
    pub(super) fn is_in(&self, other: &Value) -> Result<bool, String> {
        match (self, other) {
            (Text(part), Text(text)) => Ok(text.contains(part.as_str())),
            (_, List(values)) => Ok(values.iter().any(|value| value.equals(self))),
            (_, Dict(entries)) => Ok(entries.iter().any(|(key, _)| key.equals(self))),
            _ => Err(format!("nothing can be in {}", other.repr())),
        }
    }

    pub(super) fn compare(&self, other: &Value) -> Result<Option<Ordering>, String> {
        match (self, other) {
            (Text(a), Text(b)) => Ok(Some(a.cmp(b))),
            _ => Ok(self.number()?.partial_cmp(&other.number()?)),
        }
    }

    pub(super) fn negated(&self) -> Outcome {
        match self.whole() {
            Some(value) => value.checked_neg().map(Int).ok_or_else(too_large),
            None => Ok(Float(-self.number()?)),
        }
    }

    /// `a op b`.
    pub(super) fn combined(&self, op: &str, other: &Value) -> Outcome {
        if let Some(joined) = self.joined(op, other) {
            return joined;
        }
        let (a, b) = (self.number()?, other.number()?);
        if b == 0.0 && matches!(op, "/" | "//" | "%") {
            return Err(format!("division by zero: {self} {op} {other}"));
        }
        if let (Some(a), Some(b)) = (self.whole(), other.whole())
            && let Some(value) = whole_combined(a, op, b)
        {
            return value.map(Int).ok_or_else(too_large);
        }
        Ok(Float(match op {
            "+" => a + b,
            "-" => a - b,
            "*" => a * b,
            "/" => a / b,
            "//" => (a / b).floor(),
            // The sign is the divisor's.
            "%" => match a % b {
                rest if rest != 0.0 && (rest < 0.0) != (b < 0.0) => rest + b,
                rest => rest,
            },
            _ => a.powf(b),
        }))
    }

    /// Texts and lists put together.
    fn joined(&self, op: &str, other: &Value) -> Option<Outcome> {
        match (self, op, other) {
            (Text(a), "+", Text(b)) => Some(Ok(Text(format!("{a}{b}")))),
            (List(a), "+", List(b)) => Some(Ok(List([&a[..], &b[..]].concat()))),
            (Text(text), "*", Int(count)) | (Int(count), "*", Text(text)) => {
                let count = usize::try_from(*count).unwrap_or(0);
                Some(if count.saturating_mul(text.len()) > LONGEST_TEXT {
                    Err(too_large())
                } else {
                    Ok(Text(text.repeat(count)))
                })
            }
            _ => None,
        }
    }
}

/// Longest text that an expression makes, bytes.
const LONGEST_TEXT: usize = 1 << 16;

fn too_large() -> String {
    "a value is too large".to_owned()
}

/// Whole numbers stay whole but in a division; `None` where they do not, `Some(None)` beyond range.
fn whole_combined(a: i64, op: &str, b: i64) -> Option<Option<i64>> {
    match op {
        "+" => Some(a.checked_add(b)),
        "-" => Some(a.checked_sub(b)),
        "*" => Some(a.checked_mul(b)),
        "//" => Some(a.checked_rem_euclid(b).and_then(|_| {
            let quotient = a.checked_div(b)?;
            Some(quotient - i64::from(a % b != 0 && (a < 0) != (b < 0)))
        })),
        "%" => Some(a.checked_rem(b).map(|rest| {
            let other_sign = rest != 0 && (rest < 0) != (b < 0);
            if other_sign { rest + b } else { rest }
        })),
        "**" if b >= 0 => Some(u32::try_from(b).ok().and_then(|b| a.checked_pow(b))),
        _ => None,
    }
}
