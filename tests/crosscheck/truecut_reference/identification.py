"""Measurements of an arm, made in MuJoCo: load against deflection, and hammer blows.

Nothing of truecut but the exported model takes part. Static rest is found on MuJoCo's own forces; a hammer blow is a
half sine on a running simulation, observed by an accelerometer and filtered as a data logger would.
"""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from scipy.signal import firwin

AXES = "xyz"


class MeasuredArm:
    """An arm of hinges on springs, with stiffnesses and dampings other than those of its file."""

    def __init__(self, mjcf: str, stiffness_factor: np.ndarray, damping_factor: np.ndarray | float = 1.0) -> None:
        self.model = mujoco.MjModel.from_xml_string(mjcf)
        self.model.jnt_stiffness *= stiffness_factor
        self.model.dof_damping *= damping_factor
        self.data = mujoco.MjData(self.model)
        self.tool = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, "tool")
        self.body = self.model.site_bodyid[self.tool]

    def hold(self, command: np.ndarray) -> None:
        """Motors stand at `command`."""
        self.model.qpos_spring[:] = command
        self.data.qpos[:] = command
        self.data.qvel[:] = 0.0

    def _force(self, force_n: np.ndarray) -> None:
        self.data.qfrc_applied[:] = 0.0
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        at = self.data.site_xpos[self.tool]
        mujoco.mj_applyFT(self.model, self.data, force_n, np.zeros(3), at, self.body, self.data.qfrc_applied)

    def _out_of_balance(self, q: np.ndarray, force_n: np.ndarray) -> np.ndarray:
        self.data.qpos[:] = q
        self.data.qvel[:] = 0.0
        self._force(force_n)
        mujoco.mj_forward(self.model, self.data)
        return self.data.qfrc_passive - self.data.qfrc_bias + self.data.qfrc_applied

    def rest(self, command: np.ndarray, force_n: np.ndarray) -> np.ndarray:
        """Where the tool comes to rest, world, m."""
        self.hold(command)
        q = np.array(command, dtype=float)
        for _ in range(30):
            torque = self._out_of_balance(q, force_n)
            slope = np.empty((q.size, q.size))
            for k in range(q.size):
                step = np.zeros(q.size)
                step[k] = 1e-6
                ahead, behind = self._out_of_balance(q + step, force_n), self._out_of_balance(q - step, force_n)
                slope[:, k] = (ahead - behind) / 2e-6
            q = q - np.linalg.solve(slope, torque)
            if np.abs(torque).max() < 1e-6:
                break
        else:
            raise RuntimeError("the arm finds no rest")
        self._out_of_balance(q, force_n)
        return np.array(self.data.site_xpos[self.tool]), q

    def load_table(self, commands: np.ndarray, forces_n: np.ndarray, noise_m: float, seed: int) -> np.ndarray:
        """Rows of command (deg), force (N) and displacement (mm), each posture under each force."""
        random = np.random.default_rng(seed)
        rows = []
        for command in commands:
            free, _ = self.rest(command, np.zeros(3))
            for force_n in forces_n:
                loaded, _ = self.rest(command, force_n)
                moved = loaded - free + noise_m * random.standard_normal(3)
                rows.append([*np.degrees(command), *force_n, *(1e3 * moved)])
        return np.array(rows)

    def blows(self, command: np.ndarray, axis: int, plan: dict) -> np.ndarray:
        """Samples of hammer force (N) and tool acceleration (m/s², x y z): blows along a world axis, on one record."""
        step_s = 1.0 / (plan["rate_hz"] * plan["oversampling"])
        self.model.opt.timestep = step_s
        self.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
        _, q = self.rest(command, np.zeros(3))
        self.data.qpos[:], self.data.qvel[:] = q, 0.0
        steps = int(round(plan["blows"] * plan["interval_s"] / step_s))
        record = np.zeros((steps, 4))
        direction = np.eye(3)[axis]
        before = np.zeros(3)
        jacobian = np.zeros((3, self.model.nv))
        for i in range(steps):
            since = i * step_s % plan["interval_s"] - plan["first_s"]
            inside = 0.0 <= since <= plan["contact_s"]
            force = plan["peak_n"] * np.sin(np.pi * since / plan["contact_s"]) if inside else 0.0
            self._force(force * direction)
            mujoco.mj_step(self.model, self.data)
            mujoco.mj_kinematics(self.model, self.data)
            mujoco.mj_comPos(self.model, self.data)
            mujoco.mj_jacSite(self.model, self.data, jacobian, None, self.tool)
            velocity = jacobian @ self.data.qvel
            record[i] = [force, *((velocity - before) / step_s)]
            before = velocity
        # the same filter on all signals: what it does cancels in their ratio
        taps = firwin(8 * plan["oversampling"] + 1, 0.9 / plan["oversampling"])
        filtered = np.stack([np.convolve(column, taps, mode="same") for column in record.T], axis=1)
        sampled = filtered[:: plan["oversampling"]]
        random = np.random.default_rng(plan["seed"] + axis)
        return sampled + random.standard_normal(sampled.shape) * np.array(plan["noise"])


def write_table(path: Path, names: list[str], rows: np.ndarray, decimals: list[int]) -> None:
    """A CSV file with so many places after the point in each column."""
    lines = [",".join(names)]
    lines += [",".join(f"{value:.{places}f}" for value, places in zip(row, decimals)) for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
