# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from palpate.fem_offline.equilibrium import equilibrate
from palpate.fem_offline.friction_share import friction_share, share_along
from palpate.fem_offline.ladder import DEFAULT_SETTINGS, Ladder
from palpate.fem_offline.press import press
from palpate.fem_offline.site import patch_size
from palpate.fem_offline.tool import tangents
from tests.fem_offline.test_dragging import AHEAD, TOOL, Plane, small_site

DEPTH = 2e-3


def site_of(tool, nu=0.4):
    size = patch_size(TOOL, DEPTH, radius=1.0)
    return small_site(tool, replace(size, finest=1.7e-3, core=3.5e-3, growth=1.0), nu)


@pytest.fixture(scope="module")
def site():
    return site_of(TOOL)


@pytest.fixture(scope="module")
def pressed(site):
    ladder = Ladder.above(site, TOOL, DEFAULT_SETTINGS, DEPTH)
    return ladder, ladder.go_to(DEPTH)


def test_a_flat_tool_feels_the_coefficient_itself():
    plane = Plane()
    site = site_of(plane)
    ladder = Ladder.above(site, plane, DEFAULT_SETTINGS, 0.5e-3)
    found = ladder.go_to(0.5e-3)
    assert friction_share(site, found, ladder.contact, DEFAULT_SETTINGS) == pytest.approx(1.0, abs=1e-9)


class Pulled:
    """Contact and a dead load (N, 3) N on the tissue."""

    def __init__(self, contact, load):
        self.contact, self.load = contact, load

    def state(self, u):
        touch = self.contact.state(u)
        energy = touch.energy - float(np.sum(self.load * u))
        return replace(touch, energy=energy, gradient=touch.gradient - self.load)

    def hessian(self, u, geometric):
        return self.contact.hessian(u, geometric)


def test_it_is_the_slope_of_equilibria_under_a_growing_pull(site, pressed):
    """Friction as a load that grows by itself, with the multipliers held: what the tool then feels along it."""
    ladder, found = pressed
    contact = ladder.contact
    pressure = np.linalg.norm(found.contact.traction, axis=2)
    normal, _ = contact.give(found.u, pressure)
    along = AHEAD - (normal @ AHEAD)[:, :, None] * normal
    pull = pressure[:, :, None] * along / np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
    load, own = site.surface.nodal(pull, len(found.u)), np.einsum("bq,bqi->i", site.surface.weight, pull)
    step, pushes = 2e-3, []
    for sign in (1.0, -1.0):
        end = equilibrate(site.body, Pulled(contact, sign * step * load), found.u, 1e-10, ladder.force_floor)
        pushes.append(end.contact.force)
    slope = (-(pushes[0] - pushes[1]) / (2.0 * step) + own) @ AHEAD / found.contact.force[2]
    held = replace(DEFAULT_SETTINGS, updates=0)
    assert share_along(site, found, contact, held, AHEAD) == pytest.approx(slope, abs=2e-3)
    assert abs(slope - 1.0) > 0.1  # not the trivial answer


def test_both_ways_along_a_tangent_have_the_same(site, pressed):
    ladder, found = pressed
    one, other = (
        share_along(site, found, ladder.contact, DEFAULT_SETTINGS, sign * AHEAD) for sign in (1.0, -1.0)
    )
    assert one == pytest.approx(other, rel=1e-3)


def test_a_press_has_it_where_it_has_a_stiffness(site, pressed):
    ladder, found = pressed
    record = press(site, TOOL, np.array([1e-3, 1.5e-3, DEPTH]))
    share = record.friction_share
    alone = press(site, TOOL, np.array([DEPTH])).friction_share
    assert share[0] == 1.0 and (np.isnan(share) == np.isnan(record.sticking_stiffness[:, 0, 0])).all()
    mean = np.mean(
        [share_along(site, found, ladder.contact, DEFAULT_SETTINGS, e) for e in tangents(site.normal)]
    )
    assert alone[-1] == pytest.approx(mean, rel=1e-3)
    with_friction = press(site, TOOL, np.array([1e-3]), friction=0.3)
    assert np.isnan(with_friction.friction_share[1:]).all()
