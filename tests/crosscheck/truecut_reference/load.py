"""Forces given in advance at the tool: constant, released at t = 0, swept in frequency, rotating."""

from __future__ import annotations

import math

import numpy as np

from .scenario import Load


class LoadProcess:
    """Time-known forces; the step may be chosen freely."""

    channels: tuple[str, ...] = ()

    def __init__(self, spec: Load, duration_s: float, longest_step_s: float, axes: np.ndarray) -> None:
        self.spec = spec
        self.foot = spec.foot
        self.step_s = duration_s / math.ceil(duration_s / longest_step_s - 1e-9)
        # rows of `axes` are the process axes in the world
        turn = axes if spec.frame == "world" else np.eye(3)
        self.constant = tuple(turn @ spec.constant_n)
        self.release = turn @ spec.release_n
        self.sweep = tuple(turn @ spec.sweep_amplitude_n)
        self.sweeps = any(self.sweep)
        self.duration_s = duration_s
        self.row: tuple[float, ...] = ()

    def start_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """Before the run: the force to be released, and the foot's preload."""
        preload = self.foot.preload_n if self.foot else 0.0
        return np.array(self.release), np.array([-preload, 0.0, 0.0])

    def tool_force(self, t: float, _x, _v) -> tuple[float, float, float]:
        """Force on the tool (N, process frame) at time t."""
        s = self.spec
        fx, fy, fz = self.constant
        if self.sweeps:
            rate = (s.sweep_to_hz - s.sweep_from_hz) / self.duration_s
            wave = math.sin(2.0 * math.pi * (s.sweep_from_hz + 0.5 * rate * t) * t)
            fx += self.sweep[0] * wave
            fy += self.sweep[1] * wave
            fz += self.sweep[2] * wave
        if s.rotating_amplitude_n:
            angle = s.rotating_start_angle_rad + 2.0 * math.pi * s.rotating_frequency_hz * t
            fy += s.rotating_amplitude_n * math.cos(angle)
            fz += s.rotating_amplitude_n * math.sin(angle)
        return fx, fy, fz

    def findings(self) -> tuple[dict, dict]:
        """Nothing is left on a workpiece."""
        return {}, {}

    def joint_torque(self, _t: float):
        """The command stands still."""
        return
