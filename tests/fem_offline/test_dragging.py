# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from palpate.fem_offline.dragging import DragSettings, drag
from palpate.fem_offline.equilibrium import equilibrate
from palpate.fem_offline.ladder import DEFAULT_SETTINGS, Ladder
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press, sticking, sticking_stiffness
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Footprint, Sphere, ToolDistance
from palpate.fem_offline.verification.blocks import block_organ

R, MU, DEPTH = 5e-3, 0.3, 2e-3
TOOL = Sphere(R)
AHEAD = np.array([1.0, 0.0, 0.0])


class Plane:
    """A rigid half space above the tool frame's z = 0."""

    def distance(self, points, pose):
        n = -pose.rotation[:, 2]
        gap = (points - pose.position) @ n
        return ToolDistance(gap, np.tile(n, (len(points), 1)), np.zeros((len(points), 3, 3)))

    def offset_along(self, direction):
        return 0.0

    def contact_size(self, depth, rotation=None):
        return 10e-3

    def contact_extent(self, depth, rotation=None):
        return 30e-3

    def footprint(self, depth, rotation=None):
        return Footprint(10e-3, 30e-3, np.zeros((1, 2)))

    def hash(self):
        return "plane"


def onto_the_block(x):
    """Projector to the nearest face of the block below."""
    low, high = np.array([-0.015, -0.015, -0.02]), np.array([0.015, 0.015, 0.0])
    away = np.abs(np.concatenate([x - low, x - high], axis=1))
    face = away.argmin(axis=1)
    on = np.clip(x, low, high)
    on[np.arange(len(x)), face % 3] = np.where(face < 3, low[face % 3], high[face % 3])
    return on, np.tile([0.0, 0.0, 1.0], (len(x), 1))


def small_site(tool, size, nu=0.4):
    """A block of a few tetrahedra, all of it patch."""
    organ = block_organ((0.03, 0.03, 0.02), (3, 3, 2), {0: NeoHookean(5400.0, nu)})
    return open_site(replace(organ, project=onto_the_block), np.zeros(3), tool, size)


@pytest.fixture(scope="module")
def site():
    size = patch_size(TOOL, DEPTH, radius=1.0)
    return small_site(TOOL, replace(size, finest=1.7e-3, core=3.5e-3, growth=1.0))


@pytest.fixture(scope="module")
def pressed(site):
    ladder = Ladder.above(site, TOOL, DEFAULT_SETTINGS, DEPTH, MU)
    return ladder, ladder.go_to(DEPTH)


@pytest.fixture(scope="module")
def record(site):
    return drag(site, TOOL, [1e-3, DEPTH], MU)


def test_a_block_under_a_sliding_plane_resists_with_mu_times_the_load():
    """Coulomb's law bounds friction at each point (test_coulomb.py: to rounding); the sum falls short by the points
    that do not slide in the last step or slide sideways: measured 2e-4 to 7e-4.  Those points are 0.4 to 1.1 % of the
    area, and which they are changes when the depth changes by 1e-12 of itself; a step before, all slid."""
    plane = Plane()
    # nu = 0: nothing spreads sideways as it is pressed, so that friction points straight back everywhere
    site = small_site(plane, replace(patch_size(plane, 1e-3, radius=1.0), finest=8e-3), nu=0.0)
    # the plane covers the block's top and ends with it: there is nothing around
    nothing = SimpleNamespace(
        deepest=lambda tool, pose, u: SimpleNamespace(gap=1.0), far_faces=np.zeros((0, 3, 3))
    )
    site = replace(site, surroundings=nothing)
    record = drag(site, plane, [0.4e-3], MU, distance=8e-3, dragging=DragSettings(give=(0.5, 1.0)))
    assert record.converged, record.reason
    assert record.effective[0, 0] == pytest.approx(MU, rel=1e-3)
    for path in record.paths:
        load = path.force_vector @ site.normal
        assert path.sliding[-2] > 0.999 and path.sliding[-1] > 0.98
        assert path.resistance[-1] == pytest.approx(MU * load[-1], rel=1e-3)


def test_both_ways_end_steadily_with_every_check_met(record):
    assert record.converged and record.reason == "" and len(record.paths) == 4
    for path in record.paths:
        assert path.steady and path.residual <= 1e-9 and path.reaction_error <= 1e-8
        assert path.sliding[-1] > 0.98 and (np.diff(path.sliding[:4]) > 0.0).all()


def test_friction_that_is_felt_is_near_the_coefficient_and_depends_on_depth(record):
    """A sphere ploughs: its pressure moves forward as it is dragged, by some percent of mu where it is deep."""
    assert record.effective[:, 0] / MU == pytest.approx(np.array([1.04, 1.08]), abs=0.05)
    ratio = record.effective.max() / record.effective.min() - 1.0
    assert record.spread == pytest.approx(ratio, rel=0.1)
    assert record.amontons == (record.spread <= DragSettings().amontons)


def test_the_tool_is_held_back_both_ways(record):
    for path in record.paths:
        assert path.resistance[-1] > 0.0 and path.force_vector[-1] @ record.normal > 0.0


def test_the_hand_pays_for_energy_and_dissipation(record):
    for path in record.paths:
        assert (np.diff(path.dissipation) >= 0.0).all() and path.dissipation[-1] > 0.0
        assert path.energy_error < 0.03


