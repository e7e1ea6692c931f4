# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Response fields from closed forms, for tests of the cooked file and the runtime (Python and C++).

Organ: the half space z < 0, a sphere, or a slab of some thickness.  Tool: a ball.  Depth curve: Hertz's energy
8/15 E* sqrt(R) d^2.5 where it is wanted, made C2 with zero slope and value at 0.  Amplitude: 1 to 6 over 5 mm along x
by default.  `python synthetic_field.py DIR` writes the .rfield files that the C++ tests open.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from palpate.fields.cook import cook, write_rfield
from palpate.fields.lattice import ABSENT_INSIDE, ABSENT_OUTSIDE, ABSENT_UNREACHED, Lattice
from palpate.fields.response_field import (
    ContactGeometry,
    DepthCurves,
    ResponseField,
    ResponseNodes,
    ToolReference,
)
from palpate.fields.texture import DeviceLimits, Texture, grating, noise
from palpate.fields.texture_layout import texture_bytes
from palpate.fields.transient_layout import transient_layer

RADIUS = 5e-3
DEPTH_MAX = 5e-3


def plane(q: np.ndarray) -> np.ndarray:
    """Signed distance of the half space z < 0."""
    return q[..., 2]


def ball(radius: float) -> Callable[[np.ndarray], np.ndarray]:
    """Signed distance of a sphere organ about the origin."""
    return lambda q: np.linalg.norm(q, axis=-1) - radius


def slab(thickness: float) -> Callable[[np.ndarray], np.ndarray]:
    """Signed distance of the slab |z| < thickness / 2, rounded at its middle plane as a lattice would."""
    return lambda q: np.sqrt(q[..., 2] ** 2 + 1e-6) - 0.5 * thickness


def step(q: np.ndarray, ratio: float = 6.0, width: float = 5e-3) -> np.ndarray:
    """1 for x < 0, `ratio` for x > width, smooth between."""
    s = np.clip(q[..., 0] / width, 0, 1)
    return 1 + (ratio - 1) * (3 * s**2 - 2 * s**3)


def spline_lattice(
    values: Callable[[np.ndarray], np.ndarray],
    low: np.ndarray,
    high: np.ndarray,
    spacing: float,
    keep: Callable[[np.ndarray], np.ndarray] | None = None,
    absent: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Lattice:
    """Quasi-interpolant of `values` ((..., 3) -> (...,) or (..., c)), exact for quadratics along each axis.

    Coefficient j belongs to u = j - 1/2; per axis c_j = -f_{j-1}/8 + 5 f_j/4 - f_{j+1}/8.
    `keep` and `absent` see block centres; a block is stored where `keep` holds.
    """
    blocks = np.ceil((high - low) / (4 * spacing)).astype(int)
    axes = [low[a] + spacing * (np.arange(-1, 4 * blocks[a] + 1) - 0.5) for a in range(3)]
    f = values(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))
    f = f[..., None] if f.ndim == 3 else f
    for axis in range(3):
        n = f.shape[axis]
        a, b, c = (np.take(f, np.arange(i, n - 2 + i), axis=axis) for i in range(3))
        f = -a / 8 + 5 * b / 4 - c / 8
    f = f.reshape(blocks[0], 4, blocks[1], 4, blocks[2], 4, -1).transpose(0, 2, 4, 1, 3, 5, 6)
    centres = [low[a] + 4 * spacing * (np.arange(blocks[a]) + 0.5) for a in range(3)]
    centre = np.stack(np.meshgrid(*centres, indexing="ij"), axis=-1)
    stored = np.ones(blocks, bool) if keep is None else keep(centre)
    index = np.where(stored, 0, ABSENT_OUTSIDE if absent is None else absent(centre)).astype(np.int32)
    index[stored] = np.arange(stored.sum())
    return Lattice(low.astype(float), spacing, index, f[stored])


