# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about every material: derivatives over nine decades of step, objectivity, rest, moduli, homogeneous states.

Derivatives are taken at single deformation gradients, through the kernels' own functions (material_density.py).
Homogeneous states go through the finite elements: what their nodal forces say against closed forms (homogeneous.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from palpate.fem_offline.assembly import ElementSystem
from palpate.fem_offline.material import (
    Linear,
    Material,
    MooneyRivlin,
    NeoHookean,
    Ogden,
    VerondaWestmann,
    Yeoh,
    density,
)
from palpate.fem_offline.verification.elements import irregular_mesh, mean_stress, system_of
from palpate.fem_offline.verification.homogeneous import (
    HomogeneousState,
    equibiaxial,
    stretch_and_shear,
    uniaxial,
)
from palpate.fem_offline.verification.row import Row

__all__ = ["MODELS", "STEPS", "deformation_gradients", "derivative_errors", "material_rows"]

MU, NU = 1800.0, 0.48

MODELS: dict[str, Material] = {
    "linear": Linear(2.0 * MU * (1.0 + NU), NU),
    "neo-Hookean": NeoHookean(2.0 * MU * (1.0 + NU), NU),
    "Mooney-Rivlin": MooneyRivlin(0.35 * MU, 0.15 * MU, NU),
    "Yeoh": Yeoh(0.5 * MU, 0.4 * MU, 0.3 * MU, NU),
    "Veronda-Westmann": VerondaWestmann(MU / 3.0, 3.0, NU),
    "Ogden, one term": Ogden((MU,), (9.0,), NU),
    "Ogden, three terms": Ogden((0.5 * MU, 0.3 * MU, 0.2 * MU), (1.3, -5.0, 7.0), NU),
}
"""All of the same moduli of small strains."""

STEPS = 10.0 ** np.arange(-10.0, -0.9, 0.5)
"""Steps of central differences, nine decades."""

COMBINED = [((1.0, 1.0, 1.0), 1e-7), ((1.0, 1.0, 1.0), 1e-3)] + [
    ((a, b, 1.01 / (a * b)), g)
    for a, b in ((0.6, 0.9), (1.0, 1.0), (1.4, 1.4))
    for g in (0.0, 1e-6, 0.3, 1.2)
]
"""Stretches and shear, pairs of nearly and exactly equal principal stretches among them."""


def material_rows() -> Iterator[Row]:
    """Every row of this file; a few seconds."""
    mesh = irregular_mesh()
    for name, material in MODELS.items():
        system = system_of(mesh, material)
        yield _derivatives(name, material)
        if not isinstance(material, Linear):
            yield _objectivity(name, material)
        yield _small_strains(name, material)
        yield _worst(f"uniaxial stress, {name}", system, material, uniaxial, (0.5, 0.7, 0.9, 1.1, 1.3, 1.6))
        yield _worst(f"equibiaxial stress, {name}", system, material, equibiaxial, (0.75, 0.9, 1.1, 1.3))
        shears = [((1.0, 1.0, 1.0), g) for g in (0.05, 0.4, 1.0)]
        yield _worst(f"simple shear, {name}", system, material, lambda m, s: stretch_and_shear(m, *s), shears)
        yield _worst(
            f"stretch and shear, {name}", system, material, lambda m, s: stretch_and_shear(m, *s), COMBINED
        )


def deformation_gradients(count: int = 12, seed: int = 4) -> np.ndarray:
    """(count, 3, 3) random ones, stretches from about 0.5 to 1.8, J from about 0.8 to 1.25."""
    F = np.eye(3) + 0.25 * np.random.default_rng(seed).standard_normal((4 * count, 3, 3))
    J = np.linalg.det(F)
    F, J = F[J > 0.2][:count], J[J > 0.2][:count]
    return F * (J ** (-2.0 / 9.0))[:, None, None]


def derivative_errors(material: Material) -> np.ndarray:
    """(2, S) errors of central differences against P and A, relative to their norms, worst over states; per step."""
    F = deformation_gradients()
    H = np.random.default_rng(5).standard_normal(F.shape)
    H /= np.linalg.norm(H, axis=(1, 2))[:, None, None]
    _, P, A = density(material, F)
    slope = np.einsum("nij,nij->n", P, H)
    change = np.einsum("nikjl,njl->nik", A, H)
    steps = np.repeat(STEPS, len(F))[:, None, None]
    many, along = np.tile(F, (len(STEPS), 1, 1)), np.tile(H, (len(STEPS), 1, 1))
    ahead, behind = density(material, many + steps * along), density(material, many - steps * along)
    slopes = ((ahead[0] - behind[0]) / (2.0 * steps[:, 0, 0])).reshape(len(STEPS), -1)
    changes = ((ahead[1] - behind[1]) / (2.0 * steps)).reshape(len(STEPS), -1, 3, 3)
    first = np.abs(slopes - slope) / np.linalg.norm(P, axis=(1, 2))
    second = np.linalg.norm(changes - change, axis=(2, 3)) / np.linalg.norm(change, axis=(1, 2))
    return np.stack([first.max(axis=1), second.max(axis=1)])


def _derivatives(name: str, material: Material) -> Row:
    errors = derivative_errors(material)
    best = errors.min(axis=1)
    at = STEPS[errors.argmin(axis=1)]
    reference = "central differences, steps 1e-10 to 1e-1"
    note = f"psi -> P {best[0]:.0e} at step {at[0]:.0e}, P -> dP/dF {best[1]:.0e} at {at[1]:.0e}"
    return Row(f"derivatives, {name}", reference, float(at[1]), float(best.max()), 1e-9, note)


def _objectivity(name: str, material: Material) -> Row:
    F = deformation_gradients()
    Q, _ = np.linalg.qr(np.random.default_rng(6).standard_normal(F.shape))
    Q *= np.sign(np.linalg.det(Q))[:, None, None]
    psi, P, A = density(material, F)
    turned_psi, turned_P, turned_A = density(material, Q @ F)
    expected = np.einsum("nij,njkpl,nqp->nikql", Q, A, Q)
    error = max(
        float(np.abs(turned_psi / psi - 1.0).max()),
        float((np.abs(turned_P - Q @ P).max(axis=(1, 2)) / np.abs(P).max(axis=(1, 2))).max()),
        float(np.abs(turned_A - expected).max() / np.abs(A).max()),
    )
    reference = "psi(Q F) = psi(F), P(Q F) = Q P(F), and for dP/dF"
    return Row(f"objectivity, {name}", reference, float(turned_psi[0]), error, 1e-10)


def _small_strains(name: str, material: Material) -> Row:
    """No stress at rest, and Hooke's tangent there."""
    psi, P, A = density(material, np.eye(3)[None])
    one = np.eye(3)
    parts = [np.einsum(f"{i},{j}->ikjl", one, one) for i, j in (("ij", "kl"), ("il", "kj"), ("ik", "jl"))]
    hooke = MU * (parts[0] + parts[1]) + (material.bulk_modulus - 2.0 / 3.0 * MU) * parts[2]
    error = max(abs(float(psi[0])) / MU, float(np.abs(P).max()) / MU, float(np.abs(A[0] - hooke).max()) / MU)
    return Row(f"rest and moduli, {name}", "zero; Hooke's law", float(A[0, 0, 1, 0, 1]), error, 1e-10)


def _worst(
    name: str,
    system: ElementSystem,
    material: Material,
    state: Callable[[Material, object], HomogeneousState],
    arguments: object,
) -> Row:
    """Stress and energy of the elements against a closed form, the worst of several states."""
    error, value = 0.0, 0.0
    for argument in arguments:
        expected = state(material, argument)
        P, psi = mean_stress(system, system.space.nodes @ (expected.F - np.eye(3)).T)
        scale = max(float(np.abs(expected.P).max()), 1e-6 * MU)
        off = max(
            float(np.abs(P - expected.P).max()) / scale,
            abs(psi - expected.psi) / max(expected.psi, 1e-9 * MU),
        )
        if off >= error:
            error, value = off, float(np.abs(P).max())
    return Row(name, "closed form (homogeneous.py)", value, error, 1e-8)
