"""What the claims of `hub_spoke_belt.toml` say, without a run: the belt on the spoke at rest, contact by contact.

From the path that the planner writes (`truecut path`: places, axes, postures) and the face's control points. The wheel
is cut into slices across its axis; in the plane of each the face's nearest point gives depth and curvature, and
the belt over rubber bonded to the hub, an obstacle problem (`truecut_reference/bonded.py`), its force. Force and friction bend the arm by
J K^-1 J^T; both are solved together. Time is the way of the wheel's centre over the feed, and Preston's law does the rest.
"""

from __future__ import annotations

import csv

import numpy as np
import pinocchio
import pytest
import scipy.interpolate
from conftest import ROBOTS, ROOT, tomllib
from truecut_reference.bonded import line_load

SCENARIOS = ROOT / "scenarios" / "finishing"
SLICES = 12
# every so many of the planner's contacts, 2 mm apart
EVERY = 2
# the figures that the claims' reasons give
MEAN_FORCE_N, DEPTH_UM, WAY_MM, AREA_MM2 = 44.09, 4.819, 918.7, 16_810.0


def read(path):
    """A TOML file."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


class Face:
    """The B-spline where the job puts it, m; all weights are 1."""

    def __init__(self, patch: dict, origin_mm: list[float]) -> None:
        assert np.all(np.array(patch["weights"]) == 1)
        points = np.array(patch["control_points_mm"]) * 1e-3 + np.array(origin_mm) * 1e-3
        self.knots = (np.array(patch["knots_u"], float), np.array(patch["knots_v"], float))
        self.spline = scipy.interpolate.NdBSpline(self.knots, points, 3)

    def at(self, uv: np.ndarray, u: int = 0, v: int = 0) -> np.ndarray:
        """Places, or their derivatives."""
        return self.spline(uv, nu=(u, v))

    def area(self) -> float:
        """By Gauss's rule between the knots, m2."""
        nodes, weights = np.polynomial.legendre.leggauss(8)

        def rule(knots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            ends = np.unique(knots)
            middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
            return (middle[:, None] + half[:, None] * nodes).ravel(), (half[:, None] * weights).ravel()

        (u, wu), (v, wv) = map(rule, self.knots)
        uv = np.stack(np.meshgrid(u, v, indexing="ij"), -1).reshape(-1, 2)
        normals = np.cross(self.at(uv, 1, 0), self.at(uv, 0, 1))
        return float(np.linalg.norm(normals, axis=1) @ np.outer(wu, wv).ravel())

    def nearest(self, place: np.ndarray) -> np.ndarray:
        """Parameters of the nearest of many samples."""
        grid = np.stack(np.meshgrid(np.linspace(0, 1, 81), np.linspace(0, 1, 41)), -1).reshape(-1, 2)
        return grid[np.argmin(np.linalg.norm(self.at(grid) - place, axis=1))]


class Press:
    """Wheel, belt and face."""

    def __init__(self, table: dict, job: dict, face: Face) -> None:
        wheel = job["wheel"]
        self.face, self.mu = face, table["mu"]
        self.radius, self.width = wheel["radius_mm"] * 1e-3, wheel["width_mm"] * 1e-3
        modulus, rubber = wheel["modulus_mpa"] * 1e6, table["rubber_mm"] * 1e-3
        tension = table["tension_n"] / self.width
        # smooth in the root of the depth
        roots, radii = np.linspace(1e-3, np.sqrt(0.5e-3), 40), np.linspace(0.02, 0.05, 15)
        loads = [[line_load(x * x, r, modulus, rubber, table["poisson"], tension) for r in radii] for x in roots]
        self.table = scipy.interpolate.RectBivariateSpline(roots, radii, loads)

    def loads(self, centre: np.ndarray, axis: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
        """Force on the wheel, sum of normal forces, and the slices' nearest points as the next start."""
        middle = centre + axis * self.width * ((np.arange(SLICES)[:, None] + 0.5) / SLICES - 0.5)
        for _ in range(30):
            away, first = self.face.at(uv) - middle, (self.face.at(uv, 1, 0), self.face.at(uv, 0, 1))
            normal = np.cross(*first)
            normal /= np.linalg.norm(normal, axis=1)[:, None]
            run = np.cross(axis, normal)
            run /= np.linalg.norm(run, axis=1)[:, None]
            # in the slice's plane, and at right angles to the face's run there
            rows = np.stack([[f @ axis for f in first], [(f * run).sum(1) for f in first]]).transpose(2, 0, 1)
            wrong = np.stack([away @ axis, (away * run).sum(1)], -1)
            step = np.linalg.solve(rows, -wrong[..., None])[..., 0]
            uv = np.clip(uv + step, 0.0, 1.0)
            if np.abs(step).max() < 1e-10:
                break
        # beyond the face's border nothing presses
        meets = np.abs(wrong).max(axis=1) < 1e-6
        lean = np.sqrt(1.0 - (normal @ axis) ** 2)
        parts = np.linalg.solve(rows, np.tile([0.0, 1.0], (SLICES, 1))[..., None])[..., 0]
        second = [[(self.face.at(uv, 2 - i - j, i + j) * normal).sum(1) for i in (0, 1)] for j in (0, 1)]
        bend = -np.einsum("ki,ijk,kj->k", parts, np.array(second), parts)
        relative = 1.0 / (1.0 / self.radius + bend / lean)
        depth = np.where(meets, self.radius - np.linalg.norm(away, axis=1), 0.0)
        load = np.where(depth > 1e-8, self.table.ev(np.sqrt(np.maximum(depth, 1e-8)), relative), 0.0)
        assert depth.max() < 0.5e-3
        assert np.all((relative > 0.02) & (relative < 0.05) | (depth <= 0.0))
        pressed = load * self.width / SLICES / lean
        return pressed @ (normal + self.mu * run), float(pressed.sum()), uv


class Arm:
    """Compliance of the tool, the motors standing still."""

    def __init__(self) -> None:
        self.model = pinocchio.buildModelFromUrdf(str(ROBOTS / "hp20" / "robot.urdf"))
        self.data = self.model.createData()
        joints = read(ROBOTS / "hp20" / "robot.toml")["joint"]
        self.stiffness = np.array([joint["stiffness_nm_per_rad"] for joint in joints])

    def compliance(self, q: np.ndarray, place: np.ndarray) -> np.ndarray:
        """m/N, world axes."""
        last = self.model.njoints - 1
        pinocchio.computeJointJacobians(self.model, self.data, q)
        frame = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        jacobian = pinocchio.getJointJacobian(self.model, self.data, last, frame)
        arm = place - self.data.oMi[last].translation
        linear = jacobian[:3] - pinocchio.skew(arm) @ jacobian[3:]
        return linear / self.stiffness @ linear.T


def along(line: list[dict], press: Press, arm: Arm) -> tuple[np.ndarray, np.ndarray]:
    """Places of the wheel's centre and normal forces along one line."""
    places, forces, uv = [], [], None
    for row in line:
        place = np.array([float(row[key]) for key in ("x_mm", "y_mm", "z_mm")]) * 1e-3
        turned = pinocchio.Quaternion(*(float(row[key]) for key in ("qw", "qx", "qy", "qz")))
        axis = turned.toRotationMatrix()[:, 1]
        compliance = arm.compliance(np.radians([float(row[f"j{i}"]) for i in range(1, 7)]), place)
        uv = np.tile(press.face.nearest(place), (SLICES, 1)) if uv is None else uv
        moved = np.zeros(3)
        for _ in range(40):
            force, normal, uv = press.loads(place + moved, axis, uv)
            change = compliance @ force - moved
            moved += 0.6 * change
            if np.linalg.norm(change) < 1e-8:
                break
        places.append(place)
        forces.append(normal)
    return np.array(places), np.array(forces)


@pytest.fixture(scope="module")
def at_rest(truecut, tmp_path_factory) -> dict[str, float]:
    """Mean force, mean depth, way and area."""
    table = read(SCENARIOS / "hub_spoke_belt.toml")["process"]["belt"]
    job = read(SCENARIOS / table["job"])
    out = tmp_path_factory.mktemp("spoke")
    truecut.call("path", SCENARIOS / table["job"], "--out", out)
    with (out / "hub_spoke" / "path.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["copy"] == "1" and row["contact"] == "1"]
    patch = read(SCENARIOS / job["surface"]["patch"])
    face = Face(patch, job["surface"]["xyz_mm"])
    press, arm = Press(table, job, face), Arm()
    way = impulse = 0.0
    for segment in dict.fromkeys(row["segment"] for row in rows):
        line = [row for row in rows if row["segment"] == segment]
        # the last contact counts, whatever is left out between
        places, forces = along(line[:-1:EVERY] + line[-1:], press, arm)
        steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
        way += steps.sum()
        impulse += steps @ (forces[1:] + forces[:-1]) / 2.0
    removed = table["preston_per_pa"] * table["belt_m_per_s"] * impulse / (job["path"]["feed_mm_per_s"] * 1e-3)
    area = face.area()
    return {"force": impulse / way, "depth": removed / area, "way": way, "area": area}


def test_crosscheck_spoke_at_rest_gives_the_claims_their_numbers(at_rest):
    """Half as many contacts and other slices than in the reasons: a thousandth."""
    found = [at_rest["force"], at_rest["depth"] * 1e6, at_rest["way"] * 1e3, at_rest["area"] * 1e6]
    assert found == pytest.approx([MEAN_FORCE_N, DEPTH_UM, WAY_MM, AREA_MM2], rel=2e-3)


def test_crosscheck_claims_of_the_spoke_lie_about_the_numbers_at_rest():
    """No claim is bounded by what the run itself came to."""
    claims = {claim.get("scalar"): claim for claim in read(SCENARIOS / "hub_spoke_belt.toml")["claim"]}
    for scalar, number in (("belt.mean_force", MEAN_FORCE_N), ("belt.depth_mean", DEPTH_UM)):
        claim = claims[scalar]
        assert (claim["min"] + claim["max"]) / 2.0 == pytest.approx(number, rel=1e-3)
