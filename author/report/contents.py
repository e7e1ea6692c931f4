# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report as data: all that the page shows, as one JSON dict.  SI units; errors as fractions."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from palpate.author.haptic_device import HapticDevice
from palpate.author.report.device_map import DeviceMap
from palpate.author.report.device_rows import RATE, device_rows
from palpate.author.report.estimate import DEVIATIONS
from palpate.author.report.gather import Sources
from palpate.author.report.held_out_rows import held_out_rows, pooled, worst_rows
from palpate.author.report.limits import FULL_DEPTH, UNSTORED_SHARE, limit_rows
from palpate.author.report.maps import ReachMap
from palpate.author.report.node_origins import ORIGINS, node_origins
from palpate.author.report.on_reach import OnReach
from palpate.author.report.sizes import rfield_sections
from palpate.author.report.texture_part import texture_row
from palpate.author.report.transient_part import transient_row
from palpate.author.report.verdict import JUST_NOTICEABLE, headline, overall, verdict
from palpate.author.report.verification_rows import verification
from palpate.fields.largest_stiffness import largest_stiffness
from palpate.fields.response_field import ResponseField

__all__ = ["contents"]

WORST_SHARE = 0.05
"""Share of the reach beyond the 95th percentile: n points drawn evenly all miss it with chance 0.95^n."""


def contents(sources: Sources, reaches: list[OnReach]) -> dict[str, Any]:
    """The report; `reaches` holds one per field."""
    summary = sources.summary
    tools = [_tool(sources, index, reach) for index, reach in enumerate(reaches)]
    for tool, reach in zip(tools, reaches, strict=True):
        if reach.device is not None and sources.device is not None:
            tool["device"] = _device(sources.device, reach.device, tool["field"]["stiffness_max"])
    notes = list(sources.notes)
    for tool, reach in zip(tools, reaches, strict=True):
        if reach.map.unstored_share > UNSTORED_SHARE:
            share = f"{100 * reach.map.unstored_share:.1f}"
            notes.append(
                f"{tool['name']}: {share} % of the reach's area has no stored field and is drawn plain."
            )
        notes += [reach.estimate_missing] if reach.estimate_missing else []
    left_out = summary.get("left_out") or {}
    places = (summary.get("reach") or {}).get("places")
    return {
        "format": 2,
        "organ": sources.organ.name,
        "verdict": {
            "state": overall([tool["verdict"] for tool in tools]),
            "line": headline(tools, left_out, places),
            "sentences": [tool["verdict"]["sentence"] for tool in tools],
        },
        "just_noticeable_difference": JUST_NOTICEABLE,
        "device_rate": RATE,
        "tools": tools,
        "left_out": [{"reason": reason, "places": count} for reason, count in left_out.items()],
        "reach": summary.get("reach"),
        "verification": verification(sources),
        "files": sources.files,
        "bytes": sum(file["bytes"] for file in sources.files),
        "seconds": summary.get("seconds"),
        "cpu_seconds": summary.get("cpu_seconds"),
        "stages": summary.get("stages") or [],
        "organ_provenance": _rows(sources.organ.provenance),
        "material": _rows({"tissue": sources.organ.material, **sources.organ.region_materials}),
        "making": _rows({key: value for key, value in summary.items() if key not in _SHOWN_ELSEWHERE}),
        "notes": notes,
        "pictures": [],
        "summary": summary,
    }


_SHOWN_ELSEWHERE = {
    "asset",
    "tools",
    "seconds",
    "cpu_seconds",
    "stages",
    "failures",
    "bench",
    "device",
    "device_unknown",
    "tolerance_met",
    "left_out",
    "reach",
}


