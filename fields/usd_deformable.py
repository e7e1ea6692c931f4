# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Tokens that tell a simulator that an organ is deformable, authored raw: no USD release defines them.

Source: "Deformable Body Physics in USD", OpenUSD-proposals pull request 111, wp_deformable_physics.md at
commit 584939b6473945e92488559d14c3cb64d17a2682.  The proposal is open: names may change, and this table
is all that has to follow.  An unregistered API brings no pseudo-base along: both are applied by name.
Limit: the tokens carry initial stiffness only; a hyperelastic model stays in palpate:organ:material.
"""

from __future__ import annotations

from typing import Any

__all__ = [
    "BODY_APIS",
    "BODY_ATTRIBUTES",
    "MATERIAL_APIS",
    "SIMULATION_APIS",
    "material_attributes",
]

BODY_APIS = ("PhysicsBodyAPI", "PhysicsDeformableBodyAPI")
"""On the organ's root prim, whose direct child the TetMesh is."""
BODY_ATTRIBUTES = (("physics:bodyEnabled", "bool", True),)
SIMULATION_APIS = ("PhysicsVolumeDeformableSimAPI",)
"""On the TetMesh; rest shape and masses fall back to its points and the material's density."""
MATERIAL_APIS = ("PhysicsMaterialAPI", "PhysicsVolumeDeformableMaterialAPI")
"""On the material that is bound to the TetMesh for the purpose "physics"."""


def material_attributes(material: dict[str, Any]) -> tuple[tuple[str, str, float], ...]:
    """(name, USD type, value) of what the tokens can say of `material`; empty where it has no stiffness.

    Young's modulus is taken as it is, or is 2 (1 + nu) sum(mu), mu the initial shear moduli.

    Args:
        material: SI; any of youngs_modulus (Pa), mu (Pa, one or a list), poissons_ratio, density (kg/m3).
    """
    poissons_ratio = material.get("poissons_ratio")
    youngs_modulus = material.get("youngs_modulus")
    if youngs_modulus is None and poissons_ratio is not None and "mu" in material:
        mu = material["mu"]
        shear_modulus = sum(mu) if isinstance(mu, list) else mu
        youngs_modulus = 2.0 * (1.0 + poissons_ratio) * shear_modulus
    if youngs_modulus is None or poissons_ratio is None:
        return ()
    attributes = [
        ("physics:youngsModulus", "float", float(youngs_modulus)),
        ("physics:poissonsRatio", "float", float(poissons_ratio)),
    ]
    if "density" in material:
        attributes.append(("physics:density", "float", float(material["density"])))
    return tuple(attributes)
