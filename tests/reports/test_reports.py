"""Reports of the commands as pages: they hold all that they need, run nothing but their own script, and are drawn by a
browser without a complaint, where there is one (Chromium on the PATH, or where `TRUECUT_CHROMIUM` says)."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import os
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
SCENARIOS = ROOT / "scenarios"
MOST_BYTES = 3_000_000
MOST_POINTS = 20_000
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")

# What is called, and the page that it leaves; arguments in <> are files of the tree, {out} is the test's own folder.
CALLS = {
    "run": (["run", "<arm/free_decay.toml>", "--out", "{out}"], "free_decay/run.html"),
    "sweep": (["run", "<chamfer/threshold.toml>", "--out", "{out}"], "threshold/sweep.html"),
    "check": (["check", "<arm/free_decay.toml>", "--junit", "{out}/junit.xml"], "junit.html"),
    "compare": (["compare", "<diagnosis/elbow.toml>", "--out", "{out}"], "elbow/compare/report.html"),
    "lobes": (
        ["lobes", "<milling/path_600.toml>", "--size", "40", "--runs", "0", "--out", "{out}"],
        "path_600/lobes.html",
    ),
    "posture": (["posture", "<milling/path_600.toml>", "--out", "{out}"], "path_600/posture.html"),
    "identify": (["identify", "<identification/arm.toml>", "--out", "{out}"], "arm/identify.html"),
    "path": (["path", "<finishing/crowned_block.toml>", "--out", "{out}"], "crowned_block/path.html"),
}
# Of these there is nothing to draw.
WITHOUT_FIGURES = {"check"}


def truecut(*arguments: object) -> None:
    """Runs the program, which must end well."""
    command = [PROGRAM, *map(str, arguments)]
    ended = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"NO_COLOR": "1"}, timeout=500)
    assert ended.returncode == 0, ended.stderr + ended.stdout


class Page(HTMLParser):
    """Scripts, styles, policy and figures' data of a page."""

    def __init__(self, path: Path):
        super().__init__()
        self.bytes = path.stat().st_size
        self.path, self.text = path, path.read_text()
        self.code, self.data, self.styles = [], [], []
        self.policy, self.references = "", []
        self._into: list[str] | None = None
        self.feed(self.text)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.references += [value for name, value in attrs if name in ("src", "href", "style") or name.startswith("on")]
        if given.get("http-equiv") == "Content-Security-Policy":
            self.policy = given["content"]
        if tag == "script":
            self._into = self.data if given.get("type") == "application/json" else self.code
        elif tag == "style":
            self._into = self.styles

    def handle_endtag(self, tag):
        if tag in ("script", "style"):
            self._into = None

    def handle_data(self, data):
        if self._into is not None:
            self._into.append(data)

    @property
    def panels(self) -> list[dict]:
        """The figures' panels."""
        return [json.loads(one) for one in self.data]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Makes the page of a command, once."""
    known: dict[str, Page] = {}

    def page(command: str) -> Page:
        if command not in known:
            out = tmp_path_factory.mktemp(command)
            call, name = CALLS[command]
            fill = [re.sub("<(.*)>", lambda found: str(SCENARIOS / found[1]), one).replace("{out}", str(out)) for one in call]
            truecut(*fill)
            known[command] = Page(out / name)
        return known[command]

    return page


@pytest.mark.parametrize("command", CALLS)
def test_a_page_holds_all_that_it_needs_and_no_more(command, made):
    page = made(command)
    assert page.bytes <= MOST_BYTES, page.bytes
    assert page.references == [], "nothing is loaded, and no element brings code or styles"
    assert "@import" not in page.styles[0] and "url(" not in page.styles[0]
    [code], [style] = page.code, page.styles
    assert "Permission is hereby granted" in code, "the library's licence goes with it"
    for kind, text in (("script", code), ("style", style)):
        hashed = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{hashed}'" in page.policy, page.policy
    assert page.policy.startswith("default-src 'none'")
    assert bool(page.panels) == (command not in WITHOUT_FIGURES)
    assert "How to reproduce" in page.text and f"truecut {CALLS[command][0][0]} " in page.text
    for panel in page.panels:
        assert panel["layers"]
        for layer in panel["layers"]:
            assert len(layer["x"]) == len(layer["y"])
            if layer["style"] in ("line", "dashed", "dotted", "cloud"):
                assert len(layer["x"]) <= 1.5 * MOST_POINTS


BAD = "</script><script>document.documentElement.dataset.broken = 1</script>"


def named(name: str, folder: Path) -> Page:
    """The page of a run of this name, with a claim of this name."""
    folder.mkdir()
    text = (SCENARIOS / "arm/free_decay.toml").read_text()
    text = re.sub('^name = ".*"$', f"name = '{name}'", text, count=1, flags=re.MULTILINE)
    text = text.replace("../../assets", str(ROOT / "assets"))
    text += f"\n[[claim]]\nname = '{name}'\nmetric = 'peak'\nchannel = 'tool.displacement_x'\n"
    text += f"min = 0\nunit = 'mm'\nreason = '{name}'\n"
    scenario = folder / "named.toml"
    scenario.write_text(text)
    truecut("run", scenario, "--out", folder / "out", "--no-rrd")
    return Page(folder / "out/named/run.html")


def test_a_name_that_ends_a_script_changes_nothing(tmp_path):
    good, bad = named("plain", tmp_path / "good"), named(BAD, tmp_path / "bad")
    assert html.escape(BAD, quote=False) in bad.text
    assert bad.text.replace(html.escape(BAD, quote=False), "plain") == good.text
    assert bad.code == good.code and bad.data == good.data and bad.policy == good.policy
    if browser():
        assert "data-broken" not in opened(bad)[0]


def browser() -> str | None:
    """A browser that can be run without a screen."""
    given = os.environ.get("TRUECUT_CHROMIUM")
    return given or next(filter(None, map(shutil.which, BROWSERS)), None)


def opened(page: Page) -> tuple[str, list[str]]:
    """The document after the page's script has run, and what the console says."""
    program = browser()
    assert program
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--v=0"]
    command = [program, *options, f"--user-data-dir={page.path.parent / 'browser'}", "--dump-dom", page.path.as_uri()]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout, [line for line in ended.stderr.splitlines() if "CONSOLE" in line]


@pytest.mark.skipif(not browser(), reason="there is no Chromium")
@pytest.mark.parametrize("command", CALLS)
def test_a_browser_draws_every_panel_without_a_complaint(command, made):
    page = made(command)
    document, console = opened(page)
    assert console == []
    assert f'data-panels="{len(page.panels)}"' in document
    assert document.count("<canvas") == len(page.panels)
    labels = sum(bool(layer["label"]) for panel in page.panels for layer in panel["layers"])
    assert document.count("aria-pressed") == labels + page.code[0].count("aria-pressed") + page.styles[0].count("aria-pressed")
