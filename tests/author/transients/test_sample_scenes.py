# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The study's eleven samples are legal scenes that this version can author, with the paper's numbers in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from palpate.author.capabilities import require_capabilities
from palpate.author.scene import Scene, load_scene
from palpate.author.transients import sample_scenes
from palpate.author.transients.library import Library
from palpate.author.transients.sample_scenes import BLOCK, STIFFNESS, TIP, write_sample_scenes
from palpate.author.transients.samples import SAMPLES, Rendering
from palpate.author.transients.transient_stage import transients_of
from palpate.fields.transient_layout import read_transient_layer


@pytest.fixture
def scenes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Scene]:
    """With libraries that took no time to record."""
    force = np.outer([0.1, 0.4], np.hanning(100))
    monkeypatch.setattr(sample_scenes, "identified", lambda stylus: None)
    monkeypatch.setattr(
        sample_scenes,
        "recorded_library",
        lambda stylus, model, stiffness: Library(1e4, np.array([0.05, 0.2]), force),
    )
    return {path.stem: load_scene(path) for path in write_sample_scenes(tmp_path)}


def test_all_eleven_can_be_authored_and_play_what_the_study_played(scenes: dict[str, Scene]) -> None:
    assert list(scenes) == list(SAMPLES) and len(scenes) == 11
    for name, scene in scenes.items():
        require_capabilities(scene)
        made = transients_of(scene, scene.tool[0])
        sample = SAMPLES[name]
        plays = isinstance(sample, Rendering) and sample.transient != "none"
        assert (made is not None) == plays
        if made is not None:
            layer = read_transient_layer(made[0])
            assert layer.numbers["force_short"] == 8.5 and layer.numbers["force_steady"] == 1.4
            assert layer.numbers["attenuation"] == 1.0  # libraries were made beside the response
    pulse = transients_of(scenes["firm_pulse"], scenes["firm_pulse"].tool[0])
    assert pulse is not None
    assert read_transient_layer(pulse[0]).force.max() == pytest.approx(5.7 * 0.5)


def test_a_flat_tip_feels_the_paper_s_stiffness(scenes: dict[str, Scene]) -> None:
    for name, scene in scenes.items():
        material = scene.organ.material
        assert material.youngs_modulus is not None
        sample = SAMPLES[name]
        stiffness = sample.stiffness if isinstance(sample, Rendering) else STIFFNESS[name]
        if name == "wood_on_foam":  # a column of foam under the board
            assert material.youngs_modulus * 0.06**2 / 0.05 == pytest.approx(stiffness, rel=1e-4)
        else:
            found = BLOCK * 2 * TIP * material.youngs_modulus / (1 - material.poissons_ratio**2)
            assert found == pytest.approx(stiffness, rel=1e-4)
