# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""All that is found once over the reach of one field, for page and pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.author.haptic_device import HapticDevice
from palpate.author.report.device_map import DeviceMap, device_map, largest_by_place
from palpate.author.report.estimate import ErrorEstimate, error_estimate
from palpate.author.report.maps import TRIANGLES, ReachMap, reach_map
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ResponseField

__all__ = ["OnReach", "on_reach"]

ALL_TOOLS = 2 * TRIANGLES
"""Triangles shown for the reaches of all tools together (count), so that pages of many tools stay small."""
FEWEST = 3000
"""Triangles of a reach that are shown however many tools there are (count)."""


@dataclass(frozen=True)
class OnReach:
    """Attributes: map; sigma (V,) N/m, the largest stiffness; estimate and error (V,) fraction, or None with
    `estimate_missing` saying why; device: what the scene's device does, or None."""

    map: ReachMap
    sigma: np.ndarray
    estimate: ErrorEstimate | None
    error: np.ndarray | None
    estimate_missing: str
    device: DeviceMap | None


def on_reach(
    organ: OrganGeometry, field: ResponseField, device: HapticDevice | None, tool_count: int = 1
) -> OnReach:
    """Of `field`, one of `tool_count` in a report."""
    shown = reach_map(organ, field, max(FEWEST, min(TRIANGLES, ALL_TOOLS // tool_count)))
    sigma = largest_by_place(field.fields_by_way(), shown)
    estimate, error, missing = error_estimate(field, shown)
    held = device_map(field.fields_by_way(), shown, device, sigma) if device else None
    return OnReach(shown, sigma, estimate, error, missing, held)
