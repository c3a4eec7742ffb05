//! Clearances against exact distances of primitives, on arms and bodies that are drawn from seeds.

use std::path::Path;

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::Robot;

use super::motion::frames;
use super::*;
use crate::surface::{Mesh, MeshUse};

/// Numbers from a seed (splitmix64).
struct Random(u64);

impl Random {
    fn within(&mut self, range: std::ops::Range<f64>) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let share = ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        range.start + share * (range.end - range.start)
    }
}

/// Half lengths of the capsules of the arm and their radii, m.
const HALF_M: f64 = 0.15;
const RADIUS_M: f64 = 0.04;

/// Three joints, each turning a capsule of its own, and a tool point.
fn arm(draw: &mut Random) -> Robot {
    let mut text = String::from("<robot name=\"r\">\n<link name=\"base\"/>\n");
    for k in 1..=3 {
        let length = 2.0 * HALF_M;
        text += &format!(
            "<link name=\"l{k}\"><collision><origin xyz=\"0 0 {HALF_M}\"/><geometry>\
             <capsule radius=\"{RADIUS_M}\" length=\"{length}\"/></geometry></collision></link>\n"
        );
        let parent = if k == 1 {
            "base".to_owned()
        } else {
            format!("l{}", k - 1)
        };
        let [x, y, z] = [(); 3].map(|()| draw.within(-1.0..1.0));
        let far = if k == 1 { 0.0 } else { 2.0 * HALF_M };
        text += &format!(
            "<joint name=\"j{k}\" type=\"revolute\"><parent link=\"{parent}\"/>\
             <child link=\"l{k}\"/><origin xyz=\"0 0 {far}\"/><axis xyz=\"{x} {y} {z}\"/>\
             <limit lower=\"-3\" upper=\"3\" velocity=\"1\" effort=\"1\"/></joint>\n"
        );
    }
    let folder = tempfile::tempdir().expect("a folder");
    let urdf = folder.path().join("robot.urdf");
    std::fs::write(&urdf, text + "</robot>\n").expect("written");
    Robot::load_kinematics(&urdf, None, None).expect("an arm")
}

fn pose(draw: &mut Random, reach_m: f64) -> Isometry3<f64> {
    let mut vector = |by: f64| Vector3::from([(); 3].map(|()| draw.within(-by..by)));
    let place = vector(reach_m);
    Isometry3::from_parts(place.into(), UnitQuaternion::new(vector(3.0)))
}

fn form(draw: &mut Random) -> Form {
    let mut size = || draw.within(0.05..0.4);
    let (x, y, z) = (size(), size(), size());
    match z > 0.2 {
        true => Form::Box {
            sides_m: Vector3::new(x, y, z),
        },
        false => Form::Cylinder {
            radius_m: 0.5 * x,
            length_m: y,
        },
    }
}

/// Exact distance of a point from a form.
fn from_form(form: &Form, p: &Vector3<f64>) -> f64 {
    match form {
        Form::Box { sides_m } => (p.abs() - sides_m * 0.5).map(|out| out.max(0.0)).norm(),
        Form::Cylinder { radius_m, length_m } => {
            let beside = (p.x.hypot(p.y) - radius_m).max(0.0);
            beside.hypot((p.z.abs() - 0.5 * length_m).max(0.0))
        }
        Form::Mesh(_) => unreachable!("no mesh is drawn"),
    }
}

/// Exact distance of the arm's capsules from a form: the distance from a point is convex along the
/// axis of a capsule, so that its least is found by thirds.
fn exact_m(robot: &Robot, posture: &[f64], form: &Form, at: &Isometry3<f64>) -> f64 {
    let links = robot.world_from_links(posture);
    let of_link = |link: &Isometry3<f64>| {
        let form_from_link = at.inverse() * link;
        let away = |z: f64| from_form(form, &(form_from_link * Point3::new(0.0, 0.0, z)).coords);
        let (mut low, mut high) = (0.0, 2.0 * HALF_M);
        for _ in 0..100 {
            let third = (high - low) / 3.0;
            match away(low + third) < away(high - third) {
                true => high -= third,
                false => low += third,
            }
        }
        (away(0.5 * (low + high)) - RADIUS_M).max(0.0)
    };
    links.iter().map(of_link).fold(f64::INFINITY, f64::min)
}

fn standing(name: &str, form: Form, at: &Isometry3<f64>) -> Standing {
    Standing {
        name: name.to_owned(),
        form,
        world_from_form: *at,
        may_touch: Vec::new(),
    }
}

fn posture(draw: &mut Random) -> Vec<f64> {
    (0..3).map(|_| draw.within(-2.5..2.5)).collect()
}

