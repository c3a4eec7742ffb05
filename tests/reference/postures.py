"""The posture study of a milling arm: docs/physics/stability.md, section "An arm".

The spindle stands across the flange (tool z along flange x), the tool points down. Inertia is that
of the reference model (not 0.82 of it), the damping ratio 0.02 in every mode; no gravity.
"""

import arm
import numpy as np
import stability

P1, P2 = np.array([1.050, -1.450, 0.870]), np.array([1.350, -1.450, 0.870])
FLANGE_FROM_TIP = np.array([0.25, 0.0, 0.18])
FLANGE_FROM_TOOL = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
ALUMINIUM, STEEL = (2, 767e6, 0.22), (4, 2e9, 0.3)
SLOT, HALF = (0.0, np.pi), (np.pi / 2, np.pi)


def postures(point, angle_deg):
    """Postures of the front shoulder and upper elbow that put the tool there (two, which differ in
    the wrist).
    """
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    tool = np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])
    flange = tool @ FLANGE_FROM_TOOL.T
    return arm.inverse(arm.IRB6600, point - flange @ FLANGE_FROM_TIP, flange)[:2]


def planar_stiffness(point, q):
    """k_min and k_max across the tool, everything else left free (N/m)."""
    c = arm.compliance(arm.IRB6600, q, point)[:2, :2]
    return 1.0 / np.linalg.eigvalsh(c)[::-1]


def tip_modes(point, q):
    """Modes as `stability` takes them, in world x and y."""
    omega, shapes = arm.modes(q, point)
    return [(w, 0.02, shape[:2]) for w, shape in zip(omega, shapes.T)]


def turned(b, angle):
    """Directional matrix for a feed turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    r = np.array([[c, -s], [s, c]])
    return r @ b @ r.T


def stable(modes, b, depth=0.3e-3):
    """All eigenvalues of the arm with the cut, teeth meeting the nominal surface, in the left half
    plane.
    """
    shapes = np.array([shape for *_, shape in modes]).T
    stiffness = np.diag([w**2 for w, *_ in modes]) - depth * shapes.T @ b @ shapes
    damping = np.diag([2 * zeta * w for w, zeta, _ in modes])
    return stability.rightmost(np.eye(len(modes)), damping, stiffness).real < 0
