# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A tool dragged over a field's strongest wave at constant speed, through the runtime: force over time and its line.

A wave of spatial frequency k that a tool meets at the speed v along the wave's direction gives a force of frequency
f = k v (Hayward 2008, section 5).  The path keeps its depth; along a surface that leans against the wave its speed in
space is larger than v.  What the texture adds is the difference from a session whose waves are all silenced.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.author.report.known_surface import known_surface
from palpate.author.texture.rendered import fastest
from palpate.fields.rfield_read import read_rfield
from palpate.fields.texture_layout import read_texture

__all__ = ["Drag", "drag"]

SPEED, RATE = 20e-3, 1000.0
"""m/s and Hz; slower where the field's limits would fade the wave, never above half of what they allow."""
WAVELENGTHS, LEAST = 16, 4
"""So long a drag, and the shortest whose line can be told (count)."""
PADDING = 64
"""A spectrum's points over the drag's: its line is found between the points of the transform."""
SILENT = 1e9
"""N; a force resolution that leaves no wave."""
CONTACT = 2
"""palpate_region of a point in contact."""


@dataclass(frozen=True)
class Drag:
    """Of n ticks.

    Attributes:
        time: (n,) s.
        force, plain: (n,) N along the drag, with the texture and without.
        frequency, spectrum: (m,) Hz and N; amplitude of what the texture adds along the drag.
        wavelength: m.  speed: m/s along the wave.  depth: m.
        normal_force: N, mean of the drag without the texture.
        judged: N, the force amplitude that table 1 would be asked about there (Texture.force_amplitude).
    """

    time: np.ndarray
    force: np.ndarray
    plain: np.ndarray
    frequency: np.ndarray
    spectrum: np.ndarray
    wavelength: float
    speed: float
    depth: float
    normal_force: float
    judged: float

    @property
    def expected(self) -> float:
        """k v, Hz."""
        return self.speed / self.wavelength

    @property
    def line(self) -> float:
        """Where the spectrum is largest, Hz."""
        return float(self.frequency[np.argmax(self.spectrum)])

    def told(self) -> dict[str, Any]:
        """Numbers for JSON."""
        return {
            "wavelength": self.wavelength,
            "speed": self.speed,
            "depth": self.depth,
            "expected": self.expected,
            "line": self.line,
            "line_error": self.line / self.expected - 1.0,
            "amplitude": float(self.spectrum.max()),
            "normal_force": self.normal_force,
            "judged": self.judged,
        }


def drag(rfield: bytes) -> Drag | None:
    """None where the field has no texture, or no room for a drag across its strongest wave."""
    from palpate.runtime import Config, Field, Session, TextureLimits

    read = read_rfield(rfield)
    if "texture" not in read.layers:
        return None
    texture = read_texture(read.layers["texture"])
    waves = max(texture.waves, key=lambda one: one.amplitude.max())
    strongest = int(np.argmax(waves.amplitude))
    vector = waves.vector[strongest]
    k = float(np.linalg.norm(vector))
    if k == 0.0:
        return None
    limit = fastest(texture.limits, 1.0 / RATE, k)[0]
    speed = SPEED if limit is None else min(SPEED, 0.5 * limit)
    field = Field.open(rfield)
    depth = max(0.5 * read.depth_max, min(2.0 * texture.fade_depth, read.depth_max))
    path, normal = _path(field, _begin(read, texture, waves.mask), vector / k, WAVELENGTHS / k, depth)
    steps = speed / RATE
    ahead = path @ vector / k
    if ahead[-1] - ahead[0] < LEAST / k:
        return None
    way = np.arange(ahead[0], ahead[-1], steps)
    points = np.column_stack([np.interp(way, ahead, path[:, axis]) for axis in range(3)])
    points, normals = _at_depth(field, points, depth)
    felt = []
    for limits in (None, TextureLimits(force_factor=1.0, force_resolution=SILENT)):
        session = Session(field, Config(friction_coefficient=0.0))
        session.set_texture_limits(limits)
        out = points[0] + (depth + 0.5e-3) * normal
        down = np.linspace(out, points[0], 1000)
        session.tick_batch(down, dt=1.0 / RATE)
        felt.append(session.tick_batch(points, dt=1.0 / RATE)["force"])
    normal_force = float(np.mean(np.sum(felt[1] * normals, axis=1)))
    along = points[-1] - points[0]
    force, plain = (one @ along / np.linalg.norm(along) for one in felt)
    added = force - plain
    count = len(points)
    window = np.hanning(count)
    window /= 0.5 * window.sum()
    return Drag(
        time=np.arange(count) / RATE,
        force=force,
        plain=plain,
        frequency=np.fft.rfftfreq(PADDING * count, 1.0 / RATE),
        spectrum=abs(np.fft.rfft((added - added.mean()) * window, PADDING * count)),
        wavelength=1.0 / k,
        speed=speed,
        depth=depth,
        normal_force=normal_force,
        judged=float(texture.force_amplitude(waves, normal_force)[strongest]),
    )


def _begin(read: Any, texture: Any, mask: int) -> np.ndarray:
    """(3,) m on the organ's surface: the middle of the reach, or where the wave's mask is largest."""
    surface = known_surface(read)
    reach = surface.vertices[np.unique(surface.triangles[surface.reach_triangles])]
    if not len(reach):
        reach = surface.vertices
    middle = np.linalg.norm(reach - reach.mean(axis=0), axis=1)
    if mask < 0 or texture.masks is None:
        return reach[np.argmin(middle)]
    from palpate.fields.lattice_stencil import sample_lattice

    share = sample_lattice(texture.masks, reach).value[:, mask]
    return reach[np.argmin(middle - 10.0 * np.ptp(middle) * (share > 0.9 * share.max()))]


def _path(
    field: Any, begin: np.ndarray, direction: np.ndarray, length: float, depth: float
) -> tuple[np.ndarray, np.ndarray]:
    """Reference points (n, 3) m in contact whose progress along `direction` rises, and the normal (3,) at `begin`."""
    _, normal = _at_depth(field, begin[None], depth)
    along = direction - (direction @ normal[0]) * normal[0]
    size = float(np.linalg.norm(along))
    if size < 0.2:
        return begin[None], normal[0]
    count = 401
    share = np.linspace(-0.5, 0.5, count)
    points, _ = _at_depth(field, begin + length * share[:, None] * along / size, depth)
    found = field.sample(points)
    ahead = points @ direction
    good = (found["region"] == CONTACT) & (abs(found["depth"] - depth) < 0.02 * depth)
    good[1:] &= np.diff(ahead) > 0.0
    middle = count // 2
    low = middle - int(np.argmin(np.append(good[middle::-1], False))) + 1
    high = middle + int(np.argmin(np.append(good[middle:], False)))
    return (points[low:high] if high > low else begin[None]), normal[0]


def _at_depth(field: Any, points: np.ndarray, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """`points` (n, 3) m moved along the gradient of the distance until they are `depth` deep, and normals there."""
    moved = np.array(points, float)
    normal = np.zeros_like(moved)
    for _ in range(8):
        found = field.sample(moved)
        normal = found["normal"]
        moved = moved + (found["depth"] - depth)[:, None] * normal
    return moved, normal
