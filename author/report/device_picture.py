# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A device's map as a picture: shades of green where it renders the field without a hum, of red where it does not.

Red is darker than green everywhere, so that the border is seen without telling them apart.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap

from palpate.author.haptic_device import HapticDevice
from palpate.author.report.composition import Scale, compose
from palpate.author.report.device_map import DeviceMap
from palpate.author.report.maps import ReachMap
from palpate.author.report.numbers import percent
from palpate.author.report.palette import HUMS, ORGAN, STEADY
from palpate.author.report.projection import Mesh, View
from palpate.author.report.render import render
from palpate.author.report.viewpoint import viewpoints

__all__ = ["compose_device", "device_caption", "device_picture", "device_views"]

SHADES = 1024
"""Colours of the scale; the border between green and red is sharp to one of them."""


def device_caption(tool: str, device: HapticDevice) -> str:
    return f"{tool} on {device.name or 'the device'} at {device.rate:g} Hz"


def device_picture(path: Path, tool: str, reach: ReachMap, made: DeviceMap, device: HapticDevice) -> None:
    """Draws `made` over `reach` into the PNG file `path`.

    Raises:
        RenderFailure: this machine cannot draw.
    """
    views = device_views(reach, made)
    compose_device(path, tool, reach, made, device, views, render(views))


def device_views(reach: ReachMap, made: DeviceMap) -> list[View]:
    """One from each viewpoint."""
    high = _high(made)
    everything = np.concatenate([reach.vertices, reach.rest_vertices])
    shown = reach.vertices if len(reach.vertices) else everything
    meshes = [
        Mesh(reach.rest_vertices, reach.rest_triangles, ORGAN),
        Mesh(reach.vertices, reach.triangles, _colours(made.allowed / high), made.sigma, (0.0, high)),
    ]
    return [View(eye, up, shown, 1.45, meshes) for eye, up in viewpoints(reach)]


def compose_device(
    path: Path,
    tool: str,
    reach: ReachMap,
    made: DeviceMap,
    device: HapticDevice,
    views: list[View],
    images: list[np.ndarray],
) -> None:
    """Writes the picture of rendered `images` of device_views."""
    high = _high(made)
    held = "it is held" if np.isinf(made.allowed) else f"the device holds it (up to {_limit(made)} N/m)"
    mark = (made.allowed, f"hums\nabove\n{_limit(made)}") if made.allowed < high else None
    deepest = f"{1e3 * float(reach.depths[-1]):.3g} mm"
    share = "none" if made.share is None else percent(made.share)
    compose(
        path,
        f"{device_caption(tool, device)}: {share} of the reach without a hum",
        views,
        images,
        [],
        Scale(_colours(made.allowed / high), 0.0, high, "N/m", mark),
        f"Largest stiffness up to {deepest} deep, friction spring included. Green: {held}. Red: it hums.",
    )


def _high(made: DeviceMap) -> float:
    return float(made.sigma.max(initial=0.0)) or 1.0


def _limit(made: DeviceMap) -> str:
    return f"{float(f'{made.allowed:.3g}'):.10g}"  # three digits, without an exponent


def _colours(border: float) -> ListedColormap:
    """Green up to the share `border` of the scale, red above."""
    at = (np.arange(SHADES) + 0.5) / SHADES
    green = LinearSegmentedColormap.from_list("steady", STEADY)(
        np.clip(at / np.clip(border, 1e-9, 1.0), 0, 1)
    )
    red = LinearSegmentedColormap.from_list("hums", HUMS)(
        np.clip((at - border) / max(1.0 - border, 1e-9), 0, 1)
    )
    return ListedColormap(np.where((at <= border)[:, None], green, red))
