# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A session in a C++ thread of its own: Python leads the tool at some 30 Hz, the thread ticks at 1 kHz."""

from __future__ import annotations

import ctypes
import weakref
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from palpate.runtime.field import Field
from palpate.runtime.layout import RESPONSE, Input
from palpate.runtime.library import RuntimeFailure, check, library, shared_library
from palpate.runtime.session import Config, as_struct

__all__ = ["SERVO_STATE", "Servo"]

SERVO_STATE = np.dtype(
    [
        ("size", "<u4"),
        ("real_time", "<u4"),  # 1: at a real-time priority
        ("ticks", "<u8"),
        ("missed", "<u8"),
        ("contact_ticks", "<u8"),
        ("slip_ticks", "<u8"),
        ("longest", "<f8"),  # s between two ticks
        ("position", "<f8", (3,)),  # m
        ("orientation", "<f8", (4,)),  # x y z w
        ("response", RESPONSE),
    ]
)
"""palpate_servo_state: counts since the start, the tool's pose, and the latest tick's response."""


class Servo:
    """palpate_servo: ticks a session on `field` at `rate` Hz until `close`; use each method from one thread at a time.

    Args:
        position: (3,) m; orientation: (4,) x y z w, where the tool rests at first.
        rate: Hz, 10 to 1e5.

    Raises:
        RuntimeFailure: a number is out of range, or the system gives no thread.
    """

    def __init__(
        self,
        field: Field,
        position: ArrayLike,
        orientation: ArrayLike = (0, 0, 0, 1),
        rate: float = 1000.0,
        config: Config | None = None,
    ):
        self._fields = [field]  # all stay open: the next tick may still move in an earlier one
        self.rate = rate
        q, turn = _pose(position, orientation)
        raw, handle = as_struct(config or Config()), ctypes.c_void_p()
        check(
            _servo().palpate_servo_start(
                field.handle, raw.ctypes.data, rate, q.ctypes.data, turn.ctypes.data, ctypes.byref(handle)
            )
        )
        assert handle.value is not None
        self._state: np.void = np.zeros(1, dtype=SERVO_STATE)[0]
        self._handle: int | None = handle.value
        self._stopper = weakref.finalize(self, _stop, handle.value, self._fields)

    def __enter__(self) -> Servo:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the thread; `move` and `state` raise from then on."""
        self._handle = None
        self._stopper()

    def move(
        self,
        position: ArrayLike,
        orientation: ArrayLike = (0, 0, 0, 1),
        duration: float = 0.0,
        release: bool = False,
    ) -> None:
        """Sends the tool to `position` (3,) m, `orientation` (4,) x y z w, steadily within `duration` s; does not wait.

        `release` lets go of the tissue until another target comes.

        Raises:
            RuntimeFailure: a number is not usable, or the servo is closed.
        """
        q, turn = _pose(position, orientation)
        flags = int(Input.RELEASE) if release else 0
        check(_servo().palpate_servo_move(self._handle, q.ctypes.data, turn.ctypes.data, duration, flags))

    def set_field(self, field: Field) -> None:
        """From the next tick on, another field of the same organ; see `Session.set_field`."""
        self._fields.append(field)
        check(_servo().palpate_servo_set_field(self._handle, field.handle))

    def reset(self) -> None:
        """Contact and accounts as at the start, before the next tick; counts go on."""
        check(_servo().palpate_servo_reset(self._handle))

    @property
    def state(self) -> np.void:
        """The latest tick that could be read (`SERVO_STATE`); all zero before the first.

        A thread that the system stopped while it was telling leaves the one before.

        Raises:
            RuntimeFailure: the servo is closed.
        """
        if self._handle is None:
            raise RuntimeFailure(1, "The servo is closed.")
        raw = np.zeros(1, dtype=SERVO_STATE)
        raw["size"] = SERVO_STATE.itemsize
        if _servo().palpate_servo_read(self._handle, raw.ctypes.data) == 0:
            self._state = raw[0]
        return self._state


def _pose(position: ArrayLike, orientation: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    q = np.ascontiguousarray(position, dtype=np.float64).reshape(3)
    return q, np.ascontiguousarray(orientation, dtype=np.float64).reshape(4)


def _stop(handle: int, fields: list[Field]) -> None:
    """`fields` are held until the thread has ended."""
    _servo().palpate_servo_stop(handle)
    fields.clear()


@cache
def _servo() -> ctypes.CDLL:
    library()
    lib = ctypes.CDLL(str(shared_library("palpate_servo")))
    pointer, real = ctypes.c_void_p, ctypes.c_double
    for name, result, arguments in (
        ("start", ctypes.c_int, [pointer, pointer, real, pointer, pointer, ctypes.POINTER(pointer)]),
        ("move", ctypes.c_int, [pointer, pointer, pointer, real, ctypes.c_uint32]),
        ("set_field", ctypes.c_int, [pointer, pointer]),
        ("reset", ctypes.c_int, [pointer]),
        ("read", ctypes.c_int, [pointer, pointer]),
        ("stop", None, [pointer]),
    ):
        function = getattr(lib, f"palpate_servo_{name}")
        function.restype, function.argtypes = result, arguments
    return lib
