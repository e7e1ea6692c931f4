# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The deck of a pressed layer: its mesh is what it says, and a shallow press is the integral equation's."""

import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.verification.bonded_layer import BondedLayer
from palpate.fem_offline.verification.calculix_layer import (
    DeckSettings,
    LayerPress,
    calculix_force,
    layer_deck,
)

PRESS = LayerPress(5e-3, 15e-3, 60e-3, NeoHookean(5400.0, 0.48), (1e-3, 3e-3))


def block_of(deck: str, keyword: str) -> np.ndarray:
    """Numbers under the card that starts with `keyword`."""
    text = re.search(rf"^{re.escape(keyword)}[^\n]*\n((?:[^*][^\n]*\n)+)", deck, re.MULTILINE)[1]
    return np.array([[float(x) for x in line.rstrip(",").split(",")] for line in text.splitlines()])


def test_elements_are_counterclockwise_and_fill_the_disc():
    deck = layer_deck(PRESS)
    places = {int(n): (x, y) for n, x, y, _ in block_of(deck, "*NODE")}
    for name, area in (("DISC", 12.0 * 3.0), ("BALL", None)):
        corners = np.array(
            [[places[int(n)] for n in e[1:5]] for e in block_of(deck, f"*ELEMENT, TYPE=CAX8R, ELSET={name}")]
        )
        x, y = corners[..., 0], corners[..., 1]
        areas = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
        assert areas.min() > 0.0
        assert area is None or areas.sum() == pytest.approx(area)


def test_the_two_surfaces_face_each_other():
    deck = layer_deck(PRESS)
    places = {int(n): (x, y) for n, x, y, _ in block_of(deck, "*NODE")}
    elements = {
        int(e[0]): e[1:].astype(int)
        for name in ("DISC", "BALL")
        for e in block_of(deck, f"*ELEMENT, TYPE=CAX8R, ELSET={name}")
    }

    def mids(name: str) -> np.ndarray:  # S1 is the side between corners 1 and 2, S3 that between 3 and 4
        text = re.search(rf"\*SURFACE, NAME={name}[^\n]*\n((?:\d+, S\d\n)+)", deck)[1]
        pairs = [line.split(", S") for line in text.splitlines()]
        return np.array([places[elements[int(k)][3 + int(side)]] for k, side in pairs])

    soft, hard = mids("SOFT"), mids("HARD")
    assert soft[:, 1] == pytest.approx(0.0)
    assert np.hypot(hard[:, 0], hard[:, 1] - 1.0) == pytest.approx(1.0)
    assert soft[:, 0].max() > np.sqrt(0.6) * 1.4 and hard[:, 0].max() > 0.9


def test_each_depth_is_a_step_of_its_own():
    deck = layer_deck(replace(PRESS, friction=0.3), DeckSettings(step=0.1))
    assert deck.count("*END STEP") == 2
    assert [float(x) for x in re.findall(r"TOOL, 2, 2, (\S+)", deck)] == pytest.approx([-0.2, -0.6])
    assert [float(x) for x in re.findall(r"\*STATIC\n(\S+),", deck)] == pytest.approx([0.5, 0.25])
    assert "*FRICTION" in deck


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="needs ccx (Debian: calculix-ccx)")
def test_calculix_and_the_integral_equation_agree_on_a_shallow_press():
    a = np.sqrt(5e-3 * 5e-6)
    press = LayerPress(5e-3, 2.0 * a, 12.0 * a, NeoHookean(5400.0, 0.48), (5e-6,))
    found = calculix_force(press, DeckSettings(edges=16, penalty=3000.0, step=2e-4))
    assert found[0] == pytest.approx(BondedLayer(5400.0, 0.48, 2.0 * a).sphere(5e-3, 5e-6).force, rel=0.01)
