# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A body's Newton systems: the current Hessian, and conjugate gradients with a factor that may be older.

A Cholesky factor costs as much as some fifteen solves with it, so that of an earlier state serves until it takes too
many iterations.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.body import FreeMotion
from palpate.fem_offline.conjugate_gradients import StaleError, conjugate_gradients
from palpate.fem_offline.contact import ContactHessian, face_places
from palpate.fem_offline.hessian_pattern import HessianPattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.tissue import Tissue

__all__ = ["CG_ITERATIONS_STALE", "FactoredTangent", "Tangent"]

CG_ITERATIONS_STALE = 16
"""More iterations than this cost more than a new factor."""


class Tangent(FreeMotion, ABC):
    """A body's Newton systems: the current Hessian, and conjugate gradients with a factor that may be older.

    Args:
        tissue: what is nonlinear.
        held: node indices that do not move.
        nodes: (N, 3) m; the tissue's, and after them what else is free.
        pattern: of the Hessian.
        faces: (B, 6) faces that may touch.
    """

    iterations_max: int
    """Conjugate-gradient iterations allowed with a new factor."""

    def __init__(
        self, tissue: Tissue, held: np.ndarray, nodes: np.ndarray, pattern: HessianPattern, faces: np.ndarray
    ) -> None:
        self.tissue, self.held, self.nodes, self.pattern = tissue, held, nodes, pattern
        self.equation, self.equation_count = pattern.equation, pattern.equation_count
        self._contact_places = face_places(pattern, faces)

    def state(self, u: np.ndarray) -> ElementState:
        """Energy and forces at u (N, 3) m, without contact."""
        return self.tissue.state(u)

    @abstractmethod
    def hessian(self, u: np.ndarray) -> np.ndarray:
        """Hessian values without contact, on the pattern, at u (N, 3) m."""

    @abstractmethod
    def renew(self) -> None:
        """Make the preconditioner anew, at the current Hessian.  Raises NotPositiveDefiniteError."""

    @abstractmethod
    def precondition(self, r: np.ndarray) -> np.ndarray: ...

    @property
    @abstractmethod
    def factors(self) -> dict[bool, Factor]:
        """One for the free (False) and one for the stuck contact (True).  Sticking holds the contact in three
        directions instead of one: a factor of its own stays useful longer."""

    def set_rest(self) -> None:
        """Keep the rest stiffness, which shifts a Hessian that is not positive definite."""
        self.rest_values = self.hessian(np.zeros_like(self.nodes))

    def assemble(self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False) -> None:
        """Current Hessian at u, with contact and a share `shift` of the rest stiffness."""
        self.values = self.hessian(u)
        contact.add_to(self.values, self._contact_places)
        if shift:
            self.values += shift * self.rest_values
        self._upper = self.pattern.matrix(self.values)
        self._lower = self._upper.T
        self._diagonal = self._upper.diagonal()
        self.stuck = stuck
        self.at = (u, contact, shift, stuck)

    def linearise(self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False) -> None:
        """Assemble; factorise where there is no factor yet.  Raises NotPositiveDefiniteError."""
        self.assemble(u, contact, shift, stuck)
        if not self.factors[stuck].ready:
            self.renew()

    def apply(self, x: np.ndarray) -> np.ndarray:
        return self._upper @ x + self._lower @ x - self._diagonal * x

    def solve(self, b: np.ndarray, tolerance: float) -> np.ndarray:
        """Raises NegativeCurvatureError, NotPositiveDefiniteError, StaleError."""
        try:
            return conjugate_gradients(self.apply, self.precondition, b, tolerance, CG_ITERATIONS_STALE)
        except StaleError:
            self.renew()
        return conjugate_gradients(self.apply, self.precondition, b, tolerance, self.iterations_max)

    def far_field_error(self, u: np.ndarray, state: ElementState) -> float:
        """Estimate of how far the force is off at u (N, 3) m because something far is linear, fraction of force."""
        return 0.0

    def couple(self, u: np.ndarray) -> np.ndarray:
        """(3,) N m; moment of the inner forces at u (N, 3) m: zero, but where something is linear."""
        return self.tissue.couple(u)

    def support_reaction(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        """(6,) N, N m; force of the supports on the tissue and its moment about the origin, from their own side.

        Less the couple of linear materials, which nothing holds but the model.
        """
        force = state.force[self.held]
        moment = np.cross(self.nodes[self.held], force).sum(axis=0) - self.couple(u)
        held = np.concatenate([force.sum(axis=0), moment])
        return held + self.tissue.ground_reaction(u)


class FactoredTangent(Tangent, ABC):
    """Systems preconditioned by factors of their own Hessian, in single precision: the residuals are double."""

    iterations_max = CG_ITERATIONS_STALE

    def __init__(
        self, tissue: Tissue, held: np.ndarray, nodes: np.ndarray, pattern: HessianPattern, faces: np.ndarray
    ) -> None:
        super().__init__(tissue, held, nodes, pattern, faces)
        rows = pattern.row_start, pattern.column
        self._factors = {stuck: Factor(*rows, single=True) for stuck in (False, True)}

    @property
    def factors(self) -> dict[bool, Factor]:
        return self._factors

    def renew(self) -> None:
        self._factors[self.stuck].factorise(self.values)

    def precondition(self, r: np.ndarray) -> np.ndarray:
        return self._factors[self.stuck].solve(r)
