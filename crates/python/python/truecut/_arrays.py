"""What MAT and HDF5 files hold: the part of `truecut.convert` that reads."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np

PIP = 'pip install "truecut[convert]"'
# What begins a file. MATLAB 7.3 puts 512 bytes of its own before the HDF5 file.
HDF5 = b"\x89HDF\r\n\x1a\n"
MAT_73 = b"MATLAB 7.3"
# Deeper than people nest structs, shallower than Python recurses.
DEEPEST = 32


class ConvertError(Exception):
    """What cannot be converted. `help`: what to do about it, or None."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help


class Found(NamedTuple):
    """Something that a file holds. `read` gives its numbers, the first axis that of MATLAB's rows; without, `why`."""

    path: str
    shape: tuple[int, ...]
    unit: str | None = None
    read: Callable[[], np.ndarray] | None = None
    why: str = ""


def needed(module: str, what: str) -> Any:
    """A module of the extra, imported on its first use."""
    try:
        return import_module(module)
    except ImportError as error:
        package = module.split(".")[0]
        raise ConvertError(f"{what} needs {package}, which is not installed ({error})", PIP) from error


def found_in(path: Path) -> list[Found]:
    """What a MAT or HDF5 file holds, in its order."""
    try:
        with path.open("rb") as file:
            head = file.read(1024)
    except OSError as error:
        raise ConvertError(f"cannot be read: {error.strerror or error}") from error
    is_hdf5 = head.startswith(HDF5) or head[512:].startswith(HDF5)
    if not is_hdf5 and path.suffix.lower() in (".h5", ".hdf5", ".hdf", ".nc"):
        raise ConvertError("it is no HDF5 file, whatever its name says")
    if is_hdf5 or head.startswith(MAT_73):
        return in_hdf5(path, is_matlab=head.startswith(MAT_73))
    if path.suffix.lower() == ".mat":
        return in_mat(path)
    help = "`truecut data` reads CSV, Parquet, Arrow and MCAP as they are"
    raise ConvertError("it is neither a MAT nor an HDF5 file", help)


def in_mat(path: Path) -> list[Found]:
    """Up to version 7."""
    loadmat = needed("scipy.io", "a MAT file").loadmat
    try:
        held = loadmat(path, mat_dtype=False, struct_as_record=True)
    except Exception as error:  # damaged files raise errors of every kind in SciPy
        raise ConvertError(f"cannot be read as a MAT file: {error or type(error).__name__}") from error
    found: list[Found] = []
    for name, value in held.items():
        if not name.startswith("__"):
            of_mat(name, value, found, 0)
    return found


def of_mat(path: str, value: Any, found: list[Found], depth: int) -> None:
    """A variable or a field, and what is in it."""
    shape = tuple(getattr(value, "shape", ()))
    names = getattr(getattr(value, "dtype", None), "names", None)
    kind = type(value).__name__
    if kind in ("MatlabOpaque", "MatlabFunction", "MatlabObject") or hasattr(value, "classname"):
        found.append(Found(path, shape, why="is an object or a function of MATLAB, not numbers"))
    elif hasattr(value, "tocsc"):
        found.append(Found(path, shape, why="is a sparse matrix"))
    elif names is not None and depth < DEEPEST:
        for index, one in enumerate(value.flat, 1):
            inside = path if value.size == 1 else f"{path}.{index}"
            for name in names:
                of_mat(f"{inside}.{name}", one[name], found, depth + 1)
    elif names is not None:
        found.append(Found(path, shape, why=f"is nested deeper than {DEEPEST}"))
    elif value.dtype == object:
        found.append(Found(path, shape, why="is a cell array, not numbers"))
    else:
        found.append(of_numbers(path, shape, value.dtype, None, lambda: value))


def of_numbers(path: str, shape: tuple[int, ...], dtype: Any, unit: str | None, read: Callable) -> Found:
    """An array, if it holds real numbers of no more than two axes."""
    if dtype.kind == "c" or dtype.names is not None:
        why = "holds complex numbers or records"
    elif dtype.kind not in "fiub":
        why = "holds texts or bytes, not numbers"
    elif len(shape) > 2:
        why = f"has {len(shape)} axes; columns and matrices are converted"
    else:
        return Found(path, shape, unit, read)
    return Found(path, shape, why=why)


