# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A beam and a pad by a mixed method, in another code: Taylor-Hood tetrahedra of scikit-fem, small strains.

    Pi(u, p) = int mu dev(eps):dev(eps) + p tr(eps) - p^2 / (2 kappa) dV - int t . u dA

with u quadratic, p linear and continuous (Brezzi and Fortin 1991, section VI.6).  What is stored is the load's work
2 W = int t . u, of the whole body, E = 5400 Pa, t = 1 kPa:

    beam    40 x 10 x 10 mm, one end bonded, sheared at the other (computed: the half beyond its plane of symmetry)
    pad     20 x 20 x 5 mm, bonded below and on its sides, pressed on 4 x 4 mm of its top (computed: a quarter)

    python -m palpate.fem_offline.verification.mixed_block

prints the stored numbers, each on two meshes.  scikit-fem (BSD-3) comes with the `test` extra.
"""

from __future__ import annotations

import numpy as np

__all__ = ["STORED", "YOUNGS_MODULUS", "beam_work", "pad_work"]

YOUNGS_MODULUS = 5400.0
TRACTION = 1e3

STORED: dict[tuple[str, float], float] = {
    ("beam", 0.3): 4.888902e-02,
    ("beam", 0.49): 4.768493e-02,
    ("beam", 0.4999): 4.759089e-02,
    ("pad", 0.3): 6.734325e-06,
    ("pad", 0.49): 4.823739e-06,
    ("pad", 0.4999): 4.682589e-06,
}
"""J, of (body, Poisson's ratio): the beam at a fineness of 4 (0.1 % from 3), the pad at 2 (0.8 % from 1)."""

FINENESS = {"beam": (3, 4), "pad": (1, 2)}


def beam_work(poissons_ratio: float, fineness: int) -> float:
    """2 W, J; 4 x 1 x 2 cells times `fineness` in half the beam, finer at the bonded end and at the sides."""
    n = fineness
    x = 0.04 * np.linspace(0.0, 1.0, 4 * n + 1) ** 1.5
    y = 0.005 * (1.0 - (1.0 - np.linspace(0.0, 1.0, n + 1)) ** 1.5)
    z = 0.005 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 2 * n + 1)))

    def held(x: np.ndarray) -> np.ndarray:
        bonded = np.isclose(x[0], 0.0)
        return np.array([bonded, bonded | np.isclose(x[1], 0.0), bonded])

    return 2.0 * _work(poissons_ratio, (x, y, z), held, lambda x: np.isclose(x[0], 0.04), 2)


def pad_work(poissons_ratio: float, fineness: int) -> float:
    """2 W, J; 5 x 5 x 3 cells times `fineness` in a quarter of the pad."""
    n = fineness
    loaded, rest = np.linspace(0.0, 2e-3, 2 * n + 1), 2e-3 + 8e-3 * np.linspace(0.0, 1.0, 3 * n + 1) ** 1.4
    x = np.concatenate([loaded, rest[1:]])
    z = -0.005 * np.linspace(0.0, 1.0, 3 * n + 1) ** 1.2

    def held(x: np.ndarray) -> np.ndarray:
        bonded = np.isclose(x[0], 0.01) | np.isclose(x[1], 0.01) | np.isclose(x[2], -0.005)
        return np.array([bonded | np.isclose(x[0], 0.0), bonded | np.isclose(x[1], 0.0), bonded])

    def pressed(x: np.ndarray) -> np.ndarray:
        return np.isclose(x[2], 0.0) & (x[0] < 2e-3) & (x[1] < 2e-3)

    return 4.0 * _work(poissons_ratio, (x, x, z[::-1]), held, pressed, 2)


def _work(poissons_ratio: float, lines: tuple, held, loaded, component: int) -> float:
    from scipy.sparse import bmat
    from scipy.sparse.linalg import splu
    from skfem import (
        Basis,
        BilinearForm,
        ElementTetP1,
        ElementTetP2,
        ElementVector,
        FacetBasis,
        LinearForm,
        MeshTet,
    )
    from skfem.helpers import ddot, div, sym_grad

    mu = YOUNGS_MODULUS / (2.0 * (1.0 + poissons_ratio))
    kappa = YOUNGS_MODULUS / (3.0 * (1.0 - 2.0 * poissons_ratio))
    mesh = MeshTet.init_tensor(*lines)
    ub = Basis(mesh, ElementVector(ElementTetP2()), intorder=2)
    pb = ub.with_element(ElementTetP1())

    @BilinearForm
    def shape(u, v, w):
        return 2.0 * mu * (ddot(sym_grad(u), sym_grad(v)) - div(u) * div(v) / 3.0)

    @BilinearForm
    def volume(u, q, w):
        return q * div(u)

    @BilinearForm
    def softness(p, q, w):
        return p * q / kappa

    @LinearForm
    def push(v, w):
        return TRACTION * v[component]

    faces = mesh.facets_satisfying(loaded, boundaries_only=True)
    load = push.assemble(FacetBasis(mesh, ub.elem, facets=faces, intorder=2))
    B = volume.assemble(ub, pb)
    fixed = np.zeros(ub.N, bool)
    locations = ub.doflocs
    for i in range(3):
        own = np.concatenate([ub.nodal_dofs[i], ub.edge_dofs[i]])
        fixed[own] = held(locations[:, own])[i]
    free = ~fixed
    A = bmat([[shape.assemble(ub)[free][:, free], B[:, free].T], [B[:, free], -softness.assemble(pb)]], "csc")
    f = np.concatenate([load[free], np.zeros(pb.N)])
    return float(f @ _solve(A, f, splu))


def _solve(A, f, splu):
    try:
        from pypardiso import spsolve
    except ImportError:
        return splu(A).solve(f)
    return spsolve(A.tocsr(), f)


def _print() -> None:
    for name, work in (("beam", beam_work), ("pad", pad_work)):
        for nu in (0.3, 0.49, 0.4999):
            coarse, fine = (work(nu, n) for n in FINENESS[name])
            print(f'    ("{name}", {nu}): {fine:.6e},  # coarser: {coarse:.6e}', flush=True)


if __name__ == "__main__":
    _print()
