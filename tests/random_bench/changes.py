#!/usr/bin/env python3
"""How often what changes over time is told: `python tests/random_bench/changes.py --seed N --sets 20` hides on drawn arms
a brake that sets in, a friction that fades, a gain that jumps and an offset that creeps, at moments and in sizes drawn,
a brake that drags for a while, a gain that is off for a while, a push, and beside them nothing, or a friction, a gain or an offset that acts all along; drive torques are MuJoCo's. `--program`
may be given several times: all are asked about the same data.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from drawn import ROOT  # noqa: E402
from drawn.judge import interval  # noqa: E402

sys.path.insert(0, str(ROOT / "tests" / "hidden_effects"))

from bench.dataset import write_csv  # noqa: E402
from bench.noise import COLOURS, rms, unit_noise  # noqa: E402
from bench.runner import ask  # noqa: E402
from test_changes import DURATION_S, RATE_HZ, Changing  # noqa: E402

PROGRAM = str(ROOT / "target" / "release" / "truecut")
# a machine that does other things besides is no reason for a refusal
TIME_LIMIT_S = 600.0
CHANGES = ("brake", "fades", "gain", "creeps")
# between two moments, from a fortieth of the record to half of it
STRETCHES = ("drags", "off", "push")
STEADY = {
    "friction": {"joint_coulomb", "joint_asymmetric_coulomb"},
    "scale": {"sensor_gain"},
    "offset": {"sensor_offset", "joint_offset"},
}
FORMS = (*CHANGES, "clean", *STEADY)
ALL_FORMS = (*FORMS, *STRETCHES)
# what is hidden, over the noise that the filter of the comparison leaves, rms
LEAST, MOST = 3.0, 60.0
# the channels go through a filter of 5 Hz
BAND_HZ = 5.0


class Hidden(Changing):
    """A drawn arm with something hidden in one joint."""

    def __init__(self, seed: int, form: str, folder: Path) -> None:
        draw = np.random.default_rng([seed, 31])
        self.repeats = bool(draw.integers(0, 2))
        super().__init__(seed, folder, self.repeats)
        self.form = form
        self.colour = str(draw.choice(COLOURS))
        self.noise = float(np.exp(draw.uniform(np.log(0.003), np.log(0.03))))
        self.moment_s = float(draw.uniform(0.15, 0.75)) * DURATION_S
        self.fades_s = float(draw.uniform(0.15, 0.6)) * DURATION_S
        self.over_noise = float(np.exp(draw.uniform(np.log(LEAST), np.log(MOST))))
        self.sign = float(draw.choice([-1.0, 1.0]))
        self.lasts_s = float(np.exp(draw.uniform(np.log(0.025), np.log(0.5)))) * DURATION_S
        if form in STRETCHES:
            self.moment_s = float(draw.uniform(0.1, 0.9)) * (DURATION_S - self.lasts_s)

    def columns(self) -> dict[str, np.ndarray]:
        """The data."""
        torque, j = self.torque(), self.joint
        noise = unit_noise(self.colour, *torque.shape, RATE_HZ, BAND_HZ, self.seed)
        noise *= self.noise * torque.std(axis=0)
        late, friction = self.time > self.moment_s, np.sign(self.speed[:, j])
        inside = late & (self.time < self.moment_s + self.lasts_s)
        shape = {
            "brake": late * friction,
            "fades": np.exp(-self.time / self.fades_s) * friction,
            "gain": self.sign * late * torque[:, j],
            "creeps": self.sign * self.creep(),
            "clean": np.zeros_like(self.time),
            "friction": friction,
            "scale": self.sign * torque[:, j],
            "offset": self.sign * np.ones_like(self.time),
            "drags": inside * friction,
            "off": self.sign * inside * torque[:, j],
            "push": self.sign * inside,
        }[self.form]
        size = self.over_noise * self.noise * torque[:, j].std()
        torque[:, j] += size * shape / max(rms(shape), 1e-12)
        angles = self.command + 1e-5 * self.draw.normal(size=self.command.shape)
        columns = {"t": self.time} | {f"c{i + 1}": angles[:, i] for i in range(self.joints)}
        return columns | {f"f{i + 1}": (torque + noise)[:, i] for i in range(self.joints)}

    def creep(self) -> np.ndarray:
        """A course of an offset: towards an end, or on and on."""
        if self.seed // len(FORMS) % 2:
            return 1.0 - np.exp(-self.time / self.fades_s)
        return self.time / DURATION_S

    def judged(self, found: dict) -> str:
        """What the answer comes to: right, or in which way it is wrong."""
        causes = [(one["kind"], one["target"]) for one in found["causes"]]
        changes = found.get("changes", [])
        own = f"joint{self.joint + 1}"
        if self.form == "clean":
            return "right" if found["verdict"] == "nothing_beyond_noise" and not changes else "false alarm"
        if self.form in (*CHANGES, *STRETCHES):
            in_drift = any(kind == "sensor_drift" and own in target for kind, target in causes)
            if self.form == "creeps" and in_drift and found["verdict"] in ("named", "ambiguous"):
                return "right"
            if found["verdict"] == "unknown_cause":
                return "right" if not causes else "right, with causes"
            return {"nothing_beyond_noise": "noise"}.get(found["verdict"], "named wrongly")
        members = causes + [
            (one["kind"], one["target"]) for other in found["alternatives"] for one in other["causes"]
        ]
        hit = any(kind in STEADY[self.form] and own in str(target) for kind, target in members)
        if changes:
            return "told as a change"
        if found["verdict"] in ("named", "ambiguous"):
            return "right" if hit else "named wrongly"
        return {"nothing_beyond_noise": "noise"}.get(found["verdict"], "unknown")


def one(seed: int, form: str, folder: Path, programs: list[str]) -> list[dict]:
    """Draws, asks each program, judges."""
    hidden = Hidden(seed, form, folder / "arm")
    scenario, data = hidden.scenario(), folder / "arm" / "data.csv"
    write_csv(data, hidden.columns())
    told = []
    for i, program in enumerate(programs):
        answer = ask([program], scenario, data, folder / f"answer{i}", 1, TIME_LIMIT_S)
        what = {
            "seed": seed,
            "form": form,
            "program": i,
            "joint": hidden.joint + 1,
            "repeats": hidden.repeats,
            "colour": hidden.colour,
            "over_noise": round(hidden.over_noise, 1),
            "moment_s": round(hidden.moment_s if form in ("brake", "gain", *STRETCHES) else hidden.fades_s, 2),
            "lasts_s": round(hidden.lasts_s, 2) if form in STRETCHES else None,
            "seconds": round(answer.seconds, 1),
            "judged": "refused",
        }
        if answer.diagnosis is not None:
            found = answer.diagnosis
            what |= {
                "judged": hidden.judged(found),
                "verdict": found["verdict"],
                "causes": [f"{c['kind']} {c['target']}" for c in found["causes"]],
                "changes": [(c["channel"], c["from_s"], c.get("until_s"), c["what"]) for c in found.get("changes", [])],
                "floors": sorted({c["noise_source"] for c in found["channels"].values()}),
                "followed": [
                    (one["channel"], one["signal"], one["fraction"]) for one in found["ceiling"]["correlated_signals"]
                ],
                "reason": found["reason"],
                "left": {name: c["after"] / max(c["refitted"], 1e-300) for name, c in found["channels"].items()},
            }
        told.append(what)
    return told


def rate(hits: int, count: int) -> str:
    """With its exact 95 % interval."""
    low, high = interval(hits, count)
    return f"{hits} of {count} [{100 * low:.0f}, {100 * high:.0f}] %"


def is_told(one: dict) -> bool:
    """Whether a change is told in the right channel."""
    own = f"joint{one['joint']}.drive_torque"
    return any(channel == own for channel, *_ in one.get("changes", []))


def table(found: list[dict], programs: int) -> str:
    """Rates with exact 95 % intervals, a line for each form and program."""
    rows = ["| hidden | program | right | told as a change, in its channel | other answers |", "|" + " --- |" * 5]
    for form in ALL_FORMS:
        for i in range(programs):
            own = [f for f in found if f["form"] == form and f["program"] == i]
            if not own:
                continue
            others = sorted({f["judged"] for f in own} - {"right"})
            counts = ", ".join(f"{name} {sum(f['judged'] == name for f in own)}" for name in others)
            right = rate(sum(f["judged"] == "right" for f in own), len(own))
            rows.append(f"| {form} | {i} | {right} | {rate(sum(map(is_told, own)), len(own))} | {counts} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True, help="first seed")
    parser.add_argument("--sets", type=int, default=20, help="number of sets of each form")
    parser.add_argument("--form", choices=ALL_FORMS, action="append", help="only this; may be given several times")
    parser.add_argument("--program", action="append", help="truecut; may be given several times")
    parser.add_argument("--jobs", type=int, default=2, help="sets at once")
    parser.add_argument("--log", type=Path, help="file of a line of JSON for each answer")
    arguments = parser.parse_args()
    programs, forms = arguments.program or [PROGRAM], arguments.form or ALL_FORMS
    found = []
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(arguments.jobs) as pool:
        # a form has its seeds, whichever others are asked; those of stretches are those of the forms in their order
        jobs = [
            pool.submit(one, arguments.seed + ALL_FORMS.index(form) % len(FORMS) + len(FORMS) * i, form, Path(folder) / f"{form}_{i}", programs)
            for i in range(arguments.sets)
            for form in forms
        ]
        for job in as_completed(jobs):
            for answer in job.result():
                found.append(answer)
                line = json.dumps(answer)
                print(line[:400], flush=True)
                if arguments.log:
                    with arguments.log.open("a", encoding="utf-8") as log:
                        log.write(line + "\n")
    print(table(found, len(programs)))


if __name__ == "__main__":
    main()
