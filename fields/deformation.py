# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How the organ's surface moves under one tool, for graphics: a function of where the tool is.

With the contact point c, its normal n, r = X - c, R = |r| and the directions t = (r - (r.n) n) / R, b = n x t, a point
X of the surface moves by

    u = w [ n A0 + t B0
            + n (g.t) A1 + t (g.t) B1 + g C1
            + n (t.G t) A2 + t (t.G t) B2 + b (b.G t) C2
            + n (s.t) A3 + t (s.t) B3 + s C3 ]

A..C are functions of R and depth d: few tables shared by the whole reach, times amplitudes that change along the
surface.  Harmonic 0 is the dimple of an even half space; 1 (a vector g) and 2 (a traceless tensor G) are what
thickness, edges, supports and stiffer parts beside the contact make of it (a Fourier series about the normal, without
a frame that would have to be continuous); the last is how the surface follows a stuck tool that has moved by s.  w
falls to zero for points on the other side of the organ.  Amplitudes are kriged from the presses (Matern-5/2 over
contact point and normal).

What depends on t is zero at R = 0 (A0, C1 and C3 are not).  Tables have their knots at even steps of x = R / (R +
scale), and of depth; both are interpolated by Catmull and Rom's cubics (1974), so u is continuous with its slopes
wherever the contact point is.  They end at zero: no point farther than `radius` moves.  A point that the tool would
still cover is put onto the tool: `gap` is the tool's signed distance.

This file is the definition; runtime_cpp/src/layers/deformation.cpp is held against it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from palpate.fields.interpolation import evaluate
from palpate.fields.response_field import ResponseField

__all__ = ["BEHIND", "COMPONENTS", "Deformation", "ToolGap", "contact_of", "deform", "local_axes"]

COMPONENTS = (2, 3, 3, 3)
"""Functions in a table of harmonic 0, 1, 2 and of a stuck tool's."""
BEHIND = (-0.9, -0.7)
"""r.n / R between which w falls from 1 to 0: what lies so far below the contact is the organ's other side."""
SQRT5 = float(np.sqrt(5.0))


@dataclass(frozen=True)
class ToolGap:
    """A round tool's signed distance over (distance from its axis, height above its lowest point), bilinear.

    Attributes:
        step: m between values, both ways.
        value: (H, W) m; heights from -2 steps on, distances from 0 on.  Beyond, nothing is covered.
    """

    step: float
    value: np.ndarray


@dataclass(frozen=True)
class Deformation:
    """Of one tool.  N nodes, J radial and K depth knots.

    Attributes:
        depth_end: m; of the last depth knot.  scale: m.  radius: m; beyond it nothing moves.
        tables: for harmonics 0, 1, 2: (rank, K, J, components) m.
        stuck: (K, J, 3); displacement over the tool's tangential move.
        node: (N, 3) m; contact points.  normal: (N, 3).
        length: m; of the covariance of each harmonic's amplitudes.  normal_length: m a unit of normal.
        mean: (rank of harmonic 0,).  weight: (N, C); C = sum of rank times 1, 3 (g), 6 (G: xx yy zz yz xz xy).
        gap: of the tool.
        error: how far off on held-out presses; JSON-clean.
    """

    depth_end: float
    scale: float
    radius: float
    tables: tuple[np.ndarray, np.ndarray, np.ndarray]
    stuck: np.ndarray
    node: np.ndarray
    normal: np.ndarray
    length: tuple[float, float, float]
    normal_length: float
    mean: np.ndarray
    weight: np.ndarray
    gap: ToolGap
    error: dict[str, float] = field(default_factory=dict)

    @property
    def ranks(self) -> tuple[int, int, int]:
        a, b, c = (len(table) for table in self.tables)
        return a, b, c

    def amplitudes(self, c: np.ndarray, n: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """a (R0,), g (R1, 3), G (R2, 3, 3) at a contact point (3,) m with normal (3,); g, G in the tangent plane."""
        z = np.concatenate([self.node - c, self.normal_length * (self.normal - n)], axis=1)
        far = SQRT5 * np.sqrt(np.sum(z * z, axis=1))
        r0, r1, r2 = self.ranks
        ends, parts = (0, r0, r0 + 3 * r1, r0 + 3 * r1 + 6 * r2), []
        for i, length in enumerate(self.length):
            h = far / length
            parts.append(((1.0 + h + h * h / 3.0) * np.exp(-h)) @ self.weight[:, ends[i] : ends[i + 1]])
        value = np.concatenate(parts)
        g = value[r0 : r0 + 3 * r1].reshape(r1, 3)
        xx, yy, zz, yz, xz, xy = value[r0 + 3 * r1 :].reshape(r2, 6).T
        G = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1).reshape(r2, 3, 3)
        P = np.eye(3) - np.outer(n, n)
        G = P @ G @ P
        G = G - 0.5 * np.trace(G, axis1=1, axis2=2)[:, None, None] * P
        return self.mean + value[:r0], g @ P, G


