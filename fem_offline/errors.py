# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a bad surface, mesh or support is refused with: one sentence saying what, where, and what would be right."""

from __future__ import annotations

__all__ = ["MeshError", "SupportError", "SurfaceError", "ToolError"]


class _Refusal(ValueError):
    """Attributes: what (str), where (str; file, part or place), expected (str; what would be right)."""

    def __init__(self, what: str, where: str = "", expected: str = "") -> None:
        self.what = what
        self.where = where
        self.expected = expected
        sentence = f"{where}: {what}" if where else what
        super().__init__(f"{sentence}; expected {expected}" if expected else sentence)


class SurfaceError(_Refusal):
    """The organ's surface cannot be used as it is."""


class MeshError(_Refusal):
    """No tetrahedral mesh of the required quality came out."""


class SupportError(_Refusal):
    """Nothing holds the organ: a press would push it away."""


class ToolError(_Refusal):
    """A tool's mesh cannot be used as it is."""
