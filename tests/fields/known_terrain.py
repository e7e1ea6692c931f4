# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A reach whose response is known everywhere and costs nothing: what makes sampling hard, in one place.

    U(c, d) = A(c) d^2.5 (1 + beta(c) d / D) R(c, d)

over a plane (150 cm2 unless said otherwise): log A varies smoothly by some +-30 % over 9 cm; it falls by 1 across a
thin edge (a logistic of 3 mm along a line); it rises by up to 0.7 towards a support that lies in the reach (5 mm
decay); a nodule of 8 mm diameter multiplies force by up to 6 (1.5 mm border), more at depth.  B is the exact gradient.
Presses scatter by 0.2 %, every press by its own numbers.  It judges where nodes are put and what is made of them, not
finite elements.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from synthetic_field import plane, spline_lattice

from palpate.author.sampling import farthest_of
from palpate.author.sampling_by_error import COARSE, Terrain
from palpate.fields.node_fit import PressArrays, uniform_knots
from palpate.fields.response_field import ContactGeometry, ResponseNodes
from palpate.fields.site_curves import SiteCurves

RADIUS, DEPTH = 5e-3, 6e-3
"""m."""
HOLE, NEAR = 17e-3, 15e-3
"""m: no press within HOLE of the support's middle; what is NEAR the nodule is judged apart."""
APART = 36e-3
"""m, between the middles of nodule and support."""
NORMAL_LENGTH = 20e-3


