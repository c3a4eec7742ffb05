"""The table of what an edge under a point patch bears, and the obstacle problem that it comes from."""

from pathlib import Path

import edge_share
import numpy as np
from pytest import approx, mark
from truecut_reference import edge_share as table

CORE = Path(__file__).parents[2] / "crates" / "core" / "src" / "wheel" / "patch" / "edge_share.rs"


@mark.parametrize("seed", range(3))
def test_verify_the_table_is_the_obstacle_problem_s(seed):
    """Between nodes, where both bear more than a few per cent of the force; on a coarser grid than the table's."""
    rng = np.random.default_rng([seed, 41])
    stretch, place = rng.uniform(0.25, 0.45), rng.uniform(-0.7, 0.4)
    layer = edge_share.layer(stretch)

    def force(n, edge):
        coarse, fine = (edge_share.obstacle(n, edge, h) for h in (0.08, 0.05))
        return fine + (fine - coarse) * 0.05 / 0.03

    assert table.edge_share(layer, place) == approx(edge_share.share(layer, place, force), abs=0.012)


def test_what_is_tabulated_is_what_the_program_has():
    """Two tables that were typed: the core's, and the reference's."""
    text = CORE.read_text(encoding="utf-8")
    for name, rows in (("STRETCH", [table.STRETCHES]), ("SHARE", table.SHARES[1:])):
        block = text.split(f"const {name}")[1].split("= ", 1)[1].split(";\n")[0]
        numbers = [float(x) for x in block.replace("[1.0; 7]", "").replace("[", " ").replace("]", " ").replace(",", " ").split()]
        assert numbers == approx([x for row in rows for x in row])

