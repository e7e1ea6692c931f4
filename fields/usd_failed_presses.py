# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses that failed or stopped early, as points of a tool's layer: what stands near them is not what was asked for.

/<organ>/Response/FailedPresses     Points with PalpateFailedPressesAPI; absent where every press reached its depth

The field's own record of them is provenance["failed_presses"]: contact_point (3,) m, reason, hash.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf

from palpate.fields.usd_layer import author, author_schema, child
from palpate.fields.usd_organ import point_attributes

__all__ = ["author_failed_presses"]

FAILED = (0.90, 0.05, 0.05)
"""Preview colour, linear RGB."""
WIDTH = 2e-3
"""m, of a previewed point."""


def author_failed_presses(layer: Sdf.Layer, failed: list[dict[str, Any]]) -> None:
    """Adds the presses to the layer of a tool; nothing where there are none."""
    if not failed:
        return
    prim = child(layer.GetPrimAtPath(f"/{layer.defaultPrim}/Response"), "FailedPresses", "Points")
    points = np.array([one["contact_point"] for one in failed], float).reshape(-1, 3)
    point_attributes(prim, points, WIDTH)
    author(prim, "widths", "float[]", np.full(len(points), WIDTH), interpolation="vertex")
    author(prim, "primvars:displayColor", "color3f[]", [FAILED], interpolation="constant")
    values = {name: [one[name] for one in failed] for name in ("reason", "hash")}
    author_schema(prim, "PalpateFailedPressesAPI", values)
