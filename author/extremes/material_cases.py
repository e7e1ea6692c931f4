# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Stiffness, contrasts of stiffness, and Poisson's ratio at their ends.

Stiffness: force is proportional to Young's modulus.  Contrast: a layer on tissue a million times as stiff is a layer on
a rigid base; on tissue a million times as soft, force is proportional to both moduli at once.  Poisson's ratio: Hertz
as shallow as half_space.py says, and why.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from palpate.author.extremes import block_press as b
from palpate.author.extremes.case import Case, Wrong, close_to, must_refuse
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification import blocks, hertz
from palpate.fem_offline.verification.half_space import hertz_share

__all__ = ["material_cases"]

MODULI = (10.0, 1e3, 1e6, 1e10)
"""Pa."""
RATIOS = (0.0, 0.3, 0.45, 0.499, 0.4999, 0.49999)
HERTZ_BAR = 0.03
"""Of the verification table."""
LAYER = 0.01
"""m."""


def material_cases() -> Iterator[Case]:
    for modulus in MODULI:
        quick = modulus in (10.0, 1e10)
        yield Case("stiffness", f"{modulus:g} Pa", lambda E=modulus: _stiffness(E), quick)
    yield Case("stiffness", "1e+10 Pa, Hooke's law", lambda: _stiffness(1e10, linear=True))
    for modulus in (0.0, -5400.0, np.inf, np.nan):
        yield Case(
            "stiffness", f"{modulus:g} Pa", lambda E=modulus: must_refuse(lambda: NeoHookean(E, 0.48)), True
        )
    for contrast in (1e4, 1e6):
        yield Case("contrast", f"base {contrast:g} times as stiff, ball", lambda k=contrast: _on_base(k))
    for contrast in (1e-6, 1e-4):
        yield Case("contrast", f"base {contrast:g} times as stiff, ball", lambda k=contrast: _both_scaled(k))
    for nu in RATIOS:
        yield Case("poissons_ratio", f"{nu:g}", lambda nu=nu: _hertz(nu))
    for nu in (-1.0, 0.5, 0.6, np.nan):
        yield Case(
            "poissons_ratio", f"{nu:g}", lambda nu=nu: must_refuse(lambda: NeoHookean(5400.0, nu)), True
        )


def _stiffness(modulus: float, linear: bool = False) -> str:
    ratio = b.block_force(modulus, linear=linear) / b.block_force(linear=linear)
    return close_to(
        "force against Young's modulus, both over the usual ones", ratio, modulus / b.MODULUS, 1e-6
    )


def _layered(upper: float, lower: float, nu: float, law: type = NeoHookean, depth: float = LAYER) -> Organ:
    """The block with its upper `depth` (m) of one modulus (Pa), and the rest of another."""
    size, cells = (0.06, 0.06, 0.04), (4, 4, 4)
    return blocks.block_organ(
        size, cells, {0: law(upper, nu), 1: law(lower, nu)}, lambda x: (x[:, 2] < -depth).astype(int)
    )  # fmt: skip


def _ball(organ: Organ) -> float:
    return float(b.pressed(organ, Sphere(b.RADIUS), [b.DEPTH], patch=12e-3, refinement=0.8).force[-1])


@cache
def _alone() -> float:
    return _ball(b.block(NeoHookean(b.MODULUS, 0.48), cells=(4, 4, 1), height=LAYER))


def _on_base(contrast: float) -> str:
    organ = _layered(b.MODULUS, contrast * b.MODULUS, 0.48)
    bar = 0.01 + 2.0 / contrast
    return close_to("force against the layer alone on a rigid base", _ball(organ), _alone(), bar)


def _both_scaled(contrast: float) -> str:
    """The soft base's own modulus is then the usual one, and the layer's at the other end."""
    soft = _ball(_layered(b.MODULUS, contrast * b.MODULUS, 0.48))
    stiff = _ball(_layered(b.MODULUS / contrast, b.MODULUS, 0.48))
    held = close_to("force against both moduli, scaled", stiff * contrast, soft, 1e-4)
    if not soft < _alone():
        raise Wrong("a softer base makes no softer organ")
    return held


def _hertz(nu: float) -> str:
    depth = hertz_share(nu) * b.RADIUS
    record = b.pressed(b.half_space(b.MODULUS, nu), Sphere(b.RADIUS), [depth], refinement=1.0, patch=14e-3)
    expected = hertz.sphere_force(hertz.effective_modulus(b.MODULUS, nu), b.RADIUS, depth)
    return close_to("force against Hertz", float(record.force[-1]), float(expected), HERTZ_BAR)
