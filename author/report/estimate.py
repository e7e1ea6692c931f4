# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How far off the field's normal force is estimated to be, everywhere on the reach: kriging's own expectation.

Held-out presses say how far off it is at a few places; between them this is what the nodes themselves let expect,

    DEVIATIONS c sigma(x),    sigma: fields/error_indicator.py,    c: what sampling's tests found (sampling_by_error.py)

an estimate and no measurement.  How many of the held-out errors stay below it is counted and shown beside it.
"""

from __future__ import annotations

import numpy as np

from palpate.author.report.maps import ReachMap
from palpate.fields.response_field import ResponseField

__all__ = ["DEVIATIONS", "ErrorEstimate", "error_estimate"]

DEVIATIONS = 2.0
"""Standard deviations shown; 95 of 100 errors stay below where the expectation is right and errors are normal."""
NORMAL_LENGTH = 20e-3
"""m, of the embedding, as `build_field` has it."""
AT_ONCE = 2000
"""Places at once (count): with N nodes each takes 24 N bytes."""


class ErrorEstimate:
    """The estimate of one field; raises ValueError where its nodes let nothing be expected (no pressed node)."""

    def __init__(self, field: ResponseField) -> None:
        from palpate.fields.site_curves import SiteCurves

        if not field.nodes.node_count or not field.nodes.pressed.any():
            raise ValueError(f"{field.tool.name}: none of its nodes was pressed")
        rounds = (field.provenance.get("sampling") or {}).get("rounds") or {}
        self.correction = float((rounds.get("correction") or [1.0])[-1])
        self._field = field
        self._sites = SiteCurves.from_nodes(field.nodes, field.geometry, field.tool.offset, NORMAL_LENGTH)

    def at(self, feet: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """(n,) fraction of force at contact points (n, 3) m with outward normals (n, 3)."""
        from palpate.fields.error_indicator import ErrorIndicator
        from palpate.fields.surface_curvature import shape_operator

        halfway = self._field.tool.offset - 0.5 * self._field.depth_max
        shape = shape_operator(self._field.geometry, feet + halfway * normals)
        parts = [slice(i, i + AT_ONCE) for i in range(0, len(feet), AT_ONCE)]
        found = [ErrorIndicator(self._sites, feet[p], normals[p], shape[p]).deviation for p in parts]
        return DEVIATIONS * self.correction * np.concatenate([np.zeros(0), *found])


def error_estimate(
    field: ResponseField, reach: ReachMap
) -> tuple[ErrorEstimate | None, np.ndarray | None, str]:
    """The estimate, its values (V,) at the reach's vertices, and "" or a sentence that says why there are none."""
    try:
        estimate = ErrorEstimate(field)
        return estimate, estimate.at(reach.feet, reach.normals), ""
    except (ValueError, np.linalg.LinAlgError) as error:
        return (
            None,
            None,
            f"{field.tool.name}: its error between held-out points could not be estimated: {error}.",
        )
