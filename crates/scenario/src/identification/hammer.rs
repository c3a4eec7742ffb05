//! What `[modes]` says, in SI.

use std::path::PathBuf;

use truecut_arm::FrameId;
use truecut_recording::UserUnit;
use truecut_recording::measured::TimeBase;

use super::stiffness::Axes;

/// Hammer FRFs of one posture, that of the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesSpec {
    /// Axes of the directions.
    pub axes: Axes,
    /// Frequencies that are used.
    pub band_hz: [f64; 2],
    /// Number of modes; `None` if the data are to say.
    pub count: Option<usize>,
    /// Whether modes of the tool are asked for.
    pub tool_modes: bool,
    /// Ready-made FRFs.
    pub frfs: Vec<FrfSpec>,
    /// Signals from which FRFs are to be made; they stand behind the others.
    pub impacts: Vec<ImpactSpec>,
}

/// A direction in the axes of the table, of length one.
pub type Direction = [f64; 3];

/// Where the hammer strikes, or the sensor sits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HammerPoint {
    /// Frame of the arm.
    pub frame: FrameId,
    /// From the frame's origin, in the frame's axes, m.
    pub offset_m: [f64; 3],
    /// Direction of the blow, or of the sensor.
    pub direction: Direction,
}

/// What the response is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionKind {
    /// Displacement: the FRF is a compliance.
    Displacement,
    /// Velocity: mobility.
    Velocity,
    /// Acceleration: accelerance.
    Acceleration,
}

/// A ready-made FRF in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct FrfSpec {
    /// CSV or Parquet file.
    pub file: PathBuf,
    /// Whether the first row of a CSV file names the columns.
    pub header: bool,
    /// Column of frequencies, with its unit.
    pub frequency: (String, UserUnit),
    /// Columns of the values.
    pub values: FrfValues,
    /// Column of the coherence.
    pub coherence: Option<String>,
    /// Number of averages behind it.
    pub averages: Option<usize>,
    /// Factor that turns values into SI.
    pub factor: f64,
    /// What the response is.
    pub kind: MotionKind,
    /// Where the hammer struck.
    pub excitation: HammerPoint,
    /// Where the response was measured.
    pub response: HammerPoint,
}

/// Columns of complex values.
#[derive(Debug, Clone, PartialEq)]
pub enum FrfValues {
    /// Real and imaginary part.
    Cartesian(String, String),
    /// Magnitude, phase, and the factor that turns the phase into rad.
    Polar(String, String, f64),
}

/// Blows of a hammer, as signals.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactSpec {
    /// CSV or Parquet file.
    pub file: PathBuf,
    /// Whether the first row of a CSV file names the columns.
    pub header: bool,
    /// Times of the rows.
    pub times: TimeBase,
    /// Whether the unit of a column of times is said: else that counts which the file or the
    /// column's name gives, and the one of [`ImpactSpec::times`] where they give none.
    pub is_time_unit_said: bool,
    /// The hammer's force.
    pub force: Signal,
    /// The response.
    pub response: Signal,
    /// What the response is.
    pub kind: MotionKind,
    /// Force at which a blow begins, N; `None` for a tenth of the largest.
    pub trigger_n: Option<f64>,
    /// Time before a blow that belongs to its window, s.
    pub before_s: f64,
    /// Time from a blow to the end of its window, s; `None` for the time to the next.
    pub window_s: Option<f64>,
    /// Time constant of an exponential window on both signals, s; its damping is taken off again.
    pub exponential_s: Option<f64>,
    /// Where the hammer struck.
    pub struck: HammerPoint,
    /// Where the response was measured.
    pub observed: HammerPoint,
}

/// A column and the factor that turns it into SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Its name.
    pub column: String,
    /// Factor to SI.
    pub factor: f64,
}
