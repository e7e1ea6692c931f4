# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Cook's membrane by a mixed method, in another code: Taylor-Hood triangles of scikit-fem, in plane strain.

    Pi(u, p) = int psi_iso(F) + p (J - 1) - p^2 / (2 kappa) dA - int t . u ds,   psi_iso = mu/2 (J^(-2/3) I1 - 3)

with u quadratic, p linear and continuous, F33 = 1.  Eliminating p pointwise gives kappa/2 (J - 1)^2, so this is the
solid of material.py; p is an unknown of its own and nothing can lock (Brezzi and Fortin 1991, section VI.6).
Small strains are the first Newton step from rest.  With C = cof F, J = det F, I1 = F:F + 1 in the plane,

    dpsi[H]     = mu J^(-2/3) (F:H - I1/(3J) C:H)
    d2psi[G, H] = mu J^(-2/3) (G:H - 2/(3J) (C:G F:H + F:G C:H) + 5 I1/(9 J^2) C:G C:H - I1/(3J) cof G:H)

Mesh: `divisions` cells a side, finer towards the clamped upper corner, where stress is singular.

The membrane (Cook 1974): corners (0, 0), (48, 44), (48, 60), (0, 44) mm, clamped at x = 0, sheared at x = 48 mm.

    python -m palpate.fem_offline.verification.mixed_membrane

prints the stored numbers, each on two meshes.  scikit-fem (BSD-3) comes with the `test` extra; without it the stored
numbers serve.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec

import numpy as np

__all__ = [
    "CORNERS",
    "POISSONS_RATIOS",
    "SHEAR",
    "STORED",
    "MembraneAnswer",
    "membrane_answer",
    "quadrilateral",
    "solve_membrane",
]

CORNERS = np.array([[0.0, 0.0], [48.0, 44.0], [48.0, 60.0], [0.0, 44.0]]) * 1e-3
"""(4, 2) m."""

SHEAR = 0.078
"""Traction at the loaded edge over the shear modulus: about 7 mm of tip displacement at finite strain."""

POISSONS_RATIOS = (0.3, 0.4, 0.45, 0.49, 0.499, 0.4999)


@dataclass(frozen=True)
class MembraneAnswer:
    """What the membrane is judged by.

    Attributes:
        tip: m; upward displacement of the corner (48, 60) mm.
        work: mean over the loaded edge of (t . u) / mu, m.
    """

    tip: float
    work: float


STORED: dict[tuple[float, bool], MembraneAnswer] = {
    (0.3, False): MembraneAnswer(1.105115e-02, 8.241064e-04),
    (0.4, False): MembraneAnswer(9.586437e-03, 7.150869e-04),
    (0.45, False): MembraneAnswer(8.837480e-03, 6.592858e-04),
    (0.49, False): MembraneAnswer(8.228143e-03, 6.138532e-04),
    (0.499, False): MembraneAnswer(8.089594e-03, 6.035182e-04),
    (0.4999, False): MembraneAnswer(8.075707e-03, 6.024822e-04),
    (0.3, True): MembraneAnswer(8.769077e-03, 6.983457e-04),
    (0.4, True): MembraneAnswer(7.910797e-03, 6.246761e-04),
    (0.45, True): MembraneAnswer(7.439521e-03, 5.848158e-04),
    (0.49, True): MembraneAnswer(7.038524e-03, 5.512140e-04),
    (0.499, True): MembraneAnswer(6.945113e-03, 5.434265e-04),
    (0.4999, True): MembraneAnswer(6.935704e-03, 5.426430e-04),
}
"""Of (Poisson's ratio, finite strains): 64 cells a side at small strain, 32 at finite.  Meshes half as fine differ by
0.2 % of the tip and 0.1 % of the work at most."""


def membrane_answer(poissons_ratio: float, finite: bool) -> tuple[MembraneAnswer, str]:
    """The answer to compare with, and where it comes from: solved here, or stored where scikit-fem is absent."""
    if find_spec("skfem") is None:
        return STORED[poissons_ratio, finite], "Taylor-Hood triangles (stored; scikit-fem is not installed)"
    divisions = 16 if finite else 24
    return solve_membrane(poissons_ratio, finite, divisions), "Taylor-Hood triangles, scikit-fem"


