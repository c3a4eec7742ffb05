use super::*;

const STL: &str = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                   vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
const OBJ: &str = "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 -2 4\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\n\
                   property double y\nproperty float z\nproperty uchar red\nelement face 1\n\
                   property list uchar int vertex_indices\nend_header\n0 0 0 9\n1 0 0 9\n1 1 0 9\n\
                   0 1 0 9\n4 0 1 2 3\n";

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(2_u32.to_le_bytes());
    for z in [0.0_f32, 1.0] {
        for number in [0.0, 0.0, -1.0, 0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, z] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\n\
         property float y\nproperty float z\nproperty short k\nelement face 1\n\
         property list uint uint vertex_index\nend_header\n"
    )
    .into_bytes();
    let mut put = |raw: [u8; 4], used: usize| {
        let mut raw = raw[..used].to_vec();
        if big {
            raw.reverse();
        }
        bytes.extend(raw);
    };
    for [x, y] in [[0.0_f32, 0.0], [1.5, 0.0], [0.0, -2.0]] {
        for number in [x, y, 7.0] {
            put(number.to_le_bytes(), 4);
        }
        put([0xff, 0xff, 0, 0], 2);
    }
    for index in [3_u32, 0, 1, 2] {
        put(index.to_le_bytes(), 4);
    }
    bytes
}

fn samples() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("stl", STL.into()),
        ("stl", binary_stl()),
        ("obj", OBJ.into()),
        ("ply", PLY.into()),
        ("ply", binary_ply(false)),
        ("ply", binary_ply(true)),
    ]
}

#[test]
fn every_format_gives_its_vertices_and_triangles() {
    let read = |ending, bytes: &[u8]| MeshData::parse(ending, bytes).expect("a mesh");
    assert_eq!(read("stl", STL.as_bytes()).triangles, [[0, 1, 2]]);
    let binary = read("stl", &binary_stl());
    assert_eq!((binary.vertices.len(), binary.triangles.len()), (6, 2));
    assert_eq!(binary.against_stated_normal, [0, 1]);
    for mesh in [read("obj", OBJ.as_bytes()), read("ply", PLY.as_bytes())] {
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.vertices[2], Vector3::new(1.0, 1.0, 0.0));
    }
    for big in [false, true] {
        let mesh = read("ply", &binary_ply(big));
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert_eq!(mesh.vertices[2], Vector3::new(0.0, -2.0, 7.0));
    }
}

#[test]
fn damaged_files_are_refused_with_their_place() {
    let refuse = |ending: &str, text: &str| {
        let refused = MeshData::parse(ending, text.as_bytes());
        refused.expect_err("no mesh").to_string()
    };
    let told = refuse("stl", &STL.replace("1 0 0\nv", "1 o 0\nv"));
    assert!(
        told.starts_with("line 5: ") && told.contains("\"o\""),
        "{told}"
    );
    assert!(refuse("stl", &STL[..60]).starts_with("line "));
    assert!(refuse("stl", &STL.replace("vertex 1 0 0\n", "")).contains("has 2 vertices"));
    assert!(refuse("obj", &OBJ.replace("-2", "-5")).starts_with("line 7: "));
    assert!(refuse("obj", &OBJ.replace(" 4\n", " 5\n")).contains("there are 4 before it"));
    assert!(refuse("obj", "v 0 0 0\n").contains("no triangle"));
    assert!(refuse("obj", &OBJ.replace("v 1 1 0", "v 1 inf 0")).contains("vertex 3"));
    assert!(refuse("ply", &PLY.replace("face 1", "face 999999999999")).contains("take"));
    assert!(refuse("ply", &PLY.replace("4 0 1", "400000 0 1")).contains("400000 entries"));
    assert!(refuse("ply", &PLY.replace("4 0 1 2 3", "4 0 1 2 4")).contains("there are 4"));
    let mut long = binary_stl();
    long[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let told = MeshData::parse("stl", &long)
        .expect_err("no mesh")
        .to_string();
    assert!(told.contains("4294967295 triangles at byte 81"), "{told}");
}

/// Modellers write names and comments in the code page of their machine.
#[test]
fn names_in_another_encoding_do_not_matter() {
    let latin = |text: &str, name: &[u8]| {
        let (before, after) = text.split_once("#").expect("a place for the name");
        [before.as_bytes(), name, after.as_bytes()].concat()
    };
    let triangles = |ending, bytes: &[u8]| {
        let mesh = MeshData::parse(ending, bytes).expect("a mesh");
        mesh.triangles.len()
    };
    let stl = latin(&STL.replacen("solid s", "solid #", 1), b"Geh\xe4use");
    assert_eq!(triangles("stl", &stl), 1);
    let obj = latin(&OBJ.replacen("# a square", "o #", 1), b"Bohrung f\xfcr M6");
    assert_eq!(triangles("obj", &obj), 2);
    let broken = latin(&OBJ.replacen("# a square\nv 0 0 0", "v 0 # 0", 1), b"\xe4");
    let told = MeshData::parse("obj", &broken)
        .expect_err("no number")
        .to_string();
    assert!(told.starts_with("line 1: "), "{told}");
}

/// Cut off at every byte, and with bits turned over: a mesh or an error, never a panic, and no more
/// triangles than the file has bytes.
#[test]
fn truncated_and_flipped_files_never_panic() {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    for (ending, bytes) in samples() {
        for end in 0..bytes.len() {
            let read = MeshData::parse(ending, &bytes[..end]);
            // A text may end early and be whole: behind its last facet, or within its last number.
            let is_text = std::str::from_utf8(&bytes).is_ok() && !bytes.contains(&0);
            assert!(read.is_err() || is_text, "{ending} of {end} bytes");
            if is_text && ending != "obj" && end + 12 < bytes.len() {
                assert!(read.is_err(), "{ending} of {end} bytes");
            }
        }
        for _ in 0..2000 {
            let mut bad = bytes.clone();
            for _ in 0..=random(3) {
                let at = random(bad.len());
                bad[at] ^= 1 << random(8);
            }
            if let Ok(mesh) = MeshData::parse(ending, &bad) {
                assert!(mesh.triangles.len() < bytes.len());
                let count = mesh.vertices.len();
                assert!(
                    mesh.triangles
                        .iter()
                        .flatten()
                        .all(|i| (*i as usize) < count)
                );
            }
        }
    }
}
