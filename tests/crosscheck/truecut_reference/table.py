"""A report of the cross-check as lines for a person."""

from __future__ import annotations

from pathlib import Path

from . import compare

SHOWN_EVENTS = 8


def of_report(name: str, report: dict, path: Path) -> str:
    """The verdict, what it rests on, and where the whole report lies."""
    verdict = "agrees with MuJoCo" if report["agrees"] else "DISAGREES with MuJoCo"
    lines = [name, f"  {verdict} (RK4, {report['step_s'] * 1e6:.3g} us)"]
    lines += [f"    {reason}" for reason in report["failures"]]
    lines += _aligned(_judged(report))
    lines += _events(report.get("stick_slip"))
    others = {n: d["nrmse"] for n, d in report["quantities"].items() if n != report["judged"] and not _is_part(n)}
    lines += ["  not judged, NRMSE"] + _aligned([[f"  {n}", _percent(v), ""] for n, v in others.items()])
    if report["scalars"]:
        rows = [[f"  {n}", f"{v['recording']:.6g}", f"{v['reference']:.6g}"] for n, v in report["scalars"].items()]
        lines += ["  results, SI: here, MuJoCo"] + _aligned(rows)
    return "\n".join([*lines, f"  {path}", ""])


def _judged(report: dict) -> list[list[str]]:
    """Figures that the verdict rests on, each with its limit."""
    limit = _percent(report["tolerance"])
    halving = report["halving_the_step"]
    nrmse = {report["judged"].replace(".", " "): report["quantities"][report["judged"]]["nrmse"]}
    if "while_sliding" in report:
        nrmse["  while sliding"] = report["while_sliding"]["nrmse"]
    rows = [[f"{name}, NRMSE", _percent(value), f"limit {limit}"] for name, value in nrmse.items()]
    rows.append(["  moved by halving MuJoCo's step", _percent(halving["nrmse"]), f"limit {_percent(halving['limit'])}"])
    left = min((t for t in report["left_cut_s"].values() if t is not None), default=None)
    after = report.get("after_leaving_the_cut")
    if after:
        rows.append(["  RMS after leaving the cut", f"{after['rms_ratio']:.4f}", "limit 1 +- 0.03 of MuJoCo's"])
    if left is not None:
        rows.append(["  edge leaves the cut at", f"{left:.3f} s", "all but the RMS is until then"])
    else:
        for name, apart in report["profiles"].items():
            rows.append([f"{name}, RMS over mean", _percent(apart["relative_rms"]), f"limit {limit}"])
    for name, path in report.get("commanded_path", {}).items():
        rows.append([f"commanded path, {name}", f"{path['value']:.2g}", f"limit {path['limit']:.0e}"])
    return rows


def _events(events: dict | None) -> list[str]:
    """Begin of each stick and slip on both sides, ms apart."""
    if events is None:
        return []
    if not events["same"]:
        return ["  stick and slip: see above"]
    pairs = list(zip(events["recording"], events["reference"]))
    limit_ms = compare.EVENT_TOLERANCE_S * 1e3
    lines = [f"  stick and slip: at most {events['largest_difference_s'] * 1e3:.3f} ms apart, limit {limit_ms:.0f} ms"]
    for here, there in pairs[:SHOWN_EVENTS]:
        lines.append(f"    {here[0]:5}  from {here[1]:.4f} s, MuJoCo {there[1]:.4f} s")
    if len(pairs) > SHOWN_EVENTS:
        lines.append(f"    and {len(pairs) - SHOWN_EVENTS} more")
    return lines


def _is_part(name: str) -> bool:
    """Whether a quantity is one joint: too many to show; the report's file has them."""
    return name.startswith("joint")


def _percent(value: float) -> str:
    return f"{100.0 * value:.3g} %"


def _aligned(rows: list[list[str]]) -> list[str]:
    if not rows:
        return []
    widths = [max(len(row[i]) for row in rows) for i in range(2)]
    return [f"  {row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]}".rstrip() for row in rows]
