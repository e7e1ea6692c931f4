# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.verification import cattaneo_mindlin, mindlin


def test_the_first_slope_is_mindlins_tangential_stiffness():
    E, nu, a, reach = 5400.0, 0.3, 2e-3, 0.01
    way = cattaneo_mindlin.gross_slip_way(0.5 * E / (1 + nu), nu, a, reach)
    small = 1e-6
    slope = reach * cattaneo_mindlin.tangential_force(small) / (small * way)
    assert slope == pytest.approx(mindlin.tangential_stiffness(E, nu, a), rel=1e-5)


def test_the_way_back_from_force_is_mindlins_displacement():
    share = np.linspace(0.0, 1.0, 7)
    force = cattaneo_mindlin.tangential_force(share)
    assert 1.0 - (1.0 - force) ** (2.0 / 3.0) == pytest.approx(share)
    assert cattaneo_mindlin.stick_radius(force) == pytest.approx(np.sqrt(1.0 - share))


def test_a_press_without_slip_is_hertz_where_nothing_couples():
    assert cattaneo_mindlin.no_slip_factor(0.49999) == pytest.approx(1.0, abs=1e-6)


def test_a_press_without_slip_resists_less_than_a_bonded_disc_of_the_same_radius_would():
    """At the same depth the contact is smaller than Hertz'; a disc of one radius gains C."""
    factors = [cattaneo_mindlin.no_slip_factor(nu) for nu in (0.0, 0.2, 0.3, 0.4)]
    discs = [(1 - nu) * np.log(3 - 4 * nu) / (1 - 2 * nu) for nu in (0.0, 0.2, 0.3, 0.4)]
    assert (np.diff(factors) < 0.0).all()
    assert all(1.0 < factor < disc for factor, disc in zip(factors, discs, strict=True))
