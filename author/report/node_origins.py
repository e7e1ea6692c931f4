# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Why each node is where it is: what the run recorded, or what follows from its settings where it recorded nothing.

A run presses seeds first, spread evenly and then above the regions that the scene names; after them places are chosen
by estimated error.  Assets that were made before this was recorded hold the nodes in that order, so that counts tell
them apart, unless a press that failed is missing from the row.
"""

from __future__ import annotations

from typing import Any

from palpate.author.effort import region_nodes, seed_count
from palpate.fields.response_field import ResponseField

__all__ = ["ORIGINS", "node_origins"]

ORIGINS = {
    "seed": "spread evenly, pressed first",
    "region": "above a region that the scene names",
    "error": "where the field was estimated to be furthest off",
    "unknown": "not recorded",
}
"""Words for each reason."""


def node_origins(field: ResponseField, recorded: dict[str, list[str]] | None) -> list[str]:
    """A key of ORIGINS for each node, in their order.

    Args:
        recorded: beginnings of press hashes by key (ToolWork.node_origins), where the summary has them.
    """
    hashes = [str(one) for one in field.nodes.press_hash]
    if not recorded:
        return _inferred(field, hashes)
    length = min((len(key) for keys in recorded.values() for key in keys), default=0)
    why = {key[:length]: word for word, keys in recorded.items() for key in keys}
    parts = [[part[:length] for part in name.split("+")] for name in hashes]
    return [next((why[part] for part in own if part in why), "unknown") for own in parts]


def _inferred(field: ResponseField, hashes: list[str]) -> list[str]:
    count = len(hashes)
    sampling: dict[str, Any] = field.provenance.get("sampling") or {}
    lost = [
        one["hash"] for one in field.provenance.get("failed_presses") or [] if one.get("hash") not in hashes
    ]
    if "most" not in sampling or "scene" not in field.provenance or lost or field.ways or field.family:
        return ["unknown"] * count
    regions = len(field.provenance["scene"].get("region") or [])
    even = seed_count(int(sampling["most"]) - region_nodes(regions))
    first = (sampling.get("rounds") or {}).get("nodes") or [count]
    begun = min(int(first[0]), count)
    even = min(even, begun) if regions else begun
    return ["seed"] * even + ["region"] * (begun - even) + ["error"] * (count - begun)
