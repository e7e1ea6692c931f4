# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of the contact law: Luo and Xiao's Table 1 (IEEE CG&A 24(6), 2004) as the preset.

Decided: mu and mu_D have no unit (the table says N/kg); equation 5 takes mu_D, as the text says and the
equation does not; g points along -z.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["LUO_XIAO", "Law"]


@dataclass(frozen=True)
class Law:
    """Attributes:
    threshold: m; eps: contact where surfaces are nearer.
    stiffness: N/m; K.  damping: N s/m; D.  tangential_stiffness: N/m; K_p.
    static_friction, kinetic_friction: mu, mu_D.
    depth_max: m; contact deeper than this below the surface is released.
    speed_static: m/s; what moves slower is at rest.
    hysteresis: a principal contact is kept up to (1 + hysteresis) eps.
    gravity: (3,) m/s2.
    """

    threshold: float = 1e-3
    stiffness: float = 2300.0
    damping: float = 5.0
    static_friction: float = 0.7
    kinetic_friction: float = 0.08
    tangential_stiffness: float = 1600.0
    depth_max: float = 2e-3
    speed_static: float = 1e-3
    hysteresis: float = 0.25
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.8)


LUO_XIAO = Law()
"""Table 1."""
