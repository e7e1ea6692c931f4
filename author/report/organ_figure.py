# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ in 3-D: the reach coloured by what the field says, held-out points by their error, and the nodes.

plotly draws one mesh; the page's script (view.js) swaps its colours when another map or depth is chosen.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import plotly.graph_objects as go

from palpate.author.report.maps import QUANTITIES, ReachMap
from palpate.author.report.numbers import percent
from palpate.author.report.palette import ERRORS, INK, MARK, NODE, ORGAN, VALUES
from palpate.author.report.viewpoint import viewpoints
from palpate.fields.response_field import ResponseField

__all__ = ["organ_figure", "organ_maps"]

LIFT = 0.01
"""Share of the organ's size by which marks float above the surface, to be seen."""
LIGHT = {"ambient": 0.7, "diffuse": 0.45, "specular": 0.04, "roughness": 0.9, "fresnel": 0.02}


def organ_maps(reach: ReachMap) -> dict[str, Any]:
    """What view.js needs to recolour: names, units, depths in mm, values as base64 float32 (depth, vertex)."""
    return {
        "depths": [round(1e3 * float(d), 4) for d in reach.depths],
        "quantities": [
            {
                "key": key,
                "name": QUANTITIES[key][0],
                "unit": QUANTITIES[key][1],
                "values": base64.b64encode(values.astype("<f4").tobytes()).decode(),
            }
            for key, values in reach.values.items()
            if values.size and values.any()
        ],
    }


def organ_figure(field: ResponseField, reach: ReachMap, tool: dict[str, Any]) -> go.Figure:
    """Traces, in order: reach, rest of the organ, held-out points, nodes of each kind, failed presses."""
    figure = go.Figure()
    colour = reach.values["normal_force"][-1] if len(reach.vertices) else []
    figure.add_trace(
        _mesh(
            reach.vertices, reach.triangles, name="reach", intensity=colour, colorscale=VALUES, showscale=True,
            colorbar={"title": {"text": "N", "side": "top"}, "thickness": 12, "len": 0.6, "x": 1.0},
            hovertemplate="%{intensity:.4g}<extra></extra>",
        )
    )  # fmt: skip
    figure.add_trace(
        _mesh(reach.rest_vertices, reach.rest_triangles, name="organ", color=ORGAN, hoverinfo="skip")
    )
    everything = np.concatenate([reach.vertices, reach.rest_vertices])
    lift = LIFT * float(np.linalg.norm(np.ptp(everything, axis=0)))
    _held_out(figure, tool, lift)
    _nodes(figure, field, tool, lift)
    _failures(figure, tool, reach, lift)
    hidden = {"visible": False, "showspikes": False}
    figure.update_layout(
        template="plotly_white",
        height=560,
        margin={"l": 0, "r": 0, "t": 0, "b": 0},
        font={"family": "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif", "size": 12, "color": INK},
        showlegend=False,
        uirevision="keep",
        scene={
            "xaxis": hidden,
            "yaxis": hidden,
            "zaxis": hidden,
            "aspectmode": "data",
            "dragmode": "orbit",
            "camera": _camera(reach, everything),
        },
    )
    return figure


def _camera(reach: ReachMap, everything: np.ndarray) -> dict[str, Any]:
    """Looks at the reach, with enough of the organ around it to know where it is.

    In plotly's scene units the organ's bounding box has the volume 1 and its centre is at 0; the perspective shows
    a height of about 0.83 times the distance.
    """
    eye, up = viewpoints(reach)[0]
    low, high = everything.min(axis=0), everything.max(axis=0)
    per_metre = 1.0 / float(np.prod(np.maximum(high - low, 1e-9)) ** (1 / 3))
    whole = float(np.linalg.norm(high - low))
    seen, middle = whole, 0.5 * (low + high)
    if len(reach.vertices):
        near = float(np.linalg.norm(np.ptp(reach.vertices, axis=0)))
        seen = min(whole, max(1.7 * near, 0.6 * whole))
        middle = 0.4 * middle + 0.3 * (reach.vertices.min(axis=0) + reach.vertices.max(axis=0))
    centre = (middle - 0.5 * (low + high)) * per_metre
    place = centre + eye * seen * per_metre / 0.83
    vectors = {"eye": place, "center": centre, "up": up}
    return {name: dict(zip("xyz", v.tolist(), strict=True)) for name, v in vectors.items()}


