"""MATLAB and HDF5 files as tables of measured data.

    python -m truecut.convert run.mat -o run.parquet
    python -m truecut.convert run.h5 --select force q --time t -o run.csv

Each array of numbers becomes a column, called by its dotted path (`drive.force`), each column of a matrix one of its
own (`q_1`, `q_2`, ...). MAT files up to version 7 need SciPy, those of version 7.3 and HDF5 files need h5py, Parquet
needs pyarrow: `pip install "truecut[convert]"` has them all. Nothing is imported before it is used.

Numbers alone are read: no pickles, objects or functions, and nothing that lies in another file.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from truecut._arrays import PIP, ConvertError, Found, found_in, needed

if TYPE_CHECKING:
    import numpy as np

__all__ = ["ConvertError", "Table", "convert"]

TIMES = ("t", "time", "timestamp", "stamp", "zeit", "zeitstempel", "tout")
UNITS_OF_TIMES = ("_s", "_ms", "_us", "_ns")
# A file of a few bytes can claim an array of any size: 2 GB of 64-bit numbers.
MOST_NUMBERS = 1 << 28
MOST_COLUMNS = 4096
LISTED = 40


class Table(NamedTuple):
    """What is written: names and columns, the units that the file gives, the column of times, and what was left out."""

    columns: dict[str, np.ndarray]
    units: dict[str, str]
    time: str | None
    notes: list[str]


def chosen(found: list[Found], asked: Sequence[str]) -> list[Found]:
    """What is asked for: arrays by their paths, or all in a struct or group."""
    picked: dict[str, Found] = {}
    for path in asked:
        plain = path.strip("/").replace("/", ".")
        inside = [one for one in found if one.path in (path, plain) or one.path.startswith(plain + ".")]
        if not inside:
            raise ConvertError(f'there is no "{path}" in it', listed(found))
        exact = next((one for one in inside if one.path in (path, plain)), None)
        if exact and exact.read is None:
            raise ConvertError(f'"{exact.path}" {exact.why}', listed(found))
        numbers = [one for one in inside if one.read]
        if not numbers:
            raise ConvertError(f'"{path}" holds no numbers: {inside[0].path} {inside[0].why}', listed(found))
        picked.update((one.path, one) for one in numbers)
    return list(picked.values())


def listed(found: Iterable[Found]) -> str:
    """The paths of what could be asked for."""
    paths = [f"{one.path} ({' x '.join(map(str, one.shape))})" for one in found if one.read]
    more = f" and {len(paths) - LISTED} more" if len(paths) > LISTED else ""
    return "arrays of numbers in it: " + (", ".join(paths[:LISTED]) or "none") + more


def is_vector(one: Found) -> bool:
    """Whether it is one column, upright or lying."""
    return len(one.shape) == 1 or (len(one.shape) == 2 and 1 in one.shape)


def length(one: Found) -> int:
    """Its rows, where there is no time to go by: the longer side."""
    return max(one.shape, default=1)


def values_of(one: Found) -> np.ndarray:
    """Its numbers, in types that a table holds."""
    count = 1
    for side in one.shape:
        count *= side
    if count > MOST_NUMBERS:
        raise ConvertError(f'"{one.path}" has {count} numbers; up to {MOST_NUMBERS} are read')
    try:
        values = one.read()
    except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
        raise ConvertError(f'"{one.path}" cannot be read: {error}') from error
    kind = values.dtype.kind
    if kind == "b":
        return values.astype("u1")
    # of half and of extended precision, too
    wide = kind == "f" and values.dtype.itemsize != 4
    return values.astype("f8" if wide else values.dtype.newbyteorder("="))


def times_of(found: list[Found], picked: list[Found], asked: str | None) -> tuple[Found | None, np.ndarray | None]:
    """The times, by their path or by their name; they must rise."""
    if asked is not None:
        (one, *more) = chosen(found, [asked])
        if more or not is_vector(one):
            raise ConvertError(f'--time "{asked}" is no single column', listed(found))
        values = values_of(one).reshape(-1)
        fall = falls(values)
        if fall is not None:
            pair = f"value {fall + 2} is {values[fall + 1]}, not after {values[fall]}"
            raise ConvertError(f'--time "{asked}" does not rise: {pair}')
        return one, values
    lengths = {side for one in picked for side in one.shape}
    called = [one for one in found if one.read and is_vector(one) and is_called_time(one) and length(one) in lengths]
    read = [(one, values_of(one).reshape(-1)) for one in called]
    rising = [(one, values) for one, values in read if values.size > 1 and falls(values) is None]
    if len(rising) > 1:
        names = ", ".join(one.path for one, _ in rising)
        raise ConvertError(f"several columns could be the times: {names}", "say which: --time PATH")
    return rising[0] if rising else (None, None)


def is_called_time(one: Found) -> bool:
    """Whether its last name is one of times, with or without a unit."""
    name = one.path.rsplit(".", 1)[-1].lower()
    bare = next((name.removesuffix(unit) for unit in UNITS_OF_TIMES if name.endswith(unit)), name)
    return bare in TIMES


def falls(values: np.ndarray) -> int | None:
    """The first value that no later one follows."""
    rises = values[1:] > values[:-1]
    return None if rises.all() else int((~rises).argmax())


def table_of(found: list[Found], select: Sequence[str] = (), time: str | None = None) -> Table:
    """Columns of one length."""
    picked = chosen(found, select) if select else [one for one in found if one.read]
    if not picked:
        reasons = "; ".join(f'"{one.path}" {one.why}' for one in found[:LISTED])
        raise ConvertError("there are no numbers in it" + (f": {reasons}" if reasons else ""))
    clock, times = times_of(found, picked, time)
    notes = [f'"{one.path}" {one.why}' for one in found if one.read is None and not select]
    others = [one for one in picked if one is not clock]
    rows = len(times) if times is not None else None
    if rows is None:
        lengths = {one.path: length(one) for one in others if select or length(one) > 1}
        if len(set(lengths.values())) > 1:
            told = ", ".join(f"{path} has {count}" for path, count in list(lengths.items())[:LISTED])
            help = "choose some of one length: --select PATH ..."
            raise ConvertError(f"columns are of different length: {told}", help)
        rows = next(iter(lengths.values()), 1)
    columns: dict[str, np.ndarray] = {} if clock is None else {clock.path: times}
    units = {} if clock is None or clock.unit is None else {clock.path: clock.unit}
    for one in others:
        if rows not in one.shape:
            if select:
                against = f"the times {clock.path} have" if clock else "others have"
                shape = " x ".join(map(str, one.shape)) or "1"
                raise ConvertError(f'columns are of different length: "{one.path}" is {shape}, {against} {rows} rows')
            notes.append(f'"{one.path}" has not {rows} rows, but {length(one)}')
            continue
        add(one, rows, columns, units)
    if len(columns) == (clock is not None):
        beside = f'but the times "{clock.path}" ' if clock else ""
        raise ConvertError(f"nothing {beside}has {rows} rows", listed(found))
    return Table(columns, units, clock and clock.path, notes)


def add(one: Found, rows: int, columns: dict[str, np.ndarray], units: dict[str, str]) -> None:
    """The columns of an array."""
    values = values_of(one)
    if is_vector(one):
        parts = {one.path: values.reshape(-1)}
    else:
        upright = values if values.shape[0] == rows else values.T
        parts = {f"{one.path}_{k}": column for k, column in enumerate(upright.T, 1)}
    if len(columns) + len(parts) > MOST_COLUMNS:
        raise ConvertError(f'with "{one.path}" there are more than {MOST_COLUMNS} columns', "choose: --select PATH ...")
    for name, column in parts.items():
        if name in columns:
            raise ConvertError(f'two columns are called "{name}"', "choose one: --select PATH ...")
        columns[name] = column
        if one.unit:
            units[name] = one.unit


def write(table: Table, target: Path) -> None:
    """A Parquet or CSV file, which replaces what was there as a whole."""
    writers = {".parquet": write_parquet, ".csv": write_csv}
    writer = writers.get(target.suffix.lower())
    if writer is None:
        raise ConvertError(f"{target}: what is written ends in .parquet or .csv")
    try:
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=".converted-") as folder:
            aside = Path(folder) / target.name
            writer(table, aside)
            os.replace(aside, target)
    except OSError as error:
        raise ConvertError(f"{target}: cannot be written: {error.strerror or error}") from error


def write_parquet(table: Table, path: Path) -> None:
    """Units are in the fields' metadata, where `truecut data` finds them."""
    pyarrow = needed("pyarrow", "a Parquet file")
    arrays = [pyarrow.array(column) for column in table.columns.values()]
    fields = [
        pyarrow.field(name, array.type, metadata={"unit": table.units[name]} if name in table.units else None)
        for name, array in zip(table.columns, arrays)
    ]
    needed("pyarrow.parquet", "a Parquet file").write_table(
        pyarrow.table(arrays, schema=pyarrow.schema(fields)), path, compression="zstd"
    )


