# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The runtime's deformation is the reference's, number by number; without the effect nothing of it is there."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import synthetic_field
from known_deformation import RADIUS, REACH, known_deformation
from scipy.spatial.transform import Rotation

from palpate.fields.cook import cook
from palpate.fields.deformation import contact_of, deform
from palpate.fields.deformation_layout import HEADER_DTYPE, deformation_bytes, read_deformation
from palpate.fields.rfield_read import read_header, read_rfield
from palpate.runtime import Field, RuntimeFailure, Session, deformation, deformation_info

ROUNDED = 2e-9
"""m; vertices and displacements are floats."""
RNG = np.random.default_rng(3)
VERTICES = np.concatenate(
    [RNG.uniform((-20e-3, -20e-3, -2e-3), (20e-3, 20e-3, 0.5e-3), (400, 3)), [[0.0, 0.0, 0.0]]]
).astype(np.float32)


def with_layer(data: bytes) -> bytes:
    return cook(dataclasses.replace(synthetic_field.small_plane(), layers={"deformation": data}))


@pytest.fixture(scope="module")
def cooked() -> bytes:
    return with_layer(deformation_bytes(known_deformation()))


@pytest.fixture(scope="module")
def field(cooked) -> Field:
    return Field.open(cooked)


def reference(cooked: bytes, q, anchor=None, offset: float = 0.0) -> np.ndarray:
    known = read_rfield(cooked)
    model = read_deformation(known.layers["deformation"])
    c, n, depth, tip, axis = contact_of(known, np.asarray(q), anchor)
    stretch = None if anchor is None else q - anchor
    return deform(model, VERTICES.astype(float), c, n, depth - offset, stretch, tip, axis)


@pytest.mark.parametrize("depth", [-1e-3, 1e-5, 0.7e-3, 3.3e-3, 4.6e-3])
@pytest.mark.parametrize("drag", [None, (0.2e-3, -0.4e-3, 0.1e-3)])
def test_the_runtime_agrees_with_the_reference(field, cooked, depth, drag):
    for x, y in RNG.uniform(-5e-3, 5e-3, (5, 2)):
        q = np.array([x, y, RADIUS - depth])
        anchor = None if drag is None else q - drag
        found, result = deformation(field, q, VERTICES, anchor)
        expected = reference(cooked, q, anchor)
        assert np.abs(found - expected).max() < ROUNDED
        near = np.linalg.norm(VERTICES - result["contact_point"], axis=1) < result["radius"]
        assert result["moved_count"] == np.count_nonzero(near) and not expected[~near].any()
        assert result["depth"] == pytest.approx(max(depth, 0.0), abs=1e-6)


def test_a_yielded_surface_is_pressed_less(field, cooked):
    q = np.array([1e-3, 0.0, RADIUS - 3e-3])
    assert (
        np.abs(
            deformation(field, q, VERTICES, surface_offset=1e-3)[0] - reference(cooked, q, None, 1e-3)
        ).max()
        < ROUNDED
    )
    assert not deformation(field, q, VERTICES, surface_offset=3.1e-3)[0].any()


def test_only_the_vertices_asked_for_are_looked_at(field):
    q = np.array([0.0, 0.0, RADIUS - 3e-3])
    whole, _ = deformation(field, q, VERTICES)
    some = np.array([400, 3, 17])
    part, result = deformation(field, q, VERTICES, indices=some)
    np.testing.assert_array_equal(part[some], whole[some])
    assert not np.delete(part, some, axis=0).any() and result["moved_count"] <= 3
    near = np.linalg.norm(VERTICES - result["contact_point"], axis=1) < result["radius"]
    assert not whole[~near].any() and result["radius"] == REACH


def test_an_organs_pose_moves_the_tool_and_not_the_mesh(field):
    q, anchor = np.array([1e-3, 2e-3, RADIUS - 2e-3]), np.array([0.9e-3, 2.2e-3, RADIUS - 2e-3])
    turn, shift = Rotation.from_rotvec([0.3, -0.5, 1.1]), np.array([0.2, -0.1, 0.4])
    world = turn.apply(np.stack([q, anchor])) + shift
    posed, _ = deformation(field, world[0], VERTICES, world[1], pose=(shift, turn.as_quat()))
    assert np.abs(posed - deformation(field, q, VERTICES, anchor)[0]).max() < ROUNDED


def test_what_is_no_place_moves_nothing(field):
    for q in ([np.nan, 0, 0], [np.inf, 0, 0], [1e9, 0, 0], [0.0, 0.0, 0.5]):
        found, result = deformation(field, np.array(q, float), VERTICES)
        assert not found.any() and result["moved_count"] == 0


def test_a_session_and_the_picture_go_together(field):
    session = Session(field)
    seen = []
    for depth in np.linspace(-0.5e-3, 3e-3, 36):
        response = session.tick([0.0, 0.0, RADIUS - depth], dt=1e-3)
        moved, _ = deformation(
            field, response["reference_point"], VERTICES, response["anchor"], response["surface_offset"]
        )
        seen.append(moved[400, 2])
    assert seen[0] == 0.0 and np.all(np.diff(seen) <= 1e-9) and seen[-1] == pytest.approx(-3e-3, rel=0.1)
    assert np.abs(np.diff(seen)).max() < 3e-4


def test_what_was_judged_is_told(cooked):
    error = {"p95": 0.02, "max": 0.09, "p95_m": 5e-5, "max_m": 2e-4, "within": 15e-3}
    info = deformation_info(
        Field.open(with_layer(deformation_bytes(dataclasses.replace(known_deformation(), error=error))))
    )
    assert (info.error_p95, info.error_max, info.error_within) == (0.02, 0.09, 15e-3)
    assert deformation_info(Field.open(cooked)).error_p95 == -1.0


def test_without_the_effect_there_are_no_bytes_and_no_answer():
    plain = cook(synthetic_field.small_plane())
    assert not read_header(plain)["layer_size"].any() and read_rfield(plain).layers == {}
    for ask in (deformation_info, lambda field: deformation(field, np.zeros(3), VERTICES)):
        with pytest.raises(RuntimeFailure) as failure:
            ask(Field.open(plain))
        assert failure.value.status == 12  # PALPATE_LAYER_MISSING


@pytest.mark.parametrize(
    ("name", "value"),
    [("magic", 1), ("version", 2), ("rank", 9), ("node_count", 0), ("node_count", 2**31), ("radial_count", 65),
     ("depth_count", 2), ("gap_count", 1), ("depth_end", 0.0), ("scale", np.nan), ("length", -1.0), ("error", np.inf)],
)  # fmt: skip
def test_a_layer_that_contradicts_itself_is_refused(name, value):
    data = deformation_bytes(known_deformation())
    header = np.frombuffer(data[: HEADER_DTYPE.itemsize], HEADER_DTYPE)[0].copy()
    header[name] = value
    with pytest.raises(RuntimeFailure, match="deformation"):
        Field.open(with_layer(header.tobytes() + data[HEADER_DTYPE.itemsize :]))


def test_numbers_that_are_none_are_refused():
    data = bytearray(deformation_bytes(known_deformation()))
    data[-12:-8] = np.float32(np.nan).tobytes()
    with pytest.raises(RuntimeFailure, match="not finite"):
        Field.open(with_layer(bytes(data)))
    with pytest.raises(RuntimeFailure, match="deformation"):
        Field.open(with_layer(bytes(data)[:-8]))