def _mesh(vertices: np.ndarray, triangles: np.ndarray, **more: Any) -> go.Mesh3d:
    x, y, z = np.asarray(1e3 * vertices, np.float32).T
    i, j, k = np.asarray(triangles, np.int32).reshape(-1, 3).T
    return go.Mesh3d(
        x=x,
        y=y,
        z=z,
        i=i,
        j=j,
        k=k,
        flatshading=False,
        lighting=LIGHT,
        lightposition={"x": -2e4, "y": -6e4, "z": 1e5},
        **more,
    )


def _points(positions: np.ndarray, **more: Any) -> go.Scatter3d:
    x, y, z = np.round(1e3 * np.asarray(positions, float).reshape(-1, 3), 4).T
    return go.Scatter3d(x=x, y=y, z=z, mode="markers", **more)


def _held_out(figure: go.Figure, tool: dict[str, Any], lift: float) -> None:
    judged = [row for row in tool["held_out"] if row["force_error_max"] is not None]
    if not judged:
        return
    errors = [row["force_error_max"] for row in judged]
    tolerance = (tool["validation"] or {}).get("tolerance", 0.0)
    figure.add_trace(
        _points(
            _lifted(judged, "contact_point", "normal", lift),
            name="held-out points",
            meta="held_out",
            marker={
                "size": 9, "color": [100 * e for e in errors], "colorscale": ERRORS, "cmin": 0.0,
                "cmax": 100 * max([2 * tolerance, *errors]), "line": {"color": INK, "width": 2}, "showscale": True,
                "colorbar": {"title": {"text": "largest<br>error, %", "side": "top"}, "thickness": 12, "len": 0.6,
                             "x": -0.02, "xanchor": "left"},
            },
            text=[
                f"no. {row['number']}: normal {percent(row['force_error_max'])}, "
                f"lateral {percent(row['lateral_error_max'])}"
                for row in judged
            ],
            hovertemplate="%{text}<extra>held out</extra>",
        )
    )  # fmt: skip


def _nodes(figure: go.Figure, field: ResponseField, tool: dict[str, Any], lift: float) -> None:
    symbols = {"pressed": "circle", "extrapolated": "diamond-open", "derived": "square-open"}
    kinds = np.array([row["kind"] for row in tool["nodes"]["rows"]])
    for kind, symbol in symbols.items():
        chosen = np.flatnonzero(kinds == kind)
        if len(chosen):
            rows = [tool["nodes"]["rows"][i] for i in chosen]
            figure.add_trace(
                _points(
                    field.nodes.position[chosen] + lift * field.nodes.normal[chosen],
                    name=f"nodes, {kind}",
                    meta="nodes",
                    marker={
                        "size": 4 if kind == "pressed" else 6,
                        "color": NODE,
                        "symbol": symbol,
                        "line": {"color": "white" if kind == "pressed" else NODE, "width": 1},
                    },
                    text=[
                        f"residual {percent(row['residual'])}, reached {1e3 * row['depth_reached']:.2f} mm"
                        for row in rows
                    ],
                    hovertemplate="%{text}<extra>node, " + kind + "</extra>",
                )
            )


def _failures(figure: go.Figure, tool: dict[str, Any], reach: ReachMap, lift: float) -> None:
    failed = [row for row in tool["held_out"] if not row["converged"]]
    places = [(row["contact_point"], f"held-out no. {row['number']}: {row['reason']}") for row in failed]
    places += [(one["contact_point"], one["reason"]) for one in tool["failures"] if one.get("contact_point")]
    if places:
        figure.add_trace(
            _points(
                np.array([_above(np.array(place), reach, lift) for place, _ in places]),
                name="presses that failed or stopped early",
                meta="failures",
                marker={"size": 7, "color": MARK, "symbol": "diamond"},
                text=[reason for _, reason in places],
                hovertemplate="%{text}<extra>failed or stopped early</extra>",
            )
        )


def _lifted(rows: list[dict[str, Any]], point: str, normal: str, lift: float) -> np.ndarray:
    return np.array([np.array(row[point]) + lift * np.array(row[normal]) for row in rows]).reshape(-1, 3)


def _above(place: np.ndarray, reach: ReachMap, lift: float) -> np.ndarray:
    """`place` (3,) m, lifted along the nearest vertex's normal."""
    if not len(reach.vertices):
        return place
    nearest = int(np.argmin(np.linalg.norm(reach.vertices - place, axis=1)))
    return place + 1.5 * lift * reach.normals[nearest]
