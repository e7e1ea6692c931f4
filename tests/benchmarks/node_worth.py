# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Print what the nodes of an authored asset are worth: `python tests/benchmarks/node_worth.py ASSET [--tool NAME]`.

The asset's field is built anew from its node curves, from the seeds alone and from all nodes, with and without the
lateral reactions B as gradient data, and judged by the asset's own held-out presses (validation/*.json: every file of
the tool, so fresh points of `palpate validate` count too).  Nothing is pressed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.authored_tool import AuthoredTool, authored_tool
from palpate.author.field_stage import REACH_MARGIN
from palpate.author.held_out import FLOOR
from palpate.fields.build_field import build_field
from palpate.fields.interpolation import evaluate
from palpate.fields.response_field import ResponseField, ResponseNodes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("asset", type=Path)
    parser.add_argument("--tool")
    given = parser.parse_args()
    authored = authored_tool(given.asset, given.tool)
    presses = list(held_out(given.asset, authored.field.tool.name))
    nodes = authored.field.nodes
    seeds = authored.field.provenance["sampling"]["rounds"]["nodes"][0]
    print(
        f"{authored.field.tool.name}: {nodes.node_count} nodes, {seeds} of them seeds; {len(presses)} held-out presses"
    )
    print("nodes  B     normal % p50   p95   max   lateral % p50   p95   max")
    for count in sorted({seeds, nodes.node_count}):
        for with_gradients in (True, False):
            field = rebuilt(authored, first(nodes, count), with_gradients)
            normal, lateral = errors(field, presses)
            shown = "".join(f"{100 * x:7.2f}" for x in (*normal, *lateral))
            print(f"{count:5d}  {'yes' if with_gradients else 'no':4}  {shown}", flush=True)


def held_out(asset: Path, tool: str) -> Iterator[dict[str, Any]]:
    seen = set()
    for path in sorted((asset / "validation").glob(f"{tool}*.json")):
        for press in json.loads(path.read_text()).get("presses", ()):
            if press["converged"] and press["hash"] not in seen:
                seen.add(press["hash"])
                yield press


def first(nodes: ResponseNodes, count: int) -> ResponseNodes:
    """The first `count` nodes, in the order in which they were chosen."""
    rows = {
        f.name: getattr(nodes, f.name)[:count]
        for f in fields(nodes)
        if isinstance(getattr(nodes, f.name), np.ndarray) and f.name != "depth_knots"
    }
    return replace(nodes, **rows)


def rebuilt(authored: AuthoredTool, nodes: ResponseNodes, with_gradients: bool) -> ResponseField:
    field = authored.field
    reach = authored.samples.beyond(authored.mesh)
    return build_field(
        nodes,
        field.geometry,
        field.tool,
        reach,
        amplitude_spacing=field.amplitudes.spacing,
        margin=REACH_MARGIN,
        with_gradients=with_gradients,
        band=field.own_band,
    )


def errors(field: ResponseField, presses: list[dict[str, Any]]) -> tuple[np.ndarray, np.ndarray]:
    """p50, p95 and largest of the normal and of the lateral error, of the normal force, where that is judged."""
    normal, lateral = [], []
    for press in presses:
        c, n, d = (np.array(press[key]) for key in ("contact_point", "normal", "depth"))
        true = np.array(press["fem_force"])
        size = true @ n
        miss = evaluate(field, c + (field.tool.offset - d[:, None]) * n).force - true
        along = miss @ n
        judged = size >= FLOOR * size[-1]
        normal += list((np.abs(along) / size)[judged])
        lateral += list((np.linalg.norm(miss - along[:, None] * n, axis=1) / size)[judged])
    return np.quantile(normal, [0.5, 0.95, 1.0]), np.quantile(lateral, [0.5, 0.95, 1.0])


if __name__ == "__main__":
    main()
