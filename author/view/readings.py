# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The servo's state as the page tells it: force, contact, slip, energy accounts, ticks."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

import numpy as np

from palpate.author.report.palette import INK, MARK, QUIET, RENDERED
from palpate.author.view.colours import gradient
from palpate.runtime import Region, Tick
from palpate.runtime.library import library

__all__ = ["MISSED_ALLOWED", "Readings", "legend", "missed_share", "table"]

MISSED_ALLOWED = 0.01
"""Share of ticks that the servo thread may miss."""
BALANCED = 1e-12
"""J; energy accounts that agree to this are called balanced."""


@dataclass(frozen=True)
class Readings:
    """One look at the servo.

    Attributes:
        state: SERVO_STATE.
        slipping: whether the contact slipped in any tick since the last look.
        dimple: a sentence about the drawn surface.
    """

    state: np.void
    slipping: bool
    dimple: str

    @property
    def contact(self) -> bool:
        return int(self.state["response"]["region"]) == Region.CONTACT

    @property
    def force(self) -> float:
        """N."""
        return float(np.linalg.norm(self.state["response"]["force"]))

    @property
    def lateral(self) -> float:
        """N, across the normal: the tissue's push aside and friction."""
        r = self.state["response"]
        return float(np.linalg.norm(r["force"] - (r["force"] @ r["normal"]) * r["normal"]))

    @property
    def imbalance(self) -> float:
        """J; what the accounts leave over: 0 but for rounding."""
        r = self.state["response"]
        given = r["work_in"] + r["organ_work"] + r["hold_leak"] + r["injected"]
        return float(given - r["stored_energy"] - r["dissipated_friction"] - r["dissipated_rule"])


def missed_share(state: np.void) -> float:
    """Missed ticks over all that were due."""
    due = int(state["ticks"]) + int(state["missed"])
    return int(state["missed"]) / due if due else 0.0


def table(tool: str, now: Readings, moves: int) -> str:
    """HTML.  Its data attributes are for programs: tool, contact, slip, slipped (ticks), force N, depth m, ticks,
    missed, moves."""
    r, s = now.state["response"], now.state
    status = int(r["status"])
    bits = [bit for bit in (1 << i for i in range(16)) if status & bit and bit != Tick.SLIPPING]
    sentences = [library().palpate_tick_text(bit).decode() for bit in bits]
    word, colour = (
        ("slipping", MARK) if now.slipping else ("sticking", RENDERED) if now.contact else ("free", QUIET)
    )
    depth = float(r["depth"])
    share = missed_share(s)
    rows = [
        ("force", f"<b>{now.force:.3f} N</b> (normal {r['normal_force']:.3f}, lateral {now.lateral:.3f})"),
        ("depth", f"{1e3 * depth:.2f} mm"),
        ("stiffness", f"{r['stiffness']:.0f} N/m; along the surface {r['friction_stiffness']:.0f} N/m"),
        ("contact", f'<span style="color:{colour};font-weight:600">&#9679; {word}</span>, friction '
                    f"{r['friction_coefficient']:.3g}"),
        ("hand's work", _joule(r["work_in"])),
        ("stored", f"{_joule(r['stored_energy'])}, of that in friction's spring {_joule(r['spring_energy'])}"),
        ("dissipated", f"{_joule(r['dissipated_friction'])} by friction, {_joule(r['dissipated_rule'])} by rule"),
        ("held force", f"{_joule(r['hold_leak'])} given by holding over a tick"),
        ("accounts", "balance" if abs(now.imbalance) < BALANCED else f"off by {_joule(now.imbalance)}"),
        ("servo", f"{int(s['ticks'])} ticks, {int(s['missed'])} missed ({100 * share:.3f} %); longest "
                  f"{1e3 * s['longest']:.2f} ms; {'real-time' if s['real_time'] else 'ordinary'} priority"),
        ("surface", now.dimple),
    ]  # fmt: skip
    body = "".join(
        f'<tr><td style="color:{QUIET};padding-right:.8em;white-space:nowrap;vertical-align:top">{name}</td>'
        f"<td>{value}</td></tr>"
        for name, value in rows
    )
    told = " ".join(escape(sentence) for sentence in sentences) or "&nbsp;"
    data = {
        "tool": escape(tool, quote=True), "contact": int(now.contact), "slip": int(now.slipping),
        "force": f"{now.force:.6f}", "depth": f"{depth:.7f}", "ticks": int(s["ticks"]),
        "missed": int(s["missed"]), "moves": moves, "slipped": int(s["slip_ticks"]),
    }  # fmt: skip
    attributes = " ".join(f'data-{name}="{value}"' for name, value in data.items())
    return (
        f'<div id="palpate" {attributes} style="font-size:12px;color:{INK};padding:.3em .7em">'
        f'<table style="border-spacing:0;line-height:1.5;font-variant-numeric:tabular-nums">{body}</table>'
        f'<div style="color:{MARK};min-height:1.5em">{told}</div></div>'
    )


def legend(name: str, unit: str, low: float, high: float, scale: str, depth: float | None) -> str:
    """HTML: the colours of a map, low to high."""
    at = "" if depth is None else f" at {1e3 * depth:.1f} mm"
    return (
        f'<div style="font-size:12px;color:{INK};padding:.3em .7em">{escape(name)}{at}'
        f'<div style="height:10px;border-radius:3px;background:{gradient(scale)}"></div>'
        f'<div style="display:flex;justify-content:space-between">'
        f"<span>{low:.4g} {unit}</span><span>{high:.4g} {unit}</span></div></div>"
    )


def _joule(energy: float) -> str:
    size = abs(float(energy))
    for factor, unit in ((1e3, "mJ"), (1e6, "uJ")):
        if size * factor >= 0.1:
            return f"{factor * energy:.3f} {unit}"
    return f"{1e9 * energy:.1f} nJ"
