# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How good tetrahedra are, and the gate that a mesh must pass before anything is computed on it.

With edges e, face areas A_i, volume V of a tetrahedron:

    dihedral angle at an edge: pi minus the angle between the normals of its two faces
    radius ratio  3 r / R,   r = 3 V / sum A_i,   R = circumradius      (1: regular, 0: flat)
    volume ratio  6 sqrt(2) V / l^3,   l = root mean square edge        (1: regular, 0: flat, < 0: inverted)

Shewchuk, What Is a Good Linear Finite Element?, 2002: small dihedral angles ruin conditioning, large ones the
gradients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["FACES", "QualityLimits", "TetQuality", "gate", "tet_quality"]

FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
"""The faces opposite corners 0 to 3, counter-clockwise from outside for positive volume."""

_EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])


@dataclass(frozen=True)
class TetQuality:
    """Per tetrahedron, all (T,): volume m^3, dihedral angles in degrees, ratios from 0 to 1."""

    volume: np.ndarray
    dihedral_min: np.ndarray
    dihedral_max: np.ndarray
    radius_ratio: np.ndarray
    volume_ratio: np.ndarray

    def summary(self) -> dict[str, float]:
        """The worst of each, and the 1st percentile and median of the smallest dihedral angle."""
        p1, p50 = np.percentile(self.dihedral_min, [1, 50])
        return {
            "volume": float(self.volume.sum()),
            "volume_min": float(self.volume.min()),
            "dihedral_min": float(self.dihedral_min.min()),
            "dihedral_p1": float(p1),
            "dihedral_p50": float(p50),
            "dihedral_max": float(self.dihedral_max.max()),
            "radius_ratio_min": float(self.radius_ratio.min()),
            "volume_ratio_min": float(self.volume_ratio.min()),
        }


@dataclass(frozen=True)
class QualityLimits:
    """What a mesh must keep.  Angles in degrees; fTetWild's own results lie near 13 and 158.

    Attributes:
        dihedral_min: below it an element is a sliver; the stiffness matrix' condition grows as 1 / sin.
        dihedral_max: above it gradients over the element are meaningless.
        volume_ratio_min: flat or inverted below it.
    """

    dihedral_min: float = 6.0
    dihedral_max: float = 170.0
    volume_ratio_min: float = 0.02


def tet_quality(points: np.ndarray, tets: np.ndarray) -> TetQuality:
    """points (P, 3) m, tets (T, 4)."""
    x = np.asarray(points, float)[np.asarray(tets)]  # (T, 4 corners, 3)
    a, b, c = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0], x[:, 3] - x[:, 0]
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    f = x[:, FACES]  # (T, 4 faces, 3 corners, 3)
    normal = np.cross(f[:, :, 1] - f[:, :, 0], f[:, :, 2] - f[:, :, 0])
    double_area = np.linalg.norm(normal, axis=2)
    normal = normal / np.maximum(double_area, 1e-300)[:, :, None]
    cosine = np.stack([np.einsum("ij,ij->i", normal[:, i], normal[:, j]) for i, j in _EDGES], axis=1)
    dihedral = 180.0 - np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    squares = np.sum((x[:, _EDGES[:, 0]] - x[:, _EDGES[:, 1]]) ** 2, axis=2)
    # Circumcentre offset: o = (|a|^2 b x c + |b|^2 c x a + |c|^2 a x b) / (12 V).
    twelve_volume_o = (
        np.sum(a * a, axis=1)[:, None] * np.cross(b, c)
        + np.sum(b * b, axis=1)[:, None] * np.cross(c, a)
        + np.sum(c * c, axis=1)[:, None] * np.cross(a, b)
    )
    inradius = 3.0 * np.abs(volume) / np.maximum(0.5 * double_area.sum(axis=1), 1e-300)
    over_circumradius = 12.0 * np.abs(volume) / np.maximum(np.linalg.norm(twelve_volume_o, axis=1), 1e-300)
    return TetQuality(
        volume=volume,
        dihedral_min=dihedral.min(axis=1),
        dihedral_max=dihedral.max(axis=1),
        radius_ratio=3.0 * inradius * over_circumradius,
        volume_ratio=6.0 * np.sqrt(2.0) * volume / np.maximum(squares.mean(axis=1) ** 1.5, 1e-300),
    )


def gate(quality: TetQuality, limits: QualityLimits | None = None) -> list[str]:
    """One sentence for each limit that the mesh breaks; empty when it passes."""
    limits = limits or QualityLimits()
    reasons = []
    inverted = int(np.sum(quality.volume <= 0.0))
    if inverted:
        reasons.append(f"{inverted} elements are inverted or have no volume")
    for name, values, sign in (
        ("dihedral_min", quality.dihedral_min, 1.0),
        ("dihedral_max", quality.dihedral_max, -1.0),
        ("volume_ratio_min", quality.volume_ratio, 1.0),
    ):
        limit = getattr(limits, name)
        broken = int(np.sum(sign * values < sign * limit))
        if broken:
            worst = values[np.argmin(sign * values)]
            reasons.append(f"{broken} elements break {name} = {limit:g} (worst {worst:.3g})")
    return reasons
