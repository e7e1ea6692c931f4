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
from palpate.author.report.node_origins import ORIGINS
from palpate.author.report.numbers import percent
from palpate.author.report.on_reach import OnReach
from palpate.author.report.palette import ERRORS, INK, MARK, NODES, ORGAN, VALUES
from palpate.author.report.viewpoint import viewpoints
from palpate.fields.response_field import ResponseField

__all__ = ["error_top", "organ_figure", "organ_maps", "varies"]

LIFT = 0.01
"""Share of the organ's size by which marks float above the surface, to be seen."""
AROUND, MARGIN = 1.6, 1.1
"""What is shown over the reach's own height, at most, and the picture's margin."""
ALWAYS = ("stiffness", "normal_force")
"""Maps that are there even where they are flat."""
LIGHT = {"ambient": 0.82, "diffuse": 0.3, "specular": 0.04, "roughness": 0.9, "fresnel": 0.02}


def organ_maps(reach: OnReach, tool: dict[str, Any]) -> dict[str, Any]:
    """What view.js needs to recolour: for each quantity name, unit, colours, ends of the scale (or none), depths
    and values as base64 float32 (depth, vertex); depths in mm.  What is the same everywhere is no map."""
    quantities = [
        {
            "key": key, "name": QUANTITIES[key][0], "unit": QUANTITIES[key][1], "colours": "Viridis", "ends": None,
            "levels": len(values), "values": _packed(values),
        }
        for key, values in reach.map.values.items()
        if values.size and (key in ALWAYS or varies(values))
    ]  # fmt: skip
    if reach.error is not None and reach.error.size:
        quantities.append(
            {
                "key": "error", "name": "Estimated error of the normal force", "unit": "%", "colours": "Magma",
                "ends": [0.0, error_top(reach, tool)], "levels": 1,
                "values": _packed(100 * reach.error),
            }
        )  # fmt: skip
    return {"depths": [round(1e3 * float(d), 4) for d in reach.map.depths], "quantities": quantities}


def varies(values: np.ndarray) -> bool:
    """Whether values (L, V) are worth a map: above 0, and more than 3 % apart within the middle 98 % of vertices.
    Where a field ends, its lattice changes even a constant by that much."""
    if not values.size or not values.any():
        return False
    low, high = np.quantile(values[-1], [0.01, 0.99])
    return bool(high - low > 0.03 * np.abs(values[-1]).max())


def error_top(reach: OnReach, tool: dict[str, Any]) -> float:
    """%, the upper end of every error scale of a tool, so that estimated and measured errors have the same colours."""
    errors = [row["force_error_max"] for row in tool["held_out"] if row["force_error_max"] is not None]
    tolerance = (tool["validation"] or {}).get("tolerance", 0.0)
    estimated = [] if reach.error is None or not reach.error.size else [float(np.quantile(reach.error, 0.99))]
    return 100.0 * max([2 * tolerance, *errors, *estimated, 1e-6])


def _packed(values: np.ndarray) -> str:
    return base64.b64encode(values.astype("<f4").tobytes()).decode()


def organ_figure(field: ResponseField, on_reach: OnReach, tool: dict[str, Any]) -> go.Figure:
    """Traces, in order: reach, rest of the organ, held-out points, nodes by kind and reason, failed presses."""
    figure, reach = go.Figure(), on_reach.map
    colour = reach.values["stiffness"][-1] if len(reach.vertices) else []
    figure.add_trace(
        _mesh(
            reach.vertices, reach.triangles, name="reach", intensity=colour, colorscale=VALUES, showscale=True,
            colorbar={"title": {"text": "N/m", "side": "top"}, "thickness": 12, "len": 0.6, "x": 1.0},
            hovertemplate="%{intensity:.4g}<extra></extra>",
        )
    )  # fmt: skip
    figure.add_trace(
        _mesh(reach.rest_vertices, reach.rest_triangles, name="organ", color=ORGAN, hoverinfo="skip")
    )
    everything = np.concatenate([reach.vertices, reach.rest_vertices])
    lift = LIFT * float(np.linalg.norm(np.ptp(everything, axis=0)))
    _held_out(figure, tool, lift, error_top(on_reach, tool))
    _nodes(figure, field, tool, lift)
    _failures(figure, tool, reach, lift)
    hidden = {"visible": False, "showspikes": False}
    figure.update_layout(
        template="plotly_white",
        height=560,
        margin={"l": 0, "r": 0, "t": 0, "b": 0},
        font={"family": "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif", "size": 12, "color": INK},
        showlegend=True,
        legend={
            "x": 0.5, "xanchor": "center", "y": 0.0, "yanchor": "bottom", "orientation": "h",
            "itemsizing": "trace", "bgcolor": "rgba(255,255,255,0.75)",
        },
        uirevision="keep",
        scene={
            "xaxis": hidden,
            "yaxis": hidden,
            "zaxis": hidden,
            "aspectmode": "data",
            "dragmode": "orbit",
            "camera": _camera(reach, everything),
            "domain": {"x": [0.0, 1.0], "y": [0.06, 1.0]},
        },
    )  # fmt: skip
    return figure


