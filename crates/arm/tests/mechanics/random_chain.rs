//! Robots that nobody would build: 1 to 7 joints of either kind, oblique axes, off-centre masses,
//! and joints that others take along.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use truecut_arm::{Chain, Follower, Frames, Joint, JointKind, Link, Robot, Transmission};

/// A robot with a state: posture (rad or m), velocity, acceleration.
#[derive(Debug, Clone)]
pub struct Case {
    pub robot: Robot,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
}

type Part = (Joint, Link, (f64, f64, f64), Option<(f64, f64, f64)>);

/// Whether a joint follows another: which of them as a share, multiplier, offset.
fn following() -> impl Strategy<Value = Option<(f64, f64, f64)>> {
    prop::option::weighted(0.3, (0.0..1.0_f64, -1.5..1.5_f64, -1.0..1.0_f64))
}

pub fn case() -> impl Strategy<Value = Case> {
    prop::collection::vec((joint(), link(), state(), following()), 1..=7)
        .prop_flat_map(|parts| (Just(parts), pose(), pose(), pose()))
        .prop_map(|(parts, flange, tool, foot)| {
            let (mut joints, mut links) = (Vec::new(), Vec::new());
            let (mut q, mut v, mut a) = (Vec::new(), Vec::new(), Vec::new());
            // The first joint moves by itself, so that there is one to follow.
            let leads = |(i, part): (usize, &Part)| i == 0 || part.3.is_none();
            let leaders = parts.iter().enumerate().filter(|part| leads(*part)).count();
            let mut followers = Vec::new();
            for (i, (mut joint, mut link, state, following)) in parts.into_iter().enumerate() {
                joint.name = format!("joint_{i}");
                link.name = format!("link_{i}");
                if let (1.., Some((share, multiplier, offset))) = (i, following) {
                    followers.push(Follower {
                        name: joint.name,
                        kind: joint.kind,
                        parent_from_joint: joint.parent_from_joint,
                        axis: joint.axis,
                        limits: None,
                        after: joints.len(),
                        follows: (share * leaders as f64) as usize,
                        multiplier,
                        offset,
                        link,
                    });
                    continue;
                }
                joints.push(joint);
                links.push(link);
                q.push(state.0);
                v.push(state.1);
                a.push(state.2);
            }
            let mut robot = assemble(joints, links, [flange, tool, foot]);
            robot.chain.followers = followers;
            Case { robot, q, v, a }
        })
}

pub fn assemble(joints: Vec<Joint>, links: Vec<Link>, frames: [Isometry3<f64>; 3]) -> Robot {
    Robot {
        name: "random".into(),
        chain: Chain {
            name: "random".into(),
            joints,
            links,
            followers: Vec::new(),
            base: body("base", 0.0, Vector3::zeros(), Matrix3::zeros()),
            tip: "tip".into(),
            notes: Vec::new(),
            motion_doubts: Vec::new(),
            estimated_masses: Vec::new(),
            placeholders: None,
        },
        frames: Frames {
            last_link_from_flange: frames[0],
            flange_from_tool: frames[1],
            flange_from_foot: frames[2],
        },
        urdf_path: "random.urdf".into(),
        config_path: None,
        damping_ratios: Vec::new(),
        tool_load: None,
    }
}

pub fn body(name: &str, mass_kg: f64, com_m: Vector3<f64>, inertia: Matrix3<f64>) -> Link {
    Link {
        name: name.into(),
        mass_kg,
        com_m,
        inertia_about_com_kg_m2: inertia,
        visuals: Vec::new(),
        meshes: Vec::new(),
        solids: Default::default(),
    }
}

pub fn axis() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    vector(1.0)
        .prop_filter("long enough to have a direction", |v| v.norm() > 0.1)
        .prop_map(Unit::new_normalize)
}

pub fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

pub fn pose() -> impl Strategy<Value = Isometry3<f64>> {
    (vector(0.6), vector(3.0)).prop_map(|(translation, turn)| {
        Isometry3::from_parts(Translation3::from(translation), UnitQuaternion::new(turn))
    })
}

fn joint() -> impl Strategy<Value = Joint> {
    let revolute = prop::bool::weighted(0.75);
    (pose(), axis(), revolute, 4.0..7.0_f64).prop_map(|(pose, axis, revolute, magnitude)| Joint {
        name: String::new(),
        kind: if revolute {
            JointKind::Revolute
        } else {
            JointKind::Prismatic
        },
        parent_from_joint: pose,
        axis,
        limits: None,
        transmission: Transmission {
            stiffness: Some(10_f64.powf(magnitude)),
            damping: 1e-3 * 10_f64.powf(magnitude),
            ..Transmission::default()
        },
        urdf_damping: 0.0,
        urdf_friction: 0.0,
    })
}

/// A box of random size, density and orientation: its inertia obeys the triangle rule by
/// construction.
fn link() -> impl Strategy<Value = Link> {
    let sides = prop::array::uniform3(0.05..0.5_f64);
    (1.0..50.0_f64, vector(0.4), sides, vector(3.0)).prop_map(|(mass, com, sides, turn)| {
        let [x, y, z] = sides.map(|side| side * side);
        let moments = Vector3::new(y + z, x + z, x + y) * (mass / 12.0);
        let rotation = *Rotation3::new(turn).matrix();
        let inertia = rotation * Matrix3::from_diagonal(&moments) * rotation.transpose();
        body("", mass, com, inertia)
    })
}

fn state() -> impl Strategy<Value = (f64, f64, f64)> {
    (-2.0..2.0_f64, -2.0..2.0_f64, -5.0..5.0_f64)
}