def in_hdf5(path: Path, is_matlab: bool) -> list[Found]:
    """HDF5, and MAT of version 7.3, whose arrays lie the other way round."""
    h5py = needed("h5py", "an HDF5 file (MAT files of version 7.3 are such)")
    walk = Walk(h5py, path, is_matlab, [], {})
    try:
        with h5py.File(path, "r") as file:
            walk.seen[h5py.h5o.get_info(file.id).addr] = "/"
            walk.group(file, "")
    except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
        raise ConvertError(f"cannot be read as an HDF5 file: {error}") from error
    return walk.found


class Walk(NamedTuple):
    """A walk through an HDF5 file. `seen`: the path of each object, by its address."""

    h5py: Any
    file: Path
    is_matlab: bool
    found: list[Found]
    seen: dict[int, str]

    def group(self, group: Any, above: str) -> None:
        """What hard links lead to; all others may lead into other files, or in circles."""
        for name in group:
            path = f"{above}.{name}" if above else name
            # MATLAB's own: what cells refer to
            if name.startswith("#") and self.is_matlab and not above:
                continue
            link = group.get(name, getlink=True)
            if isinstance(link, self.h5py.HardLink):
                self.object(group[name], path)
                continue
            of_file = f"{link.filename}:" if isinstance(link, self.h5py.ExternalLink) else ""
            self.leave(path, f'is a link to "{of_file}{link.path}"; links are not followed')

    def object(self, one: Any, path: str) -> None:
        """A group or a dataset."""
        address = self.h5py.h5o.get_info(one.id).addr
        if address in self.seen:
            self.leave(path, f'is "{self.seen[address]}" once more')
            return
        self.seen[address] = path
        kind = text(one.attrs.get("MATLAB_class")) if self.is_matlab else None
        if isinstance(one, self.h5py.Dataset):
            self.dataset(one, path, kind)
        elif kind not in (None, "struct"):
            self.leave(path, f"is of MATLAB's class {kind}, not numbers")
        elif path.count(".") >= DEEPEST:
            self.leave(path, f"is nested deeper than {DEEPEST}")
        elif isinstance(one, self.h5py.Group):
            self.group(one, path)

    def dataset(self, one: Any, path: str, kind: str | None) -> None:
        """A dataset; its numbers are read when they are asked for."""
        shape = tuple(one.shape or ())
        if one.is_virtual or one.external:
            self.leave(path, "lies in other files, which are not read", shape)
        elif kind == "cell":
            self.leave(path, "is a cell array, not numbers", shape)
        elif one.attrs.get("MATLAB_empty", 0):
            self.leave(path, "is empty")
        elif kind in ("char", "struct", "function_handle") or "MATLAB_object_decode" in one.attrs:
            self.leave(path, f"is of MATLAB's class {kind}, not numbers", shape)
        elif "MATLAB_sparse" in one.attrs:
            self.leave(path, "is a sparse matrix", shape)
        elif one.dtype.names and not self.is_matlab and len(shape) == 1:
            for name in one.dtype.names:
                field = one.dtype[name]
                whole, read = shape + field.shape, self.reader(one.name, name)
                self.found.append(of_numbers(f"{path}.{name}", whole, field.base, None, read))
        else:
            unit = next((text(one.attrs[key]) for key in ("unit", "units", "Unit", "Units") if key in one.attrs), None)
            lying = shape[::-1] if self.is_matlab else shape
            self.found.append(of_numbers(path, lying, one.dtype, unit, self.reader(one.name)))

    def reader(self, inside: str, field: str | None = None) -> Callable[[], np.ndarray]:
        """Reads a dataset, or a field of its records."""

        def read() -> np.ndarray:
            with self.h5py.File(self.file, "r") as again:
                values = again[inside][()] if field is None else again[inside][field]
            return values.T if self.is_matlab else values

        return read

    def leave(self, path: str, why: str, shape: tuple[int, ...] = ()) -> None:
        """What is not read, and why."""
        self.found.append(Found(path, shape, why=why))


def text(value: Any) -> str | None:
    """An attribute as a text, if it is one."""
    value = value.item() if getattr(value, "size", 0) == 1 and hasattr(value, "item") else value
    value = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return value.strip() or None if isinstance(value, str) else None
