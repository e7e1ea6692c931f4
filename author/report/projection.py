# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How the organ is looked at in a picture: parallel projection, so that scale is the same all over it.

A point p appears at  x = W / 2 + (p - m) . right * s,   y = H / 2 - (p - m) . top * s   pixels.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.colors import Colormap

__all__ = ["WINDOW", "Mesh", "View"]

WINDOW = (1400, 1050)
"""W, H; pixels."""
CLEARANCE = 5e-3
"""Share of the picture's height by which a mark may lie under the facets shown and still count as seen."""


@dataclass(frozen=True)
class Mesh:
    """vertices (V, 3) m, triangles (F, 3), a colour or a colour scale (or its name) for values (V,).

    `limits`: the values at the scale's ends; those of the mesh when absent.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    colour: str | Colormap
    values: np.ndarray | None = None
    limits: tuple[float, float] | None = None


@dataclass(frozen=True)
class View:
    """Meshes seen from direction `eye` (3,), `up` (3,) upwards, around the points `shown` (n, 3) m.

    `margin`: height of the picture over the height of what is shown.
    """

    eye: np.ndarray
    up: np.ndarray
    shown: np.ndarray
    margin: float
    meshes: list[Mesh]

    @property
    def right(self) -> np.ndarray:
        right = np.cross(self.up, self.eye)
        return right / np.linalg.norm(right)

    @property
    def top(self) -> np.ndarray:
        return np.cross(self.eye, self.right)

    @property
    def middle(self) -> np.ndarray:
        """(3,) m; what appears in the picture's middle."""
        frame = np.stack([self.right, self.top, self.eye])
        along = self.shown @ frame.T
        return 0.5 * (along.min(axis=0) + along.max(axis=0)) @ frame

    @property
    def height(self) -> float:
        """m, of the picture."""
        across, upwards = np.ptp(self.shown @ self.right), np.ptp(self.shown @ self.top)
        return self.margin * max(float(upwards), float(across) * WINDOW[1] / WINDOW[0], 1e-9)

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pixels (n, 2) of points (n, 3) m, and whether each is seen (n,): in the picture, hidden by no mesh.

        A triangle hides p when its three edges turn the same way round p in the picture and its plane is nearer
        to the eye.
        """
        frame = np.stack([self.right, self.top, self.eye], axis=1)
        flat = (np.asarray(points, float).reshape(-1, 3) - self.middle) @ frame
        scale = WINDOW[1] / self.height
        pixels = np.array(WINDOW) / 2 + flat[:, :2] * (scale, -scale)
        seen = np.all((pixels >= 0) & (pixels < WINDOW), axis=1)
        corners = [(m.vertices[m.triangles] - self.middle) @ frame for m in self.meshes if len(m.triangles)]
        a, b, c = np.moveaxis(np.concatenate(corners), 1, 0)
        normal = np.cross(b - a, c - a)
        for k, p in enumerate(flat):
            turns = np.array([_turn(start, end, p) for start, end in ((a, b), (b, c), (c, a))])
            over = (np.all(turns >= 0, axis=0) | np.all(turns <= 0, axis=0)) & (normal[:, 2] != 0)
            n, start = normal[over], a[over]
            height = start[:, 2] - np.sum(n[:, :2] * (p[:2] - start[:, :2]), axis=1) / n[:, 2]
            seen[k] &= not np.any(height > p[2] + CLEARANCE * self.height)
        return pixels, seen


def _turn(start: np.ndarray, end: np.ndarray, p: np.ndarray) -> np.ndarray:
    d = end - start
    return d[:, 0] * (p[1] - start[:, 1]) - d[:, 1] * (p[0] - start[:, 0])
