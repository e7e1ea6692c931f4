# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Values as colours, by the report's scales."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps

__all__ = ["colours", "gradient", "rgb"]


def colours(values: np.ndarray, low: float, high: float, scale: str) -> np.ndarray:
    """(n, 4) uint8 of `values` (n,), on matplotlib's `scale` from low to high."""
    share = (values - low) / (high - low) if high > low else np.full(len(values), 0.5)
    return colormaps[scale](np.clip(share, 0.0, 1.0), bytes=True)


def gradient(scale: str) -> str:
    """The scale from left to right, as CSS."""
    stops = colormaps[scale](np.linspace(0.0, 1.0, 9), bytes=True)[:, :3]
    return "linear-gradient(90deg, " + ", ".join(f"rgb({r},{g},{b})" for r, g, b in stops) + ")"


def rgb(text: str) -> tuple[int, int, int]:
    """ "#0072b2" as three numbers of 0 to 255."""
    return tuple(int(text[i : i + 2], 16) for i in (1, 3, 5))  # type: ignore[return-value]
