//! Clearances of an arm along a program, as they are found and told.

use std::path::Path;

use rayon::prelude::*;
use truecut_arm::Robot;
use truecut_plan::clearance::{Approach, Cell, Clearances, Own, Place, Station};
use truecut_recording::Unit;
use truecut_scenario::CellFile;
use truecut_sim::Surroundings;

use crate::failure::Failure;
use crate::text::{row, show};

/// Pairs that are listed individually.
const LISTED: usize = 10;

/// A cell, and how near its bodies come along a path.
pub struct Checked {
    cell: Cell,
    found: Clearances,
    stations: Vec<Station>,
}

impl Checked {
    /// Follows a path through a cell.
    pub fn of(robot: &Robot, cell: Cell, stations: Vec<Station>) -> Self {
        let found = cell.along(robot, &stations);
        Self {
            cell,
            found,
            stations,
        }
    }

    /// A cell of a file about an arm.
    pub fn cell(robot: &Robot, file: &Path) -> Result<Cell, Failure> {
        let file = CellFile::load(file, &robot.frames.flange_from_tool)?;
        let cell = Cell::new(robot, &file.setup, &Own::default());
        cell.map_err(|error| file.refused(&error).into())
    }

    /// The cell of a path job, or of a scenario with a way of its own: part and tool are theirs.
    pub fn cell_of_job(
        robot: &Robot,
        path: &Path,
        own: &Own<'_>,
        whose: &str,
    ) -> Result<Cell, Failure> {
        let file = CellFile::load(path, &robot.frames.flange_from_tool)?;
        if file.setup.part.is_some() {
            let message = format!("`part` has no effect: {whose} gives the part");
            return Err(file.problem("part", message).into());
        }
        let cell = Cell::new(robot, &file.setup, own);
        cell.map_err(|error| file.refused(&error).into())
    }

    /// Whether no pair comes nearer than asked.
    pub fn holds(&self) -> bool {
        self.found.below.is_empty()
    }

    /// The row of the least clearance; `name` tells a path point.
    pub fn row(&self, name: &dyn Fn(usize) -> String) -> Vec<String> {
        let Some(least) = &self.found.least else {
            let what = "there is nothing that the arm could meet";
            return row("clearance", "-".to_owned(), what);
        };
        let mark = if self.holds() { "✓" } else { "✗" };
        let [one, other] = &least.pair;
        let what = format!(
            "{mark} least, of \"{one}\" from \"{other}\", {}; {} pairs, {}",
            on_the_way(&least.at, name),
            self.found.pairs,
            self.asked()
        );
        row("clearance", show(Unit::Metre, least.least_m), what)
    }

    fn asked(&self) -> String {
        match self.cell.least_m() {
            0.0 => "none may touch".to_owned(),
            least_m => format!("{} are asked", show(Unit::Metre, least_m)),
        }
    }

    /// A line on each pair that comes nearer than asked.
    pub fn faults(&self, name: &dyn Fn(usize) -> String) -> String {
        let below = self.found.below.iter();
        let told = below.take(LISTED).map(|one| self.fault(one, name));
        let mut text: String = told.collect();
        let more = self.found.below.len().saturating_sub(LISTED);
        if more > 0 {
            text.push_str(&format!("  ✗ and {more} more pairs\n"));
        }
        text
    }

    fn fault(&self, one: &Approach, name: &dyn Fn(usize) -> String) -> String {
        let [moving, other] = &one.pair;
        let first = one.first_below.map_or(one.at, |(place, _)| place);
        let how = match one.least_m {
            0.0 => "collides with".to_owned(),
            least_m => format!("comes within {} of", show(Unit::Metre, least_m)),
        };
        let asked = match self.cell.least_m() {
            0.0 => String::new(),
            _ => format!("; {}", self.asked()),
        };
        format!(
            "  ✗ \"{moving}\" {how} \"{other}\", first {}{asked}\n",
            on_the_way(&first, name)
        )
    }

    /// What was left out.
    pub fn notes(&self) -> impl Iterator<Item = &String> {
        self.cell.notes().iter().chain(&self.found.notes)
    }

    /// What stands and what is carried, to be drawn.
    pub fn surroundings(&self) -> Surroundings {
        Surroundings::of(&self.cell)
    }

    /// The shortest line between the bodies that come nearest, world.
    pub fn nearest(&self) -> Option<Vec<[f64; 3]>> {
        let least = self.found.least.as_ref()?;
        let ends = least.nearest_m?;
        Some(ends.map(Into::into).to_vec())
    }

    /// Clearance at every `every`-th station, m.
    pub fn over_stations(&self, robot: &Robot, every: usize) -> Vec<f64> {
        let stations: Vec<&Station> = self.stations.iter().step_by(every).collect();
        let each = stations.par_iter();
        each.map(|at| self.cell.clearance_m(robot, &at.posture, at.is_fed))
            .collect()
    }
}

/// A place as people read it.
fn on_the_way(at: &Place, name: &dyn Fn(usize) -> String) -> String {
    let point = name(at.path_point);
    match (at.share * 100.0).round() {
        share if share >= 100.0 => format!("at {point}"),
        share => format!("on the way to {point}, at {share:.0} %"),
    }
}
