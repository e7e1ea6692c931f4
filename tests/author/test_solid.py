# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a scene says of a material is what is pressed: the same constants, the same stiffness at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from palpate.author.scene_tables import Material
from palpate.author.solid import material_values, solid_of
from palpate.fem_offline.material import density

MATERIALS: dict[str, dict[str, Any]] = {
    "linear": {"youngs_modulus": "5.4 kPa"},
    "neo_hookean": {"mu": "1.8 kPa"},
    "mooney_rivlin": {"c10": "0.6 kPa", "c01": "0.3 kPa"},
    "ogden": {"mu": ["1.2 kPa", "0.6 kPa"], "alpha": [6.0, -4.0]},
    "yeoh": {"c10": "0.9 kPa", "c30": "2 kPa"},
    "veronda_westmann": {"c1": "0.3 kPa", "c2": 6.0},
}


def table(model: str, nu: float = 0.45) -> Material:
    return Material.model_validate({"model": model, "poissons_ratio": nu, **MATERIALS[model]})


@pytest.mark.parametrize("model", MATERIALS)
def test_both_sides_agree_on_the_shear_modulus(model: str) -> None:
    material = table(model)
    assert solid_of(material).shear_modulus == pytest.approx(material.shear_modulus, rel=1e-12)
    assert solid_of(material).poissons_ratio == material.poissons_ratio


@pytest.mark.parametrize("model", MATERIALS)
def test_a_small_shear_meets_that_modulus(model: str) -> None:
    """P_12 = mu g under simple shear g, from the mechanics' own energy."""
    material, g = table(model), 1e-5
    F = np.eye(3)[None].copy()
    F[0, 0, 1] = g
    _, P, _ = density(solid_of(material), F)
    assert P[0, 0, 1] == pytest.approx(material.shear_modulus * g, rel=1e-6)


def test_an_ogden_term_counts_as_the_scene_says() -> None:
    """psi = sum 2 mu_p / alpha_p^2 (l1^a + l2^a + l3^a - 3) at a stretch that keeps volume."""
    material, stretch = table("ogden"), 1.4
    F = np.diag([stretch, stretch**-0.5, stretch**-0.5])[None]
    psi, _, _ = density(solid_of(material), F)
    told = sum(
        2.0 * mu / a**2 * (stretch**a + 2.0 * stretch ** (-0.5 * a) - 3.0)
        for mu, a in zip(material.mu or (), material.alpha or (), strict=True)
    )
    assert psi[0] == pytest.approx(told, rel=1e-10)


@pytest.mark.parametrize("model", MATERIALS)
def test_an_asset_tells_all_constants_and_the_stiffness_at_rest(model: str) -> None:
    values = material_values(table(model))
    assert values["model"] == model
    assert values["youngs_modulus"] == pytest.approx(2.9 * table(model).shear_modulus)
    assert set(MATERIALS[model]) <= set(values)
    again = {k: v for k, v in values.items() if k != "youngs_modulus" or model in ("linear", "neo_hookean")}
    if model == "neo_hookean":
        again.pop("youngs_modulus")
    assert Material.model_validate(again) == table(model)
