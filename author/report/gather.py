# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the report reads: the asset, the verdicts of its validation, the summary of its making."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palpate.author.haptic_device import HapticDevice
from palpate.author.report.records import TICKS, VERIFICATION, file_hash
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
        fresh: per field, what `palpate validate` found at points drawn later, each with the name of its record.
        verification: what `palpate verify --json` printed (verification_record.py), or None.
        ticks: per field, tick times (tick_record.py), or None.
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
    fresh: list[list[dict[str, Any]]]
    verification: dict[str, Any] | None
    ticks: list[dict[str, Any] | None]
    files: list[dict[str, Any]]
    summary: dict[str, Any]
    notes: list[str]
    device: HapticDevice | None = None


def gather(asset: Path, summary: dict[str, Any]) -> Sources:
    """Reads the asset in folder `asset`.  Raises FieldError when it is no asset."""
    fields = [read_field(asset, name) for name in tools(asset)]
    notes: list[str] = []
    kept = asset / "validation"
    validations = [_json(kept / f"{field.tool.name}.json", notes) for field in fields]
    pairs = [_pairs(kept / TWO_CONTACTS.format(tool=field.tool.name), field, notes) for field in fields]
    fresh = [_fresh(kept, field.tool.name, [f.tool.name for f in fields], notes) for field in fields]
    ticks = [_ticks(asset, field, notes) for field in fields]
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
    verification = _json(kept / VERIFICATION, notes)
    organ = read_organ(asset)
    return Sources(
        asset, organ, fields, validations, pairs, fresh, verification, ticks, files, summary, notes, device
    )


def _fresh(kept: Path, tool: str, tools: list[str], notes: list[str]) -> list[dict[str, Any]]:
    """Later validations of `tool`, by name of their record; presses are left out, they are in the record."""
    found = []
    for path in sorted(kept.glob(f"{tool}-seed*.json")):
        if any(
            other != tool and len(other) > len(tool) and path.name.startswith(f"{other}-") for other in tools
        ):
            continue
        values = _json(path, notes)
        if values is not None and values.get("tool") == tool:
            told = {key: value for key, value in values.items() if key not in ("presses", "family", "ways")}
            found.append({"record": path.name, **told})
    return found


def _ticks(asset: Path, field: ResponseField, notes: list[str]) -> dict[str, Any] | None:
    """Tick times of the cooked file that is there; None where they are of another one."""
    record = _json(asset / "validation" / TICKS.format(tool=field.tool.name), notes)
    cooked = asset / f"{field.tool.name}.rfield"
    if record is None or not cooked.is_file():
        return None
    if record.get("sha256") == file_hash(cooked):
        return record
    notes.append(f"The tick times of {field.tool.name} are of another cooked field; they are not shown.")
    return None


def _pairs(path: Path, field: ResponseField, notes: list[str]) -> dict[str, Any] | None:
    """What two of this tool feel in this organ; None where that was found with another one."""
    found = _json(path, notes)
    if found is None:
        return None
    if (found.get("tool_hash"), found.get("organ")) == (field.tool.hash, field.provenance.get("organ")):
        return found
    notes.append(f"{path.name} in the validation folder is of another organ or tool; it is not shown.")
    return None


def _json(path: Path, notes: list[str]) -> dict[str, Any] | None:
    if not path.is_file():
        return None
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        notes.append(f"{path.name} in the validation folder cannot be read ({error}); it is not judged here.")
        return None
