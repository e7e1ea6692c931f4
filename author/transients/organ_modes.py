# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The modal sum of a scene's own organ: what its surface does under a tool when that arrives.

A tool of mass m that arrives at v hands over the momentum m v.  A mode of unit modal mass then moves as
q = (phi . n) m v sin(omega t) exp(-t / tau) / omega, the surface below the tool by (phi . n) q, and a tool that follows
takes m times that acceleration.  Without what damping changes of it,

    f(t) = v sum_i A_i sin(omega_i t) exp(-t / tau_i),   A_i = m^2 <(phi_i . n)^2> omega_i,   tau_i = 1 / (zeta omega_i)

(the modal sum of Wellman and Howe, 1995, with its amplitudes from the mesh).  <> is the mean over the reach's surface:
a field has one library, wherever it is tapped.  Limits: the tool's mass does not load the organ; one damping ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.organ_stage import OrganMesh
from palpate.author.scene import Scene
from palpate.fem_offline.vibration import vibration_modes

__all__ = ["OrganMode", "organ_modes"]


@dataclass(frozen=True)
class OrganMode:
    """Attributes: amplitude N s/m; frequency Hz; decay s."""

    amplitude: float
    frequency: float
    decay: float


def organ_modes(
    scene: Scene,
    mesh: OrganMesh,
    mass: float,
    damping_ratio: float,
    density: float = 1060.0,
    count: int = 8,
    free: bool = False,
) -> list[OrganMode]:
    """The `count` slowest modes of the organ as the scene holds it, or free.

    Args:
        mass: kg, of the tool; damping_ratio: share of critical damping, above 0 and below 1; density: kg/m3.

    Raises:
        InputError: a number is out of range, or nothing of the surface lies in the reach.
    """
    for key, value, most in (
        ("--mass", mass, 1e3),
        ("--damping-ratio", damping_ratio, 1.0),
        ("--density", density, 1e5),
        ("--count", count, 1000),
    ):
        if not 0.0 < value <= most:
            raise InputError(InputProblem("", key, value, "is not usable", f"above 0, at most {most:g}"))
    organ = mesh.organ
    faces = organ.faces
    corners = organ.points[faces]
    area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    centre = corners.mean(axis=1)
    reached = mesh.reachable(centre) & ~mesh.supported(centre)
    if scene.reach.is_given:
        reached &= scene.reach.contains(centre)
    if not reached.any():
        raise InputError(scene.problem("reach", None, "holds nothing of the surface", "a larger reach"))
    faces, area = faces[reached], area[reached]
    size = np.linalg.norm(area, axis=1)
    normal = area / size[:, None]
    try:
        modes = vibration_modes(organ, density, count, free)
    except ValueError as error:
        raise InputError(
            InputProblem("", "--count", count, f"asks for too much: {error}", "fewer")
        ) from error
    moved = np.einsum("ifcx,fx->ifc", modes.shape[:, faces], normal)
    square = np.einsum("ifc,f->i", moved**2, size) / (3.0 * size.sum())
    omega = 2.0 * np.pi * modes.frequency
    return [
        OrganMode(float(mass**2 * s * w), float(f), float(1.0 / (damping_ratio * w)))
        for s, w, f in zip(square, omega, modes.frequency, strict=True)
    ]
