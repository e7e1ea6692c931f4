# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report as data: all that the page shows, as one JSON dict.  SI units; errors as fractions."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from palpate.author.haptic_device import HapticDevice
from palpate.author.report.device_map import DeviceMap
from palpate.author.report.gather import Sources
from palpate.author.report.held_out_rows import held_out_rows, pooled, worst_rows
from palpate.author.report.maps import ReachMap
from palpate.author.report.verdict import JUST_NOTICEABLE, overall, verdict
from palpate.fields.largest_stiffness import largest_stiffness
from palpate.fields.response_field import ResponseField, ResponseNodes

__all__ = ["contents"]

FULL_DEPTH = 1.0 - 1e-6
"""A node whose press reached less than this share of depth_max has extrapolated curves."""

WORST_SHARE = 0.05
"""Share of the reach beyond the 95th percentile: n points drawn evenly all miss it with chance 0.95^n."""


def contents(
    sources: Sources, maps: list[ReachMap], device_maps: list[DeviceMap] | None = None
) -> dict[str, Any]:
    """The report; `maps` holds one per field, and `device_maps` where the sources have a device."""
    summary = sources.summary
    tools = [
        _tool(field, validation, pairs, reach, summary)
        for field, validation, pairs, reach in zip(
            sources.fields, sources.validations, sources.two_contacts, maps, strict=True
        )
    ]
    for tool, made in zip(tools, device_maps or [], strict=False):
        assert sources.device is not None
        tool["device"] = _device(sources.device, made, tool["field"]["stiffness_max"])
    notes = list(sources.notes)
    for tool, reach in zip(tools, maps, strict=True):
        if reach.unstored_share > 0.002:
            share = f"{100 * reach.unstored_share:.1f}"
            notes.append(
                f"{tool['name']}: {share} % of the reach's area has no stored field and is drawn plain."
            )
    return {
        "format": 1,
        "organ": sources.organ.name,
        "verdict": {
            "state": overall([tool["verdict"] for tool in tools]),
            "sentences": [tool["verdict"]["sentence"] for tool in tools],
        },
        "just_noticeable_difference": JUST_NOTICEABLE,
        "tools": tools,
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
}


def _tool(
    field: ResponseField,
    validation: dict[str, Any] | None,
    pairs: dict[str, Any] | None,
    reach: ReachMap,
    summary: dict[str, Any],
) -> dict[str, Any]:
    name = field.tool.name
    rows = held_out_rows(validation)
    points = (validation or {}).get("points", len(rows))
    converged = sum(row["converged"] for row in rows)
    authored = next((one for one in summary.get("tools") or [] if one.get("name") == name), {})
    known = summary.get("failures", field.provenance.get("failed_presses"))
    failures = [one for one in known or [] if one.get("tool", name) == name]
    return {
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
            **{key: len(pooled(validation, key)) for key in ("force_error", "lateral_error", "stuck_error")},
        },
        "held_out": rows,
        "worst": worst_rows(rows),
        "two_contacts": [_pair(pair) for pair in (pairs or {}).get("pairs", [])],
        "nodes": _nodes(field.nodes, field.depth_max),
        "failures": failures,
        "representation": field.representation,
        "field": _field(field, reach),
        "rfield_bytes": authored.get("bytes"),
        "device": None,
        "bench": _bench(summary.get("bench") or authored.get("bench"), name),
        "provenance": _rows(field.provenance),
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


def _nodes(nodes: ResponseNodes, depth_max: float) -> dict[str, Any]:
    short = nodes.depth_reached < FULL_DEPTH * depth_max
    known = nodes.residual[nodes.pressed]
    kind = np.where(~nodes.pressed, "derived", np.where(short, "extrapolated", "pressed"))
    return {
        "count": nodes.node_count,
        **{name: int(np.sum(kind == name)) for name in ("pressed", "extrapolated", "derived")},
        "residual": _percentiles(known),
        "rows": [
            {
                "position": nodes.position[i],
                "kind": str(kind[i]),
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
