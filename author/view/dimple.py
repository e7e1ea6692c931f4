# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The dimple under the tool: what the runtime's effect `deformation` says of the drawn surface, outside the servo."""

from __future__ import annotations

import numpy as np

from palpate.author.view.viewed import ViewedTool
from palpate.runtime.deformation import deformation, deformation_info
from palpate.runtime.library import RuntimeFailure

__all__ = ["Dimple"]

SEEN = 20e-6
"""m; a surface that moved less than that since it was drawn is not drawn anew."""


class Dimple:
    """Of one tool.  Attributes: there: its field has the effect; words: a sentence for people."""

    def __init__(self, tool: ViewedTool):
        self._tool = tool
        self._drawn = np.zeros_like(tool.reach.vertices)
        try:
            info = deformation_info(tool.runtime)
        except RuntimeFailure:
            self.there = False
            self.words = 'drawn at rest: the scene did not ask for the effect "deformation"'
            return
        self.there = True
        judged = f", off by {100 * info.error_p95:.2g} % of the depth (p95)" if info.error_p95 >= 0.0 else ""
        self.words = f"moves as the field says{judged}"

    def moved(self, response: np.void, contact: bool) -> np.ndarray:
        """(V, 3) m; displacement of the reach's vertices in a tick's last response."""
        rest = self._tool.reach.vertices
        if not (self.there and contact):
            return np.zeros_like(rest)
        return deformation(
            self._tool.runtime,
            response["reference_point"],
            rest,
            anchor=response["anchor"],
            surface_offset=float(response["surface_offset"]),
        )[0].astype(float)

    def at_rest(self) -> None:
        """The surface was drawn anew, without its dimple."""
        self._drawn = np.zeros_like(self._tool.reach.vertices)

    def to_draw(self, response: np.void, contact: bool) -> np.ndarray | None:
        """As `moved`; None where what was drawn last still looks the same."""
        now = self.moved(response, contact)
        if not now.size or np.abs(now - self._drawn).max() < SEEN:
            return None
        self._drawn = now
        return now
