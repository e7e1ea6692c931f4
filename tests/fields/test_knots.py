# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Knots are as many as the curves need: between them the force comes back."""

import numpy as np
import pytest

from palpate.fields.depth_curve import fit_depth_curve
from palpate.fields.knots import KNOT_COUNTS, KNOT_ERROR, knot_error, knots_by_error
from palpate.fields.node_fit import PressArrays, uniform_knots

D = 5e-3
UP = np.array([0.0, 0.0, 1.0])


def press(exponent: float, bend: float = 0.0, depth_max: float = D) -> PressArrays:
    """Energy 200 d^exponent (1 + bend (d / D)^4), pressed to depth_max (m)."""
    d = np.linspace(0.0, depth_max, 21)
    energy = 200.0 * d**exponent * (1.0 + bend * (d / D) ** 4)
    slope = 200.0 * d ** (exponent - 1.0) * (exponent + bend * (exponent + 4.0) * (d / D) ** 4)
    return PressArrays(np.zeros(3), UP, d, slope[:, None] * UP, energy)


def error_of(one: PressArrays, count: int) -> float:
    return knot_error(fit_depth_curve(one.depth, one.force @ UP, one.energy), uniform_knots(D, count))


def test_a_power_of_depth_needs_the_fewest_knots():
    assert len(knots_by_error([press(2.5)], D)) == KNOT_COUNTS[0]


def test_a_stiffening_press_needs_more_and_keeps_its_force_between_them():
    stiffening = press(2.5, bend=20.0)
    knots = knots_by_error([stiffening], D)
    assert KNOT_COUNTS[0] < len(knots) < KNOT_COUNTS[-1]
    assert error_of(stiffening, len(knots)) <= KNOT_ERROR
    assert error_of(stiffening, KNOT_COUNTS[KNOT_COUNTS.index(len(knots)) - 1]) > KNOT_ERROR


def test_the_press_that_needs_most_decides_among_few():
    few = [press(2.5), press(2.5), press(2.5, bend=20.0)]
    assert len(knots_by_error(few, D)) == len(knots_by_error(few[2:], D))


@pytest.mark.parametrize("presses", [[], [press(2.5, depth_max=0.7 * D)]], ids=["none", "all too short"])
def test_without_a_press_to_the_bottom_the_usual_number_is_taken(presses):
    np.testing.assert_array_equal(knots_by_error(presses, D), uniform_knots(D))
