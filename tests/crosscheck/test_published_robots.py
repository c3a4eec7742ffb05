"""Published robots, read by truecut and by Pinocchio.

Every arm of the PyPI package `example-robot-data` is given to `truecut robot` as it is installed. Its flange pose
must equal that of the same frame in Pinocchio (`pin`) on 100 random postures, and so must the mass that moves with
the first joint: a side branch lost in merging shows there.

Every other robot of the package (walking ones, hands, vehicles) is asked, too: up to three of its ends each, drawn at
random. What is refused must be refused for a reason that the file bears out.

The same poses are asked of every arm in xacro in the folder that `TRUECUT_ROBOTS` names (skipped by name where it is
not set), which Pinocchio reads as the reference program expands it.

None of the robots' files is part of this repository: they come with the pinned packages of
`tests/requirements.txt`.
"""

import csv
import io
import pathlib
import re
import subprocess
import xml.etree.ElementTree as ElementTree

import cmeel
import numpy as np
import pinocchio as pin
import pytest
import test_xacro
import xacro

POSTURES = 100
#: A run that is refused before anything of it matters.
RUN = '''name = "coupled wrist"
[robot]
urdf = "{urdf}"
config = "{config}"
posture_deg = [0, 0, 0, 0, 20, 0]
[process.load]
constant_n = [1.0, 0.0, 0.0]
[run]
duration_s = 0.01
'''
#: Both programs use double precision on a reach of about a metre: 1e-9 m is some five orders above rounding.
TOLERANCE_M = 1e-9

#: URDF below the package's robot folder, tip asked for, tip expected. Several ways to ask for the same robot are
#: listed where a user would: the default tip, the last link of the arm proper, the end of a gripper.
ROBOTS = [
    ("ur_description/urdf/ur3_robot.urdf", None, "tool0"),
    ("ur_description/urdf/ur3_joint_limited_robot.urdf", "ee_link", "ee_link"),
    ("ur_description/urdf/ur3_gripper.urdf", None, "tool0"),
    ("ur_description/urdf/ur5_robot.urdf", None, "tool0"),
    ("ur_description/urdf/ur5_joint_limited_robot.urdf", "wrist_3_link", "wrist_3_link"),
    ("ur_description/urdf/ur5_gripper.urdf", None, "tool0"),
    ("ur_description/urdf/ur10_robot.urdf", None, "tool0"),
    ("ur_description/urdf/ur10_joint_limited_robot.urdf", "forearm_link", "forearm_link"),
    ("panda_description/urdf/panda.urdf", None, "panda_hand_tcp"),
    ("panda_description/urdf/panda.urdf", "panda_link8", "panda_link8"),
    ("panda_description/urdf/panda.urdf", "panda_leftfinger", "panda_leftfinger"),
    ("panda_description/urdf/panda_collision.urdf", None, "panda_hand_tcp"),
    ("xarm_description/urdf/xarm7.urdf", None, "link_eef"),
    ("z1_description/urdf/z1.urdf", None, "gripperMover"),
    ("z1_description/urdf/z1.urdf", "gripperStator", "gripperStator"),
    ("kinova_description/robots/kinova.urdf", None, "j2s6s200_end_effector"),
    ("so_arm_description/urdf/so100.urdf", None, "jaw"),
    ("so_arm_description/urdf/so101.urdf", None, "gripper_frame_link"),
    ("so_arm_description/urdf/so101.urdf", "moving_jaw_so101_v1_link", "moving_jaw_so101_v1_link"),
    ("talos_data/robots/talos_left_arm.urdf", "gripper_left_base_link", "gripper_left_base_link"),
    ("asr_twodof_description/urdf/TwoDofs.urdf", None, "Tip"),
    ("double_pendulum_description/urdf/double_pendulum_continuous.urdf", None, "link2"),
    # One arm of a robot with two, an arm on a walking one: a tip makes a chain of any tree.
    ("baxter_description/urdf/baxter.urdf", "left_gripper", "left_gripper"),
    (
        "anymal_b_simple_description/robots/anymal-kinova.urdf",
        "j2s6s200_end_effector",
        "j2s6s200_end_effector",
    ),
]


