//! Links and rotors that differ from the robot's files, and arguments that its file takes.

use std::path::Path;
use truecut_scenario::Scenario;
use truecut_sim::Robots;
use truecut_sim::facts::robot_facts;
use truecut_sim::run::{Finished, Run, RunError};

fn run(scenario: &Scenario) -> Result<Finished, RunError> {
    Run::of(scenario).execute()
}

fn scenario(tables: &str) -> Scenario {
    let text = format!(
        r#"
name = "test"
[robot]
urdf = "../../assets/robots/arm_2r/robot.urdf"
posture_deg = [30, 40]
{tables}
[run]
duration_s = 0.05
[process.load]
release_n = [0, 100, 0]
"#
    );
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/of_a_test.toml");
    Scenario::from_str(&at, &text, &[]).unwrap_or_else(|error| panic!("{error:?}"))
}

fn names() -> (String, String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/arm_2r/robot.urdf");
    let robot = truecut_arm::Robot::load(&path, None, None).unwrap();
    (
        robot.chain.links[1].name.clone(),
        robot.chain.joints[1].name.clone(),
    )
}

fn tables(factor: f64, center_mm: f64, rotor: f64) -> String {
    let (link, joint) = names();
    format!(
        "[[robot.link]]\nname = \"{link}\"\nmass_factor = {factor:?}\ncenter_x_mm = {center_mm:?}\n\
         [[robot.joint]]\nname = \"{joint}\"\nrotor_inertia_factor = {rotor:?}\n"
    )
}

#[test]
fn a_link_and_a_rotor_as_in_the_files_change_no_bit() {
    let plain = run(&scenario("")).unwrap().recording;
    let given = run(&scenario(&tables(1.0, 0.0, 1.0))).unwrap().recording;
    assert_eq!(plain.columns, given.columns);
}

#[test]
fn each_of_them_changes_the_run() {
    let plain = run(&scenario("")).unwrap().recording;
    for (factor, center) in [(1.2, 0.0), (1.0, 30.0)] {
        let other = run(&scenario(&tables(factor, center, 1.0)))
            .unwrap()
            .recording;
        assert_ne!(plain.columns, other.columns, "{factor} {center}");
    }
}

#[test]
fn factors_of_one_joint_are_those_of_all_where_there_is_one() {
    let tables = |stiffness: f64, damping: f64| {
        let joints = ["shoulder", "elbow"].map(|joint| {
            format!(
                "[[robot.joint]]\nname = \"{joint}\"\nstiffness_factor = {stiffness:?}\n\
                 damping_factor = {damping:?}\n"
            )
        });
        run(&scenario(&joints.concat())).unwrap().recording.columns
    };
    let scales = "stiffness_scale = 0.5\ndamping_scale = 3.0\n";
    assert_eq!(
        tables(0.5, 3.0),
        run(&scenario(scales)).unwrap().recording.columns
    );
    for (stiffness, damping) in [(0.5, 1.0), (1.0, 3.0)] {
        assert_ne!(tables(stiffness, damping), tables(1.0, 1.0));
    }
}

#[test]
fn verify_the_moving_mass_follows_the_factor_of_a_link() {
    let mass = |tables: &str| robot_facts(&scenario(tables)).unwrap().moving_mass_kg;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/arm_2r/robot.urdf");
    let own = truecut_arm::Robot::load(&path, None, None)
        .unwrap()
        .chain
        .links[1]
        .mass_kg;
    let added = mass(&tables(1.5, 0.0, 1.0)) - mass("");
    assert!((added - 0.5 * own).abs() < 1e-12, "{added} of {own}");
}

#[test]
fn a_link_that_is_not_there_is_refused_at_its_name() {
    let scenario = scenario("[[robot.link]]\nname = \"uper_arm\"\n");
    let error = run(&scenario).unwrap_err().to_string();
    assert!(error.contains("uper_arm"), "{error}");
}

/// The mass on a spring as a xacro file in a folder, its mass an argument.
fn mass_as_an_argument() -> tempfile::TempDir {
    let rig = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof");
    let urdf = std::fs::read_to_string(rig.join("robot.urdf")).unwrap();
    let head = "<robot name=\"rig_1dof\">";
    let mass = "<mass value=\"100\"/>";
    assert!(urdf.contains(head) && urdf.contains(mass));
    let xacro = urdf.replacen(
        head,
        "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"rig_1dof\">\n\
         <xacro:arg name=\"mass\" default=\"100\"/>",
        1,
    );
    let xacro = xacro.replacen(mass, "<mass value=\"$(arg mass)\"/>", 1);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rig.urdf.xacro"), xacro).unwrap();
    std::fs::write(folder.path().join("rig.urdf"), urdf).unwrap();
    std::fs::copy(rig.join("robot.toml"), folder.path().join("robot.toml")).unwrap();
    folder
}

fn with_arguments(folder: &Path, urdf: &str, arguments: &str) -> Scenario {
    let text = format!(
        "name = \"test\"\n[robot]\nurdf = \"{urdf}\"\n{arguments}\n[run]\nduration_s = 0.05\n\
         [process.load]\nframe = \"world\"\nrelease_n = [100, 0, 0]\n"
    );
    let at = folder.join("of_a_test.toml");
    Scenario::from_str(&at, &text, &[]).unwrap_or_else(|error| panic!("{error:?}"))
}

#[test]
fn arguments_make_another_robot_of_one_file() {
    let folder = mass_as_an_argument();
    let of = |arguments: &str| with_arguments(folder.path(), "rig.urdf.xacro", arguments);
    let (own, light) = (of(""), of("arguments = { mass = 50 }"));
    let mass = |scenario: &Scenario| robot_facts(scenario).unwrap().moving_mass_kg;
    assert_eq!((mass(&own), mass(&light)), (100.0, 50.0));
    let set = [("robot.arguments.mass".to_owned(), "25.5".to_owned())];
    assert_eq!(mass(&own.with_overrides(&set).unwrap()), 25.5);

    // Robots that are kept are kept apart.
    let robots = Robots::new();
    let columns = |scenario: &Scenario| {
        let run = Run {
            robots: Some(&robots),
            ..Run::of(scenario)
        };
        run.execute().unwrap().recording.columns
    };
    let plain = columns(&with_arguments(folder.path(), "rig.urdf", ""));
    assert_eq!(columns(&own), plain);
    assert_ne!(columns(&light), plain);
    assert_eq!(columns(&of("arguments = { mass = 100 }")), plain);
}

#[test]
fn an_argument_that_the_file_does_not_have_is_refused_at_its_key() {
    let folder = mass_as_an_argument();
    for (urdf, arguments, name, why) in [
        (
            "rig.urdf.xacro",
            "arguments = { mas = 50 }",
            "mas",
            "did you mean \"mass\"?",
        ),
        (
            "rig.urdf",
            "[robot.arguments]\nmass = 50",
            "mass",
            "the file is no xacro and has none",
        ),
    ] {
        let error = match run(&with_arguments(folder.path(), urdf, arguments)) {
            Err(RunError::Scenario(error)) => error,
            Err(other) => panic!("{urdf}: {other}"),
            Ok(_) => panic!("{urdf}: accepted"),
        };
        let problem = error.problems().next().unwrap();
        assert_eq!(problem.key, format!("robot.arguments.{name}"));
        let line = 3 + arguments.lines().count();
        assert_eq!(problem.line(), Some(line), "{problem}");
        assert!(problem.message.contains(why), "{problem}");
    }
}
