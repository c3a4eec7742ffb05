"""MATLAB and HDF5 files of other people's writers become tables that truecut reads as it reads CSV."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
from built import PROGRAM, ROOT, python, with_arrays  # noqa: F401

SEEDS = range(2)
ELBOW = ROOT / "scenarios" / "diagnosis" / "elbow.csv"
# written by MATLAB 4.2 to 7.4 on four machines: SciPy's own cases
OF_MATLAB = Path(scipy.io.__file__).parent / "matlab" / "tests" / "data"


def convert(python: Path, *arguments: object, code: int = 0) -> subprocess.CompletedProcess[str]:
    """Runs `python -m truecut.convert`."""
    command = [python, "-m", "truecut.convert", *map(str, arguments)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert ended.returncode == code, ended.stdout + ended.stderr
    assert "Traceback" not in ended.stderr, ended.stderr
    return ended


def program(*arguments: object) -> str:
    """Runs truecut."""
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=True).stdout


def read(file: Path) -> dict[str, np.ndarray]:
    """A table that was written, by column."""
    if file.suffix == ".csv":
        names = file.read_text().splitlines()[0].split(",")
        rows = [line.split(",") for line in file.read_text().splitlines()[1:]]
        rows = [row for row in rows if "[" not in "".join(row)]
        return dict(zip(names, np.array(rows, float).T))
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(file)
    return {name: table[name].to_numpy() for name in table.column_names}


def write_mat_73(file: Path, variables: dict) -> None:
    """A MAT file of version 7.3: HDF5 behind 512 bytes of MATLAB's, arrays lying, classes as attributes."""
    with h5py.File(file, "w", userblock_size=512) as made:

        def put(group: h5py.Group, name: str, value: object) -> None:
            if isinstance(value, dict):
                inside = group.create_group(name)
                inside.attrs["MATLAB_class"] = np.bytes_("struct")
                for key, one in value.items():
                    put(inside, key, one)
            elif isinstance(value, list):
                refs = made.require_group("#refs#")
                held = [refs.create_dataset(f"{name}{k}", data=one) for k, one in enumerate(value)]
                cell = group.create_dataset(name, data=np.array([[one.ref] for one in held], dtype=h5py.ref_dtype))
                cell.attrs["MATLAB_class"] = np.bytes_("cell")
            elif isinstance(value, str):
                letters = np.frombuffer(value.encode("utf-16-le"), "u2").reshape(-1, 1)
                group.create_dataset(name, data=letters).attrs["MATLAB_class"] = np.bytes_("char")
            else:
                value = np.atleast_2d(value)
                kind = {"f": "double", "b": "logical"}.get(value.dtype.kind, value.dtype.name)
                stored = value.astype("u1") if kind == "logical" else value
                group.create_dataset(name, data=stored.T).attrs["MATLAB_class"] = np.bytes_(kind)

        for name, value in variables.items():
            put(made, name, value)
    text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Fri Nov 27 10:00:00 2026 HDF5 schema 1.00 ."
    with file.open("r+b") as raw:
        raw.write(text.ljust(116) + bytes(8) + b"\x00\x02IM")


def write_hdf5(file: Path, variables: dict) -> None:
    """The same as plain HDF5, with groups for structs."""

    def put(group: h5py.Group, variables: dict) -> None:
        for name, value in variables.items():
            if isinstance(value, dict):
                put(group.create_group(name), value)
            elif not isinstance(value, list):
                group.create_dataset(name, data=value)

    with h5py.File(file, "w") as made:
        put(made, variables)


WRITERS = {
    "5.mat": lambda file, held: scipy.io.savemat(file, {k: as_cell(v) for k, v in held.items()}),
    "5z.mat": lambda file, held: scipy.io.savemat(
        file, {k: as_cell(v) for k, v in held.items()}, do_compression=True, oned_as="column"
    ),
    "73.mat": write_mat_73,
    "plain.h5": write_hdf5,
}


def as_cell(value: object) -> object:
    """A list as SciPy takes a cell array."""
    if not isinstance(value, list):
        return value
    cell = np.empty(len(value), object)
    cell[:] = value
    return cell


