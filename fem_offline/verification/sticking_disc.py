# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about sticking contact: a disc of known radius bonded to the half space at rest.

The disc is chosen by hand (every quadrature point within a), so that what is compared is the discrete contact alone.
A stuck *press* differs for two more reasons, both physical: the tissue is already deformed (k_t 3.5 % more and k_n
2.4 % less at d = 0.1 R, same points, same mesh), and a body of 120 x 120 x 60 mm is stiffer than a half space.

Measured (nu = 0.48): k_t is 3.9 % high with edges of 0.28 a, 1.9 % with 0.18 a, 0.8 % with 0.12 a; k_n 3.9, 2.2 and
1.6 %: faces that the disc's rim cuts are held as far out as their quadrature points reach.  The sticking penalty gives
a little way at the rim, where a rigid disc's traction is singular, and hides 1 to 2 % of that.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.contact import Sticking
from palpate.fem_offline.equilibrium import equilibrate
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import PressSettings
from palpate.fem_offline.site import Site, open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification import mindlin
from palpate.fem_offline.verification.blocks import half_space
from palpate.fem_offline.verification.half_space import PLACE
from palpate.fem_offline.verification.row import Row, against

__all__ = ["bonded_disc", "sticking_rows"]

MATERIAL = NeoHookean(5400.0, 0.48)
DISC = 5e-3


def bonded_disc(site: Site, radius: float, move: np.ndarray) -> np.ndarray:
    """(3,) N; force on a bonded disc of `radius` (m) that is moved by `move` (3,) m from rest."""
    settings, surface = PressSettings(), site.surface
    away = surface.rest - site.contact_point
    # Points with a base traction are held; 1e-9 Pa holds without pressing.
    base = np.where(np.linalg.norm(away, axis=2)[..., None] < radius, -1e-9 * site.normal, 0.0)
    penalty = settings.sticking_penalty * settings.penalty * site.youngs_modulus
    stuck = Sticking(surface, penalty, surface.rest, base, site.contact_point, np.asarray(move, float))
    found = equilibrate(site.body, stuck, np.zeros_like(site.body.nodes), 1e-7, 1e-12)
    return found.contact.force


def sticking_rows(refinement: float = 1.6) -> Iterator[Row]:
    """k_n, k_t and their ratio."""
    tool = Sphere(DISC)
    size = patch_size(
        tool, DISC, refinement=refinement
    )  # the finest edges, 0.28 a / refinement, out to a = DISC
    site = open_site(half_space(MATERIAL), PLACE, tool, size)
    small = 1e-5 * DISC
    normal = -bonded_disc(site, DISC, -small * site.normal) @ -site.normal / small
    across = -bonded_disc(site, DISC, small * np.array([1.0, 0.0, 0.0]))[0] / small
    E, nu = MATERIAL.youngs_modulus, MATERIAL.poissons_ratio
    expected = mindlin.tangential_stiffness(E, nu, DISC), mindlin.normal_stiffness(E, nu, DISC)
    yield against("bonded disc, k_t", "Mindlin 1949", across, expected[0], 0.05)
    yield against("bonded disc, k_n", "Boussinesq's punch", normal, expected[1], 0.05)
    yield against(
        "bonded disc, k_t/k_n", "2 (1 - nu) / (2 - nu)", across / normal, expected[0] / expected[1], 0.05
    )
