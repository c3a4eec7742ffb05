"""Wall time per simulated second of the forced arm: truecut against MuJoCo driven from Python.

Both simulate the same arm (the exported MJCF) under a step of 1 kN for two seconds, each at the largest of
a list of steps whose tool error stays below 0.1 %. MuJoCo is driven as a machining law needs it: the force
is applied anew in every step. Both are timed in this one run, so that the ratio does not depend on the
machine's mood.

    python benches/versus_mujoco.py            (after: cargo build --release)
    python benches/versus_mujoco.py --short    (three steps, timed once: whether it runs, not how fast)
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = ROOT / "scenarios/arm/static_load.toml"
SIMULATED_S = 2.0
SAMPLE_S = 0.01
SHORT = "--short" in sys.argv
STEPS_MS = [0.25, 1.0, 5.0] if SHORT else [0.025, 0.05, 0.1, 0.125, 0.2, 0.25, 0.5, 0.625, 1.0, 1.25, 2.0, 2.5, 5.0]
LIMIT = 1e-3
REPEATS = 1 if SHORT else 5


def load_model():
    binary = ROOT / "target/release/truecut"
    with tempfile.TemporaryDirectory() as folder:
        mjcf = Path(folder) / "arm.xml"
        subprocess.run([binary, "export-mjcf", SCENARIO, "-o", mjcf], check=True, capture_output=True)
        return mujoco.MjModel.from_xml_path(str(mjcf))


def simulate(model, integrator, step_ms):
    """Tool positions every 10 ms, and the wall time of the loop alone."""
    model.opt.integrator = integrator
    model.opt.timestep = step_ms * 1e-3
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    site = model.site("tool").id
    body = model.site_bodyid[site]
    # The process X axis, along which the scenario pushes, is the tool's z axis at the start.
    force = 1000.0 * data.site_xmat[site].reshape(3, 3)[:, 2]
    none = np.zeros(3)
    every = round(SAMPLE_S / model.opt.timestep)
    count = round(SIMULATED_S / model.opt.timestep)
    positions = [data.site_xpos[site].copy()]
    start = time.perf_counter()
    for i in range(1, count + 1):
        data.qfrc_applied[:] = 0.0
        mujoco.mj_applyFT(model, data, force, none, data.site_xpos[site], body, data.qfrc_applied)
        mujoco.mj_step(model, data)
        if i % every == 0:
            mujoco.mj_kinematics(model, data)
            positions.append(data.site_xpos[site].copy())
    wall = time.perf_counter() - start
    return np.array(positions) - positions[0], wall


def error(reference, other):
    n = min(len(reference), len(other))
    square = np.sum((reference[:n] - other[:n]) ** 2, axis=1)
    return float(np.sqrt(square.mean() / np.max(np.sum(reference**2, axis=1))))


def largest_good(rows):
    good = [row for row in rows if row["error"] <= LIMIT]
    return max(good, key=lambda row: row["step_ms"])


def mujoco_rows(model, integrator, reference):
    rows = []
    for step in STEPS_MS:
        if round(SAMPLE_S / (step * 1e-3)) * step * 1e-3 - SAMPLE_S > 1e-9:
            continue
        positions, _ = simulate(model, integrator, step)
        rows.append({"step_ms": step, "error": error(reference, positions)})
    best = largest_good(rows)
    walls = [simulate(model, integrator, best["step_ms"])[1] for _ in range(REPEATS)]
    best["wall_s_per_s"] = min(walls) / SIMULATED_S
    return best


def truecut_best():
    # of the whole workspace: of one package alone the libraries have fewer features, and all are built once more
    command = ["cargo", "bench", "-q", "--profile", "release", "--workspace", "--bench", "forced_arm"]
    command += ["--", "--test"] if SHORT else []
    output = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return largest_good(json.loads(output.strip().splitlines()[-1]))


def main():
    ours = truecut_best()
    model = load_model()
    kinds = mujoco.mjtIntegrator
    reference, _ = simulate(model, kinds.mjINT_RK4, 0.02)
    print(f"{'':24}{'step ms':>9}{'error %':>10}{'ms per s':>10}{'truecut/this':>14}")
    print(row("truecut", ours, ours))
    for name, kind in [
        ("MuJoCo RK4", kinds.mjINT_RK4),
        ("MuJoCo Euler", kinds.mjINT_EULER),
        ("MuJoCo implicitfast", kinds.mjINT_IMPLICITFAST),
    ]:
        print(row(name, mujoco_rows(model, kind, reference), ours))


def row(name, best, ours):
    ratio = ours["wall_s_per_s"] / best["wall_s_per_s"]
    return (
        f"{name:24}{best['step_ms']:9.3f}{best['error'] * 100:10.4f}"
        f"{best['wall_s_per_s'] * 1e3:10.2f}{ratio:14.2f}"
    )


if __name__ == "__main__":
    main()
