# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Equilibrium with Coulomb friction: lagged pressures first, then Newton's method on the true law.

With pressures and tangent planes lagged, friction has an energy, and equilibrium.py's line search cannot fail for
friction's sake; two or three such solves come near.  There the consistent derivative, which is not symmetric because
friction follows pressure, takes over: GMRES (Saad and Schultz 1986), preconditioned by the symmetric part's Cholesky
factor.  Where Newton's method does not descend, lagging goes on (it contracts by about mu times the coupling of
pressure with shear) and Newton's method is tried again.

What is returned is an equilibrium of the true law: the residual is that of the tractions evaluated with its own
pressures and normals.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import sparse

from palpate.fem_offline.body import Body
from palpate.fem_offline.conjugate_gradients import StaleError
from palpate.fem_offline.coulomb import Coulomb
from palpate.fem_offline.equilibrium import Equilibrium, EquilibriumError, equilibrate
from palpate.fem_offline.gmres import gmres

__all__ = ["equilibrate_sliding"]

LOOSE = 3.0e-3
"""Relative residual of a solve with lagged pressures; a better one does not survive the next lag."""
NEAR = 0.05
"""Relative residual below which Newton's method is tried at once."""
ROUNDS = 8
"""Of Newton's method and lagged solves in turn."""
ANCHORINGS = 2
"""Rounds in which newly touching points are anchored; then they stay, so that the rounds converge."""
GMRES_ITERATIONS = 16
NEWTON_STEPS = 15
LINEAR_TOLERANCE = (1.0e-6, 1.0e-2)


def equilibrate_sliding(
    body: Body, contact: Coulomb, u: np.ndarray, tolerance: float, force_floor: float
) -> Equilibrium:
    """Find the equilibrium near u (N, 3) m; arguments and errors as `equilibrate`.

    The contact's anchors of newly touching points are set on the way; `contact.commit` is left to the caller.
    """
    iterations, reason = 0, ""
    contact.expect()
    if contact.touches(u) and _residual(body, contact, u, force_floor) > NEAR:
        found = equilibrate(body, contact, u, max(tolerance, LOOSE), force_floor)
        u, iterations = found.u, found.iterations
    for attempt in range(ROUNDS):
        change = contact.lag(u)
        if attempt < ANCHORINGS:
            contact.anchor(u)
        try:
            found = _newton(body, contact, u, tolerance, force_floor)
            return replace(found, iterations=iterations + found.iterations)
        except EquilibriumError as error:
            reason = str(error)
        contact.lag(u)
        found = equilibrate(body, contact, u, max(tolerance, LOOSE), force_floor)
        u, iterations = found.u, iterations + found.iterations
    raise EquilibriumError(f"friction: {reason}; pressures still change by {change:.1e}")


def _residual(body: Body, contact: Coulomb, u: np.ndarray, force_floor: float) -> float:
    touch = contact.state(u)
    r = (body.state(u).force + touch.gradient).ravel()[body.equation >= 0]
    return float(np.linalg.norm(r)) / max(float(np.linalg.norm(touch.force)), force_floor)


def _newton(body: Body, contact: Coulomb, u: np.ndarray, tolerance: float, force_floor: float) -> Equilibrium:
    free = body.equation >= 0

    def at(u: np.ndarray):
        contact.lag(u)
        elastic, touch = body.state(u), contact.state(u)
        r = (elastic.force + touch.gradient).ravel()[free]
        if not np.isfinite(elastic.energy):
            r = np.full_like(r, np.inf)
        return elastic, touch, r

    u = body.follow(u)
    elastic, touch, r = at(u)
    for iteration in range(NEWTON_STEPS + 1):
        scale = max(float(np.linalg.norm(touch.force)), force_floor)
        residual = float(np.linalg.norm(r)) / scale
        if residual <= tolerance:
            return Equilibrium(u, elastic, touch, residual, iteration)
        if iteration == NEWTON_STEPS:
            break
        d = _direction(body, contact, u, r, float(np.clip(residual, *LINEAR_TOLERANCE)))
        alpha = 1.0
        for _ in range(6):
            trial = body.moved(u, alpha * d)
            elastic_trial, touch_trial, r_trial = at(trial)
            if np.linalg.norm(r_trial) <= (1.0 - 0.1 * alpha) * np.linalg.norm(r):
                break
            alpha *= 0.5
        else:
            contact.lag(u)
            raise EquilibriumError(f"Newton's method stalled at residual {residual:.1e}")
        u, elastic, touch, r = trial, elastic_trial, touch_trial, r_trial
    raise EquilibriumError(f"no convergence in {NEWTON_STEPS} Newton steps; residual {residual:.1e}")


def _direction(body: Body, contact: Coulomb, u: np.ndarray, r: np.ndarray, tolerance: float) -> np.ndarray:
    try:
        body.linearise(u, contact.hessian(u, False), 0.0, stuck=True)
        beyond = _matrix(body, contact, u)
        return _solve(body, beyond, -r, tolerance)
    except ArithmeticError as error:
        raise EquilibriumError(f"the linear solve failed: {error}") from error


def _solve(body: Body, beyond: sparse.csr_matrix, b: np.ndarray, tolerance: float) -> np.ndarray:
    def apply(x: np.ndarray) -> np.ndarray:
        return body.apply(x) + beyond @ x

    try:
        return gmres(apply, body.precondition, b, tolerance, GMRES_ITERATIONS)
    except StaleError:
        body.renew()
    return gmres(apply, body.precondition, b, tolerance, 2 * GMRES_ITERATIONS)


def _matrix(body: Body, contact: Coulomb, u: np.ndarray) -> sparse.csr_matrix:
    """The unsymmetric part over the body's equations."""
    surface = contact.surface
    block = contact.unsymmetric(u)
    active = np.flatnonzero(np.any(block != 0.0, axis=(1, 2, 3)))
    weighted = surface.weight[active][:, :, None, None] * block[active]
    local = np.einsum("qa,qc,bqij->baicj", surface.shape, surface.shape, weighted, optimize=True)
    local = local.reshape(len(active), 18, 18)
    dof = (3 * surface.faces[active][:, :, None] + np.arange(3)).reshape(len(active), 18)
    row, column = np.broadcast_arrays(body.equation[dof][:, :, None], body.equation[dof][:, None, :])
    use = (row >= 0) & (column >= 0)
    n = body.equation_count
    return sparse.csr_matrix((local[use], (row[use], column[use])), shape=(n, n))
