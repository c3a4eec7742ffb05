//! G-code (ISO 6983, as RS-274 controls read it): words of blocks, and the modal state.

mod arcs;
mod known;
mod state;
mod travel;
mod words;

use std::path::Path;

use super::{CamOptions, CamPath};
use crate::program::ProgramError;
use crate::program::ProgramErrorKind;
use state::State;

/// By how much the radii at both ends of an arc may differ, m.
const ARC_CLOSES_M: f64 = 1e-5;

/// Reads G-code.
///
/// # Errors
/// At the first word that is not understood or would need what is not known: compensation of the
/// cutter's radius, canned cycles, subprograms, a feed that is missing, an arc that does not close.
pub fn read(text: &str, file: &Path, options: &CamOptions) -> Result<CamPath, ProgramError> {
    let mut state = State::new(options);
    let (mut tapes, mut ends) = (0, false);
    for (i, line) in text.lines().enumerate() {
        tapes += usize::from(line.trim_start().starts_with('%'));
        if line.trim_start().starts_with('/') {
            state.note(
                i + 1,
                "a block that begins with / is run, as by a control whose block delete is off",
            );
        }
        let done = words::block(line).and_then(|words| state.block(&words, i + 1));
        match done {
            Ok(true) => {}
            Ok(false) => {
                ends = true;
                break;
            }
            Err(kind) => return Err(ProgramError::in_file(file, i + 1, kind)),
        }
    }
    let last = text.lines().count().max(1);
    if tapes == 1 && !ends {
        state.note(
            last,
            "the file begins with % and ends with neither % nor M2 nor M30: it may be cut short",
        );
    }
    ProgramErrorKind::unless_too_many(state.path.points.len())
        .map_err(|kind: ProgramErrorKind| ProgramError::in_file(file, last, kind))?;
    (state.end()).map_err(|(line, kind)| ProgramError::in_file(file, line, kind))
}
