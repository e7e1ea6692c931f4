# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Gaps between exact surfaces against brute force: samples of one in the signed distance of the other, zoomed in."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from palpate.author.errors import InputError
from palpate.author.rigid import shapes
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.law import LUO_XIAO
from palpate.author.rigid.polyhedron import box
from palpate.runtime.rigid import Rigid

R, L, TUBE, C, H = 0.02, 0.05, 0.006, 30.0, 0.02
EDGES = np.array([0.03, 0.05, 0.04])
BODIES = {
    "sphere": shapes.sphere(R),
    "cylinder": shapes.cylinder(R, L),
    "capsule": shapes.capsule(R, L),
    "cone": shapes.cone(R, L),
    "torus": shapes.torus(R, TUBE),
    "paraboloid": shapes.paraboloid(C, H),
    "box": box(tuple(EDGES)),
}


def segment(q, a, b):
    """(n,) distances of (n, 2) to a segment."""
    d = b - a
    t = np.clip((q - a) @ d / (d @ d), 0, 1)
    return np.linalg.norm(q - a - t[:, None] * d, axis=1)


def profile(q, corners):
    """Signed distance to the solid of revolution whose half profile has these corners, both ends on the axis."""
    lines = [segment(q, np.array(a), np.array(b)) for a, b in itertools.pairwise(corners)]
    z, rho = q[:, 1], q[:, 0]
    width = np.interp(
        z, *zip(*sorted((b, a) for a, b in corners if a > 0 or corners[0] == (a, b)), strict=True)
    )
    low, high = min(b for _, b in corners), max(b for _, b in corners)
    inside = (rho < width) & (z > low) & (z < high)
    return np.where(inside, -1, 1) * np.min(lines, axis=0)


def away(name, p):
    """(n,) m; signed distance of points (n, 3) in the body's own axes."""
    rho, z = np.hypot(p[:, 0], p[:, 1]), p[:, 2]
    q = np.stack([rho, z], axis=1)
    if name == "sphere":
        return np.linalg.norm(p, axis=1) - R
    if name == "capsule":
        return np.linalg.norm(p - np.clip(z, -L / 2, L / 2)[:, None] * [0, 0, 1], axis=1) - R
    if name == "torus":
        return np.hypot(rho - R, z) - TUBE
    if name == "box":
        d = np.abs(p) - EDGES / 2
        return np.linalg.norm(np.maximum(d, 0), axis=1) + np.minimum(d.max(axis=1), 0)
    if name == "cylinder":
        d = np.stack([rho - R, np.abs(z) - L / 2], axis=1)
        return np.linalg.norm(np.maximum(d, 0), axis=1) + np.minimum(d.max(axis=1), 0)
    if name == "cone":
        return profile(q, [(0.0, 0.0), (R, L), (0.0, L)])
    rim = np.sqrt(H / C)
    r = np.clip(np.maximum(rho, np.sqrt(np.maximum(z, 0) / C)), 0, None)
    for _ in range(60):  # Newton's method for the foot, from above
        r = r - ((2 * C * C * r * r + 1 - 2 * C * z) * r - rho) / np.maximum(
            6 * C * C * r * r + 1 - 2 * C * z, 1e-9
        )
    r = np.clip(r, 0, rim)
    curve = np.hypot(rho - r, z - C * r * r)
    top = segment(q, np.array([0.0, H]), np.array([rim, H]))
    return np.where((z > C * rho * rho) & (z < H), -1, 1) * np.minimum(curve, top)


def around(rho, z, v):
    return np.stack([rho * np.cos(2 * np.pi * v), rho * np.sin(2 * np.pi * v), z + 0 * v], axis=1)


