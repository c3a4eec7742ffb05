//! The arm of the made-up run: where its links are, and what they look like.

use std::f64::consts::TAU;

use truecut_recording::{Arrow, Body, Frame, Geometry, Pose, Scene, Shape};

use super::{POSTURE_DEG, TOOL_M, cutting_force_n, displacement_m};

/// By how much the deflection is enlarged.
const SCALE: f64 = 300.0;

/// A rigid transform.
#[derive(Clone, Copy)]
pub(super) struct Rigid {
    at: [f64; 3],
    turn: [f64; 4],
}

impl Rigid {
    fn new(at: [f64; 3], axis: [f64; 3], angle: f64) -> Rigid {
        let (sin, cos) = (0.5 * angle).sin_cos();
        Rigid {
            at,
            turn: [axis[0] * sin, axis[1] * sin, axis[2] * sin, cos],
        }
    }

    fn rotate(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z, w] = self.turn;
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let t = cross([x, y, z], v).map(|value| 2.0 * value);
        let u = cross([x, y, z], t);
        std::array::from_fn(|i| v[i] + w * t[i] + u[i])
    }

    pub(super) fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        let turned = self.rotate(p);
        std::array::from_fn(|i| self.at[i] + turned[i])
    }

    fn then(&self, next: Rigid) -> Rigid {
        let ([x, y, z, w], [a, b, c, d]) = (self.turn, next.turn);
        let turn = [
            w * a + x * d + y * c - z * b,
            w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d,
            w * d - x * a - y * b - z * c,
        ];
        Rigid {
            at: self.apply(next.at),
            turn,
        }
    }

    fn pose(&self) -> Pose {
        Pose {
            translation_m: self.at,
            rotation_xyzw: self.turn,
        }
    }
}

pub(super) fn deflection_rad(t: f64) -> [f64; 6] {
    let d = displacement_m(t);
    [
        0.5 * d[1],
        0.4 * d[2] - 0.2 * d[0],
        0.3 * d[2],
        0.5 * d[1],
        0.6 * d[2],
        0.3 * d[1],
    ]
}

pub(super) fn joint_angles(t: f64, scale: f64) -> [f64; 6] {
    let deflection = deflection_rad(t);
    std::array::from_fn(|joint| POSTURE_DEG[joint].to_radians() + scale * deflection[joint])
}

/// Base, six links, flange.
pub(super) fn world_from_links(q: &[f64; 6]) -> Vec<Rigid> {
    let (y, z) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let steps = [
        Rigid::new([0.0, 0.0, 0.78], z, q[0]),
        Rigid::new([0.32, 0.0, 0.0], y, q[1]),
        Rigid::new([0.0, 0.0, 1.075], y, q[2] + 0.25 * TAU),
        Rigid::new([-0.2, 0.0, 1.142], z, q[3]),
        Rigid::new([0.0; 3], y, q[4]),
        Rigid::new([0.0; 3], z, q[5]),
        Rigid::new([0.0, 0.0, 0.2], z, 0.0),
    ];
    let mut links = vec![Rigid::new([0.0; 3], z, 0.0)];
    for step in steps {
        links.push(links[links.len() - 1].then(step));
    }
    links
}

fn shape(geometry: Geometry, color_rgba: [u8; 4], at: Rigid) -> Shape {
    Shape {
        geometry,
        color_rgba,
        body_from_shape: at.pose(),
    }
}

pub(super) fn scene() -> Scene {
    let mut bodies = Vec::new();
    for (path, color, accent) in [
        ("arm/true", [150, 150, 150, 110], [150, 150, 150, 110]),
        ("arm/exaggerated", [235, 110, 30, 255], [60, 60, 65, 255]),
    ] {
        let links = world_from_links(&joint_angles(0.0, 1.0));
        for (index, shapes) in link_shapes(color, accent).into_iter().enumerate() {
            let initial_pose = links[index].pose();
            bodies.push(Body {
                path: format!("{path}/link_{index}"),
                shapes,
                initial_pose,
            });
        }
    }
    let flange = world_from_links(&joint_angles(0.0, 1.0))[7];
    let x = [1.0, 0.0, 0.0];
    let plate = [
        (0.021, 0.0),
        (0.25, 0.0),
        (0.25, 0.03),
        (0.022, 0.03),
        (0.021, 0.029),
    ];
    bodies.push(Body {
        path: "workpiece".into(),
        shapes: vec![shape(
            revolved(&plate, 64),
            [120, 150, 190, 255],
            Rigid::new([0.0; 3], x, 0.0),
        )],
        initial_pose: flange.then(Rigid::new([0.0, 0.0, TOOL_M], x, 0.0)).pose(),
    });
    let arrow = |path: &str, label: &str, color_rgba| Arrow {
        path: path.into(),
        label: label.into(),
        color_rgba,
        metres_per_newton: 0.004,
    };
    Scene {
        bodies,
        arrows: vec![
            arrow(
                "force/cutting",
                "cutting force on the tool",
                [255, 220, 60, 255],
            ),
            arrow(
                "force/friction",
                "friction on the foot",
                [90, 220, 255, 255],
            ),
        ],
        fields: Vec::new(),
        deflection_scale: SCALE,
        camera: None,
    }
}

