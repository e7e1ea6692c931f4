# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Manufactured solutions: a displacement is chosen, and the loads that keep it in equilibrium follow.

(Roache, Code verification by the method of manufactured solutions, J. Fluids Eng. 124:4-10, 2002.)  In axes turned
by Q against the cube's, with k = pi / side,

    u_1 = A/k sin(k x_2 + 0.3) sin(k x_3),   u_2 = A/k sin(k x_3 + 0.5),
    u_3 = (mu/kappa) B/k cos(k x_3 + 0.2) sin(k x_1 + 0.7)

The first two are shears (det F = 1); the third swells by some mu/kappa only, so that pressure, kappa (J - 1), stays of
the order of B mu however nearly incompressible the solid is.  With H = grad u and F = 1 + H,

    small strain    P = 2 mu dev(sym H) + kappa tr(H) 1
    finite strain   P = mu J^(-2/3) (F - I1/3 F^-T) + kappa (J - 1) J F^-T
    body force      f = -Div P,  dP/dx_j = Im P(x + i h e_j) / h       (complex step: nothing cancels)
    traction        t = P N

all in NumPy, apart from the kernels.  Five faces of the cube have the displacement given, the top one the traction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.block import block
from palpate.fem_offline.material import FULL_SHARE, NeoHookean
from palpate.fem_offline.quadratic_space import (
    EDGES,
    QuadraticSpace,
    face_shape,
    quadratic_space,
    shape_gradients_barycentric,
)
from palpate.fem_offline.verification.loaded_body import LoadedBody, faces_where
from palpate.fem_offline.verification.simplex_rule import simplex_rule

__all__ = ["SIDE", "Manufactured", "cube", "errors", "manufactured_body"]

SIDE = 0.03
"""m."""

_axis = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
_cross = np.cross(np.eye(3), _axis)
TURN = np.eye(3) + np.sin(0.6) * _cross + (1.0 - np.cos(0.6)) * _cross @ _cross
"""Q."""

TET_POINTS, TET_WEIGHTS = simplex_rule(3, 4)
FACE_POINTS, FACE_WEIGHTS = simplex_rule(2, 4)


