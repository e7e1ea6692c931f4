# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Every device with a profile against one field: the rate that it needs, and how much it renders without a hum.

rate needed  r = 1 / (2 B / sigma),      sigma the field's largest stiffness             (certify.py, no delay)
"""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate.author.device_profiles import PROFILES
from palpate.author.haptic_device import HapticDevice
from palpate.author.report.device_map import share_without_hum, stiffness_allowed
from palpate.author.report.maps import ReachMap

__all__ = ["RATE", "device_rows"]

RATE = 1000.0
"""Hz; the loop that most devices' drivers run."""


def device_rows(
    sigma: np.ndarray, reach: ReachMap, stiffness_max: float, force_max: float
) -> list[dict[str, Any]]:
    """One row for each profile.

    Args:
        sigma: (V,) N/m, largest stiffness at the reach's vertices (device_map.py).
        stiffness_max: N/m, the field's own.
        force_max: N, the field's largest on the reach.
    """
    rows = []
    for profile in PROFILES:
        device = HapticDevice(profile.name, RATE, profile.damping, max_force=profile.max_force)
        allowed = stiffness_allowed(device)
        rows.append(
            {
                "name": profile.name,
                "damping": profile.damping,
                "stiffness_allowed": allowed,
                "rate_needed": 0.5 * stiffness_max / profile.damping,
                "met": bool(stiffness_max <= allowed),
                "share": share_without_hum(sigma, reach, allowed),
                "max_force": profile.max_force,
                "force_met": bool(force_max <= profile.max_force),
            }
        )
    return rows
