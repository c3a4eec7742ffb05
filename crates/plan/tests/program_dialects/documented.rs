//! Programs in the style of the makers' documentation and of the posts that people use, before an
//! arm of another build: the places and speeds that their lines say.

use std::path::Path;

use nalgebra::Isometry3;
use truecut_arm::Robot;
use truecut_plan::program::{
    Frames, Motion, Program, ProgramError, Settings, SpindleSwitch, Tool, dialect_of,
};

/// Shoulder 300 mm ahead of axis 1 at 675 mm, upper arm of 650 mm, elbow offset of 40 mm, forearm
/// of 700 mm, flange 90 mm ahead of the wrist centre; upright and stretched ahead at zero.
fn robot() -> Robot {
    let axes = [
        ("0 0 0.4", "0 0 1"),
        ("0.3 0 0.275", "0 1 0"),
        ("0 0 0.65", "0 1 0"),
        ("0.2 0 0.04", "1 0 0"),
        ("0.5 0 0", "0 1 0"),
        ("0.04 0 0", "1 0 0"),
    ];
    let mut urdf = String::from("<robot name=\"lean\"><link name=\"l0\"/>");
    for (k, (place, axis)) in axes.iter().enumerate() {
        let own = k + 1;
        urdf.push_str(&format!(
            "<link name=\"l{own}\"/><joint name=\"a{own}\" type=\"revolute\"><parent link=\"l{k}\"/>\
             <child link=\"l{own}\"/><origin xyz=\"{place}\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-6.2\" upper=\"6.2\" velocity=\"4\" effort=\"1000\"/></joint>"
        ));
    }
    urdf.push_str(
        "<link name=\"flange\"/><joint name=\"end\" type=\"fixed\"><parent link=\"l6\"/><child link=\"flange\"/>\
         <origin xyz=\"0.05 0 0\" rpy=\"0 1.5707963267948966 0\"/></joint></robot>",
    );
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lean.urdf");
    std::fs::write(&file, urdf).expect("a file");
    Robot::load_kinematics(&file, None, None).expect("an arm")
}

/// Reads files of which the first is the program.
pub(super) fn read(files: &[(&str, &str)], signal: &str) -> Result<Program, ProgramError> {
    let robot = robot();
    let main = Path::new(files[0].0);
    let text = |path: &Path| {
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        let found = found.map(|(_, text)| (*text).to_owned());
        found.ok_or_else(|| std::io::ErrorKind::NotFound.into())
    };
    let frames = Frames {
        tool: Tool::of(&robot, "tool", 1),
        world_from_base: Isometry3::identity(),
    };
    let settings = Settings {
        spindle_signal: Some(signal.to_owned()),
        ..Settings::default()
    };
    let dialect = dialect_of(main).expect("a dialect");
    dialect.read(main, &text, &robot, &frames, &settings)
}

/// What the moves say: places in mm, and the speeds (share of joints' speed, or mm/s).
struct Said<'a> {
    places_mm: &'a [[f64; 3]],
    speeds: &'a [f64],
    /// Spindle switches, before which move.
    switches: &'a [(usize, bool)],
    noted: &'a [&'a str],
}

fn check(files: &[(&str, &str)], signal: &str, said: &Said<'_>) {
    let name = files[0].0;
    let program = read(files, signal).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(program.moves.len(), said.places_mm.len(), "{name}");
    for (k, (step, wanted)) in program.moves.iter().zip(said.places_mm).enumerate() {
        let place = (program.world_from_base * step.base_from_tool)
            .translation
            .vector
            * 1e3;
        let apart = (place - nalgebra::Vector3::from(*wanted)).norm();
        assert!(apart < 2e-3, "{name}: move {k} at {place}");
        let speed = match step.motion {
            Motion::Joint { share } => share,
            Motion::Linear { speed_m_per_s } => speed_m_per_s * 1e3,
        };
        assert!(
            (speed - said.speeds[k]).abs() < 1e-3,
            "{name}: move {k}: {speed}"
        );
    }
    let switches = said.switches.iter();
    let switches = switches.map(|(before, on)| SpindleSwitch {
        before: *before,
        on: *on,
    });
    assert_eq!(program.spindle, switches.collect::<Vec<_>>(), "{name}");
    for quote in said.noted {
        let is_noted = program.notes.iter().any(|note| note.contains(quote));
        assert!(is_noted, "{name}: {quote}: {:?}", program.notes);
    }
}

