# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh

from palpate.fem_offline.surface_parts import SurfacePart

ORGANS = Path(os.environ.get("PALPATE_ORGANS", Path(__file__).parents[3] / "shared" / "organs"))


@pytest.fixture(scope="session")
def organ_file():
    """Path of a real organ's file; skips where the organs are absent."""

    def find(name: str) -> Path:
        if not (ORGANS / name).is_file():
            pytest.skip(f"the real organ {name} is absent; PALPATE_ORGANS names the folder that holds it")
        return ORGANS / name

    return find


@pytest.fixture(scope="session")
def ball() -> SurfacePart:
    """A sphere of 30 mm radius in 1,280 triangles, named ball."""
    return part(trimesh.creation.icosphere(subdivisions=3, radius=0.03), "ball")


def part(mesh: trimesh.Trimesh, name: str = "part") -> SurfacePart:
    return SurfacePart(name, np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))


@pytest.fixture(scope="session")
def as_part():
    return part
