# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.verification import sneddon

E, R = 7000.0, 5e-3


def test_the_integral_over_a_ball_is_its_closed_form():
    for depth in (0.1e-3, 1e-3, 3e-3):
        force = sneddon.profile_force(E, lambda s: s / np.sqrt(R**2 - s**2), (), R, depth)
        assert force == pytest.approx(sneddon.sphere_force(E, R, depth), rel=1e-7)


def test_the_integral_over_a_sharp_punch_and_cone_are_their_closed_forms():
    punch = sneddon.profile_force(E, *sneddon.punch_profile(R, 1e-7), 1e-3)
    assert punch == pytest.approx(sneddon.punch_force(E, R, 1e-3), rel=1e-3)
    cone = sneddon.profile_force(E, *sneddon.cone_profile(1.2, 1e-8, 0.02), 1e-3)
    assert cone == pytest.approx(sneddon.cone_force(E, 1.2, 1e-3), rel=1e-4)


def test_force_is_the_slope_of_its_work():
    """dF/dd = 2 E* a (Sneddon's stiffness) lies between that of the flat face and of the whole punch."""
    profile, h = sneddon.punch_profile(R, 0.2 * R), 1e-6
    ahead, behind = (sneddon.profile_force(E, *profile, 0.2e-3 + t * h) for t in (1, -1))
    assert 2 * E * 0.8 * R < (ahead - behind) / (2 * h) < 2 * E * R
