# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a scene will cost and hold, before any work starts: what is meshed, pressed, stored, and left out."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from palpate.author.console import Answer, table_of
from palpate.author.effort import press_memory, worker_count
from palpate.author.material_range import refuse_unstable_materials
from palpate.author.memory import available_memory
from palpate.author.organ_check import OrganSummary, check_against_organ
from palpate.author.organ_parts import organ_parts, rough_summary
from palpate.author.paint import read_paint
from palpate.author.plan_costs import added_by, tool_row, with_time
from palpate.author.press_executor import core_count
from palpate.author.scene import Scene
from palpate.author.scene_tables import EFFECTS

__all__ = ["fidelities_of", "plan", "planned_mesh_size"]

_STORED = {
    "response": "stored energy, normal force and lateral gradient over depth at each node",
    "friction": "stiffness of the friction spring and friction coefficient over depth at each node",
    "texture": "waves of height on the surface, inside the stored energy; no press of their own",
    "transient": "forces by incoming velocity that a contact plays on top of its response; no press of their own",
    "deformation": "how the surface moves over depth and distance, for graphics: about 0.1 MB a tool, from the "
    "same presses; nothing in the tick",
}

MESH_SIZE_SHARE = 1.0 / 32.0
"""Edge of the organ-wide tetrahedra over the organ's diagonal when the scene states none; 8 mm on a liver."""


def planned_mesh_size(scene: Scene, organ: OrganSummary) -> float:
    """Target edge of the organ-wide tetrahedra, m."""
    return scene.organ.mesh_size or MESH_SIZE_SHARE * float((organ.size**2).sum() ** 0.5)


def plan(scene: Scene, workers: int | None = None, tool: str = "") -> Answer:
    """The plan of `scene`.

    Args:
        tool: name of the only one; all when empty.
        workers: processes that press; one for each core when absent.  Fewer where memory does not hold them.

    Raises:
        InputError: the scene does not fit its organ.
    """
    chosen = scene.tool if not tool else (scene.tool_named(tool),)
    parts = organ_parts(scene)
    organ, taken_from = rough_summary(parts)
    check_against_organ(scene, organ)
    refuse_unstable_materials(scene)
    paint = read_paint(scene)
    reach_share = organ.share_within(scene.reach, paint) if scene.reach.is_given or paint else 1.0
    reach_area = reach_share * organ.area
    mesh_size = planned_mesh_size(scene, organ)
    # a regular tetrahedron of edge h has the volume h^3 / (6 sqrt 2)
    tets = round(organ.volume * 6.0 * 2.0**0.5 / mesh_size**3)
    cores = core_count()
    peak, available = press_memory(tets, fidelities_of(scene)), available_memory()
    count, limited = worker_count(peak, available, cores, workers)
    tools = [tool_row(scene, one, reach_area, tets) for one in chosen]
    cpu_seconds, seconds = with_time(tools, tets, min(count, cores), scene.accuracy.time_budget)
    added = added_by(scene, chosen, tools, reach_area)
    result: dict[str, Any] = {
        "scene": scene.name,
        "mesh": {
            "surface": str(scene.organ.surface),
            "parts": len(parts),
            "repair": scene.organ.repair,
            "size": organ.size,
            "area": organ.area,
            "volume": organ.volume,
            "taken_from": taken_from,
            "mesh_size": mesh_size,
            "tets": tets,
            "supports": len(scene.organ.support),
            "regions": [region.name for region in scene.organ.region],
            "capsule": scene.organ.capsule.model_dump(exclude_none=True) if scene.organ.capsule else None,
            "paint": sorted(paint.values) if paint else [],
            "material": scene.organ.material.model_dump(exclude_none=True),
            "shear_modulus": scene.organ.material.shear_modulus,
        },
        "reach": {"area": reach_area, "share": reach_share},
        "fidelity": scene.accuracy.fidelity,
        "force_tolerance": scene.accuracy.force_tolerance,
        "tools": tools,
        "stored": {effect: _STORED[effect] for effect in scene.effects if effect in _STORED},
        "not_modelled": [effect for effect in EFFECTS if effect not in scene.effects],
        "cpu_seconds": cpu_seconds,
        "cores": cores,
        "workers": count,
        "seconds": seconds,
        "time_budget": scene.accuracy.time_budget,
        "added": added,
        "memory": {
            "worker": peak,
            "workers": count * peak,
            "available": available,
            "limited": limited,
        },
    }
    return Answer(result, [_summary(result), _tool_table(tools), _added_table(added)])


