"""A hollow elastic sphere between rigid planes, by finite elements: docs/physics/wheel_contact.md.

Half a sphere on its equator, axisymmetric, quadratic on curved elements that are finest at the pole
(scikit-fem); the plane's contact on the surface's nodes, which may press but not pull. Radius 1,
E/(1 - nu^2) = 1.

    python tests/reference/shell.py
"""

import numpy as np
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import ddot, sym_grad

# nu, thickness; force at .003 and .01 of the radius
CASES = [(0.49, 0.96), (0.49, 0.5), (0.49, 0.25), (0.49, 0.1), (0.3, 0.25), (0.3, 0.05)]
INDENTATIONS = [0.003, 0.01]
MESHES = [(10, 60), (16, 120)]


class Sphere:
    """Places of the surface near the pole, and how they move by forces on them."""

    def __init__(self, nu, thickness, through, along):
        angle = np.pi / 2 * np.linspace(0, 1, along + 1) ** 2.2
        radius = np.sort(1 - thickness * np.linspace(0, 1, through + 1) ** 1.8)
        flat = skfem.MeshQuad2.from_mesh(skfem.MeshQuad.init_tensor(angle, radius))
        t, r = flat.p
        mesh = skfem.MeshQuad2(np.array([r * np.sin(t), r * np.cos(t)]), flat.t)
        basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=5)
        young = 1 - nu**2
        lame, shear = young * nu / (1 + nu) / (1 - 2 * nu), young / 2 / (1 + nu)

        @skfem.BilinearForm
        def energy(u, v, w):
            x = np.maximum(w.x[0], 1e-14)
            a, b = sym_grad(u), sym_grad(v)
            round_a, round_b = u[0] / x, v[0] / x
            whole = (a[0, 0] + a[1, 1] + round_a) * (b[0, 0] + b[1, 1] + round_b)
            return (lame * whole + 2 * shear * (ddot(a, b) + round_a * round_b)) * x * 2 * np.pi

        stiffness = energy.assemble(basis).tocsc()
        x, z = basis.doflocs
        axial = np.zeros(len(x), bool)
        for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
            axial[dofs[1::2].ravel()] = True
        held = (~axial & (x < 1e-10)) | (axial & (z < 1e-10))
        surface = axial & (np.abs(np.hypot(x, z) - 1) < 1e-9) & (x < 0.4) & ~held
        top = np.flatnonzero(surface)[np.argsort(x[surface])]
        free = np.flatnonzero(~held)
        at = np.searchsorted(free, top)
        loads = np.zeros((len(free), len(top)))
        loads[at, np.arange(len(top))] = 1
        self.gives = splu(stiffness[free][:, free]).solve(loads)[at]
        self.height = z[top]

    def force(self, indentation):
        """Against a plane that has come so far towards the equator."""
        asked = self.height - (1 - indentation)
        touches = asked > indentation / 2
        for _ in range(100):
            force = np.zeros(len(asked))
            force[touches] = np.linalg.solve(self.gives[np.ix_(touches, touches)], asked[touches])
            now = np.where(touches, force > 0, self.gives @ force < asked - 1e-15)
            if (now == touches).all():
                return force.sum()
            touches = now
        raise RuntimeError("no contact was found")


if __name__ == "__main__":
    for nu, thickness in CASES:
        for mesh in MESHES:
            sphere = Sphere(nu, thickness, *mesh)
            found = [sphere.force(d) for d in INDENTATIONS]
            print(nu, thickness, mesh, *(f"{force:.5g}" for force in found))
