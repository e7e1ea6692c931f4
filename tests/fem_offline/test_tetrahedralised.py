# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import pytest

from palpate.fem_offline.verification.tetrahedralised import ball_mesh, pressure_modes, tetrahedralised_rows


def test_patch_test_and_homogeneous_states_hold_on_a_mesh_of_ftetwild():
    rows = list(tetrahedralised_rows(modes=False))
    assert len(rows) == 9
    assert not [row for row in rows if not row.met]


@pytest.mark.slow
def test_no_pressure_goes_unfelt_on_a_mesh_of_ftetwild():
    beta = pressure_modes(ball_mesh(12e-3))
    assert beta[0] < 1e-6 < 1e-2 < beta[1]
