# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The cooked file: deterministic, small, and the same field as before up to half a micrometre and float32."""

import dataclasses

import numpy as np
import pytest
from rfield_evaluation import evaluate
from synthetic_field import DEPTH_MAX, RADIUS, ball, sphere_organ, synthetic_field

from palpate.fields.cook import CookError, cook, write_rfield
from palpate.fields.largest_stiffness import largest_stiffness
from palpate.fields.rfield_layout import SECTION_ALIGNMENT
from palpate.fields.rfield_read import RFieldError, read_header, read_rfield


@pytest.fixture(scope="module")
def field():
    return synthetic_field()


@pytest.fixture(scope="module")
def data(field):
    return cook(field)


def test_cooking_twice_gives_the_same_bytes(field, data):
    shuffled = dataclasses.replace(field, provenance=dict(reversed(field.provenance.items())))
    assert cook(shuffled) == data


def test_sections_are_aligned_and_inside_the_file(data):
    header = read_header(data)
    assert header["file_size"] == len(data)
    assert np.all(header["section_offset"] % SECTION_ALIGNMENT == 0)
    ends = header["section_offset"] + header["section_elements"] * header["section_element_size"]
    assert np.all(ends[:-1] <= header["section_offset"][1:]) and ends[-1] == len(data)


def test_geometry_is_kept_to_half_a_micrometre(field, data):
    back = read_rfield(data)
    difference = back.geometry.signed_distance.coefficients - field.geometry.signed_distance.coefficients
    assert np.abs(difference).max() <= 0.5e-6
    assert np.array_equal(
        back.geometry.signed_distance.block_index, field.geometry.signed_distance.block_index
    )


def test_curves_are_kept_exactly_and_amplitudes_as_float32(field, data):
    back = read_rfield(data)
    for name in ("energy_curves", "stiffness_curves", "friction_curves"):
        assert np.array_equal(getattr(back, name).coefficients, getattr(field, name).coefficients)
        assert getattr(back, name).depth_end == getattr(field, name).depth_end
    q = np.random.default_rng(1).uniform((-8e-3, -8e-3, 1e-3), (15e-3, 8e-3, 5e-3), (500, 3))
    before, after = evaluate(field, q), evaluate(back, q)
    assert np.abs(after.energy - before.energy).max() < 1e-3 * before.energy.max()
    assert back.provenance == field.provenance and back.tool.name == field.tool.name


def test_force_changes_by_cooking_less_than_a_thousandth(field, data):
    q = np.random.default_rng(2).uniform((-8e-3, -8e-3, 0.5e-3), (15e-3, 8e-3, 3e-3), (500, 3))
    before, after = evaluate(field, q).gradient, evaluate(read_rfield(data), q).gradient
    error = np.linalg.norm(after - before, axis=1) / np.linalg.norm(before, axis=1)
    assert error.max() < 1e-3


def test_blocks_without_amplitude_are_not_stored():
    everywhere = synthetic_field()
    nowhere = synthetic_field(amplitude=lambda q: np.where(q[..., 0] < 0, 1.0, 0.0))
    assert (
        read_header(cook(nowhere))["amplitude_stored"] < read_header(cook(everywhere))["amplitude_stored"] + 1
    )


def test_150_square_centimetres_fit_into_a_megabyte():
    radius = np.sqrt(150e-4 / (4 * np.pi))
    edge = radius + 14e-3
    field = synthetic_field(
        ball(radius), low=(-edge,) * 3, high=(edge,) * 3, amplitude_spacing=4e-3, band=(-1.5e-3, 7e-3)
    )
    assert len(cook(field)) < 1e6


