# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.assembly import ElementSystem
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.material import Linear, NeoHookean
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.verification.elements import irregular_mesh, stiffness_of, system_of

STIFF = NeoHookean(5400.0, 0.4999)


@pytest.fixture(scope="module")
def space():
    return irregular_mesh()


@pytest.mark.parametrize("pressure", [-50.0, 50.0])
def test_held_body_is_stable_under_any_uniform_pressure(space, pressure):
    """det F is a null Lagrangian: inside moves cannot work against pressure.  With J at centres, 5 mu was too much."""
    low, high = space.nodes.min(axis=0), space.nodes.max(axis=0)
    held = np.any((space.nodes < low + 1e-9) | (space.nodes > high - 1e-9), axis=1)
    pattern = hessian_pattern(space.elements, np.repeat(held, 3), [])
    J = 1.0 + pressure * STIFF.shear_modulus / STIFF.bulk_modulus
    factor = Factor(pattern.row_start, pattern.column)
    factor.factorise(system_of(space, STIFF).hessian(space.nodes * (np.cbrt(J) - 1.0), pattern))


def test_volume_is_judged_by_its_mean(space):
    """psi grows by kappa_mean/2 times the square of the mean of J - 1 over the four points, and by nothing else."""
    u = 3e-4 * np.random.default_rng(0).standard_normal(space.nodes.shape)
    soft = NeoHookean(
        2.0 * STIFF.shear_modulus * (1.0 + 2.0 / 7.0), 2.0 / 7.0
    )  # kappa = 2 mu: nothing for the mean
    assert soft.shear_modulus == pytest.approx(STIFF.shear_modulus, rel=1e-14)
    difference = system_of(space, STIFF).state(u).energy - system_of(space, soft).state(u).energy
    a, b = 0.5854101966249685, 0.1381966011250105
    j = np.zeros(len(space.elements))
    for q in range(4):
        L = np.full(4, b)
        L[q] = a
        H = np.zeros((len(j), 3, 3))
        for node in range(10):
            if node < 4:
                gradient = (4.0 * L[node] - 1.0) * space.corner_gradients[:, node]
            else:
                i, k = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))[node - 4]
                gradient = 4.0 * (L[k] * space.corner_gradients[:, i] + L[i] * space.corner_gradients[:, k])
            H += u[space.elements[:, node], :, None] * gradient[:, None, :]
        j += 0.25 * (np.linalg.det(np.eye(3) + H) - 1.0)
    kappa = STIFF.bulk_modulus - soft.bulk_modulus
    assert difference == pytest.approx(0.5 * kappa * np.sum(space.volumes * j**2), rel=1e-9)


def test_derivatives_hold_where_linear_and_hyperelastic_share_elements():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    space = quadratic_space(points, np.array([[0, 1, 2, 3], [1, 2, 3, 4]]))
    system = ElementSystem(space, [STIFF, Linear(3000.0, 0.49)], np.array([[0.3, 0.7], [1.0, 0.0]]))
    random = np.random.default_rng(1)
    u, v = 0.03 * random.standard_normal((2, *space.nodes.shape))
    h = 1e-5

    def slope(f):
        return (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)

    force = system.state(u).force
    assert slope(lambda t: system.state(u + t * v).energy) == pytest.approx(np.sum(force * v), rel=1e-8)
    product = stiffness_of(system, u) @ v.ravel()
    change = slope(lambda t: system.state(u + t * v).force).ravel()
    assert change == pytest.approx(product, abs=1e-8 * np.abs(product).max())
