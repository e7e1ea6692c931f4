# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate rigid`: cooks a rigid scene, shows the published examples, checks and times the runtime's rigid contact."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from palpate.author.console import Answer, answer_of
from palpate.author.errors import InputError, InputProblem

if TYPE_CHECKING:
    from palpate.author.rigid.timings import Timing

__all__ = ["cooked_scene", "rigid"]

SAMPLES = 4000
"""Poses that search valid formations where nobody says how many."""


def rigid(
    scene: Annotated[
        Path | None,
        typer.Argument(metavar="[SCENE]", help="rigid scene (TOML); the published examples when absent"),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="keeps cooked bytes, or pictures of examples")
    ] = None,
    samples: Annotated[
        int,
        typer.Option("--samples", min=0, metavar="N", help="poses that search valid formations; 0: no table"),
    ] = SAMPLES,
    identify: Annotated[
        int,
        typer.Option(
            "--identify", min=0, metavar="N", help="names formations of so many poses that are known"
        ),
    ] = 0,
    tables: Annotated[
        int,
        typer.Option(
            "--tables",
            min=0,
            metavar="N",
            help="searches the examples' formations with N poses, meets N others; with --identify: uses tables",
        ),
    ] = 0,
    noise: Annotated[
        float,
        typer.Option(
            "--noise", min=0.0, max=1.0, metavar="X", help="of --identify and --tables, a fraction of eps"
        ),
    ] = 0.1,
    as_json: Annotated[
        bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")
    ] = False,
) -> None:
    """Cook a rigid scene; or run the published examples of rigid contact, timed, with pictures."""

    def work() -> Answer:
        if scene is not None:
            for option, value in (("--identify", identify), ("--tables", tables)):
                if value:
                    raise InputError(InputProblem("", option, value, "is for poses of its own", "no SCENE"))
            if out is None:
                raise InputError(
                    InputProblem("", "--out", None, "is missing", "a folder for the cooked scene")
                )
            return cooked_scene(scene, out, samples)
        if identify:
            from palpate.author.rigid.known_configurations import identified

            known = identified(identify, noise, samples=tables)
            line = f"{known['right']:.5f} of {known['count']} right, noise {noise:g} eps"
            return Answer(known, [line], 0 if _right(known) else 1)
        if tables:
            rows = _tables(tables, noise)
            return Answer({"tables": rows}, [_table_lines(rows)])
        result = _examples(out)
        return Answer(result, [_lines(result)], 0 if result["met"] else 1)

    raise typer.Exit(answer_of(work, as_json))


def cooked_scene(scene: Path, out: Path, samples: int = SAMPLES) -> Answer:
    """Cooks the rigid scene into `out`.  Raises InputError."""
    result = _cooked(scene, out, samples)
    line = f"{result['rigid']}: {result['bytes']} bytes, {result['formations']} formations"
    return Answer(result, [line])


def _right(known: dict[str, Any]) -> bool:
    return known["right"] >= 0.999


def _cooked(path: Path, out: Path, samples: int) -> dict[str, Any]:
    from palpate.author.rigid.cook import cooked_rigid, element_name
    from palpate.author.rigid.formations import formation_table
    from palpate.author.rigid.scene import load_rigid_scene

    scene = load_rigid_scene(path)
    held, fixed = scene.bodies()
    law, mass = scene.rigid.law, scene.rigid.held.mass
    cooked_rigid(held, fixed, mass, law)  # refuses before the search
    table = formation_table(held, fixed, law, samples) if samples else None
    data = cooked_rigid(held, fixed, mass, law, table.formations if table else ())
    out.mkdir(parents=True, exist_ok=True)
    target = out / f"{scene.scene.name}.rigid"
    target.write_bytes(data)
    count = len(held.elements) + len(fixed.elements)
    return {
        "rigid": str(target),
        "bytes": len(data),
        "elements": [element_name(held, fixed, i) for i in range(count)],
        "formations": len(table.formations) if table else 0,
        "formation_news": table.news if table else None,
        "poses_in_contact": table.poses if table else 0,
        "mass": mass,
        "centre_of_mass": held.centre,
        "inertia": held.inertia(mass),
    }


def _examples(out: Path | None) -> dict[str, Any]:
    from palpate.author.rigid.examples import EXAMPLES, run_example
    from palpate.author.rigid.timings import coupled_timings, curved_timings, example_timings

    rows = []
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    for (name, make), timing in zip(EXAMPLES.items(), example_timings(), strict=True):
        run = run_example(make())
        if out is not None:
            from palpate.author.rigid.picture import example_picture

            example_picture(run, out / f"{name}.png")
        outcomes = [{"what": what, "met": bool(met)} for what, met in run.outcomes]
        rows.append({"outcomes": outcomes} | _timing_row(timing))
    return {
        "examples": rows,
        "curved_pairs": [_timing_row(t) for t in curved_timings()],
        "coupled": [_timing_row(t) for t in coupled_timings()],
        "met": all(o["met"] for row in rows for o in row["outcomes"]),
    }


def _timing_row(timing: Timing) -> dict[str, Any]:
    return {
        "name": timing.name,
        "identify_ns": _percentiles(timing.identify),
        "wrench_ns": _percentiles(timing.wrench),
        "tick_ns": _percentiles(timing.tick),
        "missed": timing.missed,
    }


def _tables(samples: int, noise: float) -> list[dict[str, Any]]:
    from palpate.author.rigid.examples import EXAMPLES
    from palpate.author.rigid.formations import formation_coverage, formation_table

    rows = []
    for name, make in EXAMPLES.items():
        held, fixed = make().held, make().fixed
        table = formation_table(held, fixed, samples=samples)
        covered = formation_coverage(held, fixed, table, noise=noise, samples=samples)
        rows.append({"name": name, "formations": len(table.formations), "drawn": table.poses} | covered)
    return rows


def _table_lines(rows: list[dict[str, Any]]) -> str:
    return "\n".join(
        f"{r['name']}: {r['formations']} formations of {r['drawn']} poses; of {r['poses']} others {r['found']:.4f} "
        f"are in the table, {r['right']:.4f} named rightly with noise, {r['right_with_table']:.4f} by the table"
        for r in rows
    )


def _percentiles(values: np.ndarray) -> dict[str, float]:
    p50, p99, p999 = np.percentile(values, [50, 99, 99.9])
    return {
        "p50": round(float(p50)),
        "p99": round(float(p99)),
        "p999": round(float(p999)),
        "max": round(float(values.max())),
    }


def _lines(result: dict[str, Any]) -> str:
    lines = []
    for row in result["examples"]:
        lines.append(_timing_line(row))
        lines += [f"  {'ok' if o['met'] else 'NOT MET'}: {o['what']}" for o in row["outcomes"]]
    lines += ["pairs of curved surfaces:", *(f"  {_timing_line(row)}" for row in result["curved_pairs"])]
    lines += ["with a virtual coupling:", *(f"  {_timing_line(row)}" for row in result["coupled"])]
    return "\n".join(lines)


def _timing_line(row: dict[str, Any]) -> str:
    parts = [
        f"{what} {row[key]['p50']} ns (p99.9 {row[key]['p999']})"
        for what, key in (("formation", "identify_ns"), ("wrench", "wrench_ns"), ("tick", "tick_ns"))
    ]
    missed = "".join(f"; {bar}" for bar in row["missed"])
    return f"{row['name']}: {', '.join(parts)}{missed}"
