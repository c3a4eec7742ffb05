"""Reports of the commands as pages: they hold all that they need, run nothing but their own script, and are drawn by a
browser without a complaint, where there is one (Chromium on the PATH, or where `TRUECUT_CHROMIUM` says)."""

from __future__ import annotations

import array
import base64
import csv
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

BEFORE_AN_ARM = ["--robot", "<../assets/robots/hp20/robot.urdf>", "--work-xyz-mm", "900,0,350", "--dialect", "jbi"]
BEFORE_AN_ARM += ["--option", "date=2026-01-31 12:00", "--option", "tool_number=1", "--out", "{out}"]
APT = "PARTNO/LEANING\nUNITS/MM\nMULTAX/ON\nFEDRAT/600\n" + "".join(
    f"GOTO/{2 * k},{k % 7},{0.5 * k},{0.004 * k:.6f},0.000000,{(1 - (0.004 * k) ** 2) ** 0.5:.6f}\n" for k in range(40)
)

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
    "diagnose": (["diagnose", "<diagnosis/elbow.toml>", "--out", "{out}"], "elbow/report.html"),
    "milled": (["run", "<milling/pocket.toml>", "--no-rrd", "--out", "{out}"], "pocket/run.html"),
    "polished": (["run", "<finishing/mould_constrained.toml>", "--no-rrd", "--out", "{out}"], "{stem}/run.html"),
    "ground": (["run", "<finishing/hub_spoke_belt.toml>", "--no-rrd", "--out", "{out}"], "{stem}/run.html"),
    "brushed": (["run", "<finishing/block_edge_brush.toml>", "--no-rrd", "--out", "{out}"], "{stem}/run.html"),
    "g_code": (["path", "<../tests/crosscheck/cam/pocket_mill.nc>", *BEFORE_AN_ARM], "pocket_mill/path.html"),
    "apt": (["path", "{out}/leaning.apt", *BEFORE_AN_ARM], "leaning/path.html"),
}
# Of these there is nothing to draw.
WITHOUT_FIGURES = {"check"}
# These leave something on a face.
WITH_MAPS = {"milled", "polished", "ground", "brushed"}
# Long enough to wait before a page can be used, on a machine with other work, too.
MOST_MS = 2000


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
        return [one for one in map(json.loads, self.data) if "layers" in one]

    @property
    def spaces(self) -> list[dict]:
        """What can be looked at from all sides."""
        return [one for one in map(json.loads, self.data) if "meshes" in one]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Makes the page of a command, once."""
    known: dict[str, Page] = {}

    def page(command: str) -> Page:
        if command not in known:
            out = tmp_path_factory.mktemp(command)
            (out / "leaning.apt").write_text(APT)
            call, name = CALLS[command]
            fill = [re.sub("<(.*)>", lambda found: str(SCENARIOS / found[1]), one).replace("{out}", str(out)) for one in call]
            truecut(*fill)
            known[command] = Page(out / name.replace("{stem}", Path(fill[1]).stem))
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
    assert any("scale" in panel for panel in page.panels) == (command in WITH_MAPS)
    for panel in page.panels:
        assert panel["layers"]
        for layer in panel["layers"]:
            assert len(layer["x"]) == len(layer["y"])
            if layer["style"] in ("line", "dashed", "dotted", "cloud"):
                assert len(layer["x"]) <= 1.5 * MOST_POINTS


@pytest.mark.parametrize("command", sorted(WITH_MAPS))
def test_a_map_has_the_values_of_its_table(command, made):
    """The colours stand for what `map.csv` says: means of blocks of cells, in the unit of the scale."""
    page = made(command)
    [panel] = [one for one in page.panels if "scale" in one and not one["scale"]["diverging"]]
    scale, [layer] = panel["scale"], panel["layers"]
    with (page.path.parent / "map.csv").open() as file:
        rows = list(csv.reader(file))
    name, unit = re.fullmatch(r"(.*) \((.*)\)", rows[0][5]).groups()
    assert unit == "m" and scale["label"].startswith(name.replace("_", " "))
    factor = {"mm": 1e3, "µm": 1e6, "nm": 1e9}[re.search(r"\[(.*)\]", scale["label"])[1]]
    places = [[int(row[0]), int(row[1])] for row in rows[1:]]
    columns, lines = (max(one[axis] for one in places) + 1 for axis in (0, 1))
    every = max(-(-columns // 140), -(-lines // 140))
    blocks: dict[tuple[int, int], list[float]] = {}
    for (column, line), row in zip(places, rows[1:]):
        if row[5]:
            blocks.setdefault((column // every, line // every), []).append(float(row[5]) * factor)
    wide, high = layer["size"]
    assert len(layer["x"]) == len(blocks) > 10
    left = min(layer["x"]) - wide / 2
    low = min(layer["y"]) - high / 2
    for x, y, shade in zip(layer["x"], layer["y"], layer["shade"]):
        values = blocks[int((x - left) / wide), int((y - low) / high)]
        meant = min(scale["high"], max(0.0, sum(values) / len(values)))
        assert abs(shade * scale["high"] - meant) <= 0.001 * scale["high"], (x, y)
    # of the burr nothing is left
    assert max(layer["shade"]) == 0 if command == "brushed" else max(layer["shade"]) > 0.2


@pytest.mark.parametrize("command", ["run", "milled", "path", "g_code", "apt"])
def test_a_scene_holds_the_arm_where_it_was(command, made):
    """Triangles point at corners that are there, poses are of all bodies, quaternions of length 1."""
    page = made(command)
    scenes = page.spaces
    assert any(group["label"] == "arm" for group in scenes[-1]["groups"])
    for scene in scenes:
        assert sum(len(base64.b64decode(mesh["triangles"])) for mesh in scene["meshes"]) > 1000
        for mesh in scene["meshes"]:
            corners = len(base64.b64decode(mesh["points"])) // 6
            used = array.array("I" if mesh["wide"] else "H", base64.b64decode(mesh["triangles"]))
            assert len(used) % 3 == 0 and max(used) < corners
            if "shades" in mesh:
                assert len(base64.b64decode(mesh["shades"])) == corners
        bodies = {thing["body"] for thing in scene["meshes"] + scene["lines"]} - {None}
        for poses in scene["poses"]:
            assert len(poses) % 7 == 0 and all(7 * body < len(poses) for body in bodies)
            for at in range(0, len(poses), 7):
                assert abs(sum(part * part for part in poses[at + 3 : at + 7]) - 1) < 1e-4
    if command in ("path", "g_code", "apt"):
        assert sum(bool(line["points"]) for line in scenes[-1]["lines"]) > 0
        assert len(scenes[-1]["time"]) > 10 and scenes[-1]["time"] == sorted(scenes[-1]["time"])


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
    assert f'data-spaces="{len(page.spaces)}"' in document
    assert int(re.search(r'data-ready-ms="(\d+)"', document)[1]) <= MOST_MS
    scales = sum("scale" in panel for panel in page.panels) + sum(len(scene["scales"]) for scene in page.spaces)
    assert document.count("<canvas") == len(page.panels) + len(page.spaces) + scales
    # all that there is to see is within the picture, and not lost in it
    covered = [float(share) for share in re.findall(r'data-covered="([\d.]+)"', document)]
    assert len(covered) == len(page.spaces) and all(0.01 < share < 0.9 for share in covered), covered
    labels = sum(bool(layer["label"]) for panel in page.panels for layer in panel["layers"])
    labels += sum(len(scene["groups"]) for scene in page.spaces)
    assert document.count("aria-pressed") == labels + page.code[0].count("aria-pressed") + page.styles[0].count("aria-pressed")
