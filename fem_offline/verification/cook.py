# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Cook's membrane with this package's tetrahedra, against a converged mixed solution at each Poisson's ratio.

A slab with corners (0, 0), (48, 44), (48, 60), (0, 44) mm, one cell thick, u_z = 0 on both faces (plane strain),
clamped at x = 0, sheared at x = 48 mm (Cook, Improved two-dimensional finite element, J. Struct. Div. 100:1851-1863,
1974).  It bends, it shears and, near nu = 0.5, must not change the volume of any element.  Both the tip's displacement
and the load's work have to be right.

Linear tetrahedra on the same mesh are the negative control: a test that they pass can tell nothing.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.block import block
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.verification.loaded_body import (
    LoadedBody,
    faces_where,
    finite_strain,
    small_strain,
    uniform_load,
)
from palpate.fem_offline.verification.mixed_membrane import (
    CORNERS,
    POISSONS_RATIOS,
    SHEAR,
    MembraneAnswer,
    membrane_answer,
    quadrilateral,
)
from palpate.fem_offline.verification.row import Row

__all__ = ["answer_of", "cook_rows", "membrane", "off_by"]

COARSE = 8
"""Cells along a side; a press has some 9 elements (0.33 a each) across its contact."""


def membrane(poissons_ratio: float, divisions: int) -> LoadedBody:
    """The membrane in divisions x divisions x 1 cells of five tetrahedra, mu = 1 Pa."""
    unit = block((1.0, 1.0, 1.0), (divisions, divisions, 1))
    thickness = (CORNERS[2, 1] - CORNERS[0, 1]) / divisions
    s, t, depth = unit.points.T
    points = np.column_stack([quadrilateral(s + 0.5, t + 0.5).T, thickness * depth])
    space = quadratic_space(points, unit.tets)
    x, _, z = space.nodes.T
    held = np.zeros(space.nodes.shape, bool)
    held[x < 1e-9] = True
    held[(z > -1e-9) | (z < 1e-9 - thickness), 2] = True
    faces = faces_where(space, lambda x: x[:, 0] > CORNERS[1, 0] - 1e-9)
    material = NeoHookean(2.0 * (1.0 + poissons_ratio), poissons_ratio)
    return LoadedBody(space, material, held, uniform_load(space, faces, np.array([0.0, SHEAR, 0.0])))


def answer_of(body: LoadedBody, u: np.ndarray) -> MembraneAnswer:
    """Tip displacement and load work of a displacement (N, 3) m."""
    tip = np.argmin(np.linalg.norm(body.space.nodes - [*CORNERS[2], 0.0], axis=1))
    return MembraneAnswer(float(u[tip, 1]), body.work(u) / float(body.load[:, 1].sum()) * SHEAR)


def off_by(answer: MembraneAnswer, expected: MembraneAnswer) -> tuple[float, float]:
    """Tip and work, each over what is expected, minus 1; the worse one last."""
    tip, work = answer.tip / expected.tip - 1.0, answer.work / expected.work - 1.0
    return (work, tip) if abs(tip) > abs(work) else (tip, work)


def cook_rows(ratios: tuple[float, ...] = POISSONS_RATIOS, finite: bool = True) -> Iterator[Row]:
    """The sweep at small strain, linear tetrahedra beside it; with `finite`, at finite strain too."""
    for nu in ratios:
        body = membrane(nu, COARSE)
        expected, source = membrane_answer(nu, finite=False)
        better, worse = off_by(answer_of(body, small_strain(body)), expected)
        failing, _ = off_by(answer_of(body, small_strain(body, linear=True)), expected)
        name = f"Cook's membrane, nu = {nu:g}"
        note = (
            f"tip and work off by {worse:+.1%} and {better:+.1%}; linear tetrahedra by {failing:+.1%} at best"
        )
        yield Row(name, source, 1.0 + worse, abs(worse), 0.03, note)
        if nu >= 0.49:
            note = (
                "a negative control: the error is 15 % over how far off they are, so met means that they fail"
            )
            yield Row(
                f"{name}: linear tetrahedra fail", source, 1.0 + failing, 0.15 / abs(failing), 1.0, note
            )
    for nu in (ratios[0], ratios[-1]) if finite else ():
        body = membrane(nu, COARSE)
        expected, source = membrane_answer(nu, finite=True)
        _, worse = off_by(answer_of(body, finite_strain(body, steps=4)), expected)
        note = f"neo-Hookean; the tip moves {1e3 * expected.tip:.1f} mm"
        yield Row(
            f"Cook's membrane at finite strain, nu = {nu:g}", source, 1.0 + worse, abs(worse), 0.03, note
        )
