# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid sphere pressed into quadratic tetrahedra, as a CalculiX deck: the very mesh that palpate presses.

Ten-node tetrahedra with four points each (C3D10), whose nodes stand in our order; finite strain.  The sphere is a cap
of twenty-node bricks, one thick, whose nodes lie on it and are all prescribed:

    x = c + R n + R d / |d|,    d = tan(alpha) t_1 + tan(beta) t_2 - n

over a square of angles (t_1, t_2 the contact's tangents), so that it bends as it should between its nodes.  Contact is
face to face, without friction, with the pressure proportional to the overclosure (penalty).  Lengths are in tool radii
and stresses in Young's moduli, as in calculix_layer.py, where the neo-Hookean's constants are.

Measured: sphere of 5 mm up to 2.5 mm deep in a block of 60 x 60 x 30 mm, nu 0.48, 18,489 unknowns, five depths: ours is
0.9 to 1.3 % below it.  The penalty and the tool's mesh are calculix_layer.py's and not varied here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.pose import tangents
from palpate.fem_offline.verification.calculix import CalculixError, total_forces

__all__ = ["SolidPress", "forces_of", "solid_deck"]

CONTACT, CAP = "TOUCH", "CAP"
SIDES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))
"""Corners of a tetrahedron's sides S1 to S4."""
BRICK = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
"""Corners, then mid-edges of one side of a brick, on a lattice twice as fine."""
FOUR = 4
INNER = 0.7
"""The cap's inner side, in R."""


@dataclass(frozen=True)
class SolidPress:
    """What is pressed, and how far.

    Attributes:
        nodes: (N, 3) m; of the mesh.  elements: (T, 10) as in quadratic_space.py.
        faces: (B, 3) corner nodes of the sides that may touch.
        held: (H,) nodes that do not move.
        material: of all of it.
        contact_point: (3,) m, on the surface.  normal: (3,) outward.
        radius: m; of the sphere.
        depths: m, rising; of the sphere's lowest point below the contact point.
    """

    nodes: np.ndarray
    elements: np.ndarray
    faces: np.ndarray
    held: np.ndarray
    material: NeoHookean
    contact_point: np.ndarray
    normal: np.ndarray
    radius: float
    depths: tuple[float, ...]


