# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How much of Coulomb's coefficient a sliding tool feels, to first order in it, from a press without friction.

A tool that slides along e pulls at every point of its contact with mu p t, t along the point's own tangent plane
(t = T e / |T e|, T = 1 - n n^T).  The tissue gives way by du, and pressure and normals follow:

    (H + G) du = sum_q w_q N_a (p t + dl n),     G = sum_q w_q N_a N_b (eps n n^T - p Hess g)       per unit of mu
    d(traction) = p t + dl n - (eps n n^T - p Hess g) du

with dl the change of the multipliers, dl <- dl - eps n . du after each solve, as a press updates them.  What resists
along e, over the normal force f_n, is the share

    (e . sum_q w_q d(traction)) / f_n  =  slope of the contact  +  ploughing
                                          sum p |T e| / f_n        pressure that moves ahead of the tool

so that a coefficient mu is felt as mu times the share (dragging.py finds the same by dragging, at any mu, for a
hundred times the cost).  Both ways along e have the same share: friction is odd in the direction to first order.
"""

from __future__ import annotations

import numpy as np

from palpate.fem_offline.contact import Unilateral
from palpate.fem_offline.equilibrium import Equilibrium
from palpate.fem_offline.ladder import PressSettings
from palpate.fem_offline.site import Site
from palpate.fem_offline.tool import tangents

__all__ = ["friction_share", "share_along"]

TOLERANCE = 1.0e-4
"""Of the linear solves: shares are wanted to a thousandth."""


def friction_share(site: Site, found: Equilibrium, contact: Unilateral, settings: PressSettings) -> float:
    """Mean share over two tangents of the site's normal; 1 where nothing touches.

    Args:
        found: equilibrium without friction.  contact: its contact, where it was found.

    Raises:
        ArithmeticError: a linear solve failed.
    """
    if not found.contact.area:
        return 1.0
    return float(np.mean([share_along(site, found, contact, settings, e) for e in tangents(site.normal)]))


def share_along(
    site: Site, found: Equilibrium, contact: Unilateral, settings: PressSettings, e: np.ndarray
) -> float:
    """Share along the unit tangent e (3,); arguments and errors as `friction_share`."""
    body, surface, u = site.body, site.surface, found.u
    pressure = np.linalg.norm(found.contact.traction, axis=2)
    normal, give = contact.give(u, pressure)
    along = e - (normal @ e)[:, :, None] * normal
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
    pull = pressure[:, :, None] * along
    free = body.equation >= 0
    body.linearise(u, surface.hessian(give), 0.0)
    multiplier = np.zeros_like(pressure)
    for _ in range(settings.updates + 1):
        load = pull + multiplier[:, :, None] * normal
        response = np.zeros(u.size)
        response[free] = body.solve(surface.nodal(load, len(u)).ravel()[free], TOLERANCE)
        moved = surface.points(response.reshape(-1, 3)) - surface.rest
        change = load - np.einsum("bqij,bqj->bqi", give, moved)
        opening = np.einsum("bqi,bqi->bq", normal, moved)
        multiplier -= np.where(pressure > 0.0, contact.penalty * opening, 0.0)
    resists = np.einsum("bq,bqi->i", surface.weight, change) @ e
    return float(resists / (found.contact.force @ site.normal))
