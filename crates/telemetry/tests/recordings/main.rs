//! Recordings in files: what is written can be read back, whole or torn.

mod files;
mod killed;
mod synthetic;
