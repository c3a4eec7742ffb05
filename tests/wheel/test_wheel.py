"""The Python package: built by the documented command, installed into a fresh venv, used as its page says."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time

import pytest
from built import PROGRAM, ROOT, python, run, with_arrays  # noqa: F401

PAGE = ROOT / "docs" / "python.md"
CHAMFER = "scenarios/chamfer/backward_sufficient.toml"


def test_importing_needs_nothing_else(python):
    if next((python.parents[1] / "lib").rglob("of_tests.pth"), None):
        pytest.skip("another test has put packages beside it")
    script = """
import sys
import truecut
assert not {"numpy", "pyarrow", "pandas"} & set(sys.modules)
r = truecut.load("scenarios/arm/static_load.toml").run(engine="reduced")
assert len(r) > 1 and r.outcome == "completed", r
assert r.channels["tool.displacement_y"] == "m"
try:
    r["tool.displacement_y"]
except ModuleNotFoundError as error:
    assert error.name == "numpy"
else:
    raise AssertionError("numpy is not there")
"""
    run(python, script)


def test_the_page_runs(with_arrays):
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) >= 3
    out = run(with_arrays, "\n".join(blocks))
    assert "joint_backlash" in out and "process.chamfer.depth_mm" in out, out


def test_the_front_page_runs(with_arrays):
    (block,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    out = run(with_arrays, block + "\nassert table.num_columns == len(recording.channels) + 1\n")
    assert out.startswith("True "), out


def test_a_run_is_that_of_the_program_to_the_bit(with_arrays, tmp_path):
    subprocess.run([PROGRAM, "run", CHAMFER, "--out", tmp_path, "--no-rrd"], cwd=ROOT, check=True, capture_output=True)
    (file,) = tmp_path.rglob("recording.parquet")
    script = f"""
import truecut, numpy as np, pyarrow, pyarrow.parquet
recording = truecut.load("{CHAMFER}").run()
ours, table = pyarrow.table(recording), pyarrow.parquet.read_table({str(file)!r})
assert ours.column_names == table.column_names
for name in ours.column_names:
    assert ours[name].to_numpy().tobytes() == table[name].to_numpy().tobytes(), name
    assert np.array_equal(recording[name], table[name].to_numpy()), name
# twice the same memory: nothing was copied
first, second = (pyarrow.table(recording)["time"].chunk(0).buffers()[1].address for _ in range(2))
assert first == second
"""
    run(with_arrays, script)


def test_the_wheel_keeps_to_the_stable_abi(python):
    """Every symbol of Python that the module asks for is in the stable ABI of 3.10: abi3audit looks at all."""
    (wheel,) = (python.parents[2] / "dist").glob("truecut-*.whl")
    audit = [sys.executable, "-m", "abi3audit", "--strict", "--report", wheel]
    ended = subprocess.run(audit, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    [(_, told)] = json.loads(ended.stdout)["specs"].items()
    libraries = told["wheel"]
    assert libraries, told
    for library in libraries:
        result = library["result"]
        assert result["is_abi3"] and result["is_abi3_baseline_compatible"] and result["baseline"] == "3.10", result
        assert not result["non_abi3_symbols"] and not result["future_abi3_objects"], result


def test_errors_have_their_place(python, tmp_path):
    bad = tmp_path / "bad.toml"
    text = (ROOT / CHAMFER).read_text().replace("../../assets", str(ROOT / "assets"))
    lines = text.splitlines()
    line = next(k for k, one in enumerate(lines) if one.startswith("depth_mm"))
    lines[line] = "depth_mm = -3.0"
    bad.write_text("\n".join(lines))
    script = f"""
import json, truecut
told = []
for make in (
    lambda: truecut.load({str(bad)!r}),
    lambda: truecut.load("missing.toml"),
    lambda: truecut.load("{CHAMFER}").run({{"process.chamfer.depth": 1}}),
    lambda: truecut.Robot("assets/robots/none.urdf"),
    lambda: truecut.load("{CHAMFER}").compare(),
    lambda: truecut.load("{CHAMFER}").sweep(),
):
    try:
        make()
    except truecut.TruecutError as error:
        told.append([error.file, error.line, error.key, str(error)])
