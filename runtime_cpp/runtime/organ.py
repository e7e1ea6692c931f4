# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A moving organ, published by one thread to any number of sessions."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import ArrayLike

from palpate.runtime.library import check, library

__all__ = ["Organ"]


class Organ:
    """palpate_organ: move it from one thread, tick sessions on it (`Session.set_organ`) from others."""

    def __init__(self) -> None:
        self._memory = np.zeros(-(-library().palpate_organ_size() // 8), dtype=np.float64)
        handle = ctypes.c_void_p()
        check(
            library().palpate_organ_init(self._memory.ctypes.data, self._memory.nbytes, ctypes.byref(handle))
        )
        self.handle = handle.value

    def move(self, position: ArrayLike, orientation: ArrayLike = (0, 0, 0, 1), duration: float = 0.0) -> None:
        """Publish a pose: `position` (3,) m and `orientation` (4,) x y z w of the organ's axes in the world's.

        Sessions are there `duration` seconds of their ticks later.

        Raises:
            RuntimeFailure: a number is not usable.
        """
        p = np.ascontiguousarray(position, dtype=np.float64).reshape(3)
        q = np.ascontiguousarray(orientation, dtype=np.float64).reshape(4)
        check(library().palpate_organ_move(self.handle, p.ctypes.data, q.ctypes.data, duration))
