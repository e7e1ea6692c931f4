# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The force of a shock: a virtual mass m that meets a surface at v and leaves it again.

    m d'' = -(K(d) d + D(d) d'),      K(d) = k0 d^i,   D(d) = B0 d

(V. Hayward, Physically-based haptic synthesis, 2008, section 6, after Hunt and Crossley, 1975), integrated
from d = 0, d' = v
until d is 0 again.  Both terms vanish with d, so the force is continuous and zero at both ends.  Loss: with u
= d' and the
slope s(d) = u^2 / 2, the motion is m u du/dd = -(k0 d^(i+1) + B0 d u).  For i = 0 that separates,

    m u du / (k0 + B0 u) = -d dd,

so that the speed w at which the mass leaves follows from g(v) = g(-w), g(u) = u / B0 - k0 / B0^2 log(1 + B0 u
/ k0), and the loss
is m (v^2 - w^2) / 2: `loss`, without integration over time.  Limit: other i have no such form, and `loss` refuses them.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from palpate.author.errors import InputError, InputProblem

__all__ = ["loss", "shock"]

LONGEST = 0.5
"""s; a mass that is still in the surface then is refused."""


def shock(
    velocity: float, mass: float, stiffness: float, damping: float, exponent: float = 0.0, rate: float = 1e4
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depth (n,) m, speed (n,) m/s and force on the mass, out of the surface, (n,) N, at 1 / rate s until d
    returns to zero.

    Args:
        velocity: m/s, above 0; mass: kg; stiffness: k0, N/m^(i+1); damping: B0, N s/m2; exponent: i, at least 0.

    Raises:
        InputError: a number is out of range, or the mass does not come back within half a second.
    """
    for key, value in {"velocity": velocity, "mass": mass, "stiffness": stiffness, "rate": rate}.items():
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(InputProblem("", f"shock.{key}", value, "is not usable", "above 0"))
    for key, value in {"damping": damping, "exponent": exponent}.items():
        if not (np.isfinite(value) and value >= 0.0):
            raise InputError(InputProblem("", f"shock.{key}", value, "is not usable", "0 or more"))

    def force(d: np.ndarray, u: np.ndarray) -> np.ndarray:
        d = np.maximum(d, 0.0)
        return stiffness * d ** (exponent + 1.0) + damping * d * u

    def left(t: float, y: np.ndarray) -> float:
        return y[0] if t > 0.0 else 1.0

    left.terminal, left.direction = True, -1  # type: ignore[attr-defined]
    # Depths are micrometres to millimetres: absolute tolerances far below.
    found = solve_ivp(
        lambda t, y: [y[1], -force(y[0], y[1]) / mass],
        (0.0, LONGEST),
        [0.0, velocity],
        events=left,
        rtol=1e-10,
        atol=1e-14,
        dense_output=True,
        max_step=0.02,
    )
    if not len(found.t_events[0]):
        what = f"keeps its mass for more than {LONGEST} s at {velocity:g} m/s"
        raise InputError(InputProblem("", "shock", None, what, "a stiffer or less damped shock"))
    end = found.t_events[0][0]
    depth, speed = found.sol(np.append(np.arange(0.0, end, 1.0 / rate), end))
    return depth, speed, force(depth, speed)


def loss(velocity: float, mass: float, stiffness: float, damping: float) -> float:
    """J that a shock with exponent 0 takes from the mass, in closed form (see above)."""
    if damping == 0.0:
        return 0.0

    def g(u: float) -> float:
        return u / damping - stiffness / damping**2 * np.log1p(damping * u / stiffness)

    slowest = -stiffness / damping  # g goes to infinity there
    u = brentq(lambda u: g(u) - g(velocity), max(-velocity, slowest * (1.0 - 1e-12)), 0.0, xtol=1e-15)
    return 0.5 * mass * (velocity**2 - u**2)
