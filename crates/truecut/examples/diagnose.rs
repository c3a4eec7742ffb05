//! What is wrong with this arm? Measured torques and tool heights against a simulation that lacks
//! something.
//!
//! `cargo run --release -p truecut --example diagnose`

use std::error::Error;
use std::path::Path;

use truecut::discrepancy::diagnose::{Answer, Options, Verdict, diagnose};
use truecut::discrepancy::trial::Trial;
use truecut::{RunError, Scenario, data};

/// The diagnosis of the shipped scenario, whose data have play in the elbow.
pub fn run() -> Result<Answer, Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/diagnosis/elbow.toml");
    let scenario = Scenario::load(&file, &[])?;
    let measured = data::measured(&scenario, None)?;
    let trial = Trial::new(&scenario, &measured).map_err(|error| RunError::of(&scenario, error))?;
    Ok(diagnose(
        &trial,
        &trial.observation,
        &Options::default(),
        &|_| {},
    )?)
}

pub fn main() -> Result<(), Box<dyn Error>> {
    let answer = run()?;
    let diagnosis = &answer.diagnosis;
    println!("{:?}: {}", diagnosis.verdict, diagnosis.reason);
    for cause in &diagnosis.causes {
        println!(
            "{} on {}",
            cause.kind,
            cause.target.as_deref().unwrap_or("the whole")
        );
        for (name, found) in &cause.parameters {
            println!("  {name} = {:.6} {}", found.value, found.unit);
        }
    }
    for (channel, errors) in &diagnosis.channels {
        println!(
            "{channel}: error {:.4} before, {:.4} after, noise {:.4} {}",
            errors.before, errors.after, errors.noise_floor, errors.unit
        );
    }
    assert_eq!(diagnosis.verdict, Verdict::Named);
    assert_eq!(diagnosis.causes.len(), 1);
    assert_eq!(diagnosis.causes[0].kind, "joint_backlash");
    Ok(())
}
