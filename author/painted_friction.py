# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The Coulomb coefficient between tool and tissue at a place: the paint's on a painted organ, else the tool's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.author.organ_stage import OrganMesh

__all__ = ["friction_at"]


def friction_at(
    effects: Sequence[str], friction: float | None, mesh: OrganMesh | None, points: np.ndarray
) -> np.ndarray | None:
    """(n,) at points (n, 3) m; None where the scene's `effects` leave friction out.

    Args:
        friction: of the tool; unused where the organ is painted.
    """
    if "friction" not in effects:
        return None
    painted = None if mesh is None else mesh.painted("friction", points)
    return np.full(len(points), friction or 0.0) if painted is None else painted
