# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rigid contact: cooked objects and a held object in a hand, as include/palpate/rigid.h has them."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, fields
from enum import IntEnum, IntFlag
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from palpate.runtime.library import RuntimeFailure, check, library, shared_library

__all__ = [
    "RESPONSE", "STATE", "Case", "Motion", "Region", "Rigid", "RigidConfig", "RigidSession", "Status",
    "add_wrenches", "bench_rigid", "tick_text",
]  # fmt: skip


class Region(IntEnum):
    POINT = 0
    LINE = 1
    PLANE = 2


class Motion(IntEnum):
    """Prior motion."""

    FREE = 0
    GUARDED = 1
    KEPT = 2
    GAINED = 3
    CHANGED = 4


class Case(IntEnum):
    """How the held object moves against what it touches."""

    NO_CASE = 0
    STATIC = 1
    ROLLING = 2
    TURNING = 3
    SLIDING = 4


class Status(IntFlag):
    """PALPATE_RIGID_TICK_ bits."""

    JUMP = 1
    STALE = 2
    BAD_INPUT = 4
    BAD_ARGUMENT = 8
    RELEASED = 16
    TOO_DEEP = 32
    WAITING = 64
    FORCE_LIMITED = 128
    OVERFLOW = 256
    NOT_IN_TABLE = 512
    ENERGY_LIMITED = 1024


_VECTOR = ("<f8", 3)
CONFIG = np.dtype(
    [
        ("size", "<u4"), ("inertia", "<u4"), ("grip", *_VECTOR), ("speed_max", "<f8"), ("dt_max", "<f8"),
        ("force_max", "<f8"), ("torque_max", "<f8"), ("filter_time", "<f8"),
        ("coupling_stiffness", "<f8"), ("coupling_damping", "<f8"), ("coupling_torsional_stiffness", "<f8"),
        ("coupling_torsional_damping", "<f8"), ("acceleration_max", "<f8"),
    ]
)  # fmt: skip
STATE = np.dtype(
    [("size", "<u4"), ("flags", "<u4"), ("dt", "<f8"), ("position", *_VECTOR), ("orientation", "<f8", 4)]
)
CONTACT = np.dtype(
    [
        ("held_element", "<u4"), ("fixed_element", "<u4"), ("region", "<u4"), ("sliding", "<u4"), ("point", *_VECTOR),
        ("normal", *_VECTOR), ("tangent", *_VECTOR), ("gap", "<f8"), ("normal_force", "<f8"), ("friction", *_VECTOR),
    ]
)  # fmt: skip
RESPONSE = np.dtype(
    [
        *((name, "<u4") for name in ("size", "status", "motion", "motion_case", "contact_count", "formation")),
        *((name, *_VECTOR) for name in ("force", "torque", "contact_force", "contact_torque", "velocity",
                                        "angular_velocity", "acceleration", "angular_acceleration")),
        *((name, "<f8") for name in ("stored_energy", "work_in", "dissipated_friction", "dissipated_damping",
                                     "inertial", "gravity_work", "unaccounted")),
        ("contact", CONTACT, 8),
    ]
)  # fmt: skip


@cache
def _functions() -> ctypes.CDLL:
    lib = library()
    pointer, size, text = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p
    out = ctypes.POINTER(ctypes.c_void_p)
    for name, result, arguments in (
        ("palpate_rigid_open", ctypes.c_int, [text, size, out, text, size]),
        ("palpate_rigid_close", None, [pointer]),
        ("palpate_rigid_session_size", size, []),
        ("palpate_rigid_session_init", ctypes.c_int, [pointer, size, pointer, pointer, out]),
        ("palpate_rigid_session_reset", ctypes.c_int, [pointer]),
        ("palpate_rigid_session_place", ctypes.c_int, [pointer, pointer, pointer]),
        ("palpate_rigid_tick_batch", ctypes.c_uint32, [pointer, pointer, pointer, size]),
        ("palpate_rigid_identify", ctypes.c_int, [pointer, pointer, pointer, size]),
        ("palpate_rigid_tick_text", text, [ctypes.c_uint32]),
        (
            "palpate_rigid_add",
            ctypes.c_uint32,
            [*[pointer] * 4, ctypes.c_double, ctypes.c_double, pointer, pointer],
        ),
    ):
        function = getattr(lib, name)
        function.restype, function.argtypes = result, arguments
    return lib


