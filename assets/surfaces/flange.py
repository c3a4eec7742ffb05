"""Models the flange of `flange.stl` with Open CASCADE and meshes it: `pip install cadquery-ocp`, then `python flange.py`.

A plate of 140 by 100 by 16 mm with rounded corners, a bore of 50 mm, a pocket 6 mm deep with rounded corners on either side
of it, and four bolt holes.
"""

from pathlib import Path

from OCP.BRep import BRep_Tool
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.StlAPI import StlAPI_Writer
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS

THICKNESS = 16.0


def rounded_box(corner, sides, radius):
    """A box whose four upright edges are rounded, mm."""
    box = BRepPrimAPI_MakeBox(gp_Pnt(*corner), *sides).Shape()
    fillet = BRepFilletAPI_MakeFillet(box)
    edges = TopExp_Explorer(box, TopAbs_EDGE)
    seen = set()
    while edges.More():
        edge = TopoDS.Edge(edges.Current())
        ends = ends_of(edge)
        upright = ends[0][:2] == ends[1][:2]
        if upright and ends[0][:2] not in seen:
            seen.add(ends[0][:2])
            fillet.Add(radius, edge)
        edges.Next()
    return fillet.Shape()


def ends_of(edge):
    """Both ends of an edge, rounded to 1e-6 mm."""
    ends = [BRep_Tool.Pnt_s(end) for end in (TopExp.FirstVertex_s(edge), TopExp.LastVertex_s(edge))]
    return [(round(p.X(), 6), round(p.Y(), 6), round(p.Z(), 6)) for p in ends]


def hole(x, y, radius):
    """A cylinder through the plate."""
    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, -1.0), gp_Dir(0, 0, 1)), radius, THICKNESS + 2.0).Shape()


part = rounded_box((-70, -50, 0), (140, 100, THICKNESS), 12)
cuts = [hole(0, 0, 25), *(hole(x, y, 5) for x in (-58, 58) for y in (-38, 38))]
cuts += [rounded_box((x, -22, THICKNESS - 6), (18, 44, 10), 6) for x in (-56, 38)]
for cut in cuts:
    part = BRepAlgoAPI_Cut(part, cut).Shape()
BRepMesh_IncrementalMesh(part, 0.02, False, 0.2, False)
writer = StlAPI_Writer()
writer.ASCIIMode = False
writer.Write(part, str(Path(__file__).with_name("flange.stl")))
