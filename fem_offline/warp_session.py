# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Warp, started once and quietly in each process, with a kernel cache that processes do not fight over.

Two processes that compile into one cache folder at the same time can read each other's half-written files, so
every worker gets a folder of its own (PALPATE_WARP_CACHE, set by the executor); it is kept between runs.
"""

from __future__ import annotations

import os

import warp as wp

__all__ = ["devices", "start_warp"]

_started = False


def start_warp() -> None:
    """Initialise Warp on first call; later calls do nothing."""
    global _started
    if _started:
        return
    folder = os.environ.get("PALPATE_WARP_CACHE")
    if folder:
        wp.config.kernel_cache_dir = folder
    if hasattr(wp, "LOG_ERROR"):
        wp.config.log_level = wp.LOG_ERROR
    else:  # older Warp
        wp.config.quiet = True
    wp.init()
    _started = True


def devices() -> tuple[str, ...]:
    """Names of this machine's devices; "cpu" is the first."""
    start_warp()
    return tuple(str(device) for device in wp.get_devices())
