# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about the orders at which displacements converge, against each element's theory.

Errors of u (L2) and of its gradient (H1), element size h:

    quadratic, kappa whole at four points (nu <= 2/7)    h^3  h^2
    quadratic, kappa split, the rest at the centre       h^2  h^1     its pressure is constant in each element
    linear tetrahedra                                    h^2  h^1     (where they do not lock)

(Boffi, Brezzi and Fortin, Mixed Finite Element Methods and Applications, 2013, sections 8.4 to 8.6.)

Split elements are of the second kind as soon as any of kappa is at the centre, but the first-order error is that of a
pressure that varies within elements: where shear dominates, coarse meshes still converge at the higher order.  Measured
with A = B = 0.1 at nu = 0.48, 4 to 8 cells: slopes 2.1 and 1.4.  The rows' solutions are dominated by pressure, so that
they show what holds in the end.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.verification.loaded_body import finite_strain, small_strain
from palpate.fem_offline.verification.manufactured import Manufactured, errors, manufactured_body
from palpate.fem_offline.verification.row import Row

__all__ = ["convergence_rows", "slopes"]


def slopes(solution: Manufactured, divisions: tuple[int, ...], linear: bool = False) -> tuple[float, float]:
    """Orders of the errors of u and grad u between the last two meshes of a sequence of cubes.

    Each finite-strain solve starts from the exact displacement of its nodes, so that what is measured is the elements
    and not the way to the solution.
    """
    found = []
    for n in divisions[-2:]:
        body = manufactured_body(solution, n)
        u = finite_strain(body, body.given) if solution.finite else small_strain(body, linear)
        found.append(errors(body.space, u, solution))
    order = np.log(np.array(found[-2]) / found[-1]) / np.log(divisions[-1] / divisions[-2])
    return float(order[0]), float(order[1])


def convergence_rows(everything: bool) -> Iterator[Row]:
    """Small strains; with `everything`, finite strains and finer meshes too."""
    fine = (6, 8) if everything else (4, 6)
    whole, split = "quadratic, kappa whole", "quadratic, kappa split"
    yield from _rows(f"{whole}, nu = 0.25", Manufactured(0.25, 0.1, 0.1, False), fine, (3, 2))
    for nu in (0.48, 0.4999):
        yield from _rows(f"{split}, nu = {nu}", Manufactured(nu, 0.1, 0.5, False), fine, (2, 1))
    yield from _rows("linear, nu = 0.25", Manufactured(0.25, 0.1, 0.1, False), fine, (2, 1), linear=True)
    if everything:
        name = "finite strain"
        yield from _rows(f"{whole}, nu = 0.25, {name}", Manufactured(0.25, 0.25, 0.25, True), (4, 6), (3, 2))
        for nu in (0.48, 0.4999):
            yield from _rows(f"{split}, nu = {nu}, {name}", Manufactured(nu, 0.1, 0.6, True), (4, 6), (2, 1))


def _rows(
    name: str,
    solution: Manufactured,
    divisions: tuple[int, ...],
    theory: tuple[int, int],
    linear: bool = False,
) -> Iterator[Row]:
    note = f"manufactured solution, {' and '.join(map(str, divisions))} cells a side; error is off the slope"
    found = slopes(solution, divisions, linear)
    for what, order, expected in zip(("u", "grad u"), found, theory, strict=True):
        reference = f"theory: order {expected}"
        yield Row(f"order of {what}: {name}", reference, order, abs(order - expected), 0.15, note)
