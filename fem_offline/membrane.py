# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A capsule: a thin membrane that is one with the organ's surface, in plane stress, of any material.

    W(u) = sum_q w_q t min_f psi(F_q),    F_q = F_s + f (x) N
    F_s = 1 - N (x) N + sum_a u_a (x) grad_s N_a(q)

N is the reference normal, t the thickness at rest, w_q reference area, grad_s the gradient in the face.  The column f,
the stretched and turned thickness, is free: at the minimum the stress on the membrane's own faces vanishes,

    P(F) N = 0                      (plane stress; f = normal times thickness stretch for isotropic materials)

and is found by Newton's method at each point.  By the envelope theorem the force is that of the in-plane columns alone;
the tangent is condensed statically (here Q_ij = A_ikjl N_k N_l and B_ikj = A_ikjl N_l):

    f_a = sum_q w_q t P grad_s N_a,    C = A - B Q^-1 B^T,    K_ab = sum_q w_q t grad_s N_a . C . grad_s N_b

(Holzapfel, Nonlinear Solid Mechanics, 2000, section 6.6, plane stress; de Souza Neto, Peric and Owen, Computational
Methods for Plasticity, 2008, section 9.2, its static condensation.)  Six-node triangles with three points, exact for a
linear membrane; kappa is integrated in full, because in plane stress nothing locks.

Limits: no bending stiffness, so what holds a membrane against wrinkling in compression is the tissue under it alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import warp as wp

from palpate.fem_offline import constitutive as law
from palpate.fem_offline import material_table as t
from palpate.fem_offline.batch import current_device, together
from palpate.fem_offline.contact import face_places
from palpate.fem_offline.hessian_pattern import HessianPattern
from palpate.fem_offline.material import Material
from palpate.fem_offline.material_table import material_table
from palpate.fem_offline.quadratic_space import FACE_EDGES
from palpate.fem_offline.side_by_side import Resident, SideBySide
from palpate.fem_offline.tensor4 import mat9x9
from palpate.fem_offline.warp_session import start_warp

__all__ = ["Capsule", "Membrane", "MembraneState"]

wp.set_module_options({"enable_backward": False, "max_unroll": 1})

THREE_POINT_RULE = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6.0
"""(3, 3) barycentric points of equal weight 1/3, exact to degree 2 (Strang and Fix 1973)."""

ITERATIONS = wp.constant(50)
"""Newton steps for the thickness; four do, near incompressibility two."""
CONVERGED = wp.constant(wp.float64(1.0e-9))
"""Relative change of the thickness after which a step is the last: the next would be its square."""

mat6x3 = wp.types.matrix(shape=(6, 3), dtype=wp.float64)
mat9x3 = wp.types.matrix(shape=(9, 3), dtype=wp.float64)
mat18x18 = wp.types.matrix(shape=(18, 18), dtype=wp.float64)


@wp.struct
class Faces:
    """One membrane's faces on a device; its part of common arrays begins at first_node and first_value."""

    faces: wp.array2d(dtype=wp.int32)
    gradients: wp.array2d(dtype=wp.vec3d)
    normals: wp.array(dtype=wp.vec3d)
    weights: wp.array(dtype=wp.float64)
    table: wp.array2d(dtype=wp.float64)
    entry: wp.array2d(dtype=wp.int32)
    first_node: wp.int32
    first_value: wp.int32


@dataclass(frozen=True)
class Capsule:
    """What the organ's surface is covered with.

    Attributes:
        thickness: m, at rest.
        material: any.
    """

    thickness: float
    material: Material

    def __post_init__(self) -> None:
        if not 0.0 < self.thickness < np.inf:
            raise ValueError(f"thickness is {self.thickness} m; it must be positive")


@wp.func
def surface_gradients(
    rule: wp.array3d(dtype=wp.float64), q: int, gradients: wp.array2d(dtype=wp.vec3d), b: int
) -> mat6x3:
    """grad_s N_a = sum_i dN_a/dL_i grad_s L_i, 1/m."""
    dN = mat6x3()
    for a in range(6):
        g = wp.vec3d()
        for i in range(3):
            g += gradients[b, i] * rule[q, a, i]
        for k in range(3):
            dN[a, k] = g[k]
    return dN


@wp.func
def in_plane(
    dN: mat6x3,
    s: Faces,
    b: int,
    u: wp.array(dtype=wp.vec3d),
    N: wp.vec3d,
) -> wp.mat33d:
    """F_s = 1 - N (x) N + sum_a u_a (x) grad_s N_a."""
    F = wp.identity(n=3, dtype=wp.float64) - wp.outer(N, N)
    for a in range(6):
        F += wp.outer(u[s.first_node + s.faces[b, a]], wp.vec3d(dN[a, 0], dN[a, 1], dN[a, 2]))
    return F


