# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The modal sum of a scene's organ: the frequencies of its mesh, amplitudes by the tool's momentum, into the scene."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from palpate.author.errors import InputError
from palpate.author.organ_stage import OrganMesh
from palpate.author.scene import load_scene
from palpate.author.transients.organ_modes import organ_modes
from palpate.author.transients.transient_stage import transients_of
from palpate.fem_offline.block import block
from palpate.fem_offline.organ import boundary_faces
from palpate.fields.transient_layout import read_transient_layer

SIZE = (0.10, 0.08, 0.04)


def meshed(path: Path) -> OrganMesh:
    """The block that the scenes of these tests name, without a mesher."""
    scene, mesh = load_scene(path), block(SIZE, (5, 4, 3))
    points = mesh.points + np.array([0.0, 0.0, SIZE[2]])
    return OrganMesh(
        points, boundary_faces(mesh.tets), points, mesh.tets, "block", scene.organ.material, scene.organ.support,
        (), {}, "0" * 64,
    )  # fmt: skip


def test_a_held_block_shears_and_its_amplitudes_follow_the_tool(write_scene: Callable[..., Path]) -> None:
    path = write_scene()
    mesh, scene = meshed(path), load_scene(path)
    light, heavy = (organ_modes(scene, mesh, mass, 0.1, count=5) for mass in (0.02, 0.06))
    shear = np.sqrt(1800.0 / 1060.0) / (
        4.0 * SIZE[2]
    )  # Hz; a quarter wave over the height, were it infinitely wide
    assert 0.75 * shear < light[0].frequency < shear
    for a, b in zip(light, heavy, strict=True):
        assert b.amplitude == pytest.approx(9.0 * a.amplitude) and a.amplitude > 0.0
        assert a.decay == pytest.approx(1.0 / (0.1 * 2.0 * np.pi * a.frequency))
    free = organ_modes(scene, mesh, 0.02, 0.1, count=3, free=True)
    assert free[0].frequency > 1.0 and free[0].frequency != light[0].frequency


def test_they_go_into_the_scene_as_they_are(write_scene: Callable[..., Path]) -> None:
    found = organ_modes(load_scene(write_scene()), meshed(write_scene()), 0.05, 0.1, count=3)
    rows = ", ".join(
        f'{{ amplitude = {m.amplitude}, frequency = "{m.frequency} Hz", decay = "{m.decay} s" }}'
        for m in found
    )
    table = f'[tool.transient]\nshape = "modal"\nduration = "0.2 s"\nmode = [{rows}]\n'
    scene = load_scene(
        write_scene(table, ('name = "block"', 'name = "block"\neffects = ["response", "transient"]'))
    )
    made = transients_of(scene, scene.tool[0])
    assert made is not None
    layer = read_transient_layer(made[0])
    t = 0.05
    expected = 0.5 * sum(
        m.amplitude * np.sin(2 * np.pi * m.frequency * t) * np.exp(-t / m.decay) for m in found
    )
    assert layer.force[1, 500] == pytest.approx(expected, rel=1e-4)


def test_numbers_out_of_range_and_an_empty_reach_are_refused(write_scene: Callable[..., Path]) -> None:
    path = write_scene()
    mesh, scene = meshed(path), load_scene(path)
    for arguments, words in (
        ((-1.0, 0.1), "--mass"),
        ((float("inf"), 0.1), "--mass"),
        ((0.05, 1.5), "--damping-ratio"),
    ):
        with pytest.raises(InputError, match=words):
            organ_modes(scene, mesh, *arguments)
    with pytest.raises(InputError, match="--count"):
        organ_modes(scene, meshed(path), 0.05, 0.1, density=1e3, count=10**9)
    away = load_scene(write_scene("[reach]\nsphere = { center = [1, 1, 1], radius = 0.01 }"))
    with pytest.raises(InputError, match="nothing of the surface"):
        organ_modes(away, mesh, 0.05, 0.1)
