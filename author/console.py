# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How a command answers: one answer on stdout, everything else on stderr, one exit code.

Mesh and solver libraries print to the process's own standard output.  While a command works, file descriptor
1 is therefore standard error, for Python and native code alike; the answer is written after it is put back.
"""

from __future__ import annotations

import errno
import json
import math
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rich.console import Console, RenderableType
from rich.table import Table

from palpate.author.errors import exit_code, problems_of

__all__ = ["Answer", "answer_of", "plain", "table_of"]

GO_ON = "Interrupted. Every finished press is kept."
REFUSED = frozenset(
    {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EACCES, errno.EPERM}
    | {errno.ENOTDIR, errno.EISDIR, errno.EEXIST}
)
"""What the system says when a folder takes no more, never did, or is a file."""


@dataclass(frozen=True)
class Answer:
    """What a command has found.

    Attributes:
        result: what --json prints, after `plain`.
        shown: what people see instead: text or anything that rich renders.
        exit_code: 0; 1 when a stated tolerance is not met.
    """

    result: dict[str, Any]
    shown: list[RenderableType] = field(default_factory=list)
    exit_code: int = 0


def answer_of(work: Callable[[], Answer], as_json: bool, command: str = "") -> int:
    """Does the work, answers on stdout, tells errors on stderr; gives the exit code.

    Args:
        command: what was typed; after an interrupt it goes on from there.
    """
    result: dict[str, Any]
    with _stdout_is_stderr():
        try:
            answer = work()
            result, shown, code = answer.result, answer.shown, answer.exit_code
        except (Exception, KeyboardInterrupt) as error:
            code, shown = exit_code(error), []
            result = _told(error, code, command)
    if as_json:
        print(json.dumps(plain(result), allow_nan=False))
    else:
        out = Console(soft_wrap=True, markup=False, highlight=False)  # names may hold [brackets]
        for part in shown:
            out.print(part)
    sys.stdout.flush()
    return code


def plain(value: Any) -> Any:
    """`value` as JSON knows it: arrays become lists, paths texts, numbers that are not finite null."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)


def table_of(*columns: str) -> Table:
    """An empty table without a frame; its rows may be copied and pasted."""
    return Table(*columns, box=None, pad_edge=False, padding=(0, 2, 0, 0))


def _told(error: BaseException, code: int, command: str) -> dict[str, Any]:
    """Tells `error` on stderr; gives what --json says about it."""
    if isinstance(error, KeyboardInterrupt):
        sentence = str(error) or GO_ON
        if command:
            sentence += f" The same command goes on from there: {command}"
        print(sentence, file=sys.stderr)
        return {"error": {"exit_code": code, "sentence": sentence}}
    if code == 2:
        problems = problems_of(error)
        for problem in problems:
            print(f"palpate: {problem.sentence}", file=sys.stderr)
        return {"error": {"exit_code": code, "problems": [problem.as_json() for problem in problems]}}
    sentence = f"{type(error).__name__}: {error}"
    if isinstance(error, OSError) and error.errno in REFUSED:
        where = error.filename or "a file"
        sentence = f"{where}: {error.strerror}; what was finished before is still there"
        print(f"palpate: {sentence}", file=sys.stderr)
    elif type(error).__module__.startswith("palpate."):
        print(f"palpate: {error}", file=sys.stderr)
    else:
        traceback.print_exception(error, file=sys.stderr)
        print(f"palpate: this is a bug or the machine: {sentence}", file=sys.stderr)
    return {"error": {"exit_code": code, "sentence": sentence}}


@contextmanager
def _stdout_is_stderr() -> Iterator[None]:
    sys.stdout.flush()
    python_stdout, native_stdout = sys.stdout, os.dup(1)
    try:
        os.dup2(2, 1)
        sys.stdout = sys.stderr
        yield
    finally:
        sys.stdout = python_stdout
        os.dup2(native_stdout, 1)
        os.close(native_stdout)