def _tool(sources: Sources, index: int, reach: OnReach) -> dict[str, Any]:
    field, validation = sources.fields[index], sources.validations[index]
    summary, pairs = sources.summary, sources.two_contacts[index]
    name = field.tool.name
    rows = held_out_rows(validation)
    points = (validation or {}).get("points", len(rows))
    converged = sum(row["converged"] for row in rows)
    authored = next((one for one in summary.get("tools") or [] if one.get("name") == name), {})
    known = summary.get("failures", field.provenance.get("failed_presses"))
    failures = [one for one in known or [] if one.get("tool", name) == name]
    errors = pooled(validation, "force_error")
    cooked = sources.asset / f"{name}.rfield"
    facts = _field(field, reach.map)
    deepest = facts["force_deepest"]["max"] if facts["force_deepest"] else 0.0
    tool = {
        "name": name,
        "shape": field.tool.shape,
        "parameters": field.tool.parameters,
        "hash": field.tool.hash,
        "verdict": verdict(name, validation, points, converged),
        "validation": validation,
        "judged": {
            "points": points,
            "converged": converged,
            "worst_places_missed": (1.0 - WORST_SHARE) ** converged,
            "noticeable_share": float(np.mean(np.array(errors) > JUST_NOTICEABLE)) if errors else None,
            **{
                key: len(pooled(validation, key))
                for key in ("force_error", "lateral_error", "stuck_error", "slid_error")
            },
        },
        "held_out": rows,
        "worst": worst_rows(rows),
        "fresh": sources.fresh[index],
        "two_contacts": [_pair(pair) for pair in (pairs or {}).get("pairs", [])],
        "two_contacts_depth": (pairs or {}).get("depth"),
        "nodes": _nodes(field, authored.get("node_origins")),
        "sampling": authored.get("sampling") or field.provenance.get("sampling"),
        "estimate": _estimate(reach, rows),
        "failures": failures,
        "failure_count": len(failures),
        "representation": field.representation,
        "field": facts,
        "rfield_bytes": authored.get("bytes") or (cooked.stat().st_size if cooked.is_file() else None),
        "sections": rfield_sections(cooked),
        "devices": device_rows(reach.sigma, reach.map, facts["stiffness_max"], deepest),
        "device": None,
        "texture": texture_row(field),
        "transient": transient_row(field),
        "bench": _bench(sources.ticks[index] or summary.get("bench") or authored.get("bench"), name),
        "provenance": _rows(field.provenance),
    }
    return tool | {"limits": limit_rows(tool)}


def _estimate(reach: OnReach, rows: list[dict[str, Any]]) -> dict[str, Any] | None:
    """What is estimated over the reach, and how many held-out errors stay below it; adds it to each row."""
    for row in rows:
        row["estimate"] = None
    if reach.estimate is None or reach.error is None:
        return None
    judged = [row for row in rows if row["force_error_max"] is not None]
    places = np.array([[row["contact_point"], row["normal"]] for row in judged]).reshape(-1, 2, 3)
    for row, value in zip(judged, reach.estimate.at(places[:, 0], places[:, 1]), strict=True):
        row["estimate"] = float(value)
    below = sum(row["force_error_max"] <= row["estimate"] for row in judged)
    return {
        "deviations": DEVIATIONS,
        "correction": reach.estimate.correction,
        "reach": _percentiles(reach.error),
        "held_out_below": below / len(judged) if judged else None,
        "held_out": len(judged),
    }


def _device(device: HapticDevice, made: DeviceMap, stiffness_max: float) -> dict[str, Any]:
    """What `palpate certify` says of the device, by the field's largest stiffness, and the share that the map shows."""
    longest = 2.0 * (device.damping / stiffness_max - device.delay) if stiffness_max > 0 else None  # s
    return {
        **dataclasses.asdict(device),
        "met": stiffness_max <= made.allowed,
        "stiffness_allowed": made.allowed if np.isfinite(made.allowed) else None,
        "rate_needed": 1.0 / longest if longest is not None and longest > 0 else None,
        "share": made.share,
        "picture": None,
    }


def _pair(pair: dict[str, Any]) -> dict[str, float]:
    """The worse of two tools, half as deep as they go and at their deepest."""
    worst = {name: np.abs(pair[f"{name}_error"]).max(axis=0) for name in ("normal", "lateral")}
    halves = {f"{name}_half": value[0] for name, value in worst.items()}
    return {"distance": pair["distance"], **halves, **{name: value[-1] for name, value in worst.items()}}


