# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import warp as wp

from palpate.fem_offline import material as m
from palpate.fem_offline.material import NeoHookean, lame_parameters
from palpate.fem_offline.verification import homogeneous


@wp.kernel
def _evaluate(
    F: wp.array(dtype=wp.mat33d),
    H: wp.array(dtype=wp.mat33d),
    mu: wp.float64,
    kappa: wp.float64,
    psi: wp.array2d(dtype=wp.float64),
    P: wp.array2d(dtype=wp.mat33d),
    dP: wp.array2d(dtype=wp.mat33d),
):
    i = wp.tid()
    psi[i, 0] = m.isochoric_energy(F[i], mu)
    psi[i, 1] = m.volumetric_energy(F[i], kappa)
    P[i, 0] = m.isochoric_stress(F[i], mu)
    P[i, 1] = m.volumetric_stress(F[i], kappa)
    dP[i, 0] = m.isochoric_tangent(F[i], H[i], mu)
    dP[i, 1] = m.volumetric_tangent(F[i], H[i], kappa)


MU, KAPPA = 1800.0, 45000.0


def evaluate(F, H=None):
    """psi (n, 2), P (n, 2, 3, 3), dP[H] (n, 2, 3, 3): isochoric, then volumetric."""
    n = len(F)
    H = np.zeros_like(F) if H is None else H
    out = [wp.zeros((n, 2), dtype=t, device="cpu") for t in (wp.float64, wp.mat33d, wp.mat33d)]
    inputs = [
        wp.array(F, dtype=wp.mat33d, device="cpu"),
        wp.array(H, dtype=wp.mat33d, device="cpu"),
        MU,
        KAPPA,
    ]
    wp.launch(_evaluate, dim=n, inputs=inputs, outputs=out, device="cpu")
    return [array.numpy() for array in out]


@pytest.fixture(scope="module")
def deformed():
    """50 deformation gradients, det from about 0.5 to 2, and directions."""
    random = np.random.default_rng(0)
    F = np.eye(3) + 0.25 * random.standard_normal((50, 3, 3))
    return F[np.linalg.det(F) > 0.3], random.standard_normal((50, 3, 3))[np.linalg.det(F) > 0.3]


def central(f, h=1e-4):
    """Fourth order."""
    return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h)


def test_stress_is_the_derivative_of_energy(deformed):
    F, H = deformed
    slope = central(lambda t: evaluate(F + t * H)[0])
    exact = np.einsum("npij,nij->np", evaluate(F)[1], H)
    scale = np.linalg.norm(evaluate(F)[1], axis=(2, 3)) * np.linalg.norm(H, axis=(1, 2))[:, None]
    assert np.abs((slope - exact) / scale).max() < 1e-6


def test_tangent_is_the_derivative_of_stress(deformed):
    F, H = deformed
    change = central(lambda t: evaluate(F + t * H)[1])
    exact = evaluate(F, H)[2]
    scale = np.linalg.norm(exact, axis=(2, 3))[:, :, None, None]
    assert np.abs((change - exact) / scale).max() < 1e-6


def test_energy_does_not_see_rotation(deformed):
    F, _ = deformed
    Q, _ = np.linalg.qr(np.random.default_rng(1).standard_normal((len(F), 3, 3)))
    Q *= np.sign(np.linalg.det(Q))[:, None, None]
    psi, P, _ = evaluate(F)
    turned, turned_P, _ = evaluate(Q @ F)
    assert turned == pytest.approx(psi, rel=1e-12, abs=1e-12 * MU)
    assert np.abs(turned_P - np.einsum("nij,npjk->npik", Q, P)).max() < 1e-11 * np.abs(P).max()


def test_rest_carries_neither_energy_nor_stress():
    psi, P, _ = evaluate(np.eye(3)[None])
    assert np.abs(psi).max() < 1e-15 * KAPPA
    assert np.abs(P).max() < 1e-15 * KAPPA


def test_shape_and_volume_are_separate(deformed):
    F, _ = deformed
    swollen, unimodular = 1.3 * F, F / np.cbrt(np.linalg.det(F))[:, None, None]
    assert evaluate(swollen)[0][:, 0] == pytest.approx(evaluate(F)[0][:, 0], rel=1e-10)
    assert np.abs(evaluate(unimodular)[0][:, 1]).max() < 1e-20 * KAPPA + 1e-25


def test_small_strains_are_hooke():
    """dP at rest = 2 mu dev(sym H) + kappa tr(H) 1."""
    H = np.random.default_rng(2).standard_normal((5, 3, 3))
    sym, trace = 0.5 * (H + H.swapaxes(1, 2)), np.trace(H, axis1=1, axis2=2)[:, None, None]
    dP = evaluate(np.tile(np.eye(3), (5, 1, 1)), H)[2]
    assert dP[:, 0] == pytest.approx(2 * MU * (sym - trace * np.eye(3) / 3), abs=1e-12 * KAPPA)
    assert dP[:, 1] == pytest.approx(KAPPA * trace * np.eye(3) * np.ones_like(sym), abs=1e-12 * KAPPA)


@pytest.mark.parametrize("stretch", [0.5, 0.9, 1.1, 2.0])
def test_uniaxial_stress_is_the_closed_form(stretch):
    side, axial, density = homogeneous.uniaxial(MU, KAPPA, stretch)
    psi, P, _ = evaluate(np.diag([stretch, side, side])[None])
    assert psi.sum() == pytest.approx(density, rel=1e-10)
    assert P.sum(axis=1)[0] == pytest.approx(np.diag([axial, 0.0, 0.0]), abs=1e-8 * abs(axial))


def test_closed_forms_agree_with_hooke_for_small_strains():
    E, nu = 5400.0, 0.48
    mu, kappa = lame_parameters(E, nu)
    side, axial, density = homogeneous.uniaxial(mu, kappa, 1.0 + 1e-5)
    assert axial == pytest.approx(E * 1e-5, rel=1e-4)
    assert side - 1.0 == pytest.approx(-nu * 1e-5, rel=1e-4)
    assert density == pytest.approx(0.5 * E * 1e-10, rel=1e-4)


def test_kappa_is_shared_out_completely():
    for nu in (0.1, 0.3, 0.48, 0.4999):
        solid = NeoHookean(5400.0, nu)
        mu, full, centre = solid.parameters
        assert mu == solid.shear_modulus and full + centre == pytest.approx(solid.bulk_modulus, rel=1e-14)
        assert 0.0 < full <= 2.0 * mu * (1.0 + 1e-14) and centre >= 0.0  # more of it would lock


@pytest.mark.parametrize(
    ("modulus", "ratio"), [(0.0, 0.3), (-1.0, 0.3), (np.nan, 0.3), (1e3, 0.5), (1e3, -1.0)]
)
def test_impossible_constants_are_refused(modulus, ratio):
    with pytest.raises(ValueError, match="must"):
        NeoHookean(modulus, ratio)
