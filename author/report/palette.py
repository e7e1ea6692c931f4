# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Colours of the report, safe for colour-blind eyes: Okabe and Ito (2008) for kinds, viridis and magma for amounts."""

from __future__ import annotations

__all__ = [
    "ERRORS",
    "ERROR_KINDS",
    "FEM",
    "HUMS",
    "INK",
    "MARK",
    "NODES",
    "ORGAN",
    "QUIET",
    "REACH",
    "RENDERED",
    "STEADY",
    "VALUES",
]

INK = "#22252a"
QUIET = "#9a9a94"
FEM = "#22252a"
RENDERED = "#0072b2"
MARK = "#b04a00"
NODES = {"seed": "#22252a", "region": "#e58fc0", "error": "#ffffff", "unknown": "#22252a"}
"""By why a node is there (node_origins.py); on a surface of any colour, with a rim of the other lightness."""
ORGAN = "#d8cfc4"
REACH = "#e9dcc3"

VALUES = "viridis"
"""Colour scale of what the field says."""
ERRORS = "magma_r"
"""Colour scale of errors: pale where small, dark where large."""
STEADY, HUMS = ("#dcefe6", "#56b392"), ("#d55e00", "#5c1600")
"""First and last colour of stiffness that a device takes, and of stiffness at which it hums."""

ERROR_KINDS = {
    "force_error": ("normal force", RENDERED, "solid"),
    "lateral_error": ("lateral push", "#009e73", "dash"),
    "stuck_error": ("after a sticking move", "#cc79a7", "dashdot"),
    "slid_error": ("after sliding", "#e69f00", "longdash"),
}
"""Name, colour and dash of each kind of held-out error."""
