# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Node curves of a ball of any radius, from those of balls of a few radii that were pressed at the same places.

At each node, with a = sqrt(R d) and the scaled energy

    y(R, d) = log(Phi / (R^(1/2) d^(5/2)))        constant for Hertz' ball on a half space (Johnson 1985, eq. 4.23)

what is known of contact says on what y depends: on a alone, if the tissue is linear and layered (Hertz' gap is
r^2 / 2 R); on d / R alone, if a half space is strained far (similarity; Zhang 2014: force falls by 0.15 d / R); on R
alone, if the surface is curved (1/R + curvature).  So these are taken out before anything is interpolated:

    y = trend(R, d) + rest,    trend = c0 + c1 a + c2 a^2 + c3 d / R + c4 R

with c by least squares over all radii and knots.  The rest is linear in log R between neighbours, at
equal shares d / D of their deepest presses D(R), log D being linear in log R too: no curve is asked for more depth than
was pressed.  The same numbers act on every node, so they act on y's gradient along the surface, B / Phi, and on
d log Phi / d log d = d f / Phi as well.  k d / f and mu change little with R and are linear in log R alone.

Limits: the pressed radii's own range; one node has to be pressed at every radius.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.fields.field_error import FieldError
from palpate.fields.response_field import FamilyMember, ResponseNodes

__all__ = ["depth_between", "nodes_of_radius"]

RIDGE = 1e-3
"""Of the trend's coefficients, its columns scaled to 1: what two radii of nearly one size do not determine."""
SLACK = 1e-9
"""Relative; radii nearer than this are the same."""


def depth_between(radii: Sequence[float], depths: Sequence[float], radius: float) -> float:
    """D, m: deepest press that the pressed `radii` (m, rising) with their `depths` (m) stand for at `radius` (m).

    Raises:
        FieldError: `radius` lies outside the pressed ones.
    """
    _refuse_outside(radii, radius)
    for own, depth in zip(radii, depths, strict=True):
        if abs(own - radius) <= SLACK * own:
            return float(depth)
    return float(np.exp(np.interp(np.log(radius), np.log(radii), np.log(depths))))


def nodes_of_radius(members: Sequence[FamilyMember], radius: float) -> ResponseNodes:
    """Node curves at `radius`, m; a pressed radius gives its own, bit by bit.

    The nodes' `pressed` is False and `press_hash` empty in between; `residual` is the worse of the neighbours'.
    B / Phi belongs to the tool's reference point, which the radius moves by a share of the surface's radius of
    curvature; linear in that, the interpolation follows.

    Raises:
        FieldError: `radius` lies outside the pressed ones, or the members do not share their nodes.
    """
    radii = np.array([member.radius for member in members])
    _refuse_outside(radii, radius)
    same = np.flatnonzero(np.abs(radii - radius) <= SLACK * radii)
    if len(same):
        return members[int(same[0])].nodes
    _refuse_others(members)
    j = int(np.searchsorted(radii, radius)) - 1
    above = float(np.log(radius / radii[j]) / np.log(radii[j + 1] / radii[j]))
    pair, weight = [members[j].nodes, members[j + 1].nodes], (1.0 - above, above)
    deepest = np.array([member.nodes.depth_knots[-1] for member in members])
    share = pair[0].depth_knots / deepest[j]
    knots = depth_between(radii, deepest, radius) * share
    trend = _Trend.over(radii, deepest[:, None] * share[1:])

    energy = np.stack(
        [member.nodes.stored_energy[:, 1:] for member in members], axis=1
    )  # (N, members, K - 1)
    d = deepest[:, None] * share[1:]
    y = np.log(energy) - np.log(np.sqrt(radii)[:, None] * d**2.5)
    b = np.stack([m.nodes.lateral_gradient[:, 1:] for m in members], axis=1) / energy[..., None]
    force = np.stack([member.nodes.normal_force[:, 1:] for member in members], axis=1)
    exponent = d * force / energy

    value, slope = trend.operators(radius, knots[1:], (j, j + 1), weight)
    y_here = np.einsum("kms,nms->nk", value, y)
    b_here = np.einsum("kms,nmsx->nkx", value, b)
    exponent_here = np.einsum("kms,nms->nk", slope, y) + _mixed(exponent[:, j : j + 2], weight)
    energy_here = np.sqrt(radius) * knots[1:] ** 2.5 * np.exp(y_here)
    force_here = energy_here * exponent_here / knots[1:]
    pull = np.stack(
        [n.friction_stiffness[:, 1:] * n.depth_knots[1:] / n.normal_force[:, 1:] for n in pair], axis=1
    )
    reached = np.min([n.depth_reached / n.depth_knots[-1] for n in pair], axis=0)
    first = pair[0]
    return replace(
        first,
        depth_knots=knots,
        stored_energy=_from_zero(energy_here),
        normal_force=_from_zero(force_here),
        lateral_gradient=_from_zero(b_here * energy_here[..., None]),
        friction_stiffness=_from_zero(_mixed(pull, weight) * force_here / knots[1:]),
        friction_coefficient=_mixed(np.stack([n.friction_coefficient for n in pair], axis=1), weight),
        depth_reached=reached * knots[-1],
        pressed=np.zeros(first.node_count, dtype=bool),
        residual=np.maximum(pair[0].residual, pair[1].residual),
        press_hash=np.full(first.node_count, "", dtype=str),
    )


