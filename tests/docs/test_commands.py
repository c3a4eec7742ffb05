"""Runs the commands that README, docs and benches show: each block marked `sh`, as a reader would paste it.

A document's blocks run in its order, in a copy of what is shipped, with the built program as `truecut`. A comment on the
line before a block changes what is run:

    <!-- ci: short "the command in a form that takes less time" -->
    <!-- ci: whole "such a form, which runs with TRUECUT_WHOLE=1 alone" -->
    <!-- ci: skip "why it cannot run" -->

A command that names `$TRUECUT_DATA` is skipped where there is no measured data. Skipped blocks are named at the end of
`tests/run.py`.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
SHIPPED = ("README.md", "assets", "benches", "docs", "scenarios", "tests")
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), ROOT / "benches" / "README.md"]
# runs these tests, and is running now
THIS_RUN = "python3 tests/run.py"
LONGEST_S = 900

NOTE = re.compile(r'^<!-- ci: (short|whole|skip) "(.*)" -->$')
# the workspace is not copied, so that nothing is built twice; a program that cargo starts runs in the copy. A bench of
# one package alone would build the libraries with fewer features, once more: it is built as part of the workspace
CARGO = """#!/bin/sh
command=$1
shift
if [ "$command" = bench ] && [ "$1" = -p ]; then
    shift 2
    set -- --workspace "$@"
fi
exec "{cargo}" "$command" --manifest-path "{root}/Cargo.toml" "$@"
"""


class Block(NamedTuple):
    """Commands of a document, from a line on, and what the comment before them says."""

    document: Path
    line: int
    commands: str
    note: str | None
    text: str

    @property
    def name(self) -> str:
        """Document and first command."""
        first = self.commands.strip().splitlines()[0]
        return f"{self.document.relative_to(ROOT)}:{self.line}: {first}"

    @property
    def shown(self) -> str:
        """What is run: the short form, if there is one."""
        return self.text if self.note in ("short", "whole") else self.commands

    @property
    def reason_to_skip(self) -> str | None:
        """Why it does not run here; `None` if it does."""
        if self.commands.strip() == THIS_RUN:
            return "runs these tests"
        if self.note == "skip":
            return self.text
        if self.note == "whole" and os.environ.get("TRUECUT_WHOLE") != "1":
            return "runs with TRUECUT_WHOLE=1, as in .ci/full"
        if "$TRUECUT_DATA" in self.shown and "TRUECUT_DATA" not in os.environ:
            return "TRUECUT_DATA names no folder of measured data"
        return None


def blocks(document: Path) -> list[Block]:
    """All blocks of shell commands in a document."""
    lines = document.read_text(encoding="utf-8").splitlines()
    starts = [number for number, line in enumerate(lines) if line.strip() == "```sh"]
    found = []
    for start in starts:
        indent = len(lines[start]) - len(lines[start].lstrip())
        end = next(number for number in range(start + 1, len(lines)) if lines[number].strip() == "```")
        commands = "\n".join(line[indent:] for line in lines[start + 1 : end])
        note = NOTE.match(lines[start - 1].strip()) if start > 0 else None
        found.append(Block(document, start + 1, commands, *(note.groups() if note else (None, ""))))
    return found


BLOCKS = [block for document in DOCUMENTS for block in blocks(document)]


class Desk:
    """A copy of what is shipped, in which the blocks of one document run in its order."""

    def __init__(self, document: Path, folder: Path):
        self.folder = desk(folder)
        self.left = [block for block in BLOCKS if block.document == document]

    def run_to(self, block: Block) -> None:
        """Runs a block after those before it that have not run here: another worker may have run them elsewhere."""
        while block in self.left:
            one = self.left.pop(0)
            if not one.reason_to_skip:
                run(one, self.folder)


@pytest.fixture(scope="session")
def desks(tmp_path_factory) -> dict[Path, Desk]:
    """A desk for each document, made when its first block runs."""
    if not PROGRAM.exists():
        pytest.fail(f"{PROGRAM} is missing: cargo build --release -p truecut-cli")

    class Desks(dict):
        def __missing__(self, document: Path) -> Desk:
            self[document] = Desk(document, tmp_path_factory.mktemp(document.stem))
            return self[document]

    return Desks()


def desk(folder: Path) -> Path:
    """What a reader has after the first build."""
    for name in SHIPPED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, folder / name)
    built = folder / "target" / "release"
    built.mkdir(parents=True)
    (built / "truecut").symlink_to(PROGRAM)
    tools = folder / "tools"
    tools.mkdir()
    (tools / "truecut").symlink_to(PROGRAM)
    (tools / "cargo").write_text(CARGO.format(cargo=shutil.which("cargo"), root=ROOT), encoding="utf-8")
    (tools / "cargo").chmod(0o755)
    return folder


def run(block: Block, folder: Path) -> None:
    """Runs a block, or its short form; it must end with exit code 0."""
    path = os.pathsep.join([str(folder / "tools"), str(Path(sys.executable).parent), os.environ["PATH"]])
    variables = os.environ | {"PATH": path, "NO_COLOR": "1", "TRUECUT_PYTHON": sys.executable}
    if "TRUECUT_DATA" in variables:
        variables["TRUECUT_DATA"] = str((ROOT / variables["TRUECUT_DATA"]).resolve())
    command = ["bash", "-euo", "pipefail", "-c", block.shown]
    done = subprocess.run(
        command, cwd=folder, env=variables, capture_output=True, text=True, timeout=LONGEST_S, check=False
    )
    assert done.returncode == 0, f"{block.shown}\nexit {done.returncode}\n{done.stdout}\n{done.stderr}"


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.name)
def test_command_of_a_document_runs(desks, block):
    """It ends with exit code 0."""
    if block.commands.strip() == THIS_RUN:
        return
    if block.reason_to_skip:
        pytest.skip(block.reason_to_skip)
    desks[block.document].run_to(block)


def test_every_comment_on_a_command_is_understood():
    """A comment that stands elsewhere, or is written otherwise, would silently do nothing."""
    for document in DOCUMENTS:
        text = document.read_text(encoding="utf-8")
        noted = sum(1 for block in blocks(document) if block.note is not None)
        assert text.count("<!-- ci:") == noted, document


def test_every_bench_has_its_command():
    """No bench is left out of `benches/README.md`, whose commands run here."""
    shown = "\n".join(block.commands for block in blocks(ROOT / "benches" / "README.md"))
    for source in [*ROOT.glob("crates/*/benches/*.rs"), *ROOT.glob("tests/benches/*.rs")]:
        assert f"--bench {source.stem}" in shown or source.stem == "forced_arm", source
    for script in (ROOT / "benches").glob("*.py"):
        assert f"benches/{script.name}" in shown, script
