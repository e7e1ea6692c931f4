# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the report reads: the asset, the verdicts of its validation, the summary of its making."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palpate.author.haptic_device import HapticDevice
from palpate.author.two_contacts import RECORD as TWO_CONTACTS
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ResponseField
from palpate.fields.usd_read import read_field, read_organ, tools

__all__ = ["Sources", "gather"]


@dataclass(frozen=True)
class Sources:
    """Everything that a report is made of.

    Attributes:
        asset: folder of the asset.
        organ: its geometry.
        fields: one per tool, by name.
        validations: per field, the content of validation/<tool>.json, or None where there is none.
        two_contacts: per field, what `palpate validate --apart` found, or None.
        files: path relative to the asset, and bytes, of every file but the report's own and kept presses.
        summary: the JSON dict of `palpate author`.
        device: what the scene's [device] names, or None.
        notes: sentences about what could not be read.
    """

    asset: Path
    organ: OrganGeometry
    fields: list[ResponseField]
    validations: list[dict[str, Any] | None]
    two_contacts: list[dict[str, Any] | None]
    files: list[dict[str, Any]]
    summary: dict[str, Any]
    notes: list[str]
    device: HapticDevice | None = None


def gather(asset: Path, summary: dict[str, Any]) -> Sources:
    """Reads the asset in folder `asset`.  Raises FieldError when it is no asset."""
    fields = [read_field(asset, name) for name in tools(asset)]
    notes: list[str] = []
    kept = asset / "validation"
    validations = [_validation(kept / f"{field.tool.name}.json", notes) for field in fields]
    pairs = [_pairs(kept / TWO_CONTACTS.format(tool=field.tool.name), field, notes) for field in fields]
    paths = sorted(path for path in asset.rglob("*") if path.is_file())
    relative = [(path, path.relative_to(asset)) for path in paths]
    files = [
        {"path": name.as_posix(), "bytes": path.stat().st_size}
        for path, name in relative
        if name.parts[0] not in ("report", "work") and not name.name.startswith(".")
    ]
    if unknown := summary.get("device_unknown"):
        notes.append(f"The scene's device is not held against the field: {unknown}")
    device = HapticDevice(**summary["device"]) if summary.get("device") else None
    return Sources(asset, read_organ(asset), fields, validations, pairs, files, summary, notes, device)


def _pairs(path: Path, field: ResponseField, notes: list[str]) -> dict[str, Any] | None:
    """What two of this tool feel in this organ; None where that was found with another one."""
    found = _validation(path, notes)
    if found is None:
        return None
    if (found.get("tool_hash"), found.get("organ")) == (field.tool.hash, field.provenance.get("organ")):
        return found
    notes.append(f"{path.name} in the validation folder is of another organ or tool; it is not shown.")
    return None


def _validation(path: Path, notes: list[str]) -> dict[str, Any] | None:
    if not path.is_file():
        return None
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        notes.append(f"{path.name} in the validation folder cannot be read ({error}); it is not judged here.")
        return None
