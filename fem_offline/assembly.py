# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Energy, nodal forces and Hessian of quadratic tetrahedra, as Warp kernels.

    W(u) = sum_e sum_m fraction_em W_em
    W_em = sum_{q=0..3} V/4 (psi_iso(F_q) + psi_vol(F_q; kappa_full)) + V kappa_mean/2 j^2
    F_q = I + sum_a u_a (x) grad N_a(q)
    f_a = dW/du_a = sum_q w_q P(F_q) grad N_a,    K_ab = sum_q w_q grad N_a . A(F_q) . grad N_b

j is the tetrahedron's mean volume strain (mean_dilatation.py).  A tetrahedron cut by a border between materials mixes
their energies.  The split of kappa: material_table.py.
Everything is float64.  `max_unroll = 1` keeps a cold compile at seconds instead of half a minute.
One launch evaluates any number of systems (side_by_side.py), those of other presses too (batch.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import warp as wp

from palpate.fem_offline import constitutive as law
from palpate.fem_offline import material_table as t
from palpate.fem_offline.batch import current_device, together
from palpate.fem_offline.hessian_pattern import HessianPattern
from palpate.fem_offline.material_table import FULL_SHARE, Tabulated, material_table
from palpate.fem_offline.mean_dilatation import (
    cofactor,
    mean_kappa,
    mean_stress,
    mean_tangent,
    volume_strain,
)
from palpate.fem_offline.quadratic_space import (
    CENTRE_RULE,
    FOUR_POINT_RULE,
    QuadraticSpace,
    shape_gradients_barycentric,
)
from palpate.fem_offline.side_by_side import Resident, SideBySide
from palpate.fem_offline.tensor4 import mat9x9
from palpate.fem_offline.warp_session import start_warp

__all__ = ["ElementState", "ElementSystem", "states"]

wp.set_module_options({"enable_backward": False, "max_unroll": 1})

RULE_GRADIENTS = shape_gradients_barycentric(np.concatenate([FOUR_POINT_RULE, CENTRE_RULE]))
"""(5, 10, 4): four points of integration; the centre, where J is looked at as well before a state is accepted."""

POINT_COUNT = wp.constant(len(FOUR_POINT_RULE))
QUARTER = wp.constant(wp.float64(0.25))

mat10x3 = wp.types.matrix(shape=(10, 3), dtype=wp.float64)
mat3x10 = wp.types.matrix(shape=(3, 10), dtype=wp.float64)
mat12x10 = wp.types.matrix(shape=(12, 10), dtype=wp.float64)
mat108x10 = wp.types.matrix(shape=(108, 10), dtype=wp.float64)


@wp.struct
class Elements:
    """One system's elements on a device; its part of common arrays begins at first_node and first_value."""

    elements: wp.array2d(dtype=wp.int32)
    corner_gradients: wp.array2d(dtype=wp.vec3d)
    volumes: wp.array(dtype=wp.float64)
    table: wp.array2d(dtype=wp.float64)
    fraction: wp.array2d(dtype=wp.float64)
    entry: wp.array2d(dtype=wp.int32)
    first_node: wp.int32
    first_value: wp.int32


@wp.func
def shape_gradients(
    rule: wp.array3d(dtype=wp.float64), q: int, corner_gradients: wp.array2d(dtype=wp.vec3d), e: int
) -> mat10x3:
    """grad N_a = sum_i dN_a/dL_i grad L_i, 1/m."""
    dN = mat10x3()
    for a in range(10):
        g = wp.vec3d()
        for i in range(4):
            g += corner_gradients[e, i] * rule[q, a, i]
        dN[a, 0] = g[0]
        dN[a, 1] = g[1]
        dN[a, 2] = g[2]
    return dN


@wp.func
def deformation_gradient(dN: mat10x3, s: Elements, e: int, u: wp.array(dtype=wp.vec3d)) -> wp.mat33d:
    """F = I + sum_a u_a (x) grad N_a."""
    F = wp.identity(n=3, dtype=wp.float64)
    for a in range(10):
        F += wp.outer(u[s.first_node + s.elements[e, a]], wp.vec3d(dN[a, 0], dN[a, 1], dN[a, 2]))
    return F


@wp.func
def gradient_of(U: mat3x10, D: mat12x10, q: int) -> wp.mat33d:
    """F = I + U D^T at point q."""
    F = wp.identity(n=3, dtype=wp.float64)
    for i in range(3):
        for k in range(3):
            F[i, k] = F[i, k] + wp.dot(U[i], D[3 * q + k])
    return F


@wp.func
def response(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int):
    """psi and P of material m at a quadrature point, without what acts on the mean volume, Pa."""
    psi, P = law.isochoric(F, table, m)
    psi_vol, P_vol = law.volumetric(F, table, m, table[m, t.KAPPA_FULL])
    return psi + psi_vol, P + P_vol


@wp.func
def tangent(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int) -> mat9x9:
    """A = dP/dF of `response`."""
    return law.isochoric_tangent(F, table, m) + law.volumetric_tangent(F, table, m, table[m, t.KAPPA_FULL])


@wp.kernel
def energy_and_force(
    systems: wp.array(dtype=Elements),
    end: wp.array(dtype=wp.int32),
    rule: wp.array3d(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
    # outputs
    energy: wp.array(dtype=wp.float64),
    smallest_jacobian: wp.array2d(dtype=wp.float64),
    force: wp.array(dtype=wp.vec3d),
):
    item = wp.tid()
    k = wp.lower_bound(end, item + 1)
    s = systems[k]
    e = item - end[k] + s.elements.shape[0]
    J_min = wp.float64(1.0e30)
    j = wp.vec2d()
    for q in range(POINT_COUNT + 1):
        F = deformation_gradient(shape_gradients(rule, q, s.corner_gradients, e), s, e, u)
        J_min = wp.min(J_min, wp.determinant(F))
        if q < POINT_COUNT:
            j += volume_strain(F) * QUARTER
    p = wp.cw_mul(mean_kappa(s.table, s.fraction, e), j)
    W = wp.float64(0.5) * s.volumes[e] * wp.dot(p, j)
    weight = s.volumes[e] * QUARTER
    local = mat10x3()
    for q in range(POINT_COUNT):
        dN = shape_gradients(rule, q, s.corner_gradients, e)
        F = deformation_gradient(dN, s, e, u)
        P = mean_stress(F, p) * weight
        for m in range(s.table.shape[0]):
            if s.fraction[e, m] != wp.float64(0.0):
                psi, P_m = response(F, s.table, m)
                W += weight * s.fraction[e, m] * psi
                P += P_m * (weight * s.fraction[e, m])
        for a in range(10):
            f = P * wp.vec3d(dN[a, 0], dN[a, 1], dN[a, 2])
            for i in range(3):
                local[a, i] = local[a, i] + f[i]
    energy[item] = W
    smallest_jacobian[item, 0] = J_min
    for a in range(10):
        wp.atomic_add(force, s.first_node + s.elements[e, a], wp.vec3d(local[a, 0], local[a, 1], local[a, 2]))


@wp.kernel
def hessian(
    systems: wp.array(dtype=Elements),
    end: wp.array(dtype=wp.int32),
    rule: wp.array3d(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
    # outputs
    values: wp.array(dtype=wp.float64),
):
    item = wp.tid()
    k = wp.lower_bound(end, item + 1)
    s = systems[k]
    e = item - end[k] + s.elements.shape[0]
    U = mat3x10()
    for a in range(10):
        x = u[s.first_node + s.elements[e, a]]
        for i in range(3):
            U[i, a] = x[i]
    D = mat12x10()  # gradients; row 3 q + k: of all nodes along k at point q
    g = mat3x10()  # derivative of the mean J - 1
    h = mat3x10()  # of the mean tr(F - 1)
    j_mean = wp.vec2d()
    for q in range(POINT_COUNT):
        for a in range(10):
            slope = wp.vec3d()
            for i in range(4):
                slope += s.corner_gradients[e, i] * rule[q, a, i]
            for i in range(3):
                D[3 * q + i, a] = slope[i]
        F = gradient_of(U, D, q)
        j_mean += volume_strain(F) * QUARTER
        C = cofactor(F) * QUARTER
        for i in range(3):
            g[i] = g[i] + D[3 * q] * C[i, 0] + D[3 * q + 1] * C[i, 1] + D[3 * q + 2] * C[i, 2]
            h[i] = h[i] + D[3 * q + i] * QUARTER
    kappa = mean_kappa(s.table, s.fraction, e)
    p = wp.cw_mul(kappa, j_mean)
    weight = s.volumes[e] * QUARTER
    T = mat108x10()  # row 12 (3 i + j) + 3 q + k: sum_l A_ikjl(q) grad_l N_b
    for q in range(POINT_COUNT):
        F = gradient_of(U, D, q)
        A = mean_tangent(F, p) * weight  # A[3 i + k, 3 j + l] = w d P_ik / d F_jl
        for m in range(s.table.shape[0]):
            if s.fraction[e, m] != wp.float64(0.0):
                A += tangent(F, s.table, m) * (weight * s.fraction[e, m])
        for i in range(3):
            for j in range(i, 3):
                for n in range(3):
                    T[12 * (3 * i + j) + 3 * q + n] = (
                        D[3 * q] * A[3 * i + n, 3 * j]
                        + D[3 * q + 1] * A[3 * i + n, 3 * j + 1]
                        + D[3 * q + 2] * A[3 * i + n, 3 * j + 2]
                    )
    kappa = kappa * s.volumes[e]
    n_entry = wp.int32(0)
    for i in range(3):
        for j in range(i, 3):
            for a in range(10):
                row = g[j] * (kappa[0] * g[i, a]) + h[j] * (kappa[1] * h[i, a])
                for n in range(12):
                    row += T[12 * (3 * i + j) + n] * D[n, a]
                first = 0
                if i == j:
                    first = a
                for b in range(first, 10):
                    at = s.entry[e, n_entry]
                    if at >= 0:
                        wp.atomic_add(values, s.first_value + at, row[b])
                    n_entry += 1


@dataclass(frozen=True)
class ElementState:
    """Elastic state at one displacement.

    Attributes:
        energy: J; infinite where an element is inverted or its energy overflows.
        force: (N, 3) N; dW/du at every node, fixed ones included.
        smallest_jacobian: smallest det F over the quadrature points.
    """

    energy: float
    force: np.ndarray
    smallest_jacobian: float


@dataclass
class ElementSystem(Resident):
    """The elements of one mesh, on one Warp device.

    Attributes:
        space: nodes and elements.
        materials: M of them.
        fraction: (T, M); how much of each material's energy an element has, as a rule adding up to one.
        device: Warp device; that of this thread's batch where none is given.
        full_share: of kappa, see material_table.py.
    """

    space: QuadraticSpace
    materials: Sequence[Tabulated]
    fraction: np.ndarray
    device: str = field(default_factory=current_device)
    full_share: float = FULL_SHARE
    kind = Elements
    hessian_kernel = hessian

    def __post_init__(self) -> None:
        start_warp()
        if np.shape(self.fraction) != (self.item_count, len(self.materials)):
            raise ValueError(
                f"fraction has shape {np.shape(self.fraction)}; "
                f"expected {self.item_count} tetrahedra by {len(self.materials)} materials"
            )
        space, table = self.space, material_table(self.materials, self.full_share)
        arrays = {
            "elements": (space.elements, wp.int32),
            "corner_gradients": (space.corner_gradients, wp.vec3d),
            "volumes": (space.volumes, wp.float64),
            "table": (table, wp.float64),
            "fraction": (self.fraction, wp.float64),
        }
        self.place(arrays, RULE_GRADIENTS)

    @property
    def item_count(self) -> int:
        return len(self.space.elements)

    @property
    def node_count(self) -> int:
        return self.space.node_count

    def entry(self, pattern: HessianPattern) -> np.ndarray:
        return pattern.entry

    def state(self, u: np.ndarray) -> ElementState:
        """Energy and nodal forces at the displacement u (N, 3) m."""
        return together(states, (self, u))


def states(asked: Sequence[tuple[ElementSystem, np.ndarray]]) -> list[ElementState]:
    """Of systems on one device, each at its displacement (N, 3) m, in one launch."""
    found = []
    for energy, jacobian, force in SideBySide.of(*zip(*asked, strict=True)).apart(energy_and_force):
        smallest = float(jacobian.min())
        total = float(energy.sum()) if smallest > 0.0 else np.inf
        total = total if np.isfinite(total) else np.inf  # a stiffening energy overflows at absurd stretches
        found.append(ElementState(total, force, smallest))
    return found
