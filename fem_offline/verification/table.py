# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The verification table: every row, cheap ones first.

A row that could not be computed is a row that is not met; its note says why.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from palpate.fem_offline.verification.calculix_rows import calculix_rows, tool_size_rows
from palpate.fem_offline.verification.convergence import convergence_rows
from palpate.fem_offline.verification.cook import cook_rows
from palpate.fem_offline.verification.covered_half_space import covered_rows
from palpate.fem_offline.verification.elements import element_rows
from palpate.fem_offline.verification.fidelity import fidelity_rows
from palpate.fem_offline.verification.friction_rows import drag_rows, no_slip_rows, partial_slip_rows
from palpate.fem_offline.verification.half_space import (
    RADIUS,
    energy_rows,
    force_rows,
    large_indentation_rows,
    poisson_rows,
    press_half_space,
    refinement_row,
)
from palpate.fem_offline.verification.layer_rows import layer_rows
from palpate.fem_offline.verification.locking import locking_rows
from palpate.fem_offline.verification.materials import material_rows
from palpate.fem_offline.verification.nodule import nodule_rows
from palpate.fem_offline.verification.potential import lateral_rows
from palpate.fem_offline.verification.row import Row
from palpate.fem_offline.verification.second_code import second_code_rows
from palpate.fem_offline.verification.sheet import sheet_rows
from palpate.fem_offline.verification.sticking_disc import sticking_rows
from palpate.fem_offline.verification.tetrahedralised import tetrahedralised_rows
from palpate.fem_offline.verification.tool_rows import tool_rows

__all__ = ["table"]

DEPTHS = RADIUS * np.array([0.05, 0.1, 0.15, 0.2, 0.25, 0.3])


def table(everything: bool) -> Iterator[Row]:
    """Rows as they are found: under a minute on one core; with `everything`, a quarter of an hour."""
    for name, make in _slow() if everything else _fast():
        try:
            yield from make()
        except Exception as error:
            yield Row(name, "", np.nan, np.inf, 0.0, f"{type(error).__name__}: {error}")


def _fast() -> Iterator[tuple[str, Callable[[], Iterator[Row]]]]:
    yield "elements", element_rows
    yield "materials", material_rows
    yield "capsule", sheet_rows
    yield "a second code", second_code_rows
    yield "locking", lambda: locking_rows(confined=False)
    yield "Cook's membrane", lambda: cook_rows(finite=False)
    yield "convergence", lambda: convergence_rows(everything=False)
    yield "fTetWild mesh", lambda: tetrahedralised_rows(modes=False)
    yield "half space", lambda: _half_space(everything=False)
    yield "lateral push", lambda: lateral_rows(anew=False)


def _slow() -> Iterator[tuple[str, Callable[[], Iterator[Row]]]]:
    yield "elements", element_rows
    yield "materials", material_rows
    yield "capsule", sheet_rows
    yield "a second code", second_code_rows
    yield "locking", lambda: locking_rows(confined=True)
    yield "Cook's membrane", lambda: cook_rows(finite=True)
    yield "convergence", lambda: convergence_rows(everything=True)
    yield "fTetWild mesh", lambda: tetrahedralised_rows(modes=True)
    yield "half space", lambda: _half_space(everything=True)
    yield "lateral push", lambda: lateral_rows(anew=True)
    yield "Poisson's ratio", poisson_rows
    yield "large indentation", _large_indentation
    yield "tools", tool_rows
    yield "sticking", sticking_rows
    yield "partial slip", partial_slip_rows
    yield "press without slip", no_slip_rows
    yield "drags", drag_rows
    yield "covered half space", covered_rows
    yield "fidelity", fidelity_rows
    yield "bonded layers", layer_rows
    yield "nodule", nodule_rows
    yield "CalculiX", calculix_rows
    yield "tool size", tool_size_rows


def _half_space(everything: bool) -> Iterator[Row]:
    pressed = press_half_space(DEPTHS)
    yield from force_rows(pressed)
    yield from energy_rows(pressed.record)
    if everything:
        yield refinement_row(pressed.record, press_half_space(DEPTHS, refinement=1.5).record, 1.5)


def _large_indentation() -> Iterator[Row]:
    yield from large_indentation_rows(
        press_half_space(RADIUS * np.array([0.1, 0.2, 0.3]), poissons_ratio=0.495)
    )
