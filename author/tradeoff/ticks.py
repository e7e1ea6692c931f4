# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Tick times, measured once for each layout of a field.

Fields with the same lattices, curves and ways of touching differ in numbers only, and a tick runs the same instructions
on them; the machine's noise between two such measurements would look like a difference that nobody can have.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from palpate.author.scene_types import digest
from palpate.author.store import Store

__all__ = ["tick_of"]

RUNS = 2
"""The faster one counts, kind by kind: what else a machine does only ever adds."""
KINDS = ("stick_ns", "slide_ns", "free_ns", "cold_ns")


def tick_of(path: Path, store: Store) -> dict[str, Any]:
    """`palpate bench` of the layout of the field at `path`: percentiles (ns) by kind of tick, and the machine."""
    from palpate.runtime import Field, bench
    from palpate.runtime.library import shared_library

    info = Field.open(path).info
    layout = {
        "geometry": [info.geometry_spacing, info.geometry_blocks_stored],
        "amplitudes": [info.amplitude_spacing, info.amplitude_blocks_stored, info.channel_count],
        "ways": info.way_count,
        "library": hashlib.sha256(Path(shared_library("palpate")).read_bytes()).hexdigest(),
    }

    def measured() -> tuple[dict[str, Any], dict[str, Any]]:
        runs = [bench(path) for _ in range(RUNS)]
        best = {kind: min((run[kind] for run in runs), key=lambda found: found["p50"]) for kind in KINDS}
        return {}, {**best, "load_ms": min(run["load_ms"] for run in runs), "machine": runs[0]["machine"]}

    return store.kept("tick", digest(layout), measured)[1]
