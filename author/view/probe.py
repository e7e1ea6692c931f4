# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How the mouse leads the tool: a place on the organ and a depth, gone to as a hand would.

Near places are reached along the surface at a bounded speed, so that dragging is felt as sliding; a place further off
by lifting, a move through the air in which the runtime lets go, and pressing again.  A contact that the runtime does
not count as entered from outside (it went through the tissue, the machine slept) is lifted and entered anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from palpate.author.view.place import Place, held, on_field
from palpate.author.view.viewed import ViewedTool
from palpate.runtime import Servo, Tick

__all__ = ["CLEARANCE", "Probe"]

CLEARANCE = 3e-3
"""m; height of a lifted tool above first touch."""
SLIDING, PRESSING, LIFTING = 0.08, 0.03, 0.15
"""m/s; how fast the tool is led along the surface, into the tissue, and out of it."""
HOP, FACING = 12e-3, 0.7
"""m and cosine: a place further off, or facing another way, is reached through the air."""
LEAD = 1.5
"""Periods of the page within which a target is to be reached: a late page does not make the tool stop and go."""


@dataclass
class Probe:
    """Attributes: wanted, depth (m), tilt (rad): what the page asks for.  free: (3,) m, where the gizmo holds it."""

    tool: ViewedTool
    wanted: Place
    depth: float = -CLEARANCE
    tilt: float | None = None
    free: np.ndarray | None = None

    def __post_init__(self) -> None:
        self.place = self.wanted = on_field(self.tool, self.wanted)
        self._depth = -CLEARANCE
        self._go: Callable[[Servo, float], None] = self._follow

    @property
    def position(self) -> np.ndarray:
        """(3,) m; where the tool's reference point is led now."""
        if self.free is not None:
            return self.free
        cosine = 1.0 if self.tilt is None else float(np.cos(self.tilt))
        return self.place.point + (self.tool.offset(cosine) - self._depth) * self.place.normal

    @property
    def orientation(self) -> np.ndarray:
        """(4,) x y z w."""
        return held(self.tool.field.tool, self.place.normal, self.tilt)

    def lead_to(self, place: Place) -> None:
        """Another place on the organ; the gizmo lets go."""
        self.wanted = on_field(self.tool, place)
        if self.free is not None:
            self._let_gizmo_go()

    def press(self, depth: float) -> None:
        """Another depth, m; the gizmo lets go."""
        self.depth = depth
        if self.free is not None:
            self._let_gizmo_go()

    def change(self, tool: ViewedTool) -> None:
        """Another tool: it comes from outside at the same place."""
        self.tool, self.free, self.tilt, self.depth = tool, None, None, -CLEARANCE
        self.place = self.wanted = on_field(tool, self.wanted)
        self._depth = -CLEARANCE
        self._go = self._through_the_air

    def step(self, servo: Servo, state: np.void, dt: float) -> None:
        """Leads the tool on by `dt` s, the page's period; `state`: the servo's latest."""
        if self.free is not None:
            self._follow_gizmo()
            servo.move(self.free, self.orientation, LEAD * dt)
            return
        blocked = int(state["response"]["status"]) & (Tick.WAITING | Tick.PASSED_THROUGH | Tick.TOO_DEEP)
        apart = np.linalg.norm(self.wanted.point - self.place.point)
        facing = self.wanted.normal @ self.place.normal
        if self._go == self._follow and (blocked or apart > HOP or facing < FACING):
            self._go = self._lift
        self._go(servo, dt)

    def _follow(self, servo: Servo, dt: float) -> None:
        step = self.wanted.point - self.place.point
        length = float(np.linalg.norm(step))
        if length > SLIDING * dt:
            share = SLIDING * dt / length
            normal = self.place.normal + share * (self.wanted.normal - self.place.normal)
            between = Place(self.place.point + share * step, normal / np.linalg.norm(normal))
            self.place = on_field(self.tool, between)
        else:
            self.place = self.wanted
        self._depth += float(np.clip(self.depth - self._depth, -LIFTING * dt, PRESSING * dt))
        self._send(servo, LEAD * dt)

    def _lift(self, servo: Servo, dt: float) -> None:
        self._depth = max(self._depth - LIFTING * dt, -CLEARANCE)
        self._send(servo, LEAD * dt)
        if self._depth == -CLEARANCE and self._there(servo):
            self.place = self.wanted
            self._go = self._through_the_air

    def _through_the_air(self, servo: Servo, dt: float) -> None:
        """Where the way leads through the organ nothing is felt: the runtime has let go."""
        servo.move(self.position, self.orientation, dt, release=True)
        self._go = self._arrive

    def _arrive(self, servo: Servo, dt: float) -> None:
        if self._there(servo):
            self._send(servo, dt)
            self._go = self._follow

    def _there(self, servo: Servo) -> bool:
        return bool(np.linalg.norm(servo.state["position"] - self.position) < 1e-9)

    def _send(self, servo: Servo, duration: float) -> None:
        servo.move(self.position, self.orientation, duration)

    def _follow_gizmo(self) -> None:
        """Place and depth are what the gizmo's position says."""
        assert self.free is not None
        rho = self.tool.offset()
        normal = self.place.normal
        self.place = self.wanted = on_field(self.tool, Place(self.free - rho * normal, normal))
        self._depth = rho - float((self.free - self.place.point) @ self.place.normal)
        self.depth = self._depth

    def _let_gizmo_go(self) -> None:
        """From where the gizmo held it, in the tissue or not: lifted and entered anew."""
        self.free = None
        self._go = self._lift