def test_what_is_not_installed_is_named(python, tmp_path):  # noqa: F811
    """Nothing is imported before it is used; then the line for pip is said."""
    if next((python.parents[1] / "lib").rglob("of_tests.pth"), None):
        pytest.skip("another test has put packages beside it")
    scipy.io.savemat(tmp_path / "run.mat", {"x": np.arange(5.0)})
    write_hdf5(tmp_path / "run.h5", {"x": np.arange(5.0)})
    assert "--select" in convert(python, "--help").stdout
    for file, package in (("run.mat", "scipy"), ("run.h5", "h5py")):
        said = convert(python, tmp_path / file, code=2).stderr
        assert f"needs {package}, which is not installed" in said and 'pip install "truecut[convert]"' in said


@pytest.mark.parametrize("ending", ["parquet", "csv"])
@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("seed", SEEDS)
def test_numbers_come_back_to_the_bit(seed, kind, ending, with_arrays, tmp_path):  # noqa: F811
    """Scalars, texts, cells and parameters of another length beside columns, upright and lying matrices, structs."""
    draw = np.random.default_rng(seed)
    rows = int(draw.integers(30, 200))
    time = np.cumsum(draw.uniform(1e-3, 2e-3, rows))
    force, q = draw.normal(0, 1e3, rows), draw.normal(0, 1, (rows, int(draw.integers(2, 8))))
    currents, counts = draw.normal(0, 5, (6, rows)), draw.integers(-(2**30), 2**30, rows).astype("i4")
    force[draw.integers(rows)] = np.nan
    run = {"t": time, "force": force, "deep": {"q": q}, "currents": currents}
    held = {"run": run, "counts": counts, "gain": 3.5, "note": "a text", "cells": [np.arange(3.0), np.arange(4.0)]}
    file, out = tmp_path / f"file_{kind}", tmp_path / f"out.{ending}"
    WRITERS[kind](file, held)
    told = convert(with_arrays, file, "-o", out).stdout
    assert "times: run.t\n" in told and '"gain" has not' in told, told
    assert kind == "plain.h5" or '"cells" is a cell array' in told, told
    columns = read(out)
    expected = {"run.t": time, "run.force": force, "counts": counts.astype(float)}
    expected |= {f"run.deep.q_{k + 1}": q[:, k] for k in range(q.shape[1])}
    expected |= {f"run.currents_{k + 1}": currents[k] for k in range(6)}
    assert list(columns)[0] == "run.t" and set(columns) == set(expected)
    for name, values in expected.items():
        assert np.array_equal(columns[name].astype(float), values, equal_nan=True), name
    found = json.loads(program("data", out, "--json"))["tables"][0]
    assert found["rows"] == rows and found["time"]["column"] == "run.t"
    if ending == "csv":
        return
    # chosen, by dots or by slashes, a struct or an array
    chosen = tmp_path / f"chosen.{ending}"
    convert(with_arrays, file, "-o", chosen, "--select", "run/deep", "counts", "--time", "run/t")
    assert set(read(chosen)) == {name for name in expected if "deep" in name or name in ("counts", "run.t")}


def elbow_as(kind: str, python: Path, folder: Path) -> Path:
    """The measurements of the shipped scenario, written as such a file and converted."""
    names = ELBOW.read_text().splitlines()[0].split(",")
    values = np.loadtxt(ELBOW, delimiter=",", skiprows=1)
    file, out = folder / f"elbow_{kind}", folder / "elbow.parquet"
    WRITERS[kind](file, {name: column for name, column in zip(names, values.T)})
    convert(python, file, "-o", out)
    return out


@pytest.mark.parametrize("kind", WRITERS)
def test_a_comparison_is_that_of_the_csv(kind, with_arrays, tmp_path):  # noqa: F811
    told = []
    for data in (ELBOW, elbow_as(kind, with_arrays, tmp_path)):
        folder = tmp_path / data.suffix[1:]
        program("compare", ELBOW.with_suffix(".toml"), "--data", data, "--out", folder)
        (report,) = folder.rglob("compare.json")
        told.append(json.loads(report.read_text().replace(str(data), "DATA"))["channels"])
    assert told[0] and told[0] == told[1]