def write_csv(table: Table, path: Path) -> None:
    """Names, a row of units where the file gives any, and the numbers as short as they stay the same."""
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(table.columns)
        if table.units:
            rows.writerow(f"[{table.units[name]}]" if name in table.units else "" for name in table.columns)
        rows.writerows(zip(*(column.tolist() for column in table.columns.values())))


def convert(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str] | None = None,
    *,
    select: Sequence[str] = (),
    time: str | None = None,
) -> Table:
    """Converts a MAT or HDF5 file and gives what was written to `target` (beside it, as .parquet, without).

    `select`: paths of arrays, structs or groups; all arrays that go together, without. `time`: path of the times.
    Raises `ConvertError`.
    """
    source = Path(source)
    target = source.with_suffix(".parquet") if target is None else Path(target)
    table = table_of(found_in(source), select, time)
    write(table, target)
    return table


def lines_of(table: Table, target: Path) -> list[str]:
    """What was done."""
    rows = len(next(iter(table.columns.values())))
    without = "no column of times was found: --time PATH, or `rate_hz` in [data]"
    times = f"times: {table.time}" if table.time else without
    left = [f"left out: {note}" for note in table.notes[:LISTED]]
    if len(table.notes) > LISTED:
        left.append(f"left out: {len(table.notes) - LISTED} more")
    head = f"{target}: {rows} rows, {len(table.columns)} columns"
    return [head, *(f"  {line}" for line in [times, *left]), f"`truecut data {target}` says how a scenario reads it"]


