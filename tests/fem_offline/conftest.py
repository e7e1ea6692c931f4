# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.membrane import Capsule
from palpate.fem_offline.surface_parts import SurfacePart
from palpate.fem_offline.verification.blocks import block_organ

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


@pytest.fixture(scope="session", params=["bonded", "covered, on springs", "covered, on both"])
def supported_block(request):
    """Bonded below; or covered, on springs that vary over the right half's surface; or both, bonded on the left."""
    block = block_organ((0.05, 0.05, 0.03), (5, 5, 3), {0: NeoHookean(5400.0, 0.48)})
    if request.param == "bonded":
        return block
    block = replace(
        block,
        capsule=Capsule(1e-4, NeoHookean(5.4e5, 0.4)),
        elastic=lambda x: np.where(x[:, 0] > 4e-3, 2e5 * (1.0 + x[:, 1] / 0.1), 0.0),
    )
    if request.param == "covered, on springs":
        return replace(block, held=lambda x: np.zeros(len(x), bool))
    bonded = block.held
    return replace(block, held=lambda x: bonded(x) & (x[:, 0] < -3e-3))