@wp.func
def energy_and_stress(F: wp.mat33d, table: wp.array2d(dtype=wp.float64)):
    """psi (float64) and P (mat33d), Pa."""
    kappa = table[0, t.KAPPA_FULL] + table[0, t.KAPPA_MEAN]
    psi, P = law.volumetric(F, table, 0, kappa)
    psi_iso, P_iso = law.isochoric(F, table, 0)
    return psi + psi_iso, P + P_iso


@wp.func
def tangent(F: wp.mat33d, table: wp.array2d(dtype=wp.float64)) -> mat9x9:
    """A = dP/dF, Pa."""
    kappa = table[0, t.KAPPA_FULL] + table[0, t.KAPPA_MEAN]
    return law.isochoric_tangent(F, table, 0) + law.volumetric_tangent(F, table, 0, kappa)


@wp.func
def normal_columns(A: mat9x9, N: wp.vec3d) -> mat9x3:
    """B_ikj = A_ikjl N_l."""
    B = mat9x3()
    for r in range(9):
        for j in range(3):
            B[r, j] = A[r, 3 * j] * N[0] + A[r, 3 * j + 1] * N[1] + A[r, 3 * j + 2] * N[2]
    return B


@wp.func
def normal_block(B: mat9x3, N: wp.vec3d) -> wp.mat33d:
    """Q_ij = B_ikj N_k."""
    Q = wp.mat33d()
    for i in range(3):
        for j in range(3):
            Q[i, j] = B[3 * i, j] * N[0] + B[3 * i + 1, j] * N[1] + B[3 * i + 2, j] * N[2]
    return Q


@wp.func
def deformed_area(F: wp.mat33d, E: wp.vec3d, N: wp.vec3d) -> wp.vec3d:
    """F_s E1 x F_s E2, the deformed normal times the area's ratio; det F = f . deformed_area."""
    return wp.cross(F * E, F * wp.cross(N, E))


@wp.func
def thickness_vector(F: wp.mat33d, E: wp.vec3d, N: wp.vec3d, table: wp.array2d(dtype=wp.float64)) -> wp.vec3d:
    """f with P(F_s + f (x) N) N = 0, started where volume is kept; zero where none was found."""
    c = deformed_area(F, E, N)
    f = c / wp.dot(c, c)
    for _step in range(ITERATIONS):
        G = F + wp.outer(f, N)
        _psi, P = energy_and_stress(G, table)
        r = P * N
        d = -(wp.inverse(normal_block(normal_columns(tangent(G, table), N), N)) * r)
        if int(table[0, t.MODEL]) != t.LINEAR:
            if wp.dot(r, d) > wp.float64(0.0):  # not convex here: downhill by a quarter of the thickness
                d = -r * (wp.float64(0.25) * wp.length(f) / wp.length(r))
            J = wp.dot(c, f)
            change = wp.dot(c, d)
            if change < -wp.float64(0.5) * J:
                d = d * (-wp.float64(0.5) * J / change)
            if change > J:
                d = d * (J / change)
        f += d
        if wp.dot(d, d) <= CONVERGED * CONVERGED * wp.dot(f, f):
            return f
    return wp.vec3d()


