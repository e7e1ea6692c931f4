# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A scene's material as the mechanics takes it, and as an asset tells it.

Scene and mechanics count constants alike (`scene_tables.Material`, `fem_offline.material`), so nothing is converted but
a shear modulus that stands for Young's modulus.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from palpate.author.scene_tables import Capsule, Material

if TYPE_CHECKING:  # kernels come with it
    from palpate.fem_offline.material import Material as Solid
    from palpate.fem_offline.membrane import Capsule as Skin

__all__ = ["material_values", "skin_of", "solid_of"]


def solid_of(material: Material) -> Solid:
    """The mechanics' material of a scene's material table, whose rules hold."""
    from palpate.fem_offline import material as solids

    m, nu = material, material.poissons_ratio
    if m.model == "ogden":
        return solids.Ogden(_given(m.mu), _given(m.alpha), nu)
    if m.model == "mooney_rivlin":
        return solids.MooneyRivlin(_given(m.c10), _given(m.c01), nu)
    if m.model == "yeoh":
        return solids.Yeoh(_given(m.c10), m.c20 or 0.0, m.c30 or 0.0, nu)
    if m.model == "veronda_westmann":
        return solids.VerondaWestmann(_given(m.c1), _given(m.c2), nu)
    youngs_modulus = 2.0 * (1.0 + nu) * m.shear_modulus
    return solids.Linear(youngs_modulus, nu) if m.model == "linear" else solids.NeoHookean(youngs_modulus, nu)


def skin_of(capsule: Capsule) -> Skin:
    """The mechanics' membrane of a scene's capsule table."""
    from palpate.fem_offline.membrane import Capsule as Skin

    return Skin(capsule.thickness, solid_of(capsule.material))


def material_values(material: Material) -> dict[str, Any]:
    """JSON-clean: the model, its constants (Pa, 1) as the scene gives them, and Young's modulus at rest."""
    given = material.model_dump(mode="json", exclude_none=True)
    return {**given, "youngs_modulus": 2.0 * (1.0 + material.poissons_ratio) * material.shear_modulus}


def _given(value: Any) -> Any:
    assert value is not None, "scene_rules lets no material through that lacks a constant"
    return value
