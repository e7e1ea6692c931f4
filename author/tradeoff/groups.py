# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows told apart for people: a colour, a mark and a few words for each knob that is turned."""

from __future__ import annotations

from typing import Any

__all__ = ["NAMES", "family_of", "look_of", "short_words", "words_of"]

NAMES = {
    "fidelity": "fidelity",
    "mesh_size": "organ mesh",
    "patch_radius": "patch radius",
    "patch_refinement": "patch edges",
    "nodes": "nodes",
    "knots": "knots",
    "response": "response",
    "float_bits": "float width",
}
SEVERAL = "several knobs"

_LOOKS = (
    ("#0072b2", "o", "circle"),
    ("#d55e00", "s", "square"),
    ("#009e73", "^", "triangle-up"),
    ("#cc79a7", "D", "diamond"),
    ("#e69f00", "v", "triangle-down"),
    ("#56b4e9", "P", "cross"),
    ("#8c564b", "X", "x"),
    ("#6b6b6b", "<", "triangle-left"),
    ("#332288", ">", "triangle-right"),
    ("#117733", "h", "hexagon"),
    ("#882255", "p", "pentagon"),
    ("#999933", "d", "diamond-tall"),
    ("#22252a", "*", "star"),
    ("#44aa99", "H", "hexagon2"),
)
"""Colour (Okabe and Ito 2008, then Tol), matplotlib's mark, plotly's."""


def words_of(knob: str, value: Any) -> str:
    """A knob's value in words, such as "mesh 12 mm"."""
    if knob == "mesh_size":
        return f"mesh {1e3 * value:.3g} mm"
    if knob == "patch_radius":
        return f"patch {1e3 * value:.3g} mm"
    if knob == "patch_refinement":
        return f"patch edges / {value:.2g}"
    if knob == "float_bits":
        return f"{value}-bit floats"
    if knob in ("nodes", "knots"):
        return f"{value} {knob}"
    return f"{value}".replace("_", " ")


def family_of(row: dict[str, Any]) -> str:
    """The legend's entry of a row: what it turns beside the node count."""
    turned = [knob for knob in row["changed"] if knob != "nodes"]
    if not turned:
        return "the scene's own"
    if len(turned) > 1:
        return SEVERAL
    return words_of(turned[0], row["setting"][turned[0]])


def short_words(row: dict[str, Any]) -> str:
    """What a row turns, in a few words."""
    said = [words_of("nodes", row["setting"]["nodes"])]
    said += [words_of(knob, row["setting"][knob]) for knob in row["changed"] if knob != "nodes"]
    return ", ".join(said)


def look_of(families: list[str]) -> dict[str, tuple[str, str, str]]:
    """Colour, matplotlib's and plotly's mark of each family, in their order."""
    return {family: _LOOKS[i % len(_LOOKS)] for i, family in enumerate(families)}
