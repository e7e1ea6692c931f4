# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Compliance only: patch and far field linear, with nonlinear contact on them.

    Pi(u) = u . K u / 2 + contact

K is the rest stiffness, assembled once.  The contact is as exact as on any body: the tool's shape, where it touches,
and points that have moved.  What is missing is everything that large strains and rotations do to the tissue.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.far_modes import FarModes
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.near_body import NearBody
from palpate.fem_offline.tissue import Tissue

__all__ = ["LinearBody"]


class LinearBody(NearBody):
    """A linear patch on a linear far field; arguments as of `NearBody`."""

    def __init__(
        self, tissue: Tissue, held: np.ndarray, interface: np.ndarray, far: FarModes, faces: np.ndarray
    ) -> None:
        pattern = hessian_pattern(tissue.space.elements, np.zeros(3 * tissue.space.node_count, bool), [])
        upper = pattern.matrix(tissue.hessian(np.zeros_like(tissue.nodes), pattern))
        self._stiffness = (upper + sparse.triu(upper, 1).T).tocsr()  # of all nodes, held ones included
        super().__init__(tissue, held, interface, far, faces, turning=False)

    def tissue_state(self, u: np.ndarray) -> ElementState:
        force = self._stiffness @ u.ravel()
        return ElementState(0.5 * float(u.ravel() @ force), force.reshape(-1, 3), 1.0)

    def hessian(self, u: np.ndarray) -> np.ndarray:
        return self.rest_values.copy() if hasattr(self, "rest_values") else super().hessian(u)

    def far_field_error(self, u: np.ndarray, state: ElementState) -> float:
        """NaN: all is linear, and how much that matters is not known without a better press."""
        return float("nan")

    def couple(self, u: np.ndarray) -> np.ndarray:
        """(3,) N m; linear forces balance about nodes that have not moved."""
        force = self.tissue_state(u).force
        if self.tissue.springs is not None:
            force = force - self.tissue.springs.state(u)[1]
        return np.cross(self.tissue.nodes + u, force).sum(axis=0)