@pytest.mark.parametrize("kind", ["5z.mat", "73.mat", "plain.h5"])
def test_a_diagnosis_is_that_of_the_csv(kind, with_arrays, of_csv, tmp_path):  # noqa: F811
    """The numbers are the same to the bit, and so is what is said of them."""
    told = diagnosed(elbow_as(kind, with_arrays, tmp_path), tmp_path / "out")
    assert told == of_csv and told["verdict"] == "named" and told["causes"]


def diagnosed(data: Path, out: Path) -> dict:
    """What a diagnosis of these measurements says, but for where they lie."""
    program("diagnose", ELBOW.with_suffix(".toml"), "--data", data, "--out", out)
    (report,) = out.rglob("diagnosis.json")
    told = json.loads(report.read_text())
    return {key: told[key] for key in ("verdict", "causes")}


@pytest.fixture(scope="module")
def of_csv(tmp_path_factory) -> dict:
    return diagnosed(ELBOW, tmp_path_factory.mktemp("csv"))


def test_what_matlab_wrote_is_read(with_arrays, tmp_path):  # noqa: F811
    """Files of MATLAB itself, of version 4 to 7.3."""
    angle = np.arange(9) * np.pi / 4
    files = sorted(OF_MATLAB.glob("testdouble_*.mat")) + [OF_MATLAB / "testhdf5_7.4_GLNX86.mat"]
    assert len(files) >= 5
    for file in files:
        out = tmp_path / f"{file.stem}.csv"
        convert(with_arrays, file, "-o", out)
        (values,) = read(out).values()
        assert np.allclose(values, angle, rtol=0, atol=1e-15), file.name
    nested = convert(with_arrays, OF_MATLAB / "teststruct_7.4_GLNX86.mat", "--list").stdout
    assert "teststruct.doublefield  1 x 3" in nested and "holds complex numbers" in nested, nested


def test_units_of_hdf5_are_kept(with_arrays, tmp_path):  # noqa: F811
    """In the fields of Parquet and in the row of units of CSV; a scenario that contradicts them is refused."""
    file = tmp_path / "run.h5"
    records = np.zeros(50, [("speed", "f4"), ("pair", "f8", 2)])
    records["pair"] = np.arange(100.0).reshape(50, 2)
    with h5py.File(file, "w") as made:
        made["time"] = np.arange(50) * 4.0
        made["time"].attrs["units"] = "ms"
        made["force"] = np.sin(np.arange(50))
        made["force"].attrs["unit"] = "kN"
        made["records"] = records
    for ending in ("parquet", "csv"):
        out = tmp_path / f"out.{ending}"
        convert(with_arrays, file, "-o", out)
        assert list(read(out)) == ["time", "force", "records.speed", "records.pair_1", "records.pair_2"]
        found = json.loads(program("data", out, "--json"))["tables"][0]
        assert found["time"]["unit"] == "ms" and abs(found["time"]["rate_hz"] - 250) < 1e-9
        assert found["columns"][0] | {"unit": "kN"} == found["columns"][0]


def test_nothing_outside_the_file_is_read(with_arrays, tmp_path):  # noqa: F811
    """Links and datasets that lead into other files, and circles."""
    other = tmp_path / "other.h5"
    with h5py.File(other, "w") as made:
        made["secret"] = np.arange(20.0)
    (tmp_path / "raw.bin").write_bytes(np.arange(20.0).tobytes())
    file = tmp_path / "run.h5"
    with h5py.File(file, "w") as made:
        made["t"] = np.arange(20.0)
        made["group/x"] = np.arange(20.0) ** 2
        made["group/again"] = made["/"]
        made["linked"] = h5py.ExternalLink("other.h5", "/secret")
        made["soft"] = h5py.SoftLink("/linked")
        made["dangling"] = h5py.SoftLink("/nowhere")
        layout = h5py.VirtualLayout((20,), "f8")
        layout[:] = h5py.VirtualSource(str(other), "secret", (20,))
        made.create_virtual_dataset("virtual", layout)
        made.create_dataset("raw", (20,), "f8", external=[(str(tmp_path / "raw.bin"), 0, 160)])
    out = tmp_path / "out.parquet"
    told = convert(with_arrays, file, "-o", out).stdout
    assert set(read(out)) == {"t", "group.x"}
    for name in ("linked", "soft", "dangling", "virtual", "raw"):
        assert f'left out: "{name}" ' in told, told
        assert f'"{name}" ' in convert(with_arrays, file, "-o", out, "--select", name, code=2).stderr


