# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report of an asset: one offline page whose numbers are those of its JSON twin.

The asset is an ellipsoid whose response is known exactly (known_organ.py): held-out "FEM" forces are that truth,
rendered forces are what the field says, so that the errors in the report are real ones.
"""

from __future__ import annotations

import json
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from known_organ import DEPTH, RADIUS, KnownOrgan, field_of
from palpate.author.report import write_report
from palpate.fields.interpolation import evaluate
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.response_field import ResponseField
from palpate.fields.usd_write import write_asset

ORGAN = KnownOrgan()
TOOL = "ball"
POINTS, SEED, TOLERANCE, FLOOR = 9, 7, 0.035, 0.05
REASON = "Newton stopped <early> & was not forced on"


def organ_geometry() -> OrganGeometry:
    """The ellipsoid: a sphere's triangles stretched, each with the centre a tet; reach: a cap of 2 cm."""
    ball = trimesh.creation.icosphere(subdivisions=4)
    vertices, triangles = np.asarray(ball.vertices) * ORGAN.semi_axes, np.asarray(ball.faces, np.int32)
    points = np.concatenate([vertices, [[0.0, 0.0, 0.0]]])
    tets = np.concatenate([np.full((len(triangles), 1), len(vertices), np.int32), triangles], axis=1)
    centre = vertices[triangles].mean(axis=1)
    reach = (np.linalg.norm(centre[:, :2], axis=1) < 20e-3) & (centre[:, 2] > 0)
    held = np.flatnonzero(points[:, 2] < -0.02).astype(np.int32)
    return OrganGeometry(
        "ellipsoid", vertices, triangles, points, tets, (Support("below", held),), ("tissue",),
        np.zeros(len(tets), np.int32), np.flatnonzero(reach).astype(np.int32),
        {"model": "neo_hookean", "youngs_modulus": 5.4e3, "poissons_ratio": 0.48},
        provenance={"source": "closed form", "hash": "ab" * 32},
    )  # fmt: skip


def validation(field: ResponseField) -> dict[str, Any]:
    """POINTS presses as author/held_out.py writes them; the last one stopped half way."""
    rng = np.random.default_rng(SEED)
    presses = []
    for number, c in enumerate(ORGAN.cap_points(POINTS, rng, 18e-3)):
        failed = number == POINTS - 1
        n = ORGAN.normal(c[None])[0]
        depth = DEPTH * np.arange(1, 6 if failed else 11) / 10
        q = c + (RADIUS - depth)[:, None] * n
        fem, said = ORGAN.force(q), evaluate(field, q).force
        f = fem @ n
        miss = said - fem
        aside = np.linalg.norm(miss - (miss @ n)[:, None] * n, axis=1) / f
        judged = f >= FLOOR * f[-1]
        moves = [] if failed else [
            {"depth": DEPTH, "move": [1e-3, 0.0, 0.0], "fem_force": fem[-1].tolist(),
             "rendered_force": said[-1].tolist(), "error": 0.01 * (number + 1)}
        ]  # fmt: skip
        presses.append(
            {
                "contact_point": c.tolist(), "normal": n.tolist(), "converged": not failed,
                "reason": REASON if failed else "", "hash": f"{number:02d}" * 32, "fidelity": "full", "seconds": 100.0,
                "depth": depth.tolist(), "fem_force": fem.tolist(), "rendered_force": said.tolist(),
                "force_error": [float(e) if ok else None for e, ok in zip(np.abs(miss @ n) / f, judged, strict=True)],
                "lateral_error": [float(e) if ok else None for e, ok in zip(aside, judged, strict=True)],
                "status": [0] * len(depth), "moves": moves,
            }
        )  # fmt: skip

    def spread(values: list[float | None]) -> dict[str, float]:
        known = [value for value in values if value is not None]
        p50, p95 = np.percentile(known, [50, 95])
        return {"p50": float(p50), "p95": float(p95), "max": max(known)}

    force = spread([e for press in presses for e in press["force_error"]])
    return {
        "tool": TOOL, "seed": SEED, "fidelity": "full", "tolerance": TOLERANCE, "met": False, "floor": FLOOR,
        "points": POINTS, "failed": 1, "seconds": 900.0, "force_error": force,
        "lateral_error": spread([e for press in presses for e in press["lateral_error"]]),
        "stuck_error": spread([move["error"] for press in presses for move in press["moves"]]),
        "far_field_error": {"p50": 0.002, "p95": 0.006, "max": 0.0085}, "presses": presses,
    }  # fmt: skip


SUMMARY = {
    "asset": "ellipsoid",
    "tools": [{"name": TOOL, "rfield": f"{TOOL}.rfield", "bytes": 254_321, "nodes": 40, "presses": 49, "failed": 2}],
    "seconds": 2711.0,
    "cpu_seconds": 5101.5,
    "tolerance_met": False,
    "stages": [{"name": "surface and tetrahedra", "seconds": 95.2}, {"name": "presses", "seconds": 2500.0}],
    "failures": [{"tool": TOOL, "contact_point": [0.0, 0.015, 0.0285], "reason": "the patch has no good mesh"}],
    "versions": {"palpate": "0.1.0"},
    "bench": {
        "stick_ns": {"p50": 184.2, "p99": 210.0, "p999": 333.0, "max": 9001.0}, "free_ns": None, "load_ms": 1.23,
        "bytes": 254_321, "machine": "a test",
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def asset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An asset with its validation and its report."""
    folder = tmp_path_factory.mktemp("report") / "ellipsoid"
    field = field_of(ORGAN, 40)
    write_asset(folder, organ_geometry(), field)
    (folder / "validation").mkdir()
    (folder / "validation" / f"{TOOL}.json").write_text(json.dumps(validation(field)))
    write_report(folder, SUMMARY)
    return folder


if __name__ == "__main__":  # python tests/author/test_report.py DIR: a report to look at
    import sys

    place = Path(sys.argv[1])
    shutil.rmtree(place, ignore_errors=True)
    made = field_of(ORGAN, 40)
    write_asset(place, organ_geometry(), made)
    (place / "validation").mkdir()
    (place / "validation" / f"{TOOL}.json").write_text(json.dumps(validation(made)))
    print(write_report(place, SUMMARY))
