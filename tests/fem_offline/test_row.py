# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np

from palpate.fem_offline.verification.row import Row, against, not_run


def test_a_row_is_met_failed_or_not_run():
    met, failed = against("", "", 1.01, 1.0, 0.02), against("", "", 1.03, 1.0, 0.02)
    broken, absent = Row("", "", np.nan, np.inf, 0.0), not_run("", "", 0.02, "install it")
    assert [row.met for row in (met, failed, broken, absent)] == [True, False, False, False]
    assert [row.failed for row in (met, failed, broken, absent)] == [False, True, True, False]
