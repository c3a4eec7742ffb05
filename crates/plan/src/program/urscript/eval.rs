//! Values of a script: numbers, lists, poses, and the few functions that make them.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Vector3};

use crate::program::number::finite;
use crate::program::source::Source;
use crate::program::{ProgramError, ProgramErrorKind};

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Truth(bool),
    List(Vec<f64>),
    Pose(Isometry3<f64>),
    /// The posture of a pose that is nearest to this one, or to the one before.
    NearPose(Isometry3<f64>, Option<Vec<f64>>),
}

pub(super) type Variables = BTreeMap<String, Value>;

/// Arguments of a call: those without a name first, then by name.
pub(super) type Arguments = Vec<(Option<String>, Value)>;

/// `(a, b, name=c)`.
pub(super) fn arguments(
    source: &mut Source<'_>,
    variables: &Variables,
    depth: usize,
) -> Result<Arguments, ProgramError> {
    source.expect(&["("])?;
    let mut all = Vec::new();
    if source.take(")") {
        return Ok(all);
    }
    loop {
        let name = source.named("=");
        all.push((name.map(str::to_owned), value(source, variables, depth)?));
        if source.take(")") {
            return Ok(all);
        }
        source.expect(&[","])?;
    }
}

/// A value, made of names, numbers, lists, poses and functions of them.
pub(super) fn value(
    source: &mut Source<'_>,
    variables: &Variables,
    depth: usize,
) -> Result<Value, ProgramError> {
    let fault = |source: &Source<'_>, kind| source.error(source.last_line(), kind);
    if depth > 8 {
        let kind = ProgramErrorKind::value("the depth of calls and lists", depth, "at most 8");
        return Err(fault(source, kind));
    }
    if source.comes("[") {
        return Ok(Value::List(list(source, variables, depth)?));
    }
    let word = source.word("a value")?;
    if word == "p" && source.comes("[") {
        let numbers = list(source, variables, depth)?;
        let six: [f64; 6] = numbers.try_into().map_err(|numbers: Vec<f64>| {
            let kind = ProgramErrorKind::Fields {
                what: "a pose".to_owned(),
                found: numbers.len(),
                wanted: "6".to_owned(),
            };
            fault(source, kind)
        })?;
        let [x, y, z, rx, ry, rz] = six;
        let pose = Isometry3::new(Vector3::new(x, y, z), Vector3::new(rx, ry, rz));
        return Ok(Value::Pose(pose));
    }
    if source.comes("(") {
        let given = arguments(source, variables, depth + 1)?;
        let given: Vec<Value> = given.into_iter().map(|(_, value)| value).collect();
        return match (word, given.as_slice()) {
            ("pose_trans", [Value::Pose(a), Value::Pose(b)]) => Ok(Value::Pose(a * b)),
            // Places added in the base frame, turns one after the other.
            ("pose_add", [Value::Pose(a), Value::Pose(b)]) => {
                Ok(Value::Pose(Isometry3::from_parts(
                    (a.translation.vector + b.translation.vector).into(),
                    a.rotation * b.rotation,
                )))
            }
            ("pose_inv", [Value::Pose(a)]) => Ok(Value::Pose(a.inverse())),
            ("get_inverse_kin", [Value::Pose(a), Value::List(near), ..]) => {
                Ok(Value::NearPose(*a, Some(near.clone())))
            }
            ("get_inverse_kin", [Value::Pose(a), ..]) => Ok(Value::NearPose(*a, None)),
            ("d2r", [Value::Number(deg)]) => Ok(Value::Number(deg.to_radians())),
            ("r2d", [Value::Number(rad)]) => Ok(Value::Number(rad.to_degrees())),
            _ => {
                let wanted = "pose_trans, pose_add, pose_inv, get_inverse_kin, d2r or r2d of what \
                              they take";
                Err(fault(source, ProgramErrorKind::unexpected(word, wanted)))
            }
        };
    }
    match (word, variables.get(word)) {
        ("True", _) => Ok(Value::Truth(true)),
        ("False", _) => Ok(Value::Truth(false)),
        (_, Some(known)) => Ok(known.clone()),
        _ if word.starts_with(|c: char| c.is_alphabetic()) => {
            let rule = "given a value before";
            let kind = match word.contains(['+', '-']) {
                true => ProgramErrorKind::not_read(word, "a calculated value"),
                false => ProgramErrorKind::value("the name", format!("`{word}`"), rule),
            };
            Err(fault(source, kind))
        }
        _ => {
            let number = finite(word, "a number");
            Ok(Value::Number(number.map_err(|kind| fault(source, kind))?))
        }
    }
}

fn list(
    source: &mut Source<'_>,
    variables: &Variables,
    depth: usize,
) -> Result<Vec<f64>, ProgramError> {
    source.expect(&["["])?;
    let mut numbers = Vec::new();
    loop {
        match value(source, variables, depth + 1)? {
            Value::Number(number) => numbers.push(number),
            _ => return Err(source.unexpected("a number")),
        }
        if source.take("]") {
            return Ok(numbers);
        }
        source.expect(&[","])?;
    }
}
