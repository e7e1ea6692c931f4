# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Recorded traces: a trace of tool states in, the runtime's answer to it with forces and energies out.

A trace is a table with one row for each servo tick, as CSV (a header line, commas) or as NPZ (one array for each name):

    column                      unit  needed
    x, y, z                     m     always: the grip's position in the world's axes
    dt                          s     or `time`; s since the last tick
    time                        s     or `dt`; s, rising; the first tick gets the second one's dt
    qx, qy, qz, qw              -     no; the grip's orientation.  Absent: its axes are the world's
    ox, oy, oz                  m     no; the organ's origin.  Absent: the organ's axes are the world's
    oqx, oqy, oqz, oqw          -     no, with ox, oy, oz; the organ's orientation
    release                     0, 1  no; 1 lets go (a clutch)

In NPZ `position` (n, 3), `orientation` (n, 4), `organ_position` and `organ_orientation` may stand for their columns.
A row that the runtime cannot use (a number that is not finite, a dt of 0 or below, no unit quaternion) is no reason to
refuse the trace: it goes to the runtime like any other, which sends no force, says why in its status, and lets contact
come back from outside only.  A `release` that is not finite lets go.

What comes out holds the same rows with RESULT_COLUMNS beside them, so that an answer is itself a trace and can be
replayed again: that reproduces it bit for bit.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import UNREADABLE, InputError, InputProblem
from palpate.author.rfield_file import no_rfield

__all__ = ["RESULT_COLUMNS", "read_trace", "replay", "write_trace"]

VECTORS = {"force": "f", "torque": "t", "anchor": "c", "normal": "n"}
SCALARS = (
    "status", "region", "depth", "normal_force", "stiffness", "friction_stiffness", "friction_coefficient",
    "stored_energy", "spring_energy", "surface_offset", "work_in", "dissipated_friction", "dissipated_rule",
    "hold_leak", "organ_work", "injected", "way_cosine",
)  # fmt: skip
ENERGIES = (
    "work_in", "organ_work", "injected", "stored_energy", "dissipated_friction", "dissipated_rule", "hold_leak"
)  # fmt: skip
WHOLES = {
    "position": tuple("xyz"),
    "orientation": ("qx", "qy", "qz", "qw"),
    "organ_position": ("ox", "oy", "oz"),
    "organ_orientation": ("oqx", "oqy", "oqz", "oqw"),
}
RESULT_COLUMNS = (*(f"{short}{axis}" for short in VECTORS.values() for axis in "xyz"), *SCALARS)


def replay(
    field: Path,
    trace: Path,
    out: Path | None = None,
    *,
    friction: float | None = None,
    force_max: float = 0.0,
) -> dict[str, Any]:
    """Sends the trace in the file `trace` through the runtime on the .rfield `field`.

    Args:
        out: where the answer goes (.csv or .npz); None: nowhere.
        friction: coefficient in place of the field's.
        force_max: N; the device's limit, 0 for none.

    Returns:
        field, trace, out, ticks, seconds (of the usable rows), work_in, organ_work, injected, stored_energy,
        dissipated_friction, dissipated_rule, hold_leak (J, at the end), balance_error (J; work_in recomputed here
        from forces and positions, against the accounts), force_max_seen (N), depth_max_seen (m),
        status (sentence: ticks).

    Raises:
        InputError: a file is missing or no table of numbers, a column is missing or has not one usable row, or a number
            is out of range.
        RuntimeFailure: the .rfield is damaged.
    """
    from palpate.runtime import Config, Field, Session

    table = read_trace(trace)
    if problem := no_rfield(field):
        raise InputError(problem)
    if out is not None and out.suffix not in (".csv", ".npz"):
        raise InputError(InputProblem("", "--out", str(out), "has an unknown ending", ".csv or .npz"))
    for key, value in (("--friction", friction), ("--force-max", force_max)):
        if value is not None and not 0.0 <= value < np.inf:
            raise InputError(InputProblem("", key, value, "is not usable", "a number from 0"))
    opened = Field.open(field)
    session = Session(opened, Config(friction_coefficient=friction, force_max=force_max))
    wholes = {
        whole: np.stack([table[name] for name in parts], axis=1) if parts[0] in table else None
        for whole, parts in WHOLES.items()
    }
    position = wholes["position"]
    flags = np.where(table.get("release", np.zeros(len(position))) != 0, 2, 0).astype(np.uint32)
    r = session.tick_batch(
        position,
        table["dt"],
        wholes["orientation"],
        flags,
        wholes["organ_position"],
        wholes["organ_orientation"],
    )
    if out is not None:
        write_trace(out, table | _columns(r))
    return {
        "field": str(field),
        "trace": str(trace),
        "out": None if out is None else str(out),
        "ticks": len(r),
        "seconds": float(np.sum(table["dt"], where=_usable("dt", table["dt"]))),
        **{name: float(r[-1][name]) for name in ENERGIES},
        "balance_error": _balance_error(r),
        "force_max_seen": float(np.linalg.norm(r["force"], axis=1).max()),
        "depth_max_seen": float(r["depth"].max()),
        "status": _status(r["status"]),
    }