const KRL_HEAD: &str = "&ACCESS RVP\n&REL 1\n&PARAM EDITMASK = *\n&PARAM TEMPLATE = C:\\KRC\\Roboter\\Template\\vorgabe\n\
DEF job ( )\n;FOLD INI\n;FOLD BASISTECH INI\nGLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )\n\
INTERRUPT ON 3\nBAS (#INITMOV,0 )\n;ENDFOLD (BASISTECH INI)\n;ENDFOLD (INI)\n";

#[test]
fn krl_in_the_style_of_its_documentation() {
    let job = |body: &str| format!("{KRL_HEAD}{body}\nEND\n");
    // As posts write it: the frames by number or in place, the first move in axes.
    let post = job(
        "$BWDSTART = FALSE\nPDAT_ACT = PDEFAULT\nBAS(#PTP_DAT)\nFDAT_ACT = {TOOL_NO 0,BASE_NO 0,IPO_FRAME #BASE}\nBAS(#FRAMES)\n\
         $VEL.CP=0.2\nBAS(#VEL_PTP,100)\nBAS(#TOOL,0)\nBAS(#BASE,0)\nPTP $AXIS_ACT\n\
         PTP {A1 0,A2 0,A3 0,A4 0,A5 90,A6 0,E1 0,E2 0}\n$ADVANCE = 5\n\
         LIN {X 900,Y 0,Z 700,A 0,B 90,C 180} C_DIS\nPULSE($OUT[5],TRUE,0.5)\nWAIT FOR $IN[1]==TRUE\n\
         LIN {X 900,Y 100,Z 700,A 0,B 90,C 180}",
    );
    let upright = [1000.0, 0.0, 1275.0];
    let said = Said {
        places_mm: &[upright, [900.0, 0.0, 700.0], [900.0, 100.0, 700.0]],
        speeds: &[1.0, 200.0, 200.0],
        switches: &[],
        noted: &[
            "PTP $AXIS_ACT is left aside",
            "INTERRUPT is left aside",
            "PULSE is left aside",
        ],
    };
    check(&[("job.src", &post)], "1", &said);
    // Inline forms: the speeds stand in the parameters of BAS, the positions in the data file.
    let inline = job(
        "PDAT_ACT=PPDAT1\nFDAT_ACT=FP1\nBAS(#PTP_PARAMS,20)\nPTP XP1\nLDAT_ACT=LCPDAT1\nFDAT_ACT=FP2\n\
         BAS(#CP_PARAMS,0.3)\n$OUT[1]=TRUE\nLIN XP2 C_DIS C_DIS\n$OUT[1]=FALSE\nLIN XP1",
    );
    let data = "DEFDAT job PUBLIC\nEXT BAS (BAS_COMMAND :IN,REAL :IN )\nDECL E6POS XP1={X 850.0,Y 0.0,Z 700.0,A 0.0,B 90.0,C 180.0,E1 0.0}\n\
                DECL FDAT FP1={TOOL_NO 1,BASE_NO 0,IPO_FRAME #BASE,POINT2[] \" \"}\nDECL PDAT PPDAT1={VEL 100.000,ACC 100.000,APO_DIST 100.000}\n\
                E6POS XP2={X 850.0,Y 80.0,Z 690.0,A 0.0,B 90.0,C 180.0}\nENDDAT\n";
    let said = Said {
        places_mm: &[
            [850.0, 0.0, 700.0],
            [850.0, 80.0, 690.0],
            [850.0, 0.0, 700.0],
        ],
        speeds: &[0.2, 300.0, 300.0],
        switches: &[(1, true), (2, false)],
        noted: &["PDAT_ACT is left aside"],
    };
    check(&[("job.src", &inline), ("job.dat", data)], "1", &said);
    // Places and frames that the program gives anew are those that its moves go to.
    let given = job(
        "INT I\nDECL E6POS P2\nFRAME F1\nI=3\nBASE_DATA[2]={FRAME: X 100,Y 0,Z 50,A 0,B 0,C 0}\n$BASE=BASE_DATA[2]\n\
         $TOOL=$NULLFRAME\n$VEL={CP 0.05,ORI1 200,ORI2 200}\nXP1={X 750,Y 10,Z 650,A 0,B 90,C 180}\nPTP XP1\nP2=XP1\nP2.Y=60\nXP1.Z=640\n\
         lin P2\nLIN XP1",
    );
    let said = Said {
        places_mm: &[
            [850.0, 10.0, 700.0],
            [850.0, 60.0, 700.0],
            [850.0, 10.0, 690.0],
        ],
        speeds: &[1.0, 50.0, 50.0],
        switches: &[],
        noted: &["I is left aside"],
    };
    check(&[("job.src", &given), ("job.dat", data)], "1", &said);
    // Splines of one move, as the inline forms of later controllers write them.
    let spline = job(
        "SPTP XP1 WITH $VEL_AXIS[1]=SVEL_JOINT(50.0),$TOOL=STOOL2(FP1),$BASE=SBASE(FP1.BASE_NO)\n\
         SLIN XP2 WITH $VEL=SVEL_CP(0.25,,LCPDAT1),$TOOL=STOOL2(FP2),$ACC=SACC_CP(LCPDAT1) C_SPL\n\
         SLIN XP1 WITH $VEL.CP=0.1",
    );
    let said = Said {
        places_mm: &[
            [850.0, 0.0, 700.0],
            [850.0, 80.0, 690.0],
            [850.0, 0.0, 700.0],
        ],
        speeds: &[0.5, 250.0, 100.0],
        switches: &[],
        noted: &["WITH is left aside but for its speed"],
    };
    check(&[("job.src", &spline), ("job.dat", data)], "1", &said);
}

