# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A small organ (a box of tets) and random fields of the right shapes, for tests of assets."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from palpate.fields.lattice import Lattice
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.response_field import (
    ContactGeometry,
    DepthCurves,
    ResponseField,
    ResponseNodes,
    ToolReference,
)


def box_organ(name: str = "block") -> OrganGeometry:
    """Two cubes of 2 cm, five tets each, held at z = 0, a stiff region at one end."""
    points = (
        np.array([(x, y, z) for x in range(3) for y in range(2) for z in range(2)], float) * 0.02 + 1e-3 / 3
    )
    even = [(0, 4, 6, 5), (0, 6, 2, 3), (0, 5, 3, 1), (6, 5, 7, 3), (0, 5, 6, 3)]
    mirror = {0: 4, 1: 5, 2: 6, 3: 7, 4: 0, 5: 1, 6: 2, 7: 3}
    odd = [tuple(mirror[i] for i in tet) for tet in even]
    tets = np.array([*even, *[tuple(i + 4 for i in tet) for tet in odd]], np.int32)
    a, b, c, d = (points[tets[:, k]] for k in range(4))
    wrong = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    tets[wrong] = tets[wrong][:, [0, 2, 1, 3]]
    faces = tets[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
    _, inverse, count = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True)
    triangles = np.ascontiguousarray(faces[count[inverse.reshape(-1)] == 1])
    height = points[triangles][:, :, 2]
    return OrganGeometry(
        name=name,
        vertices=points.copy(),
        triangles=triangles,
        tet_points=points,
        tet_indices=tets,
        supports=(
            Support(
                "bench",
                np.nonzero(points[:, 2] < 0.01)[0].astype(np.int32),
                np.nonzero((height < 0.01).all(axis=1))[0].astype(np.int32),
            ),
            Support("left end", np.array([0, 1], np.int32), kind="elastic", stiffness=2e6 / 3),
        ),
        region_names=("tissue", "stiff nodule"),
        region_label=np.array([0] * 7 + [1] * 3, np.int32),
        reach_triangles=np.nonzero((height > 0.01).all(axis=1))[0].astype(np.int32),
        material={
            "model": "ogden",
            "mu": [1800.0],
            "alpha": [6.0],
            "poissons_ratio": 0.49,
            "density": 1060.0,
        },
        region_materials={
            "stiff nodule": {"model": "neo_hookean", "youngs_modulus": 4e4, "poissons_ratio": 0.45}
        },
        provenance={"source": "made by the tests", "seed": 1},
    )


def random_contact(seed: int = 0) -> ContactGeometry:
    rng = np.random.default_rng(seed)
    index = np.array([[[0, -1], [1, -2]], [[-3, 2], [-1, -1]]], np.int32)
    lattice = Lattice(rng.normal(size=3), 0.0015, index, rng.normal(size=(3, 4, 4, 4, 1)) * 1e-3)
    return ContactGeometry(lattice, np.array([-1e-3, 7e-3]), 1.8e-5, 0.01)


def random_field(
    tool: str = "ball_5mm", seed: int = 0, node_count: int = 7, knot_count: int = 5, radius: float = 0.005
) -> ResponseField:
    rng = np.random.default_rng(seed)
    n, k = node_count, knot_count
    normal = rng.normal(size=(n, 3)) + np.array([0.0, 0.0, 3.0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)

    def curve(*shape: int) -> np.ndarray:
        values = rng.random(shape)
        values[:, 0] = 0.0
        return values

    def shared(count: int) -> DepthCurves:
        coefficients = rng.normal(size=(count, 6, 4))
        coefficients[:, 0, :2] = 0.0
        return DepthCurves(0.005, coefficients)

    pressed = rng.random(n) < 0.7
    nodes = ResponseNodes(
        position=rng.random((n, 3)) * (0.04, 0.02, 0.0) + (0.0, 0.0, 0.02),
        normal=normal,
        depth_knots=np.cumsum([0.0, *(rng.random(k - 1) * 1e-3 + 1e-4)]),
        stored_energy=curve(n, k),
        normal_force=curve(n, k),
        lateral_gradient=curve(n, k, 3),
        friction_stiffness=rng.random((n, k)) * 300,
        friction_coefficient=rng.random((n, k)),
        depth_reached=rng.random(n),
        pressed=pressed,
        residual=rng.random(n),
        press_hash=np.array(
            [hashlib.sha256(str(i).encode()).hexdigest() if p else "" for i, p in enumerate(pressed)]
        ),
    )
    energy, stiffness, friction = shared(3), shared(2), shared(1)
    amplitudes = Lattice(
        rng.normal(size=3), 0.004, np.array([[[0, 1], [-1, -3]]], np.int32), rng.normal(size=(2, 4, 4, 4, 6))
    )
    return ResponseField(
        tool=ToolReference(
            tool, "sphere", radius, {"radius": radius}, hashlib.sha256(tool.encode()).hexdigest()
        ),
        geometry=random_contact(),
        nodes=nodes,
        energy_curves=energy,
        stiffness_curves=stiffness,
        friction_curves=friction,
        amplitudes=amplitudes,
        depth_max=0.005,
        representation={"force_p95": 0.012 / 7, "force_max": 0.04},
        provenance={
            "mesh": "ab12",
            "solver": {"tolerance": 1e-9, "steps": [1, 2]},
            "seed": 3,
            "note": "Größe",
        },
    )


@pytest.fixture
def organ() -> OrganGeometry:
    return box_organ()


@pytest.fixture
def make_field() -> Callable[..., ResponseField]:
    return random_field


@pytest.fixture
def make_organ() -> Callable[..., OrganGeometry]:
    return box_organ


@pytest.fixture
def asset(tmp_path: Path, organ: OrganGeometry) -> Path:
    """Interface layer of an asset with the tools ball_2mm and ball_5mm."""
    from palpate.fields.usd_write import add_tool, write_asset

    path = write_asset(tmp_path / "asset", organ, random_field("ball_5mm"))
    add_tool(tmp_path / "asset", random_field("ball_2mm", seed=3, radius=0.002))
    return path
