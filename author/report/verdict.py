# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The verdict in plain words: what was asked, what was reached, at how many points, and why it falls short."""

from __future__ import annotations

from typing import Any

from palpate.author.report.numbers import asked, percent

__all__ = ["JUST_NOTICEABLE", "headline", "overall", "verdict"]

JUST_NOTICEABLE = 0.07
"""Smallest relative difference of force that people notice (measured at 2.5 to 10 N; larger for smaller forces)."""

_KINDS = {
    "force_error": "normal force",
    "lateral_error": "lateral push",
    "stuck_error": "force after a sticking move",
    "slid_error": "force after sliding",
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
    reached = (
        f"{name}: the rendered normal force is within {percent(error['p95'])} of finite elements at 95 % of the states "
        f"of {_places(points)} (asked for {asked(tolerance)}), within {percent(error['p50'])} at half of them, and "
        f"{percent(error['max'])} off at worst (asked for {asked(2 * tolerance)})."
    )
    if validation["met"]:
        return {"state": "met", "sentence": reached}
    why = "; ".join(_shortfalls(validation)) or "validation says so"
    return {"state": "missed", "sentence": f"{reached} It falls short: {why}."}


def overall(verdicts: list[dict[str, str]]) -> str:
    """One of STATES for the whole asset: the worst of its tools'."""
    found = {one["state"] for one in verdicts}
    return "missed" if "missed" in found else "unjudged" if "unjudged" in found or not found else "met"


def headline(tools: list[dict[str, Any]], left_out: dict[str, int], places: int | None) -> str:
    """The report in one line: met or not and by how much, what failed, what was left out.

    Args:
        tools: entries of the report's tools (name, verdict, validation, judged, failures).
        left_out: sampled places of the reach that were not pressed, by reason.
        places: sampled places of the reach; None where nobody counted them.
    """
    by_state = {state: [tool for tool in tools if tool["verdict"]["state"] == state] for state in STATES}
    parts = [_missed(tool) for tool in by_state["missed"]]
    for tool in by_state["met"]:
        error = tool["validation"]["force_error"]
        parts.append(
            f"{tool['name']} is within {percent(error['p95'])} of finite elements at 95 % of held-out states "
            f"and {percent(error['max'])} off at worst, where {asked(tool['validation']['tolerance'])} and "
            f"{asked(2 * tool['validation']['tolerance'])} were asked for"
        )
    parts += [f"{tool['name']} was never compared with finite elements" for tool in by_state["unjudged"]]
    building = sum(len(tool["failures"]) for tool in tools)
    judging = sum(tool["judged"]["points"] - tool["judged"]["converged"] for tool in tools)
    rest = []
    if building or judging:
        parts_of = [(building, "that build the field"), (judging, "that judge it")]
        told = " and ".join(f"{_presses(count)} {what}" for count, what in parts_of if count)
        rest.append(f"{told} failed or stopped early")
    if left_out:
        of = f" of {places}" if places else ""
        count = sum(left_out.values())
        rest.append(
            f"{count}{of} sampled places {'was' if count == 1 else 'were'} left out ({', '.join(left_out)})"
        )
    words = {"met": "Met", "missed": "Not met", "unjudged": "Not judged"}
    state = overall([tool["verdict"] for tool in tools])
    line = f"{words[state]}: " + "; ".join(parts or ["the asset has no tool"]) + "."
    said = "; ".join(rest)
    return f"{line} {said[0].upper()}{said[1:]}." if said else line


def _missed(tool: dict[str, Any]) -> str:
    """By how much, by the error that is furthest beyond what was asked."""
    validation = tool["validation"]
    tolerance = validation["tolerance"]
    shares = [
        (error[column] / (factor * tolerance), words, column, error[column], factor * tolerance)
        for key, words in _KINDS.items()
        for column, factor in (("p95", 1.0), ("max", 2.0))
        if (error := validation.get(key)) is not None
    ]
    share, words, column, value, bar = max(shares)
    if share <= 1.0:
        return f"{tool['name']}: {'; '.join(_shortfalls(validation)) or 'validation says so'}"
    where = "at the 95th percentile" if column == "p95" else "at worst"
    times = f"{share:.1f} times the {asked(bar)} that was asked for"
    return f"{tool['name']}'s {words} is {percent(value)} off {where}, {times}"


def _shortfalls(validation: dict[str, Any]) -> list[str]:
    tolerance = validation["tolerance"]
    out = []
    for key, name in _KINDS.items():
        error = validation.get(key)
        if error is None:
            continue
        over = []
        if error["p95"] > tolerance:
            over.append(f"{percent(error['p95'])} at the 95th percentile is above {asked(tolerance)}")
        if error["max"] > 2.0 * tolerance:
            over.append(f"{percent(error['max'])} at worst is above {asked(2 * tolerance)}")
        if over:
            out.append(f"the {name}'s {' and '.join(over)}")
    failed = validation.get("failed", 0)
    if failed:
        out.append(f"{failed} held-out press{'es' if failed > 1 else ''} failed or stopped early")
    return out


def _presses(count: int) -> str:
    return f"{count} press{'' if count == 1 else 'es'}"


def _places(count: int) -> str:
    return f"{count} held-out point{'' if count == 1 else 's'}"
