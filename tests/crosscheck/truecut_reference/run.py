"""Cross-checks one scenario: `run.py SCENARIO --mjcf FILE --recording recording.parquet --out crosscheck.json`.

Runs the reference at a step and at half of it, in two processes; it counts only if halving the step moves it by less
than a third of the tolerance. Exit codes: 0 agreement, 2 bad input, 4 disagreement.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import scipy.interpolate

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from truecut_reference import compare, table  # noqa: E402
from truecut_reference import scenario as scenario_file
from truecut_reference.plant import Plant  # noqa: E402
from truecut_reference.milling import growth_rate  # noqa: E402
from truecut_reference.scenario import Chamfer, Load, Milling, Scenario, Wheel  # noqa: E402
from truecut_reference.simulate import Result, simulate  # noqa: E402
from truecut_reference.wheel import RUN_UP_S, CommandedPath  # noqa: E402

STEP_S = 100e-6
DISAGREES = 4
BAD_INPUT = 2
# A commanded path may leave the straight line by this much (m and rad): a hundredth of a wheel's deflection.
PATH_TOLERANCE = 1e-6
PATH_SPEED_TOLERANCE = 1e-4
# Part of the feed per tooth by which a tool may move from tooth to tooth and its vibration still count as small.
GROWTH_LINEAR_SHARE = 0.05


def tolerance_of(scenario: Scenario) -> float:
    """Bound on the NRMSE of the tool's displacement: smooth, time-known forces 0.1 %, contact and cutting 1 %."""
    smooth = isinstance(scenario.process, Load) and scenario.process.foot is None
    return 1e-3 if smooth else 1e-2


def reference_pair(scenario: Scenario, model, step_s: float, until_s: float, command) -> tuple[Result, Result]:
    """The reference at half the step and at the step."""
    # not multiprocessing's Pool: it ends its workers by a signal that a runner of tests may catch, and then waits for ever
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("fork")) as pool:
        jobs = [pool.submit(simulate, scenario, model, h, until_s, command) for h in (0.5 * step_s, step_s)]
        fine, coarse = (job.result() for job in jobs)
    return fine, coarse


def crosscheck(scenario: Scenario, model, recording: compare.Recording, step_s: float = STEP_S) -> dict:
    """Everything that `crosscheck.json` holds; `agrees` is the verdict and `failures` its reasons."""
    tolerance = tolerance_of(scenario)
    end_s = float(recording.time_s[-1])
    travels = isinstance(scenario.process, (Wheel, Milling))
    command = recording.command() if travels else None
    fine, coarse = reference_pair(scenario, model, step_s, end_s, command)
    judged = "tool.displacement"
    report = {
        "scenario": str(scenario.path or scenario.name),
        "tolerance": tolerance,
        "step_s": fine.step_s,
        "wall_s": {"step": coarse.wall_s, "half_step": fine.wall_s},
        "recorded_share": end_s / scenario.duration_s,
    }
    if travels:
        # The travel is a thousand times the deflection: it would hide any error in the latter.
        judged = "tool.deflection"
        plant = Plant(model, scenario.robot)
        if isinstance(scenario.process, Milling):
            plant = Plant(model, scenario.robot, plant.rigid_posture(command.joints[0]))
        path = CommandedPath(plant, command)
        report["commanded_path"] = _path(path, plant, scenario.process)
        for one in (fine, coarse):
            _add_deflection(one.channels, one.state_time_s, path)
            one.state_names.update(compare.VECTORS[judged])
        _add_deflection(recording.channels, recording.time_s, path)
    ramp_s = scenario.process.ramp_s if isinstance(scenario.process, Chamfer) else 0.0
    left = {"reference": fine.left_cut_s, "recording": compare.left_cut_s(recording, ramp_s)}
    until_s = min((t for t in left.values() if t is not None), default=np.inf)
    report |= {
        "judged": judged,
        "left_cut_s": left,
        "halving_the_step": _halving(fine, coarse, until_s, tolerance, judged),
    }
    report |= _against(fine, recording, until_s, judged)
    if isinstance(scenario.process, Milling):
        report["growth_rate"] = _growth(scenario.process, fine, recording)
    report["failures"] = failures(report, tolerance)
    report["agrees"] = not report["failures"]
    return report


