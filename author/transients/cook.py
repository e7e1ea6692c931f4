# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Puts what a scene says of transients into an asset that is there: USD and .rfield anew, without a press."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from palpate.author.cook_asset import cook_asset
from palpate.author.errors import InputError, InputProblem
from palpate.author.one_tool import chosen_tools
from palpate.author.scene import Scene
from palpate.author.transients.transient_stage import with_transient

__all__ = ["cook_transients"]


def cook_transients(scene: Scene, asset: Path, tool: str = "") -> list[dict[str, Any]]:
    """A row for each tool of `scene` (or the one named `tool`): its summary, `name` and `rfields`.

    A tool without a table [tool.transient] loses the transients that the asset has of it.

    Raises:
        InputError: the asset has no such tool, or its tool is of another shape.
        FieldError: the asset cannot be read.
    """
    from palpate.author.tool_members import is_family
    from palpate.author.tool_stage import reference_of, shape_of
    from palpate.fields.usd_read import read_field, tools
    from palpate.fields.usd_write import add_tool

    known, rows = tools(asset), []
    folder = asset if asset.is_dir() else asset.parent
    for one in chosen_tools(scene, tool):
        if one.name not in known:
            what, expected = "is no tool of this asset", "one of " + ", ".join(known)
            raise InputError(InputProblem(str(asset), "tool", one.name, what, expected))
        field = read_field(asset, one.name)
        own = None if is_family(one) or field.ways else reference_of(one.name, shape_of(scene, one))
        if own is not None and own.hash != field.tool.hash:
            what = "is another tool in the asset than in the scene"
            raise InputError(InputProblem(str(asset), "tool", one.name, what, "palpate author"))
        made, told = with_transient(scene, one, field)
        add_tool(folder, made, per_vertex=False)
        cooked = cook_asset(asset, tool=one.name).result["tools"]
        rows.append({"name": one.name, "rfields": [row["rfield"] for row in cooked], **told})
    return rows
