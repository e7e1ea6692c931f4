# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The picture of a press draws whatever a press may have found: dragging, moves aside, a stop on the way."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.author import press_solve
from palpate.author.press_jobs import PressJob
from palpate.author.press_picture import press_picture
from palpate.author.tool_stage import ToolShape
from palpate.fem_offline import dragging

DEPTHS = np.array([0.5e-3, 1.0e-3])


def drag_record(reason: str = "") -> dragging.DragRecord:
    """Friction of 0.1 that grows with depth; the deeper drag ends without an answer where there is a reason."""
    effective = np.array([[0.10], [np.nan if reason else 0.11]])
    path = dragging.DragPath(
        5e-4, np.eye(3)[0], np.zeros(2), np.zeros((2, 3)), np.zeros(2), np.zeros(2), np.zeros(2),
        1e-9, 1e-10, 1e-3, np.bool_(True),
    )  # fmt: skip
    one_way = np.stack([effective - 0.01, effective + 0.01], axis=2)
    return dragging.DragRecord(
        np.zeros(3), np.eye(3)[2], 0.1, DEPTHS, np.eye(3)[:1], effective, one_way, (path,) * 4,
        False, 0.1, reason == "", reason, 10, 1.0,
    )  # fmt: skip


def dragged(monkeypatch: pytest.MonkeyPatch, reason: str = "") -> dict[str, Any]:
    monkeypatch.setattr(dragging, "drag", lambda *a, **k: drag_record(reason))
    ball = ToolShape("sphere", (("radius", 5e-3),))
    job = PressJob((0, 0, 0), ball, tuple(DEPTHS), "full", friction=0.1, drag=tuple(DEPTHS))
    return press_solve._dragged(None, None, job, lambda depth: None)


def result(**more: Any) -> dict[str, Any]:
    depth = np.linspace(0.0, 1e-3, 5)
    force = np.outer(depth**1.5 * 1e3, [0.01, 0.0, 1.0])
    return {
        "scene": "block", "tool": {"name": "ball", "shape": "sphere", "parameters": {"radius": 5e-3}},
        "material": {"model": "neo_hookean", "shear_modulus": 1800.0},
        "contact_point": np.zeros(3), "normal": np.eye(3)[2], "tangents": np.eye(3)[:2],
        "depth_asked": 1e-3, "depth": depth, "force": force[:, 2], "force_vector": force,
        "energy": depth**2.5, "area": depth * 1e-2, "penetration": depth * 1e-3,
        "reaction_error": np.full(5, 1e-10), "residual": 1e-10, "work_mismatch": 1e-3,
        "lateral": [], "drag": None, "converged": True, "reason": "", "fidelity": "full",
        "unknowns": 100, "seconds": 1.0, **more,
    }  # fmt: skip


MOVE = {
    "depth": 1e-3,
    "deflection": [[0.0, 0.0, 0.0], [1e-4, 0.0, 0.0]],
    "force_vector": [[0.0, 0.0, 1.0], [-0.1, 0.0, 1.0]],
}


@pytest.mark.parametrize("reason", ["", "dragging along [1 0 0] at 1.00 mm: the force was not steady"])
def test_what_dragging_found_is_json_and_is_drawn(
    reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drag = dragged(monkeypatch, reason)
    assert json.loads(json.dumps(drag, allow_nan=False)) == drag
    assert drag["friction"] == [0.1, None if reason else 0.11]
    assert drag["paths"][0]["steady"] is True
    press_picture(tmp_path / "a.png", result(drag=drag, lateral=[MOVE]))
    assert (tmp_path / "a.png").stat().st_size > 20_000


@pytest.mark.parametrize("states", [1, 3])
def test_a_press_that_stopped_is_drawn_as_far_as_it_came(states: int, tmp_path: Path) -> None:
    found = result(converged=False, reason="stopped before 0.75 mm: the Hessian is not positive definite")
    for name in ("depth", "force", "force_vector", "energy", "area", "penetration", "reaction_error"):
        found[name] = found[name][:states]
    press_picture(tmp_path / "a.png", found)
    assert (tmp_path / "a.png").stat().st_size > 20_000