def patches(name):
    """Parametrised parts of a body's surface: functions of u, v in 0..1, (n,), to (n, 3) m."""
    pi = np.pi
    if name == "sphere":
        return [lambda u, v: around(R * np.sin(pi * u), R * np.cos(pi * u), v)]
    if name == "torus":
        return [lambda u, v: around(R + TUBE * np.cos(2 * pi * u), TUBE * np.sin(2 * pi * u), v)]
    if name == "cone":
        return [lambda u, v: around(R * u, L * u, v), lambda u, v: around(R * u, L, v)]
    if name == "paraboloid":
        rim = np.sqrt(H / C)
        return [lambda u, v: around(rim * u, H * u * u, v), lambda u, v: around(rim * u, H, v)]
    if name == "box":
        found = []
        for axis, sign in itertools.product(range(3), (-1, 1)):
            i, j = (axis + 1) % 3, (axis + 2) % 3

            def face(u, v, axis=axis, sign=sign, i=i, j=j):
                p = np.zeros((len(u), 3))
                p[:, axis], p[:, i], p[:, j] = (
                    sign * EDGES[axis] / 2,
                    (u - 0.5) * EDGES[i],
                    (v - 0.5) * EDGES[j],
                )
                return p

            found.append(face)
        return found
    sides = [lambda u, v: around(R, L * (u - 0.5), v)]
    if name == "cylinder":
        return sides + [lambda u, v, s=s: around(R * u, s * L / 2, v) for s in (-1, 1)]
    return sides + [
        lambda u, v, s=s: around(R * np.sin(pi / 2 * u), s * (L / 2 + R * np.cos(pi / 2 * u)), v)
        for s in (-1, 1)
    ]


def brute(first, second, rotation, at):
    """m; the smallest signed distance of the turned and moved first body's surface to the second."""
    least = np.inf
    for patch in patches(first):
        u, v = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 41), indexing="ij")
        d = away(second, patch(u.ravel(), v.ravel()) @ rotation.T + at).reshape(u.shape)
        up = np.pad(d, ((1, 1), (0, 0)), constant_values=np.inf)
        ends = (d[:, -2:-1], d[:, 1:2]) if first != "box" else (np.full((len(d), 1), np.inf),) * 2
        side = np.concatenate([ends[0], d, ends[1]], axis=1)  # v goes round, but on a box
        valley = (d <= np.minimum(up[:-2], up[2:])) & (d <= np.minimum(side[:, :-2], side[:, 2:]))
        u, v, d = u[valley], v[valley], d[valley]
        for k in np.argsort(d)[:4]:
            cu, cv, wu, wv = u[k], v[k], 1 / 8, 1 / 16
            for _ in range(26):  # shrinks slowly enough to follow a valley
                gu, gv = np.meshgrid(np.linspace(-wu, wu, 9), np.linspace(-wv, wv, 9), indexing="ij")
                uu, vv = np.clip(cu + gu.ravel(), 0, 1), cv + gv.ravel()
                if first == "box":
                    vv = np.clip(vv, 0, 1)
                fine = away(second, patch(uu, vv) @ rotation.T + at)
                best = int(np.argmin(fine))
                cu, cv, wu, wv = uu[best], vv[best], 0.58 * wu, 0.58 * wv
            least = min(least, float(fine[best]))
    return least


def half_an_eps_away(held, fixed, turned, d):
    """m; how far along d from the fixed body's centre the gap is half an eps by brute force (secant method)."""
    wanted, middle = 0.5 * LUO_XIAO.threshold, BODIES[fixed].centre
    s = 0.08
    far = brute(held, fixed, turned, middle + s * d) - wanted
    t = s - far
    for _ in range(12):
        near = brute(held, fixed, turned, middle + t * d) - wanted
        if abs(near) < 1e-5:
            break
        s, t, far = t, t - near * min(max((t - s) / (near - far), 1.0), 3.0), near
    return t


