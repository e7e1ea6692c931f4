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
from palpate.fem_offline.verification.homogeneous import stretch_and_shear, uniaxial
from palpate.fem_offline.verification.materials import (
    MODELS,
    MU,
    NU,
    STEPS,
    deformation_gradients,
    derivative_errors,
    material_rows,
)

ROWS = list(material_rows())
OBJECTIVE = {name: material for name, material in MODELS.items() if not isinstance(material, Linear)}

every_model = pytest.mark.parametrize("material", MODELS.values(), ids=MODELS)
every_objective_model = pytest.mark.parametrize("material", OBJECTIVE.values(), ids=OBJECTIVE)


@pytest.mark.parametrize("row", ROWS, ids=[row.name for row in ROWS])
def test_verification_row(row):
    assert row.met, f"error {row.error:.1e}, bar {row.bar:.0e}, {row.note}"


@every_objective_model
def test_derivative_errors_fall_with_the_square_of_the_step_then_rise_with_rounding(material):
    """Over nine decades of step: an error that is not this V comes from something else than differences."""
    for errors in derivative_errors(material):
        fall = np.diff(np.log10(errors))[STEPS[:-1] >= 1e-4] / 0.5
        assert fall == pytest.approx(2.0, abs=0.2)
        assert 1e3 * errors.min() < errors[0] < 1e-4  # rounding at the smallest step
        assert 1e-7 < STEPS[errors.argmin()] < 1e-4


def test_a_linear_material_has_no_truncation_error():
    errors = derivative_errors(MODELS["linear"])
    assert (errors < 1e-14 / STEPS).all()


@every_model
def test_tangent_is_symmetric(material):
    A = density(material, deformation_gradients())[2]
    assert np.abs(A - A.transpose(0, 3, 4, 1, 2)).max() < 1e-13 * np.abs(A).max()


@every_objective_model
def test_shape_and_volume_are_separate(material):
    F = deformation_gradients()
    shape = density(material, F, volumetric=False)[0]
    assert density(material, 1.3 * F, volumetric=False)[0] == pytest.approx(shape, rel=1e-10)
    unimodular = F / np.cbrt(np.linalg.det(F))[:, None, None]
    volume = density(material, unimodular)[0] - density(material, unimodular, volumetric=False)[0]
    assert np.abs(volume).max() < 1e-12 * MU


@every_model
def test_small_strains_keep_their_digits(material):
    """psi = eps:A:eps/2 and P = A:eps to the strain's order, down to strains of 1e-7: no cancellation at rest."""
    eps = np.random.default_rng(7).standard_normal((3, 3))
    eps = 0.5 * (eps + eps.T) / np.linalg.norm(eps)
    A = density(material, np.eye(3)[None])[2][0]
    stress = np.einsum("ikjl,jl->ik", A, eps)
    for size in (1e-3, 1e-5, 1e-7):
        psi, P, _ = density(material, (np.eye(3) + size * eps)[None])
        assert psi[0] == pytest.approx(0.5 * size**2 * np.sum(eps * stress), rel=20.0 * size + 1e-8)
        assert P[0] == pytest.approx(size * stress, abs=(20.0 * size + 1e-7) * size * np.abs(stress).max())


@every_model
def test_moduli_of_small_strains_belong_together(material):
    assert material.shear_modulus == pytest.approx(MU, rel=1e-14)
    assert lame_parameters(material.youngs_modulus, NU) == pytest.approx(
        (MU, material.bulk_modulus), rel=1e-12
    )


@pytest.mark.parametrize(
    ("ogden", "same"),
    [
        (Ogden((MU,), (2.0,), NU), NeoHookean(2.0 * MU * (1.0 + NU), NU)),
        (Ogden((1400.0, 400.0), (2.0, -2.0), NU), MooneyRivlin(700.0, 200.0, NU)),
        (Ogden((-300.0, 2100.0), (-2.0, 2.0), NU), MooneyRivlin(1050.0, -150.0, NU)),
        (Ogden((1000.0, 800.0), (5.0, 5.0), NU), Ogden((1800.0,), (5.0,), NU)),
    ],
    ids=["neo-Hookean", "Mooney-Rivlin", "negative c01", "terms add"],
)
def test_ogden_of_powers_two_and_minus_two_is_the_model_of_invariants(ogden, same):
    """Two codes that share nothing but the volumetric part."""
    F = np.concatenate([deformation_gradients(), _nearly_equal_stretches()])
    for ours, theirs in zip(density(ogden, F), density(same, F), strict=True):
        assert ours == pytest.approx(theirs, rel=1e-11, abs=1e-11 * MU)


def test_ogden_does_not_notice_equal_stretches():
    """Stress and tangent change with the gap between stretches as smoothly as they should: in proportion to it."""
    material = Ogden((1000.0, 800.0), (9.0, -5.0), NU)
    F = _nearly_equal_stretches()
    _, P, A = density(material, F)
    for value in (P.reshape(len(GAPS), -1), A.reshape(len(GAPS), -1)):
        change = np.abs(value - value[0]).max(axis=1)
        assert (change <= 1e3 * MU * GAPS + 1e-10 * MU).all()


GAPS = np.array([0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3])


def _nearly_equal_stretches():
    """(3 x GAPS, 3, 3): rest, two equal, three equal and not one, turned; stretches apart by GAPS."""
    Q, _ = np.linalg.qr(np.random.default_rng(8).standard_normal((2, 3, 3)))
    stretches = np.array([[1.0, 1.0, 1.0], [1.4, 1.4, 0.6], [0.97, 0.97, 0.97]])
    apart = stretches[None] * (1.0 + GAPS[:, None, None] * np.array([1.0, 0.0, -1.0]))
    return Q[0] @ (apart.reshape(-1, 3)[:, :, None] * np.eye(3)) @ Q[1].T


def test_ogden_in_simple_shear_is_ogdens_own_formula():
    """Shear stress 2 mu/alpha (l^alpha - l^-alpha) / (l + 1/l), l - 1/l = g (Ogden 1972), in numbers."""
    g, mu, alpha = 0.8, 1500.0, 7.0
    l = g / 2.0 + np.sqrt(1.0 + g**2 / 4.0)
    expected = 2.0 * mu / alpha * (l**alpha - l**-alpha) / (l + 1.0 / l)
    assert stretch_and_shear(Ogden((mu,), (alpha,), NU), (1.0, 1.0, 1.0), g).P[0, 1] == pytest.approx(
        expected
    )


def test_closed_forms_agree_with_hooke_for_small_strains():
    for material in MODELS.values():
        state = uniaxial(material, 1.0 + 1e-5)
        assert state.P[0, 0] == pytest.approx(material.youngs_modulus * 1e-5, rel=1e-3)
        assert state.F[1, 1] - 1.0 == pytest.approx(-NU * 1e-5, rel=1e-3)
        assert state.psi == pytest.approx(0.5 * material.youngs_modulus * 1e-10, rel=1e-3)


def test_kappa_is_shared_out_completely():
    for nu in (0.1, 0.3, 0.48, 0.4999):
        solid = NeoHookean(5400.0, nu)
        full, centre = kappa_split(solid)
        assert full + centre == pytest.approx(solid.bulk_modulus, rel=1e-14)
        assert 0.0 < full <= 2.0 * solid.shear_modulus * (1.0 + 1e-14) and centre >= 0.0  # more would lock
        assert kappa_split(solid, np.inf) == (solid.bulk_modulus, 0.0)


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
