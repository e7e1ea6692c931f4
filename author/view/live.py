# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate view`: the page, and the loop between its mouse and the servo thread.

Three clocks: the servo thread ticks at 1 kHz in C++ and waits for nobody; this loop leads the tool and moves what the
page shows at FRAMES; the browser draws as fast as it can.
"""

from __future__ import annotations

import socket
import sys
import time
import webbrowser
from collections import deque
from collections.abc import Callable
from os import environ
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.scene_problems import did_you_mean
from palpate.author.view.curve import curve_at
from palpate.author.view.dimple import Dimple
from palpate.author.view.panel import Panel
from palpate.author.view.probe import CLEARANCE, Probe
from palpate.author.view.readings import MISSED_ALLOWED, Readings, missed_share
from palpate.author.view.scenery import Scenery, start_place
from palpate.author.view.viewed import ViewedTool, viewed
from palpate.runtime import Servo

__all__ = ["view"]

RATE = 1000.0
"""Hz, of the servo thread."""
FRAMES = 30.0
"""Hz, of this loop."""
DIMPLED, TOLD, DRAWN = 3, 6, 15
"""Frames between two surfaces, two texts, and two curves: they cost the browser more than the scene does."""
PRESS = 0.03
"""m of depth that a shift-drag over the whole height of the page presses."""


def view(
    path: Path,
    *,
    tool: str = "",
    host: str = "127.0.0.1",
    port: int = 8080,
    browser: bool = True,
    seconds: float | None = None,
) -> dict[str, Any]:
    """Serves the page until Ctrl-C, or for `seconds`.

    Args:
        path: asset folder or .rfield.
        tool: name of the first tool; the first by name when "".
        port: the next free one is taken where it is not; 0: any.

    Returns:
        url, tools, tool, seconds, rate (Hz), ticks, missed, missed_share, missed_allowed, met, longest_tick (s),
        real_time, contact_ticks, slip_ticks, force_max (N, as the page saw it).

    Raises:
        InputError: no such asset or tool, no address of this machine, or viser is not installed.
        FieldError, RuntimeFailure: it is damaged.
    """
    try:
        import viser
    except ImportError:
        what = "needs the package viser, which is not installed"
        raise InputError(
            InputProblem("", "palpate view", None, what, 'pip install "palpate[view]"')
        ) from None
    shown = viewed(path)
    if tool and tool not in shown.tools:
        what = f"is no tool of this asset{did_you_mean(tool, list(shown.tools))}"
        raise InputError(InputProblem(str(path), "--tool", tool, what, "one of " + "; ".join(shown.tools)))
    first = shown.tools[tool] if tool else next(iter(shown.tools.values()))
    _refuse_host(host)
    server = viser.ViserServer(host=host, port=port, label=f"palpate: {shown.organ.name}", verbose=False)
    url = f"http://{host}:{server.get_port()}"
    try:
        page = _Page(server, shown.tools, first)
        print(f"palpate: {url}  (Ctrl-C ends it)", file=sys.stderr, flush=True)
        if browser and (sys.platform != "linux" or "DISPLAY" in environ or "WAYLAND_DISPLAY" in environ):
            webbrowser.open(url)
        ended = page.run(seconds)
    finally:
        server.stop()
    return {"url": url, "asset": str(path), "tools": list(shown.tools), **ended}


def _refuse_host(host: str) -> None:
    """A server that cannot listen would wait for itself for ever."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        socket.create_server(address[:2], family=family).close()
    except OSError as error:
        what = f"is no address of this machine ({error.strerror or error})"
        raise InputError(
            InputProblem("", "--host", host, what, "127.0.0.1, or 0.0.0.0 for every one it has")
        ) from None


