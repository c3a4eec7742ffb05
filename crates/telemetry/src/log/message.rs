//! The numbers of a message, each with the path that leads to it.

use re_cdr::{BigEndian, ByteOrder, CdrReader, Error, LittleEndian, Result};

use super::layout::{Holds, Layout, Number};

/// Bytes before a message that say how it is encoded.
const HEAD_BYTES: usize = 4;
/// Longest list whose numbers become columns of their own: a scan or an image is no channel.
const MOST_ELEMENTS: usize = 64;
/// Fields that name the elements of the lists behind them.
const NAMES: [&str; 3] = ["name", "names", "joint_names"];

/// Takes what a message holds.
pub(super) trait Take {
    /// A number, where it stands and its unit.
    fn number(&mut self, path: &str, value: f64, unit: Option<&'static str>);
    /// The stamp of the message's header, seconds and nanoseconds.
    fn stamp(&mut self, seconds: i32, nanoseconds: u32);
    /// A list that is too long for columns.
    fn too_long(&mut self, path: &str);
}

/// Reads a message, its head first. `path` is the topic.
pub(super) fn read(
    layout: &Layout,
    bytes: &[u8],
    path: &str,
    take: &mut impl Take,
) -> std::result::Result<(), String> {
    let Some((head, body)) = bytes.split_at_checked(HEAD_BYTES) else {
        return Err("it ends in its head".to_owned());
    };
    let mut path = path.to_owned();
    let read = match head[..2] {
        [0, 0] => walk::<BigEndian>(layout, body, &mut path, take),
        [0, 1] => walk::<LittleEndian>(layout, body, &mut path, take),
        _ => {
            return Err(format!(
                "its encoding is {:02x}{:02x}; 0000 and 0001 (plain CDR) are read",
                head[0], head[1]
            ));
        }
    };
    read.map_err(|error| error.to_string())
}

fn walk<O: ByteOrder>(
    layout: &Layout,
    body: &[u8],
    path: &mut String,
    take: &mut impl Take,
) -> Result<()> {
    let mut walk = Walk {
        reader: CdrReader::<O>::new(body),
        take,
        is_muted: false,
    };
    walk.message(layout, path, None, None)
}

struct Walk<'a, O, T> {
    reader: CdrReader<'a, O>,
    take: &'a mut T,
    /// Within a list that is too long.
    is_muted: bool,
}

type Unit = Option<&'static str>;

impl<O: ByteOrder, T: Take> Walk<'_, O, T> {
    fn message(
        &mut self,
        layout: &Layout,
        path: &mut String,
        unit: Unit,
        outer: Option<&[String]>,
    ) -> Result<()> {
        let mut own: Option<Vec<String>> = None;
        let length = path.len();
        for field in &layout.fields {
            path.push('/');
            path.push_str(&field.name);
            let unit = field.unit.or(unit);
            match &field.holds {
                Holds::Several(of, size)
                    if matches!(**of, Holds::Text) && NAMES.contains(&field.name.as_str()) =>
                {
                    own = Some(self.texts(*size)?);
                }
                holds => self.value(holds, path, unit, own.as_deref().or(outer))?,
            }
            path.truncate(length);
        }
        Ok(())
    }

    fn value(
        &mut self,
        holds: &Holds,
        path: &mut String,
        unit: Unit,
        names: Option<&[String]>,
    ) -> Result<()> {
        match holds {
            Holds::Number(number) => {
                let value = self.number(*number)?;
                if !self.is_muted {
                    self.take.number(path, value, unit);
                }
            }
            Holds::Text => {
                self.text()?;
            }
            Holds::Header => {
                let stamp = (self.reader.read_i32()?, self.reader.read_u32()?);
                self.text()?;
                self.take.stamp(stamp.0, stamp.1);
            }
            Holds::Message(layout) => self.message(layout, path, unit, names)?,
            Holds::Several(of, size) => self.several(of, *size, path, unit, names)?,
        }
        Ok(())
    }

    fn several(
        &mut self,
        of: &Holds,
        size: Option<usize>,
        path: &mut String,
        unit: Unit,
        names: Option<&[String]>,
    ) -> Result<()> {
        let count = self.count(size)?;
        let length = path.len();
        let was_muted = self.is_muted;
        let is_text = matches!(of, Holds::Text);
        if count > MOST_ELEMENTS && !is_text && !was_muted {
            self.take.too_long(path);
            self.is_muted = true;
        }
        // Of a list that is not told the names do not matter, however many.
        let names = names.filter(|_| !self.is_muted);
        let names = names.filter(|names| names.len() == count && are_names(names));
        for index in 0..count {
            if !self.is_muted && !is_text {
                path.push('/');
                match names {
                    Some(names) => path.push_str(&names[index]),
                    None => path.push_str(&index.to_string()),
                }
            }
            self.value(of, path, unit, None)?;
            path.truncate(length);
        }
        self.is_muted = was_muted;
        Ok(())
    }

    /// Every element takes a byte at least, so that no count leads beyond the message.
    fn count(&mut self, size: Option<usize>) -> Result<usize> {
        let count = match size {
            Some(size) => size,
            None => self.reader.read_sequence_length()?,
        };
        match count > self.reader.remaining() {
            true => Err(Error::UnexpectedEof),
            false => Ok(count),
        }
    }

    fn texts(&mut self, size: Option<usize>) -> Result<Vec<String>> {
        let count = self.count(size)?;
        (0..count).map(|_| self.text()).collect()
    }

    /// Letters that are not UTF-8 are replaced: a name is no reason to lose the numbers.
    fn text(&mut self) -> Result<String> {
        let bytes = self.reader.read_byte_sequence()?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    fn number(&mut self, number: Number) -> Result<f64> {
        let reader = &mut self.reader;
        Ok(match number {
            Number::Bool => f64::from(u8::from(reader.read_bool()?)),
            Number::I8 => reader.read_i8()?.into(),
            Number::U8 => reader.read_u8()?.into(),
            Number::I16 => reader.read_i16()?.into(),
            Number::U16 => reader.read_u16()?.into(),
            Number::I32 => reader.read_i32()?.into(),
            Number::U32 => reader.read_u32()?.into(),
            Number::I64 => reader.read_i64()? as f64,
            Number::U64 => reader.read_u64()? as f64,
            Number::F32 => reader.read_f32()?.into(),
            Number::F64 => reader.read_f64()?,
        })
    }
}

/// Whether elements can be told apart by them.
fn are_names(names: &[String]) -> bool {
    let is_new = |(index, name): (usize, &String)| !names[..index].contains(name);
    names.iter().all(|name| !name.is_empty()) && names.iter().enumerate().all(is_new)
}