def _camera(reach: ReachMap, everything: np.ndarray) -> dict[str, Any]:
    """Looks at the reach, with enough of the organ around it to know where it is.

    In plotly's scene units the organ's bounding box has the volume 1 and its centre is at 0; the perspective shows
    a height of about 0.83 times the distance.
    """
    eye, up = viewpoints(reach)[0]
    low, high = everything.min(axis=0), everything.max(axis=0)
    per_metre = 1.0 / float(np.prod(np.maximum(high - low, 1e-9)) ** (1 / 3))
    right = np.cross(up, eye) / np.linalg.norm(np.cross(up, eye))
    frame = np.stack([right, np.cross(eye, right), eye])
    whole, middle = _seen(everything, frame)
    seen = whole
    if len(reach.vertices):
        near, near_middle = _seen(reach.vertices, frame)
        seen = min(whole, AROUND * near)
        share = 1.0 if whole <= near else (whole - seen) / (whole - near)
        middle = (1.0 - share) * middle + share * near_middle
    centre = (middle - 0.5 * (low + high)) * per_metre
    toward = float(
        np.max((everything - middle) @ eye)
    )  # m; what is nearer to the eye than the middle appears larger
    place = centre + eye * (MARGIN * seen / 0.83 + max(0.0, 0.5 * toward)) * per_metre
    vectors = {"eye": place, "center": centre, "up": up}
    return {name: dict(zip("xyz", v.tolist(), strict=True)) for name, v in vectors.items()}


def _seen(points: np.ndarray, frame: np.ndarray) -> tuple[float, np.ndarray]:
    """Height (m) of a picture twice as wide as high that shows `points`, and the point (3,) in its middle."""
    along = points @ frame.T
    low, high = along.min(axis=0), along.max(axis=0)
    width, height = (high - low)[:2]
    return float(max(height, 0.5 * width, 1e-9)), 0.5 * (low + high) @ frame


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


def _held_out(figure: go.Figure, tool: dict[str, Any], lift: float, top: float) -> None:
    judged = [row for row in tool["held_out"] if row["force_error_max"] is not None]
    if not judged:
        return
    errors = [row["force_error_max"] for row in judged]
    figure.add_trace(
        _points(
            _lifted(judged, "contact_point", "normal", lift),
            name=f"held-out press, coloured by its largest error ({len(judged)})",
            meta="held_out",
            marker={
                "size": 9, "color": [100 * e for e in errors], "colorscale": ERRORS, "cmin": 0.0,
                "cmax": top, "line": {"color": INK, "width": 2}, "showscale": True,
                "colorbar": {"title": {"text": "error at held-<br>out points, %", "side": "top"}, "thickness": 12,
                             "len": 0.6, "x": -0.02, "xanchor": "left"},
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
    symbols = {"pressed": "circle", "extrapolated": "diamond", "derived": "square"}
    fewer = {"extrapolated": "stopped early", "derived": "not pressed"}
    short = {"seed": "spread evenly", "region": "above a region", "error": "chosen by error", "unknown": ""}
    kinds = [(row["kind"], row["why"]) for row in tool["nodes"]["rows"]]
    for kind, why in sorted(
        set(kinds), key=lambda pair: (list(symbols).index(pair[0]), list(ORIGINS).index(pair[1]))
    ):
        chosen = [i for i, own in enumerate(kinds) if own == (kind, why)]
        rows = [tool["nodes"]["rows"][i] for i in chosen]
        words = ", ".join(filter(None, (short[why], fewer.get(kind))))
        figure.add_trace(
            _points(
                field.nodes.position[chosen] + lift * field.nodes.normal[chosen],
                name=f"node{': ' if words else ''}{words} ({len(chosen)})",
                meta="nodes",
                marker={
                    "size": 4 if kind == "pressed" else 7,
                    "color": NODES[why],
                    "symbol": symbols[kind],
                    "line": {"color": "white" if NODES[why] == INK else INK, "width": 1.5},
                },
                text=[
                    f"{ORIGINS[why]}<br>residual {percent(row['residual'])}, "
                    f"reached {1e3 * row['depth_reached']:.2f} mm"
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
                name=f"press that failed or stopped early ({len(places)})",
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
