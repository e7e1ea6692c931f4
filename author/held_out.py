# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Fresh presses against the real runtime: what a hand would feel where nobody pressed.

For each held-out press the runtime's session is moved as the tool was, held as it was: from free space straight down to
every depth of the ladder without friction, and, in a second session with the field's friction, down and then aside as
the sticking press went.  Errors are relative to the FEM normal force at that depth:

    force error    |f_n(tick) - f_n(FEM)| / f_n(FEM)
    lateral error  |f_t(tick) - f_t(FEM)| / f_n(FEM)         frictionless push along the surface
    stuck error    |f_t(tick) - f_t(FEM)| / f_n(FEM)         after a sticking move
    slid error     |f(tick) - f(FEM)| / f_n(FEM)             after sliding until friction is steady, as far as FEM went

and, no tolerance asked of it because the field is made of frictionless presses,

    friction press error   |f(tick) - f(FEM)| / f_n(FEM)     pressed straight in with friction, before it slides

judged where f_n(FEM) exceeds FLOOR of its value at the deepest state.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.tool_stage import ToolShape
from palpate.fem_offline.pose import tilted
from palpate.fields.rfield_without import rfield_without
from palpate.runtime import Config, Field, Session

__all__ = [
    "FLOOR",
    "Beyond",
    "Rendered",
    "Rendering",
    "held_out_jobs",
    "judgement",
    "judgement_of",
    "line",
    "percentiles",
    "press_judgements",
    "quasi_static",
]

FLOOR = 0.05
"""Share of the deepest force below which errors are not judged: nothing is felt there."""
TICK = 25e-6
"""m between ticks of the rendered path."""
APPROACH = 1e-3
"""m; the session starts this far outside."""
REACHED = 0.7
"""Sticking moves go this share of the stretch at which friction yields."""


Beyond = Callable[[np.ndarray], np.ndarray]
"""Tool references (n, 3) m -> (n,) m outside the reach, none or less within it."""


@dataclass(frozen=True)
class Rendered:
    """Force (n, 3) N and status (n,) at the ends of n legs."""

    force: np.ndarray
    status: np.ndarray


@runtime_checkable
class Rendering(Protocol):
    """What may stand in for the runtime, to judge what the runtime does not render."""

    def rendered(self, friction: float | None, legs: Sequence[np.ndarray]) -> Rendered:
        """As `_render`; the tool is held upright."""
        ...


