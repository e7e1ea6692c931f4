# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""pydantic's findings as sentences: key, value, what is wrong, what would be right, the nearest word."""

from __future__ import annotations

import difflib
import re
import typing
from collections.abc import Iterable, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError

from palpate.author.errors import InputProblem

__all__ = ["did_you_mean", "dotted", "table_problems", "written"]

Location = tuple[int | str, ...]

_KINDS = {
    "string_type": "a text",
    "int_type": "a whole number",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "tuple_type": "a list",
}


def table_problems(
    error: ValidationError, table: type[BaseModel], raw: Any, file: str, prefix: Location
) -> Iterable[tuple[Location, InputProblem]]:
    """The problems in one table of `file`, each with its place inside the table.

    `raw` is the table as it stands in the file, `prefix` its own place in the file.
    """
    errors = error.errors(include_url=False, include_context=True)
    for found in errors:
        place = _within(raw, found["loc"])
        if found["type"] == "too_short" and any(_inside(other["loc"], found["loc"]) for other in errors):
            continue  # pydantic counts only the entries that are right
        what, expected = _said(found, _table_at(table, place[:-1]), _field_at(table, place))
        value = None if found["type"] == "missing" else _plain(_value_at(raw, place))
        yield place, InputProblem(file, dotted(prefix + place), value, what, expected)


def dotted(place: Sequence[int | str]) -> str:
    """("tool", 1, "radius") as "tool[1].radius"."""
    text = ""
    for part in place:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def written(raw: Any, key: str, otherwise: Any) -> Any:
    """What stands in the file at a dotted key: the user's own words; `otherwise` where nothing does."""
    for part in re.findall(r"[^.\[\]]+", key):
        if isinstance(raw, dict) and part in raw:
            raw = raw[part]
        elif isinstance(raw, list) and part.isdigit() and int(part) < len(raw):
            raw = raw[int(part)]
        else:
            return otherwise
    return otherwise if _plain(raw) is None else raw


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """ " (did you mean ...?)" when one of `known` is near, else nothing."""
    close = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f' (did you mean "{close[0]}"?)' if close else ""


def _said(found: Any, table: type[BaseModel] | None, description: str) -> tuple[str, str]:
    kind, context = found["type"], found.get("ctx", {})
    if kind == "palpate":
        return context["what"], context["expected"]
    if kind == "extra_forbidden":
        known = list(table.model_fields) if table else []
        return f"is no known key{did_you_mean(str(found['loc'][-1]), known)}", "one of " + ", ".join(known)
    if kind == "missing":
        return "is missing", description
    if kind == "literal_error":
        known = re.findall(r"'([^']*)'", context["expected"])
        return f"is no known choice{did_you_mean(str(found['input']), known)}", "one of " + ", ".join(known)
    if kind in _KINDS:
        return f"is not {_KINDS[kind]}", description or _KINDS[kind]
    if kind in ("too_short", "too_long"):
        count = context.get("min_length", context.get("max_length"))
        return (
            f"has {context['actual_length']} entries",
            f"{'at least ' if kind == 'too_short' else ''}{count}",
        )
    return "is not valid", description or found["msg"]


def _inside(place: Location, other: Location) -> bool:
    return len(place) > len(other) and place[: len(other)] == other


def _within(raw: Any, place: Location) -> Location:
    """`place` as far as it exists in the file (a single value may stand for a list of one)."""
    for count, part in enumerate(place):
        if isinstance(raw, dict):
            if part not in raw:
                return place[: count + 1]
            raw = raw[part]
        elif isinstance(raw, list) and isinstance(part, int):
            if part >= len(raw):
                return place[:count]
            raw = raw[part]
        else:
            return place[:count]
    return place


def _value_at(raw: Any, place: Location) -> Any:
    for part in place:
        if isinstance(raw, dict):
            raw = raw.get(part)  # type: ignore[arg-type]
        elif isinstance(raw, list) and isinstance(part, int):
            raw = raw[part]
    return raw


def _plain(value: Any) -> Any:
    """Tables are not repeated in a sentence about them."""
    return (
        None if isinstance(value, dict) or (isinstance(value, list) and any(map(_is_table, value))) else value
    )


def _is_table(value: Any) -> bool:
    return isinstance(value, dict)


def _table_at(table: type[BaseModel] | None, place: Location) -> type[BaseModel] | None:
    for part in place:
        if table is None or isinstance(part, int):
            continue
        field = table.model_fields.get(part)
        table = _table_in(field.annotation) if field else None
    return table


def _table_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in typing.get_args(annotation) if (found := _table_in(part))), None)


def _field_at(table: type[BaseModel], place: Location) -> str:
    """Description of the field at `place`, or of the nearest one around it."""
    names = [count for count, part in enumerate(place) if isinstance(part, str)]
    if not names:
        return ""
    parent = _table_at(table, place[: names[-1]])
    field = parent.model_fields.get(str(place[names[-1]])) if parent else None
    return (field.description or "") if field else ""