@wp.kernel
def energy_and_force(
    systems: wp.array(dtype=Faces),
    end: wp.array(dtype=wp.int32),
    rule: wp.array3d(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
    # outputs
    energy: wp.array(dtype=wp.float64),
    thickness: wp.array2d(dtype=wp.float64),
    force: wp.array(dtype=wp.vec3d),
):
    item = wp.tid()
    k = wp.lower_bound(end, item + 1)
    s = systems[k]
    b = item - end[k] + s.faces.shape[0]
    N = s.normals[b]
    E = wp.normalize(s.gradients[b, 0])
    W = wp.float64(0.0)
    local = mat6x3()
    for q in range(3):
        dN = surface_gradients(rule, q, s.gradients, b)
        F = in_plane(dN, s, b, u, N)
        f = thickness_vector(F, E, N, s.table)
        thickness[item, q] = wp.length(f)
        F += wp.outer(f, N)
        psi, P = energy_and_stress(F, s.table)
        W += s.weights[b] * psi
        for a in range(6):
            g = P * wp.vec3d(dN[a, 0], dN[a, 1], dN[a, 2]) * s.weights[b]
            for i in range(3):
                local[a, i] = local[a, i] + g[i]
    energy[item] = W
    for a in range(6):
        wp.atomic_add(force, s.first_node + s.faces[b, a], wp.vec3d(local[a, 0], local[a, 1], local[a, 2]))


@wp.kernel
def hessian(
    systems: wp.array(dtype=Faces),
    end: wp.array(dtype=wp.int32),
    rule: wp.array3d(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
    # outputs
    values: wp.array(dtype=wp.float64),
):
    item = wp.tid()
    k = wp.lower_bound(end, item + 1)
    s = systems[k]
    b = item - end[k] + s.faces.shape[0]
    N = s.normals[b]
    E = wp.normalize(s.gradients[b, 0])
    K = mat18x18()
    for q in range(3):
        dN = surface_gradients(rule, q, s.gradients, b)
        F = in_plane(dN, s, b, u, N)
        F += wp.outer(thickness_vector(F, E, N, s.table), N)
        A = tangent(F, s.table)
        B = normal_columns(A, N)
        C = (A - B * wp.inverse(normal_block(B, N)) * wp.transpose(B)) * s.weights[b]
        for c in range(6):
            for j in range(3):
                for i in range(3):
                    t = wp.vec3d()
                    for n in range(3):
                        for l in range(3):
                            t[n] = t[n] + C[3 * i + n, 3 * j + l] * dN[c, l]
                    for a in range(6):
                        K[3 * a + i, 3 * c + j] = (
                            K[3 * a + i, 3 * c + j] + dN[a, 0] * t[0] + dN[a, 1] * t[1] + dN[a, 2] * t[2]
                        )
    for r in range(18):
        for c in range(18):
            at = s.entry[b, r * 18 + c]
            if at >= 0:
                wp.atomic_add(values, s.first_value + at, K[r, c])


@dataclass(frozen=True)
class MembraneState:
    """A membrane at one displacement.

    Attributes:
        energy: J; infinite where the plane stress was not found.
        force: (N, 3) N; dW/du.
        thickness: (B, 3) thickness over that at rest, at the quadrature points.
    """

    energy: float
    force: np.ndarray
    thickness: np.ndarray


@dataclass
class Membrane(Resident):
    """A capsule on some surface faces.

    Attributes:
        nodes: (N, 3) m.
        faces: (B, 6) quadratic face nodes.
        device: Warp device; that of this thread's batch where none is given.
    """

    nodes: np.ndarray
    faces: np.ndarray
    capsule: Capsule
    device: str = field(default_factory=current_device)
    kind = Faces
    hessian_kernel = hessian

    def __post_init__(self) -> None:
        start_warp()
        x = self.nodes[self.faces[:, :3]]
        area = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        twice = np.linalg.norm(area, axis=1)
        self.normals = area / twice[:, None]
        # grad_s L_i = N x (opposite edge) / (2 area)
        opposite = x[:, [2, 0, 1]] - x[:, [1, 2, 0]]
        gradients = np.cross(self.normals[:, None], opposite) / twice[:, None, None]
        self.area = 0.5 * twice
        L = THREE_POINT_RULE
        rule = np.zeros((3, 6, 3))
        rule[:, range(3), range(3)] = 4.0 * L - 1.0
        for e, (i, j) in enumerate(FACE_EDGES):
            rule[:, 3 + e, i], rule[:, 3 + e, j] = 4.0 * L[:, j], 4.0 * L[:, i]
        weights = self.area * self.capsule.thickness / len(L)
        arrays = {
            "faces": (self.faces, wp.int32),
            "gradients": (gradients, wp.vec3d),
            "normals": (self.normals, wp.vec3d),
            "weights": (weights, wp.float64),
            "table": (material_table([self.capsule.material]), wp.float64),
        }
        self.place(arrays, rule)

    @property
    def item_count(self) -> int:
        return len(self.faces)

    @property
    def node_count(self) -> int:
        return len(self.nodes)

    def entry(self, pattern: HessianPattern) -> np.ndarray:
        """Of a pattern that has the faces' blocks."""
        return face_places(pattern, self.faces).reshape(len(self.faces), 324)

    def state(self, u: np.ndarray) -> MembraneState:
        """Energy, nodal forces and thickness at the displacement u (N, 3) m."""
        return together(states, (self, u))


def states(asked: Sequence[tuple[Membrane, np.ndarray]]) -> list[MembraneState]:
    """Of membranes on one device, each at its displacement (N, 3) m, in one launch."""
    found = []
    for energy, thickness, force in SideBySide.of(*zip(*asked, strict=True)).apart(energy_and_force, 3):
        total = float(energy.sum()) if np.all(thickness > 0.0) else np.inf
        found.append(MembraneState(total if np.isfinite(total) else np.inf, force, thickness))
    return found
