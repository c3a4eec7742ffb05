"""Growth of vibration in a cut with worn flanks, in the time domain: docs/physics/milling_forces.md, Process damping.

Small motion of two modes under four teeth, chips linear in the motion. The force on a flank is either the damper of the
page, or K_sp times the area that the land overlaps of what its edge has left, integrated along the land from the motion
remembered: no force where there is no overlap.

    python tests/reference/flank.py
"""

import numpy as np

MODES = ((300.0, 2 * np.pi * 7.0, 0.02), (300.0, 2 * np.pi * 9.0, 0.02))
TEETH, RADIUS_M, DEPTH_M = 4, 8e-3, 0.05e-3
K_T, K_R = 2e9, 0.3
K_SP, LAND_M = 1.5e14, 0.1e-3
SECONDS = 4.0
PIECES = 4  # of the land, steps of time
LAWS = ("sharp", "law", "overlap")


def overlap_m2(u, i, phi, turn, pieces, step_m):
    """Area that the land overlaps, by trapezoids; the last piece ends where the land does."""
    back = np.arange(int(pieces) + 2)
    angles = phi - turn * back
    out = (u[i] - u[i - back]) @ np.array([np.sin(angles), np.cos(angles)])
    over = np.maximum(np.diagonal(out), 0.0)
    whole, part = int(pieces), pieces - int(pieces)
    end = over[whole] + (over[whole + 1] - over[whole]) * part
    return step_m * (np.sum(0.5 * (over[:whole] + over[1 : whole + 1])) + 0.5 * part * (over[whole] + end))


def motion(rpm, entry, leave, law, seconds=SECONDS):
    """Displacements at even steps from rest pushed along x, and the step."""
    spin = 2 * np.pi * rpm / 60
    speed = spin * RADIUS_M
    period = 2 * np.pi / (TEETH * spin)
    before = round(period / (LAND_M / speed / PIECES))
    step = period / before
    pieces = LAND_M / speed / step
    mass, omega, ratio = np.array(MODES).T
    count = int(seconds / step)
    u = np.zeros((count + before + 2, 2))
    velocity, half = np.array([1e-7, 0.0]), None
    for i in range(before, before + count):
        force = np.zeros(2)
        for tooth in range(TEETH):
            phi = (spin * (i - before) * step - 2 * np.pi * tooth / TEETH) % (2 * np.pi)
            if not entry <= phi < leave:
                continue
            outward = np.array([np.sin(phi), np.cos(phi)])
            chip = (u[i] - u[i - before]) @ outward
            tangential, radial = K_T * chip * DEPTH_M, K_R * K_T * chip * DEPTH_M
            if law == "law":
                radial += 0.25 * K_SP * LAND_M**2 * DEPTH_M * (velocity @ outward) / speed
            elif law == "overlap":
                radial += K_SP * DEPTH_M * overlap_m2(u, i, phi, spin * step, pieces, step * speed)
            force += np.array([-tangential * outward[1], tangential * outward[0]]) - radial * outward
        change = step * (force / mass - omega**2 * u[i] - 2 * ratio * omega * velocity)
        half = velocity + 0.5 * change if half is None else half + change
        u[i + 1] = u[i] + step * half
        velocity = half + 0.5 * change
    return u[before : before + count + 1], step


def growth_per_s(u, step):
    """Slope of the logarithm of the level in windows of two periods of the slow mode."""
    window = round(4 * np.pi / MODES[0][1] / step)
    windows = len(u) // window
    level = [np.sqrt(np.mean(np.sum(u[j * window : (j + 1) * window] ** 2, axis=1))) for j in range(windows)]
    first = windows // 3
    return np.polyfit(np.arange(first, windows) * window * step, np.log(level[first:]), 1)[0]


def main():
    cases = [("slot", 0.0, rpm) for rpm in (300, 600, 2400)] + [("down, a/D .5", np.pi / 2, rpm) for rpm in (300, 600)]
    for name, entry, rpm in cases:
        rates = (growth_per_s(*motion(rpm, entry, np.pi, law)) for law in LAWS)
        print(name, rpm, *(f"{rate:.4f}" for rate in rates))


if __name__ == "__main__":
    main()
