"""Reference numbers of docs/physics/wheel_contact.md: hollow spheres by finite elements."""

import shell
from pytest import approx, mark

FOUND = {
    (0.49, 0.96): [2.2479e-4, 1.3881e-3],
    (0.49, 0.5): [2.0649e-4, 1.1997e-3],
    (0.49, 0.25): [1.3669e-4, 6.5167e-4],
    (0.49, 0.1): [4.2480e-5, 1.6474e-4],
    (0.3, 0.25): [1.4215e-4, 6.9172e-4],
    (0.3, 0.05): [1.4176e-5, 5.2224e-5],
}


@mark.parametrize("case", shell.CASES)
def test_hollow_spheres_on_the_coarse_mesh(case):
    sphere = shell.Sphere(*case, *shell.MESHES[0])
    assert [sphere.force(d) for d in shell.INDENTATIONS] == approx(FOUND[case], rel=1e-4)


def test_the_mesh_has_converged():
    case = shell.CASES[2]
    found = [shell.Sphere(*case, *mesh).force(shell.INDENTATIONS[1]) for mesh in shell.MESHES]
    assert found[0] == approx(found[1], rel=1e-3)
