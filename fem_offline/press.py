# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One press: the normal ladder of a rigid tool, its reactions, energies, and the sticking contact's stiffness.

The tool is turned as the site says and its reference point goes from p(0) = c + rho n to p(d) = c + (rho - d) n.
Each recorded state is an equilibrium; f = force on the tool, W = stored energy.  Free checks, kept in the record:

    action and reaction:  |f_tool - f_supports| / |f_tool|, and moments  (the supports' side is computed on its own)
    work and energy:      dW/dd = f . n                             (checked over each ladder, see `work_mismatch`)

With a friction coefficient the same ladder runs with Coulomb's law at every point (coulomb.py), on a path of smaller
steps, because friction remembers; the record then holds what the law's own check found, and the work also pays for
dissipation: dW/dd + dD/dd = f . n.

Sticking: at each depth the points in contact are held to the tool, and the tool's translational stiffness
K = -df/dp is found from the linearised equilibrium.  Lateral ladders do the same with finite moves.

Sliding: without friction, the same depths also have the share of a coefficient that a sliding tool would feel
(friction_share.py).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.clearance import why_not_placed, why_stray
from palpate.fem_offline.contact import Sticking, Unilateral
from palpate.fem_offline.equilibrium import Equilibrium, EquilibriumError, equilibrate
from palpate.fem_offline.friction_share import friction_share
from palpate.fem_offline.ladder import DEFAULT_SETTINGS, Ladder, PressSettings, reaction_error
from palpate.fem_offline.site import Site
from palpate.fem_offline.tool import Tool

__all__ = [
    "LateralLadder",
    "PressRecord",
    "PressSettings",
    "PressState",
    "SlidingRecord",
    "press",
    "sticking",
    "sticking_stiffness",
]


STICKING_TOLERANCE = 1.0e-6
"""Of the linear solves for the sticking stiffness.  The stiffness is a small difference of large numbers (the
spring that holds the points is a thousand times stiffer than the tissue): 1e-2 was off by half."""


@dataclass(frozen=True)
class LateralLadder:
    """A sticking lateral move at one depth.

    Attributes:
        depth: m.
        deflection: (M, 3) m; tool translation from the pressed state, the zero state first.
        force_vector: (M, 3) N on the tool.
        energy: (M,) J.
    """

    depth: float
    deflection: np.ndarray
    force_vector: np.ndarray
    energy: np.ndarray


@dataclass(frozen=True)
class PressState:
    """What a lateral move can be chosen by.

    Attributes:
        normal: (3,) outward.  force: (3,) N on the tool.  sticking_stiffness: (3, 3) N/m.
    """

    normal: np.ndarray
    force: np.ndarray
    sticking_stiffness: np.ndarray


@dataclass(frozen=True)
class SlidingRecord:
    """What friction did in a press; rows as the press record's.

    Attributes:
        friction: coefficient.
        dissipation: (K,) J since the untouched state.
        sliding: (K,) share of the pressed area that slid in the last step.
        excess: (K,) largest |tau| - mu p over the largest mu p, from the states' tractions anew.
        turned: (K,) largest power that friction misses for not opposing sliding, over the largest mu p |slip|.
    """

    friction: float
    dissipation: np.ndarray
    sliding: np.ndarray
    excess: np.ndarray
    turned: np.ndarray


@dataclass(frozen=True)
class PressRecord:
    """What one press found.  K states, the untouched one first.

    Attributes:
        contact_point, normal: (3,) m, (3,).
        depth: (K,) m.  force_vector: (K, 3) N on the tool.  moment: (K, 3) N m about the reference point.
        energy: (K,) J stored in the tissue.  area: (K,) m2 of reference surface in contact.
        residual: (K,) |r| / |f|.  reaction_error: (K,) action against reaction, forces and moments.
        penetration: (K,) m; mean gap error where pressure acts.
        far_field_error: (K,) estimate of what the linear far field costs, fraction of force; 0 where all is nonlinear,
            NaN where all is linear.
        sticking_stiffness: (K, 3, 3) N/m; -df/dp with the contact stuck, at every second depth and the deepest;
            zero at the zero state, NaN elsewhere and where nobody asked.
        friction_share: (K,) felt over given coefficient of a tool that slides, for small coefficients, where there is
            a stiffness; 1 at the zero state, NaN elsewhere, with friction, and where it was not found.
        lateral: sticking lateral ladders.
        work_mismatch: largest |W + dissipation - integral of f_n| over the ladder, fraction of the deepest W.
        converged: every depth asked for was reached.  reason: why not, else "".
        unknowns: free equations.  newton_steps: in all.  seconds: wall time.  fidelity: near_field or full.
        sliding: with friction; None without.
    """

    contact_point: np.ndarray
    normal: np.ndarray
    depth: np.ndarray
    force_vector: np.ndarray
    moment: np.ndarray
    energy: np.ndarray
    area: np.ndarray
    residual: np.ndarray
    reaction_error: np.ndarray
    penetration: np.ndarray
    far_field_error: np.ndarray
    sticking_stiffness: np.ndarray
    friction_share: np.ndarray
    lateral: tuple[LateralLadder, ...]
    work_mismatch: float
    converged: bool
    reason: str
    unknowns: int
    newton_steps: int
    seconds: float
    fidelity: str
    sliding: SlidingRecord | None = None

    @property
    def force(self) -> np.ndarray:
        """(K,) N; normal force on the tool."""
        return self.force_vector @ self.normal


def press(
    site: Site,
    tool: Tool,
    depths: np.ndarray,
    settings: PressSettings = DEFAULT_SETTINGS,
    moves: Callable[[int, PressState], np.ndarray | None] = lambda index, state: None,
    progress: Callable[[float], None] = lambda depth: None,
    watch: Callable[[float, Equilibrium], None] = lambda depth, found: None,
    friction: float = 0.0,
    stiffness: bool = True,
) -> PressRecord:
    """Press `tool` into a site along -normal.

    Args:
        depths: (K - 1,) m, rising, positive.
        moves: of the index in `depths` and the state there, tool translations (M, 3) m tried one after the other
            with the contact stuck (each starts where the last one ended), or None.
        progress: called with each depth reached.
        watch: called with each recorded equilibrium, before any lateral move.
        friction: Coulomb's coefficient; lateral moves stick whatever it is.
        stiffness: find the stuck contact's stiffness and what friction is felt; lateral moves are chosen by it.

    Returns:
        The record, as deep as it came; `converged` and `reason` say whether that was all.
    """
    begun = time.perf_counter()
    ladder = Ladder.above(site, tool, settings, float(depths[-1]), friction)
    contact = ladder.contact
    zero = np.zeros(3)
    rows: list[tuple] = [(0.0, zero, zero, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, np.zeros((3, 3)), 1.0)]
    slid = [(0.0, 0.0, 0.0, 0.0)]
    ladders: list[LateralLadder] = []
    reason = why_not_placed(site, tool, float(depths[-1]))
    for index, depth in enumerate(depths if not reason else []):
        if depth >= site.thickness:
            reason = (
                f"{depth * 1e3:.2f} mm is deeper than the tissue, {site.thickness * 1e3:.2f} mm thick here"
            )
            break
        try:
            found = ladder.go_to(float(depth))
            mismatch = reaction_error(site, found, contact.pose)
            if mismatch > settings.reaction_tolerance:
                reason = f"action and reaction differ by {mismatch:.1e} at {depth * 1e3:.2f} mm"
                break
            reason = why_stray(site, tool, float(depth), found.u)
            if reason:
                break
            stuck = sticking(site, found, contact, settings)
            wants_stiffness = stiffness and (index % 2 == 1 or index == len(depths) - 1)
            share = np.nan
            if wants_stiffness and not friction:
                with suppress(ArithmeticError):  # of a contact about to give way
                    share = friction_share(site, found, contact, settings)
            held = sticking_stiffness(site, found, stuck) if wants_stiffness else np.full((3, 3), np.nan)
            touch = found.contact
            rows.append(
                (depth, touch.force, touch.moment, found.elastic.energy, touch.area, found.residual, mismatch,
                 touch.penetration, site.body.far_field_error(found.u, found.elastic), held, share)
            )  # fmt: skip
            if ladder.check:
                check = ladder.check
                slid.append((ladder.dissipation, check.sliding, check.excess, check.turned))
            watch(float(depth), found)
            wanted = moves(index, PressState(site.normal, touch.force, held))
            if wanted is not None:
                ladders.append(_lateral_ladder(site, found, stuck, float(depth), wanted, settings, ladder))
        except (
            EquilibriumError,
            ArithmeticError,
        ) as error:  # a linear solve of the stuck contact may fail too
            reason = f"stopped before {depth * 1e3:.2f} mm: {error}; less depth, or a finer mesh"
            break
        progress(float(depth))
    column = [np.array([row[k] for row in rows], float) for k in range(11)]
    return PressRecord(
        site.contact_point,
        site.normal,
        *column,
        tuple(ladders),
        _work_mismatch(
            column[0], column[1] @ site.normal, column[3] + (np.array(slid)[:, 0] if friction else 0.0)
        ),
        reason == "",
        reason,
        site.body.equation_count,
        ladder.newton_steps,
        time.perf_counter() - begun,
        site.fidelity,
        SlidingRecord(friction, *np.array(slid).T) if friction else None,
    )


def sticking(site: Site, found: Equilibrium, contact: Unilateral, settings: PressSettings) -> Sticking:
    return Sticking(
        site.surface,
        settings.sticking_penalty * contact.penalty,
        site.surface.points(found.u),
        found.contact.traction,
        contact.pose.position.copy(),
    )


def sticking_stiffness(site: Site, found: Equilibrium, stuck: Sticking) -> np.ndarray:
    """K = sum_q w_q eps_s (1 - N du/dD), H du/dD = eps_s sum_q w_q N."""
    if not found.contact.area:
        return np.zeros((3, 3))
    body, surface = site.body, site.surface
    body.linearise(found.u, stuck.hessian(found.u, False), 0.0, stuck=True)
    body.renew()
    free = body.equation >= 0
    load = stuck.load_of_translation(len(found.u))
    stiffness = np.zeros((3, 3))
    for k in range(3):
        response = np.zeros(len(free))
        response[free] = body.solve(load[:, :, k].ravel()[free], STICKING_TOLERANCE)
        # transposed load gives sum_q w_q eps_s N du/dD for each direction at once
        stiffness[:, k] = -np.einsum("nij,ni->j", load, response.reshape(-1, 3))
        stiffness[k, k] += stuck.penalty * float(np.sum(surface.weight[stuck._acting]))
    return 0.5 * (stiffness + stiffness.T)


def _lateral_ladder(
    site: Site,
    found: Equilibrium,
    stuck: Sticking,
    depth: float,
    moves: np.ndarray,
    settings: PressSettings,
    ladder: Ladder,
) -> LateralLadder:
    u = found.u
    forces, energies = [found.contact.force], [found.elastic.energy]
    for move in np.atleast_2d(moves):
        stuck.translation = np.asarray(move, float)
        state = equilibrate(site.body, stuck, u, 1e-4, ladder.force_floor)
        stuck.update(state.u)
        state = equilibrate(site.body, stuck, state.u, settings.tolerance, ladder.force_floor)
        ladder.newton_steps += state.iterations
        u = state.u
        forces.append(state.contact.force)
        energies.append(state.elastic.energy)
    deflection = np.concatenate([np.zeros((1, 3)), np.atleast_2d(moves)])
    return LateralLadder(depth, deflection, np.array(forces), np.array(energies))


def _work_mismatch(depth: np.ndarray, force: np.ndarray, energy: np.ndarray) -> float:
    """Largest |W - integral f dd| / W_end, with f ~ d^n between neighbours: (f2 d2 - f1 d1) / (n + 1)."""
    if len(depth) < 3 or not np.all(force[1:] > 0.0):
        return 0.0
    d, f = depth[1:], force[1:]
    n = np.diff(np.log(f)) / np.diff(np.log(d))
    # up to the first depth, n is that of the next step (1.5 for a ball, 1 for a punch, 2 for a cone)
    work = np.concatenate([[0.0], np.cumsum(np.diff(f * d) / (n + 1.0))]) + f[0] * d[0] / (n[0] + 1.0)
    return float(np.max(np.abs(energy[1:] - work)) / max(energy[-1], 1e-300))