@dataclass(frozen=True)
class _Trend:
    """trend(R, d) as numbers that act on y at all radii and knots.

    Attributes:
        radii: (M,) m.  depth: (M, S) m.  scale: (4,), largest a (m), a^2, d / R and R (m).
        solve: (5, M S) coefficients of the trend from y.
    """

    radii: np.ndarray
    depth: np.ndarray
    scale: np.ndarray
    solve: np.ndarray

    @staticmethod
    def over(radii: np.ndarray, depth: np.ndarray) -> _Trend:
        R = np.broadcast_to(radii[:, None], depth.shape).ravel()
        d = depth.ravel()
        a = np.sqrt(R * d)
        scale = np.array([a.max(), (a**2).max(), (d / R).max(), R.max()])
        weight = (depth / depth[:, -1:]).ravel()  # shallow contacts are a few elements wide
        A = _columns(R, d, scale) * weight[:, None]
        hold = RIDGE * np.sqrt(len(d)) * np.eye(5)
        hold[0] = 0.0  # the mean is free
        solve = np.linalg.pinv(np.vstack([A, hold]))[:, : len(d)] * weight
        return _Trend(radii, depth, scale, solve)

    def operators(
        self, radius: float, depth: np.ndarray, pair: tuple[int, int], weight: tuple[float, float]
    ) -> tuple[np.ndarray, np.ndarray]:
        """(K, M, S) that give y, and (K, M, S) that give what the exponent has beside its neighbours' mean."""
        shape = (len(depth), *self.depth.shape)
        R = np.full(len(depth), radius)
        value = _columns(R, depth, self.scale)
        slope = _slopes(R, depth, self.scale)
        for i, share in zip(pair, weight, strict=True):
            own = np.full(len(depth), self.radii[i])
            value = value - share * _columns(own, self.depth[i], self.scale)
            slope = slope - share * _slopes(own, self.depth[i], self.scale)
        values = (value @ self.solve).reshape(shape)
        for i, share in zip(pair, weight, strict=True):
            values[np.arange(len(depth)), i, np.arange(len(depth))] += share
        return values, (slope @ self.solve).reshape(shape)


def _columns(R: np.ndarray, d: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """(n, 5) 1, a, a^2, d / R, R."""
    return np.stack([np.ones_like(d), np.sqrt(R * d), R * d, d / R, R], axis=-1) / np.append(1.0, scale)


def _slopes(R: np.ndarray, d: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """(n, 5) their derivatives by log d."""
    zero = np.zeros_like(d)
    return np.stack([zero, 0.5 * np.sqrt(R * d), R * d, d / R, zero], axis=-1) / np.append(1.0, scale)


def _mixed(values: np.ndarray, weight: tuple[float, float]) -> np.ndarray:
    """(N, 2, ...) -> (N, ...)."""
    return weight[0] * values[:, 0] + weight[1] * values[:, 1]


def _from_zero(values: np.ndarray) -> np.ndarray:
    return np.concatenate([np.zeros_like(values[:, :1]), values], axis=1)


def _refuse_outside(radii: Sequence[float] | np.ndarray, radius: float) -> None:
    low, high = float(min(radii)), float(max(radii))
    if not low * (1.0 - SLACK) <= radius <= high * (1.0 + SLACK):
        raise FieldError(
            f"tool family: a radius of {1e3 * radius:.4g} mm was not pressed and does not lie between pressed ones; "
            f"{1e3 * low:.4g} to {1e3 * high:.4g} mm is right"
        )


def _refuse_others(members: Sequence[FamilyMember]) -> None:
    first = members[0].nodes
    for member in members[1:]:
        shared = np.array_equal(first.position, member.nodes.position)
        if not shared or len(first.depth_knots) != len(member.nodes.depth_knots):
            raise FieldError(
                f"tool family: the nodes or knots of radius {1e3 * member.radius:.4g} mm are not those of "
                f"{1e3 * members[0].radius:.4g} mm; the same places pressed at every radius are right"
            )
