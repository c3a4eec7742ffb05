"""Runs, sweeps and diagnoses that are ended from outside, at random moments: what is left is whole.

    python fuzz/ends.py                    # all, with the counts below
    python fuzz/ends.py --part kill --trials 20
    python fuzz/ends.py --seed 7 --program target/release/truecut

Parts: `writers` (two, four and eight processes into one folder), `disk` (no file can grow beyond a
random size, as on a full disk), `kill` (SIGKILL), `signal` (SIGINT and SIGTERM). A trial that leaves
something damaged is printed with its number, and the exit code is 1.
"""

import argparse
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
URDF = ROOT / "assets/robots/rig_1dof/robot.urdf"
RUN = f"""name = "run"
[robot]
urdf = '{URDF}'
[run]
duration_s = 300
time_step_ms = 0.02
record_interval_ms = 1
[process.load]
release_n = [100, 0, 0]
"""
SHORT = RUN.replace("duration_s = 300\ntime_step_ms = 0.02\n", "duration_s = 0.5\n")
SWEEP = RUN.replace("300\ntime_step_ms = 0.02\n", "2\n") + """[[sweep.axis]]
key = "process.load.release_n.0"
values = [{values}]
[[sweep.column]]
name = "swing"
metric = "peak"
channel = "tool.displacement_x"
unit = "um"
""".format(values=", ".join(str(10 * n) for n in range(1, 200)))
# What releases the tool in RUN, and what the slide's drive gives.
FORCE_N, LIMIT_N = 100, 20_000
# Files of a run that has ended.
WHOLE = ("recording.parquet", "recording.rrd", "run.html", "summary.json")


class Desk:
    """A folder with scenarios, and the program called in it."""

    def __init__(self, program):
        self.program, self.folder = program, pathlib.Path(tempfile.mkdtemp())
        for name, text in (("run", RUN), ("short", SHORT), ("sweep", SWEEP)):
            (self.folder / f"{name}.toml").write_text(text)
        elbow = (ROOT / "scenarios/diagnosis/elbow.toml").read_text()
        (self.folder / "elbow.toml").write_text(elbow.replace("../../assets", str(ROOT / "assets")))
        shutil.copy(ROOT / "scenarios/diagnosis/elbow.csv", self.folder)

    def begin(self, *arguments, **options):
        call = [self.program, *arguments]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        return subprocess.Popen(call, cwd=self.folder, **pipes, **options)

    def call(self, *arguments, **options):
        child = self.begin(*arguments, **options)
        told, _ = child.communicate()
        return child.returncode, told

    def reads(self, file):
        return self.call("view", str(file))[0] == 0

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)


def whole_run(desk, folder):
    """What is wrong with the folder of a run that has ended, or nothing."""
    missing = [name for name in WHOLE if not (folder / name).is_file()]
    if missing:
        return f"without {missing}"
    if not desk.reads(folder / "recording.parquet"):
        return "recording.parquet cannot be read"
    json.loads((folder / "summary.json").read_text())
    left = [it.name for it in folder.iterdir() if it.name not in WHOLE]
    return f"also {left}" if left else ""


def force_of(folder):
    """By how many newtons the force of the summary's run is above FORCE_N, from the drive's use."""
    use = json.loads((folder / "summary.json").read_text())["metrics"]["plant.torque_use_max"]
    return round(use * LIMIT_N) - FORCE_N


def writers(desk, draw, trials):
    """Each folder is of one run, and those that lost say so."""
    count, wrong, refused = (2, 4, 8), [], 0
    for trial in range(trials):
        many = count[trial % 3]
        out = f"out{trial}"
        durations = [round(0.3 + 0.1 * k, 1) for k in range(many)]
        children = []
        for k, duration in enumerate(durations):
            changes = ("--set", f"run.duration_s={duration}", "--set", f"process.load.release_n.0={FORCE_N + k}")
            children.append(desk.begin("run", "short.toml", "--out", out, *changes))
            time.sleep(draw.random() * 0.02)
        ends = [(child.communicate()[0], child.returncode) for child in children]
        lost = [told for told, code in ends if code == 2]
        refused += len(lost)
        if any("another run is writing into this folder" not in told for told in lost):
            wrong.append(f"{trial}: a loser does not say why: {lost}")
        if any(code not in (0, 2) for _, code in ends) or all(code for _, code in ends):
            wrong.append(f"{trial}: codes {[code for _, code in ends]}")
        folder = desk.folder / out / "short"
        fault = whole_run(desk, folder)
        told = desk.call("view", str(folder / "recording.parquet"))[1]
        # The recording tells its rows, the summary what the force took of the drive: of one run.
        won = [
            k
            for k, (d, (_, code)) in enumerate(zip(durations, ends))
            if code == 0 and f" {round(1000 * d) + 1} rows" in told and (fault or force_of(folder) == k)
        ]
        if fault or not won:
            wrong.append(f"{trial}: {fault or 'of no run that succeeded'}")
        shutil.rmtree(desk.folder / out)
    return wrong, f"{refused} calls refused by name"


