# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How the organ's surface moves in a press, for graphics.

Each recorded state gives the displacement u of the surface's nodes: those of the refined patch around the contact and,
where all tissue is nonlinear, those of the rest of the organ too.  With the contact held to the tool, the linearised
equilibrium says how they follow a small tangential move D of it,

    H du/dD = eps_s sum_q w_q N          (press.py, `sticking_stiffness`)

at every second state and the deepest; at full fidelity, where solves are dear, at the deepest one alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from palpate.fem_offline.contact import Sticking
from palpate.fem_offline.equilibrium import Equilibrium
from palpate.fem_offline.ladder import DEFAULT_SETTINGS
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.pose import tangents
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.site import Site

__all__ = ["SurfaceDisplacement"]

TOLERANCE = 1e-4
"""Of the linear solves; a picture needs no more."""


@dataclass
class SurfaceDisplacement:
    """Collects one press; `watch` is what `press` calls at each recorded state.

    Args:
        organ, site: where it presses.
        count: states that are asked for (without the untouched one).
    """

    organ: Organ
    site: Site
    count: int
    _node: np.ndarray = field(init=False)
    _point: np.ndarray = field(init=False)
    _states: list[np.ndarray] = field(default_factory=list, init=False)
    _stuck: list[np.ndarray] = field(default_factory=list, init=False)
    _stuck_depth: list[float] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        patch, body = self.site.patch, self.site.body
        space = quadratic_space(patch.points, patch.tets)  # numbered as the body's
        near = np.unique(space.face_nodes(patch.outer_faces))
        far = np.zeros(0, int)
        if self.site.fidelity == "full" and not patch.carved.all():
            far = self._far(space.node_count)
        self._node = np.concatenate([near, far])
        self._point = body.nodes[self._node]

    def _far(self, patch_count: int) -> np.ndarray:
        """Surface nodes of a full body beyond its patch, which copies the organ's own."""
        organ, body = self.organ, self.site.body
        surface = organ.space.nodes[np.unique(organ.surface_of(~self.site.patch.carved))]
        mine = {tuple(point): i for i, point in enumerate(body.nodes[patch_count:].tolist(), patch_count)}
        found = [mine.get(tuple(point), -1) for point in surface.tolist()]  # -1: the patch's
        return np.array([i for i in found if i >= 0], int)

    def watch(self, depth: float, found: Equilibrium) -> None:
        """Args: depth: m.  found: the equilibrium there."""
        index = len(self._states)
        self._states.append(found.u[self._node])
        last = index == self.count - 1
        if found.contact.area and (last or (index % 2 == 1 and self.site.fidelity != "full")):
            self._stuck.append(self._dragged(found))
            self._stuck_depth.append(depth)

    def _dragged(self, found: Equilibrium) -> np.ndarray:
        """(V, 3, 2); du/dD along the two tangents."""
        site, body = self.site, self.site.body
        settings = DEFAULT_SETTINGS
        penalty = settings.sticking_penalty * settings.penalty * site.youngs_modulus
        held = Sticking(
            site.surface, penalty, site.surface.points(found.u), found.contact.traction, np.zeros(3)
        )
        body.linearise(found.u, held.hessian(found.u, False), 0.0, stuck=True)
        body.renew()
        free = body.equation >= 0
        load = held.load_of_translation(len(found.u)) @ tangents(site.normal).T
        out = np.zeros((len(self._node), 3, 2))
        for k in range(2):
            step = body.solve(load[:, :, k].ravel()[free], TOLERANCE)
            out[:, :, k] = (body.moved(found.u, step) - found.u)[self._node]
        return out

    def arrays(self) -> dict[str, np.ndarray]:
        """What a record keeps of V surface nodes in K states, the untouched one first.

        surface_point (V, 3) m; surface_displacement (K, V, 3) m; surface_stuck (S, V, 3, 2), displacement over the
        tool's tangential move along `pose.tangents` of the normal, at surface_stuck_depth (S,) m.
        """
        zero = np.zeros((1, len(self._node), 3))
        return {
            "surface_point": self._point,
            "surface_displacement": np.concatenate([zero, *(s[None] for s in self._states)]).astype(
                np.float32
            ),
            "surface_stuck": np.array(self._stuck, np.float32).reshape(-1, len(self._node), 3, 2),
            "surface_stuck_depth": np.array(self._stuck_depth),
        }
