# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The verdict in plain words: what was asked, what was reached, at how many points, and why it falls short."""

from __future__ import annotations

from typing import Any

from palpate.author.report.numbers import asked, percent

__all__ = ["JUST_NOTICEABLE", "overall", "verdict"]

JUST_NOTICEABLE = 0.07
"""Smallest relative difference of force that people notice (measured at 2.5 to 10 N; larger for smaller forces)."""

_KINDS = {
    "force_error": "",
    "lateral_error": " of the lateral push",
    "stuck_error": " after a sticking move",
    "slid_error": " after sliding",
}

STATES = ("met", "missed", "unjudged")


def verdict(name: str, validation: dict[str, Any] | None, points: int, converged: int) -> dict[str, str]:
    """State (one of STATES) and sentence for one tool.

    Args:
        validation: content of validation/<tool>.json, or None.
        points: held-out points asked for.
        converged: those whose finite-element press converged.
    """
    if validation is None:
        return {
            "state": "unjudged",
            "sentence": f"{name}: no held-out press has been compared with this field.",
        }
    error, tolerance = validation.get("force_error"), validation["tolerance"]
    if error is None:
        return {
            "state": "unjudged",
            "sentence": f"{name}: none of {_places(points)} gave a force that could be compared.",
        }
    fidelity = validation.get("fidelity") or "the"
    reached = (
        f"{name}: asked for {asked(tolerance)} (rendered normal force against {fidelity} finite elements, 95th "
        f"percentile); reached {percent(error['p95'])}, half of the states within {percent(error['p50'])}, the worst "
        f"{percent(error['max'])}, at {_places(points)}"
        + (f", {points - converged} of which failed or stopped early" if converged != points else "")
    )
    if validation["met"]:
        return {"state": "met", "sentence": f"{reached}. The tolerance is met."}
    why = "; ".join(_shortfalls(validation)) or "validation says so"
    return {"state": "missed", "sentence": f"{reached}. The tolerance is not met: {why}."}


def overall(verdicts: list[dict[str, str]]) -> str:
    """One of STATES for the whole asset: the worst of its tools'."""
    found = {one["state"] for one in verdicts}
    return "missed" if "missed" in found else "unjudged" if "unjudged" in found or not found else "met"


def _shortfalls(validation: dict[str, Any]) -> list[str]:
    tolerance = validation["tolerance"]
    out = []
    for key, name in _KINDS.items():
        error = validation.get(key)
        if error is None:
            continue
        if error["p95"] > tolerance:
            out.append(f"the 95th percentile{name}, {percent(error['p95'])}, is above {asked(tolerance)}")
        if error["max"] > 2.0 * tolerance:
            worst = percent(error["max"])
            out.append(f"the worst{name}, {worst}, is above twice the tolerance, {asked(2 * tolerance)}")
    failed = validation.get("failed", 0)
    if failed:
        out.append(f"{failed} held-out press{'es' if failed > 1 else ''} failed or stopped early")
    return out


def _places(count: int) -> str:
    return f"{count} held-out point{'' if count == 1 else 's'}"
