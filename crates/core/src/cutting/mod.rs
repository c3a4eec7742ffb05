//! Cutting: chip area, forces, the surface that is left.

pub mod chamfer;
pub mod milling;
pub mod rim;
pub mod slip_condition;

/// How far an edge stands out, m, that turns about an axis beside the tool's (or the workpiece's)
/// own: `c cos φ + s sin φ`, with the offset `[c, s]` towards `φ = 0` and a quarter of a turn ahead
/// of it.
pub fn runout_m(offset_m: [f64; 2], angle_rad: f64) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    offset_m[0] * cos + offset_m[1] * sin
}
