"""Least squares on the drive forces of a whole arm: links, rotors, friction, a motor that turns with two joints.

Regressors are Pinocchio's, filters SciPy's, the rank rule is a singular value decomposition. Rows in which a joint
stands are left out; each joint is weighted by what the fit leaves of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio
from scipy.signal import butter, sosfiltfilt

ORDER = 4


def low_pass(values: np.ndarray, cutoff_hz: float, rate_hz: float) -> np.ndarray:
    """Forward and backward, no delay."""
    return sosfiltfilt(butter(ORDER, cutoff_hz, fs=rate_hz, output="sos"), values, axis=0)


class Motion(NamedTuple):
    """Smoothed motion and its derivatives, one row a sample."""

    rate_hz: float
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray

    @staticmethod
    def of(q: np.ndarray, rate_hz: float, cutoff_hz: float) -> Motion:
        smooth = low_pass(q, cutoff_hz, rate_hz)
        v = np.gradient(smooth, 1 / rate_hz, axis=0)
        return Motion(rate_hz, smooth, v, np.gradient(v, 1 / rate_hz, axis=0))

    def every(self, step: int) -> Motion:
        return Motion(self.rate_hz / step, self.q[::step], self.v[::step], self.a[::step])


def inertial(model: pinocchio.Model, motion: Motion) -> np.ndarray:
    """Columns of the ten parameters of every link; `[sample, joint, parameter]`."""
    data = model.createData()
    states = zip(motion.q, motion.v, motion.a, strict=True)
    return np.array([pinocchio.computeJointTorqueRegressor(model, data, *state) for state in states])


def of_joints(columns: list[np.ndarray]) -> np.ndarray:
    """Columns that each act on their own joint."""
    joints = len(columns)
    wide = np.zeros((len(columns[0]), joints, joints))
    for joint, column in enumerate(columns):
        wide[:, joint, joint] = column
    return wide


def coupled(motion: Motion, pair: tuple[int, int]) -> np.ndarray:
    """Inertia, viscous and dry friction of a motor that turns with the sum of two joints. What it does to each of
    them by its own motion is left to that joint's own rotor and friction."""
    one, other = pair
    wide = np.zeros((*motion.v.shape, 3))
    for here, there in ((one, other), (other, one)):
        wide[:, here, 0] = motion.a[:, there]
        wide[:, here, 1] = motion.v[:, there]
        wide[:, here, 2] = np.sign(motion.v[:, one] + motion.v[:, other])
    return wide


class Problem(NamedTuple):
    """Filtered and thinned to twice the cutoff."""

    columns: np.ndarray
    torque: np.ndarray
    moves: np.ndarray

    @staticmethod
    def of(columns: np.ndarray, torque: np.ndarray, motion: Motion, cutoff_hz: float, standstill: float) -> Problem:
        rate = motion.rate_hz
        edge, step = int(rate / cutoff_hz), max(1, int(rate / (2 * cutoff_hz)))
        kept = slice(edge, -edge, step)
        filtered = low_pass(columns, cutoff_hz, rate)[kept], low_pass(torque, cutoff_hz, rate)[kept]
        return Problem(*filtered, np.abs(motion.v[kept]) > standstill)

    def solve(self, weights: np.ndarray, rows: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Least squares; singular values below a part in ten thousand of the largest do not count."""
        moves = self.moves[rows].reshape(-1)
        count = self.columns.shape[2]
        matrix = (self.columns[rows] * weights[None, :, None]).reshape(-1, count)[moves]
        target = (self.torque[rows] * weights).reshape(-1)[moves]
        scale = np.linalg.norm(matrix, axis=0)
        scale[scale == 0] = 1
        found, *_ = np.linalg.lstsq(matrix / scale, target, rcond=1e-4)
        return found / scale

    def rms(self, left: np.ndarray) -> np.ndarray:
        """Of the rows of each joint in which it moves."""
        return np.sqrt((left**2 * self.moves).sum(0) / self.moves.sum(0))

    def weights(self) -> np.ndarray:
        weights = np.ones(self.torque.shape[1])
        for _ in range(5):
            weights = 1 / self.rms(self.torque - self.columns @ self.solve(weights))
        return weights

    def held_out(self, blocks: int) -> np.ndarray:
        """Each block's residual by a fit to the others."""
        weights = self.weights()
        block = np.arange(len(self.torque)) * blocks // len(self.torque)
        left = np.empty_like(self.torque)
        for one in range(blocks):
            found = self.solve(weights, block != one)
            left[block == one] = self.torque[block == one] - self.columns[block == one] @ found
        return left