def _path(path: CommandedPath, plant: Plant, process: Wheel | Milling) -> dict:
    """What the commanded path is held to: straight, no turn (a wheel), and at the feed speed once it is run up."""
    mills = isinstance(process, Milling)
    direction = plant.axes @ np.asarray(process.direction) if mills else np.array([0.0, 1.0, 0.0])
    along = path.places_m @ direction
    steady = path.time_s >= (0.0 if mills else RUN_UP_S)
    speed = np.diff(along[steady]) / np.diff(path.time_s[steady])
    off = path.places_m - np.outer(along, direction)
    found = {
        "start (m)": (float(np.abs(path.places_m[0]).max()), PATH_TOLERANCE),
        "off its line (m)": (float(np.abs(off).max()), PATH_TOLERANCE),
        "turn of the tool (rad)": (path.rotation_rad, PATH_TOLERANCE),
        "speed over feed - 1": (float(np.abs(speed / process.feed_m_per_s - 1.0).max()), PATH_SPEED_TOLERANCE),
    }
    return {name: {"value": value, "limit": limit} for name, (value, limit) in found.items()}


def _growth(process: Milling, fine: Result, recording: compare.Recording) -> dict:
    """Growth rates (1/s) of both sides' vibration once the cut has settled, at the recording's times, by one estimator."""
    rows = (recording.time_s >= process.settled_s) & (recording.time_s <= fine.state_time_s[-1])
    time_s = recording.time_s[rows]
    names = compare.VECTORS["tool.deflection"]
    window_s = max(process.tooth_period_s, 1.0 / recording.scalars["milling.chatter_frequency"])
    args = (process.tooth_period_s, window_s, GROWTH_LINEAR_SHARE * process.feed_per_tooth_m)
    here = np.array([recording.channels[name][rows] for name in names]).T
    spline = scipy.interpolate.CubicSpline(fine.state_time_s, np.array([fine.channels[name] for name in names]).T)
    return {"recording": growth_rate(time_s, here, *args), "reference": growth_rate(time_s, spline(time_s), *args)}


def _add_deflection(channels: dict, time_s: np.ndarray, path: CommandedPath) -> None:
    """How far the arm yields: displacement less that of a rigid arm on the same command."""
    rigid = path.displacement_m(time_s)
    for i, axis in enumerate("xyz"):
        channels[f"tool.deflection_{axis}"] = channels[f"tool.displacement_{axis}"] - rigid[:, i]


def _halving(fine: Result, coarse: Result, until_s: float, tolerance: float, judged: str) -> dict:
    as_recorded = compare.Recording.of_result(coarse)
    within = as_recorded.time_s <= min(until_s, fine.state_time_s[-1])
    moved = compare.distance(fine, as_recorded, compare.VECTORS[judged], _sliding(as_recorded, within))
    found = {"nrmse": moved.nrmse, "limit": tolerance / 3.0, "counts": moved.nrmse < tolerance / 3.0}
    if "foot.sliding" in fine.channels:
        limit_s = compare.EVENT_TOLERANCE_S / 3.0
        same = compare.same_events(*_until(fine, coarse, until_s), tolerance_s=limit_s)
        found["events_moved_s"] = same["largest_difference_s"]
        found["counts"] = found["counts"] and same["same"]
    after = as_recorded.time_s > until_s
    if np.count_nonzero(after) > 100:
        moved = compare.distance(fine, as_recorded, compare.VECTORS[judged], after)
        found["rms_ratio_after"] = moved.rms_ratio
        found["counts"] = found["counts"] and abs(moved.rms_ratio - 1.0) < compare.RMS_AFTER_TOLERANCE / 3.0
    return found


def _sliding(recording: compare.Recording, within: np.ndarray) -> np.ndarray:
    """Rows of `within` in which the foot slides; all of them if it never does."""
    rows = within & compare.sliding_rows(recording)
    return rows if np.count_nonzero(rows) > 2 else within


def _until(a: Result, b: Result, until_s: float):
    parts = []
    for r in (a, b):
        rows = r.force_time_s <= until_s
        parts += [r.force_time_s[rows], r.channels["foot.sliding"][rows]]
    return parts


