# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The page's controls: which tool, which map, how deep; and what is felt, as numbers and as a curve."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from palpate.author.report.palette import VALUES
from palpate.author.view.curve import curve_figure
from palpate.author.view.probe import CLEARANCE
from palpate.author.view.readings import Readings, legend, table
from palpate.author.view.scenery import Scenery
from palpate.author.view.viewed import HELD_OUT_ERROR, MAPS, ViewedTool

__all__ = ["Panel"]

HELP = (
    "Drag over the organ: the probe follows. Shift and drag up or down: it presses. "
    "Drag beside the organ: the view turns; the wheel zooms."
)


class Panel:
    """Callbacks run on the server's own thread and only note what is asked for.

    Args: on_tool(name), on_depth(m), on_tilt(rad), on_reset(), on_map(): another map or other marks are wanted.
    """

    def __init__(
        self,
        server: Any,
        names: list[str],
        tool: ViewedTool,
        scenery: Scenery,
        *,
        on_tool: Callable[[str], None],
        on_depth: Callable[[float], None],
        on_tilt: Callable[[float], None],
        on_reset: Callable[[], None],
        on_map: Callable[[], None],
    ):
        self._gui, self._scenery, self._tool = server.gui, scenery, tool
        gui = self._gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
        gui.set_panel_label("palpate view")
        gui.main_panel.dock_right()
        gui.add_markdown(HELP)
        self._choice = gui.add_dropdown("Tool", names, initial_value=tool.name)
        self._depth = gui.add_slider("Depth, mm", *self._depths(), 0.01, -1e3 * CLEARANCE)
        self._tilt = gui.add_slider("Tilt, deg", 0.0, 90.0, 0.5, 0.0, visible=False)
        self._table = gui.add_html("")
        self._plot = gui.add_plotly(
            curve_figure(np.zeros(2), np.zeros(2), None, 1.0), aspect=2.0, config={"displayModeBar": False}
        )
        with gui.add_folder("Maps"):
            self._map = gui.add_dropdown("Colour", [name for name, _ in MAPS.values()])
            self._level = gui.add_slider("At level", 1, 5, 1, 5)
            self._legend = gui.add_html("")
            self._nodes = gui.add_checkbox("Nodes", True)
            self._held_out = gui.add_checkbox("Held-out presses, coloured by error", True)
        self._reset = gui.add_button("Energy accounts to zero")

        @self._choice.on_update
        async def _(event: Any) -> None:
            on_tool(str(event.target.value))

        @self._depth.on_update
        async def _(event: Any) -> None:
            if event.client is not None:  # moved by a person
                on_depth(1e-3 * event.target.value)

        @self._tilt.on_update
        async def _(event: Any) -> None:
            on_tilt(float(np.radians(event.target.value)))

        @self._reset.on_click
        async def _(event: Any) -> None:
            on_reset()

        async def chosen(_: Any) -> None:
            on_map()

        for handle in (self._map, self._level, self._nodes, self._held_out):
            handle.on_update(chosen)
        self.change(tool)

    def change(self, tool: ViewedTool) -> None:
        """Another tool's depths, tilts and maps."""
        self._tool = tool
        self._depth.min, self._depth.max = self._depths()
        self._depth.value = -1e3 * CLEARANCE
        self._tilt.visible = tool.tilt_max > 0
        self._tilt.value, self._tilt.max = 0.0, max(float(np.degrees(tool.tilt_max)), 0.5)
        self.paint()

    def paint(self) -> None:
        """The chosen map on the organ, which is drawn at rest."""
        key = next(key for key, (name, _) in MAPS.items() if name == self._map.value)
        level = int(self._level.value) - 1
        values = self._tool.map_values(key, level)
        low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
        self._scenery.paint(values, low, high)
        name, unit = MAPS[key]
        depth: float | None = float(self._tool.reach.depths[level])
        if key == HELD_OUT_ERROR:
            depth = None
            name += "" if self._tool.held_out else ": none was pressed"
        self._legend.content = legend(name, unit, low, high, VALUES, depth)
        self._scenery.show_marks(bool(self._nodes.value), bool(self._held_out.value))

    def show_depth(self, depth: float) -> None:
        """The slider where the mouse has pressed to, m."""
        shown = float(np.clip(1e3 * depth, self._depth.min, self._depth.max))
        if abs(shown - self._depth.value) > 0.005:
            self._depth.value = shown

    def show(self, name: str, now: Readings, moves: int) -> None:
        self._table.content = table(name, now, moves)

    def show_curve(
        self, depth: np.ndarray, force: np.ndarray, present: tuple[float, float] | None, force_max: float
    ) -> None:
        self._plot.figure = curve_figure(depth, force, present, force_max)

    def _depths(self) -> tuple[float, float]:
        return -1e3 * CLEARANCE, 1e3 * self._tool.field.depth_max
