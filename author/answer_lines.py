# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Answers as people read them on a terminal, a few lines each; JSON has all that is in them."""

from __future__ import annotations

from math import degrees
from typing import Any

__all__ = ["author_lines", "certify_lines", "percentiles", "replay_lines", "two_contact_lines"]


def author_lines(result: dict[str, Any]) -> str:
    """Of what `palpate author` found (pipeline.py)."""
    lines = [f"{result['asset']}: {result['seconds']:.0f} s, {result['cpu_seconds']:.0f} s of CPU"]
    for tool in result["tools"]:
        presses = f"{tool['presses']} presses ({tool['failed']} failed), {tool['nodes']} nodes"
        size = f"{tool['bytes'] / 1024:.0f} KiB"
        lines.append(f"{tool['name']}: {presses}, {size}; force error {percentiles(tool['force_error'])}")
        if family := tool.get("family"):
            lines += [f"{tool['name']}: {_of_radius(row)}" for row in family["radii"]]
        lines += [f"{tool['name']}: {_of_way(row)}" for row in tool.get("ways", ())]
        if sampling := tool.get("sampling"):
            lines.append(
                f"{tool['name']}: sampling ended: {sampling['ended']}{_estimated(sampling['rounds'])}"
            )
    lines.append("tolerance met" if result["tolerance_met"] else "tolerance NOT met")
    return "\n".join(lines)


def _of_radius(row: dict[str, Any]) -> str:
    how = "pressed" if row["pressed"] else "between pressed radii"
    error = percentiles(row["force_error"]) if row["force_error"] else "not known"
    return f"radius {1e3 * row['radius']:.4g} mm ({how}, {row['points']} points) force error {error}"


def _of_way(row: dict[str, Any]) -> str:
    how = "pressed" if row["pressed"] else "between pressed tilts"
    error = percentiles(row["force_error"]) if row["force_error"] else "not known"
    return f"tilted by {degrees(row['tilt']):.3g} deg ({how}, {row['points']} points) force error {error}"


def _estimated(rounds: dict[str, Any]) -> str:
    if not rounds:
        return ""
    last = {name: values[-1] for name, values in rounds.items()}
    return (
        f"; at {last['nodes']} nodes an estimated {100 * last['estimate']:.2g} % at 95 % of the reach, "
        f"{100 * last['worst']:.2g} % at worst, no place farther than {1e3 * last['gap']:.1f} mm from a node"
    )


def replay_lines(result: dict[str, Any]) -> str:
    """Of what `palpate replay` found (replay.py)."""
    names = (
        "work_in",
        "organ_work",
        "stored_energy",
        "dissipated_friction",
        "dissipated_rule",
        "hold_leak",
        "balance_error",
    )
    lines = [f"{result['ticks']} ticks, {result['seconds']:.3g} s, at most {result['force_max_seen']:.3g} N"]
    lines += [f"{name}: {result[name]:.6g} J" for name in names]
    return "\n".join(lines + [f"{count} ticks: {sentence}" for sentence, count in result["status"].items()])


def certify_lines(result: dict[str, Any]) -> str:
    """Of what `palpate certify` found (certify.py)."""
    device = result["device"]
    named = f"{device['name']}, " if device["name"] else ""
    lines = [
        f"{named}{device['rate']:.4g} Hz, damping {device['damping']:.3g} N s/m"
        + "".join(f"; taken: {clause}" for clause in device["assumed"]),
        f"{result['field']}: stiffness up to {result['stiffness_max']:.4g} N/m",
        f"damping needed: {result['damping_needed']:.3g} N s/m",
        f"dry friction needed: {result['dry_friction_needed']:.3g} N",
        f"places rendered without a hum: {100 * result['sampling_share']:.1f} %",
        f"places where friction hides what an axial response leaves out: {100 * result['sliding_share']:.1f} % of the "
        f"{100 * result['sliding_judged']:.1f} % of contact above {result['sliding_floor']:.2g} N; "
        f"all of them at a friction coefficient of {result['friction_needed']:.2g}",
    ]
    if result["force_share"] is not None:
        lines.append(
            f"places within the device's {device['max_force']:.3g} N: {100 * result['force_share']:.1f} %"
        )
    if drawn := result.get("map"):
        share = "none" if drawn["share"] is None else f"{100 * drawn['share']:.1f} %"
        lines.append(f"{drawn['file']}: {share} of the reach without a hum at any depth")
    for row in result.get("simulated", ()):
        ends = "rests" if row["rests"] else "never rests"
        lines.append(
            f"simulated, damping {row['damping_over_bound']:.2f} of the bound at {row['stiffness']:.3g} N/m: {ends} "
            f"({1e3 * row['speed_early']:.3g} mm/s, later {1e3 * row['speed_late']:.3g} mm/s)"
        )
    if "texture" in result:
        from palpate.author.texture.certify_texture import texture_lines

        lines += texture_lines(result["texture"])
    return "\n".join([*lines, result["sentence"]])


def percentiles(error: dict[str, float]) -> str:
    """An error's p50, p95 and max (fractions) in percent."""
    return ", ".join(f"{key} {100 * error[key]:.2f} %" for key in ("p50", "p95", "max"))


def two_contact_lines(result: dict[str, Any]) -> str:
    """Of what `palpate validate --apart` found (two_contacts.py)."""
    deepest = 1e3 * result["depth"][-1]
    lines = [
        f"{1e3 * pair['distance']:.1f} mm apart, both {deepest:.1f} mm deep: a field of one contact is off by "
        f"{100 * max(abs(row[-1]) for row in pair['normal_error']):.1f} % in normal and by "
        f"{100 * max(row[-1] for row in pair['lateral_error']):.1f} % in lateral force"
        for pair in result["pairs"]
    ]
    return "\n".join(lines)