def parser() -> argparse.ArgumentParser:
    """Arguments of the command line."""
    about = "Makes a table of measured data of a MATLAB (.mat) or HDF5 file, as `truecut data` and [data] read it."
    after = f"Numbers alone are read: no objects, no pickles, no links. Packages: {PIP}"
    made = argparse.ArgumentParser(prog="python -m truecut.convert", description=about, epilog=after)
    made.add_argument("file", type=Path, help="a .mat file of any version, or an HDF5 file")
    made.add_argument("-o", "--output", type=Path, metavar="FILE", help=".parquet or .csv; default: FILE.parquet")
    made.add_argument("--time", metavar="PATH", help="the times; default: what is called t, time, ... and rises")
    made.add_argument(
        "--select",
        metavar="PATH",
        nargs="+",
        action="extend",
        default=[],
        help="arrays, structs or groups, such as run.force; default: all that have as many rows as there are times",
    )
    made.add_argument("--list", action="store_true", help="list what is in the file, and write nothing")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code: 0, or 2 if something is wrong with the file or what is asked of it."""
    given = parser().parse_args(arguments)
    try:
        if given.list:
            for one in found_in(given.file):
                shape = " x ".join(map(str, one.shape)) or "1"
                print(f"{one.path}  {shape}{f'  [{one.unit}]' if one.unit else ''}{f'  {one.why}' if one.why else ''}")
            return 0
        table = convert(given.file, given.output, select=given.select, time=given.time)
    except ConvertError as error:
        print(f"error: {given.file}: {error}", file=sys.stderr)
        if error.help:
            print(f"  help: {error.help}", file=sys.stderr)
        return 2
    print("\n".join(lines_of(table, given.output or given.file.with_suffix(".parquet"))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