/// The form as triangles; a cylinder's rim has so many corners that it lies in by 1e-6 of its
/// radius.
fn mesh(form: &Form) -> Mesh {
    let outline: Vec<[f64; 2]> = match form {
        Form::Box { sides_m } => [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
            .map(|[x, y]| [x * sides_m.x, y * sides_m.y])
            .to_vec(),
        Form::Cylinder { radius_m, .. } => (0..2000)
            .map(|k| (std::f64::consts::TAU * f64::from(k) / 2000.0).sin_cos())
            .map(|(s, c)| [radius_m * c, radius_m * s])
            .collect(),
        Form::Mesh(_) => unreachable!("no mesh is drawn"),
    };
    let height = match form {
        Form::Box { sides_m } => sides_m.z,
        Form::Cylinder { length_m, .. } => *length_m,
        Form::Mesh(_) => unreachable!("no mesh is drawn"),
    };
    let n = outline.len();
    let ring = |z: f64| outline.iter().map(move |[x, y]| Vector3::new(*x, *y, z));
    let mut vertices: Vec<_> = ring(-0.5 * height).chain(ring(0.5 * height)).collect();
    vertices.extend([
        Vector3::z() * (-0.5 * height),
        Vector3::z() * (0.5 * height),
    ]);
    let side = |k: usize| {
        let next = (k + 1) % n;
        [
            [k, next, n + next],
            [k, n + next, n + k],
            [2 * n, next, k],
            [2 * n + 1, n + k, n + next],
        ]
    };
    let triangles: Vec<_> = (0..n).flat_map(side).collect();
    Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a closed mesh")
}

/// Arms, boxes and cylinders drawn at random, these as primitives and as meshes: the clearance is
/// within 0.1 mm of the exact distance.
#[test]
fn verify_clearances_of_drawn_primitives_are_their_exact_distances() {
    let mut draw = Random(28);
    let (mut worst_m, mut apart) = (0.0_f64, 0);
    for _ in 0..60 {
        let robot = arm(&mut draw);
        let (form, at) = (form(&mut draw), pose(&mut draw, 0.9));
        let setup = CellSetup {
            fixtures: vec![standing("fixture", form.clone(), &at)],
            ..CellSetup::default()
        };
        let own = mesh(&form);
        let as_mesh = Own {
            part: vec![(&own, at)],
            tools: Vec::new(),
        };
        let cells = [
            Cell::new(&robot, &setup, &Own::default()),
            Cell::new(&robot, &CellSetup::default(), &as_mesh),
        ]
        .map(|cell| cell.expect("a cell"));
        for _ in 0..10 {
            let posture = posture(&mut draw);
            let exact = exact_m(&robot, &posture, &form, &at);
            for cell in &cells {
                let found = cell.clearance_m(&robot, &posture, false);
                // A capsule within a mesh is no nearer to its skin than it is.
                let is_within = exact == 0.0 && cell.begins_within_any(&robot, &posture);
                if !is_within {
                    worst_m = worst_m.max((found - exact).abs());
                }
            }
            apart += usize::from(exact > 0.0);
        }
    }
    assert!(apart > 300, "{apart} of 600 postures are clear");
    assert!(worst_m < 1e-4, "{worst_m}");
}

impl Cell {
    fn begins_within_any(&self, robot: &Robot, posture: &[f64]) -> bool {
        let frames = frames(robot, posture);
        let mut pairs = self.pairs.iter();
        pairs.any(|pair| self.begins_within(pair, &frames))
    }
}

/// Along ways of all joints that are drawn at random the least clearance is that of a dense survey
/// of exact distances, within its tolerance; where bodies touch it is told.
#[test]
fn verify_the_least_clearance_along_drawn_ways_is_that_of_exact_distances() {
    let mut draw = Random(2803);
    let (mut touched, mut clear) = (0, 0);
    for _ in 0..40 {
        let robot = arm(&mut draw);
        let (form, at) = (form(&mut draw), pose(&mut draw, 0.8));
        let setup = CellSetup {
            fixtures: vec![standing("fixture", form.clone(), &at)],
            ..CellSetup::default()
        };
        let cell = Cell::new(&robot, &setup, &Own::default()).expect("a cell");
        let ends = [posture(&mut draw), posture(&mut draw), posture(&mut draw)];
        let mut stations = Vec::new();
        let mut exact = f64::INFINITY;
        for (leg, pair) in ends.windows(2).enumerate() {
            for k in 0..=2000 {
                let t = f64::from(k) / 2000.0;
                let each = pair[0].iter().zip(&pair[1]);
                let posture: Vec<f64> = each.map(|(a, b)| a + t * (b - a)).collect();
                exact = exact.min(exact_m(&robot, &posture, &form, &at));
                // The path is told by one station in a hundred; levers change in between.
                if k % 100 == 0 {
                    stations.push(Station {
                        path_point: leg + 1,
                        posture,
                        is_fed: false,
                    });
                }
            }
        }
        let found = cell.along(&robot, &stations);
        let least = found.least.expect("a pair");
        let tolerance = TOLERANCE_M.max(TOLERANCE_SHARE * exact) + 1e-6;
        // The survey itself passes the least by a way of half its steps at most.
        let survey_m = 4e-3;
        assert!(
            least.least_m < exact + tolerance && least.least_m > exact - survey_m,
            "{} for {exact}",
            least.least_m
        );
        match least.least_m == 0.0 {
            true => {
                touched += 1;
                assert_eq!(
                    found.below.len(),
                    found.below.iter().filter(|one| one.least_m == 0.0).count()
                );
                assert!(!found.below.is_empty());
            }
            false => {
                clear += 1;
                assert!(found.below.is_empty());
                let [p, q] = least.nearest_m.expect("apart");
                assert!(((p - q).norm() - least.least_m).abs() < 1e-6);
            }
        }
    }
    assert!(touched > 5 && clear > 5, "{touched} touch, {clear} do not");
}

fn fixed(x: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, 0.0, 0.0), UnitQuaternion::identity())
}

