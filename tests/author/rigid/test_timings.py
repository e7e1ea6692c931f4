# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What is timed is contact."""

import numpy as np
import pytest

from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.examples import MASS
from palpate.author.rigid.timings import CURVED_PAIRS, press_and_roll
from palpate.runtime.rigid import Rigid, RigidSession


@pytest.mark.parametrize("name", CURVED_PAIRS)
def test_a_timed_pair_touches_and_no_tick_is_refused(name):
    held, fixed = CURVED_PAIRS[name]
    rigid = Rigid(cooked_rigid(held, fixed, MASS))
    out = RigidSession(rigid).tick_batch(*press_and_roll(rigid, held, fixed, ticks=300))
    assert not np.any(out["status"])
    touching = out["contact_count"] > 0
    assert np.mean(touching) > 0.8 and np.linalg.norm(out["contact_force"][touching], axis=1).max() > 0.5
