# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures show all of their words, with units, and no legend lies over a curve."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from palpate.author.texture.drag import Drag
from palpate.author.texture.drag_picture import drag_picture
from palpate.author.transients.identification import DeviceModel, empirical_transfer, sweep
from palpate.author.transients.library import Library
from palpate.author.transients.pictures import (
    accelerations_picture,
    bode_picture,
    library_picture,
    spectra_picture,
    transient_picture,
)
from palpate.author.transients.stylus import Stylus
from palpate.author.transients.tap import swept

RATE = 1e4
TIME = np.arange(1000) / RATE
VELOCITY = np.array([0.05, 0.1, 0.15, 0.2])
RING = np.sin(2 * np.pi * 130.0 * TIME) * np.exp(-TIME / 0.01)
FORCE = 40.0 * VELOCITY[:, None] * RING
SAMPLES = {
    name: size * RING
    for kind in ("firm", "soft")
    for name, size in ((f"{kind}_matched", 19.0), (f"{kind}_sinusoid", 9.0), (f"{kind}_proportional", 2.0))
} | {"wood_on_foam": 20.0 * RING, "wood": 100.0 * RING}
RESULT = {
    "target": "wood_on_foam",
    "rate": RATE,
    "drawn_velocity": 0.11,
    "curves": SAMPLES,
    "rows": [{"sample": name, "spectrum_error_mean": 0.04} for name in SAMPLES],
}


def bode(path: Path) -> None:
    force = sweep(0.5, RATE)
    measured = empirical_transfer(force, swept(Stylus(), force), RATE)
    w = 2.0 * np.pi * 130.0
    bode_picture(
        measured, DeviceModel(np.array([10.0, 0.0, 0.0]), np.array([1.0, 0.2 * w, w**2]), 2.5e-4), path
    )


def dragged(path: Path) -> None:
    along = 0.16 * np.sin(2 * np.pi * 16.0 * np.arange(1000) / 1e3)
    frequency = np.linspace(0.0, 500.0, 5000)
    spectrum = 0.16 * np.exp(-((frequency - 16.0) ** 2))
    drag_picture(
        Drag(np.arange(1000) / 1e3, along, 0 * along, frequency, spectrum, 1.25e-3, 0.02, 2.5e-3, 1.6, 0.16),
        path,
    )


PICTURES: dict[str, Callable[[Path], None]] = {
    "bode": bode,
    "library": lambda path: library_picture(Library(RATE, VELOCITY, FORCE), path),
    "transient": lambda path: transient_picture(RATE, VELOCITY, FORCE, path),
    "spectra": lambda path: spectra_picture(RESULT, path),
    "accelerations": lambda path: accelerations_picture(RESULT, path),
    "drag": dragged,
}


@pytest.mark.parametrize("name", PICTURES)
def test_all_words_are_whole_and_nothing_lies_under_a_legend(name: str, tmp_path: Path, monkeypatch) -> None:
    drawn: list[Figure] = []
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda self, *a, **k: (drawn.append(self), save(self, *a, **k))[1])
    PICTURES[name](tmp_path / f"{name}.png")
    (figure,) = drawn
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    page = figure.bbox
    words = [
        w for axis in figure.axes for w in (axis.xaxis.label, axis.yaxis.label, axis.title, axis._left_title)
    ]
    words += [figure._supylabel] if figure._supylabel else []
    for word in words:
        if word.get_visible() and word.get_text():
            box = word.get_window_extent(renderer)
            assert page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1, word
    assert figure._supylabel or all("[" in axis.get_ylabel() for axis in figure.axes)
    assert "[" in figure.axes[-1].get_xlabel()
    for axis in figure.axes:
        if axis.get_legend() is None:
            continue
        box = axis.get_legend().get_window_extent(renderer)
        for line in axis.lines:
            if line.get_transform() != axis.transData:
                continue  # a line across the whole picture
            at = axis.transData.transform(np.column_stack(line.get_data()))
            inside = [xy for xy in at[:: max(1, len(at) // 2000)] if box.contains(*xy)]
            assert not inside, line.get_label()