@pytest.mark.slow
def test_no_energy_comes_out_of_a_closed_drag(site, pressed):
    """There, back beyond, and home again, far enough to slide: the hand's work is rubbed away or still stored."""
    ladder, found = pressed
    home = ladder.contact.pose
    give = 1.3e-3
    corners = np.array([0.0, 1.0, -1.0, 0.0]) * give

    def path(way):
        return home.at(home.position + np.interp(way, [0.0, give, 3 * give, 4 * give], corners) * AHEAD)

    closed = ladder.turn(path)
    places, forces = [home.position], [found.contact.force]
    for way in give * np.linspace(0.0, 4.0, 25)[1:]:
        before = closed.dissipation
        end = closed.go_to(float(way))
        assert closed.dissipation >= before
        places.append(closed.contact.pose.position)
        forces.append(end.contact.force)
    mean = 0.5 * (np.array(forces)[1:] + np.array(forces)[:-1])
    work = -np.einsum("ki,ki->", mean, np.diff(places, axis=0))
    assert work > 0.0 and np.allclose(places[-1], home.position)
    assert work == pytest.approx(end.elastic.energy - found.elastic.energy + closed.dissipation, rel=0.05)


def test_a_first_small_move_meets_the_sticking_stiffness(site, pressed):
    """There and back again: what one more multiplier update does to the pressed state is the same both ways."""
    ladder, found = pressed
    K = sticking_stiffness(site, found, sticking(site, found, ladder.contact, DEFAULT_SETTINGS))
    home = ladder.contact.pose
    move = 2e-6
    there, back = (
        ladder.turn(lambda way, s=s: home.at(home.position + s * way * AHEAD)).go_to(move)
        for s in (1.0, -1.0)
    )
    slope = -(there.contact.force - back.contact.force) @ AHEAD / (2.0 * move)
    assert slope == pytest.approx(K[0, 0], rel=0.03)


def test_much_friction_is_sticking(site):
    ladder = Ladder.above(site, TOOL, DEFAULT_SETTINGS, DEPTH, 50.0)
    found = ladder.go_to(DEPTH)
    stuck = sticking(site, found, ladder.contact, DEFAULT_SETTINGS)
    stuck.translation = 0.3e-3 * AHEAD
    expected = equilibrate(site.body, stuck, found.u, 1e-9, 1e-6)
    home = ladder.contact.pose
    dragged = ladder.turn(lambda way: home.at(home.position + way * AHEAD))
    moved = dragged.go_to(0.3e-3)
    assert dragged.check.sliding < 0.02
    assert moved.contact.force @ AHEAD == pytest.approx(expected.contact.force @ AHEAD, rel=0.02)


def test_little_friction_is_none(site):
    depths = np.array([1e-3, DEPTH])
    little, none = press(site, TOOL, depths, friction=1e-9), press(site, TOOL, depths)
    assert little.converged and little.force == pytest.approx(none.force, rel=5e-3)


@pytest.mark.slow
def test_the_steady_force_does_not_depend_on_the_steps(site, record):
    path = record.paths[-2]
    coarse = drag(site, TOOL, [DEPTH], MU, distance=path.way[-1], dragging=DragSettings(give=(0.5, 1.0)))
    assert coarse.paths[0].resistance[-1] == pytest.approx(path.resistance[-1], rel=5e-3)


def test_a_press_with_friction_keeps_its_books(site):
    record = press(site, TOOL, np.array([1e-3, 1.5e-3, DEPTH]), friction=MU)
    assert record.converged and record.reaction_error.max() <= 1e-8 and record.work_mismatch < 0.02
    kept = record.sliding
    assert kept.friction == MU and (np.diff(kept.dissipation) >= 0.0).all() and kept.dissipation[-1] > 0.0
    assert kept.excess.max() <= 1e-6 and kept.turned.max() <= 1e-6
    assert ((kept.sliding >= 0.0) & (kept.sliding <= 1.0)).all()


def test_a_drag_that_meets_what_is_not_solved_says_so(site):
    met = SimpleNamespace(gap=-1.0, point=np.zeros(3))
    around = replace(
        site, surroundings=SimpleNamespace(deepest=lambda tool, pose, u: met, far_faces=np.zeros((0, 3, 3)))
    )
    record = drag(around, TOOL, [0.5e-3], MU)
    assert not record.converged and "beyond the contact that is solved" in record.reason
    assert np.isnan(record.effective).all() and not record.amontons and not record.paths


def test_a_drag_that_ends_before_all_slides_is_not_taken_for_friction(site):
    record = drag(site, TOOL, [0.5e-3], MU, distance=0.03e-3)
    assert not record.converged and "not steady" in record.reason and np.isnan(record.effective).all()


@pytest.mark.parametrize(
    "wrong",
    [
        {"friction": 0.0},
        {"depths": [1e-3, 0.5e-3]},
        {"depths": []},
        {"directions": np.array([[0.0, 0.0, 1.0]])},
    ],
)
def test_what_cannot_be_dragged_is_refused(site, wrong):
    with pytest.raises(ValueError):
        drag(site, TOOL, **{"depths": [1e-3], "friction": MU, **wrong})


def test_friction_that_is_no_number_is_refused(site):
    for friction in (-0.1, np.inf, np.nan):
        with pytest.raises(ValueError, match="friction"):
            press(site, TOOL, np.array([1e-3]), friction=friction)


def test_what_is_felt_is_what_a_press_without_friction_foretells(site, record):
    """To first order in the coefficient, which is 0.3 here."""
    share = press(site, TOOL, np.array([0.5e-3, 1e-3, 1.5e-3, DEPTH])).friction_share
    assert record.effective[:, 0] / MU == pytest.approx(share[[2, 4]], rel=0.03)
