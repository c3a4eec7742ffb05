//! Chamfers the back of a hole with a compliant robot: the same scenario at the
//! pressure that was too low in the experiment, and at one that suffices.
//!
//! `cargo run --release -p truecut --example chamfer`

use std::error::Error;
use std::path::Path;

use truecut::{Finished, Run, Scenario};

/// Runs the scenario at both pressures.
pub fn run() -> Result<(Finished, Finished), Box<dyn Error>> {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/chamfer/backward_low.toml");
    let scenario = Scenario::load(&file, &[])?;
    let low = Run::of(&scenario).execute()?;
    let pressure = (
        "process.chamfer.foot.pressure_mpa".to_owned(),
        "0.5".to_owned(),
    );
    let high = Run {
        overrides: vec![pressure],
        ..Run::of(&scenario)
    };
    Ok((low, high.execute()?))
}

/// Largest distance of the tool from its path in the plane of the cut, m.
pub fn aside_m(finished: &Finished) -> Result<f64, Box<dyn Error>> {
    let y = finished.recording.channel("tool.displacement_y")?;
    let z = finished.recording.channel("tool.displacement_z")?;
    Ok((y.iter().zip(z)).fold(0.0, |largest, (y, z)| y.hypot(*z).max(largest)))
}

pub fn main() -> Result<(), Box<dyn Error>> {
    let (low, high) = run()?;
    println!("claims on the run at 0.3 MPa:");
    for claim in &low.claims {
        let mark = if claim.holds { "holds" } else { "FAILS" };
        println!("  {mark}  {}: {}", claim.name, claim.shown);
    }
    for (pressure, finished) in [("0.3 MPa", &low), ("0.5 MPa", &high)] {
        println!(
            "{pressure}: the tool goes aside by {:.3} um, the chamfer's width varies by {:.3} um",
            1e6 * aside_m(finished)?,
            1e6 * finished.recording.scalar("chamfer.width_spread")?.value,
        );
    }
    assert!(low.holds(), "the scenario's claims hold of its own run");
    assert!(aside_m(&high)? < 5e-6 && aside_m(&low)? > 5e-6);
    Ok(())
}
