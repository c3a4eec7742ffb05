"""Chamfering with a conical cutter: chip area against the rim as it was left, forces, and the rim's geometry.

Let D(t) = n f t be the feed depth already cut; an edge stands one feed per tooth f_t deeper. The chip area of an edge
that stands at depth d over a rim of depth d_prev, both measured along the axis, is the change of the triangle's area:

    A = 1/2 tan(theta) max(0, max(d, 0)^2 - d_prev^2)          nominally (D + f_t/2) f_t tan(theta), Dong et al. 2018, eq. (1)

The rim is a ring of cells, and the step divides the revolution, so that a later pass meets exactly the cell which
an earlier one wrote. Each edge carries an axial force against its feed and, in the rotating frame, a radial and a
tangential force that turn with it (Dong et al. 2018, eq. (5)).
"""

from __future__ import annotations

import math

import numpy as np

from .profile import Profile
from .scenario import Chamfer

NO_FORCE = (0.0, 0.0, 0.0)


class ChamferProcess:
    """The cutter over one run. `tool_force` is called once a step, in order of time, at mid-step."""

    channels = ("cutting.depth", "cutting.engaged_depth", "cutting.chip_area", "cutting.edge_angle", "cutting.torque")

    def __init__(self, spec: Chamfer, longest_step_s: float) -> None:
        self.spec = spec
        self.foot = spec.foot
        per_tooth = math.ceil(spec.revolution_s / (longest_step_s * spec.edges) - 1e-9)
        self.per_tooth = per_tooth
        self.cells = per_tooth * spec.edges
        self.step_s = spec.revolution_s / self.cells
        self.sign = {"forward": 1.0, "backward": -1.0}[spec.direction]
        self.mode = ("off", "axial", "full").index(spec.regeneration)
        self.tan = math.tan(spec.half_angle_rad)
        self.per_length = 1.0 / math.cos(spec.half_angle_rad)
        c = spec.cutting
        self.k_axial = c.axial_pa
        self.k_radial = c.in_plane_pa * math.sin(c.in_plane_angle_rad)
        self.k_tangential = c.in_plane_pa * math.cos(c.in_plane_angle_rad)
        self.edge_forces = (c.edge_axial_n_per_m, c.edge_radial_n_per_m, c.edge_tangential_n_per_m)
        # what the earlier passes left; before the first one, the nominal helix of a virtual pass
        nominal = [self.feed_depth_m((k + 0.5) * self.step_s) for k in range(per_tooth)]
        self.rim = nominal * spec.edges
        self.rim_true = [0.0] * self.cells
        self._count = 0
        self.left_cut_s: float | None = None
        self.row: tuple[float, ...] = ()

    def start_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """Forces on the arm at tool and foot before the run: the foot's preload, nothing at the cutter."""
        preload = self.foot.preload_n if self.foot else 0.0
        return np.zeros(3), np.array([-preload, 0.0, 0.0])

    def feed_depth_m(self, t: float) -> float:
        """D(t): depth already cut in nominal conditions."""
        s = self.spec
        return min(s.feed_rate_m_per_s * t, s.depth_m - s.feed_per_tooth_m)

    def tool_force(self, t: float, x: tuple[float, float, float], _v) -> tuple[float, float, float]:
        """Force of the workpiece on the tool (N, process frame) at time t and tool displacement x (m)."""
        s = self.spec
        feed = self.feed_depth_m(t)
        tooth = s.feed_per_tooth_m
        axial_shift = self.sign * x[0]
        turn = s.start_angle_rad + s.spindle_rad_per_s * t
        fx = fy = fz = 0.0
        engaged_first = angle_first = area_of_all = tangential_of_all = 0.0
        for edge in range(s.edges):
            cell = (self._count + edge * self.per_tooth) % self.cells
            angle = turn + 2.0 * math.pi * edge / s.edges
            cos, sin = math.cos(angle), math.sin(angle)
            radial_shift = (x[1] * cos + x[2] * sin) / self.tan
            true_depth = feed + tooth + axial_shift + radial_shift
            if self.mode == 0:
                depth = feed + tooth
            elif self.mode == 1:
                depth = feed + tooth + axial_shift
            else:
                depth = true_depth
            engaged = depth if depth > 0.0 else 0.0
            left = self.rim[cell]
            area = 0.0
            if engaged > left:
                area = 0.5 * self.tan * (engaged * engaged - left * left)
                self.rim[cell] = engaged
                length = engaged * self.per_length
                axial = self.k_axial * area + self.edge_forces[0] * length
                radial = self.k_radial * area + self.edge_forces[1] * length
                tangential = self.k_tangential * area + self.edge_forces[2] * length
                fx -= self.sign * axial
                fy -= radial * cos - tangential * sin
                fz -= radial * sin + tangential * cos
                tangential_of_all += tangential
            elif self.left_cut_s is None and self.mode and t < s.ramp_s:
                self.left_cut_s = t
            if true_depth > self.rim_true[cell]:
                self.rim_true[cell] = true_depth
            area_of_all += area
            if edge == 0:
                engaged_first, angle_first = engaged, angle
        self._count += 1
        torque = tangential_of_all * 0.5 * s.hole_diameter_m
        self.row = (feed, engaged_first, area_of_all, angle_first, torque)
        return fx, fy, fz

    def findings(self) -> tuple[dict[str, float], dict[str, Profile]]:
        """Chamfer width (radial leg, m) at the end: its bounds, and the width by angle from process Y towards Z."""
        width = np.array(self.rim_true) * self.tan
        scalars = {
            "chamfer.width_mean": float(width.mean()),
            "chamfer.width_min": float(width.min()),
            "chamfer.width_max": float(width.max()),
            "chamfer.width_spread": float(np.ptp(width)),
            # Pappus: at each angle a triangle, its centroid a third of the width beyond the hole's edge
            "chamfer.removed_volume": float(
                np.mean(math.pi * width * width / self.tan * (0.5 * self.spec.hole_diameter_m + width / 3.0))
            ),
        }
        turn = self.spec.start_angle_rad + (np.arange(self.cells) + 0.5) * 2.0 * math.pi / self.cells
        return scalars, {"chamfer.width": Profile(turn, width, 2.0 * math.pi)}

    def joint_torque(self, _t: float):
        """The command stands still while chamfering."""
        return
