//! A fault with the place it was found at.

use std::error::Error;
use std::fmt::{Display, Formatter, Result};
use std::path::{Path, PathBuf};

/// A fault of kind `K` with its place.
///
/// `Display` gives one line, `file:line: message`, as far as file and line are known.
#[derive(Debug)]
pub struct Placed<K>(Box<Fault<K>>);

#[derive(Debug)]
struct Fault<K> {
    path: Option<PathBuf>,
    line: Option<usize>,
    kind: K,
}

impl<K> Placed<K> {
    /// A fault in the file at `path`, at the 1-based `line` if it is known.
    pub fn in_file(path: &Path, line: impl Into<Option<usize>>, kind: K) -> Self {
        Self(Box::new(Fault {
            path: Some(path.to_owned()),
            line: line.into(),
            kind,
        }))
    }

    /// The file that holds the fault; `None` if the fault is in an argument (a posture, a target).
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.0.path.as_deref()
    }

    /// The 1-based line in [`path`](Self::path), where it is known.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.0.line
    }

    /// The same fault elsewhere, if it is in a line of the file `from`: `origin` gives file and
    /// line that the line comes from.
    #[must_use]
    pub(crate) fn moved<'p>(
        mut self,
        from: &Path,
        origin: impl FnOnce(usize) -> Option<(&'p Path, usize)>,
    ) -> Self {
        let line = self.0.line.filter(|_| self.path() == Some(from));
        if let Some((path, line)) = line.and_then(origin) {
            (self.0.path, self.0.line) = (Some(path.to_owned()), Some(line));
        }
        self
    }

    /// The typed fault, for another place.
    #[must_use]
    pub fn into_kind(self) -> K {
        self.0.kind
    }

    /// The typed fault.
    #[must_use]
    pub fn kind(&self) -> &K {
        &self.0.kind
    }
}

impl<K: Display> Placed<K> {
    /// The fault in words: element, value, limit and rule, without the place.
    #[must_use]
    pub fn message(&self) -> String {
        self.0.kind.to_string()
    }
}

impl<K: Display> Display for Placed<K> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if let Some(path) = &self.0.path {
            write!(f, "{}:", path.display())?;
            if let Some(line) = self.0.line {
                write!(f, "{line}:")?;
            }
            f.write_str(" ")?;
        }
        self.0.kind.fmt(f)
    }
}

impl<K: Error> Error for Placed<K> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.0.kind.source()
    }
}

impl<K> From<K> for Placed<K> {
    fn from(kind: K) -> Self {
        Self(Box::new(Fault {
            path: None,
            line: None,
            kind,
        }))
    }
}
