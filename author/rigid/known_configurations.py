# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Poses whose contact formation is known from how they are built, and how many of them the runtime names rightly.

Gaps lie between 0.25 and 0.75 eps, other elements at least 2 eps away.  Noise moves no point of the held object by
more than a tenth of eps by translation, and as much again by rotation.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.rigid.body import Body, combined
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.formations import formation_table, jolted, keys_of
from palpate.author.rigid.law import LUO_XIAO
from palpate.author.rigid.polyhedron import box, plate_with_hole
from palpate.author.rigid.shapes import cylinder, sphere
from palpate.runtime.rigid import Rigid

__all__ = ["identified"]

EPS = LUO_XIAO.threshold
Pose = tuple[np.ndarray, np.ndarray, list[tuple[int, int]]]
"""Position of the centre of mass, rotation matrix, and the formation as pairs of element indices of both bodies."""

PEG = box((0.04, 0.06, 0.02))
PLATE = plate_with_hole((0.3, 0.3, 0.03), (0.08, 0.1))
BALL, ROD = sphere(0.02), cylinder(0.02, 0.08)
BAR = cylinder(0.02, 0.2)
ALONG_X = np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]])
ALONG_Y = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
CROSS = combined([BAR.moved(ALONG_X, np.zeros(3)), BAR.moved(ALONG_Y, np.zeros(3))])
BLOCK = box((0.3, 0.3, 0.03)).moved(np.eye(3), np.array([0, 0, -0.015]))
DOWN = np.array([0, 0, -1.0])


def _faces(body: Body) -> list[int]:
    return [i for i, e in enumerate(body.elements) if e.kind == "polygon"]


def _face(body: Body, normal: tuple[float, float, float], inner: bool = False) -> int:
    def at(i: int) -> float:
        return float(body.elements[i].centre @ np.array(normal))

    fits = [i for i in _faces(body) if body.elements[i].axis @ np.array(normal) > 0.99]
    return min(fits, key=at) if inner else max(fits, key=at)


def _gap(rng: np.random.Generator) -> float:
    return EPS * rng.uniform(0.25, 0.75)


def _facing(direction: np.ndarray, spin: float) -> np.ndarray:
    """A rotation that turns `direction` down, then by `spin` about z."""
    turn, _ = Rotation.align_vectors([DOWN], [direction / np.linalg.norm(direction)])
    return (Rotation.from_euler("z", spin) * turn).as_matrix()


def _lowest(rotation: np.ndarray, body: Body) -> float:
    corners = np.array([e.centre for e in body.elements if e.kind == "vertex"]) - body.centre
    return float((corners @ rotation.T)[:, 2].min())


def _on_top(element: int, direction: np.ndarray, rng: np.random.Generator) -> Pose:
    rotation = _facing(direction, rng.uniform(0, 2 * np.pi))
    x = rng.uniform(0.085, 0.105) * rng.choice([-1, 1])
    position = np.array([x, rng.uniform(-0.1, 0.1), 0.015 - _lowest(rotation, PEG) + _gap(rng)])
    return position, rotation, [(element, _face(PLATE, (0, 0, 1)))]


def face_on_face(rng: np.random.Generator) -> Pose:
    f = int(rng.choice(_faces(PEG)))
    return _on_top(f, PEG.elements[f].axis, rng)


def edge_on_face(rng: np.random.Generator) -> Pose:
    e = int(rng.choice([i for i, x in enumerate(PEG.elements) if x.kind == "segment"]))
    angle = np.radians(rng.uniform(25, 65))
    n = PEG.elements[e].normal
    return _on_top(e, np.cos(angle) * n[0] + np.sin(angle) * n[1], rng)


def vertex_on_face(rng: np.random.Generator) -> Pose:
    v = int(rng.choice([i for i, x in enumerate(PEG.elements) if x.kind == "vertex"]))
    return _on_top(v, np.sign(PEG.elements[v].centre) * rng.uniform(0.4, 1, 3), rng)


def edge_across_edge(rng: np.random.Generator) -> Pose:
    """A long edge of the peg lies across a long edge of the hole's mouth, one end down in the hole."""
    e = int(rng.choice([i for i, x in enumerate(PEG.elements) if x.kind == "segment" and x.high > 0.025]))
    mouth = next(
        i for i, x in enumerate(PLATE.elements)
        if x.kind == "segment" and x.centre[2] > 0 and abs(x.centre[0] - 0.04) < 1e-9 and abs(x.axis[1]) > 0.9
    )  # fmt: skip
    edge = PEG.elements[e]
    angle = np.radians(rng.uniform(30, 60))
    down = np.cos(angle) * edge.normal[0] + np.sin(angle) * edge.normal[1]
    slope = np.radians(rng.uniform(15, 30))
    along, out = np.array([np.cos(slope), 0, np.sin(slope)]), np.array([-np.sin(slope), 0, np.cos(slope)])
    world = np.stack([along, -out, np.cross(along, -out)], axis=1)
    ours = np.stack([edge.axis, down, np.cross(edge.axis, down)], axis=1)
    rotation = world @ ours.T
    at = np.array([0.04, rng.uniform(-0.015, 0.015), 0.015])
    centre = at + out * _gap(rng) + along * rng.uniform(-0.008, 0.008)
    return centre - rotation @ (edge.centre - PEG.centre), rotation, [(e, mouth)]


