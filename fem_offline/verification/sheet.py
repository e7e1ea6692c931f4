# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about the capsule's membrane alone: a flat, irregular sheet, turned in space, in homogeneous states.

As in elements.py, averages come from nodal forces, V P = sum_a f_a (x) X_a with V = area times thickness.

The string equation: a sheet stretched along x carries the tension T (nominal stress times thickness times width); a
small transverse displacement w(x) then costs

    delta^2 W = T int w'^2 dx      over the deformed length l;   16 T h^2 / (3 l) for w = 4 h x (l - x) / l^2

(second variation of the length; Landau and Lifshitz, Theory of Elasticity, 1986, section 14).  With T < 0 it is
negative: a membrane alone has nothing that holds it against wrinkling.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import sparse
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from palpate.fem_offline.hessian_pattern import HessianPattern, hessian_pattern
from palpate.fem_offline.material import Linear, Material, NeoHookean
from palpate.fem_offline.membrane import Capsule, Membrane
from palpate.fem_offline.quadratic_space import FACE_EDGES
from palpate.fem_offline.verification import homogeneous
from palpate.fem_offline.verification.row import Row, against

__all__ = ["Sheet", "sheet", "sheet_rows"]

LENGTH, WIDTH, THICKNESS = 0.03, 0.02, 1e-4
"""m."""
STIFF = NeoHookean(5.4e5, 0.3)


class Sheet:
    """A rectangle of LENGTH by WIDTH in 24 irregular six-node triangles.

    Attributes:
        membrane: the sheet.
        frame: (3, 3) rows: along its length, along its width, normal.
        plane: (N, 2) m; the nodes in those axes.
    """

    def __init__(self, material: Material, thickness: float = THICKNESS) -> None:
        x, y = np.meshgrid(np.linspace(0, LENGTH, 5), np.linspace(0, WIDTH, 4), indexing="ij")
        points = np.stack([x, y], axis=-1)
        points[1:-1, 1:-1] += np.random.default_rng(4).uniform(-2e-3, 2e-3, points[1:-1, 1:-1].shape)
        points = points.reshape(-1, 2)
        triangles = Delaunay(points).simplices
        edges, inverse = np.unique(
            np.sort(triangles[:, FACE_EDGES].reshape(-1, 2), axis=1), axis=0, return_inverse=True
        )
        self.plane = np.concatenate([points, points[edges].mean(axis=1)])
        faces = np.concatenate([triangles, len(points) + inverse.reshape(-1, 3)], axis=1).astype(np.int32)
        self.frame = Rotation.from_rotvec([0.4, -0.8, 0.2]).as_matrix()
        self.membrane = Membrane(self.plane @ self.frame[:2], faces, Capsule(thickness, material))
        self.volume = LENGTH * WIDTH * thickness

    def stretched(self, H: np.ndarray) -> np.ndarray:
        """(N, 3) m; displacement of the sheet under the in-plane gradient H (2, 2)."""
        return self.plane @ H.T @ self.frame[:2]

    def mean_stress(self, u: np.ndarray) -> tuple[np.ndarray, float]:
        """(nominal stress (2, 2) Pa in the sheet's axes, energy density J/m3)."""
        state = self.membrane.state(u)
        return (state.force @ self.frame[:2].T).T @ self.plane / self.volume, state.energy / self.volume

    def stiffness(self, u: np.ndarray) -> sparse.csr_matrix:
        """(3 N, 3 N) N/m."""
        pattern = self._pattern()
        upper = pattern.matrix(self.membrane.hessian(u, pattern))
        return (upper + sparse.triu(upper, 1).T).tocsr()

    def _pattern(self) -> HessianPattern:
        nodes = self.membrane.faces
        dense = [(3 * face[:, None] + np.arange(3)).ravel() for face in nodes]
        return hessian_pattern(np.zeros((0, 10), int), np.zeros(3 * len(self.plane), bool), dense)


def sheet(poissons_ratio: float) -> Sheet:
    """A neo-Hookean sheet of STIFF's modulus."""
    return Sheet(NeoHookean(STIFF.youngs_modulus, poissons_ratio))


def sheet_rows() -> Iterator[Row]:
    """Every row of this file; seconds."""
    yield from _derivatives()
    yield _objectivity()
    for nu in (0.3, 0.4999):
        yield _plane_stress("uniaxial", nu, None)
        yield _plane_stress("equibiaxial", nu, (1.25, 1.25))
        yield _plane_stress("compressed", nu, (1.1, 0.8))
    yield _incompressible()
    yield _hooke()
    yield _string(1.2)
    yield _string(0.9)


def _random_displacement(one: Sheet) -> np.ndarray:
    return 3e-4 * np.random.default_rng(2).standard_normal(one.membrane.nodes.shape)


