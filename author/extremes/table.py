# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""All cases, run one after the other, each kept as it ends: a run that was stopped goes on where it was."""

from __future__ import annotations

import csv
import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from palpate.author.console import plain
from palpate.author.extremes.case import OUTCOMES, Case, Row, outcome_of
from palpate.author.mechanics import mechanics_version
from palpate.author.scene import Scene
from palpate.author.scene_types import digest
from palpate.author.store import Store

__all__ = ["all_cases", "counted", "run", "written"]

CHEAP = 0.5
"""s of CPU; what cost less is found again rather than kept."""
BY_FINITE_ELEMENTS = (
    "depth_cases", "material_cases", "mesh_cases", "organ_cases", "rubbing_cases", "tool_cases",
)  # fmt: skip
"""Modules whose cases do not depend on fields or the runtime."""
SHARED = ("block_press", "books", "known_field")


def all_cases(scene: Scene | None, work: Path) -> Iterator[Case]:
    """The project's own, or those that make sense on a scene."""
    from palpate.author.extremes.scene_cases import scene_cases

    if scene is not None:
        from palpate.author.extremes.organ_cases import organ_cases

        yield from scene_cases(scene.file)
        yield from organ_cases(scene, work)
        return
    from palpate.author.extremes.depth_cases import depth_cases
    from palpate.author.extremes.field_cases import field_cases
    from palpate.author.extremes.material_cases import material_cases
    from palpate.author.extremes.mesh_cases import mesh_cases
    from palpate.author.extremes.path_cases import path_cases
    from palpate.author.extremes.rubbing_cases import rubbing_cases
    from palpate.author.extremes.servo_cases import servo_cases
    from palpate.author.extremes.tool_cases import tool_cases

    yield from scene_cases()
    yield from servo_cases()
    yield from path_cases()
    yield from field_cases()
    yield from material_cases()
    yield from tool_cases()
    yield from mesh_cases()
    yield from rubbing_cases()
    yield from depth_cases()


def run(
    cases: Sequence[Case], folder: Path, subject: str, told: Callable[[Row], None] = lambda row: None
) -> list[Row]:
    """Rows in the cases' order; those kept in `folder` for this source and `subject` (a digest) are taken from there.

    What was wrong is run again.
    """
    store, rows = Store(folder), []
    for case in cases:
        version = _version(case.run.__module__)
        key = digest({"axis": case.axis, "value": case.value, "subject": subject, "version": version})
        kept = store.read("cases", key)
        if kept is not None and kept[1]["outcome"] != "wrong":
            row = Row(**kept[1])
        else:
            row = outcome_of(case)
            if row.seconds > CHEAP:
                store.write("cases", key, {}, plain(asdict(row)))
        rows.append(row)
        told(row)
    return rows


@cache
def _version(module: str) -> str:
    """Hex digest of the source that decides what the cases of a module find."""
    from palpate.runtime.library import shared_library

    text = hashlib.sha256(mechanics_version().encode())
    if module.rsplit(".", 1)[-1] in BY_FINITE_ELEMENTS:
        for path in sorted(Path(str(files("palpate.fem_offline.verification"))).glob("*.py")):
            text.update(path.read_bytes())
    else:
        for path in sorted(Path(str(files("palpate.fields"))).glob("*.py")):
            text.update(path.read_bytes())
        text.update(shared_library("palpate").read_bytes())
    own = Path(str(files("palpate.author.extremes")))
    for name in (module.rsplit(".", 1)[-1], *SHARED):
        text.update((own / f"{name}.py").read_bytes())
    return text.hexdigest()


def counted(rows: Sequence[Row]) -> dict[str, dict[str, int]]:
    """By axis, in order of appearance: how many cases had which outcome."""
    axes = list(dict.fromkeys(row.axis for row in rows))
    of = Counter((row.axis, row.outcome) for row in rows)
    return {axis: {outcome: of[axis, outcome] for outcome in OUTCOMES} for axis in axes}


def written(rows: Sequence[Row], folder: Path) -> dict[str, str]:
    """The table as Markdown, JSON and CSV, and its overview as PNG; kind -> path."""
    from palpate.author.extremes.overview import overview

    folder.mkdir(parents=True, exist_ok=True)
    paths = {kind: folder / f"extremes.{kind}" for kind in ("md", "json", "csv", "png")}
    paths["md"].write_text(_markdown(rows))
    values: list[dict[str, Any]] = [plain(asdict(row)) for row in rows]
    paths["json"].write_text(json.dumps({"rows": values, "by_axis": counted(rows)}, indent=1))
    with paths["csv"].open("w", newline="") as file:
        writer = csv.DictWriter(file, list(values[0]))
        writer.writeheader()
        writer.writerows(values)
    overview(counted(rows), paths["png"])
    return {kind: str(path) for kind, path in paths.items()}


def _markdown(rows: Sequence[Row]) -> str:
    lines = ["# Extremes", "", "| axis | " + " | ".join(OUTCOMES) + " |", "|---|---|---|---|"]
    lines += [
        f"| {axis} | " + " | ".join(str(n) for n in of.values()) + " |" for axis, of in counted(rows).items()
    ]
    lines += ["", "| axis | value | outcome | reason |", "|---|---|---|---|"]
    lines += [
        "| "
        + " | ".join(text.replace("|", r"\|") for text in (row.axis, row.value, row.outcome, row.reason))
        + " |"
        for row in rows
    ]
    return "\n".join(lines) + "\n"
