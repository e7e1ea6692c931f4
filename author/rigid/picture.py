# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An example as a picture: both bodies, the way of the held one, force and torque over time, and what came out."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from palpate.author.rigid.body import Body, Element, frame_of
from palpate.author.rigid.examples import Run

__all__ = ["example_picture"]

COLOURS = ("tab:blue", "tab:orange", "tab:green")
HALFWAY, END = "tab:cyan", "tab:blue"
CHANGES_MAX = 12
"""Changes of formation that are marked; more would hide the curves."""


def example_picture(run: Run, path: Path) -> None:
    """Writes a PNG."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14, 6.4))
    view = figure.add_axes((0.0, 0.24, 0.36, 0.66), projection="3d")
    force = figure.add_axes((0.42, 0.33, 0.25, 0.52))
    torque = figure.add_axes((0.73, 0.33, 0.25, 0.52))
    figure.text(0.02, 0.96, f"{run.example.name}: {run.example.story}", fontsize=13, va="center")
    _scene(view, run)
    _curves(force, run, "contact_force", 1.0)
    _curves(torque, run, "contact_torque", 1e3)
    force.set(title="contact force on the held object", ylabel="N")
    torque.set(title="contact torque about its centre of mass", ylabel="N mm")
    force.legend(fontsize=8)
    for row, (what, met) in enumerate(run.outcomes):
        column, line = divmod(row, 3)
        mark, colour = ("met", "tab:green") if met else ("NOT MET", "tab:red")
        at = 0.02 + 0.49 * column, 0.17 - 0.055 * line
        figure.text(*at, mark, color=colour, fontsize=11, weight="bold")
        figure.text(at[0] + (0.035 if met else 0.07), at[1], what, fontsize=11)
    figure.savefig(path, dpi=90)


def _scene(view, run: Run) -> None:
    from matplotlib.lines import Line2D

    example = run.example
    position, orientation = (np.asarray(x) for x in example.path)
    reach = float(np.ptp(position, axis=0).max()) / 2 + max(e.ball[1] for e in example.held.elements)
    middle = (position.max(axis=0) + position.min(axis=0)) / 2
    limits = 1e3 * (middle[:, None] + np.array([-reach, reach]))
    view.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
    _draw(view, example.fixed, "0.45", limits)
    _draw(
        view,
        _placed(example.held, position[len(position) // 2], orientation[len(position) // 2]),
        HALFWAY,
        limits,
    )
    _draw(view, _placed(example.held, position[-1], orientation[-1]), END, limits)
    view.plot(*(1e3 * position.T), color="tab:red", linewidth=1.5)
    view.plot(*(1e3 * position[:1].T), "o", color="tab:red", markersize=5)
    view.set_box_aspect((1, 1, 1))
    view.set(xlabel="x, mm", ylabel="y, mm", zlabel="z, mm")
    view.tick_params(labelsize=7)
    lines = [("0.45", "fixed"), (HALFWAY, "held, halfway"), (END, "held, at the end"),
             ("tab:red", "way of its centre, from the dot")]  # fmt: skip
    view.figure.legend(
        [Line2D([], [], color=c) for c, _ in lines], [t for _, t in lines], fontsize=9, loc="lower left",
        bbox_to_anchor=(0.4, 0.195), ncols=4, frameon=False,
    )  # fmt: skip


def _curves(axes, run: Run, name: str, scale: float) -> None:
    for style, (variant, out) in zip(("-", "--"), run.responses.items(), strict=False):
        t = np.arange(len(out)) * run.example.dt
        for k, colour in enumerate(COLOURS):
            label = "xyz"[k] + (f", {variant}" if variant else "")
            axes.plot(t, scale * out[name][:, k], style, color=colour, label=label, linewidth=2.4 - 0.6 * k)
    out = run.responses[""]
    keys = [tuple(sorted(zip(r["held_element"][:n], r["fixed_element"][:n], strict=True)))
            for r, n in zip(out["contact"], out["contact_count"], strict=True)]  # fmt: skip
    changes = [i for i in range(1, len(keys)) if keys[i] != keys[i - 1]]
    if len(changes) <= CHANGES_MAX:
        for i in changes:
            axes.axvline(i * run.example.dt, color="0.75", linewidth=0.8, linestyle=":", zorder=0)
        axes.set_xlabel("t, s (dotted: principal contacts change)")
    else:
        axes.set_xlabel("t, s")
    axes.axhline(0, color="0.85", linewidth=0.8, zorder=0)


def _placed(body: Body, position: np.ndarray, orientation: np.ndarray) -> Body:
    from scipy.spatial.transform import Rotation

    centred = body.moved(np.eye(3), -body.centre)
    return centred.moved(Rotation.from_quat(orientation).as_matrix(), position)


def _draw(view, body: Body, colour: str, limits: np.ndarray) -> None:
    """Lines within `limits` (3, 2), mm; a face without edges ends there."""
    endless = not any(e.kind in ("segment", "circle", "sphere", "torus") for e in body.elements)
    part = np.linspace(0, 1, 40)[:, None]
    for e in body.elements:
        for line in _lines(e):
            points = np.concatenate([a + part * (b - a) for a, b in pairwise(1e3 * line)])
            if endless:
                points = np.clip(points, limits[:, 0], limits[:, 1])
            within = np.all((points >= limits[:, 0]) & (points <= limits[:, 1]), axis=1)
            view.plot(*np.where(within[:, None], points, np.nan).T, color=colour, linewidth=0.9)


def _lines(e: Element) -> list[np.ndarray]:
    """Polylines (n, 3), m, that show an element."""
    across = frame_of(e.axis) if e.across is None else e.across
    other = np.cross(e.axis, across)
    turn = np.linspace(0, 2 * np.pi, 41)[:, None]

    def ring(z: float, r: float) -> np.ndarray:
        return e.centre + z * e.axis + r * (np.cos(turn) * across + np.sin(turn) * other)

    if e.kind == "circle":
        return [ring(0, e.radius)]
    if e.kind == "cylinder":
        rims = [ring(z, e.radius) for z in (-e.high, e.high)]
        return [*rims, *(np.stack([rims[0][k], rims[1][k]]) for k in range(0, 40, 5))]
    if e.kind == "sphere":
        heights = np.linspace(max(e.low, -0.95), 0.95, 7) * e.radius
        return [ring(z, float(np.sqrt(e.radius**2 - z**2))) for z in heights]
    if e.kind == "cone":
        rims = [ring(z, e.size * z) for z in (e.low, e.high)]
        return [*rims, *(np.stack([rims[0][k], rims[1][k]]) for k in range(0, 40, 5))]
    if e.kind == "paraboloid":
        heights = np.linspace(0, 1, 7)[1:] ** 2 * e.high
        rings = [ring(z, float(np.sqrt(z / e.size))) for z in heights]
        return [*rings, *(np.stack([e.centre, *(r[k] for r in rings)]) for k in range(0, 40, 5))]
    if e.kind == "torus":
        return [ring(z, e.radius + s) for z, s in ((0, e.size), (0, -e.size), (e.size, 0), (-e.size, 0))]
    if e.kind == "polygon":
        return [e.centre + np.array([l[:2], l[2:]]) @ np.stack([across, other]) for l in e.numbers]
    return []
