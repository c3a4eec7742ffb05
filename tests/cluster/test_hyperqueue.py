"""A sweep over the workers of a HyperQueue server: the same files to the bit as on one machine, whatever workers do."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from workers import Cluster, Watch, kill_later

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
FILES = ("sweep.parquet", "sweep.csv", "sweep.svg", "sweep.html")
hyperqueue = pytest.importorskip("hyperqueue", reason="no wheel of HyperQueue for this machine")

SCENARIO = f"""
name = "Swings"
[robot]
urdf = '{ROOT}/assets/robots/rig_1dof/robot.urdf'
[run]
duration_s = DURATION
[process.load]
release_n = [100, 0, 0]
[[uncertain]]
key = "process.load.release_n.0"
relative = 0.1
[sweep.sample]
method = "sobol"
count = ROWS
uncertain = true
[[sweep.axis]]
key = "process.load.release_n.1"
from = -20
to = 20
[[sweep.column]]
name = "swing"
metric = "peak"
channel = "tool.displacement_x"
unit = "um"
"""


@pytest.fixture
def server(tmp_path):
    """A server with two workers of a core each; its folder."""
    from hyperqueue.cluster import LocalCluster, WorkerConfig

    with LocalCluster(str(tmp_path / "server")) as cluster:
        for _ in range(2):
            cluster.start_worker(WorkerConfig(cores=1))
        yield cluster.cluster.server_dir


def scenario(folder: Path, rows: int, duration_s: float) -> Path:
    file = folder / "swings.toml"
    file.write_text(SCENARIO.replace("ROWS", str(rows)).replace("DURATION", str(duration_s)), encoding="utf-8")
    return file


def sweep(file: Path, out: str, *words: str, python: str = sys.executable) -> subprocess.CompletedProcess:
    call = [PROGRAM, "sweep", file.name, "--engine", "reduced", "--out", out, *words]
    variables = os.environ | {"TRUECUT_PYTHON": python, "NO_COLOR": "1"}
    return subprocess.run(call, cwd=file.parent, env=variables, capture_output=True, text=True, timeout=300)


def files(file: Path, out: str) -> dict[str, bytes]:
    return {name: (file.parent / out / "swings" / name).read_bytes() for name in FILES}


def test_workers_give_what_one_machine_gives(tmp_path, server):
    file = scenario(tmp_path, 200, 0.1)
    assert sweep(file, "here").returncode == 0
    ended = sweep(file, "there", "--workers-on", "hyperqueue", "--server", server, "--part-rows", "30")
    assert ended.returncode == 0, ended.stderr
    assert "200 of 200" in ended.stdout
    assert files(file, "there") == files(file, "here")
    # parts have served
    assert {path.name for path in (tmp_path / "there" / "swings").iterdir()} == set(FILES)


def kill_some(stop: threading.Event, seed: int, folder: Path) -> int:
    """Kills calls that make parts of a sweep in this folder, at random, until told to stop."""
    draw, killed = random.Random(seed), 0
    while not stop.is_set():
        time.sleep(draw.uniform(0.05, 0.25))
        listed = subprocess.run(["pgrep", "-f", f"sweep {folder}.*--rows"], capture_output=True, text=True)
        numbers = [int(number) for number in listed.stdout.split()]
        if numbers and killed < 6:
            try:
                os.kill(draw.choice(numbers), signal.SIGKILL)
                killed += 1
            except ProcessLookupError:
                pass
    return killed


@pytest.mark.parametrize("seed", [1, 2])
def test_what_is_killed_is_made_again(tmp_path, server, seed):
    file = scenario(tmp_path, 40, 20.0)
    assert sweep(file, "here").returncode == 0
    stop, killed = threading.Event(), []
    killer = threading.Thread(target=lambda: killed.append(kill_some(stop, seed, tmp_path)))
    killer.start()
    words = ("--workers-on", "hyperqueue", "--server", server, "--part-rows", "5", "--retries", "8")
    ended = sweep(file, "there", *words)
    stop.set()
    killer.join()
    assert ended.returncode == 0, ended.stderr
    assert killed[0] >= 1, "nothing was killed"
    assert files(file, "there") == files(file, "here")


@pytest.mark.parametrize("seed", [1, 2])
def test_a_worker_that_is_killed_costs_its_parts_a_retry_and_no_row_comes_twice(tmp_path, seed):
    """The worker itself, as a machine dies, not the calls that it makes."""
    file, rows, draw = scenario(tmp_path, 60, 10.0), 60, random.Random(seed)
    assert sweep(file, "here").returncode == 0
    with Cluster(tmp_path, 2) as cluster, Watch(tmp_path / "there" / "swings" / "parts") as watch:
        victim = draw.choice(cluster.workers)
        timer = kill_later(victim, draw.uniform(0.2, 0.6))
        words = ("--workers-on", "hyperqueue", "--server", str(cluster.server), "--part-rows", "3")
        ended = sweep(file, "there", *words)
        assert not timer.is_alive(), "it ended before"
    assert ended.returncode == 0, ended.stderr
    assert files(file, "there") == files(file, "here")
    assert watch.rows == list(range(rows))


def test_a_part_that_never_comes_is_told_and_the_others_are_kept(tmp_path, server):
    file = scenario(tmp_path, 10, 300.0)
    words = ("--workers-on", "hyperqueue", "--server", server, "--part-rows", "5", "--retries", "1")
    ended = sweep(file, "there", *words, "--limit-s", "0.01")
    assert ended.returncode == 2
    assert "2 of 2 parts did not come; the first is rows 0..5" in ended.stderr
    assert "took longer than --limit-s 0.01:" in ended.stderr


def test_what_is_missing_is_told(tmp_path):
    file = scenario(tmp_path, 10, 0.1)
    words = ("--workers-on", "hyperqueue", "--part-rows", "5", "--server", str(tmp_path / "none"))
    ended = sweep(file, "there", *words)
    assert ended.returncode == 2
    assert "there is no HyperQueue server" in ended.stderr and "--server" in ended.stderr
    without = tmp_path / "python"
    without.write_text(f"#!/bin/sh\nexec {sys.executable} -S -I \"$@\"\n", encoding="utf-8")
    without.chmod(0o755)
    ended = sweep(file, "there", *words, python=str(without))
    assert ended.returncode == 2
    assert "has no package hyperqueue" in ended.stderr and "pip install hyperqueue" in ended.stderr