def _against(fine: Result, recording: compare.Recording, until_s: float, judged: str) -> dict:
    before = (recording.time_s <= until_s) & (recording.time_s <= fine.state_time_s[-1])
    after = (recording.time_s > until_s) & (recording.time_s <= fine.state_time_s[-1])
    sliding = before & compare.sliding_rows(recording)
    named = compare.quantities(fine, recording)
    found = {
        "quantities": {n: compare.distance(fine, recording, parts, before).as_dict() for n, parts in named.items()},
        "channels": {p: compare.distance(fine, recording, (p,), before).nrmse for ps in named.values() for p in ps},
        "scalars": {
            name: {"reference": value, "recording": recording.scalars[name]}
            for name, value in fine.scalars.items()
            if name in recording.scalars
        },
        "profiles": {
            name: compare.profile_distance(profile, recording.profiles[name])
            for name, profile in fine.profiles.items()
            if name in recording.profiles
        },
    }
    if "foot.sliding" in fine.channels:
        rows = fine.force_time_s <= min(until_s, float(recording.time_s[-1]))
        mine = (fine.force_time_s[rows], fine.channels["foot.sliding"][rows])
        theirs = (recording.time_s[before], recording.channels["foot.sliding"][before])
        found["stick_slip"] = compare.same_events(*mine, *theirs)
    if np.count_nonzero(sliding) > 2:
        found["while_sliding"] = compare.distance(fine, recording, named[judged], sliding).as_dict()
    if np.count_nonzero(after) > 100:
        found["after_leaving_the_cut"] = compare.distance(fine, recording, named[judged], after).as_dict()
    return found


def failures(report: dict, tolerance: float) -> list[str]:
    """Each reason why the two sides do not agree, in words."""
    found = []
    if report["recorded_share"] < 0.999:
        found.append(f"the recording ends after {report['recorded_share']:.1%} of the run")
    halving = report["halving_the_step"]
    if not halving["counts"]:
        moved = f"{halving['nrmse']:.2e} (limit {halving['limit']:.2e})"
        if "events_moved_s" in halving:
            moved += (
                f", its events by {halving['events_moved_s']:.1e} s (limit {compare.EVENT_TOLERANCE_S / 3.0:.1e} s)"
            )
        if "rms_ratio_after" in halving:
            moved += f", its RMS after leaving the cut by the factor {halving['rms_ratio_after']:.4f} (limit 1 +- 0.01)"
        found.append(f"the reference is not converged and cannot judge: halving its step moves it by {moved}")
    what = report["judged"].replace(".", " ")
    windows = {"while sliding": report.get("while_sliding"), "over the run": report["quantities"][report["judged"]]}
    for window, apart in windows.items():
        if apart and not apart["nrmse"] <= tolerance:
            found.append(f"{what} {window} differs by {apart['nrmse']:.3%} of its range, limit {tolerance:.1%}")
    events = report.get("stick_slip")
    if events and not events["same"]:
        found.append(
            f"stick and slip differ: reference {_brief(events['reference'])}, recording {_brief(events['recording'])}"
        )
    after = report.get("after_leaving_the_cut")
    if after and abs(after["rms_ratio"] - 1.0) > compare.RMS_AFTER_TOLERANCE:
        found.append(f"after the edge has left the cut the RMS ratio is {after['rms_ratio']:.4f}, limit 1 +- 0.03")
    if all(t is None for t in report["left_cut_s"].values()):
        # where an edge has left the cut, only the RMS is comparable
        for name, apart in report["profiles"].items():
            if not apart["relative_rms"] <= tolerance:
                found.append(f"{name} differs by {apart['relative_rms']:.3%} of its mean, limit {tolerance:.1%}")
    for name, path in report.get("commanded_path", {}).items():
        if not path["value"] <= path["limit"]:
            found.append(f"commanded path, {name}: {path['value']:.2e}, limit {path['limit']:.0e}")
    return found


def _brief(events) -> str:
    shown = [f"{kind} {start:.4f}-{end:.4f} s" for kind, start, end in events[:12]]
    return ", ".join(shown) + (f" and {len(events) - 12} more" if len(events) > 12 else "")


def _value(text: str):
    """A number, list or boolean as JSON writes it; anything else is a string."""
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenario", type=Path)
    parser.add_argument("--mjcf", type=Path, required=True)
    parser.add_argument("--recording", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--step-us", type=float, default=STEP_S * 1e6, help="the coarser of the two steps")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as given to `truecut run`")
    options = parser.parse_args(arguments)
    try:
        overrides = {k: _value(v) for k, v in (item.split("=", 1) for item in options.set)}
        scenario = scenario_file.load(options.scenario, overrides)
        recording = compare.Recording.read(options.recording)
        model = options.mjcf.read_text(encoding="utf-8")
        report = crosscheck(scenario, model, recording, options.step_us * 1e-6)
    except (OSError, KeyError, ValueError, NotImplementedError) as error:
        print(f"cross-check of {options.scenario}: {error}", file=sys.stderr)
        return BAD_INPUT
    options.out.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    print(table.of_report(scenario.name, report, options.out))
    return 0 if report["agrees"] else DISAGREES


if __name__ == "__main__":
    sys.exit(main())