class _Page:
    """What the mouse asked for is noted by the server's thread and done by `run`'s."""

    def __init__(self, server: Any, tools: dict[str, ViewedTool], first: ViewedTool):
        self._server, self._tools, self._tool = server, tools, first
        self._asked: deque[Callable[[Servo], None]] = deque()
        self._moves, self._force_max = 0, 0.0
        self._grip: tuple[float, float] | None = None  # screen's y and depth where a shift-drag began
        self._scene_shown: tuple[Any, ...] = ()
        self._curve_drawn: tuple[Any, ...] = ()
        self._probe = Probe(first, start_place(first))
        self._dimple = Dimple(first)
        self._scenery = Scenery(server, first, self._dragged, self._gizmo_moved)
        self._panel = Panel(
            server,
            list(tools),
            first,
            self._scenery,
            on_tool=lambda name: self._asked.append(lambda servo: self._change(servo, name)),
            on_depth=lambda depth: self._asked.append(lambda _: self._press(depth)),
            on_tilt=lambda tilt: self._asked.append(lambda _: self._lean(tilt)),
            on_reset=lambda: self._asked.append(lambda servo: servo.reset()),
            on_map=lambda: self._asked.append(lambda _: self._paint()),
        )

    def run(self, seconds: float | None) -> dict[str, Any]:
        began = last = time.monotonic()
        slip, frame = 0, 0
        with Servo(self._tool.runtime, self._probe.position, self._probe.orientation, RATE) as servo:
            try:
                while seconds is None or time.monotonic() - began < seconds:
                    while self._asked:
                        self._asked.popleft()(servo)
                    state = servo.state
                    now = time.monotonic()
                    self._probe.step(servo, state, min(now - last, 3.0 / FRAMES))
                    last = now
                    self._force_max = max(self._force_max, float(np.linalg.norm(state["response"]["force"])))
                    slipping = int(state["slip_ticks"]) > slip
                    self._show(state, slipping, frame)
                    slip = int(state["slip_ticks"])
                    frame += 1
                    time.sleep(max(0.0, 1.0 / FRAMES - (time.monotonic() - now)))
            except KeyboardInterrupt:
                print("palpate: ended", file=sys.stderr)
            state = servo.state
        return {
            "tool": self._tool.name,
            "seconds": time.monotonic() - began,
            "rate": RATE,
            "ticks": int(state["ticks"]),
            "missed": int(state["missed"]),
            "missed_share": missed_share(state),
            "missed_allowed": MISSED_ALLOWED,
            "met": missed_share(state) < MISSED_ALLOWED,
            "longest_tick": float(state["longest"]),
            "real_time": bool(state["real_time"]),
            "contact_ticks": int(state["contact_ticks"]),
            "slip_ticks": int(state["slip_ticks"]),
            "force_max": self._force_max,
        }

    def _show(self, state: np.void, slipping: bool, frame: int) -> None:
        if not self._server.get_clients():
            return
        response = state["response"]
        now = Readings(state, slipping, self._dimple.words)
        scene = (*state["position"], *state["orientation"], *response["force"], now.contact and slipping)
        if scene != self._scene_shown:
            self._scene_shown = scene
            with self._server.atomic():
                self._scenery.show_tool(state["position"], state["orientation"], now.contact and slipping)
                self._scenery.show_force(state["position"], response["force"])
                if self._probe.free is None:
                    self._scenery.move_gizmo(state["position"])
        if frame % DIMPLED == 0 and self._dimple.there:
            moved = self._dimple.to_draw(response, now.contact)
            if moved is not None:
                self._scenery.show_dimple(moved)
        if frame % TOLD == 0:
            self._panel.show(self._tool.name, now, self._moves)
            if self._probe.free is not None:
                self._panel.show_depth(self._probe.depth)
        if frame % DRAWN == 0:
            self._show_curve(now)

    def _show_curve(self, now: Readings) -> None:
        r, tool, place = now.state["response"], self._tool, self._probe.place
        cosine = float(r["way_cosine"]) if now.contact else 1.0
        contact, normal = place.point, place.normal
        if now.contact:
            normal = r["normal"]
            contact = r["reference_point"] - (tool.offset(cosine) - r["depth"]) * normal
        depth, force = curve_at(tool, contact, normal, cosine)
        present = (float(r["depth"]), float(r["normal_force"])) if now.contact else None
        top = max(float(tool.reach.values["normal_force"].max(initial=0.0)), float(force.max()), 1e-9)
        drawn = (*np.round(force / top, 4), present and (round(1e6 * present[0]), round(present[1] / top, 4)))
        if drawn != self._curve_drawn:
            self._curve_drawn = drawn
            self._panel.show_curve(depth, force, present, top)

    def _dragged(
        self,
        phase: str,
        origin: np.ndarray,
        direction: np.ndarray,
        screen: tuple[float, float],
        modifier: str | None,
    ) -> None:
        def lead(_: Servo) -> None:
            if modifier == "shift":
                if phase in ("start", "click") or self._grip is None:
                    self._grip = (screen[1], self._probe.depth)
                self._press(self._grip[1] + PRESS * (screen[1] - self._grip[0]))
                self._panel.show_depth(self._probe.depth)
            elif (place := self._scenery.surface.hit(origin, direction)) is not None:
                self._probe.lead_to(place)
            if phase == "end":
                self._grip = None
            self._moves += 1

        self._asked.append(lead)

    def _gizmo_moved(self, position: np.ndarray) -> None:
        def hold(_: Servo) -> None:
            self._probe.free = position
            self._moves += 1

        self._asked.append(hold)

    def _press(self, depth: float) -> None:
        self._probe.press(float(np.clip(depth, -CLEARANCE, self._tool.field.depth_max)))
        self._moves += 1

    def _paint(self) -> None:
        self._panel.paint()
        self._dimple.at_rest()

    def _lean(self, tilt: float) -> None:
        if self._tool.tilt_max > 0:
            self._probe.tilt = tilt

    def _change(self, servo: Servo, name: str) -> None:
        """The other tool comes from outside, its accounts at zero."""
        self._tool = tool = self._tools[name]
        self._scenery.change(tool)
        self._dimple = Dimple(tool)
        self._panel.change(tool)
        self._probe.change(tool)
        servo.set_field(tool.runtime)
        servo.reset()
