# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where a field's numbers stand against the limits that palpate promises or asks for.

Bars are the runtime's own numbers to reach (tick, opening, size) and the bounds of the model (depth, distance, one
contact).
"""

from __future__ import annotations

from typing import Any

from palpate.author.report.verdict import JUST_NOTICEABLE

__all__ = ["limit_rows"]

FULL_DEPTH = 1.0 - 1e-6
"""A node whose press reached less than this share of depth_max has extrapolated curves."""
GEOMETRY_SHARE = 0.01
"""Of depth_max; error of the contact geometry at the 99th percentile."""
FILE_BYTES = 2**20
"""For 150 cm² of reach and a tool."""
UNSTORED_SHARE = 0.002
"""Of the reach's area, drawn plain for want of a stored field; less is the border's triangles."""
TICK_BARS = (
    ("stick_ns", "p50", 180.0, "Tick in contact, sticking, median"),
    ("slide_ns", "p50", 180.0, "Tick in contact, sliding, median"),
    ("stick_ns", "p999", 350.0, "Tick in contact, sticking, 99.9th percentile"),
    ("slide_ns", "p999", 350.0, "Tick in contact, sliding, 99.9th percentile"),
    ("free_ns", "p50", 60.0, "Tick in free space, median"),
    ("cold_ns", "p50", 1300.0, "Tick after 6 MB of other memory, median"),
    ("cold_ns", "p999", 3000.0, "Tick after 6 MB of other memory, 99.9th percentile"),
)
"""ns, on a 2.5 GHz x86 core."""
OPENING_MS = 10.0


def limit_rows(tool: dict[str, Any]) -> list[dict[str, Any]]:
    """Rows {name, bar, value, kind, state, note} of one entry of the report's tools.

    state: within, beyond, or unknown where nothing was measured; kind: how numbers are written (numbers.py).
    """
    field, nodes, bench = tool["field"], tool["nodes"], tool["bench"] or {}
    depth_max = field["depth_max"]
    shallowest = min((row["depth_reached"] for row in nodes["rows"]), default=None)
    rows = [
        _row(
            "Depth that every node was pressed to", depth_max, shallowest, "mm",
            shallowest is not None and shallowest >= FULL_DEPTH * depth_max,
            "Deeper than its press a node's force goes on with its last slope, and the tick's status says so.",
        ),
        _row(
            "Error of the contact geometry, 99th percentile", GEOMETRY_SHARE * depth_max, field["geometry_error_p99"],
            "um", field["geometry_error_p99"] <= GEOMETRY_SHARE * depth_max, "At most 1 % of depth_max.",
        ),
        _row(
            "Share of the reach without a stored field", UNSTORED_SHARE, field["unstored_share"], "percent",
            field["unstored_share"] <= UNSTORED_SHARE, "There the tick gives no force and says why.",
        ),
        _row(
            "Share of the geometry flagged as crease or thin lobe", 0.0, field["flagged_share"], "percent",
            field["flagged_share"] == 0.0, "There the distance is not smooth.",
        ),
        _row(
            "Held-out presses where the runtime had something to say", 0,
            sum(bool(row["runtime"]) for row in tool["held_out"]) if tool["validation"] else None, "count",
            not any(row["runtime"] for row in tool["held_out"]), "Its words stand in the table of held-out presses.",
        ),
        _row("Cooked file", FILE_BYTES, tool["rfield_bytes"], "bytes",
             (tool["rfield_bytes"] or 0) <= FILE_BYTES, "For 150 cm² of reach and a tool."),
    ]  # fmt: skip
    for key, column, bar, name in TICK_BARS:
        value = (bench.get(key) or {}).get(column)
        rows.append(_row(name, bar, value, "ns", value is not None and value <= bar, ""))
    opened = bench.get("load_ms")
    rows.append(_row("Opening", OPENING_MS, opened, "ms", opened is not None and opened <= OPENING_MS, ""))
    pairs = tool["two_contacts"]
    nearest = min(pairs, key=lambda pair: pair["distance"]) if pairs else None
    rows.append(
        _row("Force that is wrong when two of this tool touch at once, nearest pair", JUST_NOTICEABLE,
             nearest and nearest["normal"], "percent", bool(nearest and nearest["normal"] <= JUST_NOTICEABLE),
             "The field knows one contact; the bar is what people notice.")
    )  # fmt: skip
    return rows


def _row(name: str, bar: float, value: float | None, kind: str, within: bool, note: str) -> dict[str, Any]:
    state = "unknown" if value is None else "within" if within else "beyond"
    return {"name": name, "bar": bar, "value": value, "kind": kind, "state": state, "note": note}
