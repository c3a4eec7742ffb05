#!/usr/bin/env python3
"""How long a diagnosis of ten seconds of three channels takes: `python tests/hidden_effects/ten_seconds.py`.

The bench's arm of two joints, moved for twice as long: without an effect, with a payload and dry friction, and with play
in the elbow. All cores for one diagnosis at a time. Exit code 0 if what is hidden is named within the limit, and nothing
where nothing is hidden; 1 if not.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import shlex
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT  # noqa: E402
from bench.dataset import write_csv  # noqa: E402
from bench.effects import Effect  # noqa: E402
from bench.experiment import TWO_JOINT  # noqa: E402
from bench.runner import ask  # noqa: E402
from example import measurement  # noqa: E402

LIMIT_S = 30.0
LONG = dataclasses.replace(TWO_JOINT, duration_s=10.0)
PAYLOAD = {"mass_kg": 1.5, "center_x_m": 0.04, "center_y_m": 0.0, "center_z_m": 0.10}
HIDDEN = {
    "clean": (),
    "payload and dry friction": (Effect("payload", None, PAYLOAD), Effect("joint_coulomb", 2, {"friction_n_m": 3.0})),
    "play": (Effect("joint_backlash", 2, {"gap_rad": 1.2e-3}),),
}


def main() -> int:
    """Writes the data, asks the program, prints a line for each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "truecut"), help="truecut, or a command")
    options = parser.parse_args()
    work = ROOT / "target" / "hidden_effects" / "ten_seconds"
    good = True
    for number, (name, truth) in enumerate(HIDDEN.items()):
        folder = work / name.replace(" ", "_")
        folder.mkdir(parents=True, exist_ok=True)
        write_csv(folder / "data.csv", measurement(LONG, truth, 700 + number))
        cores = os.cpu_count() or 1
        answer = ask(shlex.split(options.program), LONG.path, folder / "data.csv", folder / "answer", cores)
        if answer.diagnosis is None:
            print(answer.messages)
            return 1
        causes = sorted(cause["kind"] for cause in answer.diagnosis["causes"])
        runs = answer.diagnosis["work"]["predictions"]
        right = all(effect.kind in causes for effect in truth) and bool(causes) == bool(truth)
        good = good and right and answer.seconds <= LIMIT_S
        found = ", ".join(causes) or answer.diagnosis["verdict"]
        line = f"{name}: {answer.seconds:.1f} s, {runs} simulations, {'right' if right else 'WRONG'}: {found}"
        print(line, flush=True)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
