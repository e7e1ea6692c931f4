# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.materials import MODELS

R = 5e-3


def pressed(material, depths):
    """A thin bonded layer, coarse: 3,800 unknowns."""
    organ = block_organ((0.024, 0.024, 0.0065), (4, 4, 1), {0: material})
    size = patch_size(Sphere(R), depths[-1], radius=0.1, refinement=0.6)
    return press(open_site(organ, np.zeros(3), Sphere(R), size), Sphere(R), depths)


def work(depth, force):
    """Integral of the force: a spline through ln f over ln d, and f ~ d^1.5 up to the first depth."""
    x = np.linspace(depth[0], depth[-1], 2001)
    return force[0] * depth[0] / 2.5 + np.trapezoid(
        np.exp(CubicSpline(np.log(depth), np.log(force))(np.log(x))), x
    )


@pytest.mark.parametrize(
    "name", [n if n == "Ogden, three terms" else pytest.param(n, marks=pytest.mark.slow) for n in MODELS]
)
def test_every_material_is_pressed(name):
    record = pressed(MODELS[name], R * np.arange(0.05, 0.41, 0.05))
    assert record.converged, record.reason
    assert record.reaction_error.max() < 1e-8
    assert record.energy[-1] == pytest.approx(work(record.depth[1:], record.force[1:]), rel=0.02)
