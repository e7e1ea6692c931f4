# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A ball's radius between pressed radii, against contact laws that hold for every radius."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest
from known_organ import KnownOrgan
from scipy.interpolate import CubicSpline

from palpate.fem_offline.verification.bonded_layer import BondedLayer
from palpate.fields.build_field import build_field
from palpate.fields.contact_geometry import contact_geometry
from palpate.fields.field_error import FieldError
from palpate.fields.interpolation import evaluate
from palpate.fields.node_fit import fit_nodes, uniform_knots
from palpate.fields.response_field import FamilyMember, ResponseNodes, ToolReference
from palpate.fields.tool_family import depth_between, nodes_of_radius

MODULUS = 7e3
Law = Callable[[float, np.ndarray], np.ndarray]
"""Force (n,) N of a ball of radius R (m) at depths (n,) m."""


def hertz(R: float, d: np.ndarray) -> np.ndarray:
    return 4 / 3 * MODULUS * np.sqrt(R) * d**1.5


def half_space(R: float, d: np.ndarray) -> np.ndarray:
    """Far strained, nu = 0.5 (Zhang et al. 2014)."""
    return hertz(R, d) * (1 - 0.15 * d / R)


def curved(R: float, d: np.ndarray) -> np.ndarray:
    """On a convex surface of 30 mm radius."""
    return half_space(R, d) / np.sqrt(1 + R / 0.03)


@lru_cache
def layer(thickness: float) -> Law:
    """Bonded, nu = 0.48: Hertz times a function of sqrt(R d) / h, by the integral equation (paraboloid)."""
    bonded = BondedLayer(MODULUS * (1 - 0.48**2), 0.48, thickness)
    a, R = np.geomspace(0.2e-3, 7e-3, 16), 10.0
    table = [bonded.paraboloid(R, x**2 / R).force / hertz(R, x**2 / R) for x in a]
    factor = CubicSpline(np.log(a), np.log(table))
    return lambda R, d: half_space(R, d) * np.exp(factor(np.log(np.maximum(np.sqrt(R * d), a[0]))))


def member(law: Law, radius: float, depth: float) -> FamilyMember:
    """One node whose press is `law`."""
    knots = uniform_knots(depth)
    x, w = np.polynomial.legendre.leggauss(24)
    t = np.sqrt(knots)[:, None] * (x + 1) / 2  # int f dd = int f(t^2) 2 t dt
    energy = (law(radius, t**2) * 2 * t) @ w * np.sqrt(knots) / 2
    force, n = law(radius, knots), np.array([[0.0, 0.0, 1.0]])
    lateral = energy[None, :, None] * np.array([30.0, 0.0, 0.0])
    zero = np.zeros(1)
    nodes = ResponseNodes(0 * n, n, knots, energy[None], force[None], lateral, 0.7 * force[None] / depth,
                          np.full((1, len(knots)), 0.1), zero + depth, zero == 0, zero, np.array(["key"]))  # fmt: skip
    tool = ToolReference("balls", "sphere", radius, {"radius": radius}, f"{radius:.4f}")
    return FamilyMember(tool, nodes)


def family(
    law: Law, radii: tuple[float, ...] = (2e-3, 5e-3, 10e-3), deepest: float = 4e-3
) -> list[FamilyMember]:
    return [member(law, R, min(deepest, R)) for R in radii]


def force_error(law: Law, members: list[FamilyMember]) -> float:
    """Worst of radii between, from 15 % of their depth on."""
    radii = [m.radius for m in members]
    between = np.concatenate([np.geomspace(a, b, 5)[1:-1] for a, b in pairwise(radii)])
    worst = 0.0
    for R in between:
        nodes = nodes_of_radius(members, R)
        d = nodes.depth_knots[2:]
        worst = max(worst, float(np.abs(nodes.normal_force[0, 2:] / law(R, d) - 1).max()))
    return worst


def test_hertz_is_met_at_any_radius() -> None:
    assert force_error(hertz, family(hertz)) < 1e-10


@pytest.mark.parametrize(
    "law, bar",
    [
        (half_space, 0.002),
        (curved, 0.004),
        (layer(30e-3), 0.002),
        (layer(10e-3), 0.008),
        (layer(5e-3), 0.015),
    ],
    ids=["half space", "curved", "layer of 30 mm", "layer of 10 mm", "layer of 5 mm"],
)
def test_what_radius_does_to_contact_is_followed_between_pressed_radii(law: Law, bar: float) -> None:
    assert force_error(law, family(law)) < bar


def test_two_radii_one_four_times_the_other_are_enough_on_a_layer_where_hertz_ratio_is_far_off() -> None:
    law = layer(5e-3)
    d = np.array([2.5e-3])
    assert law(10e-3, d) / law(2.5e-3, d) > 4.5  # Hertz: 2
    assert force_error(law, family(law, (2.5e-3, 10e-3), 2.5e-3)) < 0.025


