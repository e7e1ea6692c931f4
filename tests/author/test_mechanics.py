# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A kept press must not survive a change of any module that made it."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from importlib.resources import files

import pytest

from palpate.author import mechanics

IMPORT_ALL = """
import json, sys
from palpate.author.mechanics import ROOTS
for root in ROOTS:
    __import__(f"palpate.fem_offline.{root}")
prefix = "palpate.fem_offline."
print(json.dumps([name.removeprefix(prefix) for name in sys.modules if name.startswith(prefix)]))
"""


def test_every_module_that_python_loads_for_a_press_counts() -> None:
    ended = subprocess.run([sys.executable, "-c", IMPORT_ALL], capture_output=True, text=True, check=True)
    loaded = set(json.loads(ended.stdout.splitlines()[-1]))
    assert len(loaded) > 10
    assert loaded <= set(mechanics.mechanics_modules())


def test_every_module_that_a_worker_names_counts() -> None:
    tree = ast.parse((files("palpate.author") / "press_solve.py").read_text())
    named = set(mechanics._imported(tree))
    assert named and named <= {*mechanics.mechanics_modules(), *mechanics.KEYED_APART}


@pytest.mark.parametrize("name", mechanics.KEYED_APART)
def test_what_a_module_that_is_keyed_apart_imports_counts_for_every_press(name: str) -> None:
    assert set(mechanics._imported(mechanics._tree(name))) <= set(mechanics.mechanics_modules())


@pytest.mark.parametrize("name", mechanics.mechanics_modules())
def test_a_changed_statement_changes_the_version_and_a_comment_does_not(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    original, before = mechanics._tree, mechanics.mechanics_version()
    source = (files("palpate.fem_offline") / f"{name}.py").read_text()
    for text, same in ((source + "\n# a comment\n", True), (source + "\nCHANGED = 1\n", False)):
        changed = ast.parse(text)
        monkeypatch.setattr(mechanics, "_tree", lambda n, c=changed: c if n == name else original(n))
        assert (mechanics.mechanics_version.__wrapped__() == before) is same
