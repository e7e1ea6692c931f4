# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.verification.blocks import block_organ


def test_thickness_is_the_way_through_the_body():
    organ = block_organ((0.04, 0.03, 0.02), (4, 3, 2), {0: NeoHookean(5400.0, 0.45)})
    e = np.eye(3)
    assert organ.thickness(np.array([1e-3, 2e-3, 0.0]), e[2]) == pytest.approx(0.02, rel=1e-12)
    assert organ.thickness(np.array([0.02, 1e-3, -7e-3]), e[0]) == pytest.approx(0.04, rel=1e-12)
    slanted = np.array([0.6, 0.0, 0.8])
    assert organ.thickness(np.zeros(3), slanted) == pytest.approx(0.02 / 0.8, rel=1e-12)


def test_thickness_counts_from_a_point_a_little_above_the_surface():
    """The smooth surface that is pressed is not the tetrahedra's."""
    organ = block_organ((0.04, 0.04, 0.02), (4, 4, 2), {0: NeoHookean(5400.0, 0.45)})
    assert organ.thickness(np.array([0.0, 1e-3, 0.3e-3]), np.array([0.0, 0.0, 1.0])) == pytest.approx(0.0203)
