# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A near-field press that cannot vouch for itself is done in full, and says so."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from palpate.author import press_solve
from palpate.author.press_jobs import PressJob
from palpate.author.tool_stage import ToolShape
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.verification.blocks import block_organ

BALL = ToolShape("sphere", (("radius", 3e-3),))
JOB = PressJob((2e-3, 1e-3, 0.0), BALL, (3e-4, 6e-4), "near_field")


@pytest.fixture(scope="module")
def mesh():
    organ = block_organ((0.08, 0.08, 0.03), (8, 8, 3), {0: NeoHookean(5400.0, 0.48)})
    return SimpleNamespace(hash="block", organ=organ)


@pytest.fixture(scope="module")
def near(mesh, tmp_path_factory):
    return press_solve.solve(mesh, JOB, str(tmp_path_factory.mktemp("near")))


def test_a_near_field_press_that_vouches_for_itself_stays_one(near):
    _, values = near
    assert values["converged"] and values["fidelity"] == "near_field" and values["tried"] == []
    assert 0.0 < values["estimate"] <= press_solve.VOUCHED


def test_one_that_cannot_gives_way_to_full(mesh, near, tmp_path, monkeypatch):
    monkeypatch.setattr(press_solve, "VOUCHED", 1e-9)
    arrays, values = press_solve.solve(mesh, JOB, str(tmp_path))
    assert values["converged"] and values["fidelity"] == "full" and values["estimate"] == 0.0
    assert values["tried"] == [
        {"fidelity": "near_field", "estimate": pytest.approx(near[1]["estimate"], rel=1e-6)}
    ]
    assert arrays["force_vector"][-1] == pytest.approx(near[0]["force_vector"][-1], rel=2e-3, abs=1e-6)


def test_a_patch_that_is_narrow_beside_the_tetrahedra_is_widened(mesh, near, tmp_path):
    """As it was asked for, the force is 10 % larger."""
    arrays, values = press_solve.solve(mesh, replace(JOB, patch_radius=8e-3), str(tmp_path))
    assert values["converged"] and values["fidelity"] == "near_field"
    assert arrays["force_vector"][-1] == pytest.approx(near[0]["force_vector"][-1], rel=5e-3, abs=1e-5)


def test_a_linear_press_has_no_estimate_and_no_way_out(mesh, near, tmp_path):
    arrays, values = press_solve.solve(
        mesh, PressJob(*[*(JOB.contact_point,), BALL, JOB.depths, "linear"]), str(tmp_path)
    )
    assert values["fidelity"] == "linear" and values["estimate"] is None and values["tried"] == []
    force, better = arrays["force_vector"][1:, 2], near[0]["force_vector"][1:, 2]
    assert force == pytest.approx(better, rel=0.05) and np.all(force != better)


def test_far_fields_are_kept_for_the_next_press(mesh, near, tmp_path):
    first = press_solve.solve(mesh, JOB, str(tmp_path))[1]
    beside = PressJob((3e-3, 1e-3, 0.0), ToolShape("sphere", (("radius", 2e-3),)), (3e-4,), "near_field")
    second = press_solve.solve(mesh, beside, str(tmp_path))[1]
    assert first["far_field_kept"] is False and second["far_field_kept"] is True


def test_far_fields_of_other_mechanics_are_made_anew(mesh, tmp_path, monkeypatch):
    assert press_solve.solve(mesh, JOB, str(tmp_path))[1]["far_field_kept"] is False
    monkeypatch.setattr(press_solve, "mechanics_version", lambda: "another")
    assert press_solve.solve(mesh, JOB, str(tmp_path))[1]["far_field_kept"] is False


def test_a_press_without_a_stiffness_gives_the_same_forces_and_solves_for_nothing_else(
    mesh, near, tmp_path, monkeypatch
):
    from palpate.fem_offline import press

    monkeypatch.setattr(press, "sticking_stiffness", None)
    monkeypatch.setattr(press, "friction_share", None)
    arrays, _ = press_solve.solve(mesh, replace(JOB, stiffness=False), str(tmp_path))
    for name in ("force_vector", "energy", "area"):
        assert arrays[name] == pytest.approx(near[0][name], rel=1e-6, abs=1e-12), name
    assert np.isnan(arrays["sticking_stiffness"][1:]).all() and np.isnan(arrays["friction_share"][1:]).all()
    assert np.isfinite(near[0]["sticking_stiffness"][-1]).all()
