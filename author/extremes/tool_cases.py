# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Tools at their ends: a tip of 0.1 mm, a plate wider than the organ.

Balls, cones and punches against Sneddon's profiles on a half space; what is wider than the organ against a bar that is
pressed evenly (nu = 0), or a fresh press on a finer mesh.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.author.extremes import block_press as b
from palpate.author.extremes.case import Case, close_to, must_refuse
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.tool import Cone, FlatPunch, Sphere
from palpate.fem_offline.verification import hertz, sneddon

__all__ = ["tool_cases"]

RADII = (1e-4, 1e-3, 3e-2)
"""m."""
POISSON = 0.48
PATCH = 14e-3
"""m."""


def tool_cases() -> Iterator[Case]:
    for radius in RADII:
        yield Case("tool", f"ball of {1e3 * radius:g} mm", lambda r=radius: _ball(r))
    yield Case("tool", "cone with a tip of 0.1 mm", _cone)
    yield Case("tool", "punch of 0.1 mm", _punch)
    yield Case("tool", "ball of 100 mm, wider than the organ", _wide_ball)
    yield Case("tool", "plate of 200 mm, wider than the organ", _plate, True)
    for radius in (0.0, -5e-3, np.nan):
        yield Case(
            "tool", f"ball of {1e3 * radius:g} mm", lambda r=radius: must_refuse(lambda: Sphere(r)), True
        )


def _on_half_space(tool, depth: float) -> float:
    """N."""
    organ = b.half_space(b.MODULUS, POISSON)
    return float(b.pressed(organ, tool, [depth], refinement=1.0, patch=PATCH).force[-1])


def _modulus() -> float:
    return hertz.effective_modulus(b.MODULUS, POISSON)


def _ball(radius: float) -> str:
    depth = 0.05 * radius
    expected = sneddon.sphere_force(_modulus(), radius, np.array(depth))
    return close_to(
        "force against Sneddon's sphere", _on_half_space(Sphere(radius), depth), float(expected), 0.03
    )


def _cone() -> str:
    """Less deep than its tip of 0.1 mm reaches, and on to the flank."""
    radius, angle, depth = 1e-4, np.radians(45.0), 4e-5
    expected = sneddon.profile_force(_modulus(), *sneddon.cone_profile(angle, radius, 1e-2), depth)
    force = _on_half_space(Cone(angle, tip_radius=radius), depth)
    return close_to("force against Sneddon's profile", force, expected, 0.03)


def _punch() -> str:
    radius, edge, depth = 1e-4, 2e-5, 2e-6
    expected = sneddon.profile_force(_modulus(), *sneddon.punch_profile(radius, edge), depth)
    force = _on_half_space(FlatPunch(radius, edge), depth)
    return close_to("force against Sneddon's profile", force, expected, 0.05)


def _wide_ball() -> str:
    forces = [
        b.pressed(
            b.block(NeoHookean(b.MODULUS, POISSON)),
            Sphere(0.1),
            [1e-3],
            patch=0.1,
            place=(0, 0, 0),
            refinement=r,
        ).force[-1]
        for r in (0.6, 0.9)
    ]
    return close_to("force against a fresh press on a finer mesh", *map(float, forces), 0.02)


def _plate() -> str:
    """nu = 0, pressed evenly: a bar of area A and height h."""
    organ = b.block(NeoHookean(b.MODULUS, 0.0))
    record = b.pressed(organ, FlatPunch(0.2, 1e-3), [1e-5], patch=0.2, place=(0.0, 0.0, 0.0))
    expected = b.MODULUS * 0.06**2 * 1e-5 / 0.04
    return close_to("force against a bar", float(record.force[-1]), expected, 0.01)
