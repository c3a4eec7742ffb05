//! Whole-system tests of truecut. They stand in the folders beside this one:
//!
//! | folder | what |
//! | --- | --- |
//! | `verify` | whole runs against closed forms and published numbers |
//! | `validate` | against measured data, where it is available |
//! | `house` | who may depend on whom |
//! | `invalid_input`, `program` | the program as a user meets it (built with `truecut-cli`) |
//! | `crosscheck` | the same scenarios in MuJoCo (Python) |
