# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import time

import numpy as np
import pytest
from scipy.optimize import brentq

from palpate.fem_offline.material import (
    Linear,
    MooneyRivlin,
    NeoHookean,
    Ogden,
    VerondaWestmann,
    Yeoh,
    density,
    stability,
)
from palpate.fem_offline.material_check import acoustic_eigenvalue
from palpate.fem_offline.verification.materials import MODELS

UNSTABLE = {
    "negative c01": (MooneyRivlin(1000.0, -400.0, 0.48), "c01 below zero"),
    "negative c20": (Yeoh(900.0, -100.0, 0.0, 0.48), "c20 below zero"),
    "negative c30": (Yeoh(900.0, 100.0, -300.0, 0.48), "c30 below zero"),
    "negative mu": (Ogden((2300.0, -500.0), (3.0, -4.0), 0.48), "mu[1] is negative"),
    "small c2": (VerondaWestmann(18000.0, 0.1, 0.48), "raise c2"),
}


@pytest.mark.parametrize("material", MODELS.values(), ids=MODELS)
def test_materials_with_positive_constants_are_stable(material):
    assert stability(material).stable and stability(material).sentence == ""


@pytest.mark.parametrize("alpha", [-20.0, -1.0, 1.0, 2.0, 20.0])
@pytest.mark.parametrize("ratio", [0.48, 0.4999])
def test_one_positive_ogden_term_is_stable(alpha, ratio):
    assert stability(Ogden((1800.0,), (alpha,), ratio)).stable


@pytest.mark.parametrize(("material", "advice"), UNSTABLE.values(), ids=UNSTABLE)
def test_a_failure_says_where_and_what_to_change(material, advice):
    found = stability(material)
    assert not found.stable and found.condition in found.sentence
    assert type(material).__name__ in found.sentence and f"{found.stretches[0]:.3g}" in found.sentence
    assert advice in found.sentence


def test_ellipticity_is_lost_where_shear_stress_peaks():
    """Hencky's energy mu sum (ln l)^2 (Ogden's limit of alpha = 0): g = l - 1/l peaks where coth(ln l) = ln l."""
    log = brentq(lambda x: 1.0 / np.tanh(x) - x, 1.0, 2.0)
    found = stability(Ogden((1800.0,), (1e-3,), 0.4999), 4.0, 0.25)
    assert found.condition == "strong ellipticity"
    assert found.stretches == pytest.approx((np.exp(log), 1.0, np.exp(-log)), rel=2e-3)


def test_stiffness_is_lost_where_true_stress_in_compression_peaks():
    """Mooney-Rivlin, incompressible, uniaxial: tau = 2 (l^2 - 1/l) (c10 + c01/l)."""
    c10, c01 = 1000.0, -400.0

    def rate(l):
        return (2.0 * l + l**-2.0) * (c10 + c01 / l) - (l**2 - 1.0 / l) * c01 * l**-2.0

    peak = brentq(rate, 0.3, 0.99)
    reaches = [stability(MooneyRivlin(c10, c01, 0.4999), (m * peak) ** -0.5, m * peak) for m in (1.02, 0.98)]
    assert reaches[0].stable and reaches[1].condition == "stiffness"


def test_a_compressible_solid_may_fail_where_the_incompressible_one_does_not():
    """psi_iso of J^(-1/3)-scaled stretches to the power -1 needs kappa to stay elliptic."""
    found = stability(Ogden((1800.0,), (-1.0,), 0.3))
    assert found.condition == "strong ellipticity" and "raise poissons_ratio" in found.sentence


@pytest.mark.parametrize(("material", "advice"), UNSTABLE.values(), ids=UNSTABLE)
def test_narrower_ranges_than_the_failure_are_stable(material, advice):
    found = stability(material)
    inside = np.exp(0.9 * np.log(np.array(found.stretches)[[2, 0]]))
    assert stability(material, stretch_max=inside[1], stretch_min=inside[0]).stable


def test_the_acoustic_tensor_is_that_of_the_kernels():
    """Smallest m (x) N : A : m (x) N over many directions, from the tangent that presses use."""
    random = np.random.default_rng(3)
    N = random.standard_normal((4000, 3))
    N /= np.linalg.norm(N, axis=1)[:, None]
    x = np.array(
        [[0.0, 0.0, 0.0], [0.4, 0.4, -0.8], [0.6, 0.0, -0.61], [0.5, -0.25, -0.25], [0.2, 0.1, -0.32]]
    )
    for material in [*MODELS.values(), *(material for material, _ in UNSTABLE.values())]:
        if isinstance(material, Linear):
            continue
        A = density(material, np.exp(x)[:, :, None] * np.eye(3))[2]
        Q = np.einsum("sikjl,dk,dl->sdij", A, N, N)
        smallest = np.linalg.eigvalsh(Q)[:, :, 0].min(axis=1)
        found, _ = acoustic_eigenvalue(material, x)
        # Both are minima over finitely many directions.
        assert found == pytest.approx(smallest, abs=0.02 * material.shear_modulus, rel=0.02), material


def test_a_check_takes_less_than_half_a_second():
    start = time.process_time()
    stability(NeoHookean(5400.0, 0.48))
    assert time.process_time() - start < 0.5


def test_a_range_without_rest_is_refused():
    with pytest.raises(ValueError, match="must hold 1 inside"):
        stability(NeoHookean(5400.0, 0.48), stretch_max=0.9)
