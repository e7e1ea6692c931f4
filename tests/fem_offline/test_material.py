# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.material import (
    Linear,
    MooneyRivlin,
    NeoHookean,
    Ogden,
    VerondaWestmann,
    Yeoh,
    density,
    lame_parameters,
)
from palpate.fem_offline.material_table import kappa_split
from palpate.fem_offline.verification import homogeneous

MU, KAPPA = 1800.0, 45000.0
NU = (3 * KAPPA - 2 * MU) / (2 * (3 * KAPPA + MU))
NEO_HOOKEAN = NeoHookean(2 * MU * (1 + NU), NU)
MATERIALS = [
    Linear(2 * MU * (1 + NU), NU),
    NEO_HOOKEAN,
    MooneyRivlin(0.35 * MU, 0.15 * MU, NU),
    Yeoh(0.5 * MU, 0.4 * MU, 0.3 * MU, NU),
    VerondaWestmann(MU / 3.0, 3.0, NU),
    Ogden((MU,), (6.0,), NU),
    Ogden((1.5 * MU, -0.5 * MU), (1.3, -5.0), NU),
]
OBJECTIVE = MATERIALS[1:]


def named(materials):
    return pytest.mark.parametrize("material", materials, ids=[type(m).__name__ for m in materials])


@pytest.fixture(scope="module")
def deformed():
    """Deformation gradients, det from about 0.5 to 2, and directions."""
    random = np.random.default_rng(0)
    F = np.eye(3) + 0.25 * random.standard_normal((50, 3, 3))
    keep = np.linalg.det(F) > 0.3
    return F[keep], random.standard_normal((50, 3, 3))[keep]


def central(f, h=1e-4):
    """Fourth order."""
    return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h)


@named(MATERIALS)
def test_stress_is_the_derivative_of_energy(material, deformed):
    F, H = deformed
    slope = central(lambda t: density(material, F + t * H)[0])
    P = density(material, F)[1]
    scale = np.linalg.norm(P, axis=(1, 2)) * np.linalg.norm(H, axis=(1, 2))
    assert np.abs((slope - np.einsum("nij,nij->n", P, H)) / scale).max() < 1e-6


@named(MATERIALS)
def test_tangent_is_the_derivative_of_stress(material, deformed):
    F, H = deformed
    change = central(lambda t: density(material, F + t * H)[1])
    exact = np.einsum("nikjl,njl->nik", density(material, F)[2], H)
    scale = np.linalg.norm(exact, axis=(1, 2))[:, None, None]
    assert np.abs((change - exact) / scale).max() < 1e-6


@named(MATERIALS)
def test_tangent_is_symmetric(material, deformed):
    A = density(material, deformed[0])[2]
    assert np.abs(A - A.transpose(0, 3, 4, 1, 2)).max() < 1e-13 * np.abs(A).max()


@named(OBJECTIVE)
def test_energy_does_not_see_rotation(material, deformed):
    F, _ = deformed
    Q, _ = np.linalg.qr(np.random.default_rng(1).standard_normal((len(F), 3, 3)))
    Q *= np.sign(np.linalg.det(Q))[:, None, None]
    psi, P, _ = density(material, F)
    turned, turned_P, _ = density(material, Q @ F)
    assert turned == pytest.approx(psi, rel=1e-12, abs=1e-12 * MU)
    assert np.abs(turned_P - Q @ P).max() < 1e-11 * np.abs(P).max()


@named(MATERIALS)
def test_rest_carries_neither_energy_nor_stress(material):
    psi, P, _ = density(material, np.eye(3)[None])
    assert psi[0] == 0.0
    assert np.abs(P).max() < 1e-15 * KAPPA


@named(OBJECTIVE)
def test_shape_and_volume_are_separate(material, deformed):
    F, _ = deformed
    shape = density(material, F, volumetric=False)[0]
    assert density(material, 1.3 * F, volumetric=False)[0] == pytest.approx(shape, rel=1e-10)
    unimodular = F / np.cbrt(np.linalg.det(F))[:, None, None]
    volume = density(material, unimodular)[0] - density(material, unimodular, volumetric=False)[0]
    assert np.abs(volume).max() < 1e-12 * MU


