# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid sphere pressed into a soft disc bonded at its base, as a CalculiX deck: axisymmetric, finite strain.

Eight-node axisymmetric quadrilaterals with reduced integration (CAX8R).  CalculiX turns them into a wedge of 2 degrees
and prints the wedge's forces: those of the whole are 180 times as large.  The sphere is a shell of the same elements
whose nodes are all prescribed.  Contact is face to face, with the pressure proportional to the overclosure (penalty).
Lengths are in tool radii and stresses in Young's moduli, because CalculiX's own thresholds are not relative.

Neo-Hookean: CalculiX has W = C10 (I1 J^(-2/3) - 3) + (J - 1)^2 / D1; ours is C10 = mu / 2, D1 = 2 / kappa.

What each setting changes, measured: DECISIONS.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.verification.calculix import run_calculix, total_forces

__all__ = ["DeckSettings", "LayerPress", "calculix_force", "layer_deck"]

WEDGES = 180.0


@dataclass(frozen=True)
class LayerPress:
    """What is pressed, and how far.

    Attributes:
        radius: m; of the sphere.
        thickness: m; of the disc, bonded at its base.
        width: m; from the axis to the disc's free side.
        material: of the disc.
        depths: m, rising; of the sphere's lowest point below the untouched surface.
        friction: Coulomb's coefficient.
    """

    radius: float
    thickness: float
    width: float
    material: NeoHookean
    depths: tuple[float, ...]
    friction: float = 0.0


@dataclass(frozen=True)
class DeckSettings:
    """How it is solved.

    Attributes:
        edges: elements over the Hertz contact radius at the deepest state, a = sqrt(R d).
        growth: of each element over its neighbour, away from the contact.
        penalty: pressure over overclosure, in E / a.
        stick: shear traction over slip while a point sticks, in E / a.
        step: largest move between equilibria, in R.
        element: CAX8R or CAX8.
    """

    edges: int = 8
    growth: float = 1.2
    penalty: float = 300.0
    stick: float = 30.0
    step: float = 0.04
    element: str = "CAX8R"


def calculix_force(press: LayerPress, settings: DeckSettings = DeckSettings()) -> np.ndarray:
    """(K,) N; normal force at each depth.  Raises CalculixError."""
    reaction = total_forces(run_calculix(layer_deck(press, settings)), "BASE")[:, 1]
    if len(reaction) != len(press.depths):
        raise RuntimeError(f"CalculiX printed {len(reaction)} of {len(press.depths)} forces")
    return WEDGES * press.material.youngs_modulus * press.radius**2 * reaction


