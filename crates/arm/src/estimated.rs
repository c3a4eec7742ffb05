//! Which values of an arm are estimates, by what their sources say.

use crate::model::{Robot, TransmissionSources};

/// Whether a value's source says that it is an estimate.
pub(crate) fn is_estimate(source: &str) -> bool {
    let word = source.trim_start().get(.."estimated".len());
    word.is_some_and(|word| word.eq_ignore_ascii_case("estimated"))
}

/// A value of a transmission that may be an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransmissionValue {
    Stiffness,
    Damping,
    DryFriction,
    RotorInertia,
    /// Gains and limit of the servo.
    Servo,
    /// The servo's limit alone, where its gains do nothing.
    DriveLimit,
}

impl TransmissionValue {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Stiffness,
        Self::Damping,
        Self::DryFriction,
        Self::RotorInertia,
        Self::Servo,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
            Self::DryFriction => "dry friction",
            Self::RotorInertia => "rotor inertia",
            Self::Servo => "servo",
            Self::DriveLimit => "drive limit",
        }
    }

    fn source(self, of: &TransmissionSources) -> &str {
        match self {
            Self::Stiffness => &of.stiffness,
            Self::Damping => &of.damping,
            Self::DryFriction => &of.dry_friction,
            Self::RotorInertia => &of.rotor_inertia,
            Self::Servo | Self::DriveLimit => &of.servo,
        }
    }
}

impl Robot {
    /// One sentence on what is estimated: masses, and of the transmissions the values asked for;
    /// `None` if nothing is. What rests on an estimate is as uncertain as it is, and a result does
    /// not look it.
    #[must_use]
    pub fn estimates(&self, values: &[TransmissionValue]) -> Option<String> {
        let masses = &self.chain.estimated_masses;
        let mut parts = Vec::new();
        if !masses.is_empty() {
            parts.push(format!("masses of {}", masses.join(", ")));
        }
        // Values that are estimated of the same joints stand together.
        let mut told: Vec<(Vec<&str>, Vec<&str>)> = Vec::new();
        for value in values {
            let joints = self.chain.joints.iter();
            let estimated =
                joints.filter(|joint| is_estimate(value.source(&joint.transmission.sources)));
            let joints: Vec<&str> = estimated.map(|joint| joint.name.as_str()).collect();
            if joints.is_empty() {
                continue;
            }
            match told.iter_mut().find(|(_, of)| *of == joints) {
                Some((names, _)) => names.push(value.name()),
                None => told.push((vec![value.name()], joints)),
            }
        }
        let all = self.dof();
        parts.extend(told.into_iter().map(|(names, joints)| {
            let of = match joints.len() {
                count if count == all && all > 1 => format!("all {all} joints"),
                _ => joints.join(", "),
            };
            format!("{} of {of}", listed(&names))
        }));
        (!parts.is_empty()).then(|| {
            format!(
                "estimated, not measured: {}; results are as uncertain as these",
                parts.join("; ")
            )
        })
    }
}

/// "a", "a and b", "a, b and c".
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_is_an_estimate_if_it_begins_so() {
        for yes in ["estimated", "estimated: neglected", " Estimated by a rule"] {
            assert!(is_estimate(yes), "{yes}");
        }
        for no in [
            "",
            "data sheet",
            "measured, not estimated",
            "estimé",
            "ééééé",
        ] {
            assert!(!is_estimate(no), "{no}");
        }
    }

    #[test]
    fn names_are_listed_as_they_are_spoken() {
        assert_eq!(listed(&["a"]), "a");
        assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
    }
}