def robots_folder():
    for root in cmeel.__path__:
        folder = pathlib.Path(root).parent / "cmeel.prefix/share/example-robot-data/robots"
        if folder.is_dir():
            return folder
    pytest.fail("the package example-robot-data is installed without its robots")


def ask(truecut, *arguments):
    """`truecut robot`, whatever comes of it."""
    command = [truecut.binary, "robot", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def chain_joints(model, tip):
    """Moving joints from the root to the frame `tip`, in chain order."""
    joint = model.frames[model.getFrameId(tip, pin.FrameType.BODY)].parentJoint
    chain = []
    while joint > 0:
        chain.insert(0, joint)
        joint = model.parents[joint]
    return chain


def mimicry(root):
    """What joints of a URDF follow: the joint that leads in the end, multiplier and offset."""
    own = {
        joint.get("name"): (
            joint.find("mimic").get("joint"),
            float(joint.find("mimic").get("multiplier", 1)),
            float(joint.find("mimic").get("offset", 0)),
        )
        for joint in root.findall("joint")
        if joint.find("mimic") is not None and joint.get("type") != "fixed"
    }

    def lead(name):
        if name not in own:
            return name, 1.0, 0.0
        leader, multiplier, offset = lead(own[name][0])
        return leader, own[name][1] * multiplier, own[name][1] * offset + own[name][2]

    return {name: lead(name) for name in own}


def random_postures(model, chain, rng):
    """Joint vectors within ±pi or ±1 m and the limits."""
    limits = []
    for joint in chain:
        low, high = -np.pi, np.pi
        if model.joints[joint].nq == 1:
            index = model.joints[joint].idx_q
            low = max(low, model.lowerPositionLimit[index])
            high = min(high, model.upperPositionLimit[index])
        limits.append((low, high) if low < high else (-np.pi, np.pi))
    lows, highs = np.array(limits).T
    return rng.uniform(lows, highs, size=(POSTURES, len(chain)))


def configuration(model, chain, posture, follows):
    """The chain at `posture`, what follows where it is led, everything else at zero; a continuous joint is (cos, sin)
    in Pinocchio."""
    q = pin.neutral(model)
    values = dict(zip(chain, posture))
    led = {model.names[joint]: value for joint, value in values.items()}
    for name, (leader, multiplier, offset) in follows.items():
        values[model.getJointId(name)] = multiplier * led.get(leader, 0.0) + offset
    for joint, value in values.items():
        start = model.joints[joint].idx_q
        if model.joints[joint].nq == 2:
            q[start : start + 2] = np.cos(value), np.sin(value)
        else:
            q[start] = value
    return q


def identify(value):
    return "default tip" if value is None else str(value).rsplit("/", maxsplit=1)[-1]


def assert_same_poses(truecut, path, tip_arguments, model, expected, tmp_path, follows=None):
    """The flange at random postures, by truecut and by Pinocchio."""
    data = model.createData()
    follows = follows or {}
    chain = [joint for joint in chain_joints(model, expected) if model.names[joint] not in follows]
    postures = random_postures(model, chain, np.random.default_rng(20))
    table = tmp_path / "postures.csv"
    table.write_text("\n".join(",".join(repr(float(v)) for v in row) for row in postures) + "\n")

    answer = ask(truecut, path, *tip_arguments, "--fk", table)
    assert answer.returncode == 0, answer.stderr
    rows = list(csv.DictReader(io.StringIO(answer.stdout)))
    assert len(rows) == POSTURES

    frame = model.getFrameId(expected, pin.FrameType.BODY)
    worst_m, worst_rotation = 0.0, 0.0
    for posture, row in zip(postures, rows):
        pin.framesForwardKinematics(model, data, configuration(model, chain, posture, follows))
        pose = data.oMf[frame]
        ours = [float(row[key]) for key in ("x_m", "y_m", "z_m")]
        rotation = [[float(row[f"r{i}{j}"]) for j in (1, 2, 3)] for i in (1, 2, 3)]
        worst_m = max(worst_m, np.abs(pose.translation - ours).max())
        worst_rotation = max(worst_rotation, np.abs(pose.rotation - rotation).max())
    assert worst_m <= TOLERANCE_M
    assert worst_rotation <= TOLERANCE_M


@pytest.mark.parametrize(("urdf", "asked", "expected"), ROBOTS, ids=identify)
def test_crosscheck_pinocchio_flange(truecut, urdf, asked, expected, tmp_path):
    path = robots_folder() / urdf
    tip_arguments = [] if asked is None else ["--tip", asked]
    assert_same_poses(truecut, path, tip_arguments, pin.buildModelFromUrdf(str(path)), expected, tmp_path)


@pytest.mark.skipif(not test_xacro.PUBLISHED, reason="TRUECUT_ROBOTS is not set")
@pytest.mark.parametrize("file", test_xacro.published(), ids=lambda file: file.stem)
def test_crosscheck_pinocchio_flange_of_published_xacro(truecut, file, tmp_path):
    """No masses are asked for: the arms have none, and kinematics need none."""
    try:
        root = test_xacro.reference(file, packages=test_xacro.PUBLISHED)
    except xacro.XacroException as error:
        # A file that the reference program does not expand, either: one that is not there.
        assert ask(truecut, file, "--urdf-text").returncode == 2, error
        return
    model = pin.buildModelFromXML(ElementTree.tostring(root, encoding="unicode"))
    bodies = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    # Of a robot with two arms the first; of a positioner its last table.
    tips = [name for name in bodies if name.endswith("tool0")] or bodies[-1:]
    assert_same_poses(truecut, file, ["--tip", tips[0]], model, tips[0], tmp_path, mimicry(root))


@pytest.mark.skipif(not test_xacro.PUBLISHED, reason="TRUECUT_ROBOTS is not set")
@pytest.mark.parametrize("file", test_xacro.published(".urdf"), ids=lambda file: file.stem)
def test_crosscheck_pinocchio_flange_of_published_urdf(truecut, file, tmp_path):
    root = ElementTree.parse(file).getroot()
    model = pin.buildModelFromUrdf(str(file))
    bodies = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    tip = "tool0" if "tool0" in bodies else bodies[-1]
    assert_same_poses(truecut, file, ["--tip", tip], model, tip, tmp_path, mimicry(root))


@pytest.mark.skipif(not test_xacro.PUBLISHED, reason="TRUECUT_ROBOTS is not set")
def test_a_coupled_wrist_is_read_and_not_run(truecut, tmp_path):
    """An arm whose joint 5b turns with joint 5: six joints, a note, `init`; a run says why it does not take it."""
    file = pathlib.Path(test_xacro.PUBLISHED) / "abb_irb5400_support/urdf/irb5400.xacro"
    config = tmp_path / "robot.toml"
    made = ask(truecut, "init", file, "--mass", 680, "--payload", 25, "--out", config)
    assert made.returncode == 0, made.stderr
    said = ask(truecut, file, "--config", config).stdout
    assert '"joint5b" moves with "joint5", -1 times' in said and "modes (no gravity)" in said
    scenario = tmp_path / "run.toml"
    scenario.write_text(RUN.format(urdf=file, config=config))
    answer = subprocess.run([truecut.binary, "run", scenario], capture_output=True, text=True, check=False)
    assert answer.returncode == 2, answer.stdout
    assert "joint5b" in answer.stderr and "every joint by itself" in answer.stderr, answer.stderr


def every_other_robot():
    """All robot files of the package that `ROBOTS` does not name."""
    folder = robots_folder()
    named = {urdf for urdf, _, _ in ROBOTS}
    files = sorted([*folder.glob("**/*.urdf"), *folder.glob("**/*.xacro")])
    return [file for file in files if str(file.relative_to(folder)) not in named]


def ends(root):
    """Last links of a tree with the joints that lead to each."""
    above = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
    parents = {joint.find("parent").get("link") for joint in root.findall("joint")}
    for link in (link.get("name") for link in root.findall("link")):
        if link in parents:
            continue
        path, at = [], link
        while at in above:
            path.append(above[at])
            at = above[at].find("parent").get("link")
        yield link, path


@pytest.mark.parametrize("file", every_other_robot(), ids=lambda file: file.stem)
def test_crosscheck_pinocchio_every_other_robot(truecut, file, tmp_path):
    answer = ask(truecut, file)
    try:
        root = ElementTree.fromstring(ask(truecut, file, "--urdf-text").stdout)
    except ElementTree.ParseError:
        # The one file that includes another which is not in the package.
        assert file.name == "quadrotor_base.xacro" and "No such file" in answer.stderr, answer.stderr
        return
    if not root.findall("link"):
        assert answer.returncode == 2 and "no links" in answer.stderr
        return
    # Pinocchio reads no elements that are not of a URDF.
    model = pin.buildModelFromXML(ElementTree.tostring(root, encoding="unicode"))
    follows = mimicry(root)
    all_ends = list(ends(root))
    if answer.returncode != 0:
        assert len(all_ends) > 1 and "several possible tips" in answer.stderr or "0 moving joints" in answer.stderr
    moving = lambda path: [j for j in path if j.get("type") != "fixed" and j.get("name") not in follows]
    rng = np.random.default_rng(len(all_ends))
    for index in rng.permutation(len(all_ends))[:3]:
        tip, path = all_ends[index]
        kinds = {joint.get("type") for joint in path}
        if not kinds <= {"revolute", "continuous", "prismatic", "fixed"} or not 1 <= len(moving(path)) <= 12:
            refused = ask(truecut, file, "--tip", tip)
            assert refused.returncode == 2, refused.stdout
            assert "moving joints; 1 to 12" in refused.stderr or "only revolute" in refused.stderr, refused.stderr
            continue
        names = {joint.get("name") for joint in root.findall("joint")}
        mimicked = [joint.find("mimic").get("joint") for joint in path if joint.find("mimic") is not None]
        if not names.issuperset(mimicked):
            refused = ask(truecut, file, "--tip", tip)
            assert refused.returncode == 2 and "which does not exist" in refused.stderr, refused.stderr
            continue
        assert_same_poses(truecut, file, ["--tip", tip], model, tip, tmp_path, follows)


@pytest.mark.parametrize(("urdf", "asked", "expected"), ROBOTS, ids=identify)
def test_crosscheck_pinocchio_moving_mass(truecut, urdf, asked, expected):
    tip_arguments = [] if asked is None else ["--tip", asked]
    answer = ask(truecut, robots_folder() / urdf, *tip_arguments)
    assert answer.returncode == 0, answer.stderr
    assert f'flange "{expected}"' in answer.stdout

    model = pin.buildModelFromUrdf(str(robots_folder() / urdf))
    data = model.createData()
    pin.computeSubtreeMasses(model, data)
    moving_kg = float(re.search(r"([\d.]+) kg moving", answer.stdout).group(1))
    # The report prints six decimals.
    assert abs(moving_kg - data.mass[chain_joints(model, expected)[0]]) <= 1e-6


def test_a_walking_robot_needs_a_tip(truecut):
    answer = ask(truecut, robots_folder() / "anymal_b_simple_description/robots/anymal-kinova.urdf")
    assert answer.returncode == 2
    assert "several possible tips" in answer.stderr
    assert "j2s6s200_end_effector" in answer.stderr


def test_a_file_without_a_robot_is_refused(truecut):
    """The package holds one file from which its generator left everything out."""
    answer = ask(truecut, robots_folder() / "ur_description/urdf/ur3.urdf")
    assert answer.returncode == 2
    assert "no links" in answer.stderr
