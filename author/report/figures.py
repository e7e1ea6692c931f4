# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The page's interactive figures, as plotly's own JSON; the 3-D organ is in organ_figure.py."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from palpate.author.report.gather import Sources
from palpate.author.report.held_out_rows import pooled
from palpate.author.report.numbers import asked, percent
from palpate.author.report.on_reach import OnReach
from palpate.author.report.organ_figure import organ_figure, organ_maps
from palpate.author.report.palette import ERROR_KINDS, FEM, INK, MARK, QUIET, RENDERED

__all__ = ["error_figure", "figures", "worst_figure"]

COLUMNS = 5
"""Of the worst points' curves (count)."""


def figures(sources: Sources, reaches: list[OnReach], report: dict[str, Any]) -> list[dict[str, Any]]:
    """One dict per tool: name of the figure -> plotly JSON text or None where there is nothing to draw."""
    out = []
    for field, validation, reach, tool in zip(
        sources.fields, sources.validations, reaches, report["tools"], strict=True
    ):
        out.append(
            {
                "organ": organ_figure(field, reach, tool).to_json(),
                "maps": organ_maps(reach, tool),
                "errors": _json(error_figure(validation, report["just_noticeable_difference"])),
                "worst": _json(worst_figure(tool, report["just_noticeable_difference"])),
                "residuals": _json(residual_figure(tool)),
            }
        )
    return out


def _json(figure: go.Figure | None) -> str | None:
    return None if figure is None else figure.to_json()


def error_figure(validation: dict[str, Any] | None, noticeable: float) -> go.Figure | None:
    """Histogram of normal-force errors; cumulative curves of all three errors."""
    errors = {key: 100 * np.sort(pooled(validation, key)) for key in ERROR_KINDS}
    if validation is None or not len(errors["force_error"]):
        return None
    tolerance = 100 * validation["tolerance"]
    figure = make_subplots(
        cols=2,
        horizontal_spacing=0.09,
        column_titles=["States by normal-force error", "Share of states with at most this error"],
    )
    force = errors["force_error"]
    top = max(force[-1], 1.15 * tolerance, 108 * noticeable)
    edges = np.linspace(0.0, top, 33)
    count, _ = np.histogram(force, edges)
    figure.add_bar(
        x=0.5 * (edges[1:] + edges[:-1]), y=count, width=np.diff(edges), marker={"color": RENDERED, "line_width": 0},
        name="states", showlegend=False, hovertemplate="%{x:.2f} %: %{y} states<extra></extra>",
    )  # fmt: skip
    for key, (name, colour, dash) in ERROR_KINDS.items():
        values = errors[key]
        if len(values):
            share = 100 * np.arange(1, len(values) + 1) / len(values)
            figure.add_scatter(
                x=np.r_[0, values], y=np.r_[0, share], mode="lines", name=f"{name} ({len(values)})", row=1, col=2,
                line={"color": colour, "width": 2, "dash": dash, "shape": "hv"},
                hovertemplate="%{y:.0f} % of states within %{x:.2f} %<extra>" + name + "</extra>",
            )  # fmt: skip
    for column in (1, 2):
        high = (1.0, 0.9) if column == 1 else (0.62, 0.5)
        marks = [(tolerance, f"asked {asked(validation['tolerance'])}", "dash", high[0])]
        if abs(noticeable - validation["tolerance"]) > 1e-9:
            marks.append((100 * noticeable, f"noticeable {asked(noticeable)}", "dot", high[1]))
        for x, text, dash, height in marks:
            figure.add_vline(x=x, line={"color": MARK, "width": 1.3, "dash": dash}, row=1, col=column)
            side, shift = ("left", 4) if x < 0.7 * top else ("right", -4)
            axes = ("x", "y domain") if column == 1 else ("x2", "y2 domain")
            figure.add_annotation(
                x=x, y=height, xref=axes[0], yref=axes[1], text=text, showarrow=False, xanchor=side, yanchor="top",
                xshift=shift, font={"size": 11, "color": MARK}, bgcolor="rgba(255,255,255,0.8)",
            )  # fmt: skip
    figure.add_hline(y=95, line={"color": QUIET, "width": 1}, row=1, col=2)
    figure.add_annotation(
        x=1.0, y=95, xref="x2 domain", yref="y2", text="95 % of states", showarrow=False, xanchor="right",
        yanchor="top", font={"size": 11, "color": INK},
    )  # fmt: skip
    figure.update_xaxes(title_text="error, % of the FEM normal force at that depth", rangemode="tozero")
    figure.update_xaxes(range=[0, top * 1.02], row=1, col=1)
    everything = max([top, *(values[-1] for values in errors.values() if len(values))])
    figure.update_xaxes(range=[0, everything * 1.02], row=1, col=2)
    figure.update_yaxes(title_text="states", row=1, col=1)
    figure.update_yaxes(title_text="%", range=[0, 102], row=1, col=2)
    figure.update_layout(
        legend={"orientation": "h", "x": 1.0, "xanchor": "right", "y": -0.2, "yanchor": "top"}
    )
    return _dressed(figure, 390)


