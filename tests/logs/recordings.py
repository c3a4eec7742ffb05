"""Recordings of robots as their makers' interfaces write them, and the two that lie here: `python recordings.py`."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def write_rtde(file: Path, fields: dict[str, np.ndarray], delimiter: str = " ") -> None:
    """As the client library of Universal Robots writes them (csv_writer.py): a header and a row a sample by Python's
    csv, delimited by blanks, elements of vectors numbered from 0; as other clients do with commas."""
    names, columns = [], []
    for name, values in fields.items():
        if values.ndim == 1:
            names.append(name)
            columns.append(values.tolist())
            continue
        for index, column in enumerate(values.T):
            names.append(f"{name}_{index}")
            columns.append(column.tolist())
    with file.open("w", newline="") as out:
        rows = csv.writer(out, delimiter=delimiter)
        rows.writerow(names)
        rows.writerows(zip(*columns))


def write_rsi(
    file: Path,
    ipoc_ms: np.ndarray,
    elements: dict[str, dict[str, np.ndarray]],
    answers: dict[str, dict[str, np.ndarray]] | None = None,
    lead: str = "",
) -> None:
    """As the computer at the other end of RSI logs them: telegrams `<Rob>`, each with its answer `<Sen>`."""

    def inside(elements: dict[str, dict[str, np.ndarray]], row: int) -> str:
        said = (
            f"<{tag} " + " ".join(f'{key}="{float(values[row])!r}"' for key, values in attributes.items()) + " />"
            for tag, attributes in elements.items()
        )
        return "".join(said)

    with file.open("w") as out:
        for row, ipoc in enumerate(ipoc_ms):
            body = inside(elements, row)
            out.write(f'{lead}<Rob Type="KUKA">{body}<Delay D="0" /><IPOC>{int(ipoc)}</IPOC></Rob>\n')
            if answers:
                body = inside(answers, row)
                out.write(f'<Sen Type="ImFree"><EStr>a text</EStr>{body}<IPOC>{int(ipoc)}</IPOC></Sen>\n')


def axes(values: np.ndarray) -> dict[str, np.ndarray]:
    """Columns as A1, A2, …"""
    return {f"A{k}": column for k, column in enumerate(values.T, 1)}


if __name__ == "__main__":
    time = np.arange(60) * 0.008
    q = 0.1 * np.sin(2 * time[:, None] + np.arange(6))
    force = np.hstack([20 + q[:, :3], q[:, 3:]]).round(4)
    write_rtde(HERE / "ur_rtde.csv", {"timestamp": 100 + time, "actual_q": q.round(6), "actual_TCP_force": force})
    place = dict(zip("XYZABC", np.hstack([900 + 50 * q[:, :3], 90 + q[:, 3:]]).round(3).T))
    elements = {"RIst": place, "AIPos": axes(np.degrees(q).round(4)), "MACur": axes(q.round(3))}
    answers = {"RKorr": {"X": q[:, 0].round(3)}}
    write_rsi(HERE / "kuka_rsi.xml", 4208163634 + 12 * np.arange(60), elements, answers)
