# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Quantities at the door: plain numbers are SI, strings carry their unit ("3 mm", "2 kPa/mm", "3.5 %").

A unit expression is a product of unit symbols, divided by the symbols that follow a slash: "kPa/mm", "N s/m",
"kg/m^3".  Each symbol is a factor to SI and a vector of exponents of (m, kg, s, rad), so a wrong unit is
told by its dimension and not by its spelling.
"""

from __future__ import annotations

import difflib
import math
import re

__all__ = ["DIMENSIONS", "QuantityError", "quantity"]

Exponents = tuple[int, int, int, int]

_LENGTH: Exponents = (1, 0, 0, 0)
_MASS: Exponents = (0, 1, 0, 0)
_TIME: Exponents = (0, 0, 1, 0)
_ANGLE: Exponents = (0, 0, 0, 1)
_FREQUENCY: Exponents = (0, 0, -1, 0)
_FORCE: Exponents = (1, 1, -2, 0)
_PRESSURE: Exponents = (-1, 1, -2, 0)
_NUMBER: Exponents = (0, 0, 0, 0)

_UNITS: dict[str, tuple[float, Exponents]] = {
    "m": (1.0, _LENGTH),
    "cm": (1e-2, _LENGTH),
    "mm": (1e-3, _LENGTH),
    "um": (1e-6, _LENGTH),
    "nm": (1e-9, _LENGTH),
    "kg": (1.0, _MASS),
    "g": (1e-3, _MASS),
    "s": (1.0, _TIME),
    "ms": (1e-3, _TIME),
    "us": (1e-6, _TIME),
    "min": (60.0, _TIME),
    "h": (3600.0, _TIME),
    "rad": (1.0, _ANGLE),
    "deg": (math.pi / 180.0, _ANGLE),
    "Hz": (1.0, _FREQUENCY),
    "kHz": (1e3, _FREQUENCY),
    "MHz": (1e6, _FREQUENCY),
    "N": (1.0, _FORCE),
    "mN": (1e-3, _FORCE),
    "kN": (1e3, _FORCE),
    "J": (1.0, (2, 1, -2, 0)),
    "mJ": (1e-3, (2, 1, -2, 0)),
    "Pa": (1.0, _PRESSURE),
    "kPa": (1e3, _PRESSURE),
    "MPa": (1e6, _PRESSURE),
    "GPa": (1e9, _PRESSURE),
    "1": (1.0, _NUMBER),
    "%": (1e-2, _NUMBER),
}

DIMENSIONS: dict[str, tuple[Exponents, str, str]] = {
    "length": (_LENGTH, "m", "3 mm"),
    "time": (_TIME, "s", "20 min"),
    "angle": (_ANGLE, "rad", "30 deg"),
    "frequency": (_FREQUENCY, "Hz", "1 kHz"),
    "force": (_FORCE, "N", "3.3 N"),
    "pressure": (_PRESSURE, "Pa", "5 kPa"),
    "pressure per length": ((-2, 1, -2, 0), "Pa/m", "2 kPa/mm"),
    "mass": (_MASS, "kg", "0.5 kg"),
    "stiffness": ((0, 1, -2, 0), "N/m", "2.3 N/mm"),
    "damping": ((0, 1, -1, 0), "N s/m", "5 N s/m"),
    "velocity": ((1, 0, -1, 0), "m/s", "0.1 m/s"),
    "energy": ((2, 1, -2, 0), "J", "2 mJ"),
    "spatial frequency": ((-1, 0, 0, 0), "1/m", "2 1/mm"),
    "fraction": (_NUMBER, "1", "3.5 %"),
}
"""Name of a dimension: exponents of (m, kg, s, rad), SI unit, an example of a string."""

_NUMBER_AND_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")


class QuantityError(ValueError):
    """A value that is no quantity of the expected dimension.

    Attributes: what (str; a clause that says what is wrong), expected (str; what would be right).
    """

    def __init__(self, what: str, expected: str) -> None:
        self.what = what
        self.expected = expected
        super().__init__(f"{what}; expected {expected}")


def quantity(value: object, dimension: str) -> float:
    """`value` as a number in SI units of `dimension` (a key of DIMENSIONS).

    Numbers are taken as SI; strings are a number and a unit.  Raises QuantityError for anything else.
    """
    exponents, _, _ = DIMENSIONS[dimension]
    expected = expected_quantity(dimension)
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise QuantityError("is not a quantity", expected)
    if not isinstance(value, str):
        number, factor, found = float(value), 1.0, exponents
    else:
        match = _NUMBER_AND_UNIT.fullmatch(value)
        if match is None:
            raise QuantityError("is not a number with a unit", expected)
        number = float(match[1])
        if not match[2] and dimension != "fraction":
            raise QuantityError("carries no unit", expected)
        factor, found = _parsed_unit(match[2], expected)
    if found != exponents:
        raise QuantityError(f"is {_named(found)}, not {_with_article(dimension)}", expected)
    if not math.isfinite(number):
        raise QuantityError("is not finite", expected)
    return number * factor


def expected_quantity(dimension: str) -> str:
    """A phrase that says what a quantity of `dimension` looks like in a file."""
    _, si_unit, example = DIMENSIONS[dimension]
    plain = "a plain number" if si_unit == "1" else f"a number in {si_unit}"
    return f'{_with_article(dimension)}: {plain} or a string like "{example}"'


def _parsed_unit(text: str, expected: str) -> tuple[float, Exponents]:
    """Factor to SI and exponents of a unit expression; the empty one is 1."""
    factor, exponents = 1.0, [0, 0, 0, 0]
    text = text.replace("µ", "u").replace("μ", "u").replace("°", "deg").replace("·", " ").replace("*", " ")
    for place, part in enumerate(text.split("/")):
        sign = 1 if place == 0 else -1
        symbols = part.split()
        if not symbols and (place > 0 or "/" in text):
            raise QuantityError(f'has an incomplete unit "{text}"', expected)
        for symbol in symbols:
            name, _, power_text = symbol.partition("^")
            if name not in _UNITS or (power_text and not re.fullmatch(r"-?\d", power_text)):
                raise QuantityError(f'has the unknown unit "{symbol}"{_did_you_mean(name)}', expected)
            unit_factor, unit_exponents = _UNITS[name]
            power = sign * int(power_text or 1)
            factor *= unit_factor**power
            exponents = [e + power * u for e, u in zip(exponents, unit_exponents, strict=True)]
    return factor, (exponents[0], exponents[1], exponents[2], exponents[3])


def _did_you_mean(symbol: str) -> str:
    by_lower = {name.lower(): name for name in _UNITS}
    close = difflib.get_close_matches(symbol.lower(), by_lower, n=1, cutoff=0.6)
    return f' (did you mean "{by_lower[close[0]]}"?)' if close else ""


def _named(exponents: Exponents) -> str:
    for name, (known, _, _) in DIMENSIONS.items():
        if known == exponents:
            return _with_article(name)
    symbols = ("m", "kg", "s", "rad")
    return "a quantity in " + " ".join(f"{s}^{e}" for s, e in zip(symbols, exponents, strict=True) if e)


def _with_article(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}" if noun != "damping" else "a damping"
