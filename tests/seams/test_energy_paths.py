# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""No energy is created by friction, contrast, rate, tilt, swap or organ motion, by the USD's data (energy_paths.py)."""

import energy_paths
import numpy as np
import pytest


@pytest.mark.parametrize("paths", [6_000, pytest.param(1_000_000, marks=pytest.mark.slow)])
def test_nothing_is_created_to_a_billionth_of_what_is_exchanged(paths):
    for row in energy_paths.table(paths):
        assert row["share"] < 1e-9, row
        assert row["created"] < 1e-13 and row["force_error"] < 1e-9 and row["balance"] < 1e-13, row
        assert row["touched"] > 0.9 * row["paths"] > 5 * row["left"] and row["exchanged"] > 0.0, row


def test_the_judge_sees_energy_from_nowhere():
    """A force turned by a thousandth of a radian, an anchor moved by a micrometre: both are found."""
    of = energy_paths.subject(0.5 * np.log(6.0), 20)
    rng = np.random.default_rng(2)
    honest = energy_paths.run(of, "plain", 300, rng)
    assert honest["share"] < 1e-9
    judged = energy_paths.judged

    def false_force(subject, x, force, s, r, times):
        return judged(subject, x, 0.999 * force, s, r, times)

    def false_anchor(subject, x, force, s, r, times):
        return judged(subject, x, force, s + 1e-6, r, times)

    for false in (false_force, false_anchor):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(energy_paths, "judged", false)
            assert energy_paths.run(of, "plain", 300, np.random.default_rng(2))["share"] > 1e-6
