# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The layer's integral equation against what is known of layers on other grounds."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import j0

from palpate.fem_offline.verification import hertz, sneddon
from palpate.fem_offline.verification.bonded_layer import BondedLayer

HAYES = {  # Hayes et al. 1972, as commonly quoted, not checked against a copy: kappa at nu = 0.3, 0.35, 0.4, 0.45, 0.5
    0.2: (1.207, 1.218, 1.232, 1.252, 1.281),
    0.4: (1.472, 1.502, 1.542, 1.599, 1.683),
    0.6: (1.784, 1.839, 1.917, 2.031, 2.211),
    1.0: (2.480, 2.603, 2.789, 3.085, 3.609),
    2.0: (4.336, 4.685, 5.271, 6.380, 9.069),
}


@pytest.mark.parametrize("x", [0.05, 0.4, 1.0, 3.0, 8.0])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.48])
def test_compliance_solves_naviers_equations_in_the_layer(nu, x):
    # u = (U(z) sin kx, W(z) cos kx), k = x, h = 1, mu = 1; u = 0 at z = 0; shear 0 and normal stress cos kx at z = 1
    k, lam = x, 2.0 * nu / (1.0 - 2.0 * nu)
    A = np.zeros((4, 4))  # of (U, W, U', W')
    A[0, 2] = A[1, 3] = 1.0
    A[2, 0], A[2, 3] = (lam + 2.0) * k**2, (lam + 1.0) * k
    A[3, 1], A[3, 2] = k**2 / (lam + 2.0), -(lam + 1.0) * k / (lam + 2.0)
    end = expm(A)[:, 2:]  # states at z = 1 that the slopes at z = 0 lead to
    shear = end[2] - k * end[1]
    normal = (lam + 2.0) * end[3] + lam * k * end[0]
    W = end[1] @ np.linalg.solve([shear, normal], [0.0, 1.0])
    # a half space of mu = 1 moves by (1 - nu) / k under it
    assert BondedLayer(1.0, nu, 1.0).compliance(x) == pytest.approx(W * k / (1.0 - nu), rel=1e-8)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_the_surface_takes_the_punchs_shape(nu):
    layer, a = BondedLayer(1.0, nu, 1.0), 1.5
    t, w, phi = layer.solution(a, np.ones_like)
    x, v = np.polynomial.legendre.leggauss(400)
    x, v = 15.0 * (x + 1.0), 15.0 * v
    P = np.cos(np.multiply.outer(x, t)) @ (w * phi)
    for r in (0.3, 0.9, 1.4):
        angle = 0.25 * np.pi * (np.polynomial.legendre.leggauss(60)[0] + 1.0)  # t = r sin(angle)
        weight = 0.25 * np.pi * np.polynomial.legendre.leggauss(60)[1]
        half_space = weight @ np.interp(r * np.sin(angle), t, phi)
        stiffening = v @ ((1.0 - layer.compliance(x)) * P * j0(x * r))
        assert 2.0 / layer.effective_modulus * (half_space - stiffening) == pytest.approx(1.0, abs=2e-4)


def test_small_contacts_feel_hayes_stiffness_and_large_ones_nearly():
    for a, row in HAYES.items():
        for nu, kappa in zip((0.3, 0.35, 0.4, 0.45, 0.5), row, strict=True):
            found = BondedLayer(1.0, nu, 1.0).punch_factor(a)
            # The paper's numbers fall behind as a / h grows, by 0.9 % at a = 2 h and nu = 0.5.
            assert found == pytest.approx(kappa, rel=6e-4 if a <= 0.4 else 3e-3 if a <= 1.0 else 1e-2)


def test_a_thick_layer_is_a_half_space():
    layer = BondedLayer(5400.0, 0.48, 100.0)
    E = layer.effective_modulus
    assert layer.punch(5e-3, 1e-4).force == pytest.approx(2.0 * E * 5e-3 * 1e-4, rel=1e-4)
    assert layer.paraboloid(5e-3, 1e-3).force == pytest.approx(hertz.sphere_force(E, 5e-3, 1e-3), rel=1e-4)
    assert layer.sphere(5e-3, 1e-3).force == pytest.approx(
        float(sneddon.sphere_force(E, 5e-3, np.array(1e-3))), rel=1e-4
    )


def test_a_thin_compressible_layer_is_a_bed_of_confined_columns():
    nu = 0.3
    mu = 0.5 / (1.0 + nu)
    confined = 2.0 * mu * (1.0 - nu) / (1.0 - 2.0 * nu)
    share = [BondedLayer(1.0, nu, 1.0).punch(a, 1.0).force / (np.pi * a**2 * confined) for a in (10.0, 20.0)]
    assert 2.0 * share[1] - share[0] == pytest.approx(1.0, abs=1e-3)  # the rim's share falls as h / a


def test_a_thin_incompressible_layer_is_squeezed_out_like_a_film():
    # lubrication with one wall that slips: F = 3 pi mu a^4 d / (8 h^3); the rim's shares are c1 h/a + c2 (h/a)^2
    share = [BondedLayer(1.0, 0.5, 1.0).punch(a, 1.0).force / (np.pi * a**4 / 8.0) for a in (5.0, 10.0, 20.0)]
    once = 2.0 * share[1] - share[0], 2.0 * share[2] - share[1]
    assert (4.0 * once[1] - once[0]) / 3.0 == pytest.approx(1.0, abs=1e-2)


def test_a_smooth_tool_is_as_stiff_as_a_punch_of_its_contact():
    layer, R, d, step = BondedLayer(5400.0, 0.48, 4e-3), 5e-3, 1e-3, 1e-6
    for pressed in (layer.sphere, layer.paraboloid):
        slope = (pressed(R, d + step).force - pressed(R, d - step).force) / (2.0 * step)
        assert slope == pytest.approx(layer.punch(pressed(R, d).radius, 1.0).force, rel=1e-6)


def test_a_rounded_punch_lies_between_the_sharp_ones_of_its_flat_and_of_its_contact():
    layer, radius, edge, d = BondedLayer(5400.0, 0.48, 4e-3), 5e-3, 0.5e-3, 2e-5
    found = layer.rounded_punch(radius, edge, d)
    flat, whole = layer.punch(radius - edge, d).force, layer.punch(found.radius, d).force
    assert radius - edge < found.radius < radius
    assert flat < found.force < whole
    slope = (
        layer.rounded_punch(radius, edge, 1.01 * d).force - layer.rounded_punch(radius, edge, 0.99 * d).force
    ) / (0.02 * d)
    assert slope == pytest.approx(layer.punch(found.radius, 1.0).force, rel=2e-3)


def test_a_punch_that_is_all_edge_is_a_sphere():
    layer = BondedLayer(5400.0, 0.48, 4e-3)
    found, sphere = layer.rounded_punch(5e-3, 5e-3, 1e-3), layer.sphere(5e-3, 1e-3)
    assert (found.radius, found.force) == pytest.approx((sphere.radius, sphere.force), rel=1e-9)
