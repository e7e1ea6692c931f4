# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows against a second, independent finite element code: FElupe (Dutzler, github.com/adtzlr/felupe).

The same quadratic tetrahedra under the same random displacement: forces and stiffness, entry by entry.  FElupe
integrates everything at four points, so ours does too here (full_share = inf).  The neo-Hookean solid is FElupe's own;
its other models need a package for automatic differentiation, so for those FElupe's element gets stress and tangent
from this file, which knows only the energies of principal stretches (principal_energy.py) and NumPy's eigenvectors:

    P = sum_a tau_a / l_a  u_a (x) v_a,   F = sum_a l_a u_a (x) v_a,   and with H_ab = u_a . dF v_b
    dP_aa = sum_b (h_ab - tau_a d_ab) / (l_a l_b) H_bb
    dP_ab = a_ab H_ab + b_ab H_ba,   a_ab = (tau_a - tau_b)/(l_a^2 - l_b^2),   b_ab = (a_ab l_b^2 - tau_b) / (l_a l_b)

(Ogden, Non-linear Elastic Deformations, 1984, section 6.1).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.assembly import ElementSystem
from palpate.fem_offline.material import Linear, Material, NeoHookean
from palpate.fem_offline.principal_energy import principal_energy
from palpate.fem_offline.quadratic_space import FOUR_POINT_RULE, QuadraticSpace
from palpate.fem_offline.verification.elements import irregular_mesh, stiffness_of
from palpate.fem_offline.verification.materials import MODELS
from palpate.fem_offline.verification.row import Row, not_run

__all__ = ["second_code_rows", "stress_and_tangent"]

BAR = 1e-8


def second_code_rows() -> Iterator[Row]:
    """Force and stiffness of every objective model; one row that says so where FElupe is not installed."""
    try:
        import felupe
    except ImportError:
        missing = "FElupe is not installed (pip install felupe)"
        yield not_run("forces and stiffness of a second code", "FElupe", BAR, missing)
        return
    space = irregular_mesh()
    u = 4e-4 * np.random.default_rng(11).standard_normal(space.nodes.shape)
    for name, material in MODELS.items():
        if isinstance(material, Linear):
            continue
        force, stiffness = _felupe(felupe, space, material, u)
        ours = ElementSystem(space, [material], np.ones((len(space.elements), 1)), full_share=np.inf)
        own_force, own_stiffness = ours.state(u).force, stiffness_of(ours, u)
        reference = f"FElupe {felupe.__version__}"
        off = float(np.abs(own_force - force).max() / np.abs(force).max())
        yield Row(f"force of a second code, {name}", reference, float(np.abs(force).max()), off, BAR)
        off = float(np.abs((own_stiffness - stiffness).data).max() / np.abs(stiffness.data).max())
        yield Row(
            f"stiffness of a second code, {name}", reference, float(np.abs(stiffness.data).max()), off, BAR
        )


def _felupe(felupe, space: QuadraticSpace, material: Material, u: np.ndarray):
    """(N, 3) N and (3 N, 3 N) N/m, from FElupe."""
    mesh = felupe.Mesh(space.nodes, space.elements, cell_type="tetra10")
    # FElupe's own points are rounded to seven digits, which leaves 1e-8 to 8e-8 in forces and stiffness.
    rule = felupe.quadrature.Scheme(FOUR_POINT_RULE[:, 1:], np.full(4, 1.0 / 24.0))
    region = felupe.RegionQuadraticTetra(mesh, quadrature=rule)
    field = felupe.FieldContainer([felupe.Field(region, dim=3, values=u.copy())])
    if isinstance(material, NeoHookean):
        law = felupe.NeoHooke(mu=material.shear_modulus, bulk=material.bulk_modulus)
    else:
        law = felupe.Material(
            stress=lambda x: [_at_points(material, x[0])[0], x[-1]],
            elasticity=lambda x: [_at_points(material, x[0])[1]],
        )
    solid = felupe.SolidBody(law, field)
    force = np.asarray(solid.assemble.vector().todense()).reshape(-1, 3)
    return force, solid.assemble.matrix().tocsr()


def _at_points(material: Material, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """FElupe's layout: F (3, 3, q, c) -> P (3, 3, q, c), A (3, 3, 3, 3, q, c)."""
    P, A = stress_and_tangent(material, np.moveaxis(F, (0, 1), (-2, -1)).reshape(-1, 3, 3))
    trailing = F.shape[2:]
    return (
        np.moveaxis(P.reshape(*trailing, 3, 3), (-2, -1), (0, 1)),
        np.moveaxis(A.reshape(*trailing, 3, 3, 3, 3), (-4, -3, -2, -1), (0, 1, 2, 3)),
    )


def stress_and_tangent(material: Material, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """P (n, 3, 3) and A (n, 3, 3, 3, 3), Pa, at F (n, 3, 3) whose stretches all differ."""
    u, l, vt = np.linalg.svd(F)
    flip = np.linalg.det(u)
    u = u * np.where(np.arange(3) == 2, flip[:, None], 1.0)[:, None, :]
    vt = vt * np.where(np.arange(3) == 2, flip[:, None], 1.0)[:, :, None]
    _, tau, h = principal_energy(material, np.log(l))
    J, kappa = np.linalg.det(F), material.bulk_modulus
    tau = tau + (kappa * (J - 1.0) * J)[:, None]
    h = h + (kappa * J * (2.0 * J - 1.0))[:, None, None]
    one = np.eye(3)
    products = l[:, :, None] * l[:, None, :]
    gaps = l[:, :, None] ** 2 - l[:, None, :] ** 2 + one
    a = (tau[:, :, None] - tau[:, None, :]) / gaps
    b = (a * l[:, None, :] ** 2 - tau[:, None, :]) / products
    normal = (h - tau[:, :, None] * one) / products
    local = np.einsum("nab,ac,bd->nacbd", normal, one, one)  # [a, c, b, d]: dP_ac to H_bd
    local += np.einsum("nac,ab,cd->nacbd", a * (1.0 - one), one, one)
    local += np.einsum("nac,ad,cb->nacbd", b * (1.0 - one), one, one)
    P = np.einsum("nia,na,nak->nik", u, tau / l, vt)
    A = np.einsum("nacbd,nia,nck,njb,ndl->nikjl", local, u, vt, u, vt, optimize=True)
    return P, A
