# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The part of a shared contact geometry that one tool needs."""

import dataclasses

import numpy as np
import pytest
from known_organ import BALL, KnownOrgan, field_of, geometry_of
from synthetic_field import sphere_organ

from palpate.fields.band import blocks_in_band, tool_band
from palpate.fields.build_field import build_field
from palpate.fields.contact_geometry import known_cells
from palpate.fields.cook import CookError, cook
from palpate.fields.field_check import check_field
from palpate.fields.field_error import FieldError
from palpate.fields.interpolation import evaluate
from palpate.fields.lattice import ABSENT_INSIDE, ABSENT_OUTSIDE, Lattice
from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.rfield_read import read_header, read_rfield
from palpate.fields.surface_curvature import foot_points

ORGAN = KnownOrgan(BALL)
GEOMETRY = geometry_of(ORGAN, 1.0e-3)


def kept(band: tuple[float, float]) -> Lattice:
    part, lattice = blocks_in_band(GEOMETRY, np.array(band)), GEOMETRY.signed_distance
    return dataclasses.replace(lattice, block_index=part.index, coefficients=lattice.coefficients[part.rows])


def test_a_band_goes_from_below_the_deepest_press_to_free_space_in_every_way_of_holding():
    np.testing.assert_allclose(tool_band([(5e-3, 6e-3)]), (-2.8e-3, 8e-3))
    np.testing.assert_allclose(tool_band([(5e-3, 2e-3), (0.0, 2e-3)]), (-3.5e-3, 8e-3))


def test_within_its_band_a_part_says_what_the_whole_says():
    low, high = GEOMETRY.band[0] + 3e-3, GEOMETRY.band[1] - 2e-3
    c = ORGAN.cap_points(300, np.random.default_rng(2), 15e-3)
    q = c + np.linspace(low, high, 300)[:, None] * ORGAN.normal(c)
    part, whole = sample_lattice(kept((low, high)), q), sample_lattice(GEOMETRY.signed_distance, q)
    assert part.present.all()
    np.testing.assert_array_equal(part.value, whole.value)


def test_what_goes_is_free_above_and_too_deep_below():
    low, high = GEOMETRY.band
    c = ORGAN.cap_points(50, np.random.default_rng(2), 10e-3)
    for band, phi, label in (
        ((high - 0.2e-3, high), low, ABSENT_INSIDE),
        ((low, low + 0.2e-3), high, ABSENT_OUTSIDE),
    ):
        lattice = kept(band)
        assert lattice.block_count < GEOMETRY.signed_distance.block_count
        block = np.floor((c + phi * ORGAN.normal(c) - lattice.origin) / (4 * lattice.spacing)).astype(int)
        found = lattice.block_index[tuple(block.T)]
        assert (found[found < 0] == label).all() and (found < 0).mean() > 0.5


def test_a_band_that_needs_every_block_drops_none():
    part = blocks_in_band(GEOMETRY, GEOMETRY.band + np.array([1e-9, 0.0]))
    np.testing.assert_array_equal(part.rows, np.arange(GEOMETRY.signed_distance.block_count))


def test_a_file_holds_its_tools_band_and_renders_the_same_there():
    field = sphere_organ()
    low, high = field.geometry.band
    narrow = dataclasses.replace(field, band=np.array([low + 1e-3, high - 1e-3]))
    part, whole = cook(narrow), cook(field)
    assert len(part) < len(whole)
    np.testing.assert_array_equal(read_header(part)["band"], narrow.band)
    q = np.array([[0.0, 0.0, field.tool.offset + 30e-3 - 1e-3]])
    for name in ("energy", "gradient"):
        a, b = (getattr(evaluate(read_rfield(data), q), name) for data in (part, whole))
        assert np.abs(a).max() > 0
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("band", [(1.0, 1.1), (2e-3, 2e-3), (3e-3, 2e-3), (np.nan, 2e-3)])
def test_a_band_that_cannot_be_is_not_cooked(band):
    with pytest.raises(CookError, match="band"):
        cook(dataclasses.replace(sphere_organ(), band=np.array(band)))


def test_a_band_beyond_the_geometrys_is_refused():
    field = sphere_organ()
    wide = dataclasses.replace(field, band=field.geometry.band + 1e-3)
    with pytest.raises(FieldError, match="within the geometry's"):
        check_field(wide)


@pytest.mark.parametrize("band", [None, (0.8e-3, 6e-3)])
def test_deeper_than_any_press_nothing_that_a_file_knows_pulls_the_tool_in(band):
    """A file knows more than its band, by a block at most; the runtime takes that for contact."""
    organ = KnownOrgan()
    held = field_of(organ, 12)
    field = build_field(
        held.nodes, held.geometry, held.tool, organ.reach, band=None if band is None else np.array(band)
    )
    known = read_rfield(cook(field))
    lattice = known.geometry.signed_distance
    q = lattice.origin + (known_cells(lattice) + 0.5) * lattice.spacing
    deep = evaluate(known, q).depth > 1.05 * field.depth_max
    surface, normal = foot_points(held.geometry, q[deep])
    within = organ.reach(surface) <= 0.0
    q, surface, normal = q[deep][within], surface[within], normal[within]
    assert len(q) > 50
    deepest = evaluate(known, surface + (field.tool.offset - field.depth_max) * normal).normal_force
    assert (evaluate(known, q).normal_force > deepest).all()
