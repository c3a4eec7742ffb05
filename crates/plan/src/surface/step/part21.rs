//! The text of a STEP file (ISO 10303-21): which entity stands where, and what it holds.
//!
//! Entities are parsed when they are asked for, so that memory stays within a few times the file.

use std::collections::HashMap;
use std::ops::Range;

/// Lists within each other that are followed.
const DEEPEST: usize = 16;

/// What is wrong, and with which entity.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) line: Option<usize>,
    pub(super) message: String,
}

impl Fault {
    pub(super) fn new(message: impl Into<String>) -> Self {
        let message = message.into();
        Self {
            line: None,
            message,
        }
    }
}

/// A parameter of an entity.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Reference(u64),
    List(Vec<Self>),
    /// `.NAME.`
    Name(String),
    Text(String),
    /// `NAME(...)`
    Typed(String, Vec<Self>),
    /// `$` or `*`
    Nothing,
}

/// An entity: one part, or several of a complex one.
#[derive(Debug)]
pub(super) struct Entity {
    pub(super) number: u64,
    pub(super) parts: Vec<(String, Vec<Value>)>,
}

impl Entity {
    /// Names of its parts.
    pub(super) fn kind(&self) -> String {
        let names: Vec<&str> = self.parts.iter().map(|(name, _)| name.as_str()).collect();
        names.join("+")
    }

    pub(super) fn part(&self, name: &str) -> Option<&[Value]> {
        let found = self.parts.iter().find(|(own, _)| own == name);
        found.map(|(_, values)| values.as_slice())
    }

    pub(super) fn fault(&self, message: impl std::fmt::Display) -> Fault {
        Fault::new(format!("#{} = {}: {message}", self.number, self.kind()))
    }
}

/// A file whose entities have been found.
pub(super) struct Part21<'a> {
    bytes: &'a [u8],
    places: HashMap<u64, Range<usize>>,
    /// In the file's order.
    pub(super) numbers: Vec<u64>,
}

impl<'a> Part21<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, Fault> {
        let mut cursor = Cursor { bytes, at: 0 };
        cursor.skip_blank();
        if !bytes[cursor.at..].starts_with(b"ISO-10303-21") {
            return Err(Fault::new(
                "the file does not begin with \"ISO-10303-21\", as a STEP file does",
            ));
        }
        let (mut places, mut numbers) = (HashMap::new(), Vec::new());
        let mut is_whole = false;
        loop {
            cursor.skip_blank();
            if cursor.at >= bytes.len() {
                break;
            }
            let from = cursor.at;
            let is_closed = cursor.skip_statement();
            if !is_closed {
                break;
            }
            let statement = &bytes[from..cursor.at - 1];
            is_whole |= statement.starts_with(b"END-ISO-10303-21");
            if statement.first() != Some(&b'#') {
                continue;
            }
            let mut own = Cursor { bytes, at: from };
            let number = own.reference().map_err(|fault| fault.at(bytes, from))?;
            own.skip_blank();
            own.expect(b'=').map_err(|fault| fault.at(bytes, own.at))?;
            if places.insert(number, own.at..cursor.at - 1).is_some() {
                return Err(
                    Fault::new(format!("entity #{number} is defined twice")).at(bytes, from)
                );
            }
            numbers.push(number);
        }
        if !is_whole {
            return Err(Fault::new(
                "the file is cut off: \"END-ISO-10303-21;\" is missing",
            ));
        }
        Ok(Self {
            bytes,
            places,
            numbers,
        })
    }

    /// Name of a simple entity, without its parameters; `None` of a complex one.
    pub(super) fn name(&self, number: u64) -> Option<&'a str> {
        let range = self.places.get(&number)?.clone();
        let mut cursor = Cursor {
            bytes: &self.bytes[..range.end],
            at: range.start,
        };
        cursor.skip_blank();
        cursor.word().filter(|word| !word.is_empty())
    }

    pub(super) fn entity(&self, number: u64) -> Result<Entity, Fault> {
        let Some(range) = self.places.get(&number).cloned() else {
            return Err(Fault::new(format!(
                "entity #{number} is referred to, but not there"
            )));
        };
        let mut cursor = Cursor {
            bytes: &self.bytes[..range.end],
            at: range.start,
        };
        let parts = cursor
            .parts()
            .map_err(|fault| fault.of(number).at(self.bytes, cursor.at))?;
        Ok(Entity { number, parts })
    }
}

impl Fault {
    fn at(mut self, bytes: &[u8], at: usize) -> Self {
        let before = &bytes[..at.min(bytes.len())];
        self.line = Some(1 + before.iter().filter(|byte| **byte == b'\n').count());
        self
    }

    fn of(mut self, number: u64) -> Self {
        self.message = format!("#{number}: {}", self.message);
        self
    }
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// Over white space and comments.
    fn skip_blank(&mut self) {
        while let Some(byte) = self.peek() {
            if byte.is_ascii_whitespace() {
                self.at += 1;
            } else if self.bytes[self.at..].starts_with(b"/*") {
                let rest = &self.bytes[self.at + 2..];
                let end = rest.windows(2).position(|pair| pair == b"*/");
                self.at = end.map_or(self.bytes.len(), |end| self.at + end + 4);
            } else {
                return;
            }
        }
    }