def deform(
    model: Deformation,
    points: np.ndarray,
    c: np.ndarray,
    n: np.ndarray,
    depth: float,
    stretch: np.ndarray | None = None,
    tip: np.ndarray | None = None,
    axis: np.ndarray | None = None,
) -> np.ndarray:
    """(V, 3) m; how far surface points (V, 3) m at rest have moved.

    Args:
        c, n: contact point (3,) m and outward normal (3,).
        depth: m; nothing moves where it is not positive.
        stretch: (3,) m; how far a stuck tool has moved since it stood over c.
        tip: (3,) m; the tool's lowest point, axis: (3,) out of the tissue, to keep the surface out of it; None: it may
            be covered.
    """
    u = np.zeros((len(points), 3))
    if not depth > 0.0:
        return u
    a, g, G = model.amplitudes(c, n)
    d = _depth_weights(model, depth)
    p0 = np.einsum("r,rkjc,k->jc", a, model.tables[0], d)
    p1 = np.einsum("rx,rkjc,k->jcx", g, model.tables[1], d)
    p2 = np.einsum("rxy,rkjc,k->jcxy", G, model.tables[2], d)
    if stretch is not None:
        s = stretch - (stretch @ n) * n
        p1 = p1 + np.einsum("kjc,k,x->jcx", model.stuck, d, s)
    near = np.flatnonzero(np.linalg.norm(points - c, axis=1) < model.radius)
    R, t, b, behind = local_axes(points[near], c, n)
    j, w = radial_weights(R, model.scale, model.radius, p0.shape[0])
    f0, f1, f2 = (np.einsum("vi,vi...->v...", w, p[j]) for p in (_padded(p0), _padded(p1), _padded(p2)))
    whole = f1[:, 2]
    f1 = np.einsum("vcx,vx->vc", f1[:, :2], t)
    f2 = np.einsum("vcxy,vcx,vy->vc", f2, np.stack([t, t, b], axis=1), t)
    f = f2
    f[:, :2] += f0 + f1
    u[near] = behind[:, None] * (f[:, :1] * n + f[:, 1:2] * t + f[:, 2:] * b + whole)
    if tip is not None and axis is not None:
        u[near] += _uncovered(model.gap, points[near] + u[near], tip, axis)
    return u


def contact_of(
    response: ResponseField, q: np.ndarray, anchor: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, float, np.ndarray, np.ndarray]:
    """c, n, depth, tip and axis, as `deform` takes them, of a tool whose reference point is q (3,) m.

    Args:
        anchor: (3,) m; where friction holds, q - stretch; q itself when None.
    """
    at = evaluate(response, np.stack([q, q if anchor is None else anchor]))
    first = 1 if at.valid[1] else 0
    n = at.normal[first]
    phi = response.tool.offset - at.depth[first]
    c = (q if first == 0 or anchor is None else anchor) - phi * n
    return c, n, float(at.depth[0]), q - response.tool.offset * at.normal[0], at.normal[0]


