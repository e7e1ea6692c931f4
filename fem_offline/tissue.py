# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What stores energy on one mesh: tetrahedra, a capsule on their surface, springs under it.

W(u) = W_tetrahedra(u) + W_capsule(u) + W_springs(u)
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from palpate.fem_offline.assembly import ElementState, ElementSystem
from palpate.fem_offline.contact import face_places
from palpate.fem_offline.elastic_support import ElasticSupport
from palpate.fem_offline.hessian_pattern import HessianPattern
from palpate.fem_offline.material import Linear
from palpate.fem_offline.membrane import Membrane
from palpate.fem_offline.quadratic_space import QuadraticSpace

__all__ = ["Tissue"]


@dataclass
class Tissue:
    """Tetrahedra with what acts on their surface.

    Attributes:
        elements: the tetrahedra.
        capsule: membrane on the organ's surface, or None.
        springs: elastic supports, or None.
    """

    elements: ElementSystem
    capsule: Membrane | None = None
    springs: ElasticSupport | None = None
    _spring_places: dict[int, tuple[HessianPattern, np.ndarray]] = field(init=False, default_factory=dict)

    @property
    def space(self) -> QuadraticSpace:
        return self.elements.space

    @property
    def nodes(self) -> np.ndarray:
        """(N, 3) m."""
        return self.elements.space.nodes

    def state(self, u: np.ndarray) -> ElementState:
        """Energy and nodal forces at u (N, 3) m."""
        state = self.elements.state(u)
        energy, force = state.energy, state.force
        if self.capsule is not None:
            skin = self.capsule.state(u)
            energy, force = energy + skin.energy, force + skin.force
        if self.springs is not None:
            stored, pull = self.springs.state(u)
            energy, force = energy + stored, force + pull
        return ElementState(energy, force, state.smallest_jacobian)

    def hessian(self, u: np.ndarray, pattern: HessianPattern) -> np.ndarray:
        """Values of the Hessian's upper triangle, N/m, on the pattern."""
        values = self.elements.hessian(u, pattern)
        if self.capsule is not None:
            values += self.capsule.hessian(u, pattern)
        if self.springs is not None:
            self.springs.hessian().add_to(values, self._places(pattern))
        return values

    def _places(self, pattern: HessianPattern) -> np.ndarray:
        if id(pattern) not in self._spring_places:
            self._spring_places = {id(pattern): (pattern, face_places(pattern, self.springs.surface.faces))}
        return self._spring_places[id(pattern)][1]

    def couple(self, u: np.ndarray) -> np.ndarray:
        """(3,) N m; moment of the inner forces: zero, but for linear materials, which rotations strain."""
        skin = [] if self.capsule is None else [self.capsule.capsule.material]
        materials = [*self.elements.materials, *skin]
        if not any(isinstance(material, Linear) for material in materials):
            return np.zeros(3)
        force = self.elements.state(u).force
        if self.capsule is not None:
            force = force + self.capsule.state(u).force
        return np.cross(self.nodes + u, force).sum(axis=0)

    def ground_reaction(self, u: np.ndarray) -> np.ndarray:
        """(6,) N, N m; force of the springs' ground on the tissue and its moment about the origin."""
        return np.zeros(6) if self.springs is None else self.springs.reaction(u)
