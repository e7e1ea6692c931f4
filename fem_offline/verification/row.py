# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One line of the verification table: a number of ours beside one that can be trusted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Row", "against", "not_run"]


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
        missing: what this machine lacks to do the check at all, and how to get it; "" where it was done.
            Such a row is neither met nor failed.
    """

    name: str
    reference: str
    value: float
    error: float
    bar: float
    note: str = ""
    missing: str = ""

    @property
    def met(self) -> bool:
        """Whether the check was done, and its error is a number within the bar."""
        return bool(np.isfinite(self.error) and self.error <= self.bar and not self.missing)

    @property
    def failed(self) -> bool:
        """Whether the check was done and is not met."""
        return not self.met and not self.missing


def against(name: str, reference: str, value: float, expected: float, bar: float, note: str = "") -> Row:
    """A row whose value is the ratio `value / expected`."""
    ratio = value / expected
    return Row(name, reference, ratio, abs(ratio - 1.0), bar, note)


def not_run(name: str, reference: str, bar: float, missing: str) -> Row:
    """A row of a check that this machine cannot do."""
    return Row(name, reference, np.nan, np.nan, bar, missing=missing)