def in_the_hole(rng: np.random.Generator, corner: bool) -> Pose:
    turn = int(rng.integers(4))
    rotation = Rotation.from_euler("z", 90 * turn, degrees=True).as_matrix()
    half = np.abs(rotation @ np.array([0.02, 0.03, 0.01]))
    position = np.array([0.04 - half[0] - _gap(rng), rng.uniform(-0.012, 0.012), rng.uniform(-0.002, 0.002)])
    pairs = [(_face(PEG, tuple(rotation.T @ [1, 0, 0])), _face(PLATE, (-1, 0, 0), True))]
    if corner:
        position[1] = 0.05 - half[1] - _gap(rng)
        pairs.append((_face(PEG, tuple(rotation.T @ [0, 1, 0])), _face(PLATE, (0, -1, 0), True)))
    return position, rotation, pairs


def ball_on_bars(rng: np.random.Generator, both: bool) -> Pose:
    rotation = Rotation.random(random_state=rng).as_matrix()
    z, first, second = rng.uniform(0.005, 0.03), 0.04 + _gap(rng), 0.04 + _gap(rng)
    if both:
        x, y = np.sqrt(second**2 - z**2), np.sqrt(first**2 - z**2)
        return np.array([x * rng.choice([-1, 1]), y * rng.choice([-1, 1]), z]), rotation, [(0, 0), (0, 5)]
    y = np.sqrt(first**2 - z**2)
    return np.array([rng.uniform(0.05, 0.09), y, z]), rotation, [(0, 0)]


def rod_on_block(rng: np.random.Generator, how: str) -> Pose:
    top = _face(BLOCK, (0, 0, 1))
    spin = Rotation.from_euler("z", rng.uniform(0, 360), degrees=True)
    xy = rng.uniform(-0.08, 0.08, 2)
    if how == "stands":
        up = rng.choice([-1, 1])
        rotation = (spin * Rotation.from_euler("x", 0 if up > 0 else 180, degrees=True)).as_matrix()
        return np.array([*xy, 0.04 + _gap(rng)]), rotation, [(2 if up > 0 else 1, top)]
    if how == "lies":
        rotation = (spin * Rotation.from_euler("x", 90, degrees=True)).as_matrix()
        return np.array([*xy, 0.02 + _gap(rng)]), rotation, [(0, top)]
    tilt = np.radians(rng.uniform(15, 75))
    rotation = (spin * Rotation.from_euler("x", tilt)).as_matrix()
    return np.array([*xy, 0.04 * np.cos(tilt) + 0.02 * np.sin(tilt) + _gap(rng)]), rotation, [(4, top)]


def rod_on_bar(rng: np.random.Generator, parallel: bool) -> Pose:
    """On the bar along x, beside the crossing."""
    angle = 0.0 if parallel else np.radians(rng.uniform(20, 90)) * rng.choice([-1, 1])
    rotation = Rotation.from_euler("z", angle).as_matrix() @ ALONG_X
    x = rng.uniform(0.065, 0.08)
    return np.array([x, 0, 0.04 + _gap(rng)]), rotation, [(0, 0)]


Maker = Callable[[np.random.Generator], Pose]
CASES: list[tuple[str, Body, Body, Maker]] = [
    ("face on face", PEG, PLATE, face_on_face),
    ("edge on face", PEG, PLATE, edge_on_face),
    ("vertex on face", PEG, PLATE, vertex_on_face),
    ("edge across edge", PEG, PLATE, edge_across_edge),
    ("face on wall", PEG, PLATE, lambda rng: in_the_hole(rng, False)),
    ("two faces in a corner", PEG, PLATE, lambda rng: in_the_hole(rng, True)),
    ("ball on one cylinder", BALL, CROSS, lambda rng: ball_on_bars(rng, False)),
    ("ball on two cylinders", BALL, CROSS, lambda rng: ball_on_bars(rng, True)),
    ("cylinder stands", ROD, BLOCK, lambda rng: rod_on_block(rng, "stands")),
    ("cylinder lies", ROD, BLOCK, lambda rng: rod_on_block(rng, "lies")),
    ("cylinder on its rim", ROD, BLOCK, lambda rng: rod_on_block(rng, "leans")),
    ("cylinder along cylinder", ROD, CROSS, lambda rng: rod_on_bar(rng, True)),
    ("cylinder across cylinder", ROD, CROSS, lambda rng: rod_on_bar(rng, False)),
]


def identified(
    count: int = 100_000, noise: float = 0.1, seed: int = 1, samples: int = 0
) -> dict[str, object]:
    """How many of `count` poses are named rightly.

    Args:
        noise: largest displacement by translation, and by rotation, as a fraction of eps.
        samples: poses that search each pair's table of formations; 0: no table.

    Returns:
        count, right (fraction), cases (fraction right of each).
    """
    rng = np.random.default_rng(seed)
    each = -(-count // len(CASES))
    cases: dict[str, float] = {}
    right = 0
    tables: dict[tuple[int, int], tuple[tuple[int, ...], ...]] = {}
    for name, held, fixed, make in CASES:
        pair = id(held), id(fixed)
        if samples and pair not in tables:
            tables[pair] = formation_table(held, fixed, samples=samples).formations
        rigid = Rigid(cooked_rigid(held, fixed, 0.5, formations=tables.get(pair, ())))
        poses = [make(rng) for _ in range(each)]
        position = np.array([p[0] for p in poses])
        orientation = Rotation.from_matrix(np.array([p[1] for p in poses])).as_quat()
        found = rigid.identify(*jolted(held, position, orientation, noise * EPS, rng))
        first = len(held.elements)
        hits = 0
        for row, (_, _, pairs) in zip(found, poses, strict=True):
            hits += keys_of(row) == tuple(sorted(h << 16 | (first + f) for h, f in pairs))
        cases[name] = hits / each
        right += hits
    return {"count": each * len(CASES), "noise": noise, "right": right / (each * len(CASES)), "cases": cases}
