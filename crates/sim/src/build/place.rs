//! Where a run begins, as a sign of places in another unit.

use nalgebra::Vector3;
use truecut_arm::Robot;
use truecut_recording::significant;
use truecut_scenario::Scenario;

/// Keys below a process by which it is put before the arm, mm.
const PLACES: [&str; 4] = [
    "path.start_mm",
    "path.work_xyz_mm",
    "face.origin_mm",
    "surface.xyz_mm",
];

/// That the tool begins within the arm's own foot, where the scenario says its place in mm: metres
/// put it there.
pub(super) fn place_note(
    scenario: &Scenario,
    robot: &Robot,
    tool_m: &Vector3<f64>,
) -> Option<String> {
    let off_m = robot.within_foot_m(tool_m)?;
    let process = scenario.process.name();
    let mut keys = PLACES
        .iter()
        .map(|place| format!("process.{process}.{place}"));
    let key = keys.find(|key| scenario.gives(key))?;
    Some(format!(
        "the tool begins {} mm off the origin of the arm, within its own foot: `{key}` is in mm; was it given in \
         metres?",
        significant(1e3 * off_m, 2)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_place_in_metres_is_told() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let file = root.join("scenarios/milling/path_600.toml");
        let scenario = Scenario::load(&file, &[]).unwrap();
        let spec = &scenario.robot;
        let robot = Robot::load(&spec.urdf, spec.config.as_deref(), None).unwrap();
        let [x, y, z] = [1.05, -1.45, 0.87];
        assert_eq!(place_note(&scenario, &robot, &Vector3::new(x, y, z)), None);
        let told = place_note(&scenario, &robot, &(1e-3 * Vector3::new(x, y, z))).unwrap();
        let note = "the tool begins 2.0 mm off the origin of the arm, within its own foot: \
                    `process.milling.path.start_mm` is in mm; was it given in metres?";
        assert_eq!(told, note);
        // A posture says where the tool is without any millimetres.
        let posed = root.join("scenarios/chamfer/forward_300.toml");
        let posed = Scenario::load(&posed, &[]).unwrap();
        assert_eq!(place_note(&posed, &robot, &Vector3::zeros()), None);
    }
}
