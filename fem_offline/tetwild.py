# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""fTetWild in a process of its own: it writes a file into its working folder, and may run for very long.

Hu et al., Fast Tetrahedral Meshing in the Wild, SIGGRAPH 2020.  It is not deterministic, not even on one
thread (measured: 3,938 to 3,942 tets of the same sphere in four runs), so a mesh is made once, kept, and
known by its hash.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from palpate.fem_offline.errors import MeshError

__all__ = ["fill"]


def fill(
    vertices: np.ndarray, triangles: np.ndarray, edge: float, envelope: float, time_limit: float
) -> tuple[np.ndarray, np.ndarray]:
    """Points (P, 3) m and tetrahedra (T, 4) int32, as fTetWild orients them (negatively).

    vertices (V, 3) m, triangles (F, 3); edge m; envelope m, how far the boundary may leave the surface;
    time_limit s.

    Raises:
        MeshError: it fails, or needs longer than `time_limit`.
    """
    with tempfile.TemporaryDirectory(prefix="palpate-tetwild-") as folder:
        surface, mesh = Path(folder, "surface.npz"), Path(folder, "mesh.npz")
        np.savez(surface, vertices=vertices, triangles=triangles, edge=edge, envelope=envelope)
        command = [sys.executable, "-c", f"from {__name__} import _fill; _fill()"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=time_limit)
        except subprocess.TimeoutExpired:
            raise MeshError(
                f"fTetWild needs more than {time_limit:.0f} s", "tetrahedra", "a larger mesh_size"
            ) from None
        if done.returncode or not mesh.is_file():
            last = (done.stderr.strip() or f"exit code {done.returncode}").splitlines()[-1]
            raise MeshError(
                f"fTetWild failed ({last})", "tetrahedra", "a larger mesh_size, or another repair"
            )
        with np.load(mesh) as arrays:
            return arrays["points"].astype(float), arrays["tets"].astype(np.int32)


def _fill() -> None:
    """The other process: surface.npz in, mesh.npz out, in the working folder."""
    import pytetwild

    with np.load("surface.npz") as given:
        vertices, triangles = given["vertices"], given["triangles"].astype(np.int32)
        edge, envelope = float(given["edge"]), float(given["envelope"])
    diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    points, tets = pytetwild.tetrahedralize(
        vertices, triangles, edge_length_abs=edge, epsilon=envelope / diagonal, num_threads=1
    )
    np.savez("mesh.npz", points=points, tets=tets)