def held_out_jobs(
    points: np.ndarray,
    tool: ToolShape,
    depths: np.ndarray,
    friction: float | np.ndarray,
    fidelity: str,
    seed: int,
    dragged: int = 0,
) -> list[PressJob]:
    """Jobs at points (n, 3) m; where there is friction, each sticks and moves aside at half and full depth, and nothing
    is solved for it elsewhere.

    Args:
        friction: Coulomb coefficient, one for all or (n,).
        dragged: the tool is dragged both ways, at full depth, at so many of them (count); not without friction.
    """
    generator = np.random.default_rng(seed + 1_000_003)
    jobs = []
    for point, mu in zip(points, np.broadcast_to(friction, len(points)).tolist(), strict=True):
        angles = generator.uniform(0.0, 2.0 * np.pi, 2)
        last = len(depths) - 1
        moves = (
            (((last // 4) * 2 + 1, REACHED, float(angles[0])), (last, REACHED, float(angles[1])))
            if mu
            else ()
        )
        jobs.append(
            PressJob(
                tuple(map(float, point)),
                tool,
                tuple(map(float, depths)),
                fidelity,
                moves,
                mu,
                stiffness=bool(mu),
            )
        )
    jobs[:dragged] = [replace(job, drag=job.depths[-1:]) if job.friction else job for job in jobs[:dragged]]
    return jobs


def line(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(n, 3) m, places of the ticks from after `start` to `end`."""
    count = max(1, int(np.ceil(np.linalg.norm(end - start) / TICK)))
    return start + np.linspace(0.0, 1.0, count + 1)[1:, None] * (end - start)


def _render(
    field: Field | Rendering, friction: float | None, legs: Sequence[np.ndarray], held: np.ndarray
) -> Rendered:
    """Force and status at the end of each leg of a path, the first leg's start included in it.

    held: (4,) x y z w, how the tool is held all along.
    """
    if isinstance(field, Rendering):
        return field.rendered(friction, legs)
    session = Session(field, Config(friction_coefficient=friction))
    session.tick(legs[0], orientation=held)
    here, forces, status = legs[0], [], []
    for leg in legs[1:]:
        way = line(here, leg)
        response = session.tick_batch(way, orientations=np.tile(held, (len(way), 1)))
        forces.append(response["force"][-1].copy())
        status.append(int(np.bitwise_or.reduce(response["status"])))
        here = leg
    return Rendered(np.array(forces), np.array(status))


def _press_judgement(
    field: Field | Rendering, offset: float, outcome: PressOutcome, beyond: Beyond | None
) -> dict[str, Any]:
    a, v = outcome.arrays, outcome.values
    row: dict[str, Any] = {
        "contact_point": list(outcome.job.contact_point),
        "converged": bool(v["converged"]),
        "reason": v["reason"],
        "hash": outcome.key,
        "fidelity": outcome.job.fidelity,
        "seconds": v["seconds"],
        "moves": [],
        "slides": [],
    }
    if "normal" not in a or len(a["depth"]) < 2:
        return {**row, "normal": [0.0, 0.0, 0.0], "depth": [], "fem_force": [], "rendered_force": [],
                "force_error": [], "lateral_error": [], "status": []}  # fmt: skip
    c, n = a["contact_point"], a["normal"]
    depth, fem = a["depth"][1:], a["force_vector"][1:]
    at = lambda d: c + (offset - d) * n  # noqa: E731
    start = c + (offset + APPROACH) * n
    held = Rotation.from_matrix(tilted(n, outcome.job.tool.tilt)).as_quat()
    rendered = _render(field, 0.0, [start, *[at(d) for d in depth]], held)
    fem_normal = fem @ n
    judged = fem_normal >= FLOOR * fem_normal[-1]
    normal_error = np.abs(rendered.force @ n - fem_normal) / np.abs(fem_normal)
    difference = rendered.force - fem
    aside = np.linalg.norm(difference - (difference @ n)[:, None] * n, axis=1) / np.abs(fem_normal)
    for ladder in v["lateral"]:
        d, move = ladder["depth"], np.array(ladder["deflection"])[-1]
        fem_stuck = np.array(ladder["force_vector"])[-1]
        stuck = _render(field, None, [start, at(d), at(d) + move], held)
        miss = stuck.force[-1] - fem_stuck
        scale = float(np.array(ladder["force_vector"])[0] @ n)
        row["moves"].append(
            {
                "depth": d,
                "move": move.tolist(),
                "fem_force": fem_stuck.tolist(),
                "rendered_force": stuck.force[-1].tolist(),
                "error": float(np.linalg.norm(miss - (miss @ n) * n) / scale),
            }
        )
    row["slides"] = [
        _slide(field, start, c, n, offset, path, held, beyond)
        for path in (v.get("drag") or {}).get("paths", ())
    ]
    mask = lambda values: [float(x) if ok else None for x, ok in zip(values, judged, strict=True)]  # noqa: E731
    return {
        **row,
        "normal": n.tolist(),
        "depth": depth.tolist(),
        "fem_force": fem.tolist(),
        "rendered_force": rendered.force.tolist(),
        "force_error": mask(normal_error),
        "lateral_error": mask(aside),
        "status": rendered.status.tolist(),
    }


def _slide(
    field: Field | Rendering,
    start: np.ndarray,
    c: np.ndarray,
    n: np.ndarray,
    offset: float,
    path: dict[str, Any],
    held: np.ndarray,
    beyond: Beyond | None,
) -> dict[str, Any]:
    """One drag of finite elements, and the same way in the runtime; `held` as `_render` has it.

    A drag that ends outside the reach is not judged: its error stands under another name.
    """
    here = c + (offset - path["depth"]) * n
    there = here + path["way"][-1] * np.array(path["direction"])
    fem = np.array(path["force_vector"][-1])
    pressed, rendered = _render(field, None, [start, here, there], held).force
    error = float(np.linalg.norm(rendered - fem) / (fem @ n))
    fem_pressed = np.array(path["force_vector"][0])
    outside = beyond is not None and float(beyond(there[None])[0]) > 0.0
    return {
        "depth": path["depth"],
        "move": (there - here).tolist(),
        "fem_force": fem.tolist(),
        "rendered_force": rendered.tolist(),
        "steady": path["steady"],
        "error": None if outside else error,
        "error_beyond": error if outside else None,
        "pressed_error": float(np.linalg.norm(pressed - fem_pressed) / (fem_pressed @ n)),
    }


def percentiles(values: Sequence[float | None]) -> dict[str, float] | None:
    """p50, p95 and max of what is not None; None where nothing is."""
    known = np.array([value for value in values if value is not None], float)
    if not len(known):
        return None
    return {
        "p50": float(np.percentile(known, 50)),
        "p95": float(np.percentile(known, 95)),
        "max": float(known.max()),
    }


def quasi_static(data: bytes) -> Field:
    """The runtime's field of the .rfield `data`, without what plays on top of its response: presses know of no tap."""
    return Field.open(rfield_without(data))


def judgement(
    field: Field | Rendering,
    offset: float,
    outcomes: Sequence[PressOutcome],
    near: Sequence[PressOutcome],
    tolerance: float,
    beyond: Beyond | None = None,
) -> dict[str, Any]:
    """Held-out errors of one tool.

    Args:
        offset: rho, m.
        outcomes: held-out presses.
        near: near-field presses at some of the same points, for the far field's own error; may be empty.
        tolerance: fraction at the 95th percentile, of each kind of error; the worst may be twice that.
        beyond: drags that end outside the reach are not judged; None: all are.
    """
    return judgement_of(press_judgements(field, offset, outcomes, beyond), outcomes, near, tolerance)


def press_judgements(
    field: Field | Rendering, offset: float, outcomes: Sequence[PressOutcome], beyond: Beyond | None = None
) -> list[dict[str, Any]]:
    """One row for each press, in their order; `beyond` as `judgement` has it."""
    return [_press_judgement(field, offset, outcome, beyond) for outcome in outcomes]


def judgement_of(
    presses: Sequence[dict[str, Any]],
    outcomes: Sequence[PressOutcome],
    near: Sequence[PressOutcome],
    tolerance: float,
) -> dict[str, Any]:
    """`judgement` from rows of `press_judgements`, in the order of `outcomes`."""
    flat = lambda key: [x for press in presses for x in press[key]]  # noqa: E731
    force = percentiles(flat("force_error"))
    lateral = percentiles(flat("lateral_error"))
    stuck = percentiles([move["error"] for press in presses for move in press["moves"]])
    slid = percentiles([slide["error"] for press in presses for slide in press["slides"]])
    failed = sum(not press["converged"] for press in presses)
    met = force is not None and all(
        error is None or (error["p95"] <= tolerance and error["max"] <= 2.0 * tolerance)
        for error in (force, lateral, stuck, slid)
    )
    return {
        "fidelity": outcomes[0].job.fidelity if outcomes else "",
        "tolerance": tolerance,
        "met": bool(met and not failed),
        "floor": FLOOR,
        "points": len(presses),
        "failed": failed,
        "seconds": float(sum(press["seconds"] for press in presses)),
        "force_error": force,
        "lateral_error": lateral,
        "stuck_error": stuck,
        "slid_error": slid,
        "friction_press_error": percentiles(
            [s["pressed_error"] for press in presses for s in press["slides"]]
        ),
        "slides_beyond_reach": sum(slide["error"] is None for press in presses for slide in press["slides"]),
        "far_field_error": _far_field_error(outcomes, near),
        "presses": list(presses),
    }


def _far_field_error(full: Sequence[PressOutcome], near: Sequence[PressOutcome]) -> dict[str, float] | None:
    truth = {(outcome.job.contact_point, outcome.job.tool): outcome for outcome in full}
    errors: list[float] = []
    for outcome in near:
        other = truth.get((outcome.job.contact_point, outcome.job.tool))
        if other is None or not (outcome.converged and other.converged):
            continue
        f = other.arrays["force_vector"][1:] @ other.arrays["normal"]
        miss = outcome.arrays["force_vector"][1:] @ other.arrays["normal"] - f
        errors += list(np.abs(miss / f)[f >= FLOOR * f[-1]])
    return percentiles(errors)
