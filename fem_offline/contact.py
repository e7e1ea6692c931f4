# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Contact of a rigid tool with quadratic surface faces, at the faces' quadrature points.

Frictionless, augmented Lagrangian (Wriggers, Computational Contact Mechanics, 2006, section 6.3):

    pressure  t = max(0, lambda - eps g),     Pi_c = sum_q w_q (t^2 - lambda^2) / (2 eps)
    dPi_c/du_a = -sum_q w_q t n N_a,          d2Pi_c = sum_{t > 0} w_q (eps n n^T - t Hess g) N_a N_b

with g the tool's signed distance at the deformed point and w_q reference area.  Multipliers are updated
lambda <- t after equilibrium; forces are always read in equilibrium.

Sticking: the points that carry pressure follow the tool's translation D, held by a stiff spring around the
traction tau_0 that they carried,

    y = x - x_0 - D,   Pi_s = sum_q w_q (-tau_0 . y + eps_s |y|^2 / 2),   tau = tau_0 - eps_s y

Pressures are taken at quadrature points because corner nodes of quadratic faces carry no consistent load.
Many multipliers with a very stiff penalty over-constrain a face (+2 to 3 % of force at a hundredfold); the default
is soft and updated a few times instead.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from palpate.fem_offline.hessian_pattern import HessianPattern
from palpate.fem_offline.quadratic_space import face_shape
from palpate.fem_offline.tool import Pose, Tool

__all__ = [
    "ContactHessian",
    "ContactState",
    "ContactSurface",
    "Sticking",
    "Unilateral",
    "contact_surface",
    "face_places",
]

_A1, _W1, _A2, _W2 = 0.445948490915965, 0.223381589678011, 0.091576213509771, 0.109951743655322
SIX_POINT_RULE = np.array(
    [[1 - 2 * a, a, a] for a in (_A1, _A2)]
    + [[a, 1 - 2 * a, a] for a in (_A1, _A2)]
    + [[a, a, 1 - 2 * a] for a in (_A1, _A2)]
)
SIX_POINT_WEIGHTS = np.array([_W1, _W2] * 3)
"""Degree 4 on the triangle (Dunavant 1985); weights sum to 1."""


@dataclass(frozen=True)
class ContactHessian:
    """Hessian of a contact functional, face by face.

    Attributes:
        face: (A,) faces that contribute.
        local: (A, 18, 18) N/m.
    """

    face: np.ndarray
    local: np.ndarray

    def add_to(self, values: np.ndarray, places: np.ndarray) -> None:
        """Add to Hessian values, places (B, 18, 18) of all faces."""
        at = places[self.face].ravel()
        use = at >= 0
        values += np.bincount(at[use], self.local.ravel()[use], minlength=len(values))


@dataclass(frozen=True)
class ContactSurface:
    """Surface faces that may touch, with their quadrature points.

    Attributes:
        faces: (B, 6) quadratic face nodes.
        shape: (Q, 6) shape functions at the rule's points.
        weight: (B, Q) m2; reference area times rule weight.
        rest: (B, Q, 3) m; points at rest.
    """

    faces: np.ndarray
    shape: np.ndarray
    weight: np.ndarray
    rest: np.ndarray

    @property
    def point_shape(self) -> tuple[int, int]:
        return self.weight.shape

    def points(self, u: np.ndarray) -> np.ndarray:
        """(B, Q, 3) m; deformed quadrature points."""
        return self.rest + np.einsum("qa,bai->bqi", self.shape, u[self.faces])

    def nodal(self, traction: np.ndarray, node_count: int) -> np.ndarray:
        """(N, 3) N; sum_q w_q traction N_a, traction (B, Q, 3) Pa."""
        local = np.einsum("bq,bqi,qa->bai", self.weight, traction, self.shape)
        out = np.zeros((node_count, 3))
        np.add.at(out, self.faces.ravel(), local.reshape(-1, 3))
        return out

    def hessian(self, block: np.ndarray) -> ContactHessian:
        """sum_q w_q N_a N_b block_q per face, block (B, Q, 3, 3) Pa/m."""
        active = np.flatnonzero(np.any(block != 0.0, axis=(1, 2, 3)))
        weighted = self.weight[active][:, :, None, None] * block[active]
        local = np.einsum("qa,qc,bqij->baicj", self.shape, self.shape, weighted, optimize=True)
        return ContactHessian(active, local.reshape(len(active), 18, 18))


