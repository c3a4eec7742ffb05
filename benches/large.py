"""Long runs and large files: what a step, a row or a triangle takes, and how much memory.

    python benches/large.py            # after cargo build --release; minutes
    python benches/large.py --short    # a hundredth of each

Each is done at a tenth and at the whole of its size: time for each of them flat, memory bounded. Times are of the processor.
"""

import argparse
import math
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RIG = ROOT / "assets/robots/rig_1dof/robot.urdf"


def scenario(duration_s, step_ms, row_ms, rest=""):
    return (
        f"name = \"large\"\n[robot]\nurdf = '{RIG}'\n[run]\nduration_s = {duration_s!r}\ntime_step_ms = {step_ms!r}\n"
        f"record_interval_ms = {row_ms!r}\n[process.load]\nrelease_n = [100, 0, 0]\n{rest}"
    )


def steps(folder, count):
    """Steps of 0.1 ms, a row for every 1000."""
    (folder / "large.toml").write_text(scenario(count * 1e-4, 0.1, 100.0))
    return ["run", "large.toml", "--no-rrd"]


def rows(folder, count):
    """A row each ms, of two steps."""
    (folder / "large.toml").write_text(scenario(count * 1e-3, 0.5, 1.0))
    return ["run", "large.toml"]


def sweep_rows(folder, count):
    """Runs of ten steps, a row of the table each."""
    values = ", ".join(f"{10 + 90 * n / count!r}" for n in range(count // 100))
    axes = (
        f'[[sweep.axis]]\nkey = "process.load.release_n.0"\nvalues = [{values}]\n'
        f'[[sweep.axis]]\nkey = "process.load.release_n.1"\nvalues = {[float(n) for n in range(100)]}\n'
        '[[sweep.column]]\nname = "swing"\nmetric = "peak"\nchannel = "tool.displacement_x"\nunit = "um"\n'
    )
    (folder / "large.toml").write_text(scenario(0.005, 0.5, 0.5, axes))
    return ["run", "large.toml"]


def triangles(folder, count):
    """A waved sheet on a block, as a binary STL."""
    side = max(2, round(math.sqrt(count / 2)))

    def point(i, j):
        return (i * 0.5, j * 0.5, 5 * math.sin(i / 40) * math.cos(j / 50))

    with open(folder / "sheet.stl", "wb") as file:
        file.write(bytes(80) + struct.pack("<I", 2 * side * side))
        for i in range(side):
            for j in range(side):
                a, b, c, d = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
                for corners in ((a, b, c), (a, c, d)):
                    file.write(struct.pack("<12fH", 0, 0, 0, *(x for p in corners for x in p), 0))
    return ["part", "sheet.stl", "--unit", "mm"]


SIZES = {"steps": (steps, 10**7), "rows": (rows, 10**6), "sweep rows": (sweep_rows, 10**5), "triangles": (triangles, 10**6)}


def measured(program, call, count):
    """Processor time in us for each, and the most memory in MB."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        arguments = call(folder, count)
        child = subprocess.Popen([program, *arguments], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        told = child.stdout.read()
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            raise SystemExit(f"{arguments}: code {child.returncode}\n{told.decode()}")
    return (used.ru_utime + used.ru_stime) / count * 1e6, used.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--program", default=shutil.which("truecut") or ROOT / "target/release/truecut")
    parser.add_argument("--short", action="store_true", help="a hundredth of each")
    parser.add_argument("--only", choices=SIZES, action="append")
    asked = parser.parse_args()
    print("| what | how many | processor time for each | most memory |\n| --- | --- | --- | --- |")
    for name in asked.only or SIZES:
        call, most = SIZES[name]
        most //= 100 if asked.short else 1
        for count in (most // 10, most):
            each_us, memory_mb = measured(os.path.abspath(asked.program), call, count)
            print(f"| {name} | {count} | {each_us:.2f} us | {memory_mb:.0f} MB |", flush=True)


if __name__ == "__main__":
    main()