@named(MATERIALS)
def test_small_strains_are_hooke(material):
    """dP at rest = 2 mu dev(sym H) + kappa tr(H) 1."""
    assert material.shear_modulus == pytest.approx(MU, rel=1e-14)
    assert material.bulk_modulus == pytest.approx(KAPPA, rel=1e-12)
    assert lame_parameters(material.youngs_modulus, NU) == pytest.approx((MU, KAPPA), rel=1e-12)
    H = np.random.default_rng(2).standard_normal((5, 3, 3))
    sym, trace = 0.5 * (H + H.swapaxes(1, 2)), np.trace(H, axis1=1, axis2=2)[:, None, None]
    A = density(material, np.eye(3)[None])[2][0]
    hooke = 2 * MU * (sym - trace * np.eye(3) / 3) + KAPPA * trace * np.eye(3)
    assert np.einsum("ikjl,njl->nik", A, H) == pytest.approx(hooke, abs=1e-12 * KAPPA)


@pytest.mark.parametrize("stretch", [0.5, 0.9, 1.1, 2.0])
def test_uniaxial_stress_is_the_closed_form(stretch):
    side, axial, energy = homogeneous.uniaxial(MU, KAPPA, stretch)
    psi, P, _ = density(NEO_HOOKEAN, np.diag([stretch, side, side])[None])
    assert psi[0] == pytest.approx(energy, rel=1e-10)
    assert P[0] == pytest.approx(np.diag([axial, 0.0, 0.0]), abs=1e-8 * abs(axial))


def test_closed_forms_agree_with_hooke_for_small_strains():
    E, nu = 5400.0, 0.48
    mu, kappa = lame_parameters(E, nu)
    side, axial, energy = homogeneous.uniaxial(mu, kappa, 1.0 + 1e-5)
    assert axial == pytest.approx(E * 1e-5, rel=1e-4)
    assert side - 1.0 == pytest.approx(-nu * 1e-5, rel=1e-4)
    assert energy == pytest.approx(0.5 * E * 1e-10, rel=1e-4)


def test_kappa_is_shared_out_completely():
    for nu in (0.1, 0.3, 0.48, 0.4999):
        solid = NeoHookean(5400.0, nu)
        full, centre = kappa_split(solid)
        assert full + centre == pytest.approx(solid.bulk_modulus, rel=1e-14)
        assert 0.0 < full <= 2.0 * solid.shear_modulus * (1.0 + 1e-14) and centre >= 0.0  # more would lock


@pytest.mark.parametrize(
    ("modulus", "ratio"), [(0.0, 0.3), (-1.0, 0.3), (np.nan, 0.3), (1e3, 0.5), (1e3, -1.0)]
)
def test_impossible_constants_are_refused(modulus, ratio):
    for model in (Linear, NeoHookean):
        with pytest.raises(ValueError, match="must"):
            model(modulus, ratio)
    with pytest.raises(ValueError, match="must"):
        Ogden((modulus,), (2.0,), ratio)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: MooneyRivlin(-2.0, 1.0, 0.4), "initial shear modulus of -2"),
        (lambda: Yeoh(0.0, 1.0, 1.0, 0.4), "initial shear modulus of 0"),
        (lambda: Yeoh(1.0, np.inf, 1.0, 0.4), "c20 is inf"),
        (lambda: VerondaWestmann(1.0, -1.0, 0.4), "initial shear modulus of -1"),
        (lambda: Ogden((1.0, 2.0), (2.0,), 0.4), "mu has 2 terms and alpha 1"),
        (lambda: Ogden((), (), 0.4), "at least one"),
        (lambda: Ogden((1.0,), (0.0,), 0.4), "none of them must be zero"),
        (lambda: Ogden((1.0, -3.0), (2.0, 4.0), 0.4), "initial shear modulus of -2"),
    ],
)
def test_a_refusal_says_which_constant(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()
