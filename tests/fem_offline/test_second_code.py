# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import sys

import numpy as np
import pytest

from palpate.fem_offline.material import Linear, density
from palpate.fem_offline.verification.materials import MODELS, deformation_gradients
from palpate.fem_offline.verification.second_code import second_code_rows, stress_and_tangent


def test_forces_and_stiffness_are_those_of_a_second_code():
    pytest.importorskip("felupe")
    rows = list(second_code_rows())
    assert len(rows) == 2 * (len(MODELS) - 1)
    for row in rows:
        assert row.met, f"{row.name}: error {row.error:.1e}"


def test_without_the_second_code_the_table_says_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "felupe", None)
    (row,) = second_code_rows()
    assert "not installed" in row.missing and not row.met and not row.failed


@pytest.mark.parametrize("name", [n for n, material in MODELS.items() if not isinstance(material, Linear)])
def test_principal_stretches_say_what_the_kernels_say(name):
    F = deformation_gradients()
    P, A = stress_and_tangent(MODELS[name], F)
    _, ours, tangent = density(MODELS[name], F)
    assert ours == pytest.approx(P, abs=1e-11 * np.abs(P).max())
    assert tangent == pytest.approx(A, abs=1e-11 * np.abs(A).max())
