//! How the fields of a message lie one behind the other, from its definition.

use re_ros_msg::MessageSchema;
use re_ros_msg::message_spec::{
    ArraySize, BuiltInType, ComplexType, MessageSpecification, Type, message_package,
};

use super::definitions;

/// Deepest nesting of messages in messages.
const MOST_DEEP: usize = 16;
/// Most fields of a message with all that it holds.
const MOST_FIELDS: usize = 10_000;

/// A message, all that it refers to put in its place.
#[derive(Debug)]
pub(super) struct Layout {
    pub fields: Vec<Field>,
}

/// A field of a message.
#[derive(Debug)]
pub(super) struct Field {
    pub name: String,
    pub holds: Holds,
    /// Of all numbers below it, where it is known.
    pub unit: Option<&'static str>,
}

/// What a field holds.
#[derive(Debug)]
pub(super) enum Holds {
    Number(Number),
    Text,
    /// Time of a header and a name that nobody reads.
    Header,
    /// So many, or as many as it says.
    Several(Box<Holds>, Option<usize>),
    Message(Layout),
}

/// Numbers as they are stored.
#[derive(Debug, Clone, Copy)]
pub(super) enum Number {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Layout {
    /// The layout of messages of a type, from their definition with those that it refers to.
    pub fn of(kind: &str, text: &str) -> Result<Layout, String> {
        // What the file does not say itself is looked up last.
        let text = format!("{}\n{}", text.trim_end(), definitions::PARTS);
        let schema = MessageSchema::parse(kind, &text).map_err(|error| {
            format!("the definition of its type \"{kind}\" is at fault: {error:#}")
        })?;
        let mut left = MOST_FIELDS;
        layout(&schema.spec, &schema.dependencies, MOST_DEEP, &mut left)
            .map_err(|error| format!("its type \"{kind}\": {error}"))
    }
}

/// A name without the `msg/` that newer files write into it.
fn plain(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

fn layout(
    spec: &MessageSpecification,
    known: &[MessageSpecification],
    deep: usize,
    left: &mut usize,
) -> Result<Layout, String> {
    if deep == 0 {
        return Err(format!("messages are nested more than {MOST_DEEP} deep"));
    }
    let mut fields = Vec::new();
    for field in &spec.fields {
        *left = (left.checked_sub(1)).ok_or_else(|| format!("more than {MOST_FIELDS} fields"))?;
        fields.push(Field {
            name: field.name.clone(),
            holds: holds(&field.ty, spec, known, deep, left)?,
            unit: definitions::unit(&plain(&spec.name), &field.name),
        });
    }
    Ok(Layout { fields })
}

fn holds(
    of: &Type,
    within: &MessageSpecification,
    known: &[MessageSpecification],
    deep: usize,
    left: &mut usize,
) -> Result<Holds, String> {
    Ok(match of {
        Type::BuiltIn(built_in) => scalar(built_in)?,
        Type::Array { ty, size } => {
            let size = match size {
                ArraySize::Fixed(size) => Some(*size),
                ArraySize::Bounded(_) | ArraySize::Unbounded => None,
            };
            Holds::Several(Box::new(holds(ty, within, known, deep, left)?), size)
        }
        Type::Complex(complex) => {
            let name = match complex {
                ComplexType::Absolute { package, name } => format!("{package}/{name}"),
                // The one name that is known without its package.
                ComplexType::Relative { name } if name == "Header" => "std_msgs/Header".to_owned(),
                ComplexType::Relative { name } => match message_package(&within.name) {
                    Some(package) => format!("{package}/{name}"),
                    None => name.clone(),
                },
            };
            let name = plain(&name);
            if name == "std_msgs/Header" {
                return Ok(Holds::Header);
            }
            let found = known.iter().find(|one| plain(&one.name) == name);
            let found = found.ok_or_else(|| format!("\"{name}\" in it is not defined"))?;
            let octet = found.underlying_type_if_enum_like();
            match octet.map_err(|error| error.to_string())? {
                Some(octet) => scalar(octet)?,
                None => Holds::Message(layout(found, known, deep - 1, left)?),
            }
        }
    })
}

fn scalar(of: &BuiltInType) -> Result<Holds, String> {
    Ok(Holds::Number(match of {
        BuiltInType::Bool => Number::Bool,
        BuiltInType::Byte | BuiltInType::Char | BuiltInType::UInt8 => Number::U8,
        BuiltInType::Int8 => Number::I8,
        BuiltInType::Int16 => Number::I16,
        BuiltInType::UInt16 => Number::U16,
        BuiltInType::Int32 => Number::I32,
        BuiltInType::UInt32 => Number::U32,
        BuiltInType::Int64 => Number::I64,
        BuiltInType::UInt64 => Number::U64,
        BuiltInType::Float32 => Number::F32,
        BuiltInType::Float64 => Number::F64,
        BuiltInType::String(_) => return Ok(Holds::Text),
        BuiltInType::WString(_) => return Err("texts of wide letters are not read".to_owned()),
    }))
}