def _nodes(field: ResponseField, recorded: dict[str, list[str]] | None) -> dict[str, Any]:
    nodes = field.nodes
    short = nodes.depth_reached < FULL_DEPTH * field.depth_max
    known = nodes.residual[nodes.pressed]
    kind = np.where(~nodes.pressed, "derived", np.where(short, "extrapolated", "pressed"))
    why = node_origins(field, recorded)
    return {
        "count": nodes.node_count,
        **{name: int(np.sum(kind == name)) for name in ("pressed", "extrapolated", "derived")},
        "why": [
            {"key": key, "words": words, "count": why.count(key)}
            for key, words in ORIGINS.items()
            if key in why
        ],
        "radii": [member.radius for member in field.family],
        "tilts": [field.tool.tilt, *(way.tool.tilt for way in field.ways)] if field.ways else [],
        "residual": _percentiles(known),
        "rows": [
            {
                "position": nodes.position[i],
                "kind": str(kind[i]),
                "why": why[i],
                "depth_reached": nodes.depth_reached[i],
                "force_deepest": nodes.normal_force[i, -1],
                "residual": nodes.residual[i],
                "hash": str(nodes.press_hash[i]),
            }
            for i in range(nodes.node_count)
        ],
    }


def _field(field: ResponseField, reach: ReachMap) -> dict[str, Any]:
    geometry = field.geometry
    return {
        "depth_max": field.depth_max,
        "stiffness_max": max(largest_stiffness(way) for way in field.fields_by_way()),
        "force_deepest": _range(reach.values["normal_force"][-1]),
        "stiffness_deepest": _range(reach.values["stiffness"][-1]),
        "knots": len(field.nodes.depth_knots),
        "energy_curves": field.energy_curves.curve_count,
        "stiffness_curves": field.stiffness_curves.curve_count,
        "friction_curves": field.friction_curves.curve_count,
        "geometry_spacing": geometry.signed_distance.spacing,
        "geometry_blocks": geometry.signed_distance.block_count,
        "geometry_error_p99": geometry.error_p99,
        "flagged_share": geometry.flagged_share,
        "unstored_share": reach.unstored_share,
        "area": reach.area,
        "friction": _range(reach.values["friction_coefficient"][-1]),
        "amplitude_spacing": field.amplitudes.spacing,
        "amplitude_blocks": field.amplitudes.block_count,
    }


def _range(values: np.ndarray) -> dict[str, float] | None:
    if not values.size:
        return None
    return {"min": float(values.min()), "p50": float(np.median(values)), "max": float(values.max())}


def _percentiles(values: np.ndarray) -> dict[str, float] | None:
    if not values.size:
        return None
    p50, p95 = np.percentile(values, [50, 95])
    return {"p50": float(p50), "p95": float(p95), "max": float(values.max())}


def _bench(bench: Any, name: str) -> dict[str, Any] | None:
    """Tick times of one tool: `bench` is either its own or holds one for each tool's name."""
    if isinstance(bench, dict) and isinstance(bench.get(name), dict):
        bench = bench[name]
    if not isinstance(bench, dict) or not any(key.endswith("_ns") for key in bench):
        return None
    return bench


def _rows(values: dict[str, Any], head: str = "") -> list[dict[str, str]]:
    """Nested values as flat rows of key and text; long lists of numbers are named by their length."""
    out: list[dict[str, str]] = []
    for key, value in values.items():
        name = f"{head}{key}"
        if isinstance(value, dict) and value:
            out += _rows(value, f"{name}.")
        elif isinstance(value, (list, tuple)) and value and all(isinstance(item, dict) for item in value):
            for index, item in enumerate(value):
                out += _rows(item, f"{name}[{index}].")
        elif value not in (None, "", [], {}, ()):
            out.append({"key": name, "value": _text(value)})
    return out


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(_text(item) for item in value) if len(value) <= 40 else f"{len(value)} values"
    return str(value)