def test_a_pressed_radius_gives_its_own_curves() -> None:
    members = family(half_space)
    assert nodes_of_radius(members, 5e-3) is members[1].nodes


def test_force_is_the_slope_of_energy_and_all_begins_at_zero() -> None:
    nodes = nodes_of_radius(family(layer(5e-3)), 3.3e-3)
    d, energy = nodes.depth_knots[1:], nodes.stored_energy[0, 1:]
    smooth = CubicSpline(np.log(d), np.log(energy))
    assert nodes.normal_force[0, 2:-1] == pytest.approx((energy / d * smooth(np.log(d), 1))[1:-1], rel=2e-3)
    for curve in (nodes.stored_energy, nodes.normal_force, nodes.friction_stiffness):
        assert curve[0, 0] == 0.0
    assert not nodes.pressed.any() and nodes.press_hash.tolist() == [""]


def test_the_lateral_gradient_is_that_of_the_energy() -> None:
    """Two nodes' curves 10 um apart, one law 1 % of a millimetre thicker: B / Phi is the difference of log Phi."""
    step = 1e-5
    radii, here = (2e-3, 5e-3, 10e-3), []
    pair = [family(layer(h), radii) for h in (8e-3 - step / 2, 8e-3 + step / 2)]
    for below, above in zip(*pair, strict=True):
        slope = np.log(above.nodes.stored_energy[:, 1:] / below.nodes.stored_energy[:, 1:]) / step
        middle = np.sqrt(above.nodes.stored_energy[:, 1:] * below.nodes.stored_energy[:, 1:])
        B = np.zeros((1, 13, 3))
        B[:, 1:, 0] = slope * middle
        here.append(FamilyMember(below.tool, replace(below.nodes, lateral_gradient=B)))
    found = nodes_of_radius(here, 7e-3)
    low, high = (nodes_of_radius(members, 7e-3).stored_energy[0, 1:] for members in pair)
    slope = np.log(high / low) / step
    assert found.lateral_gradient[0, 1:, 0] / found.stored_energy[0, 1:] == pytest.approx(slope, rel=1e-3)


def test_no_curve_is_deeper_than_what_was_pressed_around_it() -> None:
    assert depth_between([2e-3, 5e-3, 10e-3], [2e-3, 4e-3, 4e-3], 5e-3) == 4e-3
    assert depth_between([2e-3, 8e-3], [2e-3, 8e-3], 4e-3) == pytest.approx(4e-3)
    assert depth_between([5e-3, 10e-3], [4e-3, 4e-3], 7e-3) == pytest.approx(4e-3)


@pytest.mark.parametrize("radius", [1.9e-3, 11e-3, float("nan")])
def test_a_radius_outside_the_pressed_ones_is_refused_by_name(radius: float) -> None:
    with pytest.raises(FieldError, match=r"mm was not pressed .* 2 to 10 mm is right"):
        nodes_of_radius(family(hertz), radius)


def test_members_with_other_nodes_are_refused() -> None:
    first, *rest = family(hertz)
    moved = replace(first.nodes, position=first.nodes.position + 1e-3)
    with pytest.raises(FieldError, match="the same places pressed at every radius are right"):
        nodes_of_radius([FamilyMember(first.tool, moved), *rest], 3e-3)


def test_a_field_of_a_radius_between_renders_an_organ_whose_modulus_varies() -> None:
    """The known organ under balls of 3 and 6 mm, each 0.6 R deep; rendered for 4.2 mm, which nobody pressed."""
    organs = [KnownOrgan(radius=R, depth_max=0.6 * R) for R in (3e-3, 6e-3, 4.2e-3)]
    truth, extent = organs[2], 8e-3
    places = truth.cap_points(8, np.random.default_rng(2), extent)

    def reach(q: np.ndarray) -> np.ndarray:
        return truth.reach(q) + 20e-3 - extent

    bounds = np.array([[-0.026, -0.026, 0.018], [0.026, 0.026, 0.038]])
    geometry = contact_geometry(truth.signed_distance, reach, bounds, (0.5e-3, 7e-3))
    members = []
    for organ in organs[:2]:
        presses = [organ.press(c, np.random.default_rng(0)) for c in places]
        nodes = fit_nodes(presses, uniform_knots(organ.depth_max), organ.radius, geometry)
        members.append(FamilyMember(member(hertz, organ.radius, organ.depth_max).tool, nodes))
    tool = ToolReference("balls", "sphere", 4.2e-3, {"radius": 4.2e-3}, "between")
    field = build_field(nodes_of_radius(members, 4.2e-3), geometry, tool, reach)
    c = truth.cap_points(30, np.random.default_rng(5), extent)
    q = c + (truth.radius - 0.7 * truth.depth_max) * truth.normal(c)
    expected = truth.force(q)
    error = np.linalg.norm(evaluate(field, q).force - expected, axis=1) / np.linalg.norm(expected, axis=1)
    assert np.quantile(error, 0.95) < 0.01
