# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Print what evenly spread nodes would cost an authored asset around one place, such as a nodule.

    python tests/benchmarks/even_nodes.py SCENE ASSET --around=X,Y,Z,R [--counts 80,120,160,240] [--tool NAME]

For each count the whole reach would get so many nodes, each farthest from those before; those within R + MARGIN of the
place are pressed, elsewhere the asset's own nodes stay.  Judged by the asset's held-out presses within R
(validation/*.json: `palpate validate ASSET --within X,Y,Z,R` makes them), beside the asset's own field.
"""

from __future__ import annotations

import argparse
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
from node_worth import errors, held_out, rebuilt

from palpate.author.authored_tool import AuthoredTool, authored_tool
from palpate.author.field_stage import knots_of, press_arrays
from palpate.author.press_executor import fitting_workers, press_executor
from palpate.author.press_jobs import PressJob, run_jobs
from palpate.author.sampling import farthest_of
from palpate.author.scene import Scene, load_scene
from palpate.author.store import Store
from palpate.author.tool_work import ladder
from palpate.fields.node_fit import fit_nodes
from palpate.fields.response_field import ResponseNodes

MARGIN = 35e-3
"""m; as far as kriging's longest length."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("asset", type=Path)
    parser.add_argument("--around", required=True, help="X,Y,Z,R, m")
    parser.add_argument("--counts", default="80,120,160,240", help="nodes on the whole reach: %(default)s")
    parser.add_argument("--tool")
    given = parser.parse_args()
    *centre, radius = map(float, given.around.split(","))
    counts = sorted(map(int, given.counts.split(",")))
    scene, authored = load_scene(given.scene), authored_tool(given.asset, given.tool)

    def distance(points: np.ndarray) -> np.ndarray:
        return np.linalg.norm(points - np.array(centre), axis=1)

    name = authored.field.tool.name
    judges = [
        press for press in held_out(given.asset, name) if distance([press["contact_point"]])[0] <= radius
    ]
    if not judges:
        parser.error(f"no held-out press within {radius} m: palpate validate ASSET --within makes them")
    places = authored.samples.points[authored.samples.allowed]
    order = places[farthest_of(places, counts[-1])]
    near = distance(order) <= radius + MARGIN
    pressed = nodes_at(scene, authored, order[near], Store(given.asset / "work"))
    rank = [int(np.argmin(np.linalg.norm(order - at, axis=1))) for at in pressed.position]
    own = authored.field.nodes
    beyond = rows(own, distance(own.position) > radius + MARGIN)
    print(
        f"{name}: {len(judges)} held-out presses within {1e3 * radius:g} mm; {len(pressed.position)} new presses"
    )
    print("nodes            of them near   normal % p50   p95   max   lateral % p50   p95   max")
    tell(f"chosen {own.node_count}", own.node_count - beyond.node_count, errors(authored.field, judges))
    for count in counts:
        here = rows(pressed, np.array(rank) < count)
        field = rebuilt(authored, joined(here, beyond), with_gradients=True)
        tell(f"even {count}", here.node_count, errors(field, judges))


def tell(name: str, near: int, found: tuple[np.ndarray, np.ndarray]) -> None:
    print(f"{name:16} {near:12d}  " + "".join(f"{100 * x:7.2f}" for x in np.concatenate(found)), flush=True)


def nodes_at(scene: Scene, authored: AuthoredTool, points: np.ndarray, store: Store) -> ResponseNodes:
    """Nodes pressed at points (n, 3) m; those that failed are left out."""
    tool, field = scene.tool_named(authored.field.tool.name), authored.field
    depths = tuple(map(float, ladder(field.depth_max)))
    fidelity = scene.accuracy.fidelity
    jobs = [PressJob(tuple(map(float, at)), authored.shape, depths, fidelity) for at in points]
    count, _ = fitting_workers(len(authored.mesh.tets), {fidelity})
    with press_executor(count) as executor:
        outcomes = run_jobs(authored.mesh, jobs, store, executor, lambda outcome: None)
    usable = [press_arrays(scene, tool, outcome, authored.mesh)[0] for outcome in outcomes]
    kept = [press for press in usable if press is not None]
    return fit_nodes(kept, knots_of(scene, tool), field.tool.offset, field.geometry)


def _columns(nodes: ResponseNodes) -> list[str]:
    found = [f.name for f in fields(nodes) if f.name != "depth_knots"]
    return [name for name in found if isinstance(getattr(nodes, name), np.ndarray)]


def rows(nodes: ResponseNodes, chosen: np.ndarray) -> ResponseNodes:
    return replace(nodes, **{name: getattr(nodes, name)[chosen] for name in _columns(nodes)})


def joined(first: ResponseNodes, second: ResponseNodes) -> ResponseNodes:
    both = {name: np.concatenate([getattr(first, name), getattr(second, name)]) for name in _columns(first)}
    return replace(first, **both)


if __name__ == "__main__":
    main()