def fidelities_of(scene: Scene) -> set[str]:
    """What is pressed; held-out presses are full, whatever builds the field."""
    return {scene.accuracy.fidelity} | ({"full"} if scene.accuracy.held_out else set())


def _summary(result: dict[str, Any]) -> str:
    mesh, reach = result["mesh"], result["reach"]
    size = " x ".join(f"{1e3 * side:.0f}" for side in mesh["size"])
    tets = f"about {mesh['tets']} tetrahedra of {1e3 * mesh['mesh_size']:.1f} mm"
    cpu, wall = _minutes(result["cpu_seconds"]), _minutes(result["seconds"])
    tolerance = f"{100 * result['force_tolerance']:.1f} % of force"
    memory = result["memory"]
    free = (
        "free memory unknown"
        if memory["available"] is None
        else f"{memory['available'] / 1e9:.1f} GB are free"
    )
    lines = [
        f"scene     {result['scene']}",
        f"surface   {mesh['parts']} part(s), {size} mm, {1e6 * mesh['volume']:.0f} ml",
        f"          taken from {mesh['taken_from']}",
        f"mesh      {tets}",
        f"material  {mesh['material']['model']}, shear modulus {1e-3 * mesh['shear_modulus']:.3g} kPa, "
        f"Poisson's ratio {mesh['material']['poissons_ratio']:g}",
        *(
            [
                f"capsule   {1e6 * mesh['capsule']['thickness']:.0f} um of {mesh['capsule']['material']['model']}"
            ]
            if mesh["capsule"]
            else []
        ),
        *([f"paint     {', '.join(mesh['paint'])}"] if mesh["paint"] else []),
        f"reach     {1e4 * reach['area']:.1f} cm2, {100 * reach['share']:.0f} % of the surface",
        *(f"stored    {what}" for what in result["stored"].values()),
        f"left out  {', '.join(result['not_modelled']) or 'nothing'}",
        f"effort    {cpu} of CPU, {wall} with {result['workers']} worker(s), {result['fidelity']}, for {tolerance}",
        f"memory    about {memory['worker'] / 1e9:.1f} GB a worker, {memory['workers'] / 1e9:.1f} GB in all; {free}",
        *([f"          {memory['limited']}"] if memory["limited"] else []),
    ]
    return "\n".join(lines)


def _tool_table(tools: list[dict[str, Any]]) -> Table:
    table = table_of("tool", "shape", "depth (mm)", "seeds", "nodes", "at most", "held out")
    for tool in tools:
        table.add_row(
            tool["name"],
            tool["shape"],
            f"{1e3 * tool['depth_max']:.1f}",
            str(tool["seeds"]),
            str(tool["pressed"]),
            str(tool["nodes"]),
            str(tool["held_out"]),
        )
    return table


def _added_table(added: dict[str, list[dict[str, Any]]]) -> Table:
    table = table_of("it adds", "", "presses", "CPU", "bytes", "ns a tick")
    for kind, rows in added.items():
        for row in rows:
            numbers = (
                ("presses", str),
                ("cpu_seconds", _minutes),
                ("bytes", lambda size: f"{1e-3 * size:.0f} kB"),
                ("tick_ns", lambda ns: f"{ns:.0f}"),
            )
            shown = ["not known" if row[key] is None else told(row[key]) for key, told in numbers]
            table.add_row(kind.removesuffix("s"), row["name"], *shown)
    return table


def _minutes(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
