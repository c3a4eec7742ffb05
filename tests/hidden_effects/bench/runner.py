"""Generates the sets, asks the program, judges the answers."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np

from . import dataset
from .cases import Case
from .experiment import ALL
from .score import Answer, score
from .signature import nominal_signatures

TIME_LIMIT_S = 120.0


def _simulate(job: tuple) -> None:
    name, truth, shifts, still = job
    experiment = ALL[name]
    experiment.outputs_of(truth, shifts, still)


def simulate_all(cases: list[Case], jobs: int) -> int:
    """Runs MuJoCo for everything that the cases need and is not kept yet; how many different runs they need."""
    runs = {}
    for case in cases:
        for truth, shifts in ((case.truth, case.shifts), ((), case.shifts)):
            job = (case.experiment, truth, shifts, case.still)
            runs[repr(job)] = job
    for name in sorted({case.experiment for case in cases}):
        zero = (0.0,) * len(ALL[name].uncertain)
        shifts = [zero]
        for i in range(len(zero)):
            shifts += [tuple(sign * 0.5 * (j == i) + 0.0 for j in range(len(zero))) for sign in (1.0, -1.0)]
        for one in shifts:
            job = (name, (), one, None)
            runs[repr(job)] = job
    with ProcessPoolExecutor(jobs) as pool:
        list(pool.map(_simulate, runs.values()))
    return len(runs)


def write_all(cases: list[Case], work: Path, seed: int, jobs: int) -> dict[str, Case]:
    """Writes every case in an order that says nothing of what is hidden; cases by the names of their sets."""
    if work.exists():
        shutil.rmtree(work)
    simulate_all(cases, jobs)
    for name in {case.experiment for case in cases}:
        nominal_signatures(name)  # kept in memory, before the processes part
    order = np.random.default_rng(seed).permutation(len(cases))
    with ProcessPoolExecutor(jobs) as pool:
        names = pool.map(dataset.write, [cases[k] for k in order], range(len(order)), [work] * len(order))
        return {name: cases[k] for name, k in zip(names, order)}


def ask(
    program: list[str], scenario: Path, data: Path, out: Path, threads: int, limit_s: float = TIME_LIMIT_S
) -> Answer:
    """One diagnosis."""
    command = [*program, "diagnose", str(scenario), "--data", str(data), "--out", str(out)]
    began = time.perf_counter()
    variables = os.environ | {"RAYON_NUM_THREADS": str(threads)}
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=variables, timeout=limit_s)
        code, messages = done.returncode, done.stdout + done.stderr
    except subprocess.TimeoutExpired:
        code, messages = -1, f"no answer within {limit_s:g} s"
    seconds = time.perf_counter() - began
    written = sorted(out.rglob("diagnosis.json")) if code == 0 else []
    diagnosis = json.loads(written[0].read_text(encoding="utf-8")) if written else None
    return Answer(code, diagnosis, messages, seconds)


def diagnose_all(program: list[str], sets: dict[str, Case], work: Path, jobs: int, tell=print) -> dict[str, Answer]:
    """Asks the program about every set."""
    threads = max(1, (os.cpu_count() or 1) // jobs)

    def one(name: str) -> Answer:
        scenario = ALL[sets[name].experiment].path
        return ask(program, scenario, work / "data" / name / "data.csv", work / "answers" / name, threads)

    answers = {}
    with ThreadPoolExecutor(jobs) as pool:
        for name, answer in zip(sets, pool.map(one, sets)):
            answers[name] = answer
            if len(answers) % 25 == 0:
                tell(f"  {len(answers)} of {len(sets)} sets", flush=True)
    return answers


def judge_all(sets: dict[str, Case], answers: dict[str, Answer], work: Path, jobs: int) -> list:
    """The judgement of each set. Ambiguous answers cost the generator runs of its own."""
    with ProcessPoolExecutor(jobs) as pool:
        labels = [json.loads((work / "labels" / f"{name}.json").read_text(encoding="utf-8")) for name in sets]
        scores = pool.map(score, sets.values(), [answers[name] for name in sets], labels)
        return [(name, case, found, answers[name].seconds) for (name, case), found in zip(sets.items(), scores)]
