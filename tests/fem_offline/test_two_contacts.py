# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.site import patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.two_contacts import press_two
from palpate.fem_offline.verification.blocks import block_organ, half_space

R, DEPTH, APART = 5e-3, 0.5e-3, 12e-3
TOOL = Sphere(R)
SIZE = patch_size(TOOL, DEPTH, radius=12e-3)
BASE = 0.5
"""m; depth of the block, whose base takes up to 1.1 / (E* BASE) of compliance away (verification/blocks.py)."""


def test_each_of_two_balls_misses_what_the_other_one_lowers_the_half_space_by():
    """P / (pi E* L), 2 a / (pi L) of a ball's force in the first order."""
    places = np.array([[-APART / 2, 1e-3, 0.0], [APART / 2, 1e-3, 0.0]])
    found = press_two(half_space(NeoHookean(5400.0, 0.3)), places, TOOL, np.array([DEPTH]), SIZE)
    assert found.distance == pytest.approx(APART)
    modulus = 5400.0 / (1.0 - 0.3**2)
    assert found.alone[:, 0, 2] == pytest.approx(4.0 / 3.0 * modulus * np.sqrt(R * DEPTH**3), rel=0.03)
    expected = 2.0 * np.sqrt(R * DEPTH) / np.pi * np.array([1.0 / APART - 1.1 * np.pi / BASE, 1.0 / APART])
    assert (found.normal_error > 0.95 * expected[0]).all() and (found.normal_error < 1.05 * expected[1]).all()
    assert (found.lateral_error < 0.1 * expected[1]).all()  # of a higher order: the surface tilts by w / L
    assert found.reaction_error < 1e-8


def test_contacts_that_overlap_are_refused():
    organ = block_organ((0.08, 0.08, 0.04), (4, 4, 2), {0: NeoHookean(5400.0, 0.3)})
    with pytest.raises(ValueError, match=r"3\.0 mm apart and would overlap"):
        press_two(organ, np.array([[0.0, 0.0, 0.0], [3e-3, 0.0, 0.0]]), TOOL, np.array([DEPTH]), SIZE)