fn link_shapes(main: [u8; 4], dark: [u8; 4]) -> Vec<Vec<Shape>> {
    let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let none = Rigid::new([0.0; 3], z, 0.0);
    let at = |p| Rigid::new(p, z, 0.0);
    let across = Rigid::new([0.0; 3], x, 0.25 * TAU);
    let cylinder = |radius_m, length_m| Geometry::Cylinder { radius_m, length_m };
    let foot = [(0.034, 0.0), (0.045, 0.0), (0.045, 0.12), (0.034, 0.12)];
    let cutter = [
        (0.0, 0.0),
        (0.010, 0.0),
        (0.024, -0.014),
        (0.024, -0.10),
        (0.0, -0.10),
    ];
    vec![
        vec![shape(cylinder(0.35, 0.35), dark, at([0.0, 0.0, 0.175]))],
        vec![
            shape(cylinder(0.30, 0.40), main, at([0.0, 0.0, -0.23])),
            shape(
                Geometry::Box {
                    half_extents_m: [0.22, 0.20, 0.22],
                },
                main,
                at([0.18, 0.0, 0.0]),
            ),
        ],
        vec![
            shape(cylinder(0.20, 0.42), dark, across),
            shape(
                Geometry::Capsule {
                    radius_m: 0.14,
                    length_m: 1.075,
                },
                main,
                at([0.0, 0.0, 0.5375]),
            ),
        ],
        vec![
            shape(cylinder(0.17, 0.38), dark, across),
            shape(
                Geometry::Box {
                    half_extents_m: [0.17, 0.15, 0.25],
                },
                main,
                at([-0.15, 0.0, 0.1]),
            ),
            shape(
                Geometry::Capsule {
                    radius_m: 0.11,
                    length_m: 0.75,
                },
                main,
                at([-0.2, 0.0, 0.70]),
            ),
        ],
        vec![shape(cylinder(0.10, 0.20), dark, at([0.0, 0.0, -0.12]))],
        vec![shape(Geometry::Sphere { radius_m: 0.12 }, main, none)],
        vec![shape(cylinder(0.09, 0.10), dark, at([0.0, 0.0, 0.15]))],
        vec![
            shape(cylinder(0.07, 0.18), main, at([0.0, 0.0, 0.09])),
            shape(
                revolved(&cutter, 32),
                [200, 200, 210, main[3]],
                at([0.0, 0.0, TOOL_M]),
            ),
            shape(
                revolved(&foot, 32),
                [90, 200, 230, main[3]],
                at([0.0, 0.0, TOOL_M - 0.12]),
            ),
        ],
    ]
}

pub(super) fn frame(t: f64) -> Frame {
    let still = world_from_links(&joint_angles(t, 1.0));
    let moved = world_from_links(&joint_angles(t, SCALE));
    let start = world_from_links(&joint_angles(0.0, 1.0));
    let workpiece = start[7].then(Rigid::new([0.0, 0.0, TOOL_M], [1.0, 0.0, 0.0], 0.0));
    let mut poses: Vec<Pose> = still.iter().chain(&moved).map(Rigid::pose).collect();
    poses.push(workpiece.pose());
    let tip = moved[7].apply([0.0, 0.0, TOOL_M]);
    let [fx, fy, fz] = cutting_force_n(t);
    let cutting = start[7].rotate([fy, fz, fx]);
    let friction = start[7].rotate([-0.65 * fy, -0.65 * fz, 0.0]);
    Frame {
        time_s: t,
        poses,
        arrows: vec![(tip, cutting), (tip, friction)],
        fields: Vec::new(),
    }
}

/// The body that an outline sweeps as it turns about z: a tube, a cone, a plate with a hole.
/// The outline is a closed polygon of (radius, z) in metres, counter-clockwise with the radius
/// to the right and z up; it is turned in so many steps, at least three.
fn revolved(outline_m: &[(f64, f64)], segments: u32) -> Geometry {
    let segments = segments.max(3);
    let corners = outline_m.len() as u32;
    let angle = |segment: u32| std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
    let vertices_m = (0..segments)
        .flat_map(|segment| {
            let (sin, cos) = angle(segment).sin_cos();
            outline_m
                .iter()
                .map(move |(radius, z)| [radius * cos, radius * sin, *z])
        })
        .collect();
    let mut triangles = Vec::new();
    for segment in 0..segments {
        let (here, there) = (segment * corners, (segment + 1) % segments * corners);
        for corner in 0..corners {
            let next = (corner + 1) % corners;
            triangles.push([here + corner, there + corner, there + next]);
            triangles.push([here + corner, there + next, here + next]);
        }
    }
    Geometry::Mesh {
        vertices_m,
        triangles,
    }
}

/// Volume by the divergence theorem: right, and positive, only if every triangle faces outward.
#[test]
fn verify_volume_of_a_tube() {
    let (inner, outer, length) = (0.021, 0.06, 0.02);
    let outline = [(inner, 0.0), (outer, 0.0), (outer, length), (inner, length)];
    let segments = 96;
    let Geometry::Mesh {
        vertices_m,
        triangles,
    } = revolved(&outline, segments)
    else {
        panic!("a body of revolution is a mesh");
    };
    let corner = |index: u32| vertices_m[index as usize];
    let volume: f64 = triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(corner);
            let cross = [
                b[1] * c[2] - b[2] * c[1],
                b[2] * c[0] - b[0] * c[2],
                b[0] * c[1] - b[1] * c[0],
            ];
            (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
        })
        .sum();
    // A polygon of n sides in a circle of radius r has the area ½ n r² sin(2π/n).
    let n = f64::from(segments);
    let polygon = 0.5 * n * (std::f64::consts::TAU / n).sin();
    let expected = polygon * (outer * outer - inner * inner) * length;
    assert!(
        (volume / expected - 1.0).abs() < 1e-12,
        "{volume} against {expected}"
    );
}
