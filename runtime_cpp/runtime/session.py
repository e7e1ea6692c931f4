# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One tool in a hand."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from palpate.runtime.field import Field
from palpate.runtime.layout import CONFIG, RESPONSE, STATE, Adhesion, Input, Response
from palpate.runtime.library import RuntimeFailure, check, library
from palpate.runtime.organ import Organ
from palpate.runtime.texture import TextureLimits

__all__ = ["Config", "Session", "as_struct"]


@dataclass(frozen=True)
class Config:
    """palpate_config.

    Attributes:
        reference_point: (3,) m, in the grip's frame.
        friction_coefficient: >= 0 replaces the field's; None: the field's own.
        speed_max: m/s; a faster move is a jump; 0: no limit.
        dt_max: s; a longer tick is stale.
        adhesion: how a stretched contact slips.
        adhesion_start: 0 to 0.999; of SMOOTH and PROPORTIONAL, as a fraction of the limit.
        force_max: N; the device's limit, to which the surface yields; 0: none.
        passivity_control: the surface yields by what holding the force has given and nothing has dissipated.
        response: what is felt along the surface.
        tool_axis: (3,), unit, in the grip's frame: out of the tissue; read by fields with several ways of touching.
    """

    reference_point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    friction_coefficient: float | None = None
    speed_max: float = 10.0
    dt_max: float = 0.1
    adhesion: Adhesion = Adhesion.STICK_SLIP
    adhesion_start: float = 0.5
    force_max: float = 0.0
    passivity_control: bool = False
    response: Response = Response.POTENTIAL
    tool_axis: tuple[float, float, float] = (0.0, 0.0, 1.0)


def as_struct(config: Config) -> np.ndarray:
    """`config` as palpate_config, ()."""
    raw = np.zeros((), dtype=CONFIG)
    raw["size"] = CONFIG.itemsize
    raw["reference_point"] = config.reference_point
    raw["friction_coefficient"] = -1.0 if config.friction_coefficient is None else config.friction_coefficient
    for name in (
        "speed_max", "dt_max", "adhesion", "adhesion_start", "force_max", "passivity_control", "response",
        "tool_axis",
    ):  # fmt: skip
        raw[name] = getattr(config, name)
    _refuse_not_finite(raw)
    return raw


