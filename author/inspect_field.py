# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What is inside an asset folder or a cooked field: tools, nodes, sizes, hashes, errors."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from palpate.author.console import Answer, plain, table_of
from palpate.author.errors import InputError, InputProblem
from palpate.author.tool_family import file_name
from palpate.fields.response_field import ResponseField

__all__ = ["inspect_field"]


def inspect_field(path: Path) -> Answer:
    """`path`: an asset folder, its interface layer, or an .rfield, which the runtime opens and proves.

    Raises InputError when there is no such file; FieldError or the runtime's own refusal when it is damaged.
    """
    if not path.exists():
        raise InputError(InputProblem(str(path), "", None, "does not exist", "an asset folder or an .rfield"))
    return _rfield(path) if path.is_file() and path.suffix == ".rfield" else _asset(path)


def _rfield(path: Path) -> Answer:
    from palpate.fields.rfield_layout import LAYERS, SECTIONS, section_element_size
    from palpate.fields.rfield_read import read_header
    from palpate.runtime import Field

    info = Field.open(path).info  # proves the file: what is read below is whole
    header = read_header(path)
    sections = [
        {"name": section.name, "elements": int(count), "bytes": int(count) * section_element_size(section)}
        for section, count in zip(SECTIONS, header["section_elements"], strict=True)
    ]
    for name, size in zip(LAYERS, header["layer_size"], strict=False):
        if size:
            sections.append({"name": name, "elements": 1, "bytes": int(size)})
    result = {
        "path": str(path),
        "version": int(header["version"]),
        **dataclasses.asdict(info),
        "header_bytes": int(header["header_size"]),
        "sections": sections,
    }
    shares = table_of("section", "elements", "bytes", "share")
    for section in sections:
        share = f"{100 * section['bytes'] / info.bytes:.1f} %"
        shares.add_row(section["name"], str(section["elements"]), str(section["bytes"]), share)
    told = {key: value for key, value in result.items() if key != "sections"}
    return Answer(result, [_two_columns(told), shares])


def _asset(path: Path) -> Answer:
    from palpate.fields.usd_read import read_field, tools

    folder = path if path.is_dir() else path.parent
    fields = [read_field(path, name) for name in tools(path)]
    found = [
        _tool(field)
        | (_cooked(folder / f"{field.tool.name}.rfield") if not field.family else {"rfield": None})
        for field in fields
    ]
    for field in fields:
        for file, tool_hash in _files(folder, field):
            if file.is_file() and _cooked(file)["rfield"]["tool_hash"] != tool_hash:
                what = "was cooked for another tool than the asset's of that name"
                again = f"palpate cook {folder}, or no such file"
                raise InputError(InputProblem(str(file), "", None, what, again))
    everything = sorted(file for file in folder.rglob("*") if file.is_file())
    files = [file for file in everything if file.relative_to(folder).parts[0] != "work"]
    result = {
        "asset": str(path),
        "bytes": sum(file.stat().st_size for file in files),
        "work_bytes": sum(file.stat().st_size for file in everything)
        - sum(file.stat().st_size for file in files),
        "files": [{"path": str(f.relative_to(folder)), "bytes": f.stat().st_size} for f in files],
        "tools": found,
    }
    table = table_of(
        "tool", "nodes", "pressed", "knots", "depth (mm)", "fit residual p95", "surface p99 (um)"
    )
    for tool in found:
        table.add_row(
            tool["name"],
            str(tool["nodes"]),
            str(tool["pressed"]),
            str(tool["knots"]),
            f"{1e3 * tool['depth_max']:.2f}",
            f"{100 * tool['residual']['p95']:.2f} %",
            f"{1e6 * tool['geometry']['error_p99']:.0f}",
        )
    size, work = f"{result['bytes'] / 1024:.0f} KiB", f"{result['work_bytes'] / 2**20:.0f} MiB"
    return Answer(
        result,
        [
            f"{path}: {size} in {len(files)} files, and {work} of kept work",
            table,
            *(line for tool in found for line in _troubles(tool)),
        ],
    )


def _files(folder: Path, field: ResponseField) -> list[tuple[Path, str]]:
    """Where a tool's cooked fields are, and the hash of the tool that each is of."""
    if not field.family:
        return [(folder / f"{field.tool.name}.rfield", field.tool.hash)]
    return [(folder / file_name(field.tool.name, own.radius), own.tool.hash) for own in field.family]


def _cooked(path: Path) -> dict[str, Any]:
    """The cooked field beside an asset, where there is one."""
    if not path.is_file():
        return {"rfield": None}
    from palpate.runtime import Field

    info = Field.open(path).info
    told = {"bytes": info.bytes, "tool_hash": info.tool_hash, "field_hash": info.field_hash}
    return {"rfield": {"path": str(path), **told}}


def _tool(field: Any) -> dict[str, Any]:
    from palpate.author.report.limits import FULL_DEPTH

    nodes, tool = field.nodes, field.tool
    p50, p95 = np.percentile(nodes.residual, [50, 95])
    return {
        "name": tool.name,
        "shape": tool.shape,
        "parameters": tool.parameters,
        "radii": [
            {
                "radius": member.radius,
                "depth_max": float(member.nodes.depth_knots[-1]),
                "hash": member.tool.hash,
            }
            for member in field.family
        ],
        "hash": tool.hash,
        "tilts": [tool.tilt, *(way.tool.tilt for way in field.ways)],
        "nodes": nodes.node_count,
        "pressed": int(nodes.pressed.sum()),
        "extrapolated": int(np.sum(nodes.depth_reached < FULL_DEPTH * field.depth_max)),
        "failed_presses": field.provenance.get("failed_presses", []),
        "knots": len(nodes.depth_knots),
        "depth_max": field.depth_max,
        "force_max": float(nodes.normal_force.max()),
        "residual": {"p50": p50, "p95": p95, "max": nodes.residual.max()},
        "representation": field.representation,
        "geometry": {
            "spacing": field.geometry.signed_distance.spacing,
            "blocks": field.geometry.signed_distance.block_count,
            "error_p99": field.geometry.error_p99,
            "flagged_share": field.geometry.flagged_share,
        },
        "provenance": field.provenance,
    }


def _troubles(tool: dict[str, Any]) -> Iterator[str]:
    if tool["extrapolated"]:
        yield f"{tool['name']}: {tool['extrapolated']} nodes are extrapolated below the depth that their press reached"
    for one in tool["failed_presses"]:
        place = ", ".join(f"{1e3 * x:.1f}" for x in one["contact_point"])
        yield f"{tool['name']}: a press failed at ({place}) mm: {one['reason']}"


def _two_columns(result: dict[str, Any]) -> Table:
    table = table_of("key", "value")
    for key, value in result.items():
        table.add_row(str(key), value if isinstance(value, str) else json.dumps(plain(value)))
    return table
