//! PLY (`turk1994`): ASCII, and binary of either byte order. Elements other than vertices and
//! faces, and other properties of these, are passed over.

use nalgebra::Vector3;

use super::{MeshData, MeshFileError, fan, index_u32};

#[derive(Debug, Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Scalar {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Scalar {
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::Signed(1),
            "uchar" | "uint8" => Self::Unsigned(1),
            "short" | "int16" => Self::Signed(2),
            "ushort" | "uint16" => Self::Unsigned(2),
            "int" | "int32" => Self::Signed(4),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        let (Self::Signed(bytes) | Self::Unsigned(bytes) | Self::Float(bytes)) = self;
        bytes
    }
}

struct Property {
    name: String,
    /// Of the length, where it is a list.
    length: Option<Scalar>,
    scalar: Scalar,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

impl Element {
    /// Bytes that one takes at least.
    fn least_bytes(&self, encoding: Encoding) -> u64 {
        let binary = |p: &Property| p.length.unwrap_or(p.scalar).bytes();
        match encoding {
            // A digit and what parts it from the next.
            Encoding::Ascii => 2 * self.properties.len() as u64,
            _ => self.properties.iter().map(|p| binary(p) as u64).sum(),
        }
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<MeshData, MeshFileError> {
    let mut source = Source {
        bytes,
        at: 0,
        line: 1,
        encoding: Encoding::Ascii,
    };
    let (encoding, elements) = header(&mut source)?;
    source.encoding = encoding;
    let mut mesh = MeshData::default();
    for element in &elements {
        let left = (bytes.len() - source.at) as u64;
        let least = element.least_bytes(encoding).saturating_mul(element.count);
        // The last number of a text needs nothing behind it.
        if least > left + 1 {
            return Err(source.fault(format!(
                "the header declares {} times \"{}\", which take {least} bytes at least, but {left} \
                 are left",
                element.count, element.name
            )));
        }
        // Without properties nothing follows, however many are declared.
        if element.properties.is_empty() {
            continue;
        }
        for _ in 0..element.count {
            match element.name.as_str() {
                "vertex" => vertex(&mut source, element, &mut mesh)?,
                _ => face(&mut source, element, &mut mesh)?,
            }
        }
    }
    let count = mesh.vertices.len();
    let unknown = |t: &&[u32; 3]| t.iter().any(|i| *i as usize >= count);
    if let Some(triangle) = mesh.triangles.iter().find(unknown) {
        let message = format!("a face names vertices {triangle:?}, from 0; there are {count}");
        return Err(MeshFileError::new(message));
    }
    Ok(mesh)
}

fn header(source: &mut Source<'_>) -> Result<(Encoding, Vec<Element>), MeshFileError> {
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    if source.header_line()? != "ply" {
        return Err(MeshFileError::at(
            1,
            "not a PLY file: it does not begin with \"ply\"",
        ));
    }
    loop {
        let line = source.header_line()?.to_owned();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let bad = |source: &Source<'_>| source.fault_before(format!("the header says \"{line}\""));
        match words.as_slice() {
            ["format", kind, _] => {
                encoding = Some(match *kind {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    _ => return Err(bad(source)),
                });
            }
            ["comment" | "obj_info", ..] | [] => {}
            ["element", name, count] => elements.push(Element {
                name: (*name).to_owned(),
                count: count.parse().map_err(|_| bad(source))?,
                properties: Vec::new(),
            }),
            ["property", rest @ ..] => {
                let property = match rest {
                    ["list", length, scalar, name] => (Some(*length), *scalar, *name),
                    [scalar, name] => (None, *scalar, *name),
                    _ => return Err(bad(source)),
                };
                let (length, scalar, name) = property;
                let parse = |word| Scalar::parse(word).ok_or_else(|| bad(source));
                let property = Property {
                    name: name.to_owned(),
                    length: length.map(parse).transpose()?,
                    scalar: parse(scalar)?,
                };
                let element = elements.last_mut().ok_or_else(|| bad(source))?;
                element.properties.push(property);
            }
            ["end_header"] => break,
            _ => return Err(bad(source)),
        }
    }
    let encoding = encoding.ok_or_else(|| source.fault_before("the header has no \"format\""))?;
    Ok((encoding, elements))
}

fn vertex(
    source: &mut Source<'_>,
    element: &Element,
    mesh: &mut MeshData,
) -> Result<(), MeshFileError> {
    let mut place = Vector3::repeat(f64::NAN);
    for property in &element.properties {
        match (
            property.length,
            ["x", "y", "z"]
                .iter()
                .position(|axis| *axis == property.name),
        ) {
            (None, Some(axis)) => place[axis] = source.next(property.scalar)?,
            _ => source.pass(property)?,
        }
    }
    mesh.vertices.push(place);
    index_u32(mesh.vertices.len()).map(|_| ())
}

/// A face, or an element of any other kind.
fn face(
    source: &mut Source<'_>,
    element: &Element,
    mesh: &mut MeshData,
) -> Result<(), MeshFileError> {
    for property in &element.properties {
        let is_face = element.name == "face"
            && ["vertex_indices", "vertex_index"].contains(&property.name.as_str());
        match property.length {
            Some(length) if is_face => {
                let count = source.length(length, property.scalar)?;
                let mut corners = Vec::with_capacity(count);
                for _ in 0..count {
                    let index = source.next(property.scalar)?;
                    if index < 0.0 || index.fract() != 0.0 || index > f64::from(u32::MAX) {
                        let message = format!("a face names vertex {index}, which cannot be");
                        return Err(source.fault(message));
                    }
                    corners.push(index as u32);
                }
                mesh.triangles.extend(fan(&corners));
            }
            _ => source.pass(property)?,
        }
    }
    Ok(())
}

struct Source<'a> {
    bytes: &'a [u8],
    at: usize,
    /// From 1, of text.
    line: usize,
    encoding: Encoding,
}

impl<'a> Source<'a> {
    fn fault(&self, message: impl Into<String>) -> MeshFileError {
        match self.encoding {
            Encoding::Ascii => MeshFileError::at(self.line, message),
            _ => MeshFileError::new(format!("byte {}: {}", self.at + 1, message.into())),
        }
    }