for make, kind in (
    (lambda: truecut.load("{CHAMFER}").run({{"process.chamfer.depth_mm": object()}}), TypeError),
    (lambda: truecut.load("{CHAMFER}").run({{3: 1}}), TypeError),
    (lambda: truecut.load("{CHAMFER}").run(engine="mujoco"), ValueError),
    (lambda: truecut.load(3), TypeError),
    (lambda: truecut.Robot("assets/robots/arm_2r/robot.urdf").jacobian([1.0]), ValueError),
    (lambda: truecut.Robot("assets/robots/arm_2r/robot.urdf").jacobian([1.0, float("nan")]), ValueError),
    (lambda: truecut.Robot("assets/robots/arm_2r/robot.urdf").inverse([[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), ValueError),
    (lambda: truecut.Robot("assets/robots/arm_2r/robot.urdf").forward(frame="wrist"), ValueError),
):
    try:
        make()
    except kind as error:
        assert str(error)
    else:
        raise AssertionError(kind)
print(json.dumps(told))
"""
    told = json.loads(run(python, script))
    assert len(told) == 6, told
    file, number, key, message = told[0]
    assert (file, number, key) == (str(bad), line + 1, "process.chamfer.depth_mm")
    assert f"bad.toml:{line + 1}: " in message and "-3" in message
    assert "missing.toml" in told[1][3]
    assert told[2][2] == "process.chamfer.depth" and "depth_mm" in told[2][3]
    assert "none.urdf" in told[3][3]
    assert "[data]" in told[4][3] and "[sweep]" in told[5][3]


def test_ctrl_c_and_progress_stop_a_run(python, tmp_path):
    script = f"""
import truecut
scenario = truecut.load("{CHAMFER}", {{"process.chamfer.dwell_revolutions": 2000}})
def stop(part):
    if part > 0:
        raise LookupError(part)
try:
    scenario.run(progress=stop)
except LookupError:
    print("stopped", flush=True)
parts = [0.0]
try:
    scenario.run(progress=parts.append)
except KeyboardInterrupt:
    print("interrupted", parts[-1] < 0.9, flush=True)
"""
    # what is started in the background inherits that it does not listen to the signal
    listening = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    process = subprocess.Popen(
        [python, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True, preexec_fn=listening
    )
    assert process.stdout.readline() == "stopped\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    # long before its end
    assert process.communicate(timeout=60)[0] == "interrupted True\n"
    assert process.returncode == 0


def test_threads_run_side_by_side(python):
    """The lock is free while a run goes on: another thread counts meanwhile."""
    script = f"""
import threading, time, truecut
scenario = truecut.load("{CHAMFER}")
counted, done = 0, False
def count():
    global counted
    while not done:
        counted += 1
        time.sleep(0.001)
thread = threading.Thread(target=count)
thread.start()
before = counted
scenario.run()
during = counted - before
done = True
thread.join()
# while the lock is held none but the one that waits for it
assert during > 5, during
"""
    run(python, script)


def test_nothing_is_left_behind(with_arrays):
    """Memory after many runs is that after a few."""
    script = """
import gc, resource, truecut, pyarrow
def used_kb():
    return int(next(line for line in open("/proc/self/status") if line.startswith("VmRSS")).split()[1])
scenario = truecut.load("scenarios/arm/static_load.toml")
def some(runs):
    for _ in range(runs):
        recording = scenario.run(engine="reduced")
        pyarrow.table(recording)["time"].to_numpy()
        recording["tool.displacement_y"]
        try:
            scenario.run({"run.duration_s": -1})
        except truecut.TruecutError:
            pass
    gc.collect()
    return used_kb()
first = some(20)
later = some(100)
print(first, later)
assert later < 1.1 * first + 4000, (first, later)
"""
    run(with_arrays, script)


def test_its_bench_runs(python):
    bench = [sys.executable, ROOT / "benches" / "wheel.py", "--short", "--python", python]
    ended = subprocess.run(bench, cwd=ROOT, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    told = ended.stdout.splitlines()
    assert told[0].startswith("import: ") and "processor time" in told[1] and len(told) == 8, told


@pytest.mark.parametrize("seed", range(3))
def test_a_robot_agrees_with_itself(seed, with_arrays):
    """At postures drawn at random: inverse kinematics find the pose of forward kinematics again, the Jacobian is its
    difference quotient, stiffness the inverse of compliance, masses are positive."""
    script = f"""
import numpy as np, truecut
draw = np.random.default_rng({seed})
arm = truecut.Robot("assets/robots/irb6600_175_255/robot.urdf")
found = 0
for _ in range(10):
    posture = np.array(arm.default_posture) + draw.uniform(-0.5, 0.5, len(arm.joints))
    frame = draw.choice(["flange", "tool"])
    pose = arm.forward(posture, frame)
    postures = arm.inverse(pose, frame)
    found += any(np.allclose(one, posture, atol=1e-6) for one in postures)
    assert all(np.allclose(arm.forward(one, frame), pose, atol=1e-8) for one in postures)
    for joint, column in enumerate(arm.jacobian(posture, frame).T):
        step = np.zeros(len(posture))
        step[joint] = 1e-6
        there, back = arm.forward(posture + step, frame), arm.forward(posture - step, frame)
        change = (there - back) / 2e-6
        turning = change[:3, :3] @ pose[:3, :3].T
        spin = [turning[2, 1], turning[0, 2], turning[1, 0]]
        assert np.allclose(column, [*change[:3, 3], *spin], atol=1e-6)
    assert np.allclose(arm.compliance(posture) @ arm.stiffness(posture), np.eye(6), atol=1e-6)
    assert np.linalg.eigvalsh(arm.mass(posture)).min() > 0
    modes = arm.modes(posture)
    assert np.allclose(modes["shapes"].T @ arm.mass(posture) @ modes["shapes"], np.eye(6), atol=1e-6)
assert found == 10, found
"""
    run(with_arrays, script)


def test_stubs_are_those_of_the_module(python):
    """Every public name and method of the module is in the stubs, and the other way round."""
    import ast

    tree = ast.parse((ROOT / "crates/python/python/truecut/__init__.pyi").read_text())
    said = {
        node.name: {one.name for one in node.body if isinstance(one, ast.FunctionDef)} - {"__init__"}
        for node in tree.body
        if isinstance(node, ast.ClassDef) and node.name != "TruecutError"
    }
    script = """
import json, truecut
plain = dir(object) + ["__module__"]
print(json.dumps({name: [one for one in vars(getattr(truecut, name)) if one not in plain] for name in truecut.__all__ if isinstance(getattr(truecut, name), type) and name != "TruecutError"}))
"""
    found = {name: set(names) - {"__new__"} for name, names in json.loads(run(python, script)).items()}
    assert found == said


def test_lobes_are_those_of_the_program(with_arrays, tmp_path):
    """The same numbers as in `lobes.json`, which the program writes; what is asked for wrongly is refused."""
    scenario = "scenarios/milling/own_surface.toml"
    command = [PROGRAM, "lobes", scenario, "--size", "12", "--runs", "0", "--out", tmp_path]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (file,) = tmp_path.rglob("lobes.json")
    script = f"""
import json, math, truecut, numpy as np
told = json.load(open({str(file)!r}))
milling = truecut.load("{scenario}")
parts = []
found = truecut.lobes(milling, size=12, progress=parts.append)
assert parts[-1] == 1.0
assert found["multiplier"].shape == (12, 12) == (len(found["spindle_rad_s"]), len(found["depth_m"]))
assert np.array_equal(found["spindle_rad_s"], [one["spindle_rad_s"] for one in told["speeds"]])
assert found["depth_m"][-1] == told["deepest_m"]
depth = lambda limit: math.nan if limit is None else limit["depth_m"]
for ours, theirs in (("limit_m", "limit"), ("zero_order_m", "zero_order")):
    assert np.array_equal(found[ours], [depth(one[theirs]) for one in told["speeds"]], equal_nan=True), ours
assert np.isfinite(found["limit_m"]).sum() >= 3, found["limit_m"]
# first depths at which a multiplier is one or more
for row, limit in zip(found["multiplier"], found["limit_m"]):
    unstable = found["depth_m"][row >= 1]
    if len(unstable):
        step = found["depth_m"][1] - found["depth_m"][0]
        assert unstable[0] - step <= limit <= unstable[0] * (1 + 1e-9), (unstable[0], limit)
low, high = found["spindle_rad_s"][[3, 8]]
narrow = truecut.lobes(milling, (low, high), found["depth_m"][-1], size=12)
assert np.allclose(narrow["limit_m"][[0, -1]], found["limit_m"][[3, 8]], rtol=1e-3, equal_nan=True)
for wrong in ({{"size": 1}}, {{"spindle_rad_s": (5.0, 2.0)}}, {{"deepest_m": 0.0}}, {{"at_m": -1.0}}):
    try:
        truecut.lobes(milling, **wrong)
    except ValueError as error:
        assert next(iter(wrong)) in str(error)
    else:
        raise AssertionError(wrong)
for scenario, wrong, said in ((milling, {{"at_m": 1e3}}, "length"), (truecut.load("{CHAMFER}"), {{}}, "milling")):
    try:
        truecut.lobes(scenario, **wrong)
    except truecut.TruecutError as error:
        assert said in str(error), error
    else:
        raise AssertionError(wrong)
"""
    run(with_arrays, script)