def hertz_curves(modulus: float = 7e3, intervals: int = 16, soft: float = 0.3e-3) -> np.ndarray:
    """(1, M, 4): energy 8/15 E* sqrt(R) ((d^2 + soft^2)^1.25 - ...), C2, value and slope 0 at d = 0."""
    knots = np.linspace(0, DEPTH_MAX, intervals + 1)
    scale = 8 / 15 * modulus * np.sqrt(RADIUS)
    energy = scale * ((knots**2 + soft**2) ** 1.25 - soft**2.5)
    spline = CubicSpline(knots, energy, bc_type=((1, 0.0), "not-a-knot"))
    c = spline.c[::-1].T.copy()
    c[0, :2] = 0.0
    return c[None]


def synthetic_field(
    sdf: Callable[[np.ndarray], np.ndarray] = plane,
    amplitude: Callable[[np.ndarray], np.ndarray] = step,
    low: tuple[float, float, float] = (-15e-3, -15e-3, -14e-3),
    high: tuple[float, float, float] = (21e-3, 15e-3, 13e-3),
    geometry_spacing: float = 1.5e-3,
    amplitude_spacing: float = 1.5e-3,
    band: tuple[float, float] = (-1e-3, 8e-3),
    friction: float = 0.1,
    reach: Callable[[np.ndarray], np.ndarray] | None = None,
) -> ResponseField:
    """A ball of 5 mm on `sdf`, pressed 5 mm deep; two energy curves, one stiffness, one friction curve.

    `reach` ((..., 3) -> bool, block centres): where geometry is stored at all; elsewhere "unreached".
    """
    low_, high_ = np.array(low), np.array(high)
    half = (0.5 * np.sqrt(3.0) * 4 + 2) * geometry_spacing  # half a block's diagonal, and a stencil
    touched = (lambda c: np.ones(c.shape[:-1], bool)) if reach is None else reach

    def keep(c):
        return (sdf(c) > band[0] - half) & (sdf(c) < band[1] + half) & touched(c)

    def absent(c):
        code = np.where(sdf(c) > 0.5 * (band[0] + band[1]), ABSENT_OUTSIDE, ABSENT_INSIDE)
        return np.where(touched(c) | (code == ABSENT_OUTSIDE), code, ABSENT_UNREACHED)

    def channels(q):
        a = amplitude(q)
        return np.stack([a, 0.2 * a**1.5, 0.5 + 0.5 * a, np.ones_like(a)], axis=-1)

    def zone(c):
        return (sdf(c) > band[0] - 2 * half) & (sdf(c) < RADIUS + 2 * half) & touched(c)

    first = hertz_curves()
    second = np.zeros_like(first)
    step_ = DEPTH_MAX / first.shape[1]
    for m in range(first.shape[1]):  # 40 N/m^3 d^4-like: a quartic's C1 cubic Hermite form
        x0, x1 = m * step_, (m + 1) * step_
        f0, f1, s0, s1 = 2e5 * x0**4, 2e5 * x1**4, 8e5 * x0**3, 8e5 * x1**3
        second[0, m] = [f0, s0, (3 * (f1 - f0) / step_ - 2 * s0 - s1) / step_,
                        (2 * (f0 - f1) / step_ + s0 + s1) / step_**2]  # fmt: skip
    stiffness = np.zeros((1, 4, 4))
    for m in range(4):
        x = m * DEPTH_MAX / 4
        stiffness[0, m] = [6e4 * x - 2e6 * x**2, 6e4 - 4e6 * x, -2e6, 0.0]
    coefficient = np.zeros((1, 1, 4))
    coefficient[0, 0, 0] = friction
    one = np.zeros((1, 2))
    nodes = ResponseNodes(
        np.zeros((1, 3)), np.array([[0.0, 0, 1]]), np.array([0, DEPTH_MAX]), one, one, np.zeros((1, 2, 3)), one,
        one, np.array([DEPTH_MAX]), np.zeros(1, bool), np.zeros(1), np.array([""]),
    )  # fmt: skip
    return ResponseField(
        tool=ToolReference("ball_5mm", "sphere", RADIUS, {"radius": RADIUS}, "0" * 64),
        geometry=ContactGeometry(
            spline_lattice(sdf, low_, high_, geometry_spacing, keep, absent), np.array(band), 0.0, 0.0
        ),
        nodes=nodes,
        energy_curves=DepthCurves(DEPTH_MAX, np.concatenate([first, second])),
        stiffness_curves=DepthCurves(DEPTH_MAX, stiffness),
        friction_curves=DepthCurves(DEPTH_MAX, coefficient),
        amplitudes=spline_lattice(channels, low_, high_, amplitude_spacing, zone),
        depth_max=DEPTH_MAX,
        provenance={"mesh": "synthetic", "seed": 1},
    )