def _slope(f, h: float = 1e-6):
    """Central difference at zero, error h^4."""
    return (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)


def _derivatives() -> Iterator[Row]:
    one = sheet(0.3)
    u = _random_displacement(one)
    v = np.random.default_rng(3).standard_normal(u.shape)
    v /= np.linalg.norm(v)
    slope = _slope(lambda h: one.membrane.state(u + h * v).energy)
    exact = float(np.sum(one.membrane.state(u).force * v))
    name = "capsule: force is the energy's derivative"
    yield Row(name, "central differences", slope, abs(slope / exact - 1.0), 1e-6)
    change = _slope(lambda h: one.membrane.state(u + h * v).force).ravel()
    product = one.stiffness(u) @ v.ravel()
    error = float(np.linalg.norm(change - product) / np.linalg.norm(product))
    name = "capsule: Hessian is the force's derivative"
    yield Row(name, "central differences", float(np.linalg.norm(product)), error, 1e-6)


def _objectivity() -> Row:
    one = sheet(0.3)
    u, X = _random_displacement(one), one.membrane.nodes
    turn = Rotation.from_rotvec([0.3, 0.9, -0.6]).as_matrix()
    state, turned = one.membrane.state(u), one.membrane.state((X + u) @ turn.T - X)
    error = max(
        abs(turned.energy / state.energy - 1.0),
        float(np.linalg.norm(turned.force - state.force @ turn.T) / np.linalg.norm(state.force)),
    )
    return Row(
        "capsule: objectivity", "forces turn with the sheet, energy stays", turned.energy, error, 1e-10
    )


def _plane_stress(name: str, nu: float, stretch: tuple[float, float] | None) -> Row:
    """Principal stretches along axes turned by 30 degrees in the sheet; None: uniaxial by 1.3, the side free."""
    one = sheet(nu)
    material = one.membrane.capsule.material
    if stretch is None:
        stretch = (1.3, float(homogeneous.uniaxial(material, 1.3).F[1, 1]))
    expected = homogeneous.plane_stress(material, stretch)
    Q = Rotation.from_rotvec([0.0, 0.0, np.pi / 6.0]).as_matrix()[:2, :2]
    u = one.stretched(Q @ np.diag(stretch) @ Q.T - np.eye(2))
    P, psi = one.mean_stress(u)
    found = one.membrane.state(u).thickness
    error = max(
        float(np.abs(P - Q @ expected.P[:2, :2] @ Q.T).max() / np.abs(expected.P).max()),
        abs(psi / expected.psi - 1.0),
        float(np.abs(found / expected.F[2, 2] - 1.0).max()),
    )
    title = f"capsule: {name}, stretches {stretch[0]:g} and {stretch[1]:.3g}, nu = {nu:g}"
    return Row(title, "plane stress in closed form (homogeneous.py)", float(P[0, 0]), error, 1e-8)


def _incompressible() -> Row:
    """Equibiaxial P = mu (l - l^-5); the compressible sheet is off by O(mu/kappa), which is 2e-7 here."""
    one = sheet(0.4999999)
    P, _ = one.mean_stress(one.stretched(0.5 * np.eye(2)))
    expected = one.membrane.capsule.material.shear_modulus * (1.5 - 1.5**-5)
    name = "capsule: equibiaxial, stretch 1.5, incompressible limit"
    return against(name, "mu (l - l^-5), Treloar 1944", float(P[0, 0]), expected, 1e-6, "nu = 0.4999999")


def _hooke() -> Row:
    """sigma_x = E/(1 - nu^2) (e_x + nu e_y)."""
    nu, strain = 0.4, np.array([[0.02, 0.005], [0.005, -0.01]])
    one = Sheet(Linear(5.4e5, nu))
    P, _ = one.mean_stress(one.stretched(strain))
    expected = 5.4e5 / (1.0 - nu**2) * ((1.0 - nu) * strain + nu * np.trace(strain) * np.eye(2))
    error = float(np.abs(P - expected).max() / np.abs(expected).max())
    return Row("capsule: linear, Hooke's law in plane stress", "closed form", float(P[0, 0]), error, 1e-8)


def _string(stretch: float) -> Row:
    one = sheet(0.45)
    expected = homogeneous.uniaxial(one.membrane.capsule.material, stretch)
    u = one.stretched(expected.F[:2, :2] - np.eye(2))
    share = one.plane[:, 0] / LENGTH
    w = 4.0 * share * (1.0 - share)
    v = np.outer(w, one.frame[2]).ravel()
    tension, length = expected.P[0, 0] * THICKNESS * WIDTH, stretch * LENGTH
    name = f"capsule: transverse stiffness, stretch {stretch:g}"
    return against(
        name, "string equation", float(v @ (one.stiffness(u) @ v)), 16.0 * tension / (3.0 * length), 1e-8
    )