def worst_figure(tool: dict[str, Any], noticeable: float) -> go.Figure | None:
    """Normal and lateral curves of the worst held-out presses, FEM and rendered; around FEM what nobody notices."""
    worst = [tool["held_out"][index] for index in tool["worst"]]
    if not worst:
        return None
    columns = min(COLUMNS, len(worst))
    bands = -(-len(worst) // columns)  # each a row of normal forces above one of lateral forces
    titles = [f"no. {row['number']}: {percent(row['force_error_max'])}" for row in worst]
    titles += [""] * (bands * columns - len(titles))
    titles = [
        text for k in range(bands) for text in (*titles[k * columns : (k + 1) * columns], *[""] * columns)
    ]
    figure = make_subplots(
        rows=2 * bands, cols=columns, vertical_spacing=0.3 / (2 * bands), horizontal_spacing=0.05,
        row_heights=[0.6, 0.4] * bands, subplot_titles=titles,
    )  # fmt: skip
    for index, row in enumerate(worst):
        band, column = divmod(index, columns)
        depth = 1e3 * np.array(row["depth"])
        fem = np.array(row["curves"]["fem"]["normal"])
        figure.add_scatter(
            x=np.r_[depth, depth[::-1]], y=np.r_[(1 - noticeable) * fem, (1 + noticeable) * fem[::-1]], fill="toself",
            mode="none", fillcolor="rgba(176,74,0,0.16)", hoverinfo="skip", row=2 * band + 1, col=column + 1,
            name=f"within {asked(noticeable)} of finite elements", showlegend=index == 0,
        )  # fmt: skip
        for line, part, dash in ((1, "normal", "solid"), (2, "along", "solid"), (2, "across", "dot")):
            first = index == 0
            scale, unit = (1.0, "N") if part == "normal" else (1e3, "mN")
            at = {"row": 2 * band + line, "col": column + 1}
            figure.add_scatter(
                x=depth, y=scale * np.array(row["curves"]["rendered"][part]), mode="lines", **at,
                line={"color": RENDERED, "width": 2, "dash": dash}, showlegend=first and part != "along",
                name="rendered" if part == "normal" else "rendered, across the push",
                hovertemplate="%{x:.2f} mm: %{y:.4g} " + unit + "<extra>rendered, " + part + "</extra>",
            )  # fmt: skip
            figure.add_scatter(
                x=depth, y=scale * np.array(row["curves"]["fem"][part]), mode="markers", **at,
                marker={"color": FEM, "size": 5, "symbol": "circle-open" if part != "across" else "x-thin",
                        "line": {"width": 1.5, "color": FEM}},
                name="finite elements" if part == "normal" else "finite elements, across the push",
                showlegend=first and part != "along",
                hovertemplate="%{x:.2f} mm: %{y:.4g} " + unit + "<extra>finite elements, " + part + "</extra>",
            )  # fmt: skip
    figure.update_xaxes(range=[0, 1.04e3 * tool["field"]["depth_max"]])
    for band in range(bands):
        figure.update_xaxes(title_text="depth, mm", row=2 * band + 2)
        figure.update_yaxes(rangemode="tozero", row=2 * band + 1)
        figure.update_yaxes(title_text="normal, N", row=2 * band + 1, col=1)
        figure.update_yaxes(title_text="lateral, mN", row=2 * band + 2, col=1)
    figure.update_layout(legend={"orientation": "h", "y": -0.1 / bands, "x": 0, "yanchor": "top"})
    return _dressed(figure, 80 + 430 * bands)


def residual_figure(tool: dict[str, Any]) -> go.Figure | None:
    """Fit residual of every node, largest first."""
    rows = sorted(
        (r for r in tool["nodes"]["rows"] if r["residual"] is not None), key=lambda r: -r["residual"]
    )
    if not rows:
        return None
    figure = go.Figure()
    symbols = {"pressed": "circle", "extrapolated": "diamond-open", "derived": "square-open"}
    for kind, symbol in symbols.items():
        chosen = [(rank, row) for rank, row in enumerate(rows, 1) if row["kind"] == kind]
        if chosen:
            figure.add_scatter(
                x=[rank for rank, _ in chosen], y=[100 * row["residual"] for _, row in chosen], mode="markers",
                name=kind, marker={"symbol": symbol, "size": 7, "color": RENDERED if kind == "pressed" else MARK},
                text=[", ".join(f"{1e3 * x:.1f}" for x in row["position"]) for _, row in chosen],
                hovertemplate="%{y:.2g} % at (%{text}) mm<extra>" + kind + "</extra>",
            )  # fmt: skip
    figure.update_xaxes(title_text="nodes, by residual", rangemode="tozero")
    figure.update_yaxes(title_text="residual, % of deepest force", rangemode="tozero")
    figure.update_layout(showlegend=len(figure.data) > 1)
    return _dressed(figure, 280)


def _dressed(figure: go.Figure, height: int) -> go.Figure:
    figure.update_layout(
        template="plotly_white",
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        height=height,
        margin={"l": 56, "r": 16, "t": 36, "b": 48},
        font={"family": "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif", "size": 12, "color": INK},
        hoverlabel={"font": {"size": 12}},
        bargap=0,
    )
    figure.update_annotations(font_size=12)
    figure.update_xaxes(
        zeroline=False, showline=True, linecolor="#c9c9c4", gridcolor="#eeeeea", title_standoff=8
    )
    figure.update_yaxes(
        zeroline=False, showline=True, linecolor="#c9c9c4", gridcolor="#eeeeea", title_standoff=8
    )
    return figure
