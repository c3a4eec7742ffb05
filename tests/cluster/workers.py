"""A HyperQueue server and its workers, each in a process of its own, so that a worker can be killed as a machine dies.

HyperQueue's Python package starts workers only beside their server, in one process. Here a worker's process starts a
server that nobody uses, replaces its access record by that of the server meant, and adds its worker then, which joins
that one.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

# where a server of the package keeps what workers need to join it
ACCESS = Path("hq-current", "access.json")
STARTED = "started"


class Cluster:
    """A server in a folder, and workers of a core each; a context."""

    def __init__(self, folder: Path, workers: int):
        self.server = folder / "server"
        self._processes = [_process(self.server)]
        self.workers = [_process(folder / f"worker_{k}", self.server) for k in range(workers)]
        self._processes += self.workers

    def __enter__(self) -> Cluster:
        return self

    def __exit__(self, *_: object) -> None:
        # workers first: a server that ends would make them say so
        for process in reversed(self._processes):
            process.kill()
            process.wait()


def _process(*folders: Path) -> subprocess.Popen:
    """A server, or a worker of the server in the second folder; ready when this returns."""
    call = [sys.executable, __file__, *map(str, folders)]
    process = subprocess.Popen(call, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    for line in process.stdout:
        if line.strip() == STARTED:
            return process
    raise RuntimeError(f"ended with {process.wait()}: {call}")


class Watch:
    """Notes which files of parts have come to a folder, and how often each; a context."""

    def __init__(self, folder: Path):
        self._folder, self._stop = folder, threading.Event()
        self._seen: dict[str, set[tuple[int, int]]] = {}
        self._thread = threading.Thread(target=self._look)

    def __enter__(self) -> Watch:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def _look(self) -> None:
        while not self._stop.wait(0.005):
            try:
                found = [(file.name, file.stat()) for file in os.scandir(self._folder)]
            except FileNotFoundError:
                continue  # not there yet, or gone between two looks
            for name, stat in found:
                if name.startswith("rows_") and name.endswith(".jsonl"):
                    self._seen.setdefault(name, set()).add((stat.st_ino, stat.st_mtime_ns))

    @property
    def rows(self) -> list[int]:
        """The numbers of the rows of all parts that came, each as often as it came."""
        rows: list[int] = []
        for name, files in self._seen.items():
            start, end = map(int, name.removesuffix(".jsonl").split("_")[1:])
            rows += list(range(start, end)) * len(files)
        return sorted(rows)


def kill_later(process: subprocess.Popen, after_s: float) -> threading.Timer:
    """Kills a process after a time, as a machine dies: nothing is tidied up."""
    timer = threading.Timer(after_s, process.kill)
    timer.start()
    return timer


def main() -> None:
    """A server, or a worker, until its input is closed or it is killed."""
    from hyperqueue.cluster import LocalCluster, WorkerConfig

    own = Path(sys.argv[1])
    cluster = LocalCluster(str(own))
    for server in map(Path, sys.argv[2:]):
        shutil.copyfile(server / ACCESS, own / ACCESS)
        cluster.start_worker(WorkerConfig(cores=1))
        # it joins on a thread
        time.sleep(0.5)
    print(STARTED, flush=True)
    sys.stdin.read()


if __name__ == "__main__":
    main()
