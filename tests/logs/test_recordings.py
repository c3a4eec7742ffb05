"""Recordings of RTDE (Universal Robots) and logs of RSI (KUKA) are read without a line of conversion."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from called import ELBOW, ROOT, assert_same_diagnosis, diagnosed, diagnosed_of_csv, truecut
from recordings import axes, write_rsi, write_rtde

SEEDS = range(3)


def suggested(file: Path) -> dict[str, tuple[str, str]]:
    """Columns with channel and unit, as a scenario would say them."""
    pattern = r'column = "([^"]+)"\nchannel = "([^"]+)".*\nunit = "([^"]+)"'
    found = re.findall(pattern, truecut("data", file, "--toml").stdout)
    return {column: (channel, unit) for column, channel, unit in found}


@pytest.mark.parametrize("delimiter", [" ", ","])
@pytest.mark.parametrize("seed", SEEDS)
def test_rtde_is_recognised(seed, delimiter, tmp_path):
    draw = np.random.default_rng(seed)
    rows = int(draw.integers(40, 120))
    rate_hz = float(draw.choice([125, 500]))
    fields = {"timestamp": draw.uniform(0, 1e5) + np.arange(rows) / rate_hz}
    vectors = ["target_q", "actual_q", "actual_qd", "actual_current", "target_moment"]
    vectors += ["actual_TCP_pose", "actual_TCP_force"]
    fields |= {name: draw.normal(0, 1, (rows, 6)) for name in draw.permutation(vectors)}
    fields |= {"actual_tool_accelerometer": draw.normal(0, 1, (rows, 3)), "payload": draw.normal(0, 1, rows)}
    fields |= {"output_bit_register_64": draw.random(rows) > 0.5, "robot_mode": np.full(rows, 7)}
    file = tmp_path / "robot_data.csv"
    write_rtde(file, fields, delimiter)
    found = json.loads(truecut("data", file, "--json").stdout)["tables"][0]
    assert any("RTDE" in note for note in found["notes"])
    time = found["time"]
    assert (time["column"], time["unit"], time["unit_guessed"]) == ("timestamp", "s", None)
    assert abs(time["rate_hz"] - rate_hz) < 1e-3 * rate_hz
    units = {column["name"]: column["unit"] for column in found["columns"]}
    for name, unit in {"actual_q": "rad", "actual_qd": "rad/s", "actual_current": "A", "target_moment": "N m"}.items():
        assert all(units[f"{name}_{k}"] == unit for k in range(6))
    said = suggested(file)
    for k in range(6):
        assert said[f"actual_q_{k}"] == (f"joint{k + 1}.angle", "rad")
        assert said[f"target_q_{k}"] == (f"joint{k + 1}.command", "rad")
        assert said[f"actual_qd_{k}"] == (f"joint{k + 1}.velocity", "rad/s")
    for k, axis in enumerate("xyz"):
        assert said[f"actual_TCP_force_{k}"] == (f"tool.force_{axis}", "N")
        assert said[f"actual_TCP_force_{k + 3}"][1] == "N m"
        assert said[f"actual_TCP_pose_{k}"] == (f"tool.position_{axis}", "m")
        assert said[f"actual_tool_accelerometer_{k}"][1] == "m/s^2"
    assert said["payload"][1] == "kg" and "robot_mode" not in said
    values = {column["name"]: column for column in found["columns"]}
    assert values["output_bit_register_64"]["largest"] == 1.0
    assert values["actual_q_3"]["largest"] == fields["actual_q"][:, 3].max()


def test_other_tables_are_not_of_rtde(tmp_path):
    """One element, or the name of a field alone, says nothing."""
    file = tmp_path / "own.csv"
    file.write_text("timestamp,payload,actual_q_0\n" + "".join(f"{k},{k % 3},{k % 7}\n" for k in range(50)))
    found = json.loads(truecut("data", file, "--json").stdout)["tables"][0]
    assert not any("RTDE" in note for note in found["notes"])
    assert all(column["unit"] is None for column in found["columns"])


@pytest.mark.parametrize("seed", SEEDS)
def test_telegrams_of_rsi_are_rows(seed, tmp_path):
    draw = np.random.default_rng(seed)
    rows, cycle_ms = int(draw.integers(40, 120)), int(draw.choice([4, 12]))
    ipoc = int(draw.integers(1, 2**32)) + cycle_ms * np.arange(rows)
    place = {key: draw.normal(0, 500, rows) for key in "XYZABC"}
    q, currents = draw.normal(0, 60, (rows, 6)), draw.normal(0, 5, (rows, 6))
    elements = {"RIst": place, "AIPos": axes(q), "ASPos": axes(q + 0.01), "MACur": axes(currents)}
    answers = {"RKorr": {key: draw.normal(0, 1, rows) for key in "XYZABC"}} if draw.random() < 0.5 else None
    file = tmp_path / str(draw.choice(["rsi.xml", "rsi.log", "rsi.txt"]))
    write_rsi(file, ipoc, elements, answers, lead=str(draw.choice(["", "12:00:01.25 received "])))
    found = json.loads(truecut("data", file, "--json").stdout)["tables"][0]
    assert found["rows"] == rows
    time = found["time"]
    assert (time["column"], time["unit"], time["unit_guessed"]) == ("IPOC", "ms", None)
    assert abs(time["rate_hz"] - 1000 / cycle_ms) < 1e-3 and time["gaps"] == 0
    values = {column["name"]: column for column in found["columns"]}
    for k in range(6):
        column = values[f"AIPos.A{k + 1}"]
        assert column["unit"] == "deg" and column["largest"] == q[:, k].max() and column["missing"] == 0
        assert values[f"MACur.A{k + 1}"]["unit"] is None
    assert values["RIst.X"]["unit"] == "mm" and values["RIst.C"]["unit"] == "deg"
    said = suggested(file)
    assert said["AIPos.A6"] == ("joint6.angle", "deg") and said["ASPos.A2"] == ("joint2.command", "deg")
    assert said["RIst.Z"] == ("tool.position_z", "mm")
    if answers:
        assert values["RKorr.Y"]["smallest"] == answers["RKorr"]["Y"].min() and said["RKorr.A"][1] == "deg"


def elbow_as(kind: str, folder: Path) -> Path:
    """The arm's shipped case in a maker's form: only names and units of columns change in the scenario."""
    table = np.loadtxt(ELBOW.with_suffix(".csv"), delimiter=",", skiprows=1)
    time, commands, rest = table[:, 0], table[:, 1:3], table[:, 3:]
    own = ELBOW.read_text().replace("../../", f"{ROOT}/")
    if kind == "rtde":
        file = folder / "elbow.csv"
        padded = np.hstack([np.radians(commands), np.zeros((len(time), 4))])
        fields = {"timestamp": time, "target_q": padded, "torque": rest[:, :2], "height_mm": rest[:, 2]}
        write_rtde(file, fields)
        names = {f"command_{k}_deg": f"target_q_{k - 1}" for k in (1, 2)} | {"t_s": "timestamp"}
        names |= {f"torque_{k}_n_m": f"torque_{k - 1}" for k in (1, 2)}
        own = own.replace('unit = "deg"', 'unit = "rad"')
    else:
        file = folder / "elbow.xml"
        elements = {"ASPos": axes(commands), "Torque": axes(rest[:, :2]), "RIst": {"Z": rest[:, 2]}}
        write_rsi(file, 1000 + np.round(time * 1000), elements)
        names = {f"command_{k}_deg": f"ASPos.A{k}" for k in (1, 2)} | {"height_mm": "RIst.Z"}
        names |= {f"torque_{k}_n_m": f"Torque.A{k}" for k in (1, 2)}
        own = own.replace('time = "t_s"', 'time = "IPOC"\ntime_unit = "ms"')
    for old, new in names.items():
        own = own.replace(f'"{old}"', f'"{new}"')
    scenario = folder / "elbow.toml"
    scenario.write_text(own.replace('"elbow.csv"', f'"{file.name}"'))
    return scenario


@pytest.mark.parametrize("kind", ["rtde", "rsi"])
def test_a_comparison_is_that_of_the_csv(kind, tmp_path):
    told = []
    for index, path in enumerate((ELBOW, elbow_as(kind, tmp_path))):
        truecut("compare", path, "--out", tmp_path / str(index))
        (report,) = (tmp_path / str(index)).rglob("compare.json")
        told.append(json.loads(report.read_text()))
    ours, theirs = ({one["channel"]: one for one in report["channels"]} for report in told)
    assert ours.keys() == theirs.keys() and ours
    for name, one in ours.items():
        level = theirs[name]["level"]
        assert one["level"]["samples"] == level["samples"] > 1000
        for key in ("rms_error", "nrmse", "largest_error"):
            assert np.isclose(one["level"][key], level[key], rtol=1e-6, atol=0), (name, key)


@pytest.mark.parametrize("kind", ["rtde", "rsi"])
def test_a_diagnosis_is_that_of_the_csv(kind, tmp_path):
    assert_same_diagnosis(diagnosed(elbow_as(kind, tmp_path), tmp_path / "out"), diagnosed_of_csv())