def sphere_organ(radius: float = 30e-3, **overrides) -> ResponseField:
    """A sphere organ whose amplitude steps 1:6 across x = 0..5 mm."""
    edge = radius + 12e-3
    return synthetic_field(
        ball(radius), low=(-edge,) * 3, high=(edge,) * 3, amplitude_spacing=2.5e-3, **overrides
    )


def thin_slab(thickness: float = 6e-3) -> ResponseField:
    """A slab that a fast stroke could pass through in one tick."""
    return synthetic_field(
        slab(thickness), low=(-15e-3, -15e-3, -16.5e-3), high=(15e-3, 15e-3, 16.5e-3), band=(-2.9e-3, 8e-3)
    )


def small_plane() -> ResponseField:
    """The plane in 5 kB, coarse: whole enough to be pressed, small enough for a fuzzer to change most of it."""
    return synthetic_field(
        low=(-12e-3, -12e-3, -8e-3), high=(12e-3, 12e-3, 12e-3), geometry_spacing=4e-3, amplitude_spacing=6e-3
    )


def tapped_plane() -> ResponseField:
    """The small plane with transients at three velocities, each 2 ms of 500 Hz."""
    time = np.arange(21) / 1e4
    velocity = np.array([0.05, 0.10, 0.20])
    force = np.stack([10.0 * v**1.2 * np.sin(2 * np.pi * 500.0 * time) * np.hanning(21) for v in velocity])
    force[:, [0, -1]] = 0.0
    return replace(small_plane(), layers={"transient": transient_layer(1e4, velocity, force)})


def patchy_texture() -> Texture:
    """A grating everywhere, and noise where x is small, by a mask that falls from 1 to 0 over 6 mm of x."""

    def share(q):
        return np.clip(0.5 - q[..., 0] / 6e-3, 0.0, 1.0)

    masks = spline_lattice(share, np.array([-15e-3] * 3), np.array([15e-3] * 3), 5e-3)
    masks = replace(masks, coefficients=np.clip(masks.coefficients, 0.0, 1.0).astype(np.float32))
    rough = replace(noise(6e-6, (300.0, 2500.0), 3, 8), mask=0)
    limits = DeviceLimits(10.0, 10.0, 10.0, 10e-6, 0.0, 0.0, 400.0)
    return Texture((grating(15e-6, 500.0, (0.6, 0.8, 0.0)), rough), 0.4e-3, 300.0, limits, masks)


def textured_plane() -> ResponseField:
    """The small plane with that texture."""
    return replace(small_plane(), layers={"texture": texture_bytes(patchy_texture())})


def three_ways(first: ResponseField | None = None) -> bytes:
    """`first` (the plane when absent), cooked for three tilts: upright; half as stiff and 0.2 mm shorter at cosine 0.8;
    three times as stiff and 0.5 mm shorter at 0.5."""
    first = first or synthetic_field()

    def scaled(factor: float, offset: float) -> ResponseField:
        coefficients = first.amplitudes.coefficients * [factor, factor, factor, 1]
        return replace(
            first,
            amplitudes=replace(first.amplitudes, coefficients=coefficients),
            tool=replace(first.tool, offset=offset),
        )

    return cook(first, [(0.8, scaled(0.5, 4.8e-3)), (0.5, scaled(3.0, 4.5e-3))])


FIELDS = {
    "plane": synthetic_field,
    "sphere": sphere_organ,
    "slab": thin_slab,
    "small": small_plane,
    "tapped": tapped_plane,
    "textured": textured_plane,
}

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in FIELDS.items():
        write_rfield(make(), folder / f"{name}.rfield")
    (folder / "tilted.rfield").write_bytes(three_ways())