class Session:
    """A session of the runtime; use it from one thread at a time.

    Raises (on construction):
        RuntimeFailure: a number in the config is out of range.
    """

    def __init__(self, field: Field, config: Config | None = None):
        config = config or Config()
        self.field = field
        self._fields = [field]  # all stay open: a tick may still move in an earlier one
        self._organ: Organ | None = None
        self._memory = np.zeros(-(-library().palpate_session_size() // 8), dtype=np.float64)
        raw = as_struct(config)
        handle = ctypes.c_void_p()
        memory, init = self._memory, library().palpate_session_init
        status = init(memory.ctypes.data, memory.nbytes, field.handle, raw.ctypes.data, ctypes.byref(handle))
        check(status)
        self._handle = handle.value

    def reset(self) -> None:
        """Back to the state after construction, accounts at zero."""
        check(library().palpate_session_reset(self._handle))

    def transient_account(self) -> tuple[float, float, int]:
        """Of the effect transient since the start or `reset`: J given to the hand, J taken from it, events."""
        account = np.zeros(3)
        check(library().palpate_session_transient(self._handle, account.ctypes.data))
        return float(account[0]), float(account[1]), int(account[2])

    def set_texture_limits(self, limits: TextureLimits | None) -> None:
        """Of the device at hand, for the effect texture; None: those in the field.  Raises RuntimeFailure."""
        raw = None if limits is None else limits.as_struct()
        check(
            library().palpate_session_set_texture_limits(
                self._handle, None if raw is None else raw.ctypes.data
            )
        )

    def texture_gain(self) -> np.ndarray:
        """(16,) how much of each wave of the effect texture is rendered, 0 to 1; 1 where there is no wave."""
        gain = np.zeros(16)
        check(library().palpate_session_texture(self._handle, gain.ctypes.data))
        return gain

    def set_field(self, field: Field) -> None:
        """From the next tick on, another field of the same organ; while touching, stored energy does not rise."""
        check(library().palpate_session_set_field(self._handle, field.handle))
        self.field = field
        self._fields.append(field)

    def set_organ(self, organ: Organ | None) -> None:
        """From the next tick on the organ is where `organ` is; None: it stays where it is."""
        check(library().palpate_session_set_organ(self._handle, organ.handle if organ else None))
        self._organ = organ

    def snapshot(self) -> Session:
        """A copy with the same state; both go on independently."""
        copy = object.__new__(Session)
        copy.field, copy._fields, copy._organ = self.field, list(self._fields), self._organ
        copy._memory = np.zeros_like(self._memory)
        handle = ctypes.c_void_p()
        memory = copy._memory
        check(
            library().palpate_session_snapshot(
                self._handle, memory.ctypes.data, memory.nbytes, ctypes.byref(handle)
            )
        )
        copy._handle = handle.value
        return copy

    def tick(
        self, position: ArrayLike, dt: float = 1e-3, orientation: ArrayLike | None = None, flags: int = 0
    ) -> np.void:
        """One tick: `position` (3,) m, `dt` s, `orientation` (4,) x y z w; see `tick_batch` for what comes back."""
        batch = None if orientation is None else np.reshape(orientation, (1, 4))
        return self.tick_batch(np.reshape(position, (1, 3)), dt, batch, flags)[0]

    def tick_batch(
        self,
        positions: ArrayLike,
        dt: ArrayLike = 1e-3,
        orientations: ArrayLike | None = None,
        flags: ArrayLike = 0,
        organ_positions: ArrayLike | None = None,
        organ_orientations: ArrayLike | None = None,
    ) -> np.ndarray:
        """A trace of ticks.

        Args:
            positions: (n, 3) m; the grip.  Or (n,) structured `layout.STATE`, which then holds all the rest.
            dt: s; scalar or (n,).
            orientations: (n, 4) x y z w; None: the grip's axes are the world's.
            flags: `layout.Input`; scalar or (n,).
            organ_positions: (n, 3) m or (3,), of the organ's origin; None: the organ stays where it is.
            organ_orientations: (n, 4) or (4,) x y z w, with `organ_positions`; None: its axes are the world's.

        Returns:
            (n,) structured array (`layout.RESPONSE`), one for each tick.  Bad input is not an error: see `status`.
        """
        given = np.asarray(positions)
        if given.dtype == STATE:
            states = np.ascontiguousarray(given).copy()
        else:
            given = np.reshape(given, (-1, 3))
            states = np.zeros(len(given), dtype=STATE)
            states["position"], states["dt"], states["flags"] = given, dt, flags
            if orientations is None:
                states["flags"] |= np.uint32(Input.POSITION_ONLY)
            else:
                states["orientation"] = orientations
            if organ_positions is not None:
                states["flags"] |= np.uint32(Input.ORGAN_POSE)
                states["organ_position"] = organ_positions
                states["organ_orientation"] = (
                    (0, 0, 0, 1) if organ_orientations is None else organ_orientations
                )
        states["size"] = STATE.itemsize
        responses = np.zeros(len(states), dtype=RESPONSE)
        responses["size"] = RESPONSE.itemsize
        library().palpate_tick_batch(self._handle, states.ctypes.data, responses.ctypes.data, len(states))
        return responses


def _refuse_not_finite(config: np.ndarray) -> None:
    """The library refuses such a number too, but cannot say which it was.  Raises RuntimeFailure."""
    for name in config.dtype.names or ():
        if not np.isfinite(config[name]).all():
            raise RuntimeFailure(1, f"Config: {name} is {config[name]}; finite numbers are right.")
