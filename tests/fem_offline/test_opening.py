# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import trimesh

from palpate.fem_offline.errors import SurfaceError
from palpate.fem_offline.opening import opened
from palpate.fem_offline.smoothing import solid_volume
from palpate.fem_offline.surface_parts import is_closed


def test_opening_of_a_box_converges_to_rounded_edges():
    a, r = 0.03, 0.004
    box = trimesh.creation.box((a, a, a))
    inner = a - 2 * r
    exact = inner**3 + 6 * inner**2 * r + 3 * inner * np.pi * r**2 + 4 / 3 * np.pi * r**3
    error = []
    for spacing in (0.001, 0.0005):
        vertices, triangles = opened(np.array(box.vertices), np.array(box.faces), r, spacing)
        assert is_closed(triangles)
        assert np.abs(np.abs(vertices).max() - a / 2) < 1e-8  # flat faces stay
        error.append(abs(solid_volume(vertices, triangles) / exact - 1.0))
    assert error[1] < 0.012 and error[1] < error[0] / 3


def test_opening_takes_off_what_is_thinner_than_twice_the_radius():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.02)
    fin = trimesh.creation.box((0.03, 0.001, 0.02))
    fin.apply_translation((0.02, 0.0, 0.0))
    for solid in (ball, fin):
        assert solid.is_watertight
    both = trimesh.util.concatenate([ball, fin])  # sign by winding number: overlapping is no harm
    vertices, _ = opened(np.array(both.vertices), np.array(both.faces), 0.002, 0.001)
    assert np.linalg.norm(vertices, axis=1).max() < 0.0205


def test_membrane_without_a_body_is_refused():
    sheet = trimesh.creation.box((0.05, 0.05, 0.001))
    with pytest.raises(SurfaceError, match="thicker than 4 mm"):
        opened(np.array(sheet.vertices), np.array(sheet.faces), 0.002, 0.001)
