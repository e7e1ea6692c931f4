# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One row of the sweep: the field that a setting gives, what it cost, how large and fast it is, how wrong.

The field is cooked and the runtime itself moves through it, as in every other judgement (held_out.py); what the runtime
does not render is judged by not_rendered.py and has no tick.  cpu_seconds are those of the setting alone: surface,
tetrahedra, contact geometry, its node presses with their far fields, and the fit; what judges it is no part of it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.console import plain
from palpate.author.field_stage import field_unrounded
from palpate.author.held_out import Rendering, judgement_of, press_judgements
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressOutcome
from palpate.author.sampling import ReachSamples
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.scene_types import digest
from palpate.author.store import Store
from palpate.author.tradeoff.cost import cpu_seconds_of
from palpate.author.tradeoff.knobs import Setting, scene_with
from palpate.author.tradeoff.not_rendered import Axial, Unrounded
from palpate.author.tradeoff.ticks import tick_of
from palpate.fields.as_cooked import as_cooked
from palpate.fields.cook import write_rfield
from palpate.fields.response_field import ContactGeometry, ResponseField

__all__ = ["ERRORS", "Judge", "judged_again", "source_version"]

ERRORS = ("force_error", "lateral_error", "stuck_error")


@dataclass(frozen=True)
class Judge:
    """What all rows share.

    Attributes:
        geometry_cpu_seconds: of the contact geometry, which every setting needs.
        held: held-out presses.
        folder: where fields go.
        store: keeps rows and ticks.
    """

    scene: Scene
    tool: Tool
    samples: ReachSamples
    geometry: ContactGeometry
    geometry_cpu_seconds: float
    held: Sequence[PressOutcome]
    folder: Path
    store: Store

    def row(
        self, setting: Setting, mesh: OrganMesh, organ_cpu_seconds: float, nodes: Sequence[PressOutcome]
    ) -> dict[str, Any]:
        """A row as the answer has it, with `presses`, errors by held-out press, beside.

        Args:
            mesh: organ that was pressed.  nodes: so many outcomes as the setting has nodes.
        """
        asked = {
            "setting": setting.as_json(),
            "nodes": [outcome.key for outcome in nodes],
            "held": [outcome.key for outcome in self.held],
            "source": source_version(),
        }
        key = digest(asked)
        _, row = self.store.kept("row", key, lambda: ({}, plain(self._made(setting, mesh, nodes, key))))
        row["cpu_seconds"] = (
            organ_cpu_seconds + self.geometry_cpu_seconds + row["press_cpu_seconds"] + row["fit_cpu_seconds"]
        )
        row["organ_cpu_seconds"], row["geometry_cpu_seconds"] = organ_cpu_seconds, self.geometry_cpu_seconds
        return {**row, **judged_again(row["presses"], self.scene.accuracy.force_tolerance)}

    def field(self, row: dict[str, Any]) -> Path:
        return self.folder / f"{row['field']}.rfield"

    def _made(
        self, setting: Setting, mesh: OrganMesh, nodes: Sequence[PressOutcome], key: str
    ) -> dict[str, Any]:
        scene = scene_with(self.scene, setting)
        (made, failures), fit = cpu_seconds_of(
            lambda: field_unrounded(
                scene, self.tool, mesh, self.samples, self.geometry, nodes, {"setting": setting.as_json()}
            )
        )
        row: dict[str, Any] = {
            "setting": setting.as_json(),
            "offered": setting.offered,
            "press_cpu_seconds": float(sum(outcome.values["cpu_seconds"] for outcome in nodes)),
            "fit_cpu_seconds": fit,
            "nodes": made.nodes.node_count,
            "knots": len(made.nodes.depth_knots),
            "failed": len(failures),
            "representation": made.representation,
            "tick_ns": None,
            "tick": None,
            "field": None,
        }
        if setting.response == "axial":
            judged: Any = Axial(made)
            row["bytes"] = Axial.stored_bytes(made)
        else:
            rounded = as_cooked(_in_halves(made) if setting.float_bits == 16 else made)
            self.folder.mkdir(parents=True, exist_ok=True)
            path = self.folder / f"{key[:16]}.rfield"
            write_rfield(rounded, path)
            wider = (setting.float_bits - 32) // 8
            row["bytes"] = path.stat().st_size + wider * made.amplitudes.coefficients.size
            judged = Unrounded(made) if setting.float_bits == 64 else None
            if judged is None:
                judged = _opened(path)
            if setting.offered:
                row |= {"field": key[:16], "tick": tick_of(path, self.store)}
                row["tick_ns"] = max(row["tick"]["stick_ns"]["p50"], row["tick"]["slide_ns"]["p50"])
        row["presses"] = press_errors(judged, made.tool.offset, self.held)
        return row


def press_errors(field: Any | Rendering, offset: float, held: Sequence[PressOutcome]) -> list[dict[str, Any]]:
    """What `judgement_of` needs of each held-out press."""
    kept = ("contact_point", "converged", "seconds", "force_error", "lateral_error", "moves", "slides")
    return [{name: press[name] for name in kept} for press in press_judgements(field, offset, held)]


def judged_again(presses: Sequence[dict[str, Any]], tolerance: float) -> dict[str, Any]:
    """Errors and whether they meet `tolerance`, from the errors of single presses."""
    judged = judgement_of(presses, [], [], tolerance)
    return {name: judged[name] for name in (*ERRORS, "met", "points")}


def _opened(path: Path):
    from palpate.runtime import Field

    return Field.open(path)


def _in_halves(field: ResponseField) -> ResponseField:
    """Amplitudes rounded to 16 bits, each channel scaled so that its largest fits."""
    amplitudes = field.amplitudes
    coefficients = amplitudes.coefficients
    scale = np.abs(coefficients).max(axis=tuple(range(coefficients.ndim - 1)))
    scale = np.where(scale > 0, scale, 1.0)
    halves = (coefficients / scale).astype(np.float16).astype(float) * scale
    return replace(field, amplitudes=replace(amplitudes, coefficients=halves))


@cache
def source_version() -> str:
    """Of the code that turns presses into rows, and of the runtime: kept rows are of one version only."""
    from palpate.runtime.library import shared_library

    sources = sorted(Path(str(files("palpate.fields"))).glob("*.py"))
    author = Path(str(files("palpate.author")))
    sources += [author / name for name in ("held_out.py", "field_stage.py")]
    sources += [author / "tradeoff" / name for name in ("rows.py", "not_rendered.py")]
    library = Path(shared_library("palpate"))
    return digest([hashlib.sha256(path.read_bytes()).hexdigest() for path in (*sources, library)])
