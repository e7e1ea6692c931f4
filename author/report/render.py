# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Renders meshes off screen, in a process of its own: `python -m palpate.author.report.render FOLDER`.

Where OpenGL is missing VTK may end the process instead of raising; here that ends a child, not the report.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from palpate.author.report.projection import WINDOW, View

__all__ = ["RenderFailure", "render"]

PATIENCE = 180.0
"""s until a hanging graphics driver is given up."""


class RenderFailure(RuntimeError):
    """No picture can be made here; the message is a sentence that says why."""


def render(views: list[View]) -> list[np.ndarray]:
    """One (H, W, 3) uint8 image per view.  Raises RenderFailure where this machine cannot draw."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "views.pickle").write_bytes(pickle.dumps(views))
        command = [sys.executable, "-m", "palpate.author.report.render", folder]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired as late:
            raise RenderFailure(f"off-screen OpenGL did not answer within {PATIENCE:.0f} s.") from late
        result = Path(folder) / "images.npy"
        if done.returncode != 0 or not result.is_file():
            words = [line.strip() for line in done.stderr.splitlines() if line.strip()]
            why = f" ({words[-1][:160]})" if words else ""
            raise RenderFailure(f"off-screen OpenGL did not start, or gave up{why}.")
        return list(np.load(result))


def main(folder: str) -> None:
    views: list[View] = pickle.loads((Path(folder) / "views.pickle").read_bytes())
    np.save(Path(folder) / "images.npy", np.stack([_draw(view) for view in views]))


def _draw(view: View) -> np.ndarray:
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(WINDOW), lighting="none")
    plotter.background_color = pyvista.Color("white")
    eye, right, top = view.eye, view.right, view.top
    for direction, strength in (
        (eye + 0.5 * top - 0.4 * right, 0.68),
        (eye - 0.4 * top + 0.5 * right, 0.4),
        (top, 0.15),
    ):
        light = pyvista.Light(position=tuple(direction), light_type="scene light", intensity=strength)
        plotter.add_light(light)
    look = {"smooth_shading": True, "split_sharp_edges": True, "feature_angle": 50.0,
            "specular": 0.0, "show_scalar_bar": False}  # fmt: skip
    for mesh in view.meshes:
        if not len(mesh.triangles):
            continue
        surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.triangles)
        if mesh.values is None:
            plotter.add_mesh(surface, color=mesh.colour, ambient=0.36, diffuse=0.82, **look)
        else:
            surface["values"] = mesh.values
            plotter.add_mesh(
                surface, scalars="values", cmap=mesh.colour, clim=mesh.limits, ambient=0.86, diffuse=0.18, **look
            )  # fmt: skip
    plotter.camera.focal_point = view.middle
    plotter.camera.position = view.middle + 10.0 * view.height * eye
    plotter.camera.up = top
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.5 * view.height
    plotter.enable_anti_aliasing("ssaa")
    plotter.reset_camera_clipping_range()
    pixels = np.asarray(plotter.screenshot(return_img=True))[..., :3]
    plotter.close()
    return pixels


if __name__ == "__main__":
    main(sys.argv[1])
