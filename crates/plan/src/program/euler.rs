//! Frames as millimetres and three angles, as most robot languages hold them.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::number::fixed;

/// x, y, z in mm and the turns about fixed x, then y, then z in degrees.
pub(super) fn pose_of([x, y, z]: [f64; 3], [rx, ry, rz]: [f64; 3]) -> Isometry3<f64> {
    let [rx, ry, rz] = [rx, ry, rz].map(f64::to_radians);
    Isometry3::from_parts(
        Translation3::from(Vector3::new(x, y, z) * 1e-3),
        UnitQuaternion::from_euler_angles(rx, ry, rz),
    )
}

/// The same as texts, with so many decimals of mm and degrees.
pub(super) fn texts(pose: &Isometry3<f64>, mm: usize, deg: usize) -> ([String; 3], [String; 3]) {
    let place = (pose.translation.vector * 1e3).map(|v| fixed(v, mm));
    let (rx, ry, rz) = pose.rotation.euler_angles();
    let turns = [rx, ry, rz].map(|angle| fixed(angle.to_degrees(), deg));
    let [x, y, z] = place.into();
    ([x, y, z], turns)
}
