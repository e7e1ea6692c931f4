# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Renders meshes and balls off screen, in a process of its own: `python -m palpate.author.report.render FOLDER`.

Parallel projection, so that scale is the same all over a picture.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

__all__ = ["Balls", "Image", "Mesh", "RenderFailure", "View", "render"]

WINDOW = (1400, 1050)
"""Pixels."""
PATIENCE = 180.0
"""s until a hanging graphics driver is given up."""
MARGIN = 1.12
"""Width of the view over the width of what it shows."""


class RenderFailure(RuntimeError):
    """No picture can be made here; the message is a sentence that says why."""


@dataclass(frozen=True)
class Mesh:
    """vertices (V, 3) m, triangles (F, 3), a colour or the name of a colour scale for values (V,)."""

    vertices: np.ndarray
    triangles: np.ndarray
    colour: str
    values: np.ndarray | None = None


@dataclass(frozen=True)
class Balls:
    """Balls at places (n, 3) m; a colour, or the name of a colour scale for values (n,) from 0 to `top`."""

    places: np.ndarray
    radius: float
    colour: str
    values: np.ndarray | None = None
    top: float = 1.0


@dataclass(frozen=True)
class View:
    """What is seen from direction `eye` (3,), `up` (3,) upwards, fitted to the points `shown` (n, 3) m."""

    eye: np.ndarray
    up: np.ndarray
    shown: np.ndarray
    meshes: list[Mesh]
    balls: list[Balls]


@dataclass(frozen=True)
class Image:
    """pixels (h, w, 3) uint8; of the last group of balls: places (n, 2) in pixels, and which are seen (n,)."""

    pixels: np.ndarray
    places: np.ndarray
    seen: np.ndarray


def render(views: list[View]) -> list[Image]:
    """One image per view.  Raises RenderFailure where this machine cannot draw."""
    with tempfile.TemporaryDirectory() as folder:
        job = Path(folder)
        (job / "views.pickle").write_bytes(pickle.dumps(views))
        command = [sys.executable, "-m", "palpate.author.report.render", folder]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired as late:
            raise RenderFailure(f"OpenGL did not answer within {PATIENCE:.0f} s.") from late
        result = job / "images.pickle"
        if done.returncode != 0 or not result.is_file():
            words = [line.strip() for line in done.stderr.splitlines() if line.strip()]
            why = f" ({words[-1][:160]})" if words else ""
            raise RenderFailure(f"off-screen OpenGL did not start or gave up{why}.")
        return pickle.loads(result.read_bytes())


def _draw(view: View) -> Image:
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(WINDOW), lighting="none")
    plotter.set_background("white")
    eye, (right, top) = view.eye, _axes(view)
    for direction, strength in (
        (eye + 0.5 * top - 0.4 * right, 0.62),
        (eye - 0.6 * right, 0.28),
        (top, 0.18),
    ):
        plotter.add_light(
            pyvista.Light(position=tuple(direction), light_type="scene light", intensity=strength)
        )
    for mesh in view.meshes:
        if not len(mesh.triangles):
            continue
        surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.triangles)
        look = {"smooth_shading": True, "split_sharp_edges": True, "feature_angle": 50.0,
                "ambient": 0.3, "diffuse": 0.8, "specular": 0.04, "show_scalar_bar": False}  # fmt: skip
        if mesh.values is None:
            plotter.add_mesh(surface, color=mesh.colour, **look)
        else:
            surface["values"] = mesh.values
            plotter.add_mesh(surface, scalars="values", cmap=mesh.colour, **look)
    for group in view.balls:
        if len(group.places):
            cloud = pyvista.PolyData(np.asarray(group.places, float))
            colour = {"color": group.colour}
            if group.values is not None:
                cloud["values"] = group.values
                colour = {"scalars": "values", "cmap": group.colour, "clim": (0.0, group.top)}
            glyphs = cloud.glyph(geom=pyvista.Sphere(radius=group.radius, theta_resolution=24, phi_resolution=24),
                                 scale=False, orient=False)  # fmt: skip
            plotter.add_mesh(glyphs, ambient=0.45, diffuse=0.6, specular=0.1, show_scalar_bar=False, **colour)
    across, upwards = view.shown @ right, view.shown @ top
    middle = 0.5 * (across.min() + across.max()) * right + 0.5 * (upwards.min() + upwards.max()) * top
    middle = middle + np.mean(view.shown @ eye) * eye
    extent = max(np.ptp(upwards), np.ptp(across) * WINDOW[1] / WINDOW[0], 1e-9)
    plotter.camera.focal_point = middle
    plotter.camera.position = middle + 10.0 * extent * eye
    plotter.camera.up = top
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.5 * MARGIN * extent
    plotter.enable_anti_aliasing("ssaa")
    plotter.reset_camera_clipping_range()
    pixels = plotter.screenshot(return_img=True)
    places, seen = np.zeros((0, 2)), np.zeros(0, bool)
    if view.balls:
        places, seen = _seen(view, view.balls[-1], middle, WINDOW[1] / (MARGIN * extent))
    plotter.close()
    return Image(np.asarray(pixels), places, seen)


def _seen(view: View, balls: Balls, middle: np.ndarray, per_metre: float) -> tuple[np.ndarray, np.ndarray]:
    """Where balls are on the picture (pixels), and whether no mesh hides their front from the eye.

    A triangle hides a point p when the ray p + s eye meets it at s > 0: three edge functions of one sign in the
    picture's plane, and the triangle's plane in front of p.
    """
    right, top = _axes(view)
    points = np.asarray(balls.places, float).reshape(-1, 3)
    frame = np.stack([right, top, view.eye], axis=1)
    flat = (points - middle) @ frame
    places = np.array(WINDOW) / 2 + flat[:, :2] * (per_metre, -per_metre)
    seen = np.all((places >= 0) & (places < WINDOW), axis=1)
    corners = [
        (mesh.vertices[mesh.triangles] - middle) @ frame for mesh in view.meshes if len(mesh.triangles)
    ]
    a, b, c = np.moveaxis(np.concatenate(corners), 1, 0)
    normal = np.cross(b - a, c - a)
    for k, p in enumerate(flat + [0.0, 0.0, balls.radius]):
        edge = [_turn(s, e, p) for s, e in ((a, b), (b, c), (c, a))]
        within = np.all(np.array(edge) >= 0, axis=0) | np.all(np.array(edge) <= 0, axis=0)
        within &= np.abs(normal[:, 2]) > 0
        n, start = normal[within], a[within]
        height = start[:, 2] - np.sum(n[:, :2] * (p[:2] - start[:, :2]), axis=1) / n[:, 2]
        seen[k] &= not np.any(height > p[2])
    return places, seen


def _turn(start: np.ndarray, end: np.ndarray, p: np.ndarray) -> np.ndarray:
    d = end - start
    return d[:, 0] * (p[1] - start[:, 1]) - d[:, 1] * (p[0] - start[:, 0])


def _axes(view: View) -> tuple[np.ndarray, np.ndarray]:
    """Right and top of the picture, unit vectors (3,)."""
    right = np.cross(view.up, view.eye)
    right /= np.linalg.norm(right)
    return right, np.cross(view.eye, right)


def main(folder: str) -> None:
    views = pickle.loads((Path(folder) / "views.pickle").read_bytes())
    (Path(folder) / "images.pickle").write_bytes(pickle.dumps([_draw(view) for view in views]))


if __name__ == "__main__":
    # Under -m this file is __main__ as well; unpickled views carry the module's own classes.
    from palpate.author.report import render as module

    module.main(sys.argv[1])
