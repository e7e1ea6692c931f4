# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report of an authored asset: one page that works offline, its JSON twin, and pictures.

Every number on the page is read from the twin (report.json), so that what people read and what programs read
cannot differ.  The page draws with plotly's own JavaScript, embedded once; it loads nothing from any network.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["write_report"]


def write_report(asset: Path, summary: dict[str, Any]) -> Path:
    """Writes <asset>/report/: index.html, report.json, organ.png, stiffness_map.png and, where
    presses were held out, error_map.png and worst_curves.png; with a device, device_map.png.

    Args:
        asset: folder of a USD asset; <asset>/validation/<tool>.json is read where it exists.
        summary: the JSON dict of `palpate author`; every key is optional.

    Returns:
        path of index.html.

    Raises:
        FieldError: the asset cannot be read.
        OSError: a file cannot be written.
    """
    from palpate.author.report.write import write

    return write(Path(asset), summary)
