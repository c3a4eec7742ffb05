//! A number that is not what it must be.

use std::fmt::Display;

use thiserror::Error;

/// A number that breaks its rule.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{quantity} is {value}; it must be {rule}")]
pub struct OutOfBounds {
    pub quantity: String,
    pub value: String,
    pub rule: String,
}

impl OutOfBounds {
    pub(crate) fn new(quantity: impl Display, value: impl Display, rule: impl Display) -> Self {
        Self {
            quantity: quantity.to_string(),
            value: value.to_string(),
            rule: rule.to_string(),
        }
    }

    /// # Errors
    /// Unless the rule holds.
    pub(crate) fn unless(
        holds: bool,
        quantity: impl Display,
        value: impl Display,
        rule: impl Display,
    ) -> Result<(), Self> {
        if holds {
            return Ok(());
        }
        Err(Self::new(quantity, value, rule))
    }
}
