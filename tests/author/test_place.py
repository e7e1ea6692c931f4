# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Places answer what lies in them; the closed surface agrees with the closed form that it approximates."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from palpate.author.place import Box, HalfSpace, Place, Sphere

POINTS = np.random.default_rng(3).uniform(-1.0, 1.0, (2000, 3))


def test_a_box_holds_what_lies_between_its_corners() -> None:
    place = Place(box=Box(min=(-0.5, -1.0, 0.0), max=(0.5, 1.0, 0.25)))
    expected = (np.abs(POINTS[:, 0]) <= 0.5) & (POINTS[:, 2] >= 0.0) & (POINTS[:, 2] <= 0.25)
    assert np.array_equal(place.contains(POINTS), expected)


def test_the_border_belongs_to_the_place() -> None:
    corner = np.array([[0.5, 1.0, 0.25]])
    assert Place(box=Box(min=(0, 0, 0), max=(0.5, 1.0, 0.25))).contains(corner).all()
    assert Place(sphere=Sphere(center=(0, 0, 0), radius=1.0)).contains(np.eye(3)).all()
    assert Place(half_space=HalfSpace(point=(0, 0, 0.25), normal=(0, 0, 1))).contains(corner).all()


def test_a_half_space_holds_what_its_normal_points_away_from() -> None:
    place = Place(half_space=HalfSpace(point=(0.0, 0.0, 0.1), normal=(0.0, 0.0, 5.0)))
    assert np.array_equal(place.contains(POINTS), POINTS[:, 2] <= 0.1)


def test_a_place_that_is_not_given_is_everywhere() -> None:
    assert not Place().is_given
    assert Place().contains(POINTS).all()


@pytest.mark.parametrize("inverted", [False, True])
def test_a_closed_surface_agrees_with_the_ball_it_approximates(inverted: bool, tmp_path: Path) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=0.6)
    if inverted:
        mesh.invert()
    mesh.export(tmp_path / "ball.stl")
    radius = np.linalg.norm(POINTS, axis=1)
    clear = np.abs(radius - 0.6) > 0.005  # the facets of an icosphere sag by less than this
    found = Place(surface=tmp_path / "ball.stl").contains(POINTS)
    assert np.array_equal(found[clear], radius[clear] < 0.6)


def test_an_open_surface_is_refused(tmp_path: Path) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=1)
    mesh.update_faces(np.arange(len(mesh.faces)) > 0)
    mesh.export(tmp_path / "open.stl")
    with pytest.raises(ValueError, match="not a closed surface"):
        Place(surface=tmp_path / "open.stl").contains(POINTS)
