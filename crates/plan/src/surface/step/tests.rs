use std::f64::consts::{PI, TAU};

use super::*;

fn shipped(name: &str) -> String {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/parts");
    std::fs::read_to_string(folder.join(name)).expect("the asset")
}

fn volume_mm3(mesh: &MeshData) -> f64 {
    let at = |i: u32| mesh.vertices[i as usize];
    let each = mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(at);
        a.dot(&b.cross(&c)) / 6.0
    });
    each.sum()
}

/// Areas of the faces of one kind, the largest first, mm².
fn areas(body: &StepBody, kind: &str) -> Vec<f64> {
    let own = body.faces.iter().filter(|face| face.kind == kind);
    let mut areas: Vec<f64> = own.map(|face| 1e6 * face.area_m2).collect();
    areas.sort_by(|a, b| b.total_cmp(a));
    areas
}

fn within(found: f64, true_value: f64, share: f64) {
    let off = (found / true_value - 1.0).abs();
    assert!(off < share, "{found} instead of {true_value}: {off:.2e}");
}

/// The plate of `draw.py` is made of boxes and cylinders, whose areas and volume are known.
#[test]
fn verify_areas_and_volume_of_the_plate() {
    let body = read(shipped("plate.step").as_bytes()).expect("a body");
    let rounded = |x: f64, y: f64, r: f64| x * y - (4.0 - PI) * r * r;
    let pocket = rounded(60.0, 70.0, 12.0);
    let slot = 34.0 * 26.0 + PI * 169.0;
    let holes = PI * 225.0 + 4.0 * PI * 16.0;
    let bottom = rounded(170.0, 110.0, 14.0) - holes;
    let volume = 18.0 * bottom - 8.0 * pocket - 6.0 * slot;
    within(volume_mm3(&body.mesh), volume, 1e-4);
    let planes = areas(&body, "plane");
    within(planes[0], bottom, 1e-4);
    within(planes[1], bottom - pocket - slot, 1e-4);
    let round = areas(&body, "cylinder");
    within(round[0], TAU * 15.0 * 18.0, 1e-3);
    within(
        round.iter().sum(),
        {
            let bores = TAU * 15.0 * 18.0 + 4.0 * TAU * 4.0 * 18.0;
            bores + TAU * 14.0 * 18.0 + TAU * 12.0 * 8.0 + TAU * 13.0 * 6.0
        },
        1e-3,
    );
}

/// Bore, rim and holes of the flange; its dome by Pappus' theorem, the holes' discs taken off.
#[test]
fn verify_areas_of_the_flange() {
    let body = read(shipped("flange.step").as_bytes()).expect("a body");
    let round = areas(&body, "cylinder");
    within(round[0], TAU * 72.0 * 14.0, 1e-3);
    within(round[1], TAU * 18.0 * 20.6, 1e-3);
    // The arc of 300 mm from (18, 20.6) to (72, 14), and its centre.
    let (from, to) = ([18.0_f64, 20.6_f64], [72.0, 14.0]);
    let chord = (54.0_f64 * 54.0 + 6.6 * 6.6).sqrt();
    let far = (300.0_f64 * 300.0 - 0.25 * chord * chord).sqrt();
    let centre = [45.0 - far * 6.6 / chord, 17.3 - far * 54.0 / chord];
    let angle = |p: [f64; 2]| (p[0] - centre[0]).atan2(p[1] - centre[1]);
    let (a, b) = (angle(from), angle(to));
    let whole = TAU * (300.0 * centre[0] * (b - a) + 9e4 * (a.cos() - b.cos()));
    // Each disc of 5 mm lies at 52 mm, where the dome leans by its angle.
    let lean = ((52.0 - centre[0]) / 300.0).asin();
    let dome = whole - 6.0 * PI * 25.0 / lean.cos();
    within(areas(&body, "revolution")[0], dome, 1e-3);
}

/// The same numbers in inches make a part 25.4 times as large.
#[test]
fn verify_inches_are_read_as_inches() {
    let text = shipped("plate.step");
    let mm = read(text.as_bytes()).expect("a body");
    let unit = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )";
    assert!(text.contains(unit));
    let inches = "( CONVERSION_BASED_UNIT('INCH',#90001) LENGTH_UNIT() NAMED_UNIT(#90003) )";
    let more = "DATA;\n#90001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#90002);\n\
                #90002 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );\n\
                #90003 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);";
    let text = text.replace(unit, inches).replacen("DATA;", more, 1);
    let inch = read(text.as_bytes()).expect("a body");
    within(
        volume_mm3(&inch.mesh),
        25.4_f64.powi(3) * volume_mm3(&mm.mesh),
        1e-3,
    );
}