def layer_deck(press: LayerPress, settings: DeckSettings = DeckSettings()) -> str:
    """The input file."""
    R, E = press.radius, press.material.youngs_modulus
    h, width, depth = press.thickness / R, press.width / R, np.array(press.depths) / R
    a = np.sqrt(depth[-1])
    edge = a / settings.edges
    radial = _graded(edge, min(1.4 * a, width), width, settings.growth)
    axial = _graded(edge, edge, h, settings.growth)
    disc = _Lattice(radial, -axial[::-1], 0, 0)
    # an arc that the surface cannot leave, three layers of nodes thick
    reach = min(1.25, 1.3 * np.arcsin(min(1.0, 1.2 * a)))
    arc = np.linspace(0.0, reach, int(np.ceil(reach / edge)) + 1)
    ball = _Lattice(arc, np.array([0.0, 0.2]), disc.last_node, len(disc.elements))
    angle, inward = ball.places.T
    ball_places = np.stack([(1.0 - inward) * np.sin(angle), 1.0 - (1.0 - inward) * np.cos(angle)], axis=1)
    touching = (
        np.flatnonzero(radial[:-1] < 1.8 * a) * (len(axial) - 1) + len(axial) - 1
    )  # last row of each column
    mu, kappa = press.material.shear_modulus / E, press.material.bulk_modulus / E
    lines = ["*NODE"]
    lines += [f"{n}, {x:.12g}, {y:.12g}, 0." for n, (x, y) in zip(disc.nodes, disc.places, strict=True)]
    lines += [f"{n}, {x:.12g}, {y:.12g}, 0." for n, (x, y) in zip(ball.nodes, ball_places, strict=True)]
    for name, lattice in (("DISC", disc), ("BALL", ball)):
        lines += [f"*ELEMENT, TYPE={settings.element}, ELSET={name}"]
        lines += [f"{lattice.first + k}, {', '.join(map(str, e))}" for k, e in enumerate(lattice.elements)]
    low, left = disc.places[:, 1] == disc.places[:, 1].min(), disc.places[:, 0] == 0.0
    for name, members in (("BASE", disc.nodes[low]), ("AXIS", disc.nodes[left]), ("TOOL", ball.nodes)):
        lines += [f"*NSET, NSET={name}", *(f"{n}," for n in members)]
    lines += ["*SURFACE, NAME=SOFT", *(f"{k}, S3" for k in touching)]
    lines += ["*SURFACE, NAME=HARD", *(f"{ball.first + k}, S1" for k in range(len(ball.elements)))]
    lines += ["*MATERIAL, NAME=TISSUE", "*HYPERELASTIC, NEO HOOKE", f"{0.5 * mu:.12g}, {2.0 / kappa:.12g}"]
    lines += [
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        "1000., 0.3",
    ]  # of no effect: every node of it is prescribed
    lines += ["*SOLID SECTION, ELSET=DISC, MATERIAL=TISSUE", "*SOLID SECTION, ELSET=BALL, MATERIAL=STEEL"]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
    lines += [f"{settings.penalty / a:.12g}"]
    if press.friction:
        lines += ["*FRICTION", f"{press.friction:.12g}, {settings.stick / a:.12g}"]
    lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE", "SOFT, HARD"]
    lines += ["*BOUNDARY", "BASE, 1, 2, 0.", "AXIS, 1, 1, 0.", "TOOL, 1, 1, 0."]
    for start, end in zip((0.0, *depth[:-1]), depth, strict=True):
        share = 1.0 / np.ceil((end - start) / settings.step - 1e-9)
        lines += ["*STEP, NLGEOM, INC=400", "*STATIC", f"{share:.9g}, 1., 1e-4, {share:.9g}"]
        lines += ["*BOUNDARY", f"TOOL, 2, 2, {-end:.12g}"]
        lines += ["*NODE PRINT, NSET=BASE, TOTALS=ONLY, FREQUENCY=10000", "RF", "*END STEP"]
    return "\n".join(lines) + "\n"


class _Lattice:
    """Eight-node quadrilaterals between grid lines x and y.

    Attributes:
        nodes: (n,) numbers, after `last_node`; places: (n, 2).
        elements: (m, 8) node numbers, counterclockwise corners, then mid-edges; column after column, rising.
        first: number of the first element, after `last_element`.
    """

    def __init__(self, x: np.ndarray, y: np.ndarray, last_node: int, last_element: int) -> None:
        columns, rows = 2 * len(x) - 1, 2 * len(y) - 1
        i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
        used = (i % 2 == 0) | (j % 2 == 0)  # no node in an element's middle
        number = np.zeros((columns, rows), int)
        number[used] = last_node + 1 + np.arange(used.sum())
        xs, ys = (np.interp(0.5 * np.arange(2 * len(c) - 1), np.arange(len(c)), c) for c in (x, y))
        self.nodes = number[used]
        self.places = np.stack([xs[i[used]], ys[j[used]]], axis=1)
        self.last_node = int(number.max())
        self.first = last_element + 1
        around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
        self.elements = np.stack(
            [number[di : columns - 2 + di : 2, dj : rows - 2 + dj : 2].ravel() for di, dj in around], axis=1
        )


def _graded(edge: float, even: float, length: float, growth: float) -> np.ndarray:
    """Grid lines from 0 to `length`: spacing `edge` up to `even`, then growing."""
    count = int(np.ceil(even / edge - 1e-9))
    lines = list(np.linspace(0.0, even, count + 1))
    spacing, rest = even / count, []
    while sum(rest) < length - even:
        spacing *= growth
        rest.append(spacing)
    if rest:
        lines += list(even + np.cumsum(rest) * (length - even) / sum(rest))
    return np.array(lines)
