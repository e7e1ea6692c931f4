# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What is pressed, as equilibrium sees it.

Two bodies share the refined patch around a contact: `NearBody` (near_body.py), with the rest of the organ linear behind
a few modes, and `FullBody` (full_body.py), with all tissue nonlinear.  Both number the patch's nodes first.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.contact import ContactHessian
from palpate.fem_offline.organ import Organ, faces_held
from palpate.fem_offline.patch import Patch
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space

__all__ = ["Body", "FreeMotion", "patch_space"]


class Body(Protocol):
    """What equilibrium asks of a body.

    Attributes:
        nodes: (N, 3) m at rest.
        equation: (3 N,) equation of each component, -1 where it is held or follows others.
        equation_count: free equations.
    """

    nodes: np.ndarray
    equation: np.ndarray
    equation_count: int

    def follow(self, u: np.ndarray) -> np.ndarray:
        """u (N, 3) m with those components set that follow the free ones."""
        ...

    def moved(self, u: np.ndarray, step: np.ndarray) -> np.ndarray:
        """(N, 3) m; u after a step (equation_count,) of the free components."""
        ...

    def state(self, u: np.ndarray) -> ElementState: ...

    def linearise(
        self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False
    ) -> None: ...

    def renew(self) -> None: ...

    def solve(self, b: np.ndarray, tolerance: float) -> np.ndarray: ...

    def support_reaction(self, u: np.ndarray, state: ElementState) -> np.ndarray: ...

    def far_field_error(self, u: np.ndarray, state: ElementState) -> float: ...


class FreeMotion:
    """How a body moves whose components are free or held: nothing follows.

    Attributes:
        equation: (3 N,) as of `Body`.
    """

    equation: np.ndarray

    def follow(self, u: np.ndarray) -> np.ndarray:
        """u (N, 3) m with those components set that follow the free ones."""
        return u

    def moved(self, u: np.ndarray, step: np.ndarray) -> np.ndarray:
        """(N, 3) m; u after a step (equation_count,) of the free components."""
        out = u.copy()
        out.reshape(-1)[self.equation >= 0] += step
        return self.follow(out)


def patch_space(organ: Organ, patch: Patch) -> tuple[QuadraticSpace, np.ndarray]:
    """Quadratic space of a patch and its held nodes."""
    space = quadratic_space(patch.points, patch.tets)
    held = patch.outer_faces[faces_held(patch.points, patch.outer_faces, organ.held)]
    return space, np.unique(space.face_nodes(held)) if len(held) else np.zeros(0, int)
