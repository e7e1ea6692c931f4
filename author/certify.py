# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Can this device render this field without a hum?

Holding a spring of stiffness sigma over a period T, sent tau late, gives energy that the device's damping has to take,
and positions known to delta only, energy that its dry friction has to take (V. Hayward, Physically-based haptic
synthesis, 2008, section 1, after Colgate and Schenkel, 1994):

    B >= sigma (T / 2 + tau),        f_f >= sigma delta / 2.

sigma is the stiffness of tissue and friction spring together: the field's largest one for the verdict, that of many
places drawn at random for the share of the field that is rendered well.  Limits: one contact, the hand itself left out
(it only adds damping), a device that is a mass.  `simulate` lets a device with that much damping, less and more push
into the stiffest place that was drawn, and says whether it comes to rest.

Sliding: the field pushes along the surface where its stiffness varies, |t| = |sum_r phi_r(d) grad a_r| at a normal
force f_n.  An interpolation that leaves this push out (response = "axial", the published scheme) creates energy, which
friction hides only where mu f_n >= |t|.  Nothing is felt where f_n is tiny, but |t| / f_n has no bound just there,
where the field fades beyond its reach: places are judged where f_n is at least FORCE_FLOOR of the largest
that was drawn, as held-out errors are.  sliding_share is the share of judged contact where the field's own mu hides the
push, and friction_needed the mu that would hide it at every judged place, a lower bound for everywhere; the potential,
which does push, needs neither.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.rfield_file import no_rfield

__all__ = ["certify"]

PLACES = 200_000
"""Points drawn in the field's box; some per cent of them are in contact."""
FORCE_FLOOR = 0.05
"""Of the field's deepest force; sliding is not judged below it.  As held_out.FLOOR, whose import is slow."""
SHARES = (0.7, 1.0, 1.5, 3.0)
"""Damping of the simulated devices over what the bound asks for; beside the device's own."""
RESTS = 0.2
"""A device rests when its speed falls below this share of what it was at first."""


def certify(
    field: Path,
    *,
    rate: float,
    damping: float,
    delay: float = 0.0,
    quantum: float = 0.0,
    dry_friction: float = 0.0,
    mass: float = 0.05,
    max_force: float | None = None,
    name: str = "",
    assumed: tuple[str, ...] = (),
    simulate: bool = False,
) -> dict[str, Any]:
    """Holds a device against the .rfield `field`.

    Args:
        rate: Hz; damping: N s/m; delay: s; quantum: m; dry_friction: N; mass: kg (of the simulation); max_force: N,
            or None where it is not known; name: of the device; assumed: what nobody said of it, for the answer.

    Returns:
        field, device ({name, rate, damping, delay, resolution, friction, max_force, assumed}), rate (Hz), stiffness_max
        (N/m), damping_needed (N s/m), dry_friction_needed (N), rate_needed (Hz; None where no rate is enough at this
        delay), sampling_share (of contact up to depth_max where both bounds hold), sliding_floor (N), sliding_judged
        (share of contact above that force), sliding_share (of judged contact), friction_needed (see above) and
        friction_needed_at ((3,) m, the tool's reference point there), force_share (of contact within max_force; None
        without one), met, sentence; and with `simulate` a list `simulated` of {damping, damping_over_bound, stiffness,
        speed_early, speed_late (m/s), rests}.

    Raises:
        InputError: there is no file, nothing in it is touched, or a number is out of range.
        RuntimeFailure: it is damaged.
    """
    from palpate.runtime import Field

    given = {
        "rate": rate,
        "damping": damping,
        "delay": delay,
        "quantum": quantum,
        "dry-friction": dry_friction,
        "mass": mass,
        "max-force": 1.0 if max_force is None else max_force,
    }
    positive = ("rate", "mass", "max-force")
    problems = [
        InputProblem("", f"--{key}", value, "is not usable", "above 0" if key in positive else "0 or more")
        for key, value in given.items()
        if not (np.isfinite(value) and value >= 0 and (value > 0 or key not in positive))
    ]
    if problem := no_rfield(field):
        problems.append(problem)
    if problems:
        raise InputError(problems)
    opened = Field.open(field)
    sigma, period = opened.info.stiffness_max, 1.0 / rate
    places = _contacts(opened)
    if not len(places):
        what = f"has none of {PLACES} places in contact that were drawn in its box"
        raise InputError(InputProblem(str(field), "", None, what, "a field that is touched somewhere"))
    local = np.abs(places["stiffness"]) + places["friction_stiffness"]
    good = (damping >= local * (0.5 * period + delay)) & (dry_friction >= 0.5 * local * quantum)
    longest = 2.0 * (damping / sigma - delay) if sigma > 0 else np.inf  # s, of a period
    needed = {
        "damping_needed": sigma * (0.5 * period + delay),
        "dry_friction_needed": 0.5 * sigma * quantum,
        "rate_needed": 1.0 / longest if longest > 0 else None,
    }
    met = damping >= needed["damping_needed"] and dry_friction >= needed["dry_friction_needed"]
    result = {
        "field": str(field),
        "device": {
            "name": name,
            "rate": rate,
            "damping": damping,
            "delay": delay,
            "resolution": quantum,
            "friction": dry_friction,
            "max_force": max_force,
            "assumed": list(assumed),
        },
        "rate": rate,
        "stiffness_max": sigma,
        **needed,
        "sampling_share": float(good.mean()),
        **_sliding(places),
        "force_share": None
        if max_force is None
        else float((np.linalg.norm(places["force"], axis=1) <= max_force).mean()),
        "met": bool(met),
        "sentence": _sentence(met, needed, damping, dry_friction),
    }
    if simulate:
        from palpate.runtime.device import Device

        device = Device(mass=mass, rate=rate, delay=delay, quantum=quantum, dry_friction=dry_friction)
        result["simulated"] = _simulated(opened, places, device, damping)
    return result