@cache
def solve_membrane(poissons_ratio: float, finite: bool, divisions: int) -> MembraneAnswer:
    """Solve with mu = 1 Pa on a mesh of `divisions` cells a side.

    Args:
        finite: finite strains (load raised in four steps); else the linear solution.

    Raises:
        ImportError: scikit-fem is absent.
        RuntimeError: Newton's method did not converge.
    """
    from scipy.sparse import bmat
    from skfem import (
        Basis,
        BilinearForm,
        ElementTriP1,
        ElementTriP2,
        ElementVector,
        FacetBasis,
        LinearForm,
        condense,
        solve,
    )

    kappa = 2.0 * (1.0 + poissons_ratio) / (3.0 * (1.0 - 2.0 * poissons_ratio))
    mesh = _mesh(divisions)
    ub = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    pb = ub.with_element(ElementTriP1())
    right = mesh.facets_satisfying(lambda x: np.isclose(x[0], CORNERS[1, 0]), boundaries_only=True)
    clamped = ub.get_dofs(lambda x: np.isclose(x[0], 0.0))

    def cof(H):
        return np.array([[H[1, 1], -H[1, 0]], [-H[0, 1], H[0, 0]]])

    def dot(A, B):
        return np.einsum("ij...,ij...->...", A, B)

    def kinematics(w):
        F = np.eye(2)[:, :, None, None] + w["u"].grad
        C = cof(F)
        J = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
        return F, C, J, dot(F, F) + 1.0, J ** (-2.0 / 3.0)

    @BilinearForm
    def stiffness(u, v, w):
        F, C, J, I1, a = kinematics(w)
        G, H = u.grad, v.grad
        CG, CH = dot(C, G), dot(C, H)
        iso = (
            dot(G, H)
            - 2.0 / (3.0 * J) * (CG * dot(F, H) + dot(F, G) * CH)
            + 5.0 * I1 / (9.0 * J**2) * CG * CH
        )
        return a * (iso - I1 / (3.0 * J) * dot(cof(G), H)) + w["p"] * dot(cof(G), H)

    @BilinearForm
    def volume(u, q, w):
        return q * dot(kinematics(w)[1], u.grad)

    @BilinearForm
    def softness(p, q, w):
        return p * q / kappa

    @LinearForm
    def inner_force(v, w):
        F, C, J, I1, a = kinematics(w)
        return a * (dot(F, v.grad) - I1 / (3.0 * J) * dot(C, v.grad)) + w["p"] * dot(C, v.grad)

    @LinearForm
    def swelling(q, w):
        return q * (kinematics(w)[2] - 1.0 - w["p"] / kappa)

    @LinearForm
    def lift(v, w):
        return SHEAR * v[1]

    load = lift.assemble(FacetBasis(mesh, ub.elem, facets=right, intorder=4))
    M = softness.assemble(pb)
    n = ub.N
    x = np.zeros(n + pb.N)
    for share in (0.25, 0.5, 0.75, 1.0) if finite else (1.0,):
        for _ in range(12):
            fields = {"u": ub.interpolate(x[:n]), "p": pb.interpolate(x[n:])}
            K, B = stiffness.assemble(ub, **fields), volume.assemble(ub, pb, **fields)
            A = bmat([[K, B.T], [B, -M]], "csr")
            r = np.concatenate(
                [share * load - inner_force.assemble(ub, **fields), -swelling.assemble(pb, **fields)]
            )
            step = solve(*condense(A, r, D=clamped))
            x += step
            if not finite or np.abs(step[:n]).max() < 1e-10 * CORNERS.max():
                break
        else:
            raise RuntimeError("the mixed reference did not converge")
    tip = ub.nodal_dofs[1, np.argmin(np.linalg.norm(mesh.p - CORNERS[2][:, None], axis=0))]
    return MembraneAnswer(float(x[tip]), float(load @ x[:n]) / (CORNERS[2, 1] - CORNERS[1, 1]))


def quadrilateral(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """(2, n) m; points of the membrane at 0 <= s, t <= 1."""
    return CORNERS.T @ np.array([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])


def _mesh(divisions: int):
    from skfem import MeshTri

    line = np.linspace(0.0, 1.0, divisions + 1)
    mesh = MeshTri.init_tensor(line**2, 1.0 - (1.0 - line) ** 2)
    return MeshTri(quadrilateral(*mesh.p), mesh.t)


def _print() -> None:
    for finite in (False, True):
        for nu in POISSONS_RATIOS:
            coarse, fine = (solve_membrane(nu, finite, n) for n in ((16, 32) if finite else (32, 64)))
            print(
                f"    ({nu}, {finite}): MembraneAnswer({fine.tip:.6e}, {fine.work:.6e}),"
                f"  # half as fine: {coarse.tip:.6e}, {coarse.work:.6e}"
            )


if __name__ == "__main__":
    _print()
