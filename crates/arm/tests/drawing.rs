//! Meshes of robots: every format that is read, what is said of files that cannot be, and the rods
//! in their place.

use std::fmt::Write as _;
use std::path::Path;

use nalgebra::Vector3;
use truecut_arm::{DrawnMesh, Masses, Reading, Robot, Shape};

/// Corners of a box from the origin, and its triangles wound outwards.
fn block([x, y, z]: [f64; 3]) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let corner = |i: usize| [[0.0, x][i & 1], [0.0, y][i >> 1 & 1], [0.0, z][i >> 2 & 1]];
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    ((0..8).map(corner).collect(), triangles.collect())
}

fn words(numbers: impl IntoIterator<Item = impl std::fmt::Display>) -> String {
    let words = numbers.into_iter().map(|number| number.to_string());
    words.collect::<Vec<_>>().join(" ")
}

fn stl(size: [f64; 3]) -> String {
    let (vertices, triangles) = block(size);
    let mut text = "solid block\n".to_owned();
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in triangle {
            let _ = writeln!(text, "vertex {}", words(vertices[corner]));
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid block\n"
}

fn obj(size: [f64; 3]) -> String {
    let (vertices, triangles) = block(size);
    let vertices = vertices.iter().map(|v| format!("v {}\n", words(*v)));
    let faces = triangles
        .iter()
        .map(|t| format!("f {}\n", words(t.map(|i| i + 1))));
    vertices.chain(faces).collect()
}

/// Quadrilaterals, big endian.
fn ply(size: [f64; 3]) -> Vec<u8> {
    let (vertices, triangles) = block(size);
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 8\nproperty float x\n\
        property float y\nproperty float z\nelement face 6\n\
        property list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for coordinate in vertices.iter().flatten() {
        bytes.extend((*coordinate as f32).to_be_bytes());
    }
    for pair in triangles.chunks(2) {
        bytes.push(4);
        for corner in [pair[0][0], pair[0][1], pair[0][2], pair[1][2]] {
            bytes.extend((corner as i32).to_be_bytes());
        }
    }
    bytes
}

/// In mm, within a node that is moved by (1, 0, 0) m and turned about z by a quarter, and once more
/// without either; red.
fn collada(size: [f64; 3]) -> String {
    let (vertices, triangles) = block(size.map(|side| 1e3 * side));
    let positions = words(vertices.iter().flatten());
    let corners = words(triangles.iter().flatten().flat_map(|corner| [*corner, 0]));
    let instance = r##"<instance_geometry url="#g"><bind_material><technique_common>
        <instance_material symbol="paint" target="#m"/>
        </technique_common></bind_material></instance_geometry>"##;
    format!(
        r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><phong>
<diffuse><color>1 0 0 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="24">{positions}</float_array><technique_common>
<accessor source="#pa" count="8" stride="3"/></technique_common></source>
<source id="n"><float_array id="na" count="3">0 0 1</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12" material="paint"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="NORMAL" source="#n" offset="1"/><p>{corners}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node><translate>1000 0 0</translate><node><rotate>0 0 1 90</rotate>{instance}</node></node>
<node>{instance}</node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"##
    )
}

/// A robot of one joint in a package of its own, whose link has this mesh.
fn robot(folder: &Path, mesh: &str) -> Robot {
    let urdf = folder.join("arm_description/urdf/arm.urdf");
    std::fs::create_dir_all(urdf.parent().expect("it has one")).expect("a folder");
    let text = format!(
        r#"<robot name="arm"><link name="base"/><link name="link">
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><origin xyz="0 0 0.5"/><geometry><mesh filename="{mesh}" scale="2 2 2"/></geometry></visual>
</link><link name="tip"/>
<joint name="j" type="continuous"><parent link="base"/><child link="link"/><axis xyz="0 0 1"/></joint>
<joint name="f" type="fixed"><parent link="link"/><child link="tip"/><origin xyz="0.4 0 0.3"/></joint>
</robot>"#
    );
    std::fs::write(&urdf, text).expect("a file");
    let reading = Reading {
        masses: Masses::NotNeeded,
        ..Reading::default()
    };
    Robot::read(&urdf, &reading).expect("a mesh never refuses a robot")
}

fn put(folder: &Path, name: &str, bytes: &[u8]) {
    let path = folder.join("arm_description/meshes").join(name);
    std::fs::create_dir_all(path.parent().expect("it has one")).expect("a folder");
    std::fs::write(path, bytes).expect("a file");
}

fn extent(meshes: &[DrawnMesh]) -> [Vector3<f64>; 2] {
    let all = || meshes.iter().flat_map(|mesh| &mesh.vertices_m).copied();
    [
        all().reduce(|a, b| a.inf(&b)).expect("vertices"),
        all().reduce(|a, b| a.sup(&b)).expect("vertices"),
    ]
}

fn volume(mesh: &DrawnMesh) -> f64 {
    let corners = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| mesh.vertices_m[i as usize]));
    corners.map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
}

