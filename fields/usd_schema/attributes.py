# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The table of palpate's USD attributes, attributes.toml, as objects."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass

from palpate.fields.usd_schema import schema_path

__all__ = ["APIS", "SchemaAPI", "SchemaAttribute"]


@dataclass(frozen=True)
class SchemaAttribute:
    """One attribute: the Python `member` that it carries, its USD name and type, and what it means.

    `per_knot` primvars hold one value per knot in each node's element.
    """

    member: str
    name: str
    usd_type: str
    doc: str
    span: str
    unit: str
    per_knot: bool

    @property
    def is_primvar(self) -> bool:
        return self.name.startswith("primvars:")

    @property
    def documentation(self) -> str:
        """What the schema says of it; ends with range and unit."""
        return f"{self.doc} Range: {self.span}. Unit: {self.unit}."


@dataclass(frozen=True)
class SchemaAPI:
    """One single-apply API schema and its attributes by member."""

    name: str
    doc: str
    attributes: dict[str, SchemaAttribute]


def _read_table() -> dict[str, SchemaAPI]:
    with open(schema_path() / "attributes.toml", "rb") as file:
        table = tomllib.load(file)
    return {
        name: SchemaAPI(
            name,
            api["doc"],
            {
                member: SchemaAttribute(
                    member,
                    row["name"],
                    row["type"],
                    row["doc"],
                    row["range"],
                    row["unit"],
                    row.get("per_knot", False),
                )
                for member, row in api["attributes"].items()
            },
        )
        for name, api in table.items()
    }


APIS: dict[str, SchemaAPI] = _read_table()
"""API schemas by name, in the table's order."""