@pytest.mark.parametrize(
    ("held", "fixed"),
    [p for p in itertools.combinations_with_replacement(BODIES, 2) if p != ("cone", "cone")],
)
def test_a_gap_is_what_brute_force_says(held, fixed):
    """Half an eps apart by brute force; the nearest contact has that gap, to a thousandth of eps, and its normal."""
    rng = np.random.default_rng(sum(map(ord, held + fixed)))
    body, eps = BODIES[held], LUO_XIAO.threshold
    rigid = Rigid(cooked_rigid(body, BODIES[fixed], 0.5))
    middle = BODIES[fixed].centre
    for _ in range(2):
        rotation = Rotation.random(random_state=rng)
        d = rng.normal(size=3)
        d = d / np.linalg.norm(d)
        m, s = rotation.as_matrix(), half_an_eps_away(held, fixed, rotation.as_matrix(), d)
        gap = brute(held, fixed, m, middle + s * d)
        out = rigid.identify([middle + s * d + m @ body.centre], [rotation.as_quat()])[0]
        assert out["contact_count"] >= 1 and out["status"] == 0
        nearest = out["contact"][int(np.argmin(out["contact"]["gap"][: out["contact_count"]]))]
        assert nearest["gap"] == pytest.approx(gap, abs=1e-3 * eps)
        moved = brute(held, fixed, m, middle + s * d + 1e-5 * nearest["normal"])
        assert moved - gap == pytest.approx(1e-5, rel=0.02)


def test_a_torus_rests_in_a_pipe_and_in_a_bowl():
    """Hollows meet a torus along its circle: gaps from the closed form of its nearest point."""
    ring, pipe = shapes.torus(R, TUBE), shapes.tube(0.04, 0.05, 0.2)
    upright = Rotation.from_euler("x", 90, degrees=True)  # its circle in the plane of the pipe's axis
    out = Rigid(cooked_rigid(ring, pipe, 0.5)).identify(
        [[0.04 - R - TUBE - 5e-4, 0, 0]], [upright.as_quat()]
    )[0]
    assert out["contact_count"] == 1
    assert out["contact"]["gap"][0] == pytest.approx(5e-4, abs=1e-9)
    assert out["contact"]["normal"][0] == pytest.approx([-1, 0, 0], abs=1e-6)


def test_two_cones_are_refused_by_name():
    with pytest.raises(InputError, match="cone with a cone"):
        cooked_rigid(BODIES["cone"], BODIES["cone"], 0.5)


@pytest.mark.parametrize("hollow", [shapes.bowl(10, 0.05, 0.02), shapes.tube(0.03, 0.04, 0.1)])
def test_a_solid_paraboloid_in_a_hollow_is_refused_by_name(hollow):
    with pytest.raises(InputError, match="paraboloid with a hollow"):
        cooked_rigid(BODIES["paraboloid"], hollow, 0.5)


@pytest.mark.parametrize(
    ("held", "fixed"),
    [("cone", "paraboloid"), ("paraboloid", "paraboloid"), ("torus", "cone")],
)
def test_contacts_of_curved_sides_are_each_others_nearest_points(held, fixed):
    """Mutual feet: each point lies on its surface, and as far from the other solid as the gap says."""
    rng = np.random.default_rng(3)
    body, middle, count = BODIES[held], BODIES[fixed].centre, 6000
    turns = Rotation.random(count, random_state=rng)
    d = rng.normal(size=(count, 3))
    at = middle + d / np.linalg.norm(d, axis=1)[:, None] * rng.uniform(0.01, 0.05, (count, 1))
    m = turns.as_matrix()
    found = Rigid(cooked_rigid(body, BODIES[fixed], 0.5)).identify(at + m @ body.centre, turns.as_quat())
    first = len(body.elements)
    met = 0
    for row, turn, place in zip(found, m, at, strict=True):
        for c in row["contact"][: row["contact_count"]]:
            kinds = (
                body.elements[c["held_element"]].kind,
                BODIES[fixed].elements[c["fixed_element"] - first].kind,
            )
            if kinds != (held, fixed) or c["gap"] <= 0 or row["contact_count"] != 1:
                continue
            met += 1
            ours, theirs = c["point"], c["point"] - c["gap"] * c["normal"]
            gaps = [
                *away(fixed, np.array([ours, theirs])),
                *away(held, (np.array([ours, theirs]) - place) @ turn),
            ]
            assert gaps == pytest.approx([c["gap"], 0, 0, c["gap"]], abs=1e-6)
    assert met >= 5