/// A place in metres and the tool pointing down, its x along −x.
fn down(x: f64, y: f64, z: f64) -> String {
    format!("p[{x},{y},{z},0,3.141592653589793,0]")
}

#[test]
fn urscript_in_the_style_of_its_documentation() {
    let [a, b] = [down(0.9, 0.0, 0.7), down(0.9, 0.1, 0.7)];
    // As PolyScope writes it: settings, marks of the tree, waypoints with their joints.
    let tree = format!(
        "def job():\n  set_standard_analog_input_domain(0, 1)\n  set_tool_voltage(0)\n  set_gravity([0.0, 0.0, 9.82])\n\
         \x20 set_tcp(p[0.0,0.0,0.0,0.0,0.0,0.0])\n  set_payload(1.5, [0.0, 0.0, 0.05])\n  global Way_1_p={a}\n\
         \x20 global Way_1_q=[0.0,0.1,0.2,0.0,1.2,0.0]\n  $ 1 \"Robot Program\"\n  $ 2 \"MoveJ\"\n\
         \x20 movej(get_inverse_kin(Way_1_p, qnear=Way_1_q), a=1.4, v=1.05)\n  $ 3 \"Set\"\n  set_digital_out(2, True)\n\
         \x20 movel({b}, a=1.2, v=0.25, t=0, r=0.01)\n  sleep(0.5)\n  set_digital_out(2, False)\n  movel(Way_1_p, v=0.1)\nend\njob()\n"
    );
    let said = Said {
        places_mm: &[
            [900.0, 0.0, 700.0],
            [900.0, 100.0, 700.0],
            [900.0, 0.0, 700.0],
        ],
        speeds: &[1.05 / std::f64::consts::PI, 250.0, 100.0],
        switches: &[(1, true), (2, false)],
        noted: &["set_gravity is left aside", "sleep is left aside"],
    };
    check(&[("job.script", &tree)], "2", &said);
    // Functions of poses.
    let poses = format!(
        "def job():\n  base={a}\n  write_output_boolean_register(0, True)\n  movej(base, a=1.4, v=r2d(0.01745329251994), r=0)\n\
         \x20 movel(pose_add(base, p[0,0.05,-0.01,0,0,0]), v=0.05)\n  movel(pose_trans(base, p[0,0.05,0.02,0,0,0]), v=0.05)\nend\n"
    );
    let said = Said {
        places_mm: &[
            [900.0, 0.0, 700.0],
            [900.0, 50.0, 690.0],
            [900.0, 50.0, 680.0],
        ],
        speeds: &[1.0 / std::f64::consts::PI, 50.0, 50.0],
        switches: &[],
        noted: &["write_output_boolean_register is left aside"],
    };
    check(&[("job.script", &poses)], "2", &said);
}

