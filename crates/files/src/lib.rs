//! Files in and out, for all rooms: what is read is a file and has a size that one can hold, what
//! is written replaces what was there as a whole.

#![warn(missing_docs)]

mod cells;
mod input;
mod memory;
mod name;
mod nesting;
mod room;
mod watched;
mod whole;

pub use cells::{CellRow, Cells, CellsError, is_comment, number};
pub use input::{MOST_BYTES, MOST_TEXT_BYTES, open, open_own, read, read_raw_text, read_text};
pub use memory::{limit_memory, memory_limit};
pub use name::folder_name;
pub use nesting::{MOST_NESTED, too_deep};
pub use room::room_bytes;
pub use watched::{was_read, watched};
pub use whole::{continued, fresh, write_whole};
