# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The error of this room: one sentence that says what is wrong, where, and what would be right."""

from __future__ import annotations

__all__ = ["FieldError"]


class FieldError(ValueError):
    """A response field, an organ geometry or an asset that breaks its contract."""
