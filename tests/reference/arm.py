"""The two supplied robots in closed form: docs/physics/arm.md.

Kinematics of an arm with an ortho-parallel base and a spherical wrist (`brandstoetter2014`),
compliance J K⁻¹ Jᵀ, and modes of the surrogate links. Nothing is read from the URDF; the geometry
is typed in again.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh


class Opw(NamedTuple):
    """Lengths in m, offsets in rad, senses of the joints: θ = sense · q − offset."""

    a1: float
    a2: float
    b: float
    c1: float
    c2: float
    c3: float
    c4: float
    offset: tuple
    sense: tuple = (1, 1, 1, 1, 1, 1)


IRB6600 = Opw(0.32, -0.20, 0.0, 0.78, 1.075, 1.142, 0.20, (0, 0, -np.pi / 2, 0, 0, 0))
HP20 = Opw(
    0.15, -0.14, 0.0, 0.505, 0.76, 0.795, 0.105, (0, 0, -np.pi / 2, 0, 0, 0), (1, 1, -1, -1, -1, -1)
)
POSTURE = np.radians([-48.38, 54.82, 6.86, 54.16, 107.43, -21.95])
STIFFNESS = np.array([2.117, 4.829, 3.001, 0.855, 0.439, 0.450]) * 1e6
STIFFNESS_CLAMPED = np.array([1.245, 1.802, 2.884, 0.880, 0.634, 1.070]) * 1e6
# Mass, centre of mass, diagonal inertia of each link in its own axes (θ, not q); end effector last.
LINKS = [
    (400.0, (0.15, 0.0, -0.25), (25.0, 25.0, 30.0)),
    (250.0, (0.0, 0.0, 0.5), (30.0, 32.0, 6.0)),
    (280.0, (-0.1, 0.0, 0.2), (18.0, 20.0, 10.0)),
    (60.0, (0.0, 0.0, -0.35), (5.0, 5.0, 0.6)),
    (35.0, (0.0, 0.0, 0.03), (0.5, 0.5, 0.4)),
    (20.0, (0.0, 0.0, 0.17), (0.3, 0.3, 0.3)),
]
END_EFFECTOR = (120.0, (0.0, 0.0, 0.20 + 0.20), (4.0, 4.0, 1.5))


def turn(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    if axis == "y":
        return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def frames(robot, q):
    """Origin, rotation and joint axis of the six links in the world, links at their own joint (link
    1 at height c1).
    """
    theta = np.array(robot.sense) * q - np.array(robot.offset)
    axes = ["z", "y", "y", "z", "y", "z"]
    steps = [
        (0, 0, robot.c1),
        (robot.a1, 0, 0),
        (0, 0, robot.c2),
        (robot.a2, robot.b, robot.c3),
        (0, 0, 0),
        (0, 0, 0),
    ]
    origin, rotation, found = np.zeros(3), np.eye(3), []
    for axis, step, angle, sense in zip(axes, steps, theta, robot.sense):
        origin = origin + rotation @ np.array(step)
        direction = rotation @ np.array([0.0, axis == "y", axis == "z"]) * sense
        rotation = rotation @ turn(axis, angle)
        found.append((origin, rotation, direction))
    return found


def flange(robot, q):
    """Position and rotation of the flange."""
    origin, rotation, _ = frames(robot, q)[-1]
    return origin + rotation[:, 2] * robot.c4, rotation


def jacobian(robot, q, point):
    """6×6 Jacobian of a point fixed to the last link, translation first."""
    links = frames(robot, q)
    return np.array([np.r_[np.cross(a, point - o), a] for o, _, a in links]).T


def inverse(robot, position, rotation):
    """All eight postures (some nan) that put the flange there, by shoulder, elbow and wrist."""
    c = position - robot.c4 * rotation[:, 2]
    kappa, psi = np.hypot(robot.a2, robot.c3), np.arctan2(robot.a2, robot.c3)
    n = np.sqrt(c[0] ** 2 + c[1] ** 2 - robot.b**2) - robot.a1
    found = []
    for rear in (False, True):
        across = n + 2 * robot.a1 if rear else n
        base = np.arctan2(robot.b, n + robot.a1)
        first = np.arctan2(c[1], c[0]) + (base - np.pi if rear else -base)
        s = np.hypot(across, c[2] - robot.c1)
        with np.errstate(invalid="ignore"):
            shoulder = np.arccos((s**2 + robot.c2**2 - kappa**2) / (2 * s * robot.c2))
            elbow = np.arccos((s**2 - robot.c2**2 - kappa**2) / (2 * robot.c2 * kappa))
        lean = np.arctan2(across, c[2] - robot.c1) * (-1 if rear else 1)
        for sign in (1, -1):
            # The elbow bends to the other side of the line to the wrist than the shoulder turns.
            second = lean - sign * shoulder
            third = sign * elbow - psi
            base_rotation = turn("z", first) @ turn("y", second + third)
            r = base_rotation.T @ rotation
            fifth = np.arctan2(np.hypot(r[0, 2], r[1, 2]), r[2, 2])
            for flip in (1, -1):
                fourth = np.arctan2(flip * r[1, 2], flip * r[0, 2])
                sixth = np.arctan2(flip * r[2, 1], -flip * r[2, 0])
                theta = np.array([first, second, third, fourth, flip * fifth, sixth])
                found.append((theta + np.array(robot.offset)) / np.array(robot.sense))
    return found


def compliance(robot, q, point, stiffness=STIFFNESS):
    """6×6 compliance of a point of the last link with its rotation left free."""
    j = jacobian(robot, q, point)
    return j @ np.diag(1.0 / stiffness) @ j.T


def mass_matrix(q, robot=IRB6600, scale=1.0):
    """Joint-space inertia of the surrogate links with their end effector."""
    links = frames(robot, q)
    m = np.zeros((6, 6))
    bodies = list(enumerate(LINKS)) + [(5, END_EFFECTOR)]
    for index, (mass, centre, inertia) in bodies:
        origin, rotation, _ = links[index]
        point = origin + rotation @ np.array(centre)
        j = np.array([np.r_[np.cross(a, point - o), a] for o, _, a in links[: index + 1]]).T
        turned = rotation @ np.diag(inertia) @ rotation.T
        m[: index + 1, : index + 1] += mass * j[:3].T @ j[:3] + j[3:].T @ turned @ j[3:]
    return scale * m


def modes(q, point, robot=IRB6600, scale=1.0):
    """Angular frequencies and the mass-normalised shapes (columns) at the point."""
    squares, shapes = eigh(np.diag(STIFFNESS), mass_matrix(q, robot, scale))
    return np.sqrt(squares), jacobian(robot, q, point)[:3] @ shapes


def process_axes(rotation):
    """Columns X along the spindle, Y horizontal, Z."""
    x = rotation[:, 2]
    y = np.cross([0.0, 0.0, 1.0], x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def in_process(matrix, axes):
    return axes.T @ matrix @ axes