/// `qnear` says the branch: of two joints that it names, each brings its own posture back.
#[test]
fn get_inverse_kin_takes_the_posture_nearest_to_qnear() {
    let robot = robot();
    for q in [
        [0.1, 0.2, 0.3, 0.4, 0.9, -0.3],
        [0.1, 0.2, 0.3, 0.4 - 3.1, -0.9, 2.8],
    ] {
        let flange = robot.world_from_frame(&q, truecut_arm::FrameId::Flange);
        let (t, r) = (flange.translation.vector, flange.rotation.scaled_axis());
        let text = format!(
            "def job():\n  movej(get_inverse_kin(p[{},{},{},{},{},{}], {q:?}))\nend\n",
            t.x, t.y, t.z, r.x, r.y, r.z
        );
        let program = read(&[("job.script", &text)], "0").expect("a program");
        for (found, wanted) in program.moves[0].posture.iter().zip(q) {
            assert!(
                (found - wanted).abs() < 1e-6,
                "{:?}",
                program.moves[0].posture
            );
        }
    }
}

pub(super) fn ls(body: &str, positions: &[&str]) -> String {
    let mut text = format!(
        "/PROG  JOB\n/ATTR\nOWNER\t\t= MNEDITOR;\nCOMMENT\t\t= \"\";\nDEFAULT_GROUP\t= 1,*,*,*,*;\n/APPL\n/MN\n{body}/POS\n"
    );
    for (k, position) in positions.iter().enumerate() {
        text.push_str(&format!("P[{}]{{\n   GP1:\n\t{position}\n}};\n", k + 1));
    }
    text + "/END\n"
}

pub(super) const NUT: &str = "CONFIG : 'N U T, 0, 0, 0',";

#[test]
fn ls_in_the_style_of_its_documentation() {
    let position = |frames: &str, y: f64| {
        format!(
            "{frames},\t\t{NUT}\n\tX =   900.000  mm,\tY =   {y:.3}  mm,\tZ =   700.000  mm,\n\tW =   180.000 deg,\tP =     0.000 deg,\tR =     0.000 deg"
        )
    };
    let [one, two] = [
        position("UF : 0, UT : 1", 0.0),
        position("UF : F, UT : F", 60.0),
    ];
    let text = ls(
        "   1:  !a remark ;\n   2:  UFRAME_NUM=0 ;\n   3:  UTOOL_NUM=1 ;\n   4:  //L P[2] 100mm/sec FINE    ;\n   5:  LBL[1:start] ;\n\
         \x20  6:J P[1] 25% FINE    ;\n   7:  DO[4:spindle]=ON ;\n   8:L P[2:edge] 600cm/min CNT50 ACC80    ;\n   9:  DO[4:spindle]=OFF ;\n\
         \x20 10:L P[1]\n    :  120inch/min FINE    ;\n",
        &[&one, &two],
    );
    let said = Said {
        places_mm: &[
            [900.0, 0.0, 700.0],
            [900.0, 60.0, 700.0],
            [900.0, 0.0, 700.0],
        ],
        speeds: &[0.25, 100.0, 50.8],
        switches: &[(1, true), (2, false)],
        noted: &["LBL is left aside", "ACC80 of a move"],
    };
    check(&[("job.LS", &text)], "4", &said);
}

