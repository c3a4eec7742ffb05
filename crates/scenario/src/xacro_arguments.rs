//! Arguments of a robot's xacro file, as a file of ours gives them.

use std::collections::BTreeMap;

use crate::written::Written;

/// Arguments by their names.
pub(crate) type ArgumentTable = BTreeMap<String, Written>;

/// The texts of a table; none without one.
pub(crate) fn texts(table: Option<ArgumentTable>) -> BTreeMap<String, String> {
    let named = table.unwrap_or_default().into_iter();
    named.map(|(name, value)| (name, value.text())).collect()
}