class Rigid:
    """Cooked rigid objects.

    Raises (on construction):
        RuntimeFailure: the bytes are not those of cooked rigid objects, with one sentence.
    """

    def __init__(self, data: bytes):
        handle, message = ctypes.c_void_p(), ctypes.create_string_buffer(256)
        status = _functions().palpate_rigid_open(data, len(data), ctypes.byref(handle), message, len(message))
        if status != 0:
            raise RuntimeFailure(status, message.value.decode())
        self.handle = handle.value

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            _functions().palpate_rigid_close(self.handle)

    def identify(self, positions: ArrayLike, orientations: ArrayLike) -> np.ndarray:
        """Formations at poses of the centre of mass, without history or forces.

        Args:
            positions: (n, 3) m.  orientations: (n, 4) x y z w.

        Returns:
            (n,) RESPONSE: contacts, contact_count, formation and status.
        """
        states = _states(positions, orientations, 1e-3, 0)
        responses = np.zeros(len(states), dtype=RESPONSE)
        check(
            _functions().palpate_rigid_identify(
                self.handle, states.ctypes.data, responses.ctypes.data, len(states)
            )
        )
        return responses


@dataclass(frozen=True)
class RigidConfig:
    """palpate_rigid_config.

    Attributes:
        grip: (3,) m, in the held object's frame: where the device holds it.
        inertia: in free motion the object's own inertia is felt.
        speed_max: m/s, of any point of the object.  dt_max: s.
        force_max, torque_max: N and N m about the grip; the device's limits; 0: none.
        filter_time: s; of velocities and accelerations.
        coupling_stiffness, coupling_damping: N/m, N s/m; virtual coupling at the grip; 0: none.
        coupling_torsional_stiffness, coupling_torsional_damping: N m/rad, N m s/rad; of turns.
        acceleration_max: m/s2, of the hand; what the energy accounts count on.
    """

    grip: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: bool = True
    speed_max: float = 5.0
    dt_max: float = 0.1
    force_max: float = 0.0
    torque_max: float = 0.0
    filter_time: float = 0.005
    coupling_stiffness: float = 0.0
    coupling_damping: float = 0.0
    coupling_torsional_stiffness: float = 0.0
    coupling_torsional_damping: float = 0.0
    acceleration_max: float = 300.0


