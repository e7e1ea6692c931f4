# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Force over depth at the contact, as the runtime's own field gives it, with the present state on it."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go

from palpate.author.report.palette import INK, MARK, RENDERED
from palpate.author.view.viewed import ViewedTool

__all__ = ["curve_at", "curve_figure"]

POINTS = 61
"""Depths of the curve (count)."""


def curve_at(
    tool: ViewedTool, contact: np.ndarray, normal: np.ndarray, cosine: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Depths (POINTS,) m and normal forces (POINTS,) N of a straight press at `contact` (3,) m along `normal` (3,)."""
    depth = np.linspace(0.0, tool.field.depth_max, POINTS)
    q = contact + (tool.offset(cosine) - depth)[:, None] * normal
    return depth, tool.runtime.sample(q, cosine)["normal_force"]


def curve_figure(
    depth: np.ndarray, force: np.ndarray, present: tuple[float, float] | None, force_max: float
) -> go.Figure:
    """`present`: depth m and normal force N now, or None; force_max: N, end of the axis."""
    figure = go.Figure()
    figure.add_trace(go.Scatter(x=1e3 * depth, y=force, mode="lines", line={"color": RENDERED, "width": 2}))
    x, y = ([], []) if present is None else ([1e3 * present[0]], [present[1]])
    figure.add_trace(go.Scatter(x=x, y=y, mode="markers", marker={"color": MARK, "size": 11}))
    end = 1e3 * float(depth[-1])
    figure.update_layout(
        template="plotly_white",
        showlegend=False,
        margin={"l": 48, "r": 8, "t": 8, "b": 36},
        font={"size": 11, "color": INK},
        xaxis={"title": {"text": "depth, mm"}, "range": [-0.02 * end, 1.05 * end]},
        yaxis={"title": {"text": "normal force, N"}, "range": [-0.03 * force_max, 1.08 * force_max]},
    )
    return figure