def test_largest_stiffness_bounds_finite_differences_of_the_force_and_is_not_loose(field):
    rng = np.random.default_rng(3)
    q = rng.uniform((-10e-3, -8e-3, RADIUS - DEPTH_MAX), (15e-3, 8e-3, RADIUS), (4000, 3))
    h = 1e-6
    hessian = np.stack(
        [
            (evaluate(field, q + h * e).gradient - evaluate(field, q - h * e).gradient) / (2 * h)
            for e in np.eye(3)
        ],
        axis=1,
    )
    found = np.linalg.norm(hessian, 2, axis=(1, 2)) + evaluate(field, q).friction_stiffness
    sigma = largest_stiffness(field)
    assert found.max() <= sigma <= 1.3 * found.max()


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (lambda f: {"depth_max": -1e-3}, "depth_max"),
        (lambda f: {"depth_max": np.nan}, "depth_max"),
        (lambda f: {"tool": dataclasses.replace(f.tool, name="x" * 64)}, "tool_name"),
        (lambda f: {"stiffness_curves": f.energy_curves}, "amplitudes"),
    ],
)
def test_what_cannot_be_cooked_is_refused_with_its_key(field, change, key):
    with pytest.raises(CookError) as refusal:
        cook(dataclasses.replace(field, **change(field)))
    assert refusal.value.key == key


def test_a_coefficient_that_is_not_a_number_is_refused(field):
    bad = field.amplitudes.coefficients.copy()
    bad[0, 0, 0, 0, 0] = np.nan
    lattice = dataclasses.replace(field.amplitudes, coefficients=bad)
    with pytest.raises(CookError, match="amplitudes"):
        cook(dataclasses.replace(field, amplitudes=lattice))


def test_geometry_too_wide_for_int16_is_refused(field):
    wide = field.geometry.signed_distance.coefficients.copy()
    wide[0, 0, 0, 0, 0] = 1.0
    lattice = dataclasses.replace(field.geometry.signed_distance, coefficients=wide)
    with pytest.raises(CookError, match=r"0\.065 m"):
        cook(
            dataclasses.replace(field, geometry=dataclasses.replace(field.geometry, signed_distance=lattice))
        )


def test_a_failed_write_leaves_the_old_file(tmp_path, field, data):
    path = tmp_path / "tool.rfield"
    write_rfield(field, path)
    with pytest.raises(CookError):
        write_rfield(dataclasses.replace(field, depth_max=-1.0), path)
    assert path.read_bytes() == data
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("spoil", [lambda d: d[:100], lambda d: d[:-1], lambda d: b"x" + d[1:],
                                   lambda d: d[:-5] + b"?" + d[-4:]])  # fmt: skip
def test_the_reader_refuses_damage(data, spoil):
    with pytest.raises(RFieldError):
        read_rfield(spoil(data))


def test_an_organ_without_friction_cooks_without_its_curves():
    field = sphere_organ(20e-3)
    none = dataclasses.replace(field.stiffness_curves, coefficients=np.zeros((0, 1, 4)))
    lattice = dataclasses.replace(field.amplitudes, coefficients=field.amplitudes.coefficients[..., :2])
    bare = dataclasses.replace(field, stiffness_curves=none, friction_curves=none, amplitudes=lattice)
    header = read_header(cook(bare))
    assert header["channel_stride"] == 4 and header["stiffness_curve_count"] == 0


def test_layers_lie_behind_the_sections_and_come_back(field, data):
    carried = {"deformation": b"four", "rigid": bytes(range(70))}
    layered = cook(dataclasses.replace(field, layers=carried))
    assert read_rfield(layered).layers == carried
    assert read_rfield(data).layers == {}
    header = read_header(layered)
    placed = header["layer_offset"] > 0
    assert np.all(header["layer_offset"] % SECTION_ALIGNMENT == 0)
    assert header["layer_offset"][placed].min() >= (header["section_offset"] + header["section_elements"])[-1]
    assert header["field_hash"] != read_header(data)["field_hash"]


@pytest.mark.parametrize("layers", [{"smell": b"x"}, {"texture": b""}])
def test_a_layer_without_a_name_or_bytes_is_refused(field, layers):
    with pytest.raises(CookError, match="layers"):
        cook(dataclasses.replace(field, layers=layers))
