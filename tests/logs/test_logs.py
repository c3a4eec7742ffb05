"""Robots' logs as measured data: what other people's writers wrote is what truecut reads."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from pathlib import Path

import bags
import numpy as np
import pytest
from called import ROOT, assert_same_diagnosis, diagnosed, diagnosed_of_csv, truecut
from mcap.writer import CompressionType

# no stored result: drawn anew from these
SEEDS = range(4)


def inspected(file: Path) -> dict:
    """What `truecut data` finds."""
    return json.loads(truecut("data", file, "--json").stdout)


def table(found: dict, source: str) -> dict:
    """The table of a topic."""
    (one,) = [table for table in found["tables"] if table["source"] == source]
    return one


def columns(found: dict, source: str) -> dict[str, dict]:
    """The columns of a topic by name."""
    return {column["name"]: column for column in table(found, source)["columns"]}


def compared(scenario: Path, out: Path) -> dict:
    """What `truecut compare` says of the channels."""
    truecut("compare", scenario, "--out", out)
    (report,) = out.rglob("compare.json")
    return json.loads(report.read_text())


def refused(tmp_path: Path, text: str) -> str:
    """The error of a scenario that must be refused."""
    scenario = tmp_path / "elbow.toml"
    scenario.write_text(text)
    report = truecut("compare", scenario, "--out", tmp_path / "out", code=2).stderr
    assert "elbow.toml" in report
    return " ".join(report.replace("│", " ").split())


@pytest.fixture(scope="module")
def of_csv(tmp_path_factory) -> dict:
    """The comparison of the scenario as it is shipped."""
    return compared(ROOT / "scenarios" / "diagnosis" / "elbow.toml", tmp_path_factory.mktemp("csv"))


def numbers(report, path: str = "") -> dict[str, float]:
    """All numbers of a report by where they stand."""
    found = {}
    items = report.items() if isinstance(report, dict) else enumerate(report) if isinstance(report, list) else ()
    for key, value in items:
        found |= numbers(value, f"{path}/{key}")
    if isinstance(report, (int, float)) and not isinstance(report, bool):
        found[path] = float(report)
    return found


def write_plain(folder: Path, messages: list) -> Path:
    return bags.write_mcap(folder / "plain.mcap", messages, CompressionType.NONE)


def write_zstd(folder: Path, messages: list) -> Path:
    return bags.write_mcap(folder / "zstd.mcap", messages, CompressionType.ZSTD)


def write_lz4(folder: Path, messages: list) -> Path:
    return bags.write_mcap(folder / "lz4.mcap", messages, CompressionType.LZ4)


def write_bag(folder: Path, messages: list) -> Path:
    return bags.write_bag(folder / "bag", messages)


def write_big_endian(folder: Path, messages: list) -> Path:
    return bags.write_bag(folder / "big", messages, little_endian=False)


def write_names_alone(folder: Path, messages: list) -> Path:
    file = folder / "names.mcap"
    file.write_bytes(bags.without_definitions(messages))
    return file


WRITERS = [write_plain, write_zstd, write_lz4, write_bag, write_big_endian, write_names_alone]


@pytest.mark.parametrize("write", WRITERS)
def test_a_log_compares_like_the_table_that_it_was_made_of(write, of_csv, tmp_path):
    scenario = tmp_path / "elbow.toml"
    scenario.write_text(bags.elbow_scenario(write(tmp_path, bags.elbow())))
    of_log = compared(scenario, tmp_path / "out")
    assert of_log["channels"], "nothing was compared"
    expected, found = numbers(of_csv["channels"]), numbers(of_log["channels"])
    assert found.keys() == expected.keys()
    # times are rounded to a nanosecond, angles to a double
    worst = max(abs(found[key] - expected[key]) / (1e-9 + abs(expected[key])) for key in expected if np.isfinite(expected[key]))
    assert worst < 1e-5, worst


@pytest.mark.parametrize("write", [write_zstd, write_bag, write_names_alone])
def test_a_log_is_diagnosed_like_the_table_that_it_was_made_of(write, tmp_path):
    scenario = tmp_path / "elbow.toml"
    scenario.write_text(bags.elbow_scenario(write(tmp_path, bags.elbow())))
    assert_same_diagnosis(diagnosed(scenario, tmp_path / "out"), diagnosed_of_csv())


@pytest.mark.parametrize("seed", SEEDS)
def test_what_was_written_is_read(seed, tmp_path):
    """Joints whose order changes from message to message, lists that are left out, wrenches at another rate."""
    draw = random.Random(seed)
    joints = [f"joint_{draw.choice('abcdef')}{k}" for k in range(draw.randint(1, 7))]
    rate = draw.choice([100, 125, 500, 1000])
    messages, positions, forces = [], {name: [] for name in joints}, []
    for k in range(300):
        ns = bags.STARTS_NS + k * bags.NS // rate
        order = draw.sample(joints, len(joints))
        values = {name: draw.gauss(0, 2) for name in order}
        for name in joints:
            positions[name].append(values[name])
        listed = [values[name] for name in order]
        messages.append(bags.joint_state("/arm/joint_states", ns, draw.randint(0, 10**6), order, position=listed))
        force = [draw.gauss(0, 100) for _ in range(6)]
        forces.append(force)
        parts = {part: dict(zip("xyz", force[at : at + 3])) for part, at in (("force", 0), ("torque", 3))}
        fields = bags.stamped(ns + 7, wrench=parts)
        messages.append(bags.Message("/wrench", "geometry_msgs/msg/WrenchStamped", ns + 2_000_000, fields))
        messages.append(bags.Message("/pressure", "std_msgs/msg/Float64", ns, {"data": draw.random()}))
    draw.shuffle(messages)
    messages.sort(key=lambda one: one.log_ns)
    write = draw.choice(WRITERS)
    found = inspected(write(tmp_path, messages))
    of_joints = columns(found, "/arm/joint_states")
    assert sorted(of_joints) == sorted(f"/arm/joint_states/position/{name}" for name in joints)
    for name in joints:
        column = of_joints[f"/arm/joint_states/position/{name}"]
        assert [column["smallest"], column["largest"]] == [min(positions[name]), max(positions[name])]
        assert column["missing"] == 0
    of_wrench = columns(found, "/wrench")
    for at, (part, axis) in enumerate((part, axis) for part in ("force", "torque") for axis in "xyz"):
        column = of_wrench[f"/wrench/wrench/{part}/{axis}"]
        assert column["largest"] == max(force[at] for force in forces)
        assert column["unit"] == {"force": "N", "torque": "N m"}[part]
    times = table(found, "/arm/joint_states")["time"]
    assert times["column"] == "header_stamp"
    assert times["rate_hz"] == pytest.approx(rate, rel=1e-6)
    assert table(found, "/pressure")["time"]["column"] == "log_time"
    assert "time = \"log_time\"" in found["suggested"]


def test_what_is_suggested_is_taken_as_it_is(tmp_path):
    """Joints with numbers are recognised; what is not is there to be named."""
    messages = [
        one._replace(fields=one.fields | {"name": ["joint_1", "joint_2"]}) if "name" in one.fields else one
        for one in bags.elbow()
    ]
    file = bags.write_mcap(tmp_path / "run.mcap", messages)
    suggested = truecut("data", file, "--toml").stdout
    for column, channel in (
        ("/command/position/joint_1", "joint1.command"),
        ("/command/position/joint_2", "joint2.command"),
        ("/joint_states/effort/joint_1", "joint1.drive_torque"),
        ("/tool/pose/position/z", "tool.position_z"),
    ):
        assert f'column = "{column}"\nchannel = "{channel}"' in suggested, suggested
    scenario = tmp_path / "elbow.toml"
    head = bags.elbow_scenario(file).partition("[data]")[0]
    for name in ("joint1.command", "joint2.command"):
        suggested = suggested.replace(f'"{name}" # by its name\n', f'"{name}"\nrole = "input"\n')
    scenario.write_text(head + suggested)
    assert compared(scenario, tmp_path / "out")["channels"]


def test_gaps_jitter_and_faults_are_told(tmp_path):
    draw = random.Random(11)
    messages = []
    for k in range(1000):
        if 400 <= k < 425:
            continue
        ns = bags.STARTS_NS + k * 2_000_000 + draw.randint(-100_000, 100_000)
        value = min(float(np.sin(0.02 * k)), 0.8) + 1e-3 * draw.gauss(0, 1) * (np.sin(0.02 * k) < 0.8)
        if k in (100, 800):
            value += 5.0
        effort = [0.125 if 600 <= k < 640 else value]
        messages.append(bags.joint_state("/joint_states", ns, 1_000_000, ["a"], position=[value], effort=effort))
    found = inspected(bags.write_mcap(tmp_path / "faults.mcap", messages))
    times = table(found, "/joint_states")["time"]
    assert (times["gaps"], times["lost_rows"]) == (1, 25)
    assert 4e-5 < times["jitter_s"] < 2e-4
    position, effort = (columns(found, "/joint_states")[f"/joint_states/{kind}/a"] for kind in ("position", "effort"))
    assert position["spikes"] >= 2
    assert effort["stuck_rows"] >= 40


# ---- bad input


def test_a_topic_that_is_not_there_is_told_with_those_that_are(tmp_path):
    file = bags.write_mcap(tmp_path / "run.mcap", bags.elbow())
    channels = bags.ELBOW_CHANNELS.replace("/tool/", "/tcp/")
    report = refused(tmp_path, bags.elbow_scenario(file, channels=channels))
    assert 'no column "/tcp/pose/position/z"' in report
    assert "/tool/pose/position/z" in report and "/joint_states/effort/elbow" in report


def test_a_type_that_is_not_known_is_told(tmp_path):
    from mcap.writer import Writer

    file = tmp_path / "run.mcap"
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("my_msgs/msg/Thing", "", b"")
        channel = writer.register_channel("/tool", "cdr", schema)
        other = writer.register_channel("/command", "json", writer.register_schema("x", "jsonschema", b"{}"))
        for k in range(300):
            writer.add_message(channel, log_time=k, publish_time=k, data=b"\0\1\0\0")
            writer.add_message(other, log_time=k, publish_time=k, data=b"{}")
        writer.finish()
    report = refused(tmp_path, bags.elbow_scenario(file))
    assert "run.mcap" in report and "no topic can be read" in report
    assert '"my_msgs/msg/Thing" is not known' in report and 'encoded as "json"' in report


def test_a_compression_that_is_not_known_is_told(tmp_path):
    file = bags.write_mcap(tmp_path / "run.mcap", bags.elbow())
    file.write_bytes(file.read_bytes().replace(b"\4\0\0\0zstd", b"\4\0\0\0zlib"))
    report = refused(tmp_path, bags.elbow_scenario(file))
    assert 'compressed as "zlib"; "zstd", "lz4" and none are read' in report


@pytest.mark.parametrize("seed", range(6))
def test_a_cut_log_is_told_wherever_it_ends(seed, tmp_path):
    draw = random.Random(seed)
    file = draw.choice(WRITERS)(tmp_path, bags.elbow())
    whole = file.read_bytes()
    file.write_bytes(whole[: draw.randrange(len(whole))])
    report = truecut("data", file, code=2).stderr
    assert file.name in report and ("ends in" in report or "not an MCAP file" in report or "there is no" in report), report


def test_clocks_that_disagree_are_told(tmp_path):
    messages = [
        one._replace(log_ns=one.log_ns + 3 * bags.NS) if one.topic == "/tool" else one for one in bags.elbow()
    ]
    messages.sort(key=lambda one: one.log_ns)
    file = bags.write_mcap(tmp_path / "run.mcap", messages)
    report = refused(tmp_path, bags.elbow_scenario(file))
    assert "two clocks disagree" in report and "/tool 3.001 s after" in report and 'time = "log_time"' in report


def test_a_topic_without_stamps_is_told(tmp_path):
    messages = bags.elbow()
    messages += [bags.Message("/height", "std_msgs/msg/Float64", one.log_ns, {"data": 1.0}) for one in messages[::3]]
    messages.sort(key=lambda one: one.log_ns)
    file = bags.write_mcap(tmp_path / "run.mcap", messages)
    channels = bags.ELBOW_CHANNELS.replace("/tool/pose/position/z", "/height/data")
    report = refused(tmp_path, bags.elbow_scenario(file, channels=channels))
    assert '/height: no column "header_stamp"' in report and "log_time" in report


def test_a_bag_in_sqlite_is_told_with_the_command_that_helps(tmp_path):
    file = bags.write_bag(tmp_path / "bag", bags.elbow()[:900], sqlite=True)
    report = truecut("data", file, code=2).stderr
    assert "rosbags-convert --src BAG --dst NEW_BAG --dst-storage mcap" in report
    assert "give the .mcap file" in truecut("data", file.parent, code=2).stderr
    convert = Path(sys.executable).parent / "rosbags-convert"
    command = [convert, "--src", file.parent, "--dst", tmp_path / "new", "--dst-storage", "mcap"]
    subprocess.run(command, check=True, capture_output=True)
    (converted,) = (tmp_path / "new").glob("*.mcap")
    assert table(inspected(converted), "/command")["rows"] == 300