def read_trace(path: Path) -> dict[str, np.ndarray]:
    """The columns of a trace (n,) by name, `dt` s always among them; results of an earlier replay are left out."""
    if not path.is_file():
        raise InputError(InputProblem(str(path), "", None, "does not exist", "a trace (.csv or .npz)"))
    try:
        if path.suffix == ".npz":
            with np.load(path, allow_pickle=False) as stored:
                table = {name: np.asarray(stored[name], dtype=np.float64) for name in stored.files}
        else:
            head, *lines = path.read_text(encoding="utf-8").splitlines() or [""]
            if not any(line.strip() for line in lines):
                raise ValueError("no rows")
            names = [name.strip() for name in head.split(",")]
            rows = np.loadtxt(lines, delimiter=",", dtype=np.float64, ndmin=2)
            if rows.shape[1] != len(names):
                raise ValueError(f"{len(names)} names for {rows.shape[1]} columns")
            table = dict(zip(names, rows.T, strict=True))
    except UNREADABLE as error:
        what = "cannot be read as a table of numbers"
        raise InputError(
            InputProblem(str(path), "", str(error)[:80], what, "CSV with a header, or NPZ")
        ) from error
    for whole, parts in WHOLES.items():
        if whole in table and table[whole].ndim == 2 and table[whole].shape[1] == len(parts):
            table |= dict(zip(parts, table.pop(whole).T, strict=True))
    table = {name: column for name, column in table.items() if name not in RESULT_COLUMNS}
    problems = [_missing(path, name) for name in "xyz" if name not in table]
    if "dt" not in table and "time" not in table:
        problems.append(_missing(path, "dt"))
    for parts in list(WHOLES.values())[1:]:
        if parts[0] in table:
            problems += [_missing(path, name) for name in parts if name not in table]
    if "oqx" in table and "ox" not in table:
        problems.append(_missing(path, "ox"))
    if problems:
        raise InputError(problems)
    if "dt" not in table:
        table["dt"] = _steps(table["time"])
    lengths = {name: np.shape(column) for name, column in table.items()}
    if len(set(lengths.values())) != 1 or len(lengths["x"]) != 1 or lengths["x"][0] == 0:
        raise InputError(InputProblem(str(path), "", str(lengths)[:80], "differ in length", "equal columns"))
    problems = [
        InputProblem(str(path), name, float(table[name][0]), "has not one usable row", right)
        for name, right in (
            *((axis, "finite numbers, m") for axis in "xyz"),
            ("dt", "s above 0; rising times"),
        )
        if not _usable(name, table[name]).any()
    ]
    if problems:
        raise InputError(problems)
    return table


def write_trace(path: Path, table: dict[str, np.ndarray]) -> None:
    """Writes columns (n,) as CSV (17 digits: nothing is lost) or NPZ, by the ending of `path`."""
    if path.suffix == ".npz":
        np.savez_compressed(path, **table)
        return
    columns = np.stack([np.asarray(column, dtype=np.float64) for column in table.values()], axis=1)
    np.savetxt(path, columns, fmt="%.17g", delimiter=",", header=",".join(table), comments="")


def _usable(name: str, column: np.ndarray) -> np.ndarray:
    return np.isfinite(column) & (column > 0) if name == "dt" else np.isfinite(column)


def _steps(time: np.ndarray) -> np.ndarray:
    """s since the last tick with a finite time; the first one gets the second one's, a tick without a time nan."""
    dt = np.full(np.shape(time), np.nan)
    known = np.flatnonzero(np.isfinite(time))
    steps = np.diff(time[known])
    dt[known] = np.concatenate([steps[:1] if len(steps) else [1e-3], steps])[: len(known)]
    return dt


def _missing(path: Path, name: str) -> InputProblem:
    return InputProblem(str(path), name, None, "is not there", "columns x, y, z (m) and dt or time (s)")


def _columns(r: np.ndarray) -> dict[str, np.ndarray]:
    table = {
        f"{short}{axis}": r[name][:, i] for name, short in VECTORS.items() for i, axis in enumerate("xyz")
    }
    return table | {name: np.asarray(r[name], dtype=np.float64) for name in SCALARS}


def _balance_error(r: np.ndarray) -> float:
    """J; the hand's work from what was sent and where the tool went, against the runtime's own account."""
    work = -float(np.sum(r["force"][:-1] * np.diff(r["reference_point"], axis=0)))
    last = r[-1]
    kept = last["stored_energy"] + last["dissipated_friction"] + last["dissipated_rule"] - last["hold_leak"]
    return abs(work - float(kept - last["organ_work"] - last["injected"]))


def _status(status: np.ndarray) -> dict[str, int]:
    from palpate.runtime.library import library

    bits = [1 << i for i in range(32) if np.any(status & np.uint32(1 << i))]
    return {
        library().palpate_tick_text(bit).decode(): int(np.sum((status & np.uint32(bit)) != 0)) for bit in bits
    }