#[test]
fn verify_meshes_of_every_format_lie_where_the_urdf_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let size = [0.1, 0.2, 0.4];
    put(folder.path(), "a.stl", stl(size).as_bytes());
    put(folder.path(), "a.OBJ", obj(size).as_bytes());
    put(folder.path(), "a.ply", &ply(size));
    for file in [
        "package://arm_description/meshes/a.stl",
        "../meshes/a.stl",
        "package://arm_description/meshes/a.OBJ",
        "package://arm_description/meshes/a.ply",
    ] {
        let robot = robot(folder.path(), file);
        let (links, notes) = robot.drawn_links();
        assert!(notes.is_empty(), "{file}: {notes:?}");
        let meshes = &links[1].meshes;
        let [low, high] = extent(meshes);
        assert!(
            (low - Vector3::new(0.0, 0.0, 0.5)).norm() < 1e-6,
            "{file}: {low}"
        );
        assert!(
            (high - Vector3::new(0.2, 0.4, 1.3)).norm() < 1e-6,
            "{file}: {high}"
        );
        assert_eq!(
            (meshes[0].vertices_m.len(), meshes[0].triangles.len()),
            (8, 12)
        );
        assert!((volume(&meshes[0]) - 8.0 * 0.008).abs() < 1e-6, "{file}");
    }
}

#[test]
fn verify_collada_has_units_nodes_instances_and_colours() {
    let folder = tempfile::tempdir().expect("a folder");
    put(folder.path(), "a.dae", collada([0.1, 0.2, 0.4]).as_bytes());
    let robot = robot(folder.path(), "package://arm_description/meshes/a.dae");
    let (links, notes) = robot.drawn_links();
    assert!(notes.is_empty(), "{notes:?}");
    let meshes = &links[1].meshes;
    assert_eq!(meshes.len(), 2);
    // A quarter turn takes x to y and y to −x; the URDF's scale and place come after.
    let mut found: Vec<_> = meshes
        .iter()
        .map(|m| extent(std::slice::from_ref(m)))
        .collect();
    found.sort_by(|a, b| a[0].x.total_cmp(&b[0].x));
    let expected = [
        [Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.2, 0.4, 1.3)],
        [Vector3::new(1.6, 0.0, 0.5), Vector3::new(2.0, 0.2, 1.3)],
    ];
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).norm() < 1e-6, "{found} {expected}");
    }
    assert!(
        meshes
            .iter()
            .all(|mesh| mesh.color_rgba == [1.0, 0.0, 0.0, 1.0])
    );
}

#[test]
fn a_mesh_that_cannot_be_read_is_a_note_and_its_link_a_rod() {
    let folder = tempfile::tempdir().expect("a folder");
    let dae = collada([0.1; 3]);
    let missing = dae.replace(r#"semantic="POSITION""#, r#"semantic="TEXCOORD""#);
    let beyond = dae.replace("<p>0 0", "<p>99 0");
    let itself = dae.replace(
        "</visual_scene>",
        "<node id=\"x\"><instance_node url=\"#x\"/></node></visual_scene>",
    );
    for (name, bytes) in [
        ("cut.stl", &stl([0.1; 3]).as_bytes()[..200]),
        ("none.stl", b"solid a\nendsolid a\n"),
        ("no.obj", b"v 1 2\nf 1 2 3\n"),
        ("few.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        (
            "no.ply",
            b"ply\nformat ascii 1.0\nelement vertex 3\nend_header\n",
        ),
        ("no.dae", b"<COLLADA><unclosed>"),
        ("other.dae", b"<robot/>"),
        ("missing.dae", missing.as_bytes()),
        ("beyond.dae", beyond.as_bytes()),
        ("itself.dae", itself.as_bytes()),
    ] {
        put(folder.path(), name, bytes);
        let file = format!("package://arm_description/meshes/{name}");
        let (links, notes) = robot(folder.path(), &file).drawn_links();
        let [note] = &notes[..] else {
            panic!("{name}: one note, not {notes:?}")
        };
        assert!(
            note.contains(name) && note.contains("of link \"link\""),
            "{note}"
        );
        assert!(links[1].meshes.is_empty());
        let length = (0.4_f64.powi(2) + 0.3_f64.powi(2)).sqrt();
        let is_rod = |shape: &Shape| matches!(shape, Shape::Capsule { length_m, .. } if (length_m - length).abs() < 1e-12);
        assert!(is_rod(&links[1].visuals[0].shape), "{name}");
    }
}

#[test]
fn a_mesh_that_is_not_there_is_noted_when_the_robot_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    for (file, why) in [
        (
            "package://other_package/a.stl",
            "--package other_package=DIR",
        ),
        ("../meshes/absent.stl", "there is no file"),
    ] {
        let robot = robot(folder.path(), file);
        let notes = robot.chain.notes.join("\n");
        assert!(notes.contains(file) && notes.contains(why), "{notes}");
        assert!(robot.drawn_links().1.is_empty());
    }
    put(folder.path(), "a.step", b"ISO-10303-21;");
    let robot = robot(folder.path(), "../meshes/a.step");
    assert!(
        robot
            .chain
            .notes
            .join("\n")
            .contains("its ending is none of stl, obj, ply, dae")
    );
}
