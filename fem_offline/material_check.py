# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a material is stable in the range of stretches that a press uses.

Homogeneous states of all kinds between uniaxial and equibiaxial tension, at J = 1 and a little off it, are scanned
outwards from rest.  A material fails at the first state where one of these does not hold:

    stiffness           the isochoric energy is convex in the logarithmic stretches, h = d^2 psi / dx^2 > 0 on
                        sum dx = 0: stretching further takes more (Hill, Proc. R. Soc. Lond. A 314:457-472, 1970; the
                        check that Abaqus calls Drucker's)
    Baker-Ericksen      the larger principal stress goes with the larger stretch
    strong ellipticity  m (x) N : A : m (x) N > 0 for all m, N: no wave of shear or crush has imaginary speed

With principal stretches l, stresses tau_a = l_a dW/dl_a, the acoustic tensor Q(N) in principal axes is (Ogden,
Non-linear Elastic Deformations, 1984, section 6.1)

    Q_ii = (h_ii - tau_i)/l_i^2 N_i^2 + sum_{k != i} a_ik N_k^2,   a_ik = (tau_i - tau_k)/(l_i^2 - l_k^2)
    Q_ij = (h_ij/(l_i l_j) + b_ij) N_i N_j,                        b_ij = a_ij l_j/l_i - tau_j/(l_i l_j)

where h and tau hold the volumetric part with the material's own kappa.  a_ik > 0 is Baker-Ericksen's inequality.
The scan is a grid: a failure between its points, or in a state that is not homogeneous, is not seen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.material_table import LINEAR, OGDEN, POLYNOMIAL, VERONDA_WESTMANN, Tabulated
from palpate.fem_offline.principal_energy import principal_energy

__all__ = ["Stability", "acoustic_eigenvalue", "stability"]

CONDITIONS = ("stiffness", "Baker-Ericksen", "strong ellipticity")

SENTENCES = {
    "stiffness": "softens until stretching further takes no force",
    "Baker-Ericksen": "has its larger principal stress along the smaller stretch",
    "strong ellipticity": "loses ellipticity: it shears in bands that no mesh resolves",
}

ROUNDING = 1e-11
"""An eigenvalue above minus this fraction of the tensor's largest entry counts as not negative."""


@dataclass(frozen=True)
class Stability:
    """What was found.

    Attributes:
        stable: whether every state that was tried passed.
        condition: "" or the one that failed first: stiffness, Baker-Ericksen, strong ellipticity.
        stretches: (3,) principal stretches of the first failing state, largest first; nan where stable.
        sentence: for a person: what happens where, and which constant to change; "" where stable.
    """

    stable: bool
    condition: str
    stretches: tuple[float, float, float]
    sentence: str

    @property
    def stretch(self) -> float:
        """The failing state's stretch farthest from one (in logarithm); nan where stable."""
        return max(self.stretches, key=lambda value: abs(np.log(value)))


def stability(
    material: Tabulated, stretch_max: float = 2.0, stretch_min: float = 0.3, step: float = 0.02
) -> Stability:
    """Scan homogeneous states up to principal stretches of stretch_min and stretch_max.

    Args:
        step: of logarithmic stretch between scanned states; the failing state is found to a hundredth of it.

    Raises:
        ValueError: a range that does not hold 1 inside.
    """
    if not 0.0 < stretch_min < 1.0 < stretch_max:
        raise ValueError(f"stretches from {stretch_min} to {stretch_max}; the range must hold 1 inside")
    nothing = Stability(True, "", (np.nan,) * 3, "")
    if material.model == LINEAR:
        return nothing
    rays = _rays(13)
    reach = np.minimum(np.log(stretch_max) / rays.max(axis=1), np.log(stretch_min) / rays.min(axis=1))
    found = _first_failure(material, rays * reach[:, None], int(np.ceil(reach.max() / step)))
    if found is None:
        return nothing
    x, condition = found
    stretches = tuple(float(value) for value in np.sort(np.exp(x))[::-1])
    shown = ", ".join(f"{value:.3g}" for value in stretches)
    sentence = f"{material} {SENTENCES[condition]}, at principal stretches {shown} ({condition}); {_advice(material)}"
    return Stability(False, condition, stretches, sentence)


def acoustic_eigenvalue(material: Tabulated, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest eigenvalue of Q(N) over directions N, and what counts as zero.

    Args:
        x: (n, 3) logarithms of the principal stretches.

    Returns:
        (n,) Pa, (n,) Pa.
    """
    l = np.exp(x)
    _, tau, h = principal_energy(material, x)
    J, kappa = np.exp(x.sum(axis=1)), material.bulk_modulus
    tau = tau + (kappa * (J - 1.0) * J)[:, None]
    h = h + (kappa * J * (2.0 * J - 1.0))[:, None, None]
    a = _slopes(x, tau, h)
    b = a * l[:, None, :] / l[:, :, None] - tau[:, None, :] / (l[:, :, None] * l[:, None, :])
    off = h / (l[:, :, None] * l[:, None, :]) + b
    own = np.einsum("nii->ni", h - tau[:, :, None] * np.eye(3)) / l**2
    N = _directions()
    Q = off[:, None] * (N[:, :, None] * N[:, None, :])
    diagonal = own[:, None, :] * N**2 + np.einsum("nik,dk->ndi", a * (1.0 - np.eye(3)), N**2)
    Q[:, :, [0, 1, 2], [0, 1, 2]] = diagonal
    eigenvalues = np.linalg.eigvalsh(Q)
    return eigenvalues[:, :, 0].min(axis=1), ROUNDING * np.abs(Q).max(axis=(1, 2, 3))


def _slopes(x: np.ndarray, tau: np.ndarray, h: np.ndarray) -> np.ndarray:
    """(n, 3, 3) a_ik; its limit (h_ii - h_ik) / (2 l^2) for equal stretches; the diagonal means nothing."""
    dx = x[:, :, None] - x[:, None, :]
    dtau = tau[:, :, None] - tau[:, None, :]
    equal = np.abs(dx) < 1e-6
    along = np.where(equal, np.einsum("nii->ni", h)[:, :, None] - h, dtau / np.where(equal, 1.0, dx))
    mean = np.exp(x[:, :, None] + x[:, None, :])
    return along * np.where(equal, 0.5, dx / (2.0 * np.sinh(np.where(equal, 1.0, dx)))) / mean


def _failures(material: Tabulated, x: np.ndarray) -> np.ndarray:
    """(n,) index into CONDITIONS of the first that fails at x (n, 3), or -1."""
    _, tau, h = principal_energy(material, x)
    plane = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]) / np.sqrt([[2.0], [6.0]])
    scale = ROUNDING * np.abs(h).max(axis=(1, 2))
    stiffness = np.linalg.eigvalsh(plane @ h @ plane.T)[:, 0] <= -scale
    baker_ericksen = _slopes(x, tau, h).min(axis=(1, 2), where=~np.eye(3, dtype=bool), initial=np.inf)
    smallest, zero = acoustic_eigenvalue(material, x)
    failed = np.stack([stiffness, baker_ericksen <= -scale, smallest <= -zero], axis=1)
    return np.where(failed.any(axis=1), failed.argmax(axis=1), -1)


def _first_failure(material: Tabulated, ends: np.ndarray, count: int) -> tuple[np.ndarray, str] | None:
    """First failing state, (3,) logarithmic stretches and its condition, in `count` steps from rest to ends (R, 3)."""
    swelling = min(0.1, material.shear_modulus / material.bulk_modulus)
    volume = np.log1p(np.array([[-swelling], [0.0], [swelling]])) / 3.0

    def states(share: np.ndarray) -> np.ndarray:  # (s, R, 3 volumes, 3)
        return share[:, None, None, None] * ends[:, None, :] + volume

    for some in np.array_split(np.arange(1, count + 1) / count, max(1, count // 10)):
        x = states(some)
        which = _failures(material, x.reshape(-1, 3)).reshape(x.shape[:3])
        if (which < 0).all():
            continue
        i, j, k = np.argwhere(which >= 0)[0]
        low, high = some[i] - 1.0 / count, some[i]
        for _ in range(7):
            middle = 0.5 * (low + high)
            fails = _failures(material, states(np.array([middle]))[0, j, k][None])[0] >= 0
            low, high = (low, middle) if fails else (middle, high)
        at = states(np.array([high]))[0, j, k]
        return at, CONDITIONS[_failures(material, at[None])[0]]
    return None


def _rays(count: int) -> np.ndarray:
    """(count, 3) directions of isochoric logarithmic stretch, largest entry one: uniaxial to equibiaxial tension."""
    angle = np.linspace(0.0, np.pi / 3.0, count)[:, None] - np.array([0.0, 2.0, -2.0]) * np.pi / 3.0
    rays = np.cos(angle)
    return rays / np.abs(rays).max(axis=1, keepdims=True)


def _directions() -> np.ndarray:
    """(d, 3) unit vectors of an octant, which stands for all by symmetry; dense in the principal planes."""
    angle = np.linspace(0.0, np.pi / 2.0, 17)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(17)], axis=1)
    polar, turn = np.meshgrid(*2 * [np.linspace(0.0, np.pi / 2.0, 9)[1:-1]])
    inner = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=-1)
    return np.concatenate(
        [circle, np.roll(circle, 1, axis=1), np.roll(circle, 2, axis=1), inner.reshape(-1, 3)]
    )


def _advice(material: Tabulated) -> str:
    """What to change."""
    if material.model == OGDEN:
        mu, alpha = np.reshape(material.constants, (-1, 2)).T
        negative = np.flatnonzero(mu < 0.0)
        if len(negative):
            return f"mu[{negative[0]}] is negative: make it positive (mind the convention of the constants' source)"
        if np.abs(alpha).max() < 1.0:
            return "give one term an alpha of at least 1 in size"
    if material.model == POLYNOMIAL:
        values = dict(zip(("c10", "c01", "c20", "c30"), material.constants, strict=True))
        negative = [name for name, value in values.items() if value < 0.0]
        if negative:
            return f"{' and '.join(negative)} below zero: raise it, or press less deep"
        if values["c01"] > 0.0:
            return "raise c10 against c01, or poissons_ratio"
    if material.model == VERONDA_WESTMANN:
        return "raise c2 (its I2 term, -c1 c2/2, outweighs the exponential), or press less deep"
    return "raise poissons_ratio, or press less deep"
