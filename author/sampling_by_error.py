# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Press next where the field is estimated to be furthest off, and stop when it is near enough everywhere.

Seeds are well spread.  After them every node is a place where the error that kriging expects of itself is largest
(fields/error_indicator.py), given the presses that are under way.  Each node that arrives is first predicted by a model
that has not seen it.  These tests are honest but lie at hard places: on their own they overrate the error of the field.
Divided by what the model expected there they say whether it believes too much of itself, and that ratio corrects its
expectation over the whole reach:

    t_i = missed_i / deviation_i,     c^2 = (TRUST + sum t_i^2) / (TRUST + count)     over the latest RECENT tests
    estimate:  the error that c deviation leaves at 95 % of the reach, and WORST c deviation where that is largest

Everything follows from the records and from what is asked for, so a run that was killed goes the same way again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from palpate.fields.error_indicator import ErrorIndicator, error_quantile, missed
from palpate.fields.response_field import ContactGeometry, ResponseNodes
from palpate.fields.site_curves import SiteCurves

__all__ = ["Round", "SamplingByError", "Terrain"]

NORMAL_LENGTH = 20e-3
"""m, of the embedding, as `build_field` has it."""
FIELD_SHARE = 0.8
"""Share of the tolerance for interpolation between presses; lattice, shared curves and far field take the rest."""
WORST = 2.0
"""Deviations that the worst place may be off by."""
RECENT, TRUST = 24, 4
"""Tests that correct the model's own estimate, and how many it is worth itself (counts)."""
COARSE, FINE = 2500, 2500
"""Places whose error is estimated: so many spread evenly, and where that is large so many more (counts)."""
HARD = 0.1
"""Share of the even places around which finer ones are looked at."""
SEARCHED, ANEW = 1.1, 1.6
"""Growth of the node count after which kriging's settings are searched again, nearby and from nothing."""


@dataclass(frozen=True)
class Terrain:
    """Places that may be pressed.

    Attributes:
        position: (n, 3) m.  normal: (n, 3).  shape: (n, 3, 3) 1/m, shape operators.
        even: indices of places spread evenly, each prefix well spread.
    """

    position: np.ndarray
    normal: np.ndarray
    shape: np.ndarray
    even: np.ndarray


@dataclass(frozen=True)
class Round:
    """What was known when presses were chosen.

    Attributes:
        nodes: that built the model (count).
        estimate: error of force that 95 % of the reach stay below, fraction.  worst: the largest expected anywhere.
        correction: c above.
        missed: median and largest normal error of the nodes that arrived, before they were used; None for seeds.
        missed_lateral: largest lateral one.
        gap: m, from the place farthest from any node.  rough: whether kriging has a rough part.
    """

    nodes: int
    estimate: float
    worst: float
    correction: float
    missed: tuple[float, float] | None
    missed_lateral: float | None
    gap: float
    rough: bool


