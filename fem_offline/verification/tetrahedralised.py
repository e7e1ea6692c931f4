# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows on a mesh as the product makes it: a ball of 30 mm radius, repaired and tetrahedralised by fTetWild.

Patch test, twice.  A linear displacement, x -> x + H X, must leave no residual inside (the element is consistent),
and, given on the boundary alone, must come back inside (it is solvable: no mode of its own, at nu = 0.4999 too).
Homogeneous states are averaged from nodal forces as in elements.py.

Pressure modes.  The split element has a constant pressure in each tetrahedron.  Quadratic tetrahedra have no node on
their faces that could steer the flux through them, so the usual proof of stability (Boffi, Brezzi and Fortin 2013,
section 8.4) does not cover them, and it depends on the mesh whether a pressure can exist that no displacement feels.
With B the mean div of each, M their volumes, A the stiffness without what acts on mean volumes,

    beta_i^2 = eigenvalues of M^-1/2 B A^-1 B^T M^-1/2 mu

where one zero (uniform pressure in a body held all around) is physical; a second would be a spurious mode.  (Blocks in
five tetrahedra a cell, block.py, have many: 64 with 320 tetrahedra in 4 x 4 x 4 cells.  Displacements do not mind.)

Stability under pressure.  Held all around, a body under uniform pressure cannot do work against it and stays stable
however large the pressure is (mean_dilatation.py).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import RULE_GRADIENTS
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.linear_solver import Factor, NotPositiveDefiniteError
from palpate.fem_offline.material import FULL_SHARE, NeoHookean
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space
from palpate.fem_offline.surface import repair_surface
from palpate.fem_offline.surface_parts import SurfacePart
from palpate.fem_offline.tetrahedra import tetrahedralise
from palpate.fem_offline.verification.elements import mean_stress, system_of
from palpate.fem_offline.verification.homogeneous import stretch_and_shear, uniaxial
from palpate.fem_offline.verification.loaded_body import LoadedBody, finite_strain
from palpate.fem_offline.verification.row import Row

__all__ = ["ball_mesh", "pressure_modes", "tetrahedralised_rows"]

NEARLY_INCOMPRESSIBLE = NeoHookean(5400.0, 0.4999)
SOFT = NeoHookean(5400.0, 0.48)
_deformation = np.eye(3) + 0.1 * np.random.default_rng(3).standard_normal((3, 3))
GRADIENT = _deformation / np.cbrt(np.linalg.det(_deformation)) - np.eye(3)
"""H; keeps volume, as everything must that nu = 0.4999 is asked to do."""


