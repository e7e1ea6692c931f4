# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A known law comes back at places and depths that were never pressed; nothing moves without contact, or in steps."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
from known_deformation import DEPTHS, RADIUS, REACH, UP, known_deformation, moved, press_at
from pxr import Sdf

from palpate.fields.deformation import deform
from palpate.fields.deformation_fit import fit_deformation
from palpate.fields.deformation_layout import HEADER_DTYPE, deformation_bytes, layer_size, read_deformation
from palpate.fields.field_error import FieldError
from palpate.fields.usd_read import read_field
from palpate.fields.usd_validators import asset_errors
from palpate.fields.usd_write import write_asset

GRID = np.stack(
    [*(a.ravel() for a in np.meshgrid(*2 * [np.linspace(-20e-3, 20e-3, 41)])), np.zeros(1681)], axis=1
)


@pytest.mark.parametrize("depth", [0.4e-3, 1.1e-3, 3.7e-3])
def test_a_known_law_comes_back_between_the_presses(depth):
    c = np.array([3e-3, -4e-3, 0.0])
    near = GRID[np.linalg.norm(GRID - c, axis=1) < 0.6 * REACH]
    miss = deform(known_deformation(), near, c, UP, depth) - moved(near, c, depth)
    assert np.linalg.norm(miss, axis=1).max() < 0.03 * depth


def test_nothing_moves_without_depth_nor_beyond_the_radius():
    model, c = known_deformation(), np.zeros(3)
    assert not deform(model, GRID, c, UP, 0.0).any() and not deform(model, GRID, c, UP, -1e-3).any()
    far = c + np.array([[REACH, 0.0, 0.0], [0.0, 1.1 * REACH, 0.0]])
    assert not deform(model, far, c, UP, 4e-3).any()


def test_displacement_shrinks_with_the_depth_and_the_tools_step():
    model, c = known_deformation(), np.array([1e-3, 2e-3, 0.0])
    for depth in (1e-4, 1e-5, 1e-6):
        assert np.abs(deform(model, GRID, c, UP, depth)).max() < 1.5 * depth
    here = deform(model, GRID, c, UP, 2e-3)
    steps = [
        np.abs(deform(model, GRID, c + s * np.array([1.0, 0.5, 0.0]), UP, 2e-3 + s) - here).max()
        for s in (1e-4, 1e-5, 1e-6)
    ]
    assert steps[0] < 5e-4 and steps[1] < 0.2 * steps[0] and steps[2] < 0.2 * steps[1]


@pytest.mark.parametrize("depth", [0.5e-3, 2e-3, 4e-3, 6e-3])
def test_no_vertex_ends_inside_the_tool(depth):
    c = np.array([-8e-3, 1e-3, 0.0])  # where the law goes down by 0.84 of the depth
    free = GRID + deform(known_deformation(), GRID, c, UP, depth)
    kept = GRID + deform(known_deformation(), GRID, c, UP, depth, tip=c - depth * UP, axis=UP)
    middle = c + (RADIUS - depth) * UP
    inside = RADIUS - np.linalg.norm(free - middle, axis=1)
    assert inside.max() > 1e-5
    assert np.linalg.norm(kept - middle, axis=1).min() > RADIUS - 2e-6
    np.testing.assert_array_equal(kept[inside < -1e-6], free[inside < -1e-6])


def test_a_stuck_tool_drags_the_surface_along():
    model, c = known_deformation(), np.zeros(3)
    stretch = np.array([0.3e-3, -0.1e-3, 0.05e-3])
    dragged = deform(model, GRID, c, UP, 4e-3, stretch) - deform(model, GRID, c, UP, 4e-3)
    R = np.linalg.norm(GRID, axis=1)
    near = R < 0.6 * REACH
    law = (stretch * (1.0, 1.0, 0.0))[None] / (1.0 + (R / 7e-3) ** 2)[:, None]
    assert np.abs(dragged - law)[near].max() < 0.02 * np.linalg.norm(stretch)
    assert np.abs(dragged @ UP).max() < 1e-9


def test_the_layers_bytes_are_what_the_list_says_and_come_back():
    model = known_deformation()
    data = deformation_bytes(dataclasses.replace(model, error={"p95": 0.02, "max": 0.1}))
    assert layer_size(np.frombuffer(data, HEADER_DTYPE, 1)[0]) == len(data)
    again = read_deformation(data)
    assert again.ranks == model.ranks and again.error == {"p95": 0.02, "max": 0.1}
    assert deformation_bytes(again) == data
    for broken in (data[:-8], data + bytes(8), b"\0" * len(data), data[:100]):
        with pytest.raises(FieldError, match="deformation"):
            read_deformation(broken)
    with pytest.raises(FieldError, match="not finite"):
        deformation_bytes(dataclasses.replace(model, mean=np.full_like(model.mean, np.nan)))


def test_the_runtimes_header_is_that_of_the_list():
    text = (Path(__file__).parents[2] / "runtime_cpp/src/layers/deformation.h").read_text()
    for name, offset in re.findall(r"offsetof\(deformation_header, (\w+)\) == (\d+)", text):
        assert HEADER_DTYPE.fields[name][1] == int(offset), name
    assert f"sizeof(deformation_header) == {HEADER_DTYPE.itemsize}," in text


def test_an_asset_carries_it_only_where_it_was_asked_for(tmp_path, organ, make_field):
    plain = make_field()
    layered = dataclasses.replace(plain, layers={"deformation": deformation_bytes(known_deformation())})
    for field, there in ((plain, False), (layered, True)):
        folder = tmp_path / str(there)
        write_asset(folder, organ, field)
        assert read_field(folder, field.tool.name).layers == field.layers
        assert not list(asset_errors(next(folder.glob("*.usda"))))
        stored = Sdf.Layer.FindOrOpen(str(folder / "fields" / f"{field.tool.name}.usdc")).ExportToString()
        assert ("eformation" in stored) == there


def test_presses_at_other_depths_or_none_are_refused():
    with pytest.raises(FieldError, match="at least one"):
        fit_deformation([], 4e-3, REACH, known_deformation().gap)
    one = press_at(0.0, 0.0, 0)
    with pytest.raises(FieldError, match="one ladder"):
        fit_deformation(
            [one, dataclasses.replace(one, depth=DEPTHS * 1.1)], 4e-3, REACH, known_deformation().gap
        )
