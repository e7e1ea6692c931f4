# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What work cost, kept beside it: a result that is taken from the store has its price still.

A setting's price is what it would cost alone.  Presses of one pressing keep their far fields in a folder of their own,
so none of them is cheap because another setting was pressed before.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from palpate.author.scene_types import digest
from palpate.author.store import Result, Store

__all__ = ["PricedStore", "cpu_seconds_of"]

T = TypeVar("T")


class PricedStore(Store):
    """A store that knows what its results cost.

    Attributes:
        cpu_seconds: of all that was made or taken here so far by `kept`, what lies inside another counted once.
    """

    cpu_seconds = 0.0
    _inside = 0

    def kept(self, kind: str, key: str, make: Callable[[], Result]) -> Result:
        price_key = digest({"kind": kind, "key": key})

        def priced() -> Result:
            result, spent = cpu_seconds_of(make)
            self.write("price", price_key, {}, {"cpu_seconds": spent})  # first: a result always has its price
            return result

        self._inside += 1
        try:
            result = super().kept(kind, key, priced)
        finally:
            self._inside -= 1
        price = self.read("price", price_key)
        if price is None:  # lost: the work is done once more for its price, and its first result stays
            _, spent = cpu_seconds_of(make)
            price = {}, {"cpu_seconds": spent}
            self.write("price", price_key, *price)
        if not self._inside:
            self.cpu_seconds += float(price[1]["cpu_seconds"])
        return result


def cpu_seconds_of(work: Callable[[], T]) -> tuple[T, float]:
    """What `work` gives, and the CPU seconds that this process spent on it."""
    begun = time.process_time()
    result = work()
    return result, time.process_time() - begun