def contact_surface(nodes: np.ndarray, face_nodes: np.ndarray) -> ContactSurface:
    """Quadrature on straight quadratic faces: nodes (N, 3) m, face_nodes (B, 6)."""
    shape = face_shape(SIX_POINT_RULE)
    x = nodes[face_nodes[:, :3]]
    area = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
    weight = area[:, None] * SIX_POINT_WEIGHTS[None, :]
    rest = np.einsum("qa,bai->bqi", shape, nodes[face_nodes])
    return ContactSurface(face_nodes, shape, weight, rest)


def face_places(pattern: HessianPattern, faces: np.ndarray) -> np.ndarray:
    """(B, 18, 18) places of face blocks in a Hessian's value array; -1 where below the diagonal or held."""
    dof = (3 * faces[:, :, None] + np.arange(3)).reshape(len(faces), 18)
    row = pattern.equation[dof]
    r, c = np.broadcast_arrays(row[:, :, None], row[:, None, :])
    use = (r >= 0) & (c >= 0) & (r <= c)
    places = np.full(r.shape, -1, np.int64)
    places[use] = pattern.places(r[use], c[use])
    return places


@dataclass(frozen=True)
class ContactState:
    """Contact at one displacement and tool position.

    Attributes:
        energy: J; of the contact functional (not the tissue's).
        gradient: (N, 3) N; derivative with respect to nodal displacements.
        force: (3,) N on the tool.  moment: (3,) N m on the tool about its reference point.
        traction: (B, Q, 3) Pa; on the tissue.
        penetration: m; area-weighted mean |g| where pressure acts.
        area: m2; reference area where pressure acts.
    """

    energy: float
    gradient: np.ndarray
    force: np.ndarray
    moment: np.ndarray
    traction: np.ndarray
    penetration: float
    area: float


