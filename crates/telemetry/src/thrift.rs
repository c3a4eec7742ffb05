//! Thrift's compact protocol, as far as it is needed to know where a structure ends.
//!
//! <https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>

/// The structures of Parquet are nested less deeply.
const MOST_NESTED: usize = 32;
/// Kind of a field that is a structure.
pub(crate) const STRUCTURE: u8 = 12;

/// Bytes, and how far they are read. Whatever is not there gives `None`.
pub(crate) struct Contents<'a> {
    bytes: &'a [u8],
    pub(crate) at: usize,
}

impl<'a> Contents<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Contents<'a> {
        Contents { bytes, at: 0 }
    }

    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn number(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    fn skip(&mut self, count: u64) -> Option<()> {
        let end = (self.at as u64).checked_add(count)?;
        if end > self.bytes.len() as u64 {
            return None;
        }
        self.at = usize::try_from(end).ok()?;
        Some(())
    }

    /// A signed number: zigzag.
    pub(crate) fn signed(&mut self) -> Option<i64> {
        let number = self.number()?;
        i64::try_from(number >> 1)
            .ok()
            .map(|half| if number & 1 == 0 { half } else { !half })
    }

    /// Goes over a structure.
    pub(crate) fn structure(&mut self, depth: usize) -> Option<()> {
        self.fields(depth, &mut |_, _, _| Some(false))
    }

    /// Goes over a structure field by field. `look` gets a field's number and kind and says whether
    /// it read the value; that of a truth stands in its kind, 1 or 2.
    pub(crate) fn fields(
        &mut self,
        depth: usize,
        look: &mut dyn FnMut(&mut Self, i64, u8) -> Option<bool>,
    ) -> Option<()> {
        let mut field = 0_i64;
        loop {
            let head = self.byte()?;
            let kind = head & 0x0f;
            match (kind, head >> 4) {
                (0, _) => return Some(()),
                (_, 0) => field = self.signed()?,
                (_, further) => field = field.checked_add(i64::from(further))?,
            }
            if !look(self, field, kind)? && kind > 2 {
                self.value(kind, depth + 1)?;
            }
        }
    }

    pub(crate) fn value(&mut self, kind: u8, depth: usize) -> Option<()> {
        if depth > MOST_NESTED {
            return None;
        }
        match kind {
            1..=3 => self.skip(1),
            4..=6 => self.number().map(|_| ()),
            7 => self.skip(8),
            8 => {
                let length = self.number()?;
                self.skip(length)
            }
            9 | 10 => self.list(depth),
            11 => self.map(depth),
            STRUCTURE => self.structure(depth),
            13 => self.skip(16),
            _ => None,
        }
    }

    /// How many values a list has, and of what kind.
    pub(crate) fn list_head(&mut self) -> Option<(u64, u8)> {
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.number()?,
            few => u64::from(few),
        };
        Some((count, head & 0x0f))
    }

    fn list(&mut self, depth: usize) -> Option<()> {
        let (count, kind) = self.list_head()?;
        self.all(count, &[kind], depth)
    }

    fn map(&mut self, depth: usize) -> Option<()> {
        let count = self.number()?;
        if count == 0 {
            return Some(());
        }
        let kinds = self.byte()?;
        self.all(count, &[kinds >> 4, kinds & 0x0f], depth)
    }

    /// Each value takes a byte at least.
    fn all(&mut self, count: u64, kinds: &[u8], depth: usize) -> Option<()> {
        for _ in 0..count {
            for kind in kinds {
                self.value(*kind, depth + 1)?;
            }
        }
        Some(())
    }
}
