"""The wheel, built by the documented command and installed into a fresh venv: what the tests of the package share."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))


def made(folder: Path) -> Path:
    """The interpreter of a fresh venv in a folder with the wheel, which lies in `dist` there, and nothing else."""
    command = [Path(sys.executable).parent / "maturin", "build", "--release", "--out", folder / "dist"]
    command += ["--manifest-path", ROOT / "crates" / "python" / "Cargo.toml", "--target-dir", ROOT / "target"]
    # the interpreter that it finds does not matter: one wheel is for all from 3.10 on
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    (wheel,) = (folder / "dist").glob("truecut-*.whl")
    assert "-cp310-abi3-" in wheel.name
    venv.create(folder / "venv", with_pip=False)
    found = folder / "venv" / "bin" / "python"
    install = [sys.executable, "-m", "pip", "--python", found, "install", "--quiet", "--no-index", wheel]
    subprocess.run(install, check=True)
    return found


@pytest.fixture(scope="session")
def python(tmp_path_factory) -> Path:
    """The interpreter of a fresh venv with the wheel and nothing else."""
    return made(tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="session")
def with_arrays(python, tmp_path_factory) -> Path:
    """The same, and the packages of these tests behind its own."""
    packages = next(Path(path) for path in sys.path if path.endswith("site-packages"))
    (own,) = (python.parents[1] / "lib").glob("python3.*/site-packages")
    (own / "of_tests.pth").write_text(f"{packages}\n")
    return python


def run(python: Path, script: str, code: int = 0) -> str:
    """Runs lines of Python where the scenarios are."""
    ended = subprocess.run([python, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert ended.returncode == code, ended.stdout + ended.stderr
    return ended.stdout
