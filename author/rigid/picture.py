# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An example as a picture: both bodies, the way of the held one, and force and torque over time."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate.author.rigid.body import Body, Element, frame_of
from palpate.author.rigid.examples import Run

__all__ = ["example_picture"]

REGIONS = ("point", "line", "plane")


def example_picture(run: Run, path: Path) -> None:
    """Writes a PNG."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    example = run.example
    figure = Figure(figsize=(13, 4.6), layout="constrained")
    view = figure.add_subplot(1, 3, 1, projection="3d")
    position, orientation = example.path
    reach = float(np.ptp(position, axis=0).max()) / 2 + max(e.ball[1] for e in example.held.elements)
    middle = position.mean(axis=0)
    view.set(
        xlim=middle[0] + [-reach, reach], ylim=middle[1] + [-reach, reach], zlim=middle[2] + [-reach, reach]
    )
    _draw(view, example.fixed, "0.55")
    for i in (int(0.5 * len(position)), len(position) - 1):
        _draw(
            view,
            _placed(example.held, position[i], orientation[i]),
            "tab:blue" if i == len(position) - 1 else "lightsteelblue",
        )
    view.plot(*position.T, color="tab:red", linewidth=1)
    view.set_box_aspect((1, 1, 1))
    view.set_title(example.name)
    view.set_xlabel("x, m"), view.set_ylabel("y, m"), view.set_zlabel("z, m")
    view.tick_params(labelsize=6)
    force, torque = figure.add_subplot(1, 3, 2), figure.add_subplot(1, 3, 3)
    for style, (name, out) in zip(("-", "--"), run.responses.items(), strict=False):
        t = np.arange(len(out)) * example.dt
        for k, colour in enumerate(("tab:blue", "tab:orange", "tab:green")):
            label = "xyz"[k] + (f", {name}" if name else "")
            force.plot(t, out["contact_force"][:, k], style, color=colour, label=label, linewidth=1)
            torque.plot(t, 1e3 * out["contact_torque"][:, k], style, color=colour, linewidth=1)
    force.set(xlabel="t, s", title="contact force, N")
    torque.set(xlabel="t, s", title="contact torque about the centre of mass, N mm")
    force.legend(fontsize=7)
    figure.savefig(path, dpi=90)


def _placed(body: Body, position: np.ndarray, orientation: np.ndarray) -> Body:
    from scipy.spatial.transform import Rotation

    centred = body.moved(np.eye(3), -body.centre)
    return centred.moved(Rotation.from_quat(orientation).as_matrix(), position)


def _draw(view, body: Body, colour: str) -> None:
    for e in body.elements:
        for line in _lines(e):
            view.plot(*line.T, color=colour, linewidth=0.7, axlim_clip=True)


def _lines(e: Element) -> list[np.ndarray]:
    """Polylines (n, 3), m, that show an element."""
    across = frame_of(e.axis) if e.across is None else e.across
    other = np.cross(e.axis, across)
    turn = np.linspace(0, 2 * np.pi, 41)[:, None]

    def ring(z: float, r: float) -> np.ndarray:
        return e.centre + z * e.axis + r * (np.cos(turn) * across + np.sin(turn) * other)

    if e.kind == "segment":
        return [e.centre + np.array([[-e.high], [e.high]]) * e.axis]
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
    if e.kind == "polygon" and not e.bounds and len(e.numbers) == 4:
        return [e.centre + np.array([l[:2], l[2:]]) @ np.stack([across, other]) for l in e.numbers]
    return []
