# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Held-out presses, one row each: what the table lists, what the map colours, what the worst curves draw.

Along the surface two directions are drawn: that of the FEM push at the deepest state, and across it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["held_out_rows", "pooled", "worst_rows"]

WORST = 10
"""Presses whose curves are drawn (count)."""

_TICK_WORDS = {
    1: "deeper than pressed",
    4: "out of reach, no force",
    8: "too deep, no force",
    16: "passed through, no force",
    32: "not entered from outside, no force",
    64: "jumped, no force",
    128: "stale time, no force",
    256: "bad input, no force",
    512: "let go, no force",
    1024: "bad argument",
}
"""Bits of a tick's status (palpate.h), in few words; slipping is no news on a frictionless path."""


def held_out_rows(validation: dict[str, Any] | None) -> list[dict[str, Any]]:
    """One row for every press of `validation`, in its order; numbers in SI, None where nothing was judged."""
    return [_row(number, press) for number, press in enumerate((validation or {}).get("presses", []), 1)]


def worst_rows(rows: list[dict[str, Any]]) -> list[int]:
    """Indices of the rows with the largest normal-force error, worst first."""
    judged = [i for i, row in enumerate(rows) if row["force_error_max"] is not None]
    return sorted(judged, key=lambda i: -rows[i]["force_error_max"])[:WORST]


def pooled(validation: dict[str, Any] | None, key: str) -> list[float]:
    """All judged errors, fractions; `key`: force_error, lateral_error, or stuck_error (of the moves)."""
    presses = (validation or {}).get("presses", [])
    if key in ("stuck_error", "slid_error"):
        kind = "moves" if key == "stuck_error" else "slides"
        found = [move.get("error") for press in presses for move in press.get(kind) or []]
    else:
        found = [error for press in presses for error in press.get(key) or []]
    return [error for error in found if error is not None]


def _row(number: int, press: dict[str, Any]) -> dict[str, Any]:
    n = np.array(press["normal"], float)
    fem = np.array(press["fem_force"], float).reshape(-1, 3)
    said = np.array(press["rendered_force"], float).reshape(-1, 3)
    along = _push_direction(fem, n)
    across = np.cross(n, along)
    curves = {
        name: {
            "normal": (force @ n).tolist(),
            "along": (force @ along).tolist(),
            "across": (force @ across).tolist(),
        }
        for name, force in (("fem", fem), ("rendered", said))
    }
    moves = press.get("moves") or []
    status = np.array(press.get("status") or [0], int)
    status[-1] &= ~1  # at depth_max itself, the field's depth may be microns beyond it
    bits = int(np.bitwise_or.reduce(status))
    return {
        "number": number,
        "contact_point": press["contact_point"],
        "normal": press["normal"],
        "converged": press["converged"],
        "reason": press.get("reason") or "",
        "runtime": ", ".join(words for bit, words in _TICK_WORDS.items() if bits & bit),
        "radius": press.get("radius"),
        "tilt": press.get("tilt"),
        "depth_reached": float(press["depth"][-1]) if press["depth"] else None,
        "force_deepest": curves["fem"]["normal"][-1] if len(fem) else None,
        "states_judged": sum(error is not None for error in press["force_error"]),
        "force_error_max": _largest(press["force_error"]),
        "lateral_error_max": _largest(press["lateral_error"]),
        "stuck_error_max": _largest([move.get("error") for move in moves]),
        "seconds": press.get("seconds"),
        "hash": press.get("hash") or "",
        "depth": press["depth"],
        "curves": curves,
    }


def _push_direction(fem: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Unit tangent along the deepest FEM push; any tangent where there is none."""
    push = fem[-1] - (fem[-1] @ n) * n if len(fem) else np.zeros(3)
    size = np.linalg.norm(push)
    if size > 1e-9 * max(float(np.abs(fem).max(initial=0.0)), 1e-30):
        return push / size
    tangent = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    return tangent / max(float(np.linalg.norm(tangent)), 1e-30)


def _largest(errors: list[float | None]) -> float | None:
    return max((error for error in errors if error is not None), default=None)
