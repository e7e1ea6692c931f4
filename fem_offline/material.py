# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Materials by their constants: isotropic, nearly incompressible, shape and volume apart.

    psi = psi_iso(shape) + kappa/2 (J - 1)^2,   kappa = 2 mu (1 + nu) / (3 (1 - 2 nu))

mu is the shear modulus of small strains, which each model states.  With I1bar, I2bar the isochoric invariants and
l1, l2, l3 the isochoric principal stretches:

    Linear           mu dev(eps):dev(eps), with kappa/2 tr(eps)^2      mu = E / (2 (1 + nu))
    NeoHookean       mu/2 (I1bar - 3)                                  mu = E / (2 (1 + nu))
    MooneyRivlin     c10 (I1bar - 3) + c01 (I2bar - 3)                 mu = 2 (c10 + c01)
    Yeoh             sum_n cn0 (I1bar - 3)^n, n = 1, 2, 3              mu = 2 c10
    VerondaWestmann  c1 (exp(c2 (I1bar - 3)) - 1) - c1 c2/2 (I2bar - 3)  mu = c1 c2
    Ogden            sum_p 2 mu_p/alpha_p^2 (l1^a + l2^a + l3^a - 3)     mu = sum mu_p

Other texts write Ogden's terms as mu_p/alpha_p (...), with mu = sum mu_p alpha_p / 2, or count mu_p twice: check
before copying constants.  Equations, sources and code: constitutive.py and what it imports.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

from palpate.fem_offline.material_check import Stability, stability
from palpate.fem_offline.material_density import density
from palpate.fem_offline.material_table import FULL_SHARE, LINEAR, OGDEN, POLYNOMIAL, VERONDA_WESTMANN

__all__ = [
    "FULL_SHARE",
    "Linear",
    "Material",
    "MooneyRivlin",
    "NeoHookean",
    "Ogden",
    "Stability",
    "VerondaWestmann",
    "Yeoh",
    "density",
    "lame_parameters",
    "stability",
]


def lame_parameters(youngs_modulus: float, poissons_ratio: float) -> tuple[float, float]:
    """Shear modulus mu and bulk modulus kappa, Pa, of small strains.

    Raises:
        ValueError: a modulus that is not positive, or Poisson's ratio outside (-1, 0.5).
    """
    if not 0.0 < youngs_modulus < math.inf:
        raise ValueError(f"youngs_modulus is {youngs_modulus} Pa; it must be positive")
    _check_ratio(poissons_ratio)
    mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    kappa = youngs_modulus / (3.0 * (1.0 - 2.0 * poissons_ratio))
    return mu, kappa


class Material(ABC):
    """An isotropic material; every model of this file is one.

    Attributes:
        poissons_ratio: of small strains.
        shear_modulus: Pa, of small strains.
        model, constants: what its row of a material table holds (material_table.py).
    """

    poissons_ratio: float

    @property
    @abstractmethod
    def shear_modulus(self) -> float: ...

    @property
    @abstractmethod
    def model(self) -> int: ...

    @property
    @abstractmethod
    def constants(self) -> tuple[float, ...]: ...

    @property
    def bulk_modulus(self) -> float:
        """Pa, of small strains."""
        nu = self.poissons_ratio
        return 2.0 * self.shear_modulus * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))

    def _check(self, constants: Mapping[str, float]) -> None:
        for name, value in constants.items():
            if not math.isfinite(value):
                raise ValueError(f"{name} is {value}; it must be a finite number")
        _check_ratio(self.poissons_ratio)
        mu = self.shear_modulus
        if not 0.0 < mu < math.inf:
            raise ValueError(f"{self} has an initial shear modulus of {mu} Pa; it must be positive")


def _check_ratio(poissons_ratio: float) -> None:
    if not -1.0 < poissons_ratio < 0.5:
        raise ValueError(f"poissons_ratio is {poissons_ratio}; it must lie between -1 and 0.5")


class _ByYoungsModulus(Material):
    youngs_modulus: float

    def __post_init__(self) -> None:
        lame_parameters(self.youngs_modulus, self.poissons_ratio)

    @property
    def shear_modulus(self) -> float:
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))


class _ByConstants(Material):
    @property
    def youngs_modulus(self) -> float:
        """Pa, of small strains."""
        return 2.0 * self.shear_modulus * (1.0 + self.poissons_ratio)


