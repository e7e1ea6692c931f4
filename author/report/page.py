# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The page itself: template, style, scripts and figures in one file that loads nothing."""

from __future__ import annotations

import base64
import io
import json
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape
from plotly.offline import get_plotlyjs

from palpate.author.report.numbers import written

__all__ = ["Numbers", "page"]

_HERE = Path(__file__).parent


WIDTH, QUALITY = 1100, 82
"""Pixels and WebP quality of pictures inside the page; beside it they lie as they were drawn."""
APART = ("worst_curves",)
"""Pictures that the page draws itself."""


def page(report: dict[str, Any], figures: list[dict[str, Any]], folder: Path | None = None) -> str:
    """The page as text.

    Args:
        report: JSON-clean, as in report.json.
        figures: one dict per tool.
        folder: where the report's pictures lie, that the page carries too.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("template.html").render(
        report=report,
        value=Numbers(report),
        style=Markup((_HERE / "style.css").read_text(encoding="utf-8")),
        script=Markup((_HERE / "view.js").read_text(encoding="utf-8")),
        plotly=Markup(get_plotlyjs()),
        images=_images(report, folder),
        sounds=_sounds(report, folder),
        figures=[{name: _script_json(figure) for name, figure in one.items()} for one in figures],
    )


def _images(report: dict[str, Any], folder: Path | None) -> dict[str, Markup]:
    """File name -> data address, of the pictures that the page shows."""
    from PIL import Image

    out: dict[str, Markup] = {}
    for picture in report["pictures"] if folder else []:
        if picture["file"].startswith(APART):
            continue
        with Image.open(folder / picture["file"]) as drawn:
            image = drawn.convert("RGB")
        if image.width > WIDTH:
            image = image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.Resampling.LANCZOS)
        packed = io.BytesIO()
        image.save(packed, "WEBP", quality=QUALITY, method=6)
        code = base64.b64encode(packed.getvalue()).decode()
        out[picture["file"]] = Markup(f"data:image/webp;base64,{code}")
    return out


def _sounds(report: dict[str, Any], folder: Path | None) -> dict[str, Markup]:
    """File name -> data address, of the sounds that the page plays."""
    names = [(tool.get("transient") or {}).get("sound") for tool in report["tools"]] if folder else []
    return {
        name: Markup(f"data:audio/wav;base64,{base64.b64encode((folder / name).read_bytes()).decode()}")
        for name in names
        if name and folder
    }


class Numbers:
    """Writes values of the report by their path in report.json, which the page keeps beside each of them."""

    def __init__(self, report: dict[str, Any]) -> None:
        self._report = report

    def __call__(self, path: str, kind: str = "text") -> Markup:
        """`path`: keys and indices joined by "/"; what is absent on the way is written as absent."""
        found: Any = self._report
        for key in path.split("/"):
            if isinstance(found, list):
                found = found[int(key)]
            else:
                found = None if found is None else found.get(key)
        return Markup('<span data-path="{}" data-kind="{}">{}</span>').format(
            path, kind, escape(written(found, kind))
        )


def _script_json(value: Any) -> Markup | None:
    """JSON that may stand inside a script element."""
    if value is None:
        return None
    text = value if isinstance(value, str) else json.dumps(value, allow_nan=False)
    return Markup(text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))
