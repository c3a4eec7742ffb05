//! A broken rule, by the path of the key that breaks it.

/// Whether an error is about a key's name or about its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum At {
    Key,
    Value,
}

/// A broken rule before it has a place in the text.
#[derive(Debug, Clone)]
pub(crate) struct Fault {
    pub path: Vec<String>,
    pub at: At,
    pub message: String,
    pub label: String,
    pub help: Option<String>,
}

impl Fault {
    /// A fault in the value at `path` (dotted).
    pub fn value(path: &str, message: String, label: impl Into<String>) -> Fault {
        Fault {
            path: split_path(path),
            at: At::Value,
            message,
            label: label.into(),
            help: None,
        }
    }

    /// A fault in the presence of the key at `path` (dotted).
    pub fn key(path: &str, message: String, label: impl Into<String>) -> Fault {
        Fault {
            at: At::Key,
            ..Fault::value(path, message, label)
        }
    }

    /// Adds advice.
    pub fn with_help(mut self, help: impl Into<String>) -> Fault {
        self.help = Some(help.into());
        self
    }
}

/// Splits a dotted key path.
pub(crate) fn split_path(path: &str) -> Vec<String> {
    path.split('.')
        .filter(|part| !part.is_empty())
        .map(str::to_owned)
        .collect()
}
