"""Joints of a replay that no column commands: where they begin is measured, with noise, and sags from their motors.
Arms are drawn from seeds and move in MuJoCo."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench.effects import Effect  # noqa: E402
from bench.noise import unit_noise  # noqa: E402
from test_delays import DURATION_S, RATE_HZ, Drawn, named  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402

SEEDS = some(range(63_000, 63_004), 1)
# of an encoder on the link, and of a torque sensor over what it measures
ANGLE_NOISE_RAD, NOISE = 2e-5, 0.01


class Held(Drawn):
    """One joint is held by its motor, somewhere; its angle is measured."""

    def __init__(self, seed: int, folder: Path) -> None:
        super().__init__(seed, folder)
        self.held = self.number
        self.command[:, self.held - 1] = self.command[0, self.held - 1]

    def scenario(self, given: bool) -> Path:
        """The scenario; `given`: it says where the motors stand."""
        columns = [(f"c{j}", f"joint{j}.command", "rad", True) for j in range(1, self.joints + 1) if j != self.held]
        columns += [(f"f{j}", f"joint{j}.transmission_torque", "N m", False) for j in range(1, self.joints + 1)]
        columns.append(("q", f"joint{self.held}.angle", "rad", False))
        posture = f"posture_deg = {np.degrees(self.command[0]).tolist()}\n" if given else ""
        robot = f'{posture}drive = "position"\nhold_against_sag = false\n'
        return self._scenario(robot, 'mode = "forward"\n', columns)

    def data(self, effects: list[Effect]) -> dict[str, np.ndarray]:
        """Columns of the data file."""
        self.forward()
        time_s, channels = self.channels(effects)
        names = [f"joint{j}.transmission_torque" for j in range(1, self.joints + 1)] + [f"joint{self.held}.angle"]
        clean = np.stack([np.interp(self.time, time_s, channels[name]) for name in names], axis=1)
        level = NOISE * clean.std(axis=0)
        level[-1] = ANGLE_NOISE_RAD
        noisy = clean + level * unit_noise(("white", "ar1")[self.seed % 2], *clean.shape, RATE_HZ, 30.0, self.seed)
        columns = {"t": self.time}
        columns |= {f"c{j + 1}": self.command[:, j] for j in range(self.joints) if j + 1 != self.held}
        columns |= {f"f{j + 1}": noisy[:, j] for j in range(self.joints)}
        return columns | {"q": noisy[:, -1]}


@pytest.mark.parametrize("given", [False, True], ids=["measured", "given"])
@pytest.mark.parametrize("hidden", ["nothing", "friction"])
def test_crosscheck_mujoco_start_of_a_joint_that_nothing_commands(hidden, given, tmp_path):
    """Neither one sample's noise nor the sag is a cause; friction of another joint is."""
    for seed in SEEDS:
        held = Held(seed, tmp_path / str(seed))
        other = held.held % held.joints + 1
        speed = np.std(np.gradient(held.command[:, other - 1], 1.0 / RATE_HZ))
        assert DURATION_S * speed > 0.1
        effects, viscous = [], 0.0
        if hidden == "friction":
            torque = held.data([])[f"f{other}"]
            viscous = float(0.05 * np.std(torque) / speed)
            effects = [Effect("joint_viscous", other, {"viscous_n_m_s_per_rad": viscous})]
        data = held.data(effects)
        found = named(held.scenario(given), data)
        causes = [(one["kind"], one["target"]) for one in found["causes"]]
        if hidden == "nothing":
            assert found["verdict"] == "nothing_beyond_noise", (seed, causes, found["reason"])
            continue
        assert (found["verdict"], causes) == ("named", [("joint_viscous", f"joint{other}")]), (seed, found["reason"])
        (parameter,) = found["causes"][0]["parameters"].values()
        room = max(0.05 * viscous, 1.5 * 0.5 * (parameter["high"] - parameter["low"]))
        assert abs(parameter["value"] - viscous) < room, (seed, parameter, viscous)