def disk(desk, draw, trials):
    """An earlier result stays whole where the next one finds no room."""
    wrong, failed = [], 0
    desk.call("run", "short.toml", "--out", "disk")
    folder = desk.folder / "disk/short"
    earlier = {it.name: it.read_bytes() for it in folder.iterdir()}
    largest = max(map(len, earlier.values()))
    for trial in range(trials):
        size = draw.randrange(largest)

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        code, told = desk.call(
            "run", "short.toml", "--out", "disk", "--set", "run.duration_s=0.6", preexec_fn=limit
        )
        failed += code == 2
        now = {it.name: it.read_bytes() for it in folder.iterdir() if it.name != "recording.arrows"}
        if code != 2 or now != earlier:
            wrong.append(f"{trial}: {size} bytes, code {code}: {told}")
    return wrong, f"{failed} refused with the file's name, nothing old lost"


def wait(child, file, least):
    """Until the file has more bytes than that; false if the program ended before."""
    while not file.exists() or file.stat().st_size <= least:
        if child.poll() is not None:
            return False
        time.sleep(0.002)
    return True


# Call, what grows, its size from which moments are drawn, longest wait.
KINDS = {
    "run": (("run", "run.toml", "--out", "o"), "o/run/recording.arrows", 100_000, 1.5),
    "sweep": (("run", "sweep.toml", "--out", "o"), "o/sweep/sweep.rows.jsonl", 300, 0.6),
    "diagnosis": (("diagnose", "elbow.toml", "--out", "o"), "o/elbow/diagnosis.runs", 1000, 1.0),
}


def begun(desk, draw, kind):
    """A program that is at work for a random time."""
    call, grows, least, longest = KINDS[kind]
    child, grows = desk.begin(*call), desk.folder / grows
    at_work = wait(child, grows, least)
    time.sleep(draw.random() * longest)
    return child, grows, at_work


def kill(desk, draw, trials):
    """What was on the disk is read, and gone on from."""
    wrong, lost, kept = [], [], 0
    for trial in range(trials):
        kind = ("run", "sweep", "diagnosis")[trial % 3]
        child, grows, at_work = begun(desk, draw, kind)
        now = time.time()
        child.kill()
        child.communicate()
        if not at_work or child.returncode != -signal.SIGKILL:
            # It had ended: no trial.
            shutil.rmtree(desk.folder / "o", ignore_errors=True)
            continue
        if kind == "run":
            lost.append(now - grows.stat().st_mtime)
            if not desk.reads(grows):
                wrong.append(f"{trial}: {grows.name} cannot be read")
        else:
            # The next one is stopped as soon as it has said what it takes over.
            size = grows.stat().st_size
            child = desk.begin(*KINDS[kind][0])
            if wait(child, grows, 0.98 * size):
                kept += 1
            else:
                wrong.append(f"{trial}: {kind} did not go on")
            child.kill()
            child.communicate()
        shutil.rmtree(desk.folder / "o", ignore_errors=True)
    most = max(lost, default=0.0)
    return wrong, f"at most {most:.2f} s of a run's rows lost; {kept} sweeps and diagnoses went on"


def stop(desk, draw, trials):
    """The code tells of the signal; files are whole."""
    wrong, took = [], []
    for trial in range(trials):
        kind = ("run", "sweep", "diagnosis")[trial % 3]
        number, code = ((signal.SIGINT, 130), (signal.SIGTERM, 143))[trial % 2]
        child, grows, at_work = begun(desk, draw, kind)
        now = time.time()
        child.send_signal(number)
        told, _ = child.communicate()
        took.append(time.time() - now)
        if at_work and child.returncode != code and "stopped by a signal" in told:
            wrong.append(f"{trial}: {kind}: code {child.returncode}: {told}")
        if kind == "run":
            fault = whole_run(desk, grows.parent)
            if child.returncode != code or fault:
                wrong.append(f"{trial}: code {child.returncode}, {fault}")
        elif child.returncode == code and not grows.is_file():
            wrong.append(f"{trial}: {kind}: {grows.name} is gone")
        shutil.rmtree(desk.folder / "o", ignore_errors=True)
    return wrong, f"ended within {max(took, default=0.0):.2f} s"


PARTS = {"writers": (writers, 50), "disk": (disk, 10), "kill": (kill, 200), "signal": (stop, 100)}


def main():
    about = __doc__.split("\n\n")[0]
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--program", default=str(ROOT / "target/release/truecut"))
    parser.add_argument("--part", choices=PARTS, action="append")
    parser.add_argument("--trials", type=int)
    parser.add_argument("--seed", type=int, default=25)
    asked = parser.parse_args()
    any_wrong = False
    for name in asked.part or PARTS:
        part, trials = PARTS[name]
        trials = asked.trials or trials
        desk = Desk(os.path.abspath(asked.program))
        begun_s = time.time()
        wrong, told = part(desk, random.Random(asked.seed), trials)
        desk.remove()
        for line in wrong:
            print(f"  {name} {line}")
        print(f"{name}: {trials} trials, {len(wrong)} wrong, {told} ({time.time() - begun_s:.0f} s)", flush=True)
        any_wrong |= bool(wrong)
    return 1 if any_wrong else 0


if __name__ == "__main__":
    sys.exit(main())
