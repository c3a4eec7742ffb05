"""The oracle of the bench: whether it says of two explanations what their likelihoods say."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench.cases import Case  # noqa: E402
from bench.dataset import noise_scale  # noqa: E402
from bench.effects import Effect  # noqa: E402
from bench.experiment import ALL  # noqa: E402
from bench.noise import COLOURS, density, unit_noise  # noqa: E402
from bench.oracle import Oracle  # noqa: E402

AXIS = ALL["axis"]
SET = Case(
    "single middle",
    "axis",
    (Effect("joint_viscous", 1, {"viscous_n_m_s_per_rad": 20.0}),),
    "named",
    (0.4,) * len(AXIS.uncertain),
    "white",
    seed=5,
    level=2.0,
)


@pytest.mark.parametrize("colour", COLOURS)
def test_verify_density_is_that_of_the_noise(colour):
    """Mean power of 300 drawn series over the density, bin by bin: 1 within what chance leaves."""
    count, rate, band = 1000, 250.0, 30.0
    hz = np.fft.rfftfreq(count, 1.0 / rate)
    drawn = [np.fft.rfft(unit_noise(colour, count, 4, rate, band, seed), axis=0) for seed in range(300)]
    power = np.mean(np.abs(drawn) ** 2, axis=(0, 2)) / count
    ratio = (power / density(colour, hz, rate, band))[1:-1]
    # each is a mean of 1200 squares of complex numbers: a deviation of 3 %. Every series is scaled to its own level in
    # band, which in 1/f noise is that of a few bins: the mean of its inverse square lies higher by some per cent
    assert abs(ratio.mean() - 1.0) < (0.06 if colour == "one_over_f" else 0.02)
    assert np.abs(ratio - 1.0).max() < 0.15


def test_verify_evidence_of_white_noise():
    """Of nothing against the truth, seen in the mean of 60 noises: the truth's trace squared over the noise's density,
    less what refitted nominal numbers take, and the truth's own freedom."""
    (effect,) = SET.truth
    trace = AXIS.outputs_of(SET.truth, SET.shifts) - AXIS.outputs_of((), SET.shifts)
    found = [Oracle(replace(SET, seed=seed)).evidence(()) for seed in range(60)]
    oracle = Oracle(SET)
    left = oracle.refitted(trace)
    expected = float(left @ left)
    # twice the deviation of the mean: the evidence of a trace of size d has a deviation of 2 d
    bound = 4.0 * np.sqrt(expected / 60.0) + 2.0
    assert expected > 100.0
    assert abs(np.mean(found) - expected - len(effect.values)) < bound


@pytest.mark.parametrize("colour", COLOURS)
def test_verify_a_constant_tells_nothing_beside_noise_as_one_over_f(colour):
    """Constants drawn for each output: beside noise of a finite spectrum at nothing the sum of their squares over its density
    there, but for nominal numbers; beside 1/f none, and what varies counts as before."""
    draw = np.random.default_rng(11)
    oracle = Oracle(replace(SET, colour=colour))
    constant = np.ones_like(oracle.truth) * draw.normal(size=oracle.truth.shape[1])
    varying = np.sin(2.0 * np.pi * 7.0 * np.arange(len(constant)) / len(constant))[:, None] * constant
    squares = [float(np.sum(oracle.whitened.white(values) ** 2)) for values in (constant, varying, constant + varying)]
    count, level = len(constant), noise_scale(oracle.case) * np.array(AXIS.reference_noise)
    at_rest = density(colour, np.fft.rfftfreq(count, 1.0 / AXIS.rate_hz), AXIS.rate_hz, AXIS.band_hz)[0]
    expected = 0.0 if colour == "one_over_f" else float(np.sum(count * constant[0] ** 2 / (at_rest * level**2)))
    assert abs(squares[0] - expected) < 1e-9 * (1.0 + expected)
    assert squares[1] > 0.0
    assert abs(squares[2] - squares[0] - squares[1]) < 1e-6 * squares[2]


def test_verify_more_noise_hides_a_difference():
    """The same rival is told from the truth at a strong level and not where noise hides both; sizes near the truth's never
    are."""
    rival = (Effect("joint_damping", 1, {"factor": 1.5}),)
    evidence = {}
    for level in (10.0, 0.02):
        oracle = Oracle(replace(SET, level=level))
        evidence[level] = oracle.evidence(rival)
        near = Effect("joint_viscous", 1, {"viscous_n_m_s_per_rad": 20.0 * (1.0 + 1e-4)})
        assert not oracle.tells((near,))
    assert noise_scale(replace(SET, level=10.0)) < noise_scale(replace(SET, level=0.02))
    assert Oracle(replace(SET, level=10.0)).tells(rival), evidence
    assert not Oracle(replace(SET, level=0.02)).tells(rival), evidence
