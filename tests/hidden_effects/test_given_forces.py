"""Arms drawn from seeds that are drawn aside and let go, or shaken by a swept sine, by some millimetres: MuJoCo moves
them. Nothing is a cause where nothing was hidden, and a joint that is stiffer, or a payload, is named."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT  # noqa: E402, F401
from bench.noise import unit_noise  # noqa: E402
from test_delays import _urdf, named  # noqa: E402
from test_hidden_effects import PROGRAM  # noqa: E402
from truecut_reference import scenario as scenario_file  # noqa: E402
from truecut_reference.compare import Recording  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402
from truecut_reference.simulate import simulate  # noqa: E402

RATE_HZ, DURATION_S, STEP_S = 500.0, 3.0, 0.2e-3
NOISE_M = 1e-6
CLEAN_SEEDS, HIDDEN_SEEDS = some(range(64_000, 64_020), 5), some(range(64_100, 64_108), 3)


class Shaken:
    """A chain of two to four revolute joints on springs, with a force at its tool."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.seed, self.folder = seed, folder
        draw = np.random.default_rng([seed, 7])
        self.joints = int(draw.integers(2, 5))
        folder.mkdir(parents=True)
        urdf = _urdf(draw, self.joints)
        (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
        self.posture = draw.uniform(-1, 1, self.joints)
        model = mujoco.MjModel.from_xml_string(urdf)
        data, mass = mujoco.MjData(model), np.zeros((self.joints, self.joints))
        data.qpos[:] = self.posture
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        rate = 2 * np.pi * draw.uniform(8, 25, self.joints)
        text = 'name = "drawn"\n[frames.tool]\nxyz_m = [0.05, 0.0, 0.2]\nrpy_deg = [0.0, 0.0, 0.0]\n'
        for j, inertia in enumerate(np.diag(mass)):
            text += (
                f'[[joint]]\nname = "joint_{j + 1}"\nstiffness_nm_per_rad = {inertia * rate[j] ** 2}\n'
                f"damping_nm_s_per_rad = {0.06 * inertia * rate[j]}\ndry_friction_nm = 0.0\nrotor_inertia_kg_m2 = 0.0\n"
                "[joint.source]\n"
                + "".join(f'{what} = "drawn"\n' for what in ("stiffness", "damping", "dry_friction", "rotor_inertia"))
            )
        (folder / "robot.toml").write_text(text, encoding="utf-8")
        self.direction = draw.normal(size=3)
        self.direction /= np.linalg.norm(self.direction)
        self.is_released = bool(draw.integers(0, 2))
        self.swing_m = float(draw.uniform(1e-3, 5e-3))
        self.number = int(draw.integers(1, self.joints + 1))
        self.factor = float(draw.choice([0.9, 1.1]))
        self.force_n = 1.0

    def text(self, hidden: bool) -> str:
        """The scenario without its data."""
        force = (self.force_n * self.direction).tolist()
        sweep = f"[process.load.sweep]\namplitude_n = {force}\nfrom_hz = 1\nto_hz = 30\n"
        joint = f'[[robot.joint]]\nname = "joint_{self.number}"\nstiffness_factor = {self.factor}\n'
        return (
            'name = "drawn"\n[robot]\nurdf = "robot.urdf"\n'
            f'posture_deg = {np.degrees(self.posture).tolist()}\nhold_against_sag = false\n'
            f"{joint if hidden else ''}[run]\nduration_s = {DURATION_S}\n[process.load]\n"
            f"{f'release_n = {force}' if self.is_released else sweep}\n"
        )

    def moved(self, hidden: bool, step_s: float) -> tuple[np.ndarray, np.ndarray]:
        """Times and displacements of the tool."""
        truth, model = self.folder / "truth.toml", self.folder / "truth.xml"
        truth.write_text(self.text(hidden), encoding="utf-8")
        subprocess.run([PROGRAM, "export-mjcf", truth, "-o", model], check=True, capture_output=True)
        found = simulate(scenario_file.load(truth, {}), model.read_text(encoding="utf-8"), step_s)
        return found.state_time_s, np.stack([found.channels[f"tool.displacement_{axis}"] for axis in "xyz"], axis=1)

    def measured(self, hidden: bool) -> tuple[Path, dict[str, np.ndarray]]:
        """The scenario, which knows nothing of what is hidden, and the columns of its data."""
        _, probe = self.moved(hidden, 1e-3)
        swing = np.linalg.norm(probe - (probe[-1] if self.is_released else 0.0), axis=1).max()
        self.force_n *= self.swing_m / swing
        time_s, moved = self.moved(hidden, STEP_S)
        time = np.arange(round((DURATION_S - 0.01) * RATE_HZ)) / RATE_HZ
        noise = unit_noise(("white", "ar1")[self.seed % 2], time.size, 3, RATE_HZ, 30.0, self.seed)
        values = CubicSpline(time_s, moved)(time) + NOISE_M * noise
        text = self.text(False) + '[data]\nfile = "data.csv"\ntime = "t"\n'
        for axis in "xyz":
            text += f'[[data.channel]]\ncolumn = "{axis}"\nchannel = "tool.displacement_{axis}"\nunit = "m"\n'
        path = self.folder / "shaken.toml"
        path.write_text(text, encoding="utf-8")
        return path, {"t": time} | {axis: values[:, i] for i, axis in enumerate("xyz")}


@pytest.mark.parametrize("seed", CLEAN_SEEDS)
def test_crosscheck_mujoco_given_forces_without_cause(seed, tmp_path):
    """What an arm of first order leaves out of a swing is no cause."""
    found = named(*Shaken(seed, tmp_path / str(seed)).measured(hidden=False))
    assert found["verdict"] == "nothing_beyond_noise", (found["reason"], found["causes"])


@pytest.mark.parametrize("seed", HIDDEN_SEEDS)
def test_crosscheck_mujoco_stiffness_under_given_forces(seed, tmp_path):
    """A tenth of one joint's stiffness is named, alone, and held-out errors are those of the scenario written."""
    shaken = Shaken(seed, tmp_path / str(seed))
    scenario, columns = shaken.measured(hidden=True)
    found = named(scenario, columns)
    assert [(one["kind"], one["target"]) for one in found["causes"]] == [("joint_stiffness", f"joint{shaken.number}")]
    (parameter,) = found["causes"][0]["parameters"].values()
    assert abs(parameter["value"] - shaken.factor) < 0.002, parameter
    answer = scenario.parent / "answer" / scenario.stem / "extended.toml"
    subprocess.run([PROGRAM, "run", answer, "--out", tmp_path, "--no-rrd"], check=True, capture_output=True)
    run = Recording.read(tmp_path / "extended" / "recording.parquet")
    last = columns["t"] > 0.8 * columns["t"][-1]
    for axis in "xyz":
        name = f"tool.displacement_{axis}"
        moved = CubicSpline(run.time_s, run.channels[name])(columns["t"])
        error = np.sqrt(np.mean((columns[axis] - moved)[last] ** 2))
        assert 0.9 < found["channels"][name]["after"] / error < 1.1, (name, error, found["channels"][name])