@dataclass
class SamplingByError:
    """Chooses the nodes of one tool.

    Args:
        terrain: places that may be pressed.
        geometry, offset: of the field; rho, m.
        tolerance: fraction of force at the 95th percentile; the worst may be twice that.
        most: nodes (count).
        apart: m; no chosen node comes nearer to another or to a place that cannot be pressed.  Presses that share most
            of their contact differ by the noise of their meshes, and where a surface is faceted that noise would draw
            one node after another.
    """

    terrain: Terrain
    geometry: ContactGeometry
    offset: float
    tolerance: float
    most: int
    apart: float = 0.0
    rounds: list[Round] = field(default_factory=list)
    ended: str = ""
    near_enough: bool = False
    _sites: SiteCurves | None = None
    _tests: list[float] = field(default_factory=list)
    _searched: int = 0
    _anew: int = 0

    def choose(
        self, nodes: ResponseNodes, index: Sequence[int], busy: Sequence[int], count: int
    ) -> np.ndarray:
        """Up to `count` places to press next; none when it `ended`.

        Args:
            nodes: all nodes so far; those of earlier calls first.
            index: their places.
            busy: places that are being pressed, or cannot be.
        """
        index = np.asarray(index, int)
        fresh = index[self.rounds[-1].nodes :] if self.rounds else index[:0]
        tested = self._test(nodes, fresh)
        self._fit(nodes)
        at = self._places()
        here = ErrorIndicator(self._sites, *self._taken(at))
        even = here.deviation[: len(self.terrain.even)]
        correction = self._correction
        p95, worst = correction * error_quantile(even), WORST * correction * float(here.deviation.max())
        gap = KDTree(nodes.position).query(self.terrain.position[self.terrain.even])[0].max()
        rough = self._sites.response.settings.short_variance > 0
        self.rounds.append(Round(len(index), p95, worst, correction, *tested, float(gap), rough))
        allowed = FIELD_SHARE * self.tolerance
        before, self.near_enough = self.near_enough, p95 <= allowed and worst <= 2.0 * allowed
        if (
            before and self.near_enough
        ):  # twice: one lucky round, or seeds, which test nothing, are not enough
            self.ended = "tolerance met by estimate"
        elif len(index) + len(busy) >= self.most:
            self.ended = "most nodes reached"
        if self.ended:
            return np.zeros(0, int)
        return self._next(here, at, index, busy, min(count, self.most - len(index) - len(busy)))

    def report(self) -> dict[str, Any]:
        """How sampling went, JSON-clean."""
        rounds = [asdict(r) for r in self.rounds]
        columns = {name: [_clean(r[name]) for r in rounds] for name in (rounds[0] if rounds else ())}
        return {"ended": self.ended, "most": self.most, "rounds": columns}

    @property
    def note(self) -> str:
        """Where sampling stands, for people."""
        if not self.rounds:
            return ""
        last = self.rounds[-1]
        return f"{last.nodes} of at most {self.most} nodes, force off by an estimated {100 * last.estimate:.2g} %"

    def _taken(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.terrain.position[at], self.terrain.normal[at], self.terrain.shape[at]

    def _test(self, nodes: ResponseNodes, fresh: np.ndarray):
        """Errors of the prediction where nodes are fresh; they correct the model's estimate."""
        if self._sites is None or len(fresh) == 0:
            return None, None
        expected = ErrorIndicator(self._sites, *self._taken(fresh)).deviation
        normal, lateral = missed(self._sites, _last(nodes, len(fresh)), self.terrain.shape[fresh])
        self._tests += (normal / expected).tolist()
        return (float(np.median(normal)), float(normal.max())), float(lateral.max())

    @property
    def _correction(self) -> float:
        t = np.array(self._tests[-RECENT:])
        return max(1.0, float(np.sqrt((TRUST + np.sum(t**2)) / (TRUST + len(t)))))

    def _fit(self, nodes: ResponseNodes) -> None:
        count = nodes.node_count
        known = None if self._sites is None else self._sites.response.settings
        if known is None or count >= ANEW * self._anew:
            how, self._anew, self._searched = {}, count, count
        elif count >= SEARCHED * self._searched or (known.short_variance == 0 and self._sites.response.rough):
            how, self._searched = {"near": known}, count
        else:
            how = {"settings": known}
        self._sites = SiteCurves.from_nodes(nodes, self.geometry, self.offset, NORMAL_LENGTH, **how)

    def _places(self) -> np.ndarray:
        """The even places, then finer ones around those of them that are hard."""
        even = self.terrain.even
        deviation = ErrorIndicator(self._sites, *self._taken(even)).deviation
        hard = np.argsort(-deviation, kind="stable")[: max(1, int(HARD * len(even)))]
        rank = np.full(len(even), len(even))
        rank[hard] = np.arange(len(hard))
        nearest = rank[KDTree(self.terrain.position[even]).query(self.terrain.position)[1]]
        nearest[even] = len(even)
        order = np.argsort(nearest, kind="stable")[:FINE]
        return np.concatenate([even, order[nearest[order] < len(even)]])

    def _next(self, here: ErrorIndicator, at: np.ndarray, index: np.ndarray, busy: Sequence[int], count: int):
        taken = np.concatenate([index, np.asarray(busy, int)])
        position = self.terrain.position[at]
        free = ~np.isin(at, taken) & (KDTree(self.terrain.position[taken]).query(position)[0] >= self.apart)
        place = {int(i): k for k, i in enumerate(at)}
        for i in busy:
            if i in place:
                here.plan(place[i])
        chosen = []
        while len(chosen) < count and free.any():
            k = int(np.argmax(np.where(free, here.deviation, -1.0)))
            here.plan(k)
            free[k] = False
            free &= np.linalg.norm(position - position[k], axis=1) >= self.apart
            chosen.append(int(at[k]))
        return np.array(chosen, int)


def _clean(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _last(nodes: ResponseNodes, count: int) -> ResponseNodes:
    taken = {name: value if name == "depth_knots" else value[-count:] for name, value in vars(nodes).items()}
    return ResponseNodes(**taken)
