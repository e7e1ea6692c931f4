# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The meaning of the mechanics' source: a press is kept for one text of it only.

Every module of `fem_offline` counts that the ROOTS import, directly or by way of others; comments, docstrings and
layout do not.
"""

from __future__ import annotations

import ast
from functools import cache
from importlib.resources import files

from palpate.author.scene_types import digest

__all__ = ["KEYED_APART", "ROOTS", "mechanics_modules", "mechanics_version", "module_meaning"]

PACKAGE = "palpate.fem_offline"
KEYED_APART = ("surface_displacement",)
"""Modules that only presses with some effects use; their text is in those presses' keys alone (press_jobs.py)."""
ROOTS = ("deformed", "dragging", "far_field", "membrane", "patch", "press", "signed_distance", "site", "tool")
"""What a worker imports to press, and what lays the organ's surface."""


@cache
def mechanics_version() -> str:
    """Hex digest of the mechanics' source."""
    return digest({name: ast.dump(_meaning(_tree(name))) for name in mechanics_modules()})


@cache
def module_meaning(name: str) -> str:
    """Hex digest of one module's source, for what only some presses keep."""
    return digest(ast.dump(_meaning(_tree(name))))


@cache
def mechanics_modules() -> tuple[str, ...]:
    """Modules of `fem_offline` whose text decides what a press finds, in alphabetical order."""
    found: set[str] = set()
    waiting = list(ROOTS)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += _imported(_tree(name))
    return tuple(sorted(found))


def _tree(name: str) -> ast.Module:
    return ast.parse((files(PACKAGE) / f"{name}.py").read_text())


def _imported(tree: ast.Module) -> list[str]:
    """Modules of the package that a module names, wherever in it the import stands."""
    names = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    own = [name.removeprefix(f"{PACKAGE}.") for name in names if name.startswith(f"{PACKAGE}.")]
    return [name for name in own if (files(PACKAGE) / f"{name}.py").is_file()]


def _meaning(tree: ast.Module) -> ast.Module:
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [  # type: ignore[attr-defined]
                n for n in body if not (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))
            ]
    return tree
