# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A held body, fixed bodies and a contact law as cooked bytes for the runtime."""

from __future__ import annotations

from dataclasses import astuple, fields

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.rigid.body import Body, Element, frame_of
from palpate.author.rigid.law import LUO_XIAO, Law
from palpate.author.rigid.reflex import past_reflex_edges
from palpate.fields.rigid_layout import (
    ELEMENT,
    FORMATION,
    HEADER,
    KINDS,
    MERGE,
    PAIR,
    formation_hash,
    packed,
)

__all__ = ["cooked_rigid", "element_name", "require_pair"]

PAIR_LIMIT = 1 << 17
_EDGES = ("vertex", "segment", "circle")
_FLAT = ("polygon", "disc")


def cooked_rigid(
    held: Body,
    fixed: Body,
    mass: float,
    law: Law = LUO_XIAO,
    formations: tuple[tuple[int, ...], ...] = (),
    merged: bool = True,
) -> bytes:
    """The bytes that `palpate.runtime.rigid.Rigid` opens.

    Args:
        held: in any frame; it is cooked about its centre of mass, axes kept.  fixed: in world axes.
        mass: kg, of the held body.
        formations: of rising keys (held element << 16 | fixed element); see formations.py.
        merged: False: every elementary contact is a point by itself; for searching formations.

    Raises:
        InputError: no mass or volume, parts thinner than contact is deep, a pair of curved surfaces that no distance
            is known for.
    """
    _check(held, fixed, mass, law)
    held = held.moved(np.eye(3), -held.centre)
    elements = [*held.elements, *fixed.elements]
    count = len(held.elements)
    first = [0] * count + [count] * len(fixed.elements)
    table = np.zeros(len(elements), dtype=ELEMENT)
    numbers: list[np.ndarray] = []
    indices: list[int] = []
    at = 0
    for i, e in enumerate(elements):
        row = table[i]
        row["kind"], row["side"] = KINDS.index(e.kind), e.side
        ups = [i, *(b + first[i] for b in e.bounds)]
        row["up_first"], row["up_count"] = len(indices), len(ups)
        indices += ups
        beside = sorted(_beside(elements, first, i))
        row["beside_first"], row["beside_count"] = len(indices), len(beside)
        indices += beside
        lines, grown = past_reflex_edges(e, law.depth_max) if e.kind == "polygon" else (e.numbers, 0.0)
        flat = np.asarray(lines, dtype="<f8").ravel()
        row["number_first"], row["number_count"] = at, len(flat)
        numbers.append(flat)
        at += len(flat)
        row["bound_centre"], row["bound_radius"] = e.ball[0], e.ball[1] + grown
        row["centre"], row["axis"] = e.centre, e.axis
        row["across"] = frame_of(e.axis) if e.across is None else e.across
        for name in ("radius", "size", "low", "high", "cosine", "normal"):
            row[name] = getattr(e, name)
    pairs = [
        (h, count + f)
        for h, a in enumerate(held.elements)
        for f, b in enumerate(fixed.elements)
        if _touch(a, b)
    ]
    if len(pairs) > PAIR_LIMIT:
        raise _refused(
            "rigid", f"makes {len(pairs)} pairs of elements", f"at most {PAIR_LIMIT}: coarser meshes"
        )
    merges = sorted(
        (h << 16 | (count + f), region)
        for h, a in enumerate(held.elements)
        for f, b in enumerate(fixed.elements)
        if merged and (region := _region(a.kind, b.kind))
    )
    ordered = sorted(formations, key=formation_hash)
    rows, words = [], []
    for keys in ordered:
        rows.append((formation_hash(keys), len(words), len(keys)))
        words += keys
    header = np.zeros((), dtype=HEADER)
    header["held_count"] = count
    for field, value in zip(fields(law), astuple(law), strict=True):
        header[field.name] = value
    inertia = held.inertia(mass)
    header["mass"] = mass
    header["inertia"] = [
        inertia[0, 0],
        inertia[1, 1],
        inertia[2, 2],
        inertia[0, 1],
        inertia[1, 2],
        inertia[0, 2],
    ]
    header["held_radius"] = max(float(np.linalg.norm(e.ball[0])) + e.ball[1] for e in held.elements)
    return packed(
        header,
        {
            "elements": table,
            "pairs": np.array(pairs, dtype=PAIR),
            "numbers": np.concatenate([*numbers, np.zeros(0)]).astype("<f8"),
            "indices": np.array(indices, dtype="<u4"),
            "merges": np.array(merges, dtype=MERGE),
            "formations": np.array(rows, dtype=FORMATION),
            "formation_indices": np.array(words, dtype="<u4"),
        },
    )