fn cube(side_m: f64) -> Form {
    Form::Box {
        sides_m: Vector3::repeat(side_m),
    }
}

fn refused(robot: &Robot, setup: &CellSetup) -> CellError {
    Cell::new(robot, setup, &Own::default())
        .err()
        .expect("it is refused")
}

#[test]
fn bodies_within_bodies_and_names_that_nobody_has_are_refused_with_their_keys() {
    let robot = arm(&mut Random(1));
    let part = || Some(standing("part", cube(0.2), &fixed(2.0)));
    let with = |fixture: Standing| CellSetup {
        part: part(),
        fixtures: vec![standing("table", cube(0.1), &fixed(3.0)), fixture],
        ..CellSetup::default()
    };
    let inner = refused(&robot, &with(standing("pin", cube(0.05), &fixed(2.05))));
    assert_eq!(inner.key, "fixture.1.name");
    assert!(inner.to_string().contains("\"pin\" lies inside \"part\""));
    let outer = refused(&robot, &with(standing("vice", cube(0.5), &fixed(2.0))));
    assert!(outer.to_string().contains("\"part\" lies inside \"vice\""));
    let twice = refused(&robot, &with(standing("table", cube(0.1), &fixed(4.0))));
    assert_eq!(twice.key, "fixture.0.name");
    let stranger = Standing {
        may_touch: vec!["l9".to_owned()],
        ..standing("vice", cube(0.1), &fixed(4.0))
    };
    let stranger = refused(&robot, &with(stranger));
    assert_eq!(stranger.key, "fixture.1.may_touch");
    assert!(
        stranger.to_string().contains("base, l1, l2, l3"),
        "{stranger}"
    );
    let file = Path::new("nowhere.stl").to_owned();
    let missing = Form::Mesh(crate::surface::MeshFile { file, unit_m: 1e-3 });
    let missing = refused(&robot, &with(standing("vice", missing, &fixed(4.0))));
    assert_eq!(missing.key, "fixture.1.shape.mesh");
    assert!(missing.to_string().contains("nowhere.stl"));
}

/// What works on the part may touch it where it is fed, and there only; what stands in the way of
/// links that may touch it does not count.
#[test]
fn a_tool_may_touch_the_part_where_it_is_fed() {
    let robot = arm(&mut Random(3));
    let at = robot.world_from_links(&[0.0; 3])[2] * Isometry3::translation(0.0, 0.0, 0.5);
    let tool = |cuts: bool| Carried {
        name: "wheel".to_owned(),
        form: cube(0.02),
        flange_from_form: Isometry3::translation(0.0, 0.0, 0.5),
        cuts,
    };
    let station = |path_point: usize, by: f64, is_fed: bool| Station {
        path_point,
        posture: vec![0.0, 0.0, by],
        is_fed,
    };
    // The part stands where the tool is at the end of the feed.
    let ways = [
        station(0, 0.3, false),
        station(1, 0.29, false),
        station(2, 0.0, true),
    ];
    let along = |cuts: bool, part: bool, may_touch: &[&str], stations: &[Station]| {
        let own = Standing {
            may_touch: may_touch.iter().map(|name| (*name).to_owned()).collect(),
            ..standing("block", cube(0.03), &at)
        };
        let setup = CellSetup {
            carried: vec![tool(cuts)],
            part: part.then(|| own.clone()),
            fixtures: if part { Vec::new() } else { vec![own] },
            ..CellSetup::default()
        };
        let cell = Cell::new(&robot, &setup, &Own::default()).expect("a cell");
        cell.along(&robot, stations).below
    };
    assert!(along(true, true, &[], &ways).is_empty());
    let told = along(false, true, &[], &ways);
    assert_eq!(told[0].pair, ["wheel".to_owned(), "block".to_owned()]);
    let (first, _) = told[0].first_below.expect("a place");
    assert!(
        first.path_point == 2 && first.share > 0.5 && first.share < 1.0,
        "{first:?}"
    );
    assert_eq!(along(true, false, &[], &ways).len(), 1);
    assert!(along(true, false, &["wheel"], &ways).is_empty());
    let free: Vec<Station> = ways
        .iter()
        .map(|one| Station {
            is_fed: false,
            ..one.clone()
        })
        .collect();
    assert_eq!(along(true, true, &[], &free).len(), 1);
}
