# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a field with transients tells, draws and sounds what is stored; one without says nothing of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image
from scipy.io import wavfile
from synthetic_field import small_plane, tapped_plane

from palpate.author.report.transient_part import draw_transient, transient_row


def test_a_report_tells_draws_and_sounds_the_transients(tmp_path: Path) -> None:
    field = tapped_plane()
    row = transient_row(field)
    assert row is not None
    assert row["velocity"] == [0.05, 0.20] and row["velocity_count"] == 3 and not row["limited"]
    assert row["duration"] == 2e-3
    (picture,) = draw_transient(tmp_path, field, row, "")
    assert picture["file"] == row["picture"] == "transient.png"
    pixels = np.asarray(Image.open(tmp_path / "transient.png").convert("RGB"))
    assert np.unique(pixels.reshape(-1, 3), axis=0).shape[0] > 50  # lines, not an empty frame
    rate, sound = wavfile.read(tmp_path / row["sound"])
    assert rate == 44100 and abs(sound.astype(int)).max() == 30000
    spectrum = abs(np.fft.rfft(sound.astype(float)))
    loudest = np.fft.rfftfreq(len(sound), 1 / rate)[np.argmax(spectrum)]
    assert 50.0 < loudest < 700.0  # the stylus' resonance or the transient's 500 Hz


def test_a_field_without_transients_has_no_such_part() -> None:
    assert transient_row(small_plane()) is None