def ball_mesh(mesh_size: float) -> QuadraticSpace:
    """A ball of 30 mm radius, edges of about `mesh_size` m: 9 mm makes some 1,800 tetrahedra."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.03)
    part = SurfacePart("ball", np.array(ball.vertices, float), np.array(ball.faces, np.int32))
    mesh = tetrahedralise(repair_surface([part], edge=4e-3), mesh_size)
    return quadratic_space(mesh.points, mesh.tets)


def tetrahedralised_rows(modes: bool) -> Iterator[Row]:
    """Patch tests and homogeneous states; with `modes`, the pressure modes too."""
    space = ball_mesh(9e-3)
    yield _consistent(space)
    for material in (SOFT, NEARLY_INCOMPRESSIBLE):
        yield _solvable(space, material)
    yield from _homogeneous(space)
    yield from _stable_under_pressure(space, 50.0)
    if modes:
        yield _stable(ball_mesh(12e-3))


def _surface_nodes(space: QuadraticSpace) -> np.ndarray:
    """(N,) bool."""
    on = np.zeros(space.node_count, bool)
    on[space.face_nodes(boundary_faces(space.elements[:, :4]))] = True
    return on


def _consistent(space: QuadraticSpace) -> Row:
    force = system_of(space, SOFT).state(space.nodes @ GRADIENT.T).force
    on = _surface_nodes(space)
    largest = float(np.abs(force[~on]).max())
    error = largest / float(np.abs(force[on]).max())
    name = "patch test on an fTetWild mesh: residual"
    return Row(name, "zero residual inside", largest, error, 1e-10, f"{len(space.elements)} tetrahedra")


def _solvable(space: QuadraticSpace, material: NeoHookean) -> Row:
    """Inside nodes start beside the linear field; at nu = 0.4999, a micrometre beside it is a pressure of mu."""
    linear = space.nodes @ GRADIENT.T
    held = np.repeat(_surface_nodes(space)[:, None], 3, axis=1)
    body = LoadedBody(space, material, held, np.zeros_like(linear), linear)
    noise = 1e-7 * np.random.default_rng(4).standard_normal(linear.shape)
    u = finite_strain(body, np.where(held, linear, linear + noise))
    error = float(np.abs(u - linear).max() / np.abs(linear).max())
    name = f"patch test on an fTetWild mesh: solution, nu = {material.poissons_ratio:g}"
    return Row(
        name, "the linear field given at the surface", error, error, 1e-10, "finite strain, neo-Hookean"
    )


def _homogeneous(space: QuadraticSpace) -> Iterator[Row]:
    for material in (SOFT, NEARLY_INCOMPRESSIBLE):
        system = system_of(space, material)
        states = {
            "uniaxial, stretch 0.7": uniaxial(material, 0.7),
            "simple shear, 0.4": stretch_and_shear(material, (1.0, 1.0, 1.0), 0.4),
        }
        for name, state in states.items():
            P, psi = mean_stress(system, space.nodes @ (state.F - np.eye(3)).T)
            scale = float(np.abs(state.P).max())
            error = max(float(np.abs(P - state.P).max()) / scale, abs(psi / state.psi - 1.0))
            name = f"{name} on an fTetWild mesh, nu = {material.poissons_ratio:g}"
            yield Row(name, "closed form (homogeneous.py)", float(P[0, 0]), error, 1e-8)


def _stable(space: QuadraticSpace) -> Row:
    beta = pressure_modes(space)
    spurious = int(np.count_nonzero(beta < 1e-6)) - 1
    note = f"{len(space.elements)} tetrahedra; beta of the next modes is {beta[1]:.3f}, {beta[2]:.3f}, {beta[3]:.3f}"
    name = "spurious pressure modes on an fTetWild mesh"
    return Row(name, "none but the uniform one", float(spurious), float(abs(spurious)), 0.0, note)


def _stable_under_pressure(space: QuadraticSpace, pressure: float) -> Iterator[Row]:
    """Smallest pivot or eigenvalue is not asked for: a Cholesky factor exists or does not."""
    held = np.repeat(_surface_nodes(space), 3)
    pattern = hessian_pattern(space.elements, held, [])
    material = NEARLY_INCOMPRESSIBLE
    system = system_of(space, material)
    for sign, name in ((1.0, "tension"), (-1.0, "pressure")):
        J = 1.0 + sign * pressure * material.shear_modulus / material.bulk_modulus
        factor = Factor(pattern.row_start, pattern.column)
        try:
            factor.factorise(system.hessian(space.nodes * (np.cbrt(J) - 1.0), pattern))
            error = 0.0
        except NotPositiveDefiniteError:
            error = np.inf
        name = f"stable under a uniform {name} of {pressure:g} mu"
        yield Row(name, "a held body: det F is a null Lagrangian", pressure, error, 0.0, "Hessian factorised")


def pressure_modes(space: QuadraticSpace) -> np.ndarray:
    """(T,) beta_i, rising, of a body held at all of its surface; dense, for a thousand tetrahedra."""
    count = len(space.elements)
    held = np.repeat(_surface_nodes(space), 3)
    pattern = hessian_pattern(space.elements, held, [])
    # mu = 1 Pa, and kappa = FULL_SHARE mu, so that nothing is left for mean volumes
    nu = (1.5 * FULL_SHARE - 1.0) / (3.0 * FULL_SHARE + 1.0)
    system = system_of(space, NeoHookean(2.0 * (1.0 + nu), nu))
    factor = Factor(pattern.row_start, pattern.column)
    factor.factorise(system.hessian(np.zeros_like(space.nodes), pattern))
    gradients = np.einsum("ai,eij->eaj", RULE_GRADIENTS[4], space.corner_gradients)
    values = np.sqrt(space.volumes)[:, None, None] * gradients
    columns = 3 * space.elements[:, :, None] + np.arange(3)
    rows = np.broadcast_to(np.arange(count)[:, None, None], columns.shape)
    B = sparse.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(count, len(held)))
    B = B[:, ~held].toarray()
    S = B @ factor.solve(B.T)
    return np.sqrt(np.maximum(np.linalg.eigvalsh(0.5 * (S + S.T)), 0.0))
