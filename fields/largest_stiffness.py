# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Sigma: the largest stiffness that a hand can meet in a field, for the hold's leak and for device certificates.

With g = grad phi, U = sum_r phi_r(d) a_r(q), d = rho - phi(q),

    Hess U = sum_r  phi_r'' a_r g g^T - phi_r' a_r Hess phi - phi_r' (g grad a_r^T + grad a_r g^T) + phi_r Hess a_r

sigma = max ( |Hess U|_2 + k ) over the centres of all geometry cells in contact up to depth_max, the curves
taken at the deepest point of the cell.  The force on the hand changes by at most sigma |dp| in a tick of
sticking contact; the hold gives away at most sigma |dp|^2 / 2 (Colgate and Brown, 1994).
A texture (texture.py) adds at most, with H, S_1, S_2 the largest |h|, |grad h|, |Hess h|, x = w' H |g| + w S_1,
F = sum_r phi_r' a_r and everything else taken at a felt depth of d + H,

    phi'' a (2 |g| x + x^2) + F (w' H |Hess phi| + |w''| H |g|^2 + 2 w' |g| S_1 + w S_2) + 2 x |sum_r phi_r' grad a_r|,

the larger of where it is whole (w = 1) and of where it fades (w = 1, w' = 1.5 / fade_depth, w'' = 6 / fade_depth^2).

Limit: a maximum over cell centres times `MARGIN`, not a proven bound between them.
"""

from __future__ import annotations

import numpy as np

from palpate.fields.lattice import BLOCK_EDGE, Lattice
from palpate.fields.response_field import DepthCurves, ResponseField
from palpate.fields.texture import Texture
from palpate.fields.texture_layout import read_texture

__all__ = ["largest_stiffness"]

MARGIN = 1.05
"""For places between cell centres; on a 6:1 step over 5 mm the centres alone fell short by 0.1 %."""
_CHUNK = 20_000  # points at a time; bounds memory, nothing else


def largest_stiffness(field: ResponseField) -> float:
    """Largest stiffness of energy and friction spring, N/m, up to `field.depth_max`; 0 without contact."""
    lattice = field.geometry.signed_distance
    cells = _whole_cells(lattice)
    texture = read_texture(field.layers["texture"]) if "texture" in field.layers else None
    height = 0.0 if texture is None else texture.height_max
    sigma = 0.0
    for start in range(0, len(cells), _CHUNK):
        q = lattice.origin + lattice.spacing * (cells[start : start + _CHUNK] + 0.5)
        phi, g, hess = (x[..., 0] for x in _derivatives(lattice, q))
        depth = field.tool.offset - phi
        touching = (depth > 0) & (depth <= field.depth_max)
        if not touching.any():
            continue
        q, g, hess, depth = q[touching], g[touching], hess[touching], depth[touching]
        reach = 0.5 * np.sqrt(3.0) * lattice.spacing * np.linalg.norm(g, axis=1)
        deep = np.minimum(depth + reach, field.depth_max)
        a, da, dda = _derivatives(field.amplitudes, q)
        r_u, r_k = field.energy_curves.curve_count, field.stiffness_curves.curve_count
        value, slope, bend = _curves(field.energy_curves, deep + height)
        a_u, da_u = a[:, :r_u], da[..., :r_u]
        weight = np.einsum("nr,nr->n", slope, a_u)
        tilt = np.einsum("nr,nir->ni", slope, da_u)
        h = np.einsum("nr,nr,ni,nj->nij", bend, a_u, g, g) - weight[:, None, None] * hess
        h -= g[:, :, None] * tilt[:, None, :] + tilt[:, :, None] * g[:, None, :]
        h += np.einsum("nr,nijr->nij", value, dda[..., :r_u])
        k = np.einsum("nr,nr->n", _curves(field.stiffness_curves, deep + height)[0], a[:, r_u : r_u + r_k])
        local = np.linalg.norm(h, 2, axis=(1, 2)) + np.maximum(k, 0)
        if texture is not None:
            shapes = np.linalg.norm(g, axis=1), np.linalg.norm(hess, 2, axis=(1, 2))
            whole = _of_texture(texture, shapes, _forces(field, deep + height, a_u, da_u), fading=False)
            shallow = np.minimum(deep, texture.fade_depth) + height
            faded = _of_texture(texture, shapes, _forces(field, shallow, a_u, da_u), fading=True)
            local += np.where(depth - reach < texture.fade_depth, np.maximum(whole, faded), whole)
        sigma = max(sigma, float(np.max(local)))
    return MARGIN * sigma


def _forces(field: ResponseField, depth: np.ndarray, a: np.ndarray, da: np.ndarray) -> tuple[np.ndarray, ...]:
    """|phi'' a|, |phi' a| and |phi' grad a| at the depths (n,) for amplitudes (n, R) and their gradients (n, 3, R)."""
    _, slope, bend = _curves(field.energy_curves, depth)
    along = np.einsum("nr,nir->ni", slope, da)
    return np.abs(np.sum(bend * a, axis=1)), np.abs(np.sum(slope * a, axis=1)), np.linalg.norm(along, axis=1)


def _of_texture(
    texture: Texture, shapes: tuple[np.ndarray, ...], forces: tuple[np.ndarray, ...], fading: bool
) -> np.ndarray:
    """(n,) N/m; what a texture adds at most where it is whole, or where it fades."""
    (length, bent), (stiff, force, along) = shapes, forces
    H, fade = texture.height_max, texture.fade_depth
    S1, S2 = texture.slopes()
    dw, ddw = (1.5 / fade, 6.0 / fade**2) if fading else (0.0, 0.0)
    x = dw * H * length + S1
    bend = dw * H * bent + ddw * H * length**2 + 2.0 * dw * length * S1 + S2
    return stiff * (2.0 * length * x + x * x) + force * bend + 2.0 * x * along


def _whole_cells(lattice: Lattice) -> np.ndarray:
    """(n, 3) cells whose 27 coefficients are all stored."""
    stored = np.kron(lattice.block_index >= 0, np.ones((BLOCK_EDGE,) * 3, dtype=bool))
    for axis in range(3):
        n = stored.shape[axis]
        a, b, c = (np.take(stored, np.arange(i, n - 2 + i), axis=axis) for i in range(3))
        stored = a & b & c
    return np.argwhere(stored)


def _derivatives(lattice: Lattice, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value (n, c), gradient (n, 3, c) and Hessian (n, 3, 3, c) of all channels; absent blocks are zero."""
    u = (q - lattice.origin) / lattice.spacing
    i = np.floor(u).astype(int)
    t = u - i
    w = np.stack([0.5 * (1 - t) ** 2, 0.5 + t * (1 - t), 0.5 * t * t])  # (3 taps, n, 3 axes)
    d = np.stack([t - 1, 1 - 2 * t, t]) / lattice.spacing
    dd = (
        np.broadcast_to(np.array([1.0, -2.0, 1.0])[:, None, None], t.shape[:0] + w.shape) / lattice.spacing**2
    )
    n, channels = len(q), lattice.channel_count
    value, grad, hess = np.zeros((n, channels)), np.zeros((n, 3, channels)), np.zeros((n, 3, 3, channels))
    for tap in np.ndindex(3, 3, 3):
        j = i + np.array(tap)
        inside = np.all((j >= 0) & (j < BLOCK_EDGE * np.array(lattice.block_index.shape)), axis=1)
        j = np.where(inside[:, None], j, 0)
        row = np.where(inside, lattice.block_index[tuple((j // BLOCK_EDGE).T)], -1)
        c = np.where(
            (row >= 0)[:, None], lattice.coefficients[(np.maximum(row, 0), *(j % BLOCK_EDGE).T)], 0.0
        )
        tables = (w, d, dd)
        value += np.prod([w[tap[x], :, x] for x in range(3)], axis=0)[:, None] * c
        for a in range(3):
            order = [int(x == a) for x in range(3)]
            grad[:, a] += np.prod([tables[order[x]][tap[x], :, x] for x in range(3)], axis=0)[:, None] * c
            for b in range(3):
                order = [int(x == a) + int(x == b) for x in range(3)]
                hess[:, a, b] += (
                    np.prod([tables[order[x]][tap[x], :, x] for x in range(3)], axis=0)[:, None] * c
                )
    return value, grad, hess


def _curves(curves: DepthCurves, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value, slope and second derivative, each (n, R), for depths in (0, depth_end] and beyond."""
    count = curves.coefficients.shape[1]
    step = curves.depth_end / count
    at = np.minimum(depth, curves.depth_end)
    m = np.minimum((at / step).astype(int), count - 1)
    x = (at - m * step)[:, None]
    c0, c1, c2, c3 = np.moveaxis(curves.coefficients[:, m], -1, 0).swapaxes(1, 2)
    value = c0 + x * (c1 + x * (c2 + x * c3))
    slope, bend = c1 + x * (2 * c2 + 3 * x * c3), 2 * c2 + 6 * x * c3
    y = (depth - at)[:, None]
    return value + y * (slope + 0.5 * y * bend), slope + y * bend, bend
