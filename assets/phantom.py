# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The phantoms that ship with palpate: their shapes, their tissue, and the files made of them.

Each phantom is a binary PLY in metres and, beside it, a JSON file that says where it comes from: the
generator and its parameters, what was measured on the mesh, and the tissue constants with their source.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate.assets import liver as liver_shape
from palpate.assets import palpation_block
from palpate.assets.surface_nets import surface_net

__all__ = ["PHANTOMS", "Phantom", "generate", "provenance", "surface", "write_ply"]

TABLE = "PMC6925591, Table 1"

# Published values of soft tissue scatter by a factor of 3 to 10: these are starting points, not truths.
LIVER_TISSUE = {
    "tissue": "healthy liver",
    "shear_modulus": {"value": 1800.0, "spread": 400.0, "unit": "Pa", "source": TABLE},
}
TUMOUR_TISSUE = {
    "tissue": "hepatocellular carcinoma",
    "shear_modulus": {"value": 23000.0, "unit": "Pa", "source": TABLE},
}


@dataclass(frozen=True)
class Phantom:
    """One generated surface.

    Attributes:
        name: stem of its files.
        title: one line for people.
        shape: (n, 3) m -> (n,) m, negative inside.
        box: (2, 3) m, holds the surface.
        spacing: m, of the generating grid; edges come out a tenth shorter.
        tissue: constants with their sources.
    """

    name: str
    title: str
    shape: Callable[[np.ndarray], np.ndarray]
    box: np.ndarray
    spacing: float
    tissue: dict


PHANTOMS = (
    Phantom(
        "liver_phantom",
        "A liver-like organ with two lobes, a thin left edge and a gallbladder bed",
        liver_shape.liver,
        liver_shape.BOX,
        4.0e-3,
        LIVER_TISSUE,
    ),
    Phantom(
        "palpation_block",
        "A block with rounded edges, 80 x 60 x 30 mm",
        palpation_block.block,
        palpation_block.BLOCK_BOX,
        2.5e-3,
        LIVER_TISSUE,
    ),
    Phantom(
        "nodule",
        "A stiff nodule, 18 x 14 x 12 mm, 6.5 mm under the top of the palpation block",
        palpation_block.nodule,
        palpation_block.NODULE_BOX,
        1.5e-3,
        TUMOUR_TISSUE,
    ),
)


def surface(phantom: Phantom) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) m and outward triangles (F, 3) int32 of a phantom, generated anew."""
    return surface_net(phantom.shape, phantom.box[0], phantom.box[1], phantom.spacing)


def provenance(phantom: Phantom, vertices: np.ndarray, triangles: np.ndarray) -> dict:
    """What the JSON file beside the mesh says."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    return {
        "name": phantom.name,
        "title": phantom.title,
        "license": "Apache-2.0",
        "origin": "generated from formulas by palpate.assets; no scan or third-party model is used",
        "generator": {
            "command": "python -m palpate.assets",
            "version": 1,
            "shape": f"{phantom.shape.__module__}.{phantom.shape.__name__}",
            "spacing": phantom.spacing,
            "box": phantom.box.tolist(),
        },
        "units": "m",
        "vertices": len(vertices),
        "triangles": len(triangles),
        "volume": round(float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0), 9),
        "area": round(float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()), 7),
        "extent": [round(float(e), 5) for e in np.ptp(vertices, axis=0)],
        "tissue": phantom.tissue,
    }


def write_ply(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Binary little-endian PLY, float32 vertices in m."""
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment made by palpate.assets, metres, Apache-2.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    path.write_bytes(header.encode("ascii") + vertices.astype("<f4").tobytes() + faces.tobytes())


def generate(folder: Path) -> list[Path]:
    """Writes all phantoms into `folder`; returns the files."""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for phantom in PHANTOMS:
        vertices, triangles = surface(phantom)
        mesh, facts = folder / f"{phantom.name}.ply", folder / f"{phantom.name}.json"
        write_ply(mesh, vertices, triangles)
        facts.write_text(json.dumps(provenance(phantom, vertices, triangles), indent=2) + "\n")
        files += [mesh, facts]
    return files
