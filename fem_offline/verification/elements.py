# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about the elements alone: derivatives, objectivity, rest, patch test.

Averages over a body in a homogeneous state come from its nodal forces, f_a = dW/du_a:

    V P = sum_a f_a (x) X_a,   V psi = W          (virtual work with u_a = H X_a, any H)
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementSystem
from palpate.fem_offline.block import block
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.material import Material, NeoHookean
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space
from palpate.fem_offline.verification.row import Row

__all__ = ["element_rows", "irregular_mesh", "mean_stress", "stiffness_of", "system_of"]

MATERIAL = NeoHookean(5400.0, 0.48)


def irregular_mesh(seed: int = 1) -> QuadraticSpace:
    """135 tetrahedra of a 30 mm cube, vertices moved at random by up to 1.5 mm inside and along nothing else."""
    mesh = block((0.03, 0.03, 0.03), (3, 3, 3))
    points = mesh.points.copy()
    inside = (
        np.all((np.abs(points[:, :2]) < 0.0149), axis=1) & (points[:, 2] < -1e-4) & (points[:, 2] > -0.0299)
    )
    points[inside] += np.random.default_rng(seed).uniform(-1.5e-3, 1.5e-3, (int(inside.sum()), 3))
    return quadratic_space(points, mesh.tets)


def system_of(space: QuadraticSpace, material: Material = MATERIAL) -> ElementSystem:
    """All elements of one material."""
    return ElementSystem(space, [material], np.ones((len(space.elements), 1)))


def mean_stress(system: ElementSystem, u: np.ndarray) -> tuple[np.ndarray, float]:
    """(first Piola-Kirchhoff stress (3, 3) Pa, energy density J/m3), averaged over the body."""
    volume = float(system.space.volumes.sum())
    state = system.state(u)
    return state.force.T @ system.space.nodes / volume, state.energy / volume


def stiffness_of(system: ElementSystem, u: np.ndarray) -> sparse.csr_matrix:
    """Hessian over all components, (3 N, 3 N) N/m."""
    pattern = hessian_pattern(system.space.elements, np.zeros(3 * system.space.node_count, bool), [])
    upper = pattern.matrix(system.hessian(u, pattern))
    return (upper + sparse.triu(upper, 1).T).tocsr()


def element_rows() -> Iterator[Row]:
    """Every row of this file; about a second."""
    space = irregular_mesh()
    system = system_of(space)
    random = np.random.default_rng(2)
    u = 4e-4 * random.standard_normal(space.nodes.shape)
    yield from _derivatives(system, u, random)
    yield _objectivity(system, u)
    yield _rest(system)
    yield _patch_test(system)


def _derivatives(system: ElementSystem, u: np.ndarray, random: np.random.Generator) -> Iterator[Row]:
    v = random.standard_normal(u.shape)
    v /= np.linalg.norm(v)
    h = 1e-6

    def richardson(f):  # error h^4
        return (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)

    force = system.state(u).force
    slope = richardson(lambda t: system.state(u + t * v).energy)
    exact = float(np.sum(force * v))
    yield Row(
        "force is the energy's derivative", "central differences", slope, abs(slope / exact - 1.0), 1e-6
    )
    change = richardson(lambda t: system.state(u + t * v).force).ravel()
    product = stiffness_of(system, u) @ v.ravel()
    error = float(np.linalg.norm(change - product) / np.linalg.norm(product))
    norm = float(np.linalg.norm(product))
    yield Row("Hessian is the force's derivative", "central differences", norm, error, 1e-6)


def _objectivity(system: ElementSystem, u: np.ndarray) -> Row:
    axis = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
    cross = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(1.1) * cross + (1.0 - np.cos(1.1)) * cross @ cross
    X = system.space.nodes
    state, turned = system.state(u), system.state((X + u) @ turn.T - X)
    error = max(
        abs(turned.energy / state.energy - 1.0),
        float(np.linalg.norm(turned.force - state.force @ turn.T) / np.linalg.norm(state.force)),
    )
    return Row("objectivity", "forces turn with the body, energy stays", turned.energy, error, 1e-10)


def _rest(system: ElementSystem) -> Row:
    state = system.state(np.zeros_like(system.space.nodes))
    scale = MATERIAL.shear_modulus * float(system.space.volumes.sum()) ** (2.0 / 3.0)
    largest = float(np.abs(state.force).max())
    return Row("rest is free of stress", "zero", largest, largest / scale, 1e-12)


def _patch_test(system: ElementSystem) -> Row:
    """A linear displacement leaves no residual inside an irregular mesh: the element is consistent."""
    space = system.space
    H = 0.1 * np.random.default_rng(3).standard_normal((3, 3))
    force = system.state(space.nodes @ H.T).force
    low, high = space.nodes.min(axis=0), space.nodes.max(axis=0)
    inside = np.all((space.nodes > low + 1e-9) & (space.nodes < high - 1e-9), axis=1)
    largest = float(np.abs(force[inside]).max())
    error = largest / float(np.abs(force[~inside]).max())
    return Row("patch test on an irregular mesh", "zero residual inside", largest, error, 1e-10)