def local_axes(
    points: np.ndarray, c: np.ndarray, n: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """R (V,) m, t (V, 3), b (V, 3) and w (V,) of points (V, 3) m."""
    r = points - c
    R = np.sqrt(np.sum(r * r, axis=1))
    z = r @ n
    t = (r - z[:, None] * n) / np.maximum(R, 1e-12)[:, None]
    low, high = BEHIND
    x = np.clip((z / np.maximum(R, 1e-12) - low) / (high - low), 0.0, 1.0)
    return R, t, np.cross(n, t), x * x * (3.0 - 2.0 * x)


def radial_weights(R: np.ndarray, scale: float, radius: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Knots (V, 4) of a padded table, and Catmull-Rom weights (V, 4), at distances R (V,) m up to radius."""
    x = (R / (R + scale)) * ((radius + scale) / radius) * (count - 1)
    cell = np.clip(np.floor(x).astype(int), 0, count - 2)
    return cell[:, None] + np.arange(4), _catmull_rom(x - cell)


def knots(scale: float, radius: float, count: int) -> np.ndarray:
    """(count,) m; distances at which tables have values."""
    x = np.arange(count) / (count - 1) * (radius / (radius + scale))
    return scale * x / (1.0 - x)


def _catmull_rom(f: np.ndarray) -> np.ndarray:
    return np.stack(
        [
            f * (-0.5 + f * (1.0 - 0.5 * f)),
            1.0 + f * f * (-2.5 + 1.5 * f),
            f * (0.5 + f * (2.0 - 1.5 * f)),
            f * f * (-0.5 + 0.5 * f),
        ],
        axis=-1,
    )


def _padded(p: np.ndarray) -> np.ndarray:
    """A table with one more value before (its slope goes on) and after (zero)."""
    return np.concatenate([2.0 * p[:1] - p[1:2], p, np.zeros_like(p[:1])])


def _depth_weights(model: Deformation, depth: float) -> np.ndarray:
    """(K,) weights of the depth knots; beyond the last, the last slope goes on, up to twice that depth."""
    count = model.stuck.shape[0]
    x = min(depth / model.depth_end, 2.0) * (count - 1)
    out = np.zeros(count + 2)
    if x >= count - 1:
        out[count - 1 : count + 1] = (count - 1 - x, x - (count - 2))
        return out[1:-1]
    cell = int(x)
    out[cell : cell + 4] = _catmull_rom(np.array(x - cell))
    out[1:3] += out[0] * np.array([2.0, -1.0])  # ghosts: the end's slope goes on
    out[-3:-1] += out[-1] * np.array([-1.0, 2.0])
    return out[1:-1]


def _uncovered(gap: ToolGap, points: np.ndarray, tip: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """(V, 3) m; from points (V, 3) m that the tool covers to its surface, zero elsewhere."""
    y = points - tip
    height = y @ axis
    across = y - height[:, None] * axis
    distance = np.sqrt(np.sum(across * across, axis=1))
    rows, columns = gap.value.shape
    i, k = height / gap.step + 2.0, distance / gap.step
    inside = (i >= 0.0) & (i < rows - 1) & (k < columns - 1)
    i, k = np.where(inside, i, 0.0), np.where(inside, k, 0.0)
    i0, k0 = i.astype(int), k.astype(int)
    a, e = i - i0, k - k0
    v00, v01, v10, v11 = (gap.value[i0 + p, k0 + q] for p in (0, 1) for q in (0, 1))
    value = (1 - a) * ((1 - e) * v00 + e * v01) + a * ((1 - e) * v10 + e * v11)
    up = (1 - e) * (v10 - v00) + e * (v11 - v01)
    out = (1 - a) * (v01 - v00) + a * (v11 - v10)
    size = np.sqrt(up * up + out * out)
    covered = inside & (value < 0.0) & (size > 0.0)
    push = np.where(covered, -value / np.where(covered, size, 1.0), 0.0)
    along = across / np.maximum(distance, 1e-12)[:, None]
    return push[:, None] * (up[:, None] * axis + out[:, None] * along)