def faults(folder: Path) -> list[tuple[list[object], list[str]]]:
    """Arguments, and what must be said of them."""
    rows = np.arange(40.0)
    held = {"t": rows, "force": rows**2, "short": rows[:30], "cell": as_cell([rows, rows])}
    mat = folder / "run.mat"
    scipy.io.savemat(mat, held)
    deep = folder / "run.h5"
    with h5py.File(deep, "w") as made:
        made["a/t"], made["a/time_s"], made["a/force"], made["b/falls"] = rows, rows, rows, -rows
        made["z"], made["cube"], made["name"] = rows * 1j, np.zeros((2, 3, 4)), "text"
        made.create_dataset("vast", (1 << 40,), "f8", chunks=(1 << 20,))
    torn, wrong, text = folder / "torn.h5", folder / "wrong.mat", folder / "run.csv"
    torn.write_bytes(deep.read_bytes()[:700])
    wrong.write_bytes(mat.read_bytes()[:300])
    text.write_text("t,x\n1,2\n")
    named = folder / "no.h5"
    named.write_text("no HDF5 file")
    return [
        ([mat, "--select", "cell"], ['"cell" is a cell array, not numbers', "t (1 x 40), force (1 x 40)"]),
        ([mat, "--select", "forse"], ['there is no "forse" in it', "force (1 x 40)"]),
        ([mat, "--select", "force", "short"], ["columns are of different length", '"short" is 1 x 30', "40 rows"]),
        ([mat, "--time", "none"], ['there is no "none" in it']),
        ([mat, "-o", folder / "out.xlsx"], ["out.xlsx", "ends in .parquet or .csv"]),
        ([mat, "-o", folder / "absent" / "out.csv"], ["cannot be written"]),
        ([deep], ["several columns could be the times: a.t, a.time_s", "--time PATH"]),
        ([deep, "--select", "b/none"], ['there is no "b/none" in it', "a.force (40)"]),
        ([deep, "--select", "z"], ['"z" holds complex numbers']),
        ([deep, "--select", "cube"], ['"cube" has 3 axes']),
        ([deep, "--select", "name"], ['"name" holds texts']),
        ([deep, "--select", "a", "--time", "b.falls"], ['--time "b.falls" does not rise: value 2 is -1.0, not after']),
        ([deep, "--select", "a", "--time", "a"], ['--time "a" is no single column']),
        ([deep, "--select", "vast", "--time", "vast"], ["has 1099511627776 numbers; up to 268435456 are read"]),
        ([torn], ["torn.h5: cannot be read as an HDF5 file"]),
        ([wrong], ["wrong.mat: cannot be read as a MAT file"]),
        ([named], ["it is no HDF5 file"]),
        ([text], ["it is neither a MAT nor an HDF5 file", "`truecut data` reads CSV"]),
        ([folder / "missing.mat"], ["missing.mat: cannot be read: No such file"]),
        ([folder], ["cannot be read"]),
    ]


def test_errors_name_file_place_and_rule(with_arrays, tmp_path):  # noqa: F811
    for arguments, said in faults(tmp_path):
        ended = convert(with_arrays, *arguments, code=2)
        assert ended.stderr.startswith(f"error: {arguments[0]}: "), ended.stderr
        for part in said:
            assert part in ended.stderr, (arguments, ended.stderr)
    scipy.io.savemat(tmp_path / "lone.mat", {"a": np.arange(5.0), "b": np.arange(6.0)})
    said = convert(with_arrays, tmp_path / "lone.mat", code=2).stderr
    assert "columns are of different length: a has 5, b has 6" in said and "--select" in said, said
    assert not [*tmp_path.glob("*.parquet"), *tmp_path.glob(".converted-*")]
