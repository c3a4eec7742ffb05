//! What tests of stability share.

use std::path::Path;

use truecut_scenario::Scenario;

/// The shipped pocket with keys changed.
pub(super) fn pocket(keys: &[(&str, &str)]) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/milling/pocket.toml");
    let keys = keys
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
    Scenario::load(&at, &keys.collect::<Vec<_>>()).unwrap()
}
