//! Whether a data sheet can be one: mass, payload, reach and repeatability against those of arms
//! that are sold. The bands and the arms that they come from stand in `docs/physics/estimates.md`.

use super::{DataSheet, Lengths};
use crate::error::{ArmError, ArmErrorKind};
use crate::model::Chain;

/// Fewest joints of what is an arm; a rig of fewer may have any masses.
const FEWEST_JOINTS: usize = 4;

/// Where a figure lies for arms that are sold, and beyond what it is taken for a mistake.
struct Band {
    seen: [f64; 2],
    taken: [f64; 2],
}

/// Payload over the mass of the arm.
const PAYLOAD_OVER_MASS: Band = Band {
    seen: [0.03, 0.5],
    taken: [0.01, 1.0],
};
/// Mass over the square of the length of the stretched chain, kg/m².
const MASS_OVER_LENGTH_SQUARED: Band = Band {
    seen: [5.0, 800.0],
    taken: [1.5, 2400.0],
};
/// Reach over the length of the stretched chain. Beyond 1 no point of the chain comes.
const REACH_OVER_LENGTH: Band = Band {
    seen: [0.55, 1.0],
    taken: [0.4, 1.0],
};
/// Repeatability, mm.
const REPEATABILITY_MM: Band = Band {
    seen: [0.005, 0.5],
    taken: [0.0005, 5.0],
};

/// What a figure of a data sheet is held against.
struct Figure<'a> {
    /// The option and its value.
    given: String,
    /// What the ratio is, with its value.
    comes_to: String,
    value: f64,
    /// What arms that are sold have.
    of: &'a str,
    band: Band,
}

impl Figure<'_> {
    /// A note where the figure is rare.
    ///
    /// # Errors
    /// Where it is taken for a mistake.
    fn judged(&self) -> Result<Option<String>, ArmError> {
        let within = |[low, high]: [f64; 2]| (low..=high).contains(&self.value);
        let [low, high] = self.band.seen;
        let [least, most] = self.band.taken;
        let Figure {
            given,
            comes_to,
            of,
            ..
        } = self;
        let said = format!("{given} {comes_to}; {of} {low} to {high}");
        if within(self.band.seen) {
            return Ok(None);
        }
        if within(self.band.taken) {
            return Ok(Some(format!(
                "{said}: is it the right figure, in the right unit?"
            )));
        }
        let said =
            format!("{said}, and what is below {least} or above {most} is taken for a mistake");
        Err(ArmErrorKind::Implausible(said).into())
    }
}

/// Notes on what is rare in a data sheet for this chain.
///
/// # Errors
/// What no arm has: value, what it comes to, and the band.
pub(super) fn notes(
    chain: &Chain,
    lengths: &Lengths,
    sheet: &DataSheet,
) -> Result<Vec<String>, ArmError> {
    let mut figures = Vec::new();
    let length_m = lengths.reach;
    if let Some(reach_m) = sheet.reach_m {
        let travel_m = chain.travel_m();
        // Of an arm on a track a sheet gives the arm's reach, of a gantry that of its slides.
        let with_travel = travel_m > 0.0 && reach_m - 1e-3 > length_m;
        let length_m = length_m + if with_travel { travel_m } else { 0.0 };
        let travel = match with_travel {
            true => format!(", {} m of travel of its slides included", short(travel_m)),
            false => String::new(),
        };
        figures.push(Figure {
            given: format!("--reach {reach_m} m"),
            comes_to: format!(
                "is {} of the {length_m:.3} m from the first joint to the flange along the stretched chain of the file{travel}",
                short(reach_m / length_m)
            ),
            // A data sheet is rounded to millimetres.
            value: (reach_m - 1e-3) / length_m,
            of: "arms that are sold have",
            band: REACH_OVER_LENGTH,
        });
    }
    if chain.joints.len() >= FEWEST_JOINTS {
        figures.extend(of_mass(chain, length_m, sheet));
    }
    if let Some(repeatability_mm) = sheet.repeatability_mm {
        figures.push(Figure {
            given: format!("--repeatability {repeatability_mm} mm"),
            comes_to: "is not what data sheets state".to_owned(),
            value: repeatability_mm,
            of: "they state",
            band: REPEATABILITY_MM,
        });
    }
    let mut notes = Vec::new();
    for figure in figures {
        notes.extend(figure.judged()?);
    }
    Ok(notes)
}

fn of_mass(chain: &Chain, length_m: f64, sheet: &DataSheet) -> [Figure<'static>; 2] {
    let moving_kg: f64 = chain.moving().map(|body| body.link.mass_kg).sum();
    let mass_kg = sheet.mass_kg.unwrap_or(moving_kg + chain.base.mass_kg);
    let mass = match sheet.mass_kg {
        Some(mass_kg) => format!("--mass {mass_kg} kg"),
        None => format!("the file's mass, {} kg,", short(mass_kg)),
    };
    let over_length = mass_kg / length_m.powi(2);
    let over_mass = sheet.payload_kg / mass_kg;
    [
        Figure {
            given: mass,
            comes_to: format!(
                "over a stretched length of {length_m:.3} m is {} kg/m^2",
                short(over_length)
            ),
            value: over_length,
            of: "arms that are sold have",
            band: MASS_OVER_LENGTH_SQUARED,
        },
        Figure {
            given: format!("--payload {} kg", sheet.payload_kg),
            comes_to: format!("is {} of the arm's {} kg", short(over_mass), short(mass_kg)),
            value: over_mass,
            of: "arms that are sold carry",
            band: PAYLOAD_OVER_MASS,
        },
    ]
}

/// Three digits.
pub(crate) fn short(value: f64) -> String {
    let rounded = format!("{value:.2e}").parse::<f64>();
    format!("{}", rounded.unwrap_or(value))
}