@dataclass(frozen=True)
class KnownTerrain:
    """Seed of everything drawn; with the nodule or without; noise as a share of force; half of the reach's sides, m;
    even places (count)."""

    seed: int = 1
    nodule: bool = True
    noise: float = 0.002
    half: tuple[float, float] = (0.075, 0.05)
    places: int = COARSE

    @cached_property
    def _drawn(self) -> dict[str, np.ndarray]:
        rng = np.random.default_rng(self.seed)
        wave = rng.normal(size=(4, 2))
        while True:
            nodule, support = rng.uniform(-1, 1, (2, 2)) * (np.array(self.half) - APART / 2)
            if np.linalg.norm(nodule - support) > APART:
                break
        return {
            "wave": wave / np.linalg.norm(wave, axis=1, keepdims=True) * 2 * np.pi / 90e-3,
            "phase": rng.uniform(0, 2 * np.pi, 4),
            "nodule": nodule,
            "support": support,
        }

    @property
    def nodule_at(self) -> np.ndarray:
        """(3,) m."""
        return np.append(self._drawn["nodule"], 0.0)

    @cached_property
    def geometry(self) -> ContactGeometry:
        low, high = (
            np.array([-x - 20e-3 for x in self.half] + [-12e-3]),
            np.array([x + 20e-3 for x in self.half] + [12e-3]),
        )
        return ContactGeometry(spline_lattice(plane, low, high, 4e-3), np.array([-3e-3, 8e-3]))

    @cached_property
    def terrain(self) -> Terrain:
        x, y = (np.arange(-h + 0.5e-3, h, 1e-3) for h in self.half)
        places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        places = places[np.linalg.norm(places - self._drawn["support"], axis=1) > HOLE]
        position = np.concatenate([places, np.zeros((len(places), 1))], axis=1)
        normal = np.tile([0.0, 0.0, 1.0], (len(places), 1))
        return Terrain(position, normal, np.zeros((len(places), 3, 3)), farthest_of(position, self.places))

    def stored(self, c: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Energy and force (n, K) at surface points c (n, 3) m and depths d (K,) m."""
        at, p, u = c[:, :2], self._drawn, d / DEPTH
        A = 8 / 15 * 9e3 * np.sqrt(RADIUS) * np.exp(
            0.15 * np.sin(at @ p["wave"].T + p["phase"]).sum(axis=1)
            - 1.0 / (1.0 + np.exp((at[:, 0] + self.half[0] - 12e-3) / 3e-3))
            + np.exp(-(np.linalg.norm(at - p["support"], axis=1) - 15e-3) / 5e-3)
        )  # fmt: skip
        beta = 0.3 + 0.15 * np.sin(40.0 * at[:, :1] + 55.0 * at[:, 1:])
        energy = A[:, None] * d**2.5 * (1 + beta * u)
        force = A[:, None] * (2.5 * d**1.5 * (1 + beta * u) + d**2.5 * beta / DEPTH)
        if not self.nodule:
            return energy, force
        bump = 0.5 * (1 - np.tanh((np.linalg.norm(at - p["nodule"], axis=1) - 4e-3) / 1.5e-3))[:, None]
        ratio, slope = 1 + 5 * bump * (0.3 + 0.7 * u), 5 * bump * 0.7 / DEPTH
        return energy * ratio, force * ratio + energy * slope

    def lateral(self, c: np.ndarray, d: np.ndarray) -> np.ndarray:
        """B (n, K, 3) N."""
        h = 1e-6
        sides = [
            (self.stored(c + h * e, d)[0] - self.stored(c - h * e, d)[0]) / (2 * h) for e in np.eye(3)[:2]
        ]
        return np.stack([*sides, np.zeros_like(sides[0])], axis=-1)

    def press(self, i: int) -> PressArrays:
        """A press at place `i`, as finite elements give it."""
        c, depth = self.terrain.position[[i]], np.linspace(0.0, DEPTH, 11)
        energy, force = (a[0] for a in self.stored(c, depth))
        vector = np.append(-self.lateral(c, depth)[0, :, :2], force[:, None], axis=1)
        rng = np.random.default_rng([self.seed, int(i)])
        energy = energy * (1 + self.noise * rng.normal())
        vector = vector * (1 + self.noise * rng.normal()) + self.noise * force[:, None] * rng.normal(size=3)
        return PressArrays(c[0], np.array([0.0, 0.0, 1.0]), depth, vector, energy, hash=str(i))

    def nodes(self, index: np.ndarray) -> ResponseNodes:
        """Nodes at places `index` (N,), without the detour through a ladder's fit."""
        index = np.asarray(index, int)
        c, knots = self.terrain.position[index], uniform_knots(DEPTH)
        energy, force = self.stored(c, knots)
        B = self.lateral(c, knots)
        for k, i in enumerate(index):
            rng = np.random.default_rng([self.seed, int(i)])
            energy[k] *= 1 + self.noise * rng.normal()
            force[k] *= 1 + self.noise * rng.normal()
            B[k, :, :2] += self.noise * force[k, :, None] * rng.normal(size=2)
        zero, count = np.zeros_like(energy), len(index)
        return ResponseNodes(
            c, self.terrain.normal[index], knots, energy, force, B, zero, zero,
            np.full(count, DEPTH), np.ones(count, bool), np.zeros(count), np.array([""] * count),
        )  # fmt: skip

    def kriged(self, index: np.ndarray) -> SiteCurves:
        return SiteCurves.from_nodes(self.nodes(index), self.geometry, RADIUS, NORMAL_LENGTH)

    def errors(self, sites: SiteCurves, count: int = 1500) -> dict[str, tuple[float, float]]:
        """p95 and worst error of force, of depths with 5 % of the deepest: over the reach, near the nodule, off it."""
        rng = np.random.default_rng(1000 + self.seed)
        off = np.linalg.norm(self.terrain.position - self.nodule_at, axis=1) > NEAR
        test = rng.choice(len(off), count, replace=False)
        out = {"all": test, "off": test[off[test]]}
        if self.nodule:
            out["near"] = rng.choice(np.flatnonzero(~off), 300, replace=False)
        return {name: self._error(sites, places) for name, places in out.items()}

    def _error(self, sites: SiteCurves, places: np.ndarray) -> tuple[float, float]:
        position, depth = self.terrain.position[places], sites.knots
        said = sites.at(position, self.terrain.normal[places], depth).force
        truth = self.stored(position, depth)[1]
        error = np.abs(said / truth - 1)[truth >= 0.05 * truth[:, -1:]]
        return float(np.quantile(error, 0.95)), float(error.max())