@dataclass
class Unilateral:
    """Frictionless contact with one tool.

    Attributes:
        penalty: eps, Pa/m.
        pose: of the tool.
        multiplier: lambda, (B, Q) Pa.
    """

    surface: ContactSurface
    tool: Tool
    penalty: float
    pose: Pose = field(default_factory=lambda: Pose.upright(np.zeros(3)))
    multiplier: np.ndarray | None = None

    def __post_init__(self) -> None:
        if self.multiplier is None:
            self.multiplier = np.zeros(self.surface.point_shape)

    def _distance(self, u: np.ndarray):
        x = self.surface.points(u)
        d = self.tool.distance(x.reshape(-1, 3), self.pose)
        b, q = self.surface.point_shape
        return x, d.gap.reshape(b, q), d.normal.reshape(b, q, 3), d.curvature.reshape(b, q, 3, 3)

    def state(self, u: np.ndarray) -> ContactState:
        x, gap, normal, _ = self._distance(u)
        pressure = np.maximum(0.0, self.multiplier - self.penalty * gap)
        w = self.surface.weight
        energy = float(np.sum(w * (pressure**2 - self.multiplier**2))) / (2.0 * self.penalty)
        traction = pressure[:, :, None] * normal
        load = w[:, :, None] * traction
        acting = pressure > 0.0
        area = float(w[acting].sum())
        return ContactState(
            energy,
            -self.surface.nodal(traction, len(u)),
            -load.sum(axis=(0, 1)),
            -np.cross(x - self.pose.position, load).sum(axis=(0, 1)),
            traction,
            float(np.sum(w[acting] * np.abs(gap[acting])) / area) if area else 0.0,
            area,
        )

    def hessian(self, u: np.ndarray, geometric: bool) -> ContactHessian:
        """Second derivative; without `geometric` its indefinite part -t Hess g is left out."""
        _, gap, normal, curvature = self._distance(u)
        pressure = np.maximum(0.0, self.multiplier - self.penalty * gap)
        return self.surface.hessian(self._normal_block(pressure, normal, curvature, geometric))

    def _normal_block(self, pressure, normal, curvature, geometric: bool) -> np.ndarray:
        acting = (pressure > 0.0)[:, :, None, None]
        block = np.where(acting, self.penalty * normal[:, :, :, None] * normal[:, :, None, :], 0.0)
        return block - pressure[:, :, None, None] * curvature if geometric else block

    def give(self, u: np.ndarray, pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How tractions at u (N, 3) m, with `pressure` (B, Q) Pa, follow a motion of the points.

        Returns:
            n (B, Q, 3), the way pressure pushes the tissue, and -d(traction)/dx (B, Q, 3, 3) Pa/m, zero where nothing
            touches.
        """
        _, _, normal, curvature = self._distance(u)
        return normal, self._normal_block(pressure, normal, curvature, True)

    def update(self, u: np.ndarray) -> None:
        """Multiplier update lambda <- t."""
        _, gap, _, _ = self._distance(u)
        self.multiplier = np.maximum(0.0, self.multiplier - self.penalty * gap)

    def touches(self, u: np.ndarray) -> bool:
        return bool(np.any(self.multiplier - self.penalty * self._distance(u)[1] > 0.0))


@dataclass
class Sticking:
    """The points that carried pressure follow the tool's translation.

    Attributes:
        penalty: eps_s, Pa/m.
        anchor: x_0, (B, Q, 3) m; where the points stood when sticking began.
        base: tau_0, (B, Q, 3) Pa.
        translation: D, (3,) m.
        reference: (3,) m; the tool's reference point when sticking began.
    """

    surface: ContactSurface
    penalty: float
    anchor: np.ndarray
    base: np.ndarray
    reference: np.ndarray
    translation: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def _acting(self) -> np.ndarray:
        return np.any(self._held != 0.0, axis=2)

    def __post_init__(self) -> None:
        self._held = self.base.copy()

    def _slack(self, u: np.ndarray) -> np.ndarray:
        return np.where(
            self._acting[:, :, None], self.surface.points(u) - self.anchor - self.translation, 0.0
        )

    def state(self, u: np.ndarray) -> ContactState:
        y = self._slack(u)
        traction = np.where(self._acting[:, :, None], self.base - self.penalty * y, 0.0)
        w = self.surface.weight[:, :, None]
        energy = float(np.sum(w * (-self.base * y + 0.5 * self.penalty * y**2)))
        load = w * traction
        arm = self.surface.points(u) - (self.reference + self.translation)
        area = float(self.surface.weight[self._acting].sum())
        slip = np.linalg.norm(y, axis=2)[self._acting]
        return ContactState(
            energy,
            -self.surface.nodal(traction, len(u)),
            -load.sum(axis=(0, 1)),
            -np.cross(arm, load).sum(axis=(0, 1)),
            traction,
            float(slip.mean()) if len(slip) else 0.0,
            area,
        )

    def hessian(self, u: np.ndarray, geometric: bool) -> ContactHessian:
        return self.surface.hessian(np.where(self._acting[:, :, None, None], self.penalty * np.eye(3), 0.0))

    def update(self, u: np.ndarray) -> None:
        """Augment: the traction found in equilibrium becomes the base."""
        self.base = np.where(self._acting[:, :, None], self.base - self.penalty * self._slack(u), 0.0)

    def load_of_translation(self, node_count: int) -> np.ndarray:
        """(N, 3, 3) N/m; minus the derivative of the gradient with respect to D, per direction of D (last axis)."""
        unit = np.where(self._acting, self.penalty, 0.0)[:, :, None]
        columns = [self.surface.nodal(unit * np.eye(3)[k], node_count) for k in range(3)]
        return np.stack(columns, axis=2)