def _sliding(places: np.ndarray) -> dict[str, Any]:
    """What friction would have to hide from a scheme without a push along the surface."""
    floor = FORCE_FLOOR * float(places["normal_force"].max())
    judged = places[places["normal_force"] >= floor]
    normal, force = judged["normal"], judged["force"]
    along = force - np.sum(force * normal, axis=1, keepdims=True) * normal
    needed = np.linalg.norm(along, axis=1) / judged["normal_force"]
    worst = int(np.argmax(needed))
    return {
        "sliding_floor": floor,
        "sliding_judged": len(judged) / len(places),
        "sliding_share": float((judged["friction_coefficient"] >= needed).mean()),
        "friction_needed": float(needed[worst]),
        "friction_needed_at": judged["q"][worst].tolist(),
    }


def _sentence(met: bool, needed: dict[str, Any], damping: float, dry_friction: float) -> str:
    if met:
        return "Nothing that this device renders of the field adds energy."
    missing = []
    if damping < needed["damping_needed"]:
        rate = needed["rate_needed"]
        instead = f"{rate / 1e3:.3g} kHz" if rate else "less delay"
        missing.append(f"needs {instead}, or damping of {needed['damping_needed']:.3g} N s/m, on this device")
    if dry_friction < needed["dry_friction_needed"]:
        missing.append(f"needs {needed['dry_friction_needed']:.3g} N of dry friction or finer encoders")
    return "; ".join(missing)


def _contacts(field) -> np.ndarray:
    """Samples in contact up to depth_max, at places drawn by a fixed seed."""
    info = field.info
    q = np.random.default_rng(1).uniform(info.box_min, info.box_max, (PLACES, 3))
    s = field.sample(q)
    touching = (s["region"] == 2) & (s["depth"] <= info.depth_max) & (s["normal_force"] > 0)
    kept = np.zeros(int(touching.sum()), dtype=[*s.dtype.descr, ("q", "<f8", (3,))])
    for name in s.dtype.names:
        kept[name] = s[name][touching]
    kept["q"] = q[touching]
    return kept


def _simulated(field, places: np.ndarray, device, damping: float) -> list[dict[str, Any]]:
    from dataclasses import replace

    reachable = places[places["depth"] <= 0.8 * field.info.depth_max]
    at = reachable[np.argmax(reachable["stiffness"])]
    stiffness = float(at["stiffness"])  # along the push
    bound = stiffness * (0.5 / device.rate + device.delay)
    rows = []
    for share in sorted({*SHARES, damping / bound}):
        tried = replace(device, damping=share * bound)
        early, late = _speeds(field, tried, at)
        rows.append(
            {
                "damping": tried.damping,
                "damping_over_bound": share,
                "stiffness": stiffness,
                "speed_early": early,
                "speed_late": late,
                "rests": late < RESTS * early,
            }
        )
    return rows


def _speeds(field, device, at) -> tuple[float, float]:
    """RMS speed (m/s) along the normal, at first and at last, of a device let go 0.2 mm out of its equilibrium.

    Friction is off and the motion is along the normal only, so that damping alone can bring it to rest."""
    from palpate.runtime import Config, Session
    from palpate.runtime.device import Hand, simulate

    ticks = 3000
    session = Session(field, Config(friction_coefficient=0.0, speed_max=0.0))
    outside = at["q"] + (at["depth"] + 1e-3) * at["normal"]
    session.tick_batch(np.linspace(outside, at["q"], 200))
    force = session.tick(at["q"])["force"]
    hand = Hand(push=tuple(-force), along=tuple(at["normal"]))
    motion = simulate(session, device, hand, at["q"] + 2e-4 * at["normal"], ticks, substeps=8)
    speed = motion.velocity @ at["normal"]
    return float(np.sqrt(np.mean(speed[:300] ** 2))), float(np.sqrt(np.mean(speed[-300:] ** 2)))
