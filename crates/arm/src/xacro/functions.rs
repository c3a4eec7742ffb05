//! Functions and constants that xacro's expressions may use: Python's `math`, and its built-in
//! functions on numbers, texts and lists.

use std::cmp::Ordering;
use std::f64::consts;

use super::value::{Outcome, Value};

use Value::{Bool, Float, Int, List, Text};

/// A constant, `None` if there is none of that name.
pub(super) fn constant(name: &str) -> Option<Value> {
    Some(match name {
        "pi" => Float(consts::PI),
        "tau" => Float(consts::TAU),
        "e" => Float(consts::E),
        "inf" => Float(f64::INFINITY),
        "nan" => Float(f64::NAN),
        "True" => Bool(true),
        "False" => Bool(false),
        "None" => Value::None,
        _ => return None,
    })
}

/// The value of a function, `None` if there is none of that name.
pub(super) fn call(name: &str, given: &[Value]) -> Option<Outcome> {
    if let Some(function) = of_one(name) {
        return Some(match given {
            [x] => checked(name, x, function),
            _ => Err(count(name, "one argument")),
        });
    }
    if let Some(function) = of_two(name) {
        return Some(match given {
            [x, y] => (|| Ok(Float(function(x.number()?, y.number()?))))(),
            _ => Err(count(name, "two arguments")),
        });
    }
    built_in(name, given)
}

fn count(name: &str, takes: &str) -> String {
    format!("{name}() takes {takes}")
}

/// What Python refuses, rather than giving no number.
fn checked(name: &str, x: &Value, function: fn(f64) -> f64) -> Outcome {
    let x = x.number()?;
    let value = function(x);
    if !value.is_finite() && x.is_finite() {
        return Err(format!("{name}({x}) has no value"));
    }
    Ok(Float(value))
}

fn of_one(name: &str) -> Option<fn(f64) -> f64> {
    Some(match name {
        "sin" => f64::sin,
        "cos" => f64::cos,
        "tan" => f64::tan,
        "asin" => f64::asin,
        "acos" => f64::acos,
        "atan" => f64::atan,
        "sinh" => f64::sinh,
        "cosh" => f64::cosh,
        "tanh" => f64::tanh,
        "exp" => f64::exp,
        "log10" => f64::log10,
        "log2" => f64::log2,
        "sqrt" => f64::sqrt,
        "fabs" => f64::abs,
        "radians" => f64::to_radians,
        "degrees" => f64::to_degrees,
        _ => return None,
    })
}

fn of_two(name: &str) -> Option<fn(f64, f64) -> f64> {
    Some(match name {
        "atan2" => f64::atan2,
        "hypot" => f64::hypot,
        "pow" => f64::powf,
        "copysign" => f64::copysign,
        "fmod" => |a, b| a % b,
        _ => return None,
    })
}

fn built_in(name: &str, given: &[Value]) -> Option<Outcome> {
    Some(match (name, given) {
        ("abs", [Int(x)]) => Ok(Int(x.wrapping_abs())),
        ("abs", [x]) => x.number().map(|x| Float(x.abs())),
        ("floor", [x]) => x.number().and_then(|x| whole(x.floor())),
        ("ceil", [x]) => x.number().and_then(|x| whole(x.ceil())),
        ("trunc", [x]) => x.number().and_then(|x| whole(x.trunc())),
        ("log", [x]) => checked("log", x, f64::ln),
        ("log", [x, base]) => (|| Ok(Float(x.number()?.ln() / base.number()?.ln())))(),
        ("round", [x]) => x.number().and_then(|x| whole(x.round_ties_even())),
        ("round", [x, Int(digits)]) => rounded(x, *digits),
        ("int", [Text(text)]) => {
            (text.trim().parse().map(Int)).map_err(|_| format!("'{text}' is no whole number"))
        }
        ("int", [x]) => x.number().and_then(|x| whole(x.trunc())),
        ("float", [Text(text)]) => {
            (text.trim().parse().map(Float)).map_err(|_| format!("'{text}' is no number"))
        }
        ("float", [x]) => x.number().map(Float),
        ("bool", [x]) => Ok(Bool(x.is_true())),
        ("str", [x]) => Ok(Text(x.to_string())),
        ("isnan", [x]) => x.number().map(|x| Bool(x.is_nan())),
        ("isinf", [x]) => x.number().map(|x| Bool(x.is_infinite())),
        ("len", [List(values)]) => Ok(Int(values.len() as i64)),
        ("len", [Value::Dict(entries)]) => Ok(Int(entries.len() as i64)),
        ("len", [Text(text)]) => Ok(Int(text.chars().count() as i64)),
        ("list", [List(values)]) => Ok(List(values.clone())),
        ("sum", [List(values)]) => (values.iter()).try_fold(Int(0), |sum, x| sum.combined("+", x)),
        ("min", [List(values)]) => extreme(values, Ordering::Less),
        ("max", [List(values)]) => extreme(values, Ordering::Greater),
        ("min", values) => extreme(values, Ordering::Less),
        ("max", values) => extreme(values, Ordering::Greater),
        _ => return None,
    })
}

fn whole(value: f64) -> Outcome {
    if value.abs() < 9e15 {
        Ok(Int(value as i64))
    } else {
        Err(format!("{value} is too large for a whole number"))
    }
}

/// To so many decimals, as the decimal text rounds.
fn rounded(x: &Value, digits: i64) -> Outcome {
    let x = x.number()?;
    let text = match usize::try_from(digits) {
        Ok(digits) if digits <= 20 => format!("{x:.digits$}"),
        _ => return Err(format!("round() to {digits} decimals: 0 to 20 are taken")),
    };
    (text.parse().map(Float)).map_err(|_| format!("{x} cannot be rounded"))
}

fn extreme(values: &[Value], wanted: Ordering) -> Outcome {
    let Some((first, others)) = values.split_first() else {
        return Err("min() and max() take at least one argument".to_owned());
    };
    let mut best = first;
    for value in others {
        if value.compare(best)? == Some(wanted) {
            best = value;
        }
    }
    Ok(best.clone())
}