/// What a position leaves out stays as it was; a move by so much goes from the point before, in the
/// base frame or in the tool's; a circle takes no attitude of its auxiliary point.
#[test]
fn krl_positions_in_part_are_those_of_the_point_before() {
    let job = |body: &str| format!("{KRL_HEAD}$VEL.CP=0.2\n{body}\nEND\n");
    let text = job(
        "PTP {A1 0,A2 0,A3 0,A4 0,A5 90,A6 0}\nPTP {A1 10}\nPTP {A1 0}\nLIN {X 900,Y 0,Z 700,A 0,B 90,C 180}\n\
         LIN {Y 50}\nLIN_REL {Z 20}\nLIN_REL {X 10} C_DIS #TOOL\nLIN {X 880,Y 0}",
    );
    let (sine, cosine) = 10_f64.to_radians().sin_cos();
    let upright = [1000.0, 0.0, 1275.0];
    let said = Said {
        places_mm: &[
            upright,
            [1000.0 * cosine, 1000.0 * sine, 1275.0],
            upright,
            [900.0, 0.0, 700.0],
            [900.0, 50.0, 700.0],
            [900.0, 50.0, 720.0],
            // The tool's x points down.
            [900.0, 50.0, 710.0],
            [880.0, 0.0, 710.0],
        ],
        speeds: &[1.0, 1.0, 1.0, 200.0, 200.0, 200.0, 200.0, 200.0],
        switches: &[],
        noted: &[],
    };
    check(&[("job.src", &text)], "1", &said);
    let first = "LIN {X 900,Y 0,Z 700,A 0,B 90,C 180}\n";
    let circle = |points: &str| {
        let text = job(&format!("{first}CIRC {points}"));
        read(&[("job.src", &text)], "1").unwrap_or_else(|error| panic!("{points}: {error}"))
    };
    let whole = circle("{X 910,Y 10,Z 700,A 0,B 90,C 180},{X 900,Y 20,Z 700,A 0,B 90,C 180}");
    for points in [
        "{X 910,Y 10,Z 700},{X 900,Y 20,Z 700,A 0,B 90,C 180}",
        "{X 910,Y 10},{X 900,Y 20}",
    ] {
        assert_eq!(circle(points).moves, whole.moves, "{points}");
    }
}

#[test]
fn rapid_in_the_style_of_its_documentation() {
    let module = |body: &str| {
        format!(
            "MODULE Job\n  CONST robtarget p10:=[[900,0,700],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n\
             \x20 PERS wobjdata wobj1:=[FALSE,TRUE,\"\",[[0,0,0],[1,0,0,0]],[[10,0,0],[1,0,0,0]]];\n\
             \x20 TASK PERS loaddata load1:=[1,[0,0,1],[1,0,0,0],0,0,0];\n  PROC main()\n    ConfL\\Off;\n    ConfJ\\Off;\n    AccSet 50,50;\n\
             {body}    RETURN;\n  ENDPROC\nENDMODULE\n"
        )
    };
    let text = module(
        "    MoveAbsJ [[0,0,0,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]]\\NoEOffs,v1000,z50,tool0;\n    Set doSpindle;\n\
         \x20   MoveL p10,v200,fine\\Inpos:=inpos50,tool0;\n    MoveL Offs(p10,0,30,0),v100\\V:=35,[FALSE,5,8,8,0.8,8,0.8],tool0\\WObj:=wobj1\\TLoad:=load1;\n\
         \x20   Reset doSpindle;\n    MoveL RelTool(p10,0,0,10),v50,z0,tool0\\WObj:=wobj0;\n    SetDO doSpindle,high;\n    SetDO doSpindle,low;\n    TPWrite \"done\";\n",
    );
    let said = Said {
        places_mm: &[
            [1000.0, 0.0, 1275.0],
            [900.0, 0.0, 700.0],
            [910.0, 30.0, 700.0],
            [900.0, 0.0, 690.0],
        ],
        speeds: &[1.0 / 7.0, 200.0, 35.0, 50.0],
        switches: &[(1, true), (3, false), (4, true), (4, false)],
        noted: &[
            "\\Inpos is left aside",
            "\\TLoad is left aside",
            "AccSet is left aside",
        ],
    };
    check(&[("job.mod", &text)], "doSpindle", &said);
}

#[test]
fn jobs_in_the_style_of_their_documentation() {
    let text = "/JOB\r\n//NAME JOB\r\n//POS\r\n///NPOS 2,0,0,0,0,0\r\n///TOOL 1\r\n///POSTYPE BASE\r\n///RECTAN\r\n///RCONF 1,0,0,0,0,0\r\n\
                C00000=900.000,0.000,700.000,180.0000,0.0000,0.0000\r\n///TOOL 1\r\nC00001=900.000,45.000,700.000,180.0000,\
                0.0000,0.0000\r\n//INST\r\n///DATE 2026/01/31 12:00\r\n///COMM style\r\n///ATTR SC,RW\r\n///GROUP1 RB1\r\nNOP\r\n'start\r\n\
                MOVJ C00000 VJ=25.00 PL=0 NWAIT ACC=50 DEC=50\r\nDOUT OT#(7) ON\r\nTIMER T=1.00\r\nMOVL C00001 V=93.5 PL=1 ACC=20\r\nDOUT OT#(7) OFF\r\nEND\r\n";
    let said = Said {
        places_mm: &[[900.0, 0.0, 700.0], [900.0, 45.0, 700.0]],
        speeds: &[0.25, 93.5],
        switches: &[(1, true), (2, false)],
        noted: &["TIMER is left aside", "NWAIT of a move", "ACC=50 of a move"],
    };
    check(&[("JOB.JBI", text)], "7", &said);
}

