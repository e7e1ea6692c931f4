# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Forces against time that need no recording, each for an incoming velocity v.

    pulse              f = A v                                           0 <= t < d          the paper, table 1
    decaying sinusoid  f = A v sin(2 pi F t) exp(-t / tau)               0 <= t < d          the paper, after
    Okamura 2001
    modal sum          f = v sum_i A_i sin(2 pi F_i t) exp(-t / tau_i)   0 <= t < d          Wellman and Howe 1995

The paper's table gives the sinusoid's A, F and d and not its decay: `decay` is a parameter here, d / 3 when absent.
Positive pushes the hand out of the surface.  The shock has a file of its own (shock.py).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

__all__ = ["decaying_sinusoid", "modal_sum", "pulse"]


def pulse(time: np.ndarray, velocity: float, amplitude: float, duration: float) -> np.ndarray:
    """(n,) N at `time` (n,) s; amplitude in N s/m, duration in s."""
    time = np.asarray(time, dtype=float)
    return np.where((time >= 0.0) & (time < duration), amplitude * velocity, 0.0)


def decaying_sinusoid(
    time: np.ndarray,
    velocity: float,
    amplitude: float,
    frequency: float,
    duration: float,
    decay: float | None = None,
) -> np.ndarray:
    """(n,) N at `time` (n,) s; amplitude in N s/m, frequency in Hz, duration and decay (time constant) in s."""
    return modal_sum(
        time, velocity, [(amplitude, frequency, duration / 3.0 if decay is None else decay)], duration
    )


def modal_sum(
    time: np.ndarray, velocity: float, modes: Sequence[tuple[float, float, float]], duration: float
) -> np.ndarray:
    """(n,) N at `time` (n,) s; modes: (amplitude N s/m, frequency Hz, decay s) each."""
    t = np.maximum(np.asarray(time, dtype=float), 0.0)
    rung = sum((a * np.sin(2.0 * np.pi * f * t) * np.exp(-t / tau) for a, f, tau in modes), np.zeros_like(t))
    return np.where((np.asarray(time) >= 0.0) & (t < duration), velocity * rung, 0.0)
