"""Chamfering with a pressed foot: docs/physics/chamfering.md and pressure_foot.md.

Every figure follows from the published coefficients of `dong2018chamfering` and three assumptions
(two cylinders of 32 mm bore and 50 mm length, friction coefficient 0.15).
"""

import numpy as np

AXIAL_PA, IN_PLANE_PA = 1.96e9, 2.14e9
FEED_M, DEPTH_M, HALF_ANGLE = 0.05e-3, 1.0e-3, np.radians(45.0)
ARM_N_PER_M = (8.646e5, 1.078e6, 1.394e6)  # k1 along the feed, k2 and k3 across
PISTONS_M2 = 2.0 * np.pi / 4.0 * 0.032**2
STROKE_M, AMBIENT_PA, ADIABATIC = 0.05, 101_325.0, 1.4
MU = 0.15


def chip_area_m2(depth_m, feed_m=FEED_M, half_angle=HALF_ANGLE):
    """Section between two passes of one edge: the triangle of depth d + f less that of depth d."""
    triangle = lambda d: 0.5 * d**2 * np.tan(half_angle)
    return triangle(depth_m + feed_m) - triangle(depth_m)


def rotating_force_n(depth_m):
    return IN_PLANE_PA * chip_area_m2(depth_m)


def axial_force_n(depth_m):
    return AXIAL_PA * chip_area_m2(depth_m)


def gas_stiffness_n_per_m(pressure_pa):
    """Adiabatic gas spring, n γ p_abs A / L."""
    return ADIABATIC * (pressure_pa + AMBIENT_PA) * PISTONS_M2 / STROKE_M


def axial_share(stiffness_n_per_m):
    """Part of an axial force that a spring beside the arm carries."""
    return stiffness_n_per_m / (stiffness_n_per_m + ARM_N_PER_M[0])


def paper_threshold_pa(mu, depth_m=DEPTH_M):
    """Pressure at which the published amplitude turns imaginary: 4 μN = π M, N = pA + F_X."""
    return (np.pi / (4 * mu) * rotating_force_n(depth_m) - axial_force_n(depth_m)) / PISTONS_M2


def exact_threshold_pa(mu, share, depth_m=DEPTH_M, sign=1.0):
    """Pressure at which μN = M, the foot carrying `share` of the axial force."""
    return (rotating_force_n(depth_m) / mu - sign * share * axial_force_n(depth_m)) / PISTONS_M2


def first_slip_depth_m(pressure_pa, share, mu=MU):
    """Depth already cut at which M(d) = μ (pA + share F_X(d)); both forces are linear in d."""
    net = (IN_PLANE_PA - mu * share * AXIAL_PA) * FEED_M * np.tan(HALF_ANGLE)
    return mu * pressure_pa * PISTONS_M2 / net - FEED_M / 2


def first_slip_depth_on_the_arm_m(pressure_pa, share, coupling, sign, mu=MU):
    """The same with an arm that moves across: M + coupling (1 − share) F_X = μ (pA + sign share
    F_X).
    """
    net = IN_PLANE_PA + coupling * (1 - share) * AXIAL_PA - sign * mu * share * AXIAL_PA
    return mu * pressure_pa * PISTONS_M2 / (net * FEED_M * np.tan(HALF_ANGLE)) - FEED_M / 2


def axial_process_stiffness_n_per_m(depth_m=DEPTH_M):
    """dF_X/dX where the surface behind stands still: K_fc d tan θ."""
    return AXIAL_PA * depth_m * np.tan(HALF_ANGLE)
