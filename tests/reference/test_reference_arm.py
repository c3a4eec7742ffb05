"""Reference numbers of docs/physics/arm.md."""

import arm
import numpy as np
from pytest import approx

POSITION, ROTATION = arm.flange(arm.IRB6600, arm.POSTURE)
TIP = POSITION + 0.30 * ROTATION[:, 2]
AXES = arm.process_axes(ROTATION)


def free(stiffness=arm.STIFFNESS, tip=TIP):
    return arm.in_process(arm.compliance(arm.IRB6600, arm.POSTURE, tip, stiffness)[:3, :3], AXES)


def test_flange_of_the_published_posture():
    assert POSITION == approx([1.3043301285, -1.2351738406, 0.4886557433], abs=1e-9)
    assert ROTATION[:, 2] == approx([0.1571794943, 0.9875691603, -0.0013267225], abs=1e-9)
    assert ROTATION[:, 0] == approx([-0.6928734071, 0.1112334106, 0.7124279403], abs=1e-9)


def test_branches_of_the_published_posture():
    found = arm.inverse(arm.IRB6600, POSITION, ROTATION)
    reached = [q for q in found if np.isfinite(q).all()]
    assert len(reached) == 4
    off = [np.abs((q - arm.POSTURE + np.pi) % (2 * np.pi) - np.pi).max() for q in reached]
    assert min(off) < 1e-9
    second = np.radians([-48.38, 54.82, 6.86, -125.84, -107.43, 158.05])
    assert min(np.abs((q - second + np.pi) % (2 * np.pi) - np.pi).max() for q in reached) < 1e-9


def test_stiffness_with_rotation_free():
    c = free()
    assert 1 / c[0, 0] == approx(0.86476e6, rel=2e-5)
    assert 1 / c[1, 1] == approx(1.37290e6, rel=2e-5)
    assert 1 / c[2, 2] == approx(1.09067e6, rel=2e-5)
    values, vectors = np.linalg.eigh(c[1:, 1:])
    assert 1 / values[::-1] == approx([1.07780e6, 1.39384e6], rel=2e-5)
    stiff = vectors[:, 0]
    assert np.degrees(np.arctan(stiff[1] / stiff[0])) == approx(13.185, abs=2e-3)


def test_stiffness_with_rotation_clamped():
    clamped = lambda tip: np.linalg.inv(
        np.linalg.inv(arm.compliance(arm.IRB6600, arm.POSTURE, tip))[:3, :3]
    )
    assert clamped(TIP) == approx(clamped(POSITION), rel=1e-9, abs=1e-15)
    k = np.linalg.inv(arm.compliance(arm.IRB6600, arm.POSTURE, TIP, arm.STIFFNESS_CLAMPED))[:3, :3]
    c = arm.in_process(np.linalg.inv(k), AXES)
    lateral = 1 / np.linalg.eigvalsh(c[1:, 1:])[::-1]
    assert [1 / c[0, 0], *lateral] == approx([8.646e5, 1.078e6, 1.394e6], rel=1e-3)


def test_axial_force_pushes_sideways():
    c = free()
    s = np.linalg.solve(c[1:, 1:], c[1:, 0])
    assert np.linalg.norm(s) == approx(0.525, abs=5e-4)


def test_modes():
    omega, _ = arm.modes(arm.POSTURE, TIP)
    assert omega / (2 * np.pi) == approx([6.042, 9.985, 19.056, 25.445, 39.275, 79.924], abs=6e-4)
    omega, _ = arm.modes(arm.POSTURE, TIP, scale=0.82)
    assert omega[0] / (2 * np.pi) == approx(6.672, abs=6e-4)


def test_hp20_on_the_spoke():
    assert arm.HP20.a1 + arm.HP20.c2 + np.hypot(arm.HP20.a2, arm.HP20.c3) == approx(1.717, abs=5e-4)
    for u, expected in [
        (0.2, [-6.200, 6.516, -34.775, -3.616, -31.231, -80.996]),
        (0.6, [-4.896, 22.475, -12.569, 0.668, -61.852, -85.455]),
    ]:
        rise = 25.0 * np.pi * np.cos(np.pi * u)
        along = np.array([200.0, 0.0, rise]) / np.hypot(200.0, rise)
        normal = np.array([-rise, 0.0, 200.0]) / np.hypot(200.0, rise)
        centre = np.array([200.0 * u, 0.0, 25.0 * np.sin(np.pi * u)]) + 39.5 * normal
        rotation = np.column_stack([np.cross(along, -normal), along, -normal])
        wrist = np.array([1.0, -0.1, 0.45]) + 1e-3 * centre - 0.25 * rotation[:, 2]
        off = [np.degrees(q) - expected for q in arm.inverse(arm.HP20, wrist, rotation)]
        assert min(np.abs((d + 180) % 360 - 180).max() for d in off) < 1e-3
