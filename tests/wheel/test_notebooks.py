"""The notebooks of the documentation run from the first cell to the last with the wheel, and draw."""

from __future__ import annotations

import json
from pathlib import Path

import nbformat
import pytest
from built import ROOT, python, with_arrays  # noqa: F401
from nbclient import NotebookClient

FOLDER = ROOT / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
# most seconds of a cell: a diagnosis on a machine with other work
LONGEST_S = 500


@pytest.fixture
def kernel(with_arrays, tmp_path, monkeypatch) -> str:  # noqa: F811
    """A kernel of the interpreter with the wheel."""
    folder = tmp_path / "kernels" / "wheel"
    folder.mkdir(parents=True)
    argv = [str(with_arrays), "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    spec = {"argv": argv, "display_name": "wheel", "language": "python"}
    (folder / "kernel.json").write_text(json.dumps(spec))
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path / "matplotlib"))
    return "wheel"


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_runs(file: Path, kernel):
    notebook = nbformat.read(file, as_version=4)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    # what a notebook shows is what it computes: results are not kept in the tree
    assert all(not cell.outputs and cell.execution_count is None for cell in cells)
    where = {"metadata": {"path": str(FOLDER)}}
    NotebookClient(notebook, timeout=LONGEST_S, kernel_name=kernel, resources=where).execute()
    outputs = [output for cell in cells for output in cell.outputs]
    warned = [output.text for output in outputs if output.get("name") == "stderr"]
    assert not warned, warned
    figures = [output for output in outputs if "image/png" in output.get("data", {})]
    drawn = sum("plt." in cell.source and "import" not in cell.source for cell in cells)
    assert len(figures) == drawn >= 1, (len(figures), drawn)


def test_there_are_notebooks():
    assert {file.stem for file in NOTEBOOKS} >= {"chamfer", "what_your_arm_lacks", "choose_a_posture"}
