# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Cooks the response fields of an asset into .rfield files."""

from __future__ import annotations

from pathlib import Path

from palpate.author.console import Answer
from palpate.author.errors import InputError, InputProblem
from palpate.author.scene_problems import did_you_mean

__all__ = ["cook_asset"]


def cook_asset(asset: Path, out: Path | None = None, tool: str | None = None) -> Answer:
    """Writes <out>/<tool>.rfield for each tool of `asset` (or one); `out` is the asset folder when absent."""
    from palpate.fields.cook import write_rfield
    from palpate.fields.usd_read import read_field, tools

    names = tools(asset)
    if tool is not None and tool not in names:
        what = f"is no tool of this asset{did_you_mean(tool, names)}"
        raise InputError(InputProblem(str(asset), "--tool", tool, what, "one of " + ", ".join(names)))
    folder = out or (asset if asset.is_dir() else asset.parent)
    folder.mkdir(parents=True, exist_ok=True)
    cooked = []
    for name in [tool] if tool else names:
        path = folder / f"{name}.rfield"
        write_rfield(read_field(asset, name), path)
        cooked.append({"name": name, "rfield": str(path), "bytes": path.stat().st_size})
    shown = "\n".join(f"{one['rfield']}: {one['bytes'] / 1024:.0f} KiB" for one in cooked)
    return Answer({"asset": str(asset), "tools": cooked}, [shown])
