//! How hard must the foot press? For each friction coefficient the lowest pressure at which it
//! holds is searched, and compared with two formulas.
//!
//! `cargo run --release -p truecut --example sweep`

use std::error::Error;
use std::path::Path;

use truecut::{Scenario, SweepTable, sweep};

/// The shipped sweep, all rows in parallel.
pub fn run() -> Result<(Scenario, SweepTable), Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/chamfer/threshold.toml");
    let scenario = Scenario::load(&file, &[])?;
    let table = sweep(&scenario, &|_| {})?;
    Ok((scenario, table))
}

pub fn main() -> Result<(), Box<dyn Error>> {
    let (scenario, table) = run()?;
    let headings: Vec<String> = (table.columns.iter())
        .map(|column| format!("{} [{}]", column.short_name(), column.unit.symbol))
        .collect();
    println!("{}", headings.join("  "));
    for row in &table.rows {
        let cells: Vec<String> = (row.iter().zip(&headings))
            .map(|(value, heading)| format!("{value:>width$.4}", width = heading.len()))
            .collect();
        println!("{}", cells.join("  "));
    }
    let claims = table.claims(&scenario);
    for claim in &claims {
        println!("{}: {}", claim.name, claim.shown);
    }
    assert_eq!(table.count_unfinished(), 0);
    assert!(claims.iter().all(|claim| claim.holds));
    Ok(())
}
