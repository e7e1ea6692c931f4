# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Cooks the response fields of an asset into .rfield files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.author.console import Answer
from palpate.author.errors import InputError, InputProblem
from palpate.author.scene_problems import did_you_mean

if TYPE_CHECKING:
    from palpate.fields.response_field import ResponseField

__all__ = ["cook_asset", "refuse_radius"]


def cook_asset(
    asset: Path, out: Path | None = None, tool: str | None = None, radius: float | None = None
) -> Answer:
    """Writes <out>/<tool>.rfield for each tool of `asset` (or one); `out` is the asset folder when absent.

    Of a tool family one file for each pressed radius, <tool>-<radius>mm.rfield, or for `radius` (m) alone.

    Raises:
        InputError: there is no such tool, or it has no field of that radius.
    """
    from palpate.fields.usd_read import read_field, tools

    names = tools(asset)
    if tool is not None and tool not in names:
        what = f"is no tool of this asset{did_you_mean(tool, names)}"
        raise InputError(InputProblem(str(asset), "--tool", tool, what, "one of " + ", ".join(names)))
    if radius is not None and tool is None and len(names) > 1:
        what = "is a radius of one tool family, and the asset has several tools"
        raise InputError(
            InputProblem(str(asset), "--radius", f"{1e3 * radius:g} mm", what, "--tool beside it")
        )
    folder = out or (asset if asset.is_dir() else asset.parent)
    folder.mkdir(parents=True, exist_ok=True)
    cooked = []
    for name in [tool] if tool else names:
        cooked += _cooked(asset, folder, read_field(asset, name), radius)
    shown = "\n".join(f"{one['rfield']}: {one['bytes'] / 1024:.0f} KiB" for one in cooked)
    return Answer({"asset": str(asset), "tools": cooked}, [shown])


def refuse_radius(asset: Path, field: ResponseField, radius: float | None) -> None:
    """Raises InputError where `field` is of no family, or `radius` (m) lies outside what was pressed."""
    if radius is None:
        return
    if not field.family:
        own = field.tool.parameters.get("radius")
        what = f"is asked of {field.tool.name}, which was authored with one radius"
        expected = "no --radius" + (f", for {1e3 * own:.4g} mm" if own else "")
        raise InputError(InputProblem(str(asset), "--radius", f"{1e3 * radius:g} mm", what, expected))
    radii = [member.radius for member in field.family]
    if not radii[0] * (1.0 - 1e-9) <= radius <= radii[-1] * (1.0 + 1e-9):
        known = ", ".join(f"{1e3 * own:.4g}" for own in radii)
        what = f"is outside the radii that {field.tool.name} was pressed with ({known} mm)"
        expected = f"{1e3 * radii[0]:.4g} mm to {1e3 * radii[-1]:.4g} mm"
        raise InputError(InputProblem(str(asset), "--radius", f"{1e3 * radius:g} mm", what, expected))


def _cooked(asset: Path, folder: Path, field: ResponseField, radius: float | None) -> list[dict[str, Any]]:
    """The files of one tool, and what is said of each."""
    from palpate.fields.cook import write_rfield

    refuse_radius(asset, field, radius)
    name = field.tool.name
    if not field.family:
        write_rfield(field, path := folder / f"{name}.rfield")
        return [{"name": name, "rfield": str(path), "bytes": path.stat().st_size}]
    from palpate.author.authored_tool import authored_tool
    from palpate.author.field_stage import REACH_MARGIN
    from palpate.author.tool_family import field_of_radius, file_name

    authored = authored_tool(asset, name)
    beyond = authored.samples.beyond(authored.mesh)
    rows = []
    for one in [radius] if radius is not None else [member.radius for member in field.family]:
        own = field_of_radius(field, one, beyond, REACH_MARGIN)
        write_rfield(own, path := folder / file_name(name, one))
        size = path.stat().st_size
        rows.append(
            {"name": name, "radius": one, "depth_max": own.depth_max, "rfield": str(path), "bytes": size}
        )
    return rows