/// What would be read as another thing than the controller makes of it is refused at its line.
#[test]
fn what_would_be_misread_is_refused() {
    let position = |frames: &str, more: &str| {
        format!(
            "{frames}, {NUT}\n X = 900 mm, Y = 0 mm, Z = 700 mm,\n W = 180 deg, P = 0 deg, R = 0 deg{more}"
        )
    };
    let plain = position("UF : 1, UT : 1", "");
    let other = position("UF : 2, UT : 1", "");
    let other_tool = position("UF : 1, UT : 2", "");
    let rail = position("UF : 1, UT : 1", ",\n E1= 100.000 mm");
    let frames = "1: UFRAME_NUM=1 ;\n2: UTOOL_NUM=1 ;\n3:J P[1] 10% FINE ;\n";
    let job = |body: &str| format!("DEF job ( )\n{body}\nEND\n");
    let cases: [(&str, String, usize, &[&str]); 12] = [
        ("a.LS", ls(&format!("{frames}4: UFRAME_NUM=2 ;\n5:L P[2] 10mm/sec FINE ;\n"), &[&plain, &other]), 11, &["UFRAME_NUM is 2", "one frame"]),
        ("b.LS", ls(frames, &[&other]), 10, &["UF of the position", "is 2", "by UFRAME_NUM"]),
        ("c.LS", ls(frames, &[&other_tool]), 10, &["UT of the position", "by UTOOL_NUM"]),
        ("d.LS", ls(frames, &[&rail]), 17, &["E1 is 100 mm", "in deg"]),
        ("e.src", job("PTP_REL {A1 10}"), 2, &["`PTP_REL` is not read", "from where the arm stands"]),
        ("f.src", job("XP1={X 1,Y 2,Z 3,A 0,B 0,C 0}\nXP1.X=XP1.X+10"), 3, &["`XP1.X` is not read", "calculated"]),
        ("g.src", job("$BASE=BASE_DATA[1]\nPTP {X 850,Y 0,Z 700,A 0,B 90,C 180}\n$BASE=BASE_DATA[2]"), 4, &["$BASE is BASE_DATA[2]", "one frame"]),
        ("j.src", job("$VEL.CP=0.1\nPTP {A1 0,A2 0,A3 0,A4 0,A5 90,A6 0}\nLIN_REL {Z 20}"), 4, &["`LIN_REL` is not read", "no position in X to C"]),
        ("k.src", job("$VEL.CP=0.1\nLIN {X 850,Y 0,Z 700,A 0,B 90,C 180}\nLIN_REL {A 10}"), 4, &["`A of LIN_REL` is not read", "a turn"]),
        ("l.src", job("$VEL.CP=0.1\nLIN {X 850,Y 0}"), 3, &["a position", "one with Z"]),
        ("h.src", job("MY_PART()"), 2, &["`MY_PART` is not read", "a subprogram"]),
        (
            "I.JBI",
            "/JOB\n//NAME I\n//POS\n///NPOS 2,0,0,0,0,0\n///TOOL 0\n///POSTYPE BASE\n///RECTAN\n///RCONF 1,0,0,0,0,0\n\
             C00000=900,0,700,180,0,0\n///TOOL 1\nC00001=900,9,700,180,0,0\n"
                .to_owned(),
            10,
            &["///TOOL is 1", "one tool"],
        ),
    ];
    for (name, text, line, quotes) in cases {
        let error = read(&[(name, &text)], "1").expect_err(name);
        let told = error.to_string();
        assert_eq!(error.line(), Some(line), "{told}");
        for quote in quotes {
            assert!(told.contains(quote), "{told}");
        }
    }
}
