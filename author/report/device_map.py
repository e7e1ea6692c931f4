# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where on the reach a device renders a field without a hum.

At each place, over the depths of the reach's map,

    sigma = max over depths of |Hess U|_2 + k,    rendered without a hum where sigma <= allowed,
    allowed = min(B / (T / 2 + tau), 2 f_f / delta)                                        (certify.py)

so that every place is rendered well where the field's own largest stiffness is allowed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh

from palpate.author.haptic_device import HapticDevice
from palpate.author.report.maps import ReachMap
from palpate.fields.interpolation import energy_hessian, evaluate
from palpate.fields.response_field import ResponseField

__all__ = ["DeviceMap", "device_map", "largest_by_place", "share_without_hum", "stiffness_allowed"]


@dataclass(frozen=True)
class DeviceMap:
    """Attributes: sigma (V,) N/m at the reach's vertices; allowed N/m, infinite where nothing limits it; share of the
    reach's area (that the field stores) without a hum; None where there is none."""

    sigma: np.ndarray
    allowed: float
    share: float | None


def stiffness_allowed(device: HapticDevice) -> float:
    """N/m; the largest stiffness that the device holds without a hum at its rate."""
    by_damping = device.damping / (0.5 / device.rate + device.delay)
    return min(by_damping, 2.0 * device.friction / device.resolution if device.resolution else np.inf)


def device_map(
    ways: Sequence[ResponseField], reach: ReachMap, device: HapticDevice, sigma: np.ndarray | None = None
) -> DeviceMap:
    """Args: ways: the field, by every way of touching; the stiffest of them counts.  reach: of the first.  sigma: what
    `largest_by_place` gave, found when None."""
    sigma = largest_by_place(ways, reach) if sigma is None else sigma
    allowed = stiffness_allowed(device)
    return DeviceMap(sigma, allowed, share_without_hum(sigma, reach, allowed))


def largest_by_place(ways: Sequence[ResponseField], reach: ReachMap) -> np.ndarray:
    """(V,) N/m at the reach's vertices, over its depths and all `ways`; no device comes into it."""
    return np.max([_sigma(way, reach) for way in ways], axis=0)


def share_without_hum(sigma: np.ndarray, reach: ReachMap, allowed: float) -> float | None:
    """Share of the reach's area where sigma (V,) is at most `allowed`, N/m; None where there is no reach."""
    area = trimesh.triangles.area(reach.vertices[reach.triangles]) if len(reach.triangles) else np.zeros(0)
    good = (sigma <= allowed)[reach.triangles].mean(axis=1)
    return float(area @ good / area.sum()) if area.sum() > 0 else None


def _sigma(field: ResponseField, reach: ReachMap) -> np.ndarray:
    """(V,) N/m."""
    sigma = np.zeros(len(reach.vertices))
    for depth in reach.depths:
        q = reach.feet + (field.tool.offset - depth) * reach.normals
        bend = np.abs(np.linalg.eigvalsh(energy_hessian(field, q))).max(axis=1, initial=0.0)
        sigma = np.maximum(sigma, bend + evaluate(field, q).friction_stiffness)
    return sigma