class RigidSession:
    """One held object in a hand; use it from one thread at a time.

    Raises (on construction):
        RuntimeFailure: a number in the config is out of range.
    """

    def __init__(self, rigid: Rigid, config: RigidConfig | None = None):
        self.rigid = rigid
        self._memory = np.zeros(-(-_functions().palpate_rigid_session_size() // 8), dtype=np.float64)
        raw = _config(config or RigidConfig())
        handle = ctypes.c_void_p()
        memory = self._memory
        status = _functions().palpate_rigid_session_init(
            memory.ctypes.data, memory.nbytes, rigid.handle, raw.ctypes.data, ctypes.byref(handle)
        )
        check(status)
        self._handle = handle.value

    def reset(self) -> None:
        """Back to the state after construction, accounts at zero."""
        check(_functions().palpate_rigid_session_reset(self._handle))

    def place(self) -> tuple[np.ndarray, np.ndarray]:
        """Where the held object is after the last tick: (3,) m, centre of mass; (4,) x y z w.

        Raises:
            RuntimeFailure: there has been no tick.
        """
        position, orientation = np.zeros(3), np.zeros(4)
        check(
            _functions().palpate_rigid_session_place(
                self._handle, position.ctypes.data, orientation.ctypes.data
            )
        )
        return position, orientation

    def tick(
        self, position: ArrayLike, orientation: ArrayLike = (0, 0, 0, 1), dt: float = 1e-3, flags: int = 0
    ) -> np.void:
        """One tick; see `tick_batch`."""
        return self.tick_batch(np.reshape(position, (1, 3)), np.reshape(orientation, (1, 4)), dt, flags)[0]

    def tick_batch(
        self, positions: ArrayLike, orientations: ArrayLike, dt: ArrayLike = 1e-3, flags: ArrayLike = 0
    ) -> np.ndarray:
        """A trace of ticks.

        Args:
            positions: (n, 3) m, of the grip.  orientations: (n, 4) or (4,) x y z w.  dt: s.

        Returns:
            (n,) RESPONSE, one for each tick.  Bad input is not an error: see `status`.
        """
        states = _states(positions, orientations, dt, flags)
        responses = np.zeros(len(states), dtype=RESPONSE)
        responses["size"] = RESPONSE.itemsize
        _functions().palpate_rigid_tick_batch(
            self._handle, states.ctypes.data, responses.ctypes.data, len(states)
        )
        return responses


def add_wrenches(
    first: tuple[ArrayLike, ArrayLike],
    second: tuple[ArrayLike, ArrayLike],
    force_max: float = 0.0,
    torque_max: float = 0.0,
) -> tuple[np.ndarray, np.ndarray, bool]:
    """One wrench of two (force (3,) N, torque (3,) N m, one grip), within the device's limits; and whether limited."""
    parts = [np.ascontiguousarray(x, dtype=np.float64) for x in (*first, *second)]
    force, torque = np.zeros(3), np.zeros(3)
    limited = _functions().palpate_rigid_add(
        *(p.ctypes.data for p in parts), force_max, torque_max, force.ctypes.data, torque.ctypes.data
    )
    return force, torque, bool(limited)


def tick_text(status: int) -> str:
    """One sentence for the lowest bit of a tick's status."""
    return _functions().palpate_rigid_tick_text(status).decode()


def _states(positions: ArrayLike, orientations: ArrayLike, dt: ArrayLike, flags: ArrayLike) -> np.ndarray:
    given = np.reshape(np.asarray(positions, dtype=float), (-1, 3))
    states = np.zeros(len(given), dtype=STATE)
    states["size"], states["dt"], states["flags"] = STATE.itemsize, dt, flags
    states["position"], states["orientation"] = given, orientations
    return states


def bench_rigid(
    rigid: Rigid,
    positions: ArrayLike,
    orientations: ArrayLike,
    dt: float = 1e-3,
    config: RigidConfig | None = None,
) -> dict[str, np.ndarray]:
    """Times a motion tick by tick, each the fastest of five runs.

    Returns:
        identify: (n,) ns, of naming the formation where the tick put the object.  tick: (n,) ns, of the whole tick.
    """
    timing = ctypes.CDLL(str(shared_library("palpate_bench")))
    pointer = ctypes.c_void_p
    timing.palpate_bench_rigid.restype = ctypes.c_int
    timing.palpate_bench_rigid.argtypes = [pointer, pointer, pointer, ctypes.c_size_t, pointer, pointer]
    states, raw = _states(positions, orientations, dt, 0), _config(config or RigidConfig())
    identify, tick = np.zeros(len(states)), np.zeros(len(states))
    check(
        timing.palpate_bench_rigid(
            rigid.handle,
            raw.ctypes.data,
            states.ctypes.data,
            len(states),
            identify.ctypes.data,
            tick.ctypes.data,
        )
    )
    return {"identify": identify, "tick": tick}


def _config(config: RigidConfig) -> np.ndarray:
    raw = np.zeros((), dtype=CONFIG)
    raw["size"] = CONFIG.itemsize
    for field in fields(config):
        raw[field.name] = getattr(config, field.name)
    return raw
