# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about near-incompressibility: the quadratic element with kappa split must not lock, and the linear one does.

A short beam (40 x 10 x 10 mm, one end bonded, sheared at the other: Cook's trouble in three dimensions) and a confined
pad (20 x 20 x 5 mm, bonded below and on its sides, pressed on a fifth of its top), at small strains.  What is compared
is the work of the load, 2 W = f . u.  The converged value is bracketed: the split element comes from the soft
side, the same element with kappa at all four points from the stiff side, on a mesh twice as fine.

The linear tetrahedron needs no code of its own: a quadratic displacement whose mid-edge values are the means of
their corners' is a linear one, u_P2 = Z u_P1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementSystem, hessian_pattern
from palpate.fem_offline.block import block
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.material import FULL_SHARE, Material, NeoHookean
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space
from palpate.fem_offline.verification.row import Row

__all__ = ["LoadedBlock", "beam", "compliance", "locking_rows", "pad"]


@dataclass(frozen=True)
class LoadedBlock:
    """A block with held and loaded nodes.

    Attributes:
        space: nodes and elements.
        held: (N,) bool.
        load: (N, 3) N.
    """

    space: QuadraticSpace
    held: np.ndarray
    load: np.ndarray


def beam(fineness: int) -> LoadedBlock:
    """40 x 10 x 10 mm in 4 x 1 x 1 cells times `fineness`, sheared by 1 kPa at its end."""
    n = fineness
    mesh = block((0.04, 0.01, 0.01), (4 * n, n, n))
    space = quadratic_space(mesh.points, mesh.tets)
    faces = _faces(mesh.points, mesh.tets, lambda x: x[:, 0] > 0.02 - 1e-9)
    return LoadedBlock(
        space, space.nodes[:, 0] < -0.02 + 1e-9, _loads(space, faces, np.array([0.0, 0.0, -1e3]))
    )


def pad(fineness: int) -> LoadedBlock:
    """20 x 20 x 5 mm in 5 x 5 x 1 cells times `fineness`, 1 kPa on the middle cells of its top."""
    n = fineness
    mesh = block((0.02, 0.02, 0.005), (5 * n, 5 * n, n))
    space = quadratic_space(mesh.points, mesh.tets)
    faces = _faces(
        mesh.points, mesh.tets, lambda x: (x[:, 2] > -1e-9) & (np.abs(x[:, :2]).max(axis=1) < 2e-3 + 1e-9)
    )
    x = space.nodes
    held = (np.abs(x[:, :2]).max(axis=1) > 0.01 - 1e-9) | (x[:, 2] < -0.005 + 1e-9)
    return LoadedBlock(space, held, _loads(space, faces, np.array([0.0, 0.0, -1e3])))


def compliance(
    loaded: LoadedBlock, material: Material, linear: bool = False, full_share: float = FULL_SHARE
) -> float:
    """f . u, J, of the small-strain solution; `linear`: with P1 elements."""
    space = loaded.space
    system = ElementSystem(space, [material], np.ones((len(space.elements), 1)), full_share=full_share)
    pattern = hessian_pattern(space.elements, np.zeros(3 * space.node_count, bool), [])
    upper = pattern.matrix(system.hessian(np.zeros_like(space.nodes), pattern))
    K = (upper + sparse.triu(upper, 1).T).tocsr()
    f = loaded.load.ravel()
    free = np.repeat(~loaded.held, 3)
    if linear:
        Z = _linear_in_quadratic(space)
        K, f, free = (Z.T @ K @ Z).tocsr(), Z.T @ f, free[: Z.shape[1]]
    upper = sparse.triu(K[free][:, free]).tocsr()
    upper.sort_indices()
    factor = Factor(upper.indptr, upper.indices)
    factor.factorise(upper.data)
    return float(f[free] @ factor.solve(f[free]))


def locking_rows(confined: bool) -> Iterator[Row]:
    """Coarse meshes against the bracketed converged value, at nu 0.49 and 0.4999; with `confined`, the pad too."""
    for name, make in (("bending", beam), ("confined pad", pad))[: 1 + confined]:
        for nu in (0.49, 0.4999):
            material = NeoHookean(5400.0, nu)
            fine, coarse = make(4), make(2)
            stiff, soft = compliance(fine, material, full_share=np.inf), compliance(fine, material)
            ratio = compliance(coarse, material) / (0.5 * (stiff + soft))
            linear = compliance(coarse, material, linear=True) / (0.5 * (stiff + soft))
            bracket = (soft - stiff) / (soft + stiff)
            note = f"reference known to {bracket:.1%}; linear tetrahedra give {linear:.2f}"
            reference = "twice as fine, kappa split and not"
            yield Row(f"{name}, nu = {nu:g}", reference, ratio, abs(ratio - 1.0), 0.03, note)


def _faces(points: np.ndarray, tets: np.ndarray, inside) -> np.ndarray:
    faces = boundary_faces(tets)
    return faces[inside(points)[faces].all(axis=1)]


def _loads(space: QuadraticSpace, faces: np.ndarray, traction: np.ndarray) -> np.ndarray:
    """Uniform traction (3,) Pa: a third of each face's load to each mid-edge node, nothing to its corners."""
    x = space.nodes[faces]
    area = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
    load = np.zeros_like(space.nodes)
    for mid in space.face_nodes(faces)[:, 3:].T:
        np.add.at(load, mid, area[:, None] / 3.0 * traction)
    return load


def _linear_in_quadratic(space: QuadraticSpace) -> sparse.csr_matrix:
    corners = space.node_count - len(space.edge_nodes)
    a, b, mid = space.edge_nodes.T
    rows = np.concatenate([np.arange(corners), mid, mid])
    cols = np.concatenate([np.arange(corners), a, b])
    values = np.concatenate([np.ones(corners), np.full(2 * len(mid), 0.5)])
    nodal = sparse.csr_matrix((values, (rows, cols)), shape=(space.node_count, corners))
    return sparse.kron(nodal, sparse.eye(3)).tocsr()
