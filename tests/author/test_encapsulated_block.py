# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The shipped scene with a capsule, springs, an Ogden tissue and a punch: planned, and pressed once."""

from __future__ import annotations

import numpy as np
import pytest

from palpate.assets import scene_path
from palpate.author import press_command
from palpate.author.plan import plan
from palpate.author.scene import load_scene

DEPTH = 0.5e-3


@pytest.fixture(scope="module")
def scene():
    return load_scene(scene_path("encapsulated_block"))


def test_the_plan_names_what_is_new(scene) -> None:
    result = plan(scene).result
    assert result["mesh"]["material"]["model"] == "ogden"
    assert result["mesh"]["capsule"]["thickness"] == pytest.approx(50e-6)
    assert result["tools"][0]["shape"] == "flat_punch"
    assert scene.organ.support[0].kind == "elastic"


def test_the_punch_presses_it(scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """The capsule makes it stiffer than Sneddon's punch on a bare half space, F = 2 E* a d, E* = 2 mu / (1 - nu)."""
    monkeypatch.setattr(press_command, "ladder", lambda depth: depth * np.array([0.5, 1.0]))
    result = press_command.press(scene, (0.0, 0.0, 0.03), "punch_6mm", DEPTH)
    assert result["converged"], result["reason"]
    assert max(result["reaction_error"]) < 1e-8
    assert result["tool"]["offset"] == 0.0
    bare = 2.0 * 2.0 * 1800.0 / (1.0 - 0.49) * 3e-3 * DEPTH
    assert bare < result["force"][-1] < 10.0 * bare
