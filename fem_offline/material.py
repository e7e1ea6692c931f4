# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Hyperelastic materials, isochoric and volumetric parts apart.

    psi(F) = psi_iso(F) + psi_vol(J),  J = det F
    neo-Hookean   psi_iso = mu / 2 (J^(-2/3) I1 - 3),  I1 = tr F^T F
    volumetric    psi_vol = kappa / 2 (J - 1)^2

(Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, eq. 6.50, 6.59.)
The first Piola-Kirchhoff stress is P = d psi / dF; `_tangent` functions give dP[H] = (d^2 psi / dF^2) : H.

The volumetric part is split once more for quadratic tetrahedra: a share `kappa_full` of the order of mu is
integrated at the same four points as psi_iso, the rest at the element's centre alone.  Without that share an
element has 4 x 5 + 1 = 21 strain measures for 24 deforming modes; with kappa alone at four points it locks.
"""

from __future__ import annotations

from dataclasses import dataclass

import warp as wp

__all__ = [
    "NeoHookean",
    "isochoric_energy",
    "isochoric_stress",
    "isochoric_tangent",
    "lame_parameters",
    "volumetric_energy",
    "volumetric_stress",
    "volumetric_tangent",
]


FULL_SHARE = 2.0
"""kappa_full over mu.  Measured on a ball over a thin soft layer (5 mm ball, 4 mm deep, a stiff nodule 6.5 mm down):
with 1, elements hourglassed (smallest J 0.55 at 4 mm); with 2 it stays at 0.85, with 4 at 0.80.  Force on the same
coarse mesh rises by 0.2 % from 1 to 2, 0.5 % to 4, 0.8 % to 8: the locking that full integration would bring."""


def lame_parameters(youngs_modulus: float, poissons_ratio: float) -> tuple[float, float]:
    """Shear modulus mu and bulk modulus kappa, Pa, of small strains.

    Raises:
        ValueError: a modulus that is not positive, or Poisson's ratio outside (-1, 0.5).
    """
    if not youngs_modulus > 0.0:
        raise ValueError(f"youngs_modulus is {youngs_modulus} Pa; it must be positive")
    if not -1.0 < poissons_ratio < 0.5:
        raise ValueError(f"poissons_ratio is {poissons_ratio}; it must lie between -1 and 0.5")
    mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    kappa = youngs_modulus / (3.0 * (1.0 - 2.0 * poissons_ratio))
    return mu, kappa


@dataclass(frozen=True)
class NeoHookean:
    """A nearly incompressible neo-Hookean solid.

    Attributes:
        youngs_modulus: Pa, of small strains.
        poissons_ratio: of small strains; 0.3 to 0.495 is what this version's tests cover.
    """

    youngs_modulus: float
    poissons_ratio: float

    def __post_init__(self) -> None:
        lame_parameters(self.youngs_modulus, self.poissons_ratio)

    @property
    def shear_modulus(self) -> float:
        return lame_parameters(self.youngs_modulus, self.poissons_ratio)[0]

    @property
    def bulk_modulus(self) -> float:
        return lame_parameters(self.youngs_modulus, self.poissons_ratio)[1]

    @property
    def parameters(self) -> tuple[float, float, float]:
        """(mu, kappa_full, kappa_centre), Pa: what the kernels take."""
        mu, kappa = self.shear_modulus, self.bulk_modulus
        kappa_full = min(FULL_SHARE * mu, kappa)
        return mu, kappa_full, kappa - kappa_full


# A quotient of literals inside a Warp function would be taken in float32.
TWO_THIRDS = wp.constant(wp.float64(2.0 / 3.0))
TWO_NINTHS = wp.constant(wp.float64(2.0 / 9.0))


@wp.func
def inverse_transpose(F: wp.mat33d) -> wp.mat33d:
    """F^-T."""
    return wp.transpose(wp.inverse(F))


@wp.func
def isochoric_energy(F: wp.mat33d, mu: wp.float64) -> wp.float64:
    """mu / 2 (J^(-2/3) I1 - 3)."""
    J = wp.determinant(F)
    I1 = wp.ddot(F, F)
    return wp.float64(0.5) * mu * (I1 * wp.pow(J, -TWO_THIRDS) - wp.float64(3.0))


@wp.func
def isochoric_stress(F: wp.mat33d, mu: wp.float64) -> wp.mat33d:
    """P = mu J^(-2/3) (F - I1/3 F^-T)."""
    J = wp.determinant(F)
    I1 = wp.ddot(F, F)
    Fit = inverse_transpose(F)
    return (F - Fit * (I1 / wp.float64(3.0))) * (mu * wp.pow(J, -TWO_THIRDS))


@wp.func
def isochoric_tangent(F: wp.mat33d, H: wp.mat33d, mu: wp.float64) -> wp.mat33d:
    """dP[H] = mu J^(-2/3) (H - 2/3 (F:H) F^-T - 2/3 (F^-T:H) F + 2/9 I1 (F^-T:H) F^-T + I1/3 F^-T H^T F^-T)."""
    J = wp.determinant(F)
    I1 = wp.ddot(F, F)
    Fit = inverse_transpose(F)
    a = wp.ddot(Fit, H)
    b = wp.ddot(F, H)
    dP = H - Fit * (TWO_THIRDS * b) - F * (TWO_THIRDS * a)
    dP = dP + Fit * (TWO_NINTHS * I1 * a) + Fit * wp.transpose(H) * Fit * (I1 / wp.float64(3.0))
    return dP * (mu * wp.pow(J, -TWO_THIRDS))


@wp.func
def volumetric_energy(F: wp.mat33d, kappa: wp.float64) -> wp.float64:
    """kappa / 2 (J - 1)^2."""
    J = wp.determinant(F)
    return wp.float64(0.5) * kappa * (J - wp.float64(1.0)) * (J - wp.float64(1.0))


@wp.func
def volumetric_stress(F: wp.mat33d, kappa: wp.float64) -> wp.mat33d:
    """P = kappa (J - 1) J F^-T."""
    J = wp.determinant(F)
    return inverse_transpose(F) * (kappa * (J - wp.float64(1.0)) * J)


@wp.func
def volumetric_tangent(F: wp.mat33d, H: wp.mat33d, kappa: wp.float64) -> wp.mat33d:
    """dP[H] = kappa (J (2J - 1) (F^-T:H) F^-T - J (J - 1) F^-T H^T F^-T)."""
    J = wp.determinant(F)
    Fit = inverse_transpose(F)
    a = wp.ddot(Fit, H)
    one = wp.float64(1.0)
    two = wp.float64(2.0)
    return Fit * (kappa * J * (two * J - one) * a) - Fit * wp.transpose(H) * Fit * (kappa * J * (J - one))