    /// Behind the next semicolon outside of strings; whether there was one.
    fn skip_statement(&mut self) -> bool {
        let mut is_text = false;
        while let Some(byte) = self.peek() {
            if !is_text && byte == b'/' && self.bytes[self.at..].starts_with(b"/*") {
                self.skip_blank();
                continue;
            }
            self.at += 1;
            match byte {
                b'\'' => is_text = !is_text,
                b';' if !is_text => return true,
                _ => {}
            }
        }
        false
    }

    fn expect(&mut self, wanted: u8) -> Result<(), Fault> {
        self.skip_blank();
        if self.peek() == Some(wanted) {
            self.at += 1;
            return Ok(());
        }
        let found = self.peek().map_or("the entity's end".to_owned(), |byte| {
            format!("\"{}\"", char::from(byte))
        });
        Err(Fault::new(format!(
            "\"{}\" is expected, not {found}",
            char::from(wanted)
        )))
    }

    fn word(&mut self) -> Option<&'a str> {
        let from = self.at;
        let is_part = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
        while self.peek().is_some_and(is_part) {
            self.at += 1;
        }
        std::str::from_utf8(&self.bytes[from..self.at]).ok()
    }

    fn reference(&mut self) -> Result<u64, Fault> {
        self.expect(b'#')?;
        let digits = self.word().unwrap_or_default();
        digits
            .parse()
            .map_err(|_| Fault::new(format!("\"#{digits}\" is no number of an entity")))
    }

    fn parts(&mut self) -> Result<Vec<(String, Vec<Value>)>, Fault> {
        self.skip_blank();
        let mut parts = Vec::new();
        if self.peek() == Some(b'(') {
            self.at += 1;
            loop {
                self.skip_blank();
                if self.peek() == Some(b')') {
                    break;
                }
                parts.push(self.part()?);
            }
        } else {
            parts.push(self.part()?);
        }
        Ok(parts)
    }

    fn part(&mut self) -> Result<(String, Vec<Value>), Fault> {
        let name = self.word().unwrap_or_default().to_ascii_uppercase();
        if name.is_empty() {
            return Err(Fault::new("the name of an entity is expected"));
        }
        Ok((name, self.list(0)?))
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Value>, Fault> {
        if depth > DEEPEST {
            return Err(Fault::new(format!(
                "lists within each other {depth} deep; {DEEPEST} are read"
            )));
        }
        self.expect(b'(')?;
        let mut values = Vec::new();
        self.skip_blank();
        if self.peek() == Some(b')') {
            self.at += 1;
            return Ok(values);
        }
        loop {
            values.push(self.value(depth)?);
            self.skip_blank();
            if self.peek() == Some(b',') {
                self.at += 1;
                continue;
            }
            self.expect(b')')?;
            return Ok(values);
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, Fault> {
        self.skip_blank();
        match self.peek() {
            Some(b'(') => Ok(Value::List(self.list(depth + 1)?)),
            Some(b'#') => Ok(Value::Reference(self.reference()?)),
            Some(b'$' | b'*') => {
                self.at += 1;
                Ok(Value::Nothing)
            }
            Some(b'\'') => Ok(Value::Text(self.quoted(b'\''))),
            Some(b'"') => Ok(Value::Text(self.quoted(b'"'))),
            Some(b'.') if !self.bytes.get(self.at + 1).is_some_and(u8::is_ascii_digit) => {
                self.at += 1;
                let name = self.word().unwrap_or_default().to_ascii_uppercase();
                self.expect(b'.')?;
                Ok(Value::Name(name))
            }
            Some(byte) if byte.is_ascii_alphabetic() => {
                let name = self.word().unwrap_or_default().to_ascii_uppercase();
                Ok(Value::Typed(name, self.list(depth + 1)?))
            }
            _ => self.number(),
        }
    }

    fn quoted(&mut self, mark: u8) -> String {
        let mut text = Vec::new();
        loop {
            self.at += 1;
            let from = self.at;
            while self.peek().is_some_and(|byte| byte != mark) {
                self.at += 1;
            }
            text.extend_from_slice(&self.bytes[from..self.at]);
            self.at = (self.at + 1).min(self.bytes.len());
            if self.peek() != Some(mark) {
                return String::from_utf8_lossy(&text).into_owned();
            }
            // A doubled mark stands for one; what follows belongs to the text.
            text.push(mark);
        }
    }

    fn number(&mut self) -> Result<Value, Fault> {
        let from = self.at;
        let is_part =
            |byte: u8| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.' | b'e' | b'E');
        while self.peek().is_some_and(is_part) {
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.bytes[from..self.at]).unwrap_or_default();
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Value::Number(number)),
            _ => Err(Fault::new(format!("\"{text}\" is no number"))),
        }
    }
}
