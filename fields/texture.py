# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A small height that enters depth inside U: texture as a part of the potential.

After V. Hayward, Physically-Based Haptic Synthesis (2008), section 5.  At the tool's reference point q and depth d

    h(q) = sum_c m_c(q) sum_i a_i cos(2 pi (k_i . q + p_i))
    s = d + w(d) h(q),   w(d) = t^2 (3 - 2 t),  t = min(1, d / fade_depth)
    U(q) = sum_r phi_r(s) a_r(q),   grad s = -(1 + w' h) grad phi + w grad h

The waves are plane waves in space: along a surface that leans by an angle against k, k shrinks by its cosine.  The foot
point on the surface is no coordinate for them: its derivative holds the second derivatives of phi, which jump between
the lattice's cells, and force would jump with them.  With |h| <= HEIGHT_SHARE fade_depth, ds/dd >= 5/8: energy still
rises with depth and contact begins where it did.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from palpate.fields.field_error import FieldError
from palpate.fields.lattice import Lattice
from palpate.fields.lattice_stencil import sample_lattice

__all__ = [
    "HEIGHT_SHARE",
    "MASK_LIMIT",
    "WAVE_LIMIT",
    "DeviceLimits",
    "Texture",
    "Waves",
    "grating",
    "joined",
    "noise",
    "profile",
]

WAVE_LIMIT = 16
"""Waves of a texture; those of one mask come in groups of four."""
MASK_LIMIT = 4
LEAST_SHARE = 1e-5
"""Of a profile's largest harmonic; what is less is its file's rounding."""
HEIGHT_SHARE = 0.25
"""Largest sum of amplitudes over the depth in which they fade."""


@dataclass(frozen=True)
class DeviceLimits:
    """What a device can render, Hayward's table 1; 0 is not known, and no limit.

    Attributes:
        time_factor, space_factor, force_factor: safety factors alpha, beta, gamma.
        resolution: delta, m; of position.  force_resolution: b, N.
        stiffness_max: A_0, N/m.  structural_frequency: F_0, Hz.
    """

    time_factor: float = 0.0
    space_factor: float = 0.0
    force_factor: float = 0.0
    resolution: float = 0.0
    force_resolution: float = 0.0
    stiffness_max: float = 0.0
    structural_frequency: float = 0.0


@dataclass(frozen=True)
class Waves:
    """Plane waves.

    Attributes:
        vector: (n, 3) 1/m; cycles a metre along each axis.
        phase: (n,) cycles.
        amplitude: (n,) m, >= 0.
        mask: row of the texture's masks that scales them; -1: none.
    """

    vector: np.ndarray
    phase: np.ndarray
    amplitude: np.ndarray
    mask: int = -1

    @property
    def spatial_frequency(self) -> np.ndarray:
        """(n,) 1/m."""
        return np.linalg.norm(self.vector, axis=1)

    def height(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) m and its gradient (n, 3) at `points` (n, 3) m."""
        angle = 2.0 * np.pi * (np.asarray(points, float) @ self.vector.T + self.phase)
        rise = -2.0 * np.pi * self.amplitude * np.sin(angle)
        return np.cos(angle) @ self.amplitude, rise @ self.vector


@dataclass(frozen=True)
class Texture:
    """What the layer `texture` holds.

    Attributes:
        waves: by mask.
        fade_depth: m.
        stiffness: N/m; largest of the response, by which a height becomes a force along the normal.
        normal_force: N; largest of the response, by which a slope becomes a force along the surface; 0: not known.
        limits: of the device that it was made for.
        masks: lattice of up to MASK_LIMIT channels, 0 to 1, whose absent blocks are 0; or None.
    """

    waves: tuple[Waves, ...]
    fade_depth: float
    stiffness: float = 0.0
    limits: DeviceLimits = field(default_factory=DeviceLimits)
    masks: Lattice | None = None
    normal_force: float = 0.0

    def __post_init__(self) -> None:
        if not self.waves or sum(-(-len(w.phase) // 4) for w in self.waves) > WAVE_LIMIT // 4:
            raise FieldError(f"texture: 1 to {WAVE_LIMIT} waves are right, in groups of four of one mask")
        if not 0.0 < self.height_max <= HEIGHT_SHARE * self.fade_depth * (1.0 + 1e-9):
            raise FieldError(
                f"texture: heights up to {self.height_max:g} m fade over {self.fade_depth:g} m; "
                f"at least {self.height_max / HEIGHT_SHARE:g} m is right"
            )

    @property
    def height_max(self) -> float:
        """m; no height is larger."""
        return float(sum(w.amplitude.sum() for w in self.waves))

    def force_amplitude(self, waves: Waves, normal_force: float | None = None) -> np.ndarray:
        """(n,) N; what a tool that crosses each wave feels of it, at `normal_force` (N), the texture's own when None.

        U(s) with s = d + h gives U' dh / dx = 2 pi k F_n a along the wave and U'' a along the normal, a quarter of a
        wavelength apart: the larger one counts.  Less where h still fades or where k leans out of the surface.
        """
        force = self.normal_force if normal_force is None else normal_force
        return waves.amplitude * np.maximum(self.stiffness, 2.0 * np.pi * waves.spatial_frequency * force)

    def slopes(self) -> tuple[float, float]:
        """Largest |grad h| and largest |Hess h| (1/m), where every wave is at its steepest at once."""
        first = second = 0.0
        for w in self.waves:
            k = 2.0 * np.pi * w.spatial_frequency
            first += float(np.sum(w.amplitude * k))
            second += float(np.sum(w.amplitude * k * k))
            if w.mask >= 0 and self.masks is not None:
                height, slope = float(w.amplitude.sum()), float(np.sum(w.amplitude * k))
                m1, m2 = _mask_slopes(self.masks, w.mask)
                first += height * m1
                second += 2.0 * slope * m1 + height * m2
        return first, second

    def height(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """h (n,) m and grad h (n, 3) at `points` (n, 3) m."""
        h, dh = np.zeros(len(points)), np.zeros((len(points), 3))
        masks = None if self.masks is None else sample_lattice(self.masks, points)
        for w in self.waves:
            one, slope = w.height(points)
            if w.mask >= 0:
                assert masks is not None
                m, dm = masks.value[:, w.mask], masks.gradient[:, w.mask]
                one, slope = m * one, m[:, None] * slope + dm * one[:, None]
            h, dh = h + one, dh + slope
        return h, dh

    def fade(self, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """w and w' (1/m) at depths (n,) m."""
        t = np.clip(depth / self.fade_depth, 0.0, 1.0)
        return t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / self.fade_depth


def grating(amplitude: float, spatial_frequency: float, direction: Sequence[float]) -> Waves:
    """One wave of `amplitude` m and `spatial_frequency` 1/m along `direction`, highest at the origin."""
    return Waves(spatial_frequency * _unit(direction)[None], np.zeros(1), np.array([amplitude]))


def noise(
    rms: float,
    band: tuple[float, float],
    seed: int,
    count: int = 8,
    directions: Sequence[Sequence[float]] = ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
) -> Waves:
    """`count` seeded plane waves of equal amplitude, spatial frequencies (1/m) even in the logarithm over `band`.

    Args:
        rms: m; root mean square of the height.
        directions: what the wave vectors are spread over: two for a sheet, three for a solid.
    """
    random = np.random.default_rng(seed)
    low, high = band
    share = (np.arange(count) + random.uniform(0.0, 1.0, count)) / count
    frequency = low * (high / low) ** share
    basis = np.linalg.qr(np.array(directions, float).T)[0].T
    towards = random.normal(size=(count, len(basis))) @ basis
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    amplitude = np.full(count, rms * np.sqrt(2.0 / count))
    return Waves(frequency[:, None] * towards, random.uniform(0.0, 1.0, count), amplitude)


def profile(
    position: np.ndarray,
    height: np.ndarray,
    direction: Sequence[float],
    count: int = 8,
    band: tuple[float, float] = (0.0, np.inf),
) -> tuple[Waves, float]:
    """A measured height profile, repeated end to end along `direction`, as its strongest `count` harmonics.

    Args:
        position: (n,) m, evenly rising; the period is n steps.  height: (n,) m; its mean is taken away.
        band: 1/m; harmonics outside are left out.

    Returns:
        The waves, and the share of the profile's mean square that they leave out.

    Raises:
        FieldError: positions that are not even, too few of them, or nothing in the band.
    """
    position, height = np.asarray(position, float), np.asarray(height, float)
    if position.ndim != 1 or position.shape != height.shape or len(position) < 4:
        raise FieldError("texture: a profile has at least 4 positions and as many heights")
    if not (np.isfinite(position).all() and np.isfinite(height).all()):
        raise FieldError("texture: a profile has numbers that are not finite")
    step = (position[-1] - position[0]) / (len(position) - 1)
    if not step > 0 or np.max(abs(np.diff(position) - step)) > 1e-3 * step:
        raise FieldError("texture: a profile's positions rise by even steps")
    c = np.fft.rfft(height - height.mean()) / len(height)
    frequency = np.fft.rfftfreq(len(height), step)
    amplitude = 2.0 * abs(c)
    if len(height) % 2 == 0:
        amplitude[-1] = 0.0  # the last harmonic has no phase of its own
    inside = (frequency > 0) & (frequency >= band[0]) & (frequency <= band[1])
    order = np.argsort(-np.where(inside, amplitude, 0.0), kind="stable")[:count]
    order = np.sort(order[np.where(inside, amplitude, 0.0)[order] > LEAST_SHARE * amplitude.max()])
    if not len(order):
        raise FieldError("texture: a profile has no height in its band")
    power = float(np.mean((height - height.mean()) ** 2))
    phase = np.angle(c[order]) / (2.0 * np.pi) - frequency[order] * position[0]
    left = 1.0 - float(np.sum(amplitude[order] ** 2)) / 2.0 / power
    return Waves(frequency[order, None] * _unit(direction), np.mod(phase, 1.0), amplitude[order]), max(
        0.0, left
    )


def joined(waves: Sequence[Waves]) -> tuple[Waves, ...]:
    """Those of one mask together, so that they fill groups."""
    found = []
    for mask in sorted({w.mask for w in waves}):
        same = [w for w in waves if w.mask == mask]
        found.append(
            Waves(
                *(np.concatenate([getattr(w, n) for w in same]) for n in ("vector", "phase", "amplitude")),
                mask,
            )
        )
    return tuple(found)


def _unit(direction: Sequence[float]) -> np.ndarray:
    d = np.asarray(direction, float)
    length = np.linalg.norm(d)
    if d.shape != (3,) or not length > 0:
        raise FieldError(f"texture: {list(direction)} is no direction")
    return d / length


def _mask_slopes(masks: Lattice, channel: int) -> tuple[float, float]:
    """Bounds of |grad m| (1/m) and |Hess m| (1/m2): derivatives of a quadratic B-spline are means of differences."""
    from palpate.fields.lattice import BLOCK_EDGE

    shape = BLOCK_EDGE * np.array(masks.block_index.shape)
    dense = np.zeros(shape)
    for place in np.argwhere(masks.block_index >= 0):
        low = BLOCK_EDGE * place
        block = masks.coefficients[masks.block_index[tuple(place)], ..., channel]
        dense[tuple(slice(a, a + BLOCK_EDGE) for a in low)] = block
    dense = np.pad(dense, 2)
    first = [np.max(abs(np.diff(dense, axis=a))) for a in range(3)]
    second = [np.max(abs(np.diff(np.diff(dense, axis=a), axis=b))) for a in range(3) for b in range(3)]
    return (
        float(np.linalg.norm(first)) / masks.spacing,
        float(np.linalg.norm(second)) / masks.spacing**2,
    )
