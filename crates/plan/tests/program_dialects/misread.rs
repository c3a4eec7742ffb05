//! What controllers make of files in ways that are easily overlooked: frames by parameters of
//! inline forms, ends of programs, options of moves. Each file is written in the style of the
//! makers' documentation; what it says is read as said, or refused at its line.

use nalgebra::Vector3;
use truecut_plan::program::{Program, Zone};

use super::documented::{NUT, ls, read};

/// Refused: the file, those beside it, the line and what is told.
struct Refused<'a> {
    files: &'a [(&'a str, &'a str)],
    line: usize,
    quotes: &'a [&'a str],
}

fn are_refused(cases: &[Refused<'_>]) {
    for case in cases {
        let text = case.files[0].1;
        let error = read(case.files, "1").expect_err(text);
        let told = error.to_string();
        assert_eq!(error.line(), Some(case.line), "{told}\n{text}");
        for quote in case.quotes {
            assert!(told.contains(quote), "`{quote}` is not in: {told}");
        }
    }
}

fn program(files: &[(&str, &str)]) -> Program {
    read(files, "1").unwrap_or_else(|error| panic!("{error}\n{}", files[0].1))
}

/// Where the tool stands at each move, mm in the world.
fn places_mm(program: &Program) -> Vec<[f64; 3]> {
    let place = |pose: nalgebra::Isometry3<f64>| (pose.translation.vector * 1e3).into();
    let moves = program.moves.iter();
    moves
        .map(|step| place(program.world_from_base * step.base_from_tool))
        .collect()
}

fn are_near(found: &[[f64; 3]], wanted: &[[f64; 3]]) {
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for (a, b) in found.iter().zip(wanted) {
        let apart = (Vector3::from(*a) - Vector3::from(*b)).norm();
        assert!(apart < 2e-3, "{a:?}, not {b:?}");
    }
}

/// Two places in the .dat, with parameters that the case gives.
fn data(parameters: &str) -> String {
    format!(
        "DEFDAT job PUBLIC\nDECL E6POS XP1={{X 850,Y 0,Z 700,A 0,B 90,C 180,E1 0,E2 0}}\n\
         DECL E6POS XP2={{X 850,Y 80,Z 690,A 0,B 90,C 180,E1 0,E2 0}}\n{parameters}ENDDAT\n"
    )
}

/// A move by joints and a line, as inline forms of both kinds of controllers write them.
const INLINE: &str = "DEF job( )\nPDAT_ACT=PPDAT1\nFDAT_ACT=FP1\nBAS(#PTP_PARAMS,20)\nPTP XP1\n\
LDAT_ACT=LCPDAT2\nFDAT_ACT=FP2\nBAS(#CP_PARAMS,0.3)\nLIN XP2 C_DIS C_DIS\nEND\n";
const SPLINE: &str = "DEF job( )\nSPTP XP1 WITH $VEL_AXIS[1]=SVEL_JOINT(50.0), $TOOL=STOOL2(FP1), \
$BASE=SBASE(FP1.BASE_NO), $IPO_MODE=SIPO_MODE(FP1.IPO_FRAME), $LOAD=SLOAD(FP1.TOOL_NO)\n\
SLIN XP2 WITH $VEL=SVEL_CP(0.25, , LCPDAT2), $TOOL=STOOL2(FP2), $BASE=SBASE(FP2.BASE_NO), \
$IPO_MODE=SIPO_MODE(FP2.IPO_FRAME), $ACC=SACC_CP(LCPDAT2), $ORI_TYPE=SORI_TYP(LCPDAT2) C_SPL\nEND\n";

#[test]
fn krl_frames_of_inline_forms_are_those_of_their_parameters() {
    let frames = |one: &str, two: &str, line: &str| {
        data(&format!(
            "DECL FDAT FP1={{{one},POINT2[] \" \",TQ_STATE FALSE}}\nDECL FDAT FP2={{{two},POINT2[] \" \"}}\n\
             DECL LDAT LCPDAT2={{VEL 0.3,ACC 100,APO_DIST 12.5,APO_FAC 50,{line}}}\n\
             FRAME BASE_DATA_OF_OURS={{X 1,Y 2,Z 3,A 0,B 0,C 0}}\n"
        ))
    };
    let (even, table) = ("ORI_TYP #VAR", "TOOL_NO 1,BASE_NO 3,IPO_FRAME #BASE");
    let same = frames(table, table, even);
    let base = frames(table, "TOOL_NO 1,BASE_NO 1,IPO_FRAME #BASE", even);
    let world = frames("TOOL_NO 1,BASE_NO 0,IPO_FRAME #BASE", table, even);
    let tool = frames(table, "TOOL_NO 2,BASE_NO 3,IPO_FRAME #BASE", even);
    let fixed = frames(table, "TOOL_NO 1,BASE_NO 3,IPO_FRAME #TCP", even);
    for (source, line) in [(INLINE, 8), (SPLINE, 3)] {
        let with = |data: &str| read(&[("job.src", source), ("job.dat", data)], "1");
        let read = with(&same).unwrap_or_else(|error| panic!("{error}"));
        are_near(
            &places_mm(&read),
            &[[850.0, 0.0, 700.0], [850.0, 80.0, 690.0]],
        );
        for (data, quotes) in [
            (&base, ["$BASE is BASE_DATA[1]", "BASE_DATA[3], as before"]),
            (&world, ["$BASE is BASE_DATA[3]", "BASE_DATA[0], as before"]),
            (&tool, ["$TOOL is TOOL_DATA[2]", "TOOL_DATA[1], as before"]),
            (
                &fixed,
                ["`IPO_FRAME #TCP` is not read", "workpiece at the flange"],
            ),
        ] {
            let files: &[(&str, &str)] = &[("job.src", source), ("job.dat", data)];
            are_refused(&[Refused {
                files,
                line,
                quotes: &quotes,
            }]);
        }
    }
    // The zone of a line is that of its parameters.
    let read = program(&[("job.src", INLINE), ("job.dat", &same)]);
    assert_eq!(read.moves[1].zone, Zone::Within(0.0125));
}

#[test]
fn krl_attitudes_frames_by_parts_and_further_axes_are_not_overlooked() {
    let job = |body: &str| format!("DEF job( )\n$VEL.CP=0.1\n{body}\nEND\n");
    let turned = "LIN {X 850,Y 80,Z 690,A 0,B 90,C 170}";
    let line = |body: &str| job(&format!("{body}\nPTP XP1\n{turned}"));
    let kept = line("$ORI_TYPE=#CONSTANT");
    let plain = data("");
    let kept_by_data = data("DECL LDAT LCPDAT2={VEL 0.3,ORI_TYP #CONSTANT}\n");
    let by_data = job(&format!(
        "LDAT_ACT=LCPDAT2\nBAS(#CP_PARAMS,0.3)\nPTP XP1\n{turned}"
    ));
    let fixed = line("$IPO_MODE=#TCP");
    let part = line("$BASE.X=100");
    let frame_part = line("BASE_DATA[4].X=100\n$BASE=BASE_DATA[4]");
    let rail = job("PTP {X 850,Y 0,Z 700,A 0,B 90,C 180,E1 0,E2 1500}");
    let home = job("PTP XHOME");
    let moved_home = job("XP1={X 850,Y 0,Z 700,A 0,B 90,C 180}\nXP1=XHOME\nPTP XP1");
    let told = "the tool keeps its attitude";
    are_refused(&[
        Refused {
            files: &[("job.src", &kept), ("job.dat", &plain)],
            line: 5,
            quotes: &["#CONSTANT", told],
        },
        Refused {
            files: &[("job.src", &by_data), ("job.dat", &kept_by_data)],
            line: 6,
            quotes: &["#CONSTANT", told],
        },
        Refused {
            files: &[("job.src", &fixed), ("job.dat", &plain)],
            line: 3,
            quotes: &["`$IPO_MODE #TCP` is not read"],
        },
        Refused {
            files: &[("job.src", &part)],
            line: 3,
            quotes: &["`$BASE.X` is not read", "give the frame whole"],
        },
        Refused {
            files: &[("job.src", &frame_part)],
            line: 3,
            quotes: &["`BASE_DATA[4].X` is not read"],
        },
        Refused {
            files: &[("job.src", &rail)],
            line: 3,
            quotes: &["E2 is 1500", "a turntable is read, as E1"],
        },
        Refused {
            files: &[("job.src", &home)],
            line: 3,
            quotes: &["`XHOME` is not read", "job.dat, which would declare it"],
        },
        Refused {
            files: &[("job.src", &home), ("job.dat", &plain)],
            line: 3,
            quotes: &["`XHOME` is not read", "nor the .dat", "$config.dat"],
        },
        Refused {
            files: &[("job.src", &moved_home)],
            line: 4,
            quotes: &["`XHOME` is not read", "job.dat, which would declare it"],
        },
    ]);
    // The same attitude at both ends is kept by any mode.
    let even = job("$ORI_TYPE=#CONSTANT\nPTP XP1\nLIN XP2");
    let read = program(&[("job.src", &even), ("job.dat", &plain)]);
    are_near(
        &places_mm(&read),
        &[[850.0, 0.0, 700.0], [850.0, 80.0, 690.0]],
    );
    // Axes stand where they stand in any frame; a part of a known frame moves it.
    let frames = job(
        "$TOOL=$NULLFRAME\n$BASE=$NULLFRAME\nPTP {A1 0,A2 0,A3 0,A4 0,A5 90,A6 0}\n\
         BASE_DATA[2]={X 10,Y 0,Z 0,A 0,B 0,C 0}\nBASE_DATA[2].X=50\n$BASE=BASE_DATA[2]\nLIN XP1",
    );
    let read = program(&[("job.src", &frames), ("job.dat", &plain)]);
    are_near(
        &places_mm(&read),
        &[[1000.0, 0.0, 1275.0], [900.0, 0.0, 700.0]],
    );
    // A turntable may be a track.
    let turned = job("PTP {X 850,Y 0,Z 700,A 0,B 90,C 180,E1 90}");
    let notes = program(&[("job.src", &turned)]).notes;
    assert!(
        notes.iter().any(|note| note.contains("a track in mm")),
        "{notes:?}"
    );
}

fn pose(frames: &str, y: f64, more: &str) -> String {
    format!(
        "{frames}, {NUT}\n X = 900 mm, Y = {y} mm, Z = 700 mm,\n W = 180 deg, P = 0 deg, R = 0 deg{more}"
    )
}

#[test]
fn ls_frames_options_and_further_axes_are_not_overlooked() {
    let first = pose("UF : 0, UT : 1", 0.0, "");
    let two = |second: &str, body: &str| ls(body, &[&first, second]);
    let plain = "1:J P[1] 10% FINE ;\n2:L P[2] 10mm/sec FINE ;\n";
    let tool = two(&pose("UF : 0, UT : 2", 60.0, ""), plain);
    let frame = two(&pose("UF : 3, UT : 1", 60.0, ""), plain);
    let table = two(
        &pose("UF : 0, UT : 1", 60.0, ",\n E1 = 0 deg, E2 = 30 deg"),
        plain,
    );
    let joints = "UF : 0, UT : 1,\n J1= 0 deg, J2= 0 deg, J3= 0 deg, J4= 0 deg, J5= -90 deg, J6= 0 deg, J7= 5 deg";
    let seventh = two(joints, plain);
    let circle = ls(
        "1:J P[1] 10% FINE ;\n2:C P[2]\n :  P[1] 10mm/sec FINE ;\n",
        &[&first, &pose("UF : 0, UT : 2", 60.0, "")],
    );
    let option = |word: &str| {
        let body = format!("1:J P[1] 10% FINE ;\n2:L P[2] 10mm/sec FINE {word} ;\n");
        two(&pose("UF : 0, UT : 1", 60.0, ""), &body)
    };
    let options = [
        ("RTCP", "a tool that stands in the cell"),
        ("COORD[1]", "another motion group"),
        ("Wjnt", "the wrist turns by its joints"),
        ("INC", "from where the arm stands"),
        ("Offset,PR[3]", "a register"),
    ];
    for (word, why) in options {
        let text = option(word);
        are_refused(&[Refused {
            files: &[("a.LS", &text)],
            line: 9,
            quotes: &[word, "is not read", why],
        }]);
    }
    are_refused(&[
        Refused {
            files: &[("a.LS", &tool)],
            line: 9,
            quotes: &["UT of the position", "is 2", "must be 1"],
        },
        Refused {
            files: &[("a.LS", &frame)],
            line: 9,
            quotes: &["UF of the position", "is 3", "must be 0"],
        },
        Refused {
            files: &[("a.LS", &table)],
            line: 9,
            quotes: &["E2 is 30", "a turntable is read, as E1"],
        },
        Refused {
            files: &[("a.LS", &seventh)],
            line: 9,
            quotes: &["holds 7 joints", "has 6"],
        },
        Refused {
            files: &[("a.LS", &circle)],
            line: 9,
            quotes: &["UT of the position", "is 2"],
        },
    ]);
    for (text, why) in [
        ("IF R[1]=1,JMP LBL[2]", "branches"),
        ("UTOOL[1]=PR[1]", "a frame of a register"),
    ] {
        let text = ls(&format!("1:  {text} ;\n2:J P[1] 10% FINE ;\n"), &[&first]);
        are_refused(&[Refused {
            files: &[("a.LS", &text)],
            line: 8,
            quotes: &["is not read", why],
        }]);
    }
    // Spaces about `=`, registers and pulses that no move uses.
    let free = ls(
        "1: UFRAME_NUM = 0 ;\n2: UTOOL_NUM = 1 ;\n3: PR[2]=LPOS ;\n4: DO[2]=PULSE,0.5sec ;\n5:J P[1] 10% FINE ;\n",
        &[&first],
    );
    let read = program(&[("a.LS", &free)]);
    are_near(&places_mm(&read), &[[900.0, 0.0, 700.0]]);
    assert_eq!(read.tool.number, 1);
}

/// `RETURN` ends a procedure and `EXIT` the program; `halt` a script. What stands behind is not
/// run.
#[test]
fn what_stands_behind_the_end_is_not_run() {
    let module = "MODULE Job\n  CONST robtarget p10:=[[900,0,700],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n\
        \x20 TASK PERS tasks both{2}:=[[\"T_ROB1\"],[\"T_ROB2\"]];\n\
        \x20 PROC main()\n    ConfL\\Off;\n    ConfJ\\Off;\n    MoveJ p10,v100,fine,tool0,\\WObj:=wobj0;\n    side;\n\
        \x20   MoveL Offs(p10,0,0,10),v100,fine,tool0;\n    EXIT;\n    MoveL Offs(p10,0,0,90),v100,fine,tool0;\n  ENDPROC\n\
        \x20 PROC side()\n    MoveL Offs(p10,0,20,0),v100,fine,tool0;\n    RETURN;\n    MoveL Offs(p10,0,90,0),v100,fine,tool0;\n\
        \x20 ENDPROC\nENDMODULE\n";
    let read = program(&[("job.mod", module)]);
    let wanted = [
        [900.0, 0.0, 700.0],
        [900.0, 20.0, 700.0],
        [900.0, 0.0, 710.0],
    ];
    are_near(&places_mm(&read), &wanted);
    let down = |z: f64| format!("p[0.9,0,{z},0,3.141592653589793,0]");
    for halt in ["halt", "halt()"] {
        let script = format!(
            "def job():\n  movej({})\n  movel({})\n  {halt}\n  movel({})\nend\n",
            down(0.7),
            down(0.69),
            down(0.6)
        );
        let read = program(&[("job.script", &script)]);
        are_near(
            &places_mm(&read),
            &[[900.0, 0.0, 700.0], [900.0, 0.0, 690.0]],
        );
    }
    let (start, via) = (down(0.7), down(0.69));
    let branch =
        format!("def job():\n  movej({start})\n  if (True):\n    movej({via})\n  end\nend\n");
    are_refused(&[Refused {
        files: &[("job.script", &branch)],
        line: 3,
        quotes: &["`if` is not read", "branches"],
    }]);
}

/// What no instruction says is told: which tool and base stand for it.
#[test]
fn a_tool_or_base_that_is_not_given_is_told() {
    let script = "def job():\n  movej(p[0.9,0,0.7,0,3.14,0])\nend\n";
    let source = "DEF job( )\nPTP {X 850,Y 0,Z 700,A 0,B 90,C 180}\nEND\n";
    for (name, text, told) in [
        ("job.script", script, "no set_tcp stands in the script"),
        (
            "job.src",
            source,
            "no $TOOL is selected; the robot's own tool",
        ),
        ("job.src", source, "no $BASE is selected; the base given"),
    ] {
        let notes = program(&[(name, text)]).notes;
        assert!(notes.iter().any(|note| note.contains(told)), "{notes:?}");
    }
    // Blends that meet are passed, those that overlap make the controller skip a move.
    for (blend_mm, overlaps) in [(10.0, false), (11.0, true)] {
        let at = |y: f64| format!("p[0.9,{y},0.7,0,3.14,0], r={}", blend_mm * 1e-3);
        let script = format!(
            "def job():\n  set_tcp(p[0,0,0,0,0,0])\n  movel({})\n  movel({})\n  movel(p[0.9,0.1,0.7,0,3.14,0])\nend\n",
            at(0.0),
            at(0.021)
        );
        let notes = program(&[("job.script", &script)]).notes;
        let is_told = notes
            .iter()
            .any(|note| note.contains("line 4: its blend overlaps"));
        assert_eq!(is_told, overlaps, "{notes:?}");
    }
    let calculated = "def job():\n  z=0.7\n  movej(p[0.9,0,z+0.1,0,3.14,0])\nend\n";
    let elsewhere = "MODULE Job\n  PROC main()\n    Elsewhere;\n  ENDPROC\nENDMODULE\n";
    let (script, module) = ([("job.script", calculated)], [("job.mod", elsewhere)]);
    are_refused(&[
        Refused {
            files: &script,
            line: 3,
            quotes: &["`z+0.1` is not read", "calculated"],
        },
        Refused {
            files: &module,
            line: 3,
            quotes: &["`Elsewhere` is not read", "not in the module"],
        },
    ]);
}

/// With mode 1 the tool turns with the tangent of the arc, whatever the attitude of the end.
#[test]
fn movec_of_mode_1_turns_with_the_tangent() {
    let arc = |mode: &str| {
        let script = format!(
            "def job():\n  movej(p[0.9,0,0.7,0,3.141592653589793,0])\n\
             \x20 movec(p[0.93,0.03,0.7,0,0,0], p[0.9,0.06,0.7,0,3.141592653589793,0]{mode})\n\
             \x20 movec(p[0.87,0.03,0.7,0,0,0], p[0.9,0,0.7,0,3.141592653589793,0]{mode})\nend\n"
        );
        program(&[("job.script", &script)])
    };
    let x = |pose: &nalgebra::Isometry3<f64>| pose.rotation * Vector3::x();
    for (mode, half) in [("", -1.0), (", 1.2, 0.25, 0, 1", 1.0)] {
        let read = arc(mode);
        let poses: Vec<_> = read.moves.iter().map(|step| step.base_from_tool).collect();
        let middle = poses.len() / 2;
        let place = poses[middle].translation.vector;
        assert!(
            (place - Vector3::new(0.9, 0.06, 0.7)).norm() < 1e-9,
            "{place}"
        );
        for (pose, wanted) in [(&poses[middle], half), (&poses[poses.len() - 1], -1.0)] {
            assert!(
                (x(pose).x - wanted).abs() < 1e-9,
                "mode {mode}: {}",
                x(pose)
            );
        }
        // On the way the tool turns by as much as the spoke.
        let spoke = poses[middle / 2].translation.vector - Vector3::new(0.9, 0.03, 0.7);
        let turn_rad = spoke.y.atan2(spoke.x) + std::f64::consts::FRAC_PI_2;
        let expected = match half > 0.0 {
            true => -Vector3::new(turn_rad.cos(), turn_rad.sin(), 0.0),
            false => -Vector3::x(),
        };
        assert!(
            (x(&poses[middle / 2]) - expected).norm() < 1e-9,
            "mode {mode}"
        );
    }
    let other = "def job():\n  movej(p[0.9,0,0.7,0,3.14,0])\n\
                 \x20 movec(p[0.93,0.03,0.7,0,0,0], p[0.9,0.06,0.7,0,3.14,0], mode=2)\nend\n";
    let quotes = ["the mode of movec is 2", "must be 0", "or 1"];
    are_refused(&[Refused {
        files: &[("job.script", other)],
        line: 3,
        quotes: &quotes,
    }]);
}

/// A job of later controllers: a long name, a folder, local variables; with the place of one
/// move.
fn job(name: &str, tool: u8, y: f64, instructions: &str) -> String {
    let count = usize::from(instructions.contains("C00000"));
    let place = match count {
        0 => String::new(),
        _ => format!(
            "///POSTYPE BASE\n///RECTAN\n///RCONF 1,0,0,0,0,0\nC00000=900.000,{y:.3},700.000,180.0000,0.0000,0.0000\n"
        ),
    };
    format!(
        "/JOB\n//NAME {name}\n///FOLDERNAME PARTS\n//POS\n///NPOS {count},0,0,0,0,0\n///TOOL {tool}\n{place}//INST\n\
         ///DATE 2026/01/31 12:00\n///ATTR SC,RW\n///GROUP1 RB1\n\
         ///LVARS 0,0,0,0,0,5,0,0\nNOP\n{instructions}END\n"
    )
}

#[test]
fn jobs_that_are_called_have_the_tool_of_the_moves_before() {
    let move_ = "MOVJ C00000 VJ=25.00\n";
    let main = job(
        "MAIN",
        2,
        0.0,
        "CALL JOB:Left_side-of-table\nCALL JOB:RIGHT\n",
    );
    let left = job("Left_side-of-table", 1, 0.0, move_);
    let beside = format!("SET B000 1\nMSG \"go\"\n{move_}");
    let right = job("RIGHT", 1, 40.0, &beside);
    let read = program(&[
        ("MAIN.JBI", &main),
        ("Left_side-of-table.JBI", &left),
        ("RIGHT.JBI", &right),
    ]);
    are_near(
        &places_mm(&read),
        &[[900.0, 0.0, 700.0], [900.0, 40.0, 700.0]],
    );
    assert_eq!(read.tool.number, 1);
    let other = job("RIGHT", 3, 40.0, move_);
    are_refused(&[Refused {
        files: &[
            ("MAIN.JBI", &main),
            ("Left_side-of-table.JBI", &left),
            ("RIGHT.JBI", &other),
        ],
        line: 14,
        quotes: &["///TOOL of the job that is called is 3", "must be 1"],
    }]);
    let own = job("MAIN", 2, 0.0, "CALL JOB:RIGHT\nMOVJ C00000 VJ=25.00\n");
    are_refused(&[Refused {
        files: &[("MAIN.JBI", &own), ("RIGHT.JBI", &right)],
        line: 17,
        quotes: &["///TOOL of the job that is called is 1", "must be 2"],
    }]);
    let foreign =
        "/JOB\n//NAME USERS\n//POS\n///NPOS 1,0,0,0,0,0\n///USER 2\n///TOOL 1\n///POSTYPE USER\n";
    are_refused(&[Refused {
        files: &[("USERS.JBI", foreign)],
        line: 7,
        quotes: &["of type USER", "frames"],
    }]);
}
