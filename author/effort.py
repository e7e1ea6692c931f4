# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How much work a scene is, before it is done: presses by area and tolerance, seconds by fidelity.

Presses: interpolating from N nodes over 148 cm2 of a liver left errors at the 95th percentile of 13, 5.9 and
1.8 % at N = 100, 200 and 400 (gradient-enhanced kriging), which is close to

    error = 5.9 % (N / 200)^-1.4         so     N = 200 (area / 148 cm2) (5.9 % / error)^(1 / 1.4)

It is the most that a tool presses: sampling by error (sampling_by_error.py) begins with SEEDS of it and ends as soon as
its own estimate of the error allows, in between.  Measured: 10 of 8 to 12 (the shipped block), 103 to 159 of 44 to 294
(known reaches of 150 cm2), so what is expected is the geometric mean of both.  A region asks for more, around its
border.  All is an estimate to plan with; what an asset reaches is measured on held-out presses.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

__all__ = [
    "BUDGET_TO_PRESS",
    "NODES_AT_LEAST",
    "PRESS_SECONDS",
    "REGION_EXPECTED",
    "REGION_SEEDS",
    "STARTING",
    "expected_nodes",
    "far_field_seconds",
    "fitting_seconds",
    "meshing_seconds",
    "node_count",
    "press_memory",
    "press_seconds",
    "region_nodes",
    "seed_count",
    "worker_count",
]

PRESS_SECONDS: dict[str, float] = {"linear": 6.0, "near_field": 9.0, "full": 45.0}
"""CPU seconds of one press (its mesh included; held-out ones with two sticking moves) by fidelity, on a 2.5 GHz x86
core, in an organ of some 12,000 tetrahedra.

Means over kept records of a 5 mm ball 4 to 6 mm deep: near field 8.6 (block, 12 presses), 8.5 (liver, 131), 10 to 12
(kidney, 142); full 24 (block, 3,300 tetrahedra, 4 presses), 39 (kidney, 7,500, 79), 43 (liver, 12,000, 32).
"""
FULL_PRESS = (17.0, 2.3e-3)
"""CPU seconds of a full press, (a, b) in a + b T over T tetrahedra of the organ: 25, 34 and 45 for the three above."""
FAR_FIELD = 49.0, 45_068
"""CPU seconds of a worker's first look at an organ of so many tetrahedra; goes as the factor's fill, T^(4/3)."""
MESHING = 2.5e-3
"""CPU seconds a tetrahedron: repair, tetrahedra, their check.  3 to 5 (3,300), 4 to 17 (7,500), 27 s (12,000)."""
STARTING = 8.0
"""CPU seconds before a process presses: libraries, kernels; once more for the process that asks."""
FITTING = 1000.0
"""CPU seconds a m2 of reach, for contact geometry, field and files of a tool: 1 to 2, 4 to 5, up to 46 s on 7, 112 and
291 cm2."""
BUDGET_TO_PRESS = 0.9
"""Share of a time budget after which no further node is chosen (pipeline.py)."""

PRESS_MEMORY: dict[str, tuple[float, float]] = {
    "linear": (0.70e9, 2100.0),
    "near_field": (0.70e9, 2100.0),
    "full": (0.75e9, 2200.0),
}
"""A worker's peak resident set by fidelity, (m, k) in m + k T^(4/3) bytes over T tetrahedra of the organ.

The power is that of a Cholesky factor's fill in three dimensions (George, "Nested dissection of a regular finite
element mesh", SIAM J. Numer. Anal. 10, 1973).  Fitted to presses of a 5 mm ball, 2.5 mm deep, into a block of 160 x 120
x 60 mm on its base, one thread, Linux, in MiB:

    T            3250   12000   27000
    near_field    483     734    1403    a worker's first press
    full          540    1014       -
    near_field    730       -       -    its third: what libraries have loaded and not given back comes on top
    full          801       -       -

These were measured when a near-field press held no factor of the whole organ.  Now it does, as a full one always did:
1.26e9 bytes on a liver of 12,263 tetrahedra, where its curve, raised for that, says 1.29e9.
"""

NODES_AT_LEAST = 12
"""Fewest nodes that a field may have (count)."""
SEEDS, SEEDS_AT_LEAST = 0.15, 8
"""Share of the most nodes that is pressed before errors are estimated; and fewest (count)."""
REGION_SEEDS, REGION_EXPECTED, REGION_NODES = 6, 12, 60
"""Nodes more for each region to begin with, expected, and at most.  A nodule of 8 mm, 6 times as stiff, took 25 to 36
at 3.5 % (tests/benchmarks/sampling.py), the one of the shipped block 7 at 8 %."""


def seed_count(most: int) -> int:
    """Nodes to begin with, of `most`."""
    return min(most, max(SEEDS_AT_LEAST, math.ceil(SEEDS * most)))


def region_nodes(regions: int) -> int:
    """Nodes more for so many regions."""
    return REGION_NODES * regions


def expected_nodes(most: int) -> int:
    """Nodes when sampling by error ends by itself, of `most`, regions left out."""
    return round(math.sqrt(seed_count(most) * most))


def press_seconds(fidelity: str, tets: int) -> float:
    """CPU seconds of one press in an organ of `tets` tetrahedra."""
    return FULL_PRESS[0] + FULL_PRESS[1] * tets if fidelity == "full" else PRESS_SECONDS[fidelity]


def far_field_seconds(tets: int) -> float:
    """CPU seconds of one worker, once."""
    seconds, at = FAR_FIELD
    return seconds * (tets / at) ** (4.0 / 3.0)


def meshing_seconds(tets: int) -> float:
    """CPU seconds from surface file to tetrahedra."""
    return MESHING * tets


def fitting_seconds(area: float) -> float:
    """CPU seconds of one tool's field over `area` m2, files and judgement included."""
    return FITTING * area


def node_count(area: float, force_tolerance: float) -> int:
    """Presses that build a field over `area` (m2) for `force_tolerance` (fraction at the 95th percentile)."""
    estimate = 200.0 * (area / 148e-4) * (0.059 / force_tolerance) ** (1.0 / 1.4)
    return max(NODES_AT_LEAST, math.ceil(estimate))


def press_memory(tets: int, fidelities: Iterable[str]) -> int:
    """Peak resident set of a worker on an organ of `tets` tetrahedra, bytes; of the hungriest of `fidelities`."""
    curves = [PRESS_MEMORY[kind] for kind in fidelities]
    return round(max(least + slope * tets ** (4.0 / 3.0) for least, slope in curves))


def worker_count(peak: int, available: int | None, cores: int, asked: int | None = None) -> tuple[int, str]:
    """How many presses to do at once, so that memory holds them; and a sentence where that is fewer than wanted.

    Args:
        peak: bytes of one worker.
        available: bytes; None: unknown, nothing is limited.
        asked: by the user; one for each core when absent.
    """
    wanted = asked or cores
    fit = wanted if available is None else available // peak
    if fit >= wanted:
        return wanted, ""
    free = f"{_gigabytes(available or 0)} are free"
    if fit:
        return fit, f"{wanted} workers may take {_gigabytes(wanted * peak)} and {free}: {fit} press instead"
    return 1, (
        f"a press may take {_gigabytes(peak)} and {free}: one worker tries; "
        "if it dies, free some memory or give the organ a larger mesh_size"
    )


def _gigabytes(count: int) -> str:
    return f"{count / 1e9:.1f} GB"
