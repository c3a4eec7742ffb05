"""A mass on two springs under a rotating force, held back by dry friction:
docs/physics/vibration.md.

Time steps after Moreau with the velocity at the *end* of the step, the plain rule of `moreau1988`;
the program takes the velocity at mid-step. All cases of a table run side by side.
"""

import numpy as np

MASS_KG = 557.3  # 7 Hz on k2
K2, K3 = 1.078e6, 1.394e6
FORCE_N = 109.68
IN_PLANE_PA, FEED_M = 2.14e9, 0.05e-3


def run(force, limit_n, stiffness, damping_ratio, steps, dt, watch_from=0):
    """Largest and smallest position and largest radius of each case after step `watch_from`.

    force(t) -> (2, cases) N; limit_n (cases,) is μN; stiffness (2, 1) N/m.
    """
    damping = 2.0 * damping_ratio * np.sqrt(stiffness * MASS_KG)
    x = np.zeros((2, len(limit_n)))
    v = np.zeros_like(x)
    low, high = np.full_like(x, np.inf), np.full_like(x, -np.inf)
    radius = []
    most = np.asarray(limit_n) * dt / MASS_KG
    for k in range(steps):
        v = v + (force(k * dt) - stiffness * x - damping * v) * (dt / MASS_KG)
        speed = np.maximum(np.hypot(v[0], v[1]), 1e-300)
        v *= np.maximum(0.0, 1.0 - most / speed)
        x = x + dt * v
        radius.append(np.hypot(x[0], x[1]))
        if k >= watch_from:
            low, high = np.minimum(low, x), np.maximum(high, x)
    return 0.5 * (high - low), np.array(radius)


def steady_amplitude_um(
    ratios, rpm, damping_ratio=0.02, stiffness=(K2, K3), revolutions=60, per_turn=4000
):
    """Steady amplitudes in Y and Z (µm) for μN/M in `ratios`."""
    omega = 2.0 * np.pi * rpm / 60.0
    force = lambda t: FORCE_N * np.array([[np.cos(omega * t)], [np.sin(omega * t)]])
    steps = revolutions * per_turn
    limit = FORCE_N * np.asarray(ratios, float)
    k = np.array(stiffness)[:, None]
    found, _ = run(
        force, limit, k, damping_ratio, steps, 60.0 / rpm / per_turn, steps - 2 * per_turn
    )
    return 1e6 * found


def ramp_um(rpm, limit_n, per_turn=4000):
    """Largest radius (µm) in each quarter of a ramp of 20 revolutions to 1 mm, for each friction
    limit.

    The force begins along the second axis. That matters: the transient of the start, of 0.9 per
    second, is still there.
    """
    omega, turns = 2.0 * np.pi * rpm / 60.0, 20
    size = lambda t: IN_PLANE_PA * (FEED_M * omega * t / (2 * np.pi) + FEED_M / 2) * FEED_M
    force = lambda t: size(t) * np.array([[-np.sin(omega * t)], [np.cos(omega * t)]])
    k = np.array([[K2], [K3]])
    _, radius = run(
        force, np.asarray(limit_n, float), k, 0.02, turns * per_turn, 60.0 / rpm / per_turn
    )
    return 1e6 * radius.reshape(4, -1, len(limit_n)).max(axis=1).T


def circle_radius_um(ratio, rpm=300.0):
    """Closed form without damping, equal springs: √(M² − (μN)²)/|k − mω²|."""
    omega = 2.0 * np.pi * rpm / 60.0
    return 1e6 * FORCE_N * np.sqrt(1.0 - ratio**2) / abs(K2 - MASS_KG * omega**2)


def published_amplitude_um(ratio, rpm=300.0):
    """The published one: √(M² − (4μN/π)²)/|k − mω²|, nan where it is imaginary."""
    omega = 2.0 * np.pi * rpm / 60.0
    rest = 1.0 - (4.0 * ratio / np.pi) ** 2
    return 1e6 * FORCE_N * np.sqrt(rest) / abs(K2 - MASS_KG * omega**2) if rest >= 0 else np.nan


def den_hartog(r, ratio):
    """Amplification X k / F of motion without stops (`denhartog1931`)."""
    v = 1.0 / (1.0 - r * r)
    u = np.sin(np.pi / r) / (r * (1.0 + np.cos(np.pi / r)))
    return np.sqrt(v * v - (ratio * u) ** 2)


def den_hartog_in_time(r, ratios, periods=400, per_period=2000):
    """The same by time steps, in one direction."""
    omega = r * np.sqrt(K2 / MASS_KG)
    force = lambda t: FORCE_N * np.array([[np.cos(omega * t)], [0.0]])
    steps = periods * per_period
    k = np.array([[K2], [K2]])
    dt = 2.0 * np.pi / omega / per_period
    found, _ = run(
        force, FORCE_N * np.asarray(ratios, float), k, 0.0, steps, dt, steps - 2 * per_period
    )
    return found[0] * K2 / FORCE_N


def decaying_swing(start, velocity, steps, parted=False, span=25.0, dry=0.03, rows=128):
    """Positions of 1 kg on 1 N/m under a dry friction of `dry` N in the plane, `rows` of them.

    Time steps by the rule with the velocity at mid-step. `parted`: a step in which the motion along its
    first direction comes to rest is parted there, all other forces taken as constant.
    """
    x, v, h = np.array(start, float), np.array(velocity, float), span / steps
    found = []
    for k in range(steps):
        dt = 0.5 * h if k == 0 else h  # velocities live at half steps
        free, most = v - x * dt, dry * dt
        v = parted_step(v, free, most) if parted else step(v, free, most)
        x = x + h * v
        if (k + 1) % (steps // rows) == 0:
            found.append(x)
    return np.array(found)


def step(before, free, most):
    """Velocity after a step: at rest if friction can bring it there, else against the mean velocity."""
    if np.linalg.norm(free) <= most:
        return np.zeros(2)
    middle = 0.5 * (before + free)
    against = middle if np.linalg.norm(middle) > 0.5 * most else free
    return free - most * against / np.linalg.norm(against)


def parted_step(before, free, most):
    speed, middle = np.linalg.norm(before), 0.5 * (before + free)
    if speed > 0.0:
        if np.linalg.norm(middle) > 0.5 * most:
            after = free - most * middle / np.linalg.norm(middle)
            if after @ before > 0.0:
                return after
        change = free - before - most * before / speed
        braking = -change @ before / speed
        if braking > speed:
            part = speed / braking
            here = before + part * change
            return step(here, here + (1.0 - part) * (free - before), (1.0 - part) * most)
    return step(before, free, most)
