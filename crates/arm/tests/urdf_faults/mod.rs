//! What each faulty URDF in `tests/invalid_input/urdf` is to be refused with.

/// File, line of the fault, and what the message must quote.
pub const URDF_FAULTS: &[(&str, Option<usize>, &[&str])] = &[
    (
        "xml_error",
        Some(17),
        &["not well-formed XML", "'inertial'"],
    ),
    (
        "entities",
        Some(4),
        &["not well-formed XML", "entity reference loop"],
    ),
    (
        "entities_of_links",
        Some(4),
        &["not well-formed XML", "entity reference loop"],
    ),
    (
        "latin_1",
        Some(3),
        &["the byte 0xf6", "is not UTF-8", "encoding=\"ISO-8859-1\""],
    ),
    (
        "unknown_encoding",
        Some(1),
        &["\"klingon\"", "save it as UTF-8"],
    ),
    ("not_a_robot", Some(3), &["<sdf>", "<robot>"]),
    ("no_links", None, &["no links"]),
    (
        "loop_two_parents",
        Some(49),
        &[
            "\"coupler\"",
            "\"left_pin\"",
            "\"right_pin\"",
            "closed loop",
        ],
    ),
    (
        "loop_closed",
        Some(26),
        &["fore -> upper -> fore", "closed loop"],
    ),
    (
        "two_roots",
        Some(33),
        &["2 root links", "\"base\", \"stand\"", "exactly one"],
    ),
    (
        "floating_joint",
        Some(19),
        &["\"elbow\"", "\"fore\"", "floating", "only revolute"],
    ),
    (
        "planar_joint",
        Some(19),
        &["\"elbow\"", "planar", "only revolute"],
    ),
    (
        "unknown_joint_type",
        Some(5),
        &["\"shoulder\"", "\"hinge\""],
    ),
    (
        "zero_mass",
        Some(15),
        &["\"upper\"", "\"shoulder\"", "mass 0 kg", "positive mass"],
    ),
    (
        "negative_mass",
        Some(15),
        &["\"upper\"", "-4 kg", "must not be negative"],
    ),
    (
        "inertia_triangle",
        Some(16),
        &["\"upper\"", "triangle rule", "0.13 kg m^2", "0.12 kg m^2"],
    ),
    (
        "inertia_not_positive",
        Some(16),
        &["\"upper\"", "-2.000000e-2", "none may be negative"],
    ),
    (
        "zero_axis",
        Some(23),
        &["\"elbow\"", "length 0", "longer than"],
    ),
    (
        "duplicate_link",
        Some(40),
        &["link name \"upper\"", "twice", "line 12"],
    ),
    (
        "duplicate_joint",
        Some(19),
        &["joint name \"shoulder\"", "twice", "line 5"],
    ),
    (
        "nan_mass",
        Some(15),
        &["<mass value=\"nan\">", "\"upper\"", "finite"],
    ),
    (
        "nan_origin",
        Some(8),
        &[
            "<origin xyz=\"0 NaN 0.4\">",
            "\"shoulder\"",
            "three finite numbers",
        ],
    ),
    (
        "short_axis",
        Some(9),
        &["<axis xyz=\"0 1\">", "three finite numbers"],
    ),
    ("no_inertia_term", Some(16), &["<inertia>", "`iyz`"]),
    (
        "no_mass",
        Some(13),
        &["<inertial>", "link \"upper\"", "no <mass>"],
    ),
    ("no_joint_name", Some(19), &["<joint>", "`name`"]),
    (
        "unknown_link",
        Some(7),
        &["\"shoulder\"", "child", "\"uper\"", "base, upper"],
    ),
    (
        "mimic_unknown",
        Some(24),
        &["\"elbow\"", "mimics \"sholder\"", "known: elbow, shoulder"],
    ),
    ("mimic_itself", Some(24), &["\"elbow\"", "mimics itself"]),
    ("no_moving_joint", Some(12), &["0 moving joints", "1 to 12"]),
    (
        "thirteen_joints",
        Some(180),
        &["13 moving joints", "1 to 12"],
    ),
    (
        "limits_reversed",
        Some(10),
        &["\"shoulder\"", "lower limit 2", "upper limit -2"],
    ),
    (
        "negative_damping",
        Some(11),
        &["\"shoulder\"", "damping is -5", "must not be negative"],
    ),
    (
        "negative_velocity_limit",
        Some(10),
        &["\"shoulder\"", "velocity limit is -1"],
    ),
    (
        "ambiguous_tip",
        None,
        &[
            "choose one",
            "\"left_hand\" (1 joint)",
            "\"right_hand\" (1 joint)",
        ],
    ),
    ("overflowing_axis", Some(23), &["\"elbow\"", "finite"]),
    ("mass_too_large", Some(29), &["\"fore\"", "mass", "1e6 kg"]),
    (
        "mass_too_small",
        Some(29),
        &["\"fore\"", "0.000000000001", "1e-9"],
    ),
    (
        "inertia_too_large",
        Some(30),
        &["\"fore\"", "inertia", "1e9"],
    ),
    (
        "origin_too_far",
        Some(22),
        &["\"elbow\"", "origin", "1e4 m"],
    ),
    ("xacro", Some(22), &["${length}", "is called .xacro"]),
    (
        "inertia_in_kg_mm2",
        Some(16),
        &[
            "\"upper\"",
            "radius of gyration about its centre is 127 m",
            "more than the whole arm is long",
            "in kg mm^2 it were 0.127 m",
        ],
    ),
    (
        "centre_in_mm",
        Some(14),
        &[
            "\"upper\"",
            "200 m from the link's frame",
            "given in m; in mm it were 0.2 m",
        ],
    ),
];