@dataclass(frozen=True)
class Linear(_ByYoungsModulus):
    """Hooke's law of small strains at any strain: compliance only; rotations strain it.

    Attributes:
        youngs_modulus: Pa.
        poissons_ratio: up to 0.4999.
    """

    youngs_modulus: float
    poissons_ratio: float

    model = int(LINEAR)

    @property
    def constants(self) -> tuple[float, ...]:
        return (self.shear_modulus,)


@dataclass(frozen=True)
class NeoHookean(_ByYoungsModulus):
    """mu/2 (I1bar - 3).

    Attributes:
        youngs_modulus: Pa, of small strains.
        poissons_ratio: of small strains, up to 0.4999.
    """

    youngs_modulus: float
    poissons_ratio: float

    model = int(POLYNOMIAL)

    @property
    def constants(self) -> tuple[float, ...]:
        return 0.5 * self.shear_modulus, 0.0, 0.0, 0.0


@dataclass(frozen=True)
class MooneyRivlin(_ByConstants):
    """c10 (I1bar - 3) + c01 (I2bar - 3).

    Attributes:
        c10, c01: Pa; their sum is positive.
        poissons_ratio: of small strains, up to 0.4999.
    """

    c10: float
    c01: float
    poissons_ratio: float

    model = int(POLYNOMIAL)

    def __post_init__(self) -> None:
        self._check({"c10": self.c10, "c01": self.c01})

    @property
    def shear_modulus(self) -> float:
        return 2.0 * (self.c10 + self.c01)

    @property
    def constants(self) -> tuple[float, ...]:
        return self.c10, self.c01, 0.0, 0.0


@dataclass(frozen=True)
class Yeoh(_ByConstants):
    """c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3.

    Attributes:
        c10, c20, c30: Pa; c10 is positive.
        poissons_ratio: of small strains, up to 0.4999.
    """

    c10: float
    c20: float
    c30: float
    poissons_ratio: float

    model = int(POLYNOMIAL)

    def __post_init__(self) -> None:
        self._check({"c10": self.c10, "c20": self.c20, "c30": self.c30})

    @property
    def shear_modulus(self) -> float:
        return 2.0 * self.c10

    @property
    def constants(self) -> tuple[float, ...]:
        return self.c10, 0.0, self.c20, self.c30


@dataclass(frozen=True)
class VerondaWestmann(_ByConstants):
    """c1 (exp(c2 (I1bar - 3)) - 1) - c1 c2/2 (I2bar - 3).

    Attributes:
        c1: Pa.  c2: without unit.  Their product is positive.
        poissons_ratio: of small strains, up to 0.4999.
    """

    c1: float
    c2: float
    poissons_ratio: float

    model = int(VERONDA_WESTMANN)

    def __post_init__(self) -> None:
        self._check({"c1": self.c1, "c2": self.c2})

    @property
    def shear_modulus(self) -> float:
        return self.c1 * self.c2

    @property
    def constants(self) -> tuple[float, ...]:
        return self.c1, self.c2


@dataclass(frozen=True)
class Ogden(_ByConstants):
    """sum_p 2 mu_p/alpha_p^2 (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3), of isochoric stretches.

    Attributes:
        mu: Pa, one for each term; their sum is positive.
        alpha: without unit, one for each term, none of them zero.
        poissons_ratio: of small strains, up to 0.4999.
    """

    mu: tuple[float, ...]
    alpha: tuple[float, ...]
    poissons_ratio: float

    model = int(OGDEN)

    def __post_init__(self) -> None:
        object.__setattr__(self, "mu", tuple(float(value) for value in self.mu))
        object.__setattr__(self, "alpha", tuple(float(value) for value in self.alpha))
        if len(self.mu) != len(self.alpha) or not self.mu:
            raise ValueError(
                f"mu has {len(self.mu)} terms and alpha {len(self.alpha)}; they must be as many, at least one"
            )
        if 0.0 in self.alpha:
            raise ValueError(f"alpha is {self.alpha}; none of them must be zero")
        terms = enumerate(zip(self.mu, self.alpha, strict=True))
        self._check(
            {f"{name}[{p}]": x for p, pair in terms for name, x in zip(("mu", "alpha"), pair, strict=True)}
        )

    @property
    def shear_modulus(self) -> float:
        return sum(self.mu)

    @property
    def constants(self) -> tuple[float, ...]:
        return tuple(x for term in zip(self.mu, self.alpha, strict=True) for x in term)