#[test]
fn what_cannot_be_read_is_named() {
    let text = shipped("plate.step");
    let refuse = |text: &str| read(text.as_bytes()).expect_err("not read").1;
    let told = refuse(&text.replacen("CYLINDRICAL_SURFACE", "RECTANGULAR_COMPOSITE_SURFACE", 1));
    assert!(
        told.contains("RECTANGULAR_COMPOSITE_SURFACE: surfaces of this kind are not read")
            && told.contains("ADVANCED_FACE)"),
        "{told}"
    );
    let told = refuse(&text.replacen("= CIRCLE(", "= PARABOLA(", 1));
    assert!(told.contains("PARABOLA: curves of this kind"), "{told}");
    let told = refuse(&text.replace("CLOSED_SHELL", "SHELL_OF_SHELLS"));
    assert!(
        told.contains("SHELL_OF_SHELLS: shells of this kind"),
        "{told}"
    );
    let told = refuse(&text.replace("MANIFOLD_SOLID_BREP", "CSG_SOLID"));
    assert!(
        told.contains("the file holds no body")
            && told.contains("FACETED_BREP, SHELL_BASED_SURFACE_MODEL are read")
            && told.contains("it has 1 CSG_SOLID, 1 CLOSED_SHELL, ")
            && told.contains("export the solid by its faces"),
        "{told}"
    );
    let told = refuse(&text.replace("GLOBAL_UNIT_ASSIGNED_CONTEXT", "OTHER_CONTEXT"));
    assert!(told.contains("no unit of length"), "{told}");
    assert!(refuse("solid block\n").contains("ISO-10303-21"));
    // A cylinder twice as wide as the circles about its face.
    let start = text.find("= CYLINDRICAL_SURFACE(").expect("one");
    let end = start + text[start..].find(");").expect("its end");
    let comma = start + text[start..end].rfind(',').expect("its radius");
    let wide = format!("{},44.0{}", &text[..comma], &text[end..]);
    let told = refuse(&wide);
    assert!(told.contains("off its surface"), "{told}");
}

/// A point so far off that its square is no number is refused, whatever it is a point of.
#[test]
fn points_beyond_all_parts_are_refused() {
    for name in ["plate.step", "bracket.step", "flange.step"] {
        let text = shipped(name);
        let points: Vec<usize> = (text.match_indices("CARTESIAN_POINT"))
            .map(|(at, _)| at)
            .collect();
        let mut refused = 0;
        for at in points.iter().step_by(points.len() / 12) {
            let open = at + text[*at..].find("(").expect("values") + 1;
            let open = open + text[open..].find("(").expect("a list") + 1;
            let close = open + text[open..].find(",").expect("three numbers");
            let far = format!("{}1e308{}", &text[..open], &text[close..]);
            // One that no face uses is not looked at.
            if let Err((_, told)) = read(far.as_bytes()) {
                assert!(
                    told.contains("1e308 mm, but must be within 1e8 mm"),
                    "{told}"
                );
                refused += 1;
            }
        }
        assert!(refused > 6, "{name}: {refused}");
    }
}

/// What a file has in place of a body is told in one short line, so that its user knows what to
/// export.
#[test]
fn a_file_without_a_body_tells_what_comes_nearest() {
    let refuse = |entities: &str| {
        let text = format!(
            "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n{entities}ENDSEC;\nEND-ISO-10303-21;\n"
        );
        let (line, told) = read(text.as_bytes()).expect_err("no body");
        assert!(
            line.is_none() && !told.contains('\n') && told.len() < 400,
            "{told}"
        );
        for body in BODIES {
            assert!(told.contains(body), "{told}");
        }
        told
    };
    let told = refuse("#1 = LINE('',#2,#3);\n#4 = POLYLINE('',());\n#5 = LINE('',#2,#3);\n");
    assert!(
        told.contains("it has 1 POLYLINE, 2 LINE; wires hold no material"),
        "{told}"
    );
    let told = refuse("#1 = CARTESIAN_POINT('',(0.,0.,0.));\n");
    assert!(told.contains("no solids, faces or wires"), "{told}");
    let many: String = (1..500)
        .map(|n| format!("#{n} = {}{n}('');\n", "KIND_OF_A_USERS_OWN_".repeat(9)))
        .collect();
    let told = refuse(&format!(
        "{many}#501 = TESSELLATED_SOLID('',(),$);\n#502 = OPEN_SHELL('',());\n\
         #503 = EDGE_CURVE('',#1,#2,#3,.T.);\n#504 = CIRCLE('',#1,1.);\n"
    ));
    assert!(
        told.contains("1 TESSELLATED_SOLID, 1 OPEN_SHELL, 1 EDGE_CURVE; triangles in STEP"),
        "{told}"
    );
}

/// Cut off or scribbled on anywhere, a file is refused or read, and nothing panics.
#[test]
fn damaged_files_are_refused_or_read() {
    let text = shipped("plate.step");
    for k in 1..60 {
        let cut = &text[..text.len() * k / 60];
        assert!(read(cut.as_bytes()).is_err(), "cut at {k}");
        let whole = format!("{cut}\nEND-ISO-10303-21;\n");
        let _ = read(whole.as_bytes());
        let mut bytes = text.clone().into_bytes();
        let at = bytes.len() * k / 60;
        for (i, byte) in b"(#1,'),*;".iter().enumerate() {
            bytes[(at + 7 * i) % text.len()] = *byte;
        }
        let _ = read(&bytes);
    }
}

/// Marks in a text are doubled, be they a million: none is read within another.
#[test]
fn a_text_of_marks_is_read() {
    let marks = "''".repeat(1_000_000);
    let text = format!(
        "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1 = A('it{marks}s', 2.);\nENDSEC;\nEND-ISO-10303-21;\n"
    );
    let file = Part21::new(text.as_bytes()).expect("a file");
    let entity = file.entity(1).expect("an entity");
    let Some([Value::Text(text), Value::Number(number)]) = entity.part("A") else {
        panic!("{:?}", entity.kind());
    };
    assert_eq!((text.len(), *number), (1_000_003, 2.0));
    assert!(text.starts_with("it'") && text.ends_with("'s"));
}
