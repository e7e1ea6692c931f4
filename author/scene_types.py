# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The kinds of values in a scene file: quantities, lists, names, files; and the table they stand in."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, GetCoreSchemaHandler, ValidationInfo
from pydantic.functional_validators import AfterValidator
from pydantic.json_schema import WithJsonSchema
from pydantic_core import PydanticCustomError, core_schema

from palpate.author.units import DIMENSIONS, QuantityError, expected_quantity, quantity

__all__ = [
    "Direction",
    "Identifier",
    "OneOrMore",
    "Point",
    "Quantity",
    "SurfaceFile",
    "Table",
    "canonical",
    "digest",
    "refused",
]


def refused(what: str, expected: str) -> PydanticCustomError:
    """An error that pydantic collects: `what` is wrong and what would be right."""
    return PydanticCustomError("palpate", "{what}; expected {expected}", {"what": what, "expected": expected})


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float: a quantity of `dimension`, read from a number (SI) or a string with a unit.

    Bounds are in SI: the value is > above, >= least, < below, <= most, as far as they are given.
    """

    dimension: str
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None

    def read(self, value: object) -> float:
        try:
            number = quantity(value, self.dimension)
        except QuantityError as error:
            raise refused(error.what, error.expected) from None
        allowed = (
            (self.above is None or number > self.above)
            and (self.least is None or number >= self.least)
            and (self.below is None or number < self.below)
            and (self.most is None or number <= self.most)
        )
        if not allowed:
            raise refused("is out of range", f"{expected_quantity(self.dimension)}, {self._range()}")
        return number

    def _range(self) -> str:
        unit = DIMENSIONS[self.dimension][1]
        bounds = (
            ("above", self.above),
            ("at least", self.least),
            ("below", self.below),
            ("at most", self.most),
        )
        said = [f"{word} {bound:g}" for word, bound in bounds if bound is not None]
        return " and ".join(said) + ("" if unit == "1" else f" {unit}")

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        number: dict[str, Any] = {"type": "number"}
        for keyword, bound in (
            ("exclusiveMinimum", self.above),
            ("minimum", self.least),
            ("exclusiveMaximum", self.below),
            ("maximum", self.most),
        ):
            if bound is not None:
                number[keyword] = bound
        _, unit, example = DIMENSIONS[self.dimension]
        return {
            "anyOf": [number, {"type": "string", "examples": [example]}],
            "dimension": self.dimension,
            "unit": unit,
        }


class _OneOrMore:
    """Annotation of a tuple: a single value stands for a list of one."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_before_validator_function(
            lambda value: value if isinstance(value, (list, tuple)) else (value,), handler(source)
        )

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        many = handler(schema)
        many["minItems"] = 1
        return {"anyOf": [many["items"], many]}


OneOrMore = _OneOrMore()


def _identifier(value: str) -> str:
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", value):
        raise refused("is not an identifier", "letters, digits and underscores, not starting with a digit")
    return value


Identifier = Annotated[
    str,
    AfterValidator(_identifier),
    WithJsonSchema({"type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_]*$"}),
]
"""A name that can stand in a USD path and a file name as it is."""


def _direction(value: tuple[float, float, float]) -> tuple[float, float, float]:
    length = sum(x * x for x in value) ** 0.5
    if length < 1e-12:
        raise refused("has no direction", "a vector that is not zero")
    return (value[0] / length, value[1] / length, value[2] / length)


Coordinate = Annotated[float, Quantity("length")]
Number = Annotated[float, Quantity("fraction")]
Point = tuple[Coordinate, Coordinate, Coordinate]
"""A place in organ or tool axes, m."""
Direction = Annotated[tuple[Number, Number, Number], AfterValidator(_direction)]
"""A vector of any length but zero, normalised."""


def _existing_file(value: object, info: ValidationInfo) -> Path:
    if not isinstance(value, (str, Path)) or not str(value):
        raise refused("is not a file name", "a path, relative to the scene file")
    folder = Path((info.context or {}).get("folder", "."))
    path = (folder / value).resolve()
    if not path.is_file():
        raise refused("is no file", f"a file; looked for {path}")
    return path


SurfaceFile = Annotated[Path, BeforeValidator(_existing_file), WithJsonSchema({"type": "string"})]
"""A file that exists; relative paths start at the scene file."""


class Table(BaseModel):
    """A table of the scene file: immutable, and a key that it does not know is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    def hash_inputs(self) -> dict[str, Any]:
        """What results may depend on, as plain JSON values.

        Names are labels and left out, files stand for their contents (SHA-256), absent keys are absent.
        """
        return canonical(self)

    def digest(self) -> str:
        """Hex SHA-256 of `hash_inputs`."""
        return digest(self.hash_inputs())


def canonical(value: Any) -> Any:
    """`value` (tables, tuples, files, numbers) as JSON values, free of key order and file places."""
    if isinstance(value, Table):
        pairs = ((key, getattr(value, key)) for key in sorted(type(value).model_fields) if key != "name")
        return {key: canonical(item) for key, item in pairs if item is not None}
    if isinstance(value, dict):
        return {key: canonical(value[key]) for key in sorted(value)}
    if isinstance(value, (tuple, list)):
        return [canonical(item) for item in value]
    if isinstance(value, Path):
        return {"sha256": hashlib.sha256(value.read_bytes()).hexdigest()}
    if isinstance(value, float):
        return value + 0.0  # -0.0 becomes 0.0
    return value


def digest(value: Any) -> str:
    """Hex SHA-256 of plain JSON values; floats enter with all their digits."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