    /// Of the line that has just been read.
    fn fault_before(&self, message: impl Into<String>) -> MeshFileError {
        MeshFileError::at(self.line - 1, message)
    }

    fn header_line(&mut self) -> Result<&'a str, MeshFileError> {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().take(1000).position(|byte| *byte == b'\n');
        let end = end.ok_or_else(|| self.fault("the header of the PLY file has no end"))?;
        let line = std::str::from_utf8(&rest[..end])
            .map_err(|_| self.fault("the header of the PLY file is no text"))?;
        self.at += end + 1;
        self.line += 1;
        Ok(line.trim())
    }

    fn next(&mut self, scalar: Scalar) -> Result<f64, MeshFileError> {
        if self.encoding == Encoding::Ascii {
            return self.word();
        }
        let taken = self.bytes.get(self.at..self.at + scalar.bytes());
        let taken = taken.ok_or_else(|| self.fault("the file is cut off here"))?;
        self.at += taken.len();
        let mut eight = [0; 8];
        for (k, byte) in taken.iter().enumerate() {
            let little = self.encoding == Encoding::Little;
            eight[if little { k } else { taken.len() - 1 - k }] = *byte;
        }
        let whole = u64::from_le_bytes(eight);
        Ok(match scalar {
            Scalar::Unsigned(_) => whole as f64,
            Scalar::Signed(bytes) => {
                let unused = 64 - 8 * bytes as u32;
                ((whole << unused) as i64 >> unused) as f64
            }
            Scalar::Float(4) => f64::from(f32::from_bits(whole as u32)),
            Scalar::Float(_) => f64::from_bits(whole),
        })
    }

    fn word(&mut self) -> Result<f64, MeshFileError> {
        while let Some(byte) = self
            .bytes
            .get(self.at)
            .filter(|byte| byte.is_ascii_whitespace())
        {
            self.line += usize::from(*byte == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let word = &rest[..end.unwrap_or(rest.len())];
        if word.is_empty() {
            return Err(self.fault("the file is cut off here"));
        }
        let parsed = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse().ok());
        let number = parsed.ok_or_else(|| {
            let word = String::from_utf8_lossy(&word[..word.len().min(40)]);
            self.fault(format!("\"{word}\" is no number"))
        })?;
        self.at += word.len();
        Ok(number)
    }

    /// How many entries a list has; no more than can follow.
    fn length(&mut self, length: Scalar, entry: Scalar) -> Result<usize, MeshFileError> {
        let count = self.next(length)?;
        let left = self.bytes.len() - self.at;
        let room = match self.encoding {
            Encoding::Ascii => left / 2 + 1,
            _ => left / entry.bytes(),
        };
        if count < 0.0 || count.fract() != 0.0 || count > room as f64 {
            return Err(self.fault(format!("a list of {count} entries cannot follow here")));
        }
        Ok(count as usize)
    }

    fn pass(&mut self, property: &Property) -> Result<(), MeshFileError> {
        let count = match property.length {
            Some(length) => self.length(length, property.scalar)?,
            None => 1,
        };
        (0..count).try_for_each(|_| self.next(property.scalar).map(|_| ()))
    }
}
