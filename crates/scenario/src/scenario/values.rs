//! Numbers set in memory: a search changes a few of them thousands of times.

use std::sync::Arc;

use super::Scenario;
use crate::error::ScenarioError;
use crate::fault::split_path;
use crate::structure;
use crate::units::key_unit;

impl Scenario {
    /// The same scenario with other numbers at dotted keys, in SI, by the rules of
    /// [`Scenario::with_overrides`] but without its text. Numbers of the robot and of effects are
    /// set where they were resolved to. More depends on those of other tables: with one of these
    /// the parsed document is resolved anew. [`Scenario::effective_text`] and
    /// [`Scenario::overrides`] stay as they were.
    ///
    /// # Errors
    /// As [`Scenario::with_overrides`].
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Scenario, ScenarioError> {
        let mut varied = self.clone();
        varied
            .set
            .retain(|(key, _)| values.iter().all(|(other, _)| key != other));
        varied.set.extend(
            values
                .iter()
                .map(|(key, value)| ((*key).to_owned(), *value)),
        );
        if values
            .iter()
            .all(|(key, value)| varied.set_number(key, *value))
        {
            return Ok(varied);
        }
        let anew = varied.resolved_anew(&[])?;
        Ok(Scenario {
            document: Arc::clone(&self.document),
            set: varied.set,
            ..anew
        })
    }

    /// Least and largest number, in SI, that a dotted key may have, as far as that does not depend
    /// on other keys.
    pub fn range(&self, key: &str) -> [f64; 2] {
        let factor = key_unit(key).si_factor;
        structure::range(self.document.schema(), &split_path(key)).map(|end| end * factor)
    }

    /// Resolves the document with the numbers that were set, further overrides and the effects that
    /// were added.
    pub(super) fn resolved_anew(
        &self,
        overrides: &[(String, String)],
    ) -> Result<Scenario, ScenarioError> {
        let mut document = (*self.document).clone();
        (self.set.iter())
            .try_for_each(|(key, value)| document.set_number(key, key_unit(key).from_si(*value)))
            .and_then(|()| document.override_with(overrides))?;
        Scenario::read(document, &self.processes)?.with_effects(&self.added)
    }

    /// Whether the key's number stands somewhere by itself and may be so large; then it is set
    /// there.
    fn set_number(&mut self, key: &str, value: f64) -> bool {
        let path = split_path(key);
        let written = key_unit(key).from_si(value);
        if !structure::may_be(self.document.schema(), &path, written) {
            return false;
        }
        let parts: Vec<&str> = path.iter().map(String::as_str).collect();
        match parts[..] {
            ["robot", ref own @ ..] => self.gives("robot") && self.robot.set(own, value),
            ["data", "clock_rate"] => {
                let data = self.data.as_mut();
                data.is_some_and(|data| {
                    data.mapping.clock_rate = value;
                    true
                })
            }
            // An effect that was added may stand in place of the file's.
            ["effect", index, own] if self.added.is_empty() && self.gives(key) => {
                let effect = index
                    .parse()
                    .ok()
                    .and_then(|i: usize| self.effects.get_mut(i));
                effect.is_some_and(|effect| effect.set(own, value))
            }
            _ => false,
        }
    }
}
