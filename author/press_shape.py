# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The deformed patch of one press as a file that others open: VTU for analysis (ParaView), USD to look at.

VTU holds the quadratic tetrahedra at rest, so that "Warp by vector: displacement" shows the press at any scale;
USD holds the surface as it stands, with the displacement beside it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import PalpateError

__all__ = ["SHAPE_PREFIX", "shape_of", "write_usd", "write_vtu"]

SHAPE_PREFIX = "shape_"
FACE_PARTS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""The four flat triangles of a quadratic one: corners, then mid-edges (01)(12)(02)."""


def shape_of(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Fields of `fem_offline.deformed.DeformedPatch` from a press record's arrays.

    Raises:
        PalpateError: no state was reached that could be shown.
    """
    found = {
        name.removeprefix(SHAPE_PREFIX): array
        for name, array in arrays.items()
        if name.startswith(SHAPE_PREFIX)
    }
    if not found:
        raise PalpateError("the press reached no depth, so there is no deformed patch to show")
    return found


def write_vtu(path: Path, shape: dict[str, np.ndarray], about: dict[str, Any]) -> None:
    """Quadratic tetrahedra with displacement, contact pressure, region and volume ratio.

    Args:
        about: short facts (text or numbers) that go along as field data.
    """
    import pyvista

    tets = shape["tets"]  # VTK_QUADRATIC_TETRA orders nodes as quadratic_space.py does
    cells = np.column_stack([np.full(len(tets), tets.shape[1]), tets]).ravel()
    kinds = np.full(len(tets), pyvista.CellType.QUADRATIC_TETRA)
    grid = pyvista.UnstructuredGrid(cells, kinds, shape["nodes"])
    grid.point_data["displacement"] = shape["displacement"]
    grid.point_data["contact_pressure"] = shape["pressure"]
    grid.cell_data["region"] = shape["label"]
    grid.cell_data["volume_ratio"] = shape["volume_ratio"]
    for name, value in about.items():
        grid.field_data[name] = np.atleast_1d(value)
    _folder_of(path)
    grid.save(path)


def write_usd(
    path: Path,
    shape: dict[str, np.ndarray],
    about: dict[str, Any],
    tool: tuple[np.ndarray, np.ndarray] | None = None,
) -> None:
    """The patch's outer surface, deformed, coloured by how far it moved, and the tool where it stands.

    Args:
        about: facts that go along, JSON-clean.
        tool: vertices (V, 3) m in the organ's axes, triangles (G, 3).
    """
    from palpate.fields.usd_deformed import write_deformed

    faces = shape["faces"]
    triangles = faces[:, FACE_PARTS].reshape(-1, 3)
    used, triangles = np.unique(triangles, return_inverse=True)
    moved = shape["displacement"][used]
    _folder_of(path)
    write_deformed(
        path,
        shape["nodes"][used],
        triangles.reshape(-1, 3),
        moved,
        {"contact_pressure": (shape["pressure"][used], "Pa")},
        _colours(np.linalg.norm(moved, axis=1)),
        about,
        tool,
    )


def _colours(amount: np.ndarray) -> np.ndarray:
    """(n, 3) linear RGB in [0, 1]; viridis over amount (n,), 0 at its dark end."""
    from matplotlib import colormaps

    from palpate.author.report.palette import VALUES

    top = float(amount.max()) or 1.0
    srgb = colormaps[VALUES](amount / top)[:, :3]
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _folder_of(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