@dataclass(frozen=True)
class Manufactured:
    """A solution and its loads, mu = 1 Pa.

    Attributes:
        poissons_ratio: of small strains.
        shear: A.  swelling: B.
        finite: neo-Hookean at finite strain; else Hooke at small strain.
    """

    poissons_ratio: float
    shear: float
    swelling: float
    finite: bool

    @property
    def material(self) -> NeoHookean:
        return NeoHookean(2.0 * (1.0 + self.poissons_ratio), self.poissons_ratio)

    def displacement(self, x: np.ndarray) -> np.ndarray:
        """u, (..., 3) m, at points (..., 3) m."""
        k = np.pi / SIDE
        x1, x2, x3 = np.moveaxis(k * (x @ TURN.T), -1, 0)
        A, B = self.shear / k, self.swelling / self.material.bulk_modulus / k
        u1, u2 = A * np.sin(x2 + 0.3) * np.sin(x3), A * np.sin(x3 + 0.5)
        return np.stack([u1, u2, B * np.cos(x3 + 0.2) * np.sin(x1 + 0.7)], axis=-1) @ TURN

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """H, (..., 3, 3), at points (..., 3) m, complex ones too."""
        x1, x2, x3 = np.moveaxis(np.pi / SIDE * (x @ TURN.T), -1, 0)
        A, B = self.shear, self.swelling / self.material.bulk_modulus
        H = np.zeros((*x1.shape, 3, 3), x1.dtype)
        H[..., 0, 1] = A * np.cos(x2 + 0.3) * np.sin(x3)
        H[..., 0, 2] = A * np.sin(x2 + 0.3) * np.cos(x3)
        H[..., 1, 2] = A * np.cos(x3 + 0.5)
        H[..., 2, 2] = -B * np.sin(x3 + 0.2) * np.sin(x1 + 0.7)
        H[..., 2, 0] = B * np.cos(x3 + 0.2) * np.cos(x1 + 0.7)
        return TURN.T @ H @ TURN

    def stress(self, x: np.ndarray) -> np.ndarray:
        """P, (..., 3, 3) Pa."""
        H, kappa = self.gradient(x), self.material.bulk_modulus
        if not self.finite:
            strain = 0.5 * (H + np.swapaxes(H, -1, -2))
            trace = np.trace(H, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
            return 2.0 * (strain - trace / 3.0) + kappa * trace
        F = np.eye(3) + H
        J, I1 = np.linalg.det(F)[..., None, None], np.sum(F * F, axis=(-1, -2))[..., None, None]
        Fit = np.swapaxes(np.linalg.inv(F), -1, -2)
        return J ** (-2.0 / 3.0) * (F - I1 / 3.0 * Fit) + kappa * (J - 1.0) * J * Fit

    def body_force(self, x: np.ndarray) -> np.ndarray:
        """f, (..., 3) N/m3."""
        h = 1e-20
        f = np.zeros_like(x)
        for j in range(3):
            f -= self.stress(x + 1j * h * np.eye(3)[j])[..., j].imag / h
        return f


def cube(divisions: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (P, 3) m and tets (T, 4) of a cube whose inside is smoothly distorted by up to 8 % of its side.

    Smoothly, so that meshes of one sequence are alike and slopes are not noise; random moves of 8 % of a cell gave the
    same slopes within 0.1.
    """
    mesh = block((1.0, 1.0, 1.0), (divisions,) * 3)
    x, y, z = (mesh.points - mesh.points.min(axis=0)).T
    bubble = 0.08 * np.sin(np.pi * x) * np.sin(np.pi * y) * np.sin(np.pi * z)
    moved = np.stack([np.sin(2.0 * y + z), np.cos(2.0 * z + x), np.sin(3.0 * x - y)], axis=1)
    return SIDE * (mesh.points + bubble[:, None] * moved), mesh.tets


def manufactured_body(solution: Manufactured, divisions: int, full_share: float = FULL_SHARE) -> LoadedBody:
    """The cube with the solution's loads, its displacement given on all faces but the top."""
    space = quadratic_space(*cube(divisions))
    x = space.nodes
    held = (np.abs(np.abs(x[:, :2]) - SIDE / 2) < 1e-9).any(axis=1) | (x[:, 2] < -SIDE + 1e-9)
    given = solution.displacement(x)
    held = np.repeat(held[:, None], 3, axis=1)
    return LoadedBody(space, solution.material, held, _load(space, solution), given, full_share)


def errors(space: QuadraticSpace, u: np.ndarray, solution: Manufactured) -> tuple[float, float]:
    """Relative errors of u (L2) and of its gradient (H1 seminorm), by quadrature of degree 7."""
    X = np.einsum("qk,ekj->eqj", TET_POINTS, space.nodes[space.elements[:, :4]])
    local = u[space.elements]
    found = np.einsum("qa,eai->eqi", _shape(TET_POINTS), local)
    dN = np.einsum("qak,ekj->eqaj", shape_gradients_barycentric(TET_POINTS), space.corner_gradients)
    gradient = np.einsum("eqaj,eai->eqij", dN, local)
    exact, exact_gradient = solution.displacement(X), solution.gradient(X)

    def norm(v: np.ndarray) -> float:
        squared = np.sum(v.reshape(*v.shape[:2], -1) ** 2, axis=2)
        return float(np.sqrt(space.volumes @ squared @ TET_WEIGHTS))

    return norm(found - exact) / norm(exact), norm(gradient - exact_gradient) / norm(exact_gradient)


def _load(space: QuadraticSpace, solution: Manufactured) -> np.ndarray:
    load = np.zeros_like(space.nodes)
    X = np.einsum("qk,ekj->eqj", TET_POINTS, space.nodes[space.elements[:, :4]])
    f = solution.body_force(X)
    shape = _shape(TET_POINTS)
    np.add.at(load, space.elements, np.einsum("q,e,qa,eqi->eai", TET_WEIGHTS, space.volumes, shape, f))
    faces = faces_where(space, lambda x: x[:, 2] > -1e-9)
    corners = space.nodes[faces]
    edges = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    traction = solution.stress(np.einsum("qk,ekj->eqj", FACE_POINTS, corners))[..., 2]  # N = e_z
    local = np.einsum("q,e,qa,eqi->eai", FACE_WEIGHTS, area, face_shape(FACE_POINTS), traction)
    np.add.at(load, space.face_nodes(faces), local)
    return load


def _shape(points: np.ndarray) -> np.ndarray:
    """(Q, 10) shape functions at barycentric points (Q, 4)."""
    edges = np.stack([4.0 * points[:, a] * points[:, b] for a, b in EDGES], axis=1)
    return np.concatenate([points * (2.0 * points - 1.0), edges], axis=1)
