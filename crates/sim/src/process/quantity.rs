//! Numbers that a process reports, each with its name, unit and meaning in one place: of a step as
//! a channel, of the whole run as a scalar.

use truecut_recording::{ChannelSpec, Scalar, Unit};

/// A number under its name.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    name: &'static str,
    unit: Unit,
    /// SI.
    pub value: f64,
    text: &'static str,
}

impl Quantity {
    /// A number without a description; `value` is in SI.
    #[must_use]
    pub fn new(name: &'static str, unit: Unit, value: f64) -> Self {
        Self {
            name,
            unit,
            value,
            text: "",
        }
    }

    /// The same described in one line, for a reader who does not know the program.
    #[must_use]
    pub fn text(self, text: &'static str) -> Self {
        Self { text, ..self }
    }
}

impl From<Quantity> for ChannelSpec {
    fn from(quantity: Quantity) -> Self {
        Self::new(quantity.name, quantity.unit, quantity.text)
    }
}

impl From<Quantity> for Scalar {
    fn from(quantity: Quantity) -> Self {
        let Quantity {
            name,
            unit,
            value,
            text,
        } = quantity;
        Self::new(name, unit, value, text)
    }
}

/// Channels of the quantities of a step.
pub(super) fn channels(quantities: impl IntoIterator<Item = Quantity>) -> Vec<ChannelSpec> {
    quantities.into_iter().map(ChannelSpec::from).collect()
}

/// Scalars of the quantities of a run.
pub(super) fn scalars(quantities: impl IntoIterator<Item = Quantity>) -> Vec<Scalar> {
    quantities.into_iter().map(Scalar::from).collect()
}

/// Appends the values of a step.
pub(super) fn record(quantities: impl IntoIterator<Item = Quantity>, row: &mut Vec<f64>) {
    row.extend(quantities.into_iter().map(|quantity| quantity.value));
}
