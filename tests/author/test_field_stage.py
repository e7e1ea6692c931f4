# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How fine a field is made: as coarse as its errors allow."""

from types import SimpleNamespace

import numpy as np
import pytest

from palpate.assets import scene_path
from palpate.author import field_stage
from palpate.author.field_stage import (
    AMPLITUDE_SPACINGS,
    GEOMETRY_ERROR,
    GEOMETRY_SPACINGS,
    REPRESENTATION_ERROR,
    SPACING_IN_DEPTHS,
    band_of,
    band_of_tool,
    coarsest_field,
    contact_geometry_of,
    is_fine_enough,
)
from palpate.author.press_jobs import PressJob
from palpate.author.scene import load_scene
from tests.author.stand_in_solvers import BALL, known_press


def losing(error: dict[float, float]):
    """A stand-in for building a field, which loses `error` (fraction of force) by spacing (m)."""
    return lambda spacing: SimpleNamespace(spacing=spacing, representation={"site_force_p95": error[spacing]})


def test_the_coarsest_lattice_that_is_near_enough_is_taken():
    coarse, middle, fine = AMPLITUDE_SPACINGS
    near, far = REPRESENTATION_ERROR, 1.01 * REPRESENTATION_ERROR
    assert coarsest_field(losing({coarse: near, middle: 0.0, fine: 0.0})).spacing == coarse
    assert coarsest_field(losing({coarse: far, middle: near, fine: 0.0})).spacing == middle


def test_the_one_that_loses_least_is_taken_where_none_is_near_enough():
    coarse, middle, fine = AMPLITUDE_SPACINGS
    assert coarsest_field(losing({coarse: 0.5, middle: 0.2, fine: 0.3})).spacing == middle


@pytest.mark.parametrize(("error", "taken"), [((0.9, 0.1), 0), ((1.1, 0.9), 1), ((1.2, 1.1), 1)])
def test_geometry_is_as_coarse_as_the_shallowest_tool_allows(monkeypatch, error, taken):
    scene = load_scene(scene_path("palpation_block"))
    allowed = GEOMETRY_ERROR * min(scene.depth_max(tool) for tool in scene.tool)
    asked = []

    def made(*_, spacing, **__):
        asked.append(spacing)
        return SimpleNamespace(
            error_p99=error[len(asked) - 1] * allowed, signed_distance=SimpleNamespace(spacing=spacing)
        )

    monkeypatch.setattr(field_stage, "contact_geometry", made)
    monkeypatch.setattr(field_stage, "rounded_geometry", lambda geometry: geometry)
    samples = SimpleNamespace(points=np.zeros((1, 3)), beyond=lambda mesh: None)
    contact_geometry_of(scene, SimpleNamespace(distance=None), samples)
    assert tuple(asked) == GEOMETRY_SPACINGS[: taken + 1]


def test_geometry_serves_no_tool_that_presses_less_deep_than_it_is_fine():
    coarse, finest = GEOMETRY_SPACINGS
    depth = coarse / SPACING_IN_DEPTHS

    def known(spacing, error):
        return SimpleNamespace(error_p99=error, signed_distance=SimpleNamespace(spacing=spacing))

    assert is_fine_enough(known(coarse, GEOMETRY_ERROR * depth), depth)
    assert not is_fine_enough(known(coarse, 0.0), 0.99 * depth)
    assert not is_fine_enough(known(coarse, 1.01 * GEOMETRY_ERROR * depth), depth)
    assert is_fine_enough(known(finest, 1.0), 0.1 * depth)  # none is finer


def test_the_scenes_band_holds_every_tools():
    scene = load_scene(scene_path("palpation_block"))
    low, high = band_of(scene)
    for tool in scene.tool:
        own = band_of_tool(scene, tool)
        assert low <= own[0] < own[1] <= high


def test_a_node_has_the_friction_that_is_felt_there():
    """Depths whose share was not found (every other one, and where a solve failed) are left to their neighbours."""
    outcome = known_arrays()
    depth = outcome["depth"]
    outcome["friction_share"] = np.where(np.arange(len(depth)) % 2 == 0, 1.0 + 50.0 * depth, np.nan)
    press = field_stage._arrays(SimpleNamespace(arrays=outcome, key="k"), 0.2)
    assert press.friction_coefficient[:, 0] == pytest.approx(depth[2::2])
    assert press.friction_coefficient[:, 1] == pytest.approx(0.2 * (1.0 + 50.0 * depth[2::2]))
    outcome["friction_share"] = 1.0 + 50.0 * depth * np.where(
        depth > 2.5e-3, -10.0, 1.0
    )  # the contact folds at 3 mm
    press = field_stage._arrays(SimpleNamespace(arrays=outcome, key="k"), 0.2)
    assert press.friction_coefficient == pytest.approx(np.array([[1e-3, 0.21], [2e-3, 0.22]]))
    outcome["friction_share"] = np.full(len(depth), np.nan)
    assert field_stage._arrays(SimpleNamespace(arrays=outcome, key="k"), 0.2).friction_coefficient == 0.2
    assert field_stage._arrays(SimpleNamespace(arrays=outcome, key="k"), None).friction_coefficient == 0.0


def known_arrays() -> dict[str, np.ndarray]:
    job = PressJob((0.0, 0.0, 0.0), BALL, (1e-3, 2e-3, 3e-3, 4e-3), "near_field")
    return known_press(job, 5e-3, 1.0, 0.0)[0]
