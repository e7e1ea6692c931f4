# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What can go wrong, said once, and the only place that maps an exception to an exit code.

0 done; 1 done, but a stated tolerance is not met; 2 the input is wrong; 3 a bug or the machine.
130 is the shell's own code for an interrupt (128 + SIGINT).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any
from zipfile import BadZipFile

from palpate.fem_offline.errors import MeshError, SupportError, SurfaceError, ToolError
from palpate.fields.field_error import FieldError
from palpate.runtime.library import RuntimeFailure

__all__ = [
    "UNREADABLE",
    "InputError",
    "InputProblem",
    "Interrupted",
    "PalpateError",
    "ToleranceNotMet",
    "exit_code",
    "problems_of",
]

UNREADABLE = (OSError, ValueError, TypeError, LookupError, EOFError, BadZipFile)
"""What NumPy and SciPy raise where a table, an archive or a sound file is none."""
_REFUSALS = (SurfaceError, MeshError, SupportError, ToolError, FieldError)
"""How the rooms below, which cannot import this one, refuse an input."""
_REFUSED_FIELD = range(4, 14)
"""Those palpate_status values that say that an .rfield is damaged, of another version, or has what this runtime has not
(palpate.h)."""


@dataclass(frozen=True)
class InputProblem:
    """One thing that is wrong with an input.

    Attributes:
        file: the file as the user named it; "" for a command-line argument.
        key: dotted path with indices, such as "tool[1].radius"; "" where the whole file is meant.
        value: what stands there; None where nothing does.
        what: a clause that says what is wrong, to be read after "file: key = value".
        expected: what would be right, with its unit.
        introduced_by: the word before it.
    """

    file: str
    key: str
    value: Any
    what: str
    expected: str = ""
    introduced_by: str = "expected"

    @property
    def sentence(self) -> str:
        where = ": ".join(part for part in (self.file, self.key) if part)
        value = "" if self.value is None else f" = {_shown(self.value)}"
        head = f"{where}{value} " if where or value else ""
        return f"{head}{self.what}" + (f"; {self.introduced_by} {self.expected}" if self.expected else "")

    def as_json(self) -> dict[str, Any]:
        value = (
            self.value if isinstance(self.value, (str, int, float, bool, type(None))) else _shown(self.value)
        )
        return {
            "file": self.file,
            "key": self.key,
            "value": value,
            "what": self.what,
            "expected": self.expected,
            "sentence": self.sentence,
        }


class PalpateError(Exception):
    """Something that this project noticed itself: the machine is at fault, or a promise is broken."""

    exit_code = 3


class InputError(PalpateError):
    """The input is wrong; `problems` holds every problem found, at least one."""

    exit_code = 2

    def __init__(self, problems: InputProblem | Iterable[InputProblem]) -> None:
        self.problems = (problems,) if isinstance(problems, InputProblem) else tuple(problems)
        super().__init__("\n".join(problem.sentence for problem in self.problems))


class ToleranceNotMet(PalpateError):
    """The work is done and its result is there, but a stated tolerance is not met."""

    exit_code = 1


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, after what was finished has been kept; the text says how much that is."""


def exit_code(error: BaseException) -> int:
    """The exit code of a command that ended with `error`."""
    if isinstance(error, PalpateError):
        return error.exit_code
    if isinstance(error, KeyboardInterrupt):
        return 130
    if isinstance(error, RuntimeFailure):
        return 2 if error.status in _REFUSED_FIELD else 3
    return 2 if isinstance(error, _REFUSALS) else 3


def problems_of(error: BaseException) -> tuple[InputProblem, ...]:
    """What an error with exit code 2 says about the input, in order."""
    if isinstance(error, InputError):
        return error.problems
    what = getattr(error, "what", str(error))
    return (InputProblem(getattr(error, "where", ""), "", None, what, getattr(error, "expected", "")),)


def _shown(value: Any) -> str:
    text = f'"{value}"' if isinstance(value, str) else str(value)
    return text if len(text) <= 80 else text[:77] + "..."
