# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A flat surface that the runtime renders as a spring, U = k d^2 / 2, with transients on top: the study's renderings.

The signed distance is z, which a lattice of quadratic B-splines holds exactly (coefficient j is its value at j - 1/2);
cooking rounds it to a micrometre.  The tool is a ball so large that 25 mm are shallow.
"""

from __future__ import annotations

import numpy as np

from palpate.author.transients.stylus import Stylus
from palpate.fields.cook import cook
from palpate.fields.lattice import Lattice
from palpate.fields.response_field import (
    ContactGeometry,
    DepthCurves,
    ResponseField,
    ResponseNodes,
    ToolReference,
)
from palpate.runtime import Field, Session
from palpate.runtime.layout import Tick

__all__ = ["DEPTH_MAX", "RuntimeLoop", "flat_surface"]

DEPTH_MAX = 25e-3
"""m."""
OFFSET = 30e-3
"""m, the ball's radius."""
SPACING = 4e-3
"""m, of the lattice: 14 cells along z."""
BAND = (3e-3, 54e-3)
"""m, of the ball's centre above the surface: contact begins 24 mm below where the surface is first known."""


def flat_surface(stiffness: float, transient: bytes | None = None) -> ResponseField:
    """The field of `stiffness` N/m with the layer `transient`."""
    none = DepthCurves(DEPTH_MAX, np.zeros((0, 1, 4)))
    energy = np.array([[[0.0, 0.0, 0.5 * stiffness, 0.0]]])
    height = SPACING * (np.arange(16) - 0.5)
    phi = np.broadcast_to(height.reshape(4, 1, 1, 4), (4, 4, 4, 4))
    low = np.array([-SPACING, -SPACING, 0.0])
    index = np.arange(4, dtype=np.int32).reshape(1, 1, 4)
    one = np.zeros((1, 2))
    nodes = ResponseNodes(
        np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]), np.array([0.0, DEPTH_MAX]), one, one, np.zeros((1, 2, 3)),
        one, one, np.array([DEPTH_MAX]), np.zeros(1, bool), np.zeros(1), np.array([""]),
    )  # fmt: skip
    return ResponseField(
        tool=ToolReference("stylus", "sphere", OFFSET, {"radius": OFFSET}, "0" * 64),
        geometry=ContactGeometry(
            Lattice(low, SPACING, index, phi[..., None].copy()), np.array(BAND), 0.0, 0.0
        ),
        nodes=nodes,
        energy_curves=DepthCurves(DEPTH_MAX, energy),
        stiffness_curves=none,
        friction_curves=none,
        amplitudes=Lattice(low, SPACING, index, np.ones((4, 4, 4, 4, 1))),
        depth_max=DEPTH_MAX,
        provenance={"mesh": "flat", "stiffness": stiffness},
        layers={} if transient is None else {"transient": transient},
    )


class RuntimeLoop:
    """A controller (tap.py) that asks the C++ runtime for its force: one session for each tap, one tick a period.

    Attributes: status (taps,) of all that the ticks said; events (taps,) begun; given (taps,) J to the hand.
    """

    def __init__(self, stylus: Stylus, stiffness: float, transient: bytes | None = None) -> None:
        self._field = Field.open(cook(flat_surface(stiffness, transient)))
        self._period = 1.0 / stylus.rate
        self._sessions: list[Session] = []
        self.status = np.zeros(0, dtype=int)

    def __call__(self, depth: np.ndarray) -> np.ndarray:
        """(taps,) N into the sample for encoders that read `depth` (taps,) m."""
        if not self._sessions:
            self._sessions = [Session(self._field) for _ in depth]
            self.status = np.zeros(len(depth), dtype=int)
        force = np.empty(len(depth))
        for i, (session, d) in enumerate(zip(self._sessions, depth, strict=True)):
            out = session.tick((0.0, 0.0, OFFSET - d), self._period)
            force[i] = -out["force"][2]
            self.status[i] |= int(out["status"])
        return force

    @property
    def events(self) -> np.ndarray:
        return np.array([session.transient_account()[2] for session in self._sessions])

    @property
    def given(self) -> np.ndarray:
        return np.array([session.transient_account()[0] for session in self._sessions])

    @property
    def limited(self) -> np.ndarray:
        """(taps,) bool: where a transient was cut by the device's limits, its energy or the library's fastest."""
        return (self.status & int(Tick.TRANSIENT_LIMITED)) != 0