def solid_deck(
    press: SolidPress, penalty: float = 300.0, step: float = 0.1, bricks: int = 24, reach: float = 1.1
) -> str:
    """The input file: one step for each depth.

    Args:
        penalty: pressure over overclosure, in E / a, a = sqrt(R d) at the deepest state.
        step: largest move between equilibria, in R.
        bricks: of the cap, along each of its two angles.
        reach: rad; of the cap's angles, both ways.
    """
    R, E = press.radius, press.material.youngs_modulus
    depth = np.array(press.depths) / R
    places = (press.nodes - press.contact_point) / R
    cap, outside = _cap(press.normal, bricks, reach)
    cap_nodes = len(places) + 1 + np.arange(len(cap))
    first = len(press.elements) + 1
    mu, kappa = press.material.shear_modulus / E, press.material.bulk_modulus / E
    lines = ["*NODE", *_rows(1 + np.arange(len(places)), places), *_rows(cap_nodes, cap)]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=BODY"]
    lines += [f"{k}, {', '.join(map(str, e))}" for k, e in enumerate(press.elements + 1, start=1)]
    lines += [f"*ELEMENT, TYPE=C3D20, ELSET={CAP}"]
    for k, brick in enumerate(outside + len(places) + 1, start=first):
        text = [str(n) for n in (k, *brick)]  # a line holds sixteen entries
        lines += [", ".join(text[:11]) + ",", ", ".join(text[11:])]
    for name, members in (("BASE", press.held + 1), ("TOOL", cap_nodes)):
        lines += [f"*NSET, NSET={name}", *(f"{n}," for n in members)]
    lines += ["*SURFACE, NAME=SOFT", *(f"{k + 1}, S{s + 1}" for k, s in _sides(press))]
    lines += ["*SURFACE, NAME=HARD", *(f"{first + k}, S2" for k in range(len(outside)))]
    lines += ["*MATERIAL, NAME=TISSUE", "*HYPERELASTIC, NEO HOOKE", f"{0.5 * mu:.12g}, {2.0 / kappa:.12g}"]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "1000., 0.3"]  # no effect: every node of it is prescribed
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=TISSUE", f"*SOLID SECTION, ELSET={CAP}, MATERIAL=STEEL"]
    lines += [f"*SURFACE INTERACTION, NAME={CONTACT}", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
    lines += [f"{penalty / np.sqrt(depth[-1]):.12g}"]
    lines += [f"*CONTACT PAIR, INTERACTION={CONTACT}, TYPE=SURFACE TO SURFACE", "SOFT, HARD"]
    lines += ["*BOUNDARY", "BASE, 1, 3, 0."]
    for start, end in zip((0.0, *depth[:-1]), depth, strict=True):
        share = 1.0 / np.ceil((end - start) / step - 1e-9)
        lines += ["*STEP, NLGEOM, INC=400", "*STATIC", f"{share:.9g}, 1., 1e-4, {share:.9g}", "*BOUNDARY"]
        lines += [f"TOOL, {i + 1}, {i + 1}, {-end * press.normal[i]:.12g}" for i in range(3)]
        lines += ["*NODE PRINT, NSET=BASE, TOTALS=ONLY, FREQUENCY=10000", "RF", "*END STEP"]
    return "\n".join(lines) + "\n"


def forces_of(press: SolidPress, dat: str) -> np.ndarray:
    """(K, 3) N on the tool at each depth, from what `run_calculix` printed for the deck.

    Raises:
        CalculixError: forces are missing.
    """
    reaction = total_forces(dat, "BASE")
    if len(reaction) != len(press.depths):
        raise CalculixError(f"CalculiX printed {len(reaction)} of {len(press.depths)} forces")
    return press.material.youngs_modulus * press.radius**2 * reaction


def _rows(numbers: np.ndarray, places: np.ndarray) -> list[str]:
    # CalculiX reads twenty characters of a number: with more digits a small one loses its exponent
    return [f"{n}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in zip(numbers, places, strict=True)]


def _sides(press: SolidPress) -> list[tuple[int, int]]:
    """Element and side (from 0) of each face, in their order.

    Raises:
        ValueError: a face that is no element's side.
    """
    corners = press.elements[:, :4]
    used = np.flatnonzero(np.isin(corners, press.faces).sum(axis=1) >= 3)
    owner = {
        tuple(sorted(corners[k][list(side)].tolist())): (int(k), s)
        for k in used
        for s, side in enumerate(SIDES)
    }
    try:
        return [owner[tuple(sorted(face))] for face in press.faces.tolist()]
    except KeyError as error:
        raise ValueError(f"no tetrahedron has a side with the corners {error.args[0]}") from None


def _cap(normal: np.ndarray, bricks: int, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 3) in R from the contact point, and bricks (m, 20) of them, their sides S2 on the sphere."""
    fine = 2 * bricks + 1
    i, j = np.meshgrid(np.arange(fine), np.arange(fine), indexing="ij")
    t1, t2 = tangents(normal)
    slope = np.tan(np.linspace(-reach, reach, fine))
    # t_2 before t_1: with them in this order the third axis, from inside to outside, makes a right-handed brick
    away = slope[i][..., None] * t2 + slope[j][..., None] * t1 - normal
    away /= np.linalg.norm(away, axis=2, keepdims=True)
    no_middle = (i % 2 == 0) | (j % 2 == 0)
    corner = (i % 2 == 0) & (j % 2 == 0)
    nodes, numbers, count = [], [], 0
    for used, distance in ((no_middle, INNER), (no_middle, 1.0), (corner, 0.5 * (1.0 + INNER))):
        number = np.full((fine, fine), -1)
        number[used] = count + np.arange(used.sum())
        count += int(used.sum())
        nodes.append(normal + distance * away[used])
        numbers.append(number)
    inner, outer, between = (
        [number[di : fine - 2 + di : 2, dj : fine - 2 + dj : 2].ravel() for di, dj in BRICK]
        for number in numbers
    )
    order = [*inner[:FOUR], *outer[:FOUR], *inner[FOUR:], *outer[FOUR:], *between[:FOUR]]
    return np.concatenate(nodes), np.stack(order, axis=1)
