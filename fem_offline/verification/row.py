# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One line of the verification table: a number of ours beside one that can be trusted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Row", "against"]


@dataclass(frozen=True)
class Row:
    """One check.

    Attributes:
        name: what was checked.
        reference: the law or computation it is held against, with its source.
        value: what came out (SI units, or a ratio to the reference; `name` says which).
        error: how far off, a fraction.
        bar: the largest error allowed.
        note: what limits the comparison, "" where nothing does.
    """

    name: str
    reference: str
    value: float
    error: float
    bar: float
    note: str = ""

    @property
    def met(self) -> bool:
        """Whether the error is a number and within the bar."""
        return bool(np.isfinite(self.error) and self.error <= self.bar)


def against(name: str, reference: str, value: float, expected: float, bar: float, note: str = "") -> Row:
    """A row whose value is the ratio `value / expected`."""
    ratio = value / expected
    return Row(name, reference, ratio, abs(ratio - 1.0), bar, note)