def element_name(held: Body, fixed: Body, index: int) -> str:
    """What a person calls the element: "held cylinder 0"."""
    count = len(held.elements)
    body, i, who = (held, index, "held") if index < count else (fixed, index - count, "fixed")
    return f"{who} {body.elements[i].kind} {i}"


def _refused(key: str, what: str, expected: str) -> InputError:
    return InputError(InputProblem("", key, None, what, expected))


def _check(held: Body, fixed: Body, mass: float, law: Law) -> None:
    if not (np.isfinite(mass) and mass > 0):
        raise _refused("mass", f"is {mass:g} kg", "a mass above 0 kg")
    if not held.volume > 0:
        raise _refused(
            "held",
            "has no volume",
            "a solid: sphere, cylinder, capsule, cone, torus, paraboloid, tube, pen, box, mesh",
        )
    for who, body in (("held", held), ("fixed", fixed)):
        if body.smallest <= 2 * law.depth_max:
            what = f"has a part {body.smallest:g} m thin, and contact is followed {law.depth_max:g} m deep"
            raise _refused(who, what, f"parts thicker than {2 * law.depth_max:g} m, or a smaller depth_max")
    if law.kinetic_friction > law.static_friction:
        raise _refused("kinetic_friction", "is above static_friction", f"at most {law.static_friction:g}")
    if not law.threshold <= law.depth_max:
        raise _refused("depth_max", "is below the threshold", f"at least {law.threshold:g} m")
    for a in held.elements:
        for b in fixed.elements:
            require_pair(a, b)


def require_pair(a: Element, b: Element) -> None:
    """Raises InputError for curved surfaces whose contact nothing finds: two cones, a solid paraboloid in a hollow."""
    if a.kind == b.kind == "cone" and not (_cavity(a) or _cavity(b)):
        what = "asks for contact of a cone with a cone, whose distance is not computed"
        raise _refused("rigid", what, "other shapes for one of the two")
    for round_one, other in ((a, b), (b, a)):
        if round_one.kind == "paraboloid" and not _cavity(round_one) and _cavity(other):
            what = (
                f"asks for contact of a paraboloid with a hollow {other.kind}, whose distance is not computed"
            )
            raise _refused("rigid", what, "other shapes for one of the two")


def _cavity(e: Element) -> bool:
    return e.side < 0 and e.kind not in _EDGES


def _touch(a: Element, b: Element) -> bool:
    """Whether the runtime looks at this pair."""
    x, y = sorted((a.kind, b.kind), key=KINDS.index)
    if x == "vertex":
        return KINDS.index(y) >= KINDS.index("polygon")
    if x == "segment":
        return y not in _FLAT
    if x in _FLAT:
        return y in ("sphere", "torus", "paraboloid")
    if _cavity(a) and _cavity(b):
        return False
    if x in ("cone", "torus", "paraboloid") and "torus" not in (x, y):
        return y == "paraboloid" and not (_cavity(a) or _cavity(b))  # of others rims and apices meet first
    return True


def _region(a: str, b: str) -> int:
    """1: their contact may be a line, 2: a plane, 0: points only."""
    pair = {a, b}
    if (a in _FLAT and b in _FLAT) or ("torus" in pair and pair & set(_FLAT)):
        return 2
    if pair & {"segment", "cylinder", "cone"} and pair & set(_FLAT):
        return 1
    return 1 if pair in ({"cylinder"}, {"cylinder", "segment"}) else 0


def _beside(elements: list[Element], first: list[int], i: int) -> set[int]:
    """Faces that share a convex edge with element i."""
    found: set[int] = set()
    for j, e in enumerate(elements):
        if e.kind not in ("segment", "circle") or first[j] != first[i]:
            continue
        faces = [b + first[j] for b in e.bounds]
        if i in faces:
            found |= set(faces) - {i}
    return found
