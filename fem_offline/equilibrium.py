# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Static equilibrium of a body in contact: Newton's method with an energy line search.

    Pi(u) = W(u) + Pi_c(u),   r = dPi/du = 0 on free components

The step solves H d = -r with the exact Hessian; where that is not positive definite the contact's geometric part is
left out, then a twentieth of the rest stiffness is added, and more, until it is.  No state with an inverted element
is ever accepted: its energy is infinite.

Close to equilibrium the energy's decrease, r.d / 2, drowns in the rounding of a sum over the whole body (psi_iso alone
carries 1e-16 mu V), and an energy line search would shrink good steps to nothing.  There a step is taken when it
halves the residual (compare the approximate Wolfe conditions of Hager and Zhang 2005).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.body import Body
from palpate.fem_offline.conjugate_gradients import NegativeCurvatureError, StaleError
from palpate.fem_offline.contact import ContactHessian, ContactState, Sticking
from palpate.fem_offline.coulomb import Coulomb
from palpate.fem_offline.linear_solver import NotPositiveDefiniteError

__all__ = ["Equilibrium", "EquilibriumError", "equilibrate"]

SUFFICIENT_DECREASE = 1.0e-4
FORCING = (1.0e-4, 0.05)
"""Smallest and largest reduction of the linear residual in a Newton step."""
NEAR = 1.0e-5
"""Relative residual below which the residual may judge a step; the energy's decrease is then some 1e-10 of it."""
LADDER = ((True, 0.0), (False, 0.0), (False, 0.05), (False, 0.5), (False, 5.0), (False, 50.0))
"""(contact's geometric part kept, share of the rest stiffness added), tried in turn."""


class EquilibriumError(RuntimeError):
    """No equilibrium was found; the message says why."""


class Contact(Protocol):
    def state(self, u: np.ndarray) -> ContactState: ...

    def hessian(self, u: np.ndarray, geometric: bool) -> ContactHessian: ...


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium.

    Attributes:
        u: (N, 3) m.
        elastic: energy and nodal forces of the tissue.
        contact: forces on the tool.
        residual: |r| / |force on the tool|.
        iterations: Newton steps taken.
    """

    u: np.ndarray
    elastic: ElementState
    contact: ContactState
    residual: float
    iterations: int


def _direction(body: Body, contact: Contact, u: np.ndarray, r: np.ndarray, tolerance: float) -> np.ndarray:
    stuck = isinstance(contact, Sticking | Coulomb)
    for geometric, shift in LADDER:
        try:
            body.linearise(u, contact.hessian(u, geometric), shift, stuck)
            return body.solve(-r, tolerance)
        except (NotPositiveDefiniteError, NegativeCurvatureError, StaleError):
            continue
    raise EquilibriumError(
        "the Hessian could not be made positive definite: the tissue is more distorted than its mesh can follow"
    )


def _forcing(residual: float, tolerance: float) -> float:
    """How far a Newton step's linear system is solved: as the residual, which keeps convergence quadratic, less early
    on, where the contact area still changes (Eisenstat and Walker 1996), and no further than the tolerance asks."""
    return float(np.clip(residual, max(0.3 * tolerance / residual, FORCING[0]), FORCING[1]))


def equilibrate(
    body: Body,
    contact: Contact,
    u: np.ndarray,
    tolerance: float,
    force_floor: float,
    iterations_max: int = 40,
) -> Equilibrium:
    """Find the equilibrium near u.

    Args:
        u: (N, 3) m; start, no inverted element.
        tolerance: of the residual's 2-norm relative to the force on the tool.
        force_floor: N; scale of the residual where the tool carries less.

    Raises:
        EquilibriumError: no convergence.
    """
    free = body.equation >= 0
    u = body.follow(u)
    elastic, touch = body.state(u), contact.state(u)
    if not np.isfinite(elastic.energy):
        raise EquilibriumError("the start has an inverted element")
    energy = elastic.energy + touch.energy
    for iteration in range(iterations_max + 1):
        r = (elastic.force + touch.gradient).ravel()[free]
        scale = max(float(np.linalg.norm(touch.force)), force_floor)
        residual = float(np.linalg.norm(r)) / scale
        if residual <= tolerance:
            return Equilibrium(u, elastic, touch, residual, iteration)
        if iteration == iterations_max:
            break
        d = _direction(body, contact, u, r, _forcing(residual, tolerance))
        slope = float(r @ d)
        alpha = 1.0
        for _ in range(25):
            trial = body.moved(u, alpha * d)
            elastic_trial, touch_trial = body.state(trial), contact.state(trial)
            energy_trial = elastic_trial.energy + touch_trial.energy
            if np.isfinite(energy_trial):
                rounding = 1e-13 * (abs(elastic_trial.energy) + abs(touch_trial.energy))
                if energy_trial <= energy + SUFFICIENT_DECREASE * alpha * slope + rounding:
                    break
                if residual < NEAR:
                    r_trial = (elastic_trial.force + touch_trial.gradient).ravel()[free]
                    if np.linalg.norm(r_trial) <= 0.5 * np.linalg.norm(r):
                        break
            alpha *= 0.5
        else:
            raise EquilibriumError(f"the line search failed at residual {residual:.1e}")
        u, elastic, touch, energy = trial, elastic_trial, touch_trial, energy_trial
    raise EquilibriumError(f"no convergence in {iterations_max} Newton steps; residual {residual:.1e}")
