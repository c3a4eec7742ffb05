//! What can be wrong with measured data.

/// Data that cannot be used. Every message begins with the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DataError {
    /// A column that is not there.
    #[error(
        "{source_name}: no column \"{column}\"{}; the file has {known}",
        crate::unit::suggestion(.nearest.as_deref())
    )]
    NoColumn {
        /// The file.
        source_name: String,
        /// As asked for.
        column: String,
        /// The nearest one that exists.
        nearest: Option<String>,
        /// All that exist.
        known: String,
    },
    /// Times that do not rise, or are not numbers.
    #[error("{source_name}: {place}: {message}")]
    Time {
        /// The file.
        source_name: String,
        /// The row.
        place: String,
        /// Value and rule.
        message: String,
    },
    /// A channel that cannot be used.
    #[error("{source_name}: column \"{column}\" ({channel}): {message}")]
    Channel {
        /// The file.
        source_name: String,
        /// The column.
        column: String,
        /// The channel that it was to be.
        channel: String,
        /// Value and rule.
        message: String,
    },
    /// The file as a whole.
    #[error("{source_name}: {message}")]
    File {
        /// The file.
        source_name: String,
        /// Value and rule.
        message: String,
    },
}
