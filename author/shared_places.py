# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One tool pressed as several (radii, tilts) at the same places: one of them chooses, the others follow."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from palpate.author.field_stage import knots_of, press_arrays
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.sampling import common_samples
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.tool_stage import reference_of, shape_of
from palpate.author.tool_work import ToolWork, ladder
from palpate.fields.node_fit import LateralLadder, PressArrays, fit_nodes, friction_at, uniform_knots
from palpate.fields.response_field import ContactGeometry, ResponseNodes, ToolReference

__all__ = ["SharedPlaces", "mean_press"]


class SharedPlaces(ToolWork):
    """A tool of several members.

    Args:
        scene, tool: as the scene file has them.
        members: each way as a tool of its own, and the scene whose depth is its own.
        leader: of the members, whose field chooses the places.
        told: (member) -> words that tell it apart in a failure.
        groups: members whose presses at a place are one node's, their mean; each by itself when None.
    """

    def __init__(
        self,
        scene: Scene,
        mesh: OrganMesh,
        tool: Tool,
        members: Sequence[tuple[Scene, Tool]],
        leader: int,
        told: Callable[[int], str],
        groups: Sequence[Sequence[int]] | None = None,
    ) -> None:
        self._whole, self._named = scene, tool
        self._members, self._leader, self._told = list(members), leader % len(members), told
        self._shapes = [shape_of(*member) for member in self._members]
        self._depths = [own.depth_max(member) for own, member in self._members]
        self._groups = groups or [[i] for i in range(len(self._members))]
        self._beside: dict[PressJob, PressOutcome | None] = {}
        samples = common_samples(mesh, scene.reach, self._shapes, self._depths)
        super().__init__(self._members[leader][0], mesh, self._members[leader][1], samples)

    @property
    def presses_at_most(self) -> int:
        return super().presses_at_most + (len(self._members) - 1) * self.most

    def begin(
        self, geometry: Callable[[], ContactGeometry], width: int, out_of_time: Callable[[], bool]
    ) -> list[PressJob]:
        first = super().begin(geometry, width, out_of_time)
        seeds = first[: len(first) - len(self.held_jobs) - len(self.near_jobs)]
        return [*seeds, *self._followers(seeds), *first[len(seeds) :]]

    def more(self) -> list[PressJob]:
        jobs = super().more()
        return [*jobs, *self._followers(jobs)]

    def _followers(self, jobs: Sequence[PressJob]) -> list[PressJob]:
        """The other members at the places of `jobs`."""
        numbers = [i for i in range(len(self._members)) if i != self._leader]
        others = [self._at(job.contact_point, i) for job in jobs for i in numbers]
        self._beside.update(dict.fromkeys(others))
        return others

    def _at(self, point: tuple[float, float, float], i: int) -> PressJob:
        depths = tuple(map(float, ladder(self._depths[i])))
        leading = self._job(np.array(point), self._whole.accuracy.fidelity)
        return replace(leading, contact_point=point, tool=self._shapes[i], depths=depths)

    def arrived(self, outcome: PressOutcome) -> None:
        super().arrived(outcome)
        if outcome.job in self._beside:
            self._beside[outcome.job] = outcome

    @property
    def node_outcomes(self) -> list[PressOutcome]:
        return [*self.rounds.outcomes, *(outcome for outcome in self._beside.values() if outcome is not None)]

    def _nodes(self, geometry: ContactGeometry) -> list[tuple[ToolReference, ResponseNodes]]:
        """Tool and nodes of each group; a node needs every member, and what failed is noted."""
        usable: list[list[PressArrays]] = [[] for _ in self._groups]
        for outcome in self.rounds.outcomes:
            presses = self._presses_at(outcome)
            for own, group in zip(usable, self._groups, strict=True):
                found = [presses[i] for i in group]
                if all(press is not None for press in presses):
                    own.append(mean_press([press for press in found if press is not None]))
        nodes = []
        members = [self._members[first] for first, *_ in self._groups]
        count = max(  # groups are blended knot by knot
            len(knots_of(*member, presses)) for member, presses in zip(members, usable, strict=True)
        )
        for (first, *_), presses in zip(self._groups, usable, strict=True):
            reference = reference_of(self.tool.name, self._shapes[first])
            knots = uniform_knots(self._depths[first], count)
            nodes.append((reference, fit_nodes(presses, knots, reference.offset, geometry)))
        return nodes

    def _presses_at(self, outcome: PressOutcome) -> list[PressArrays | None]:
        """Of every member, at the place of the leader's `outcome`; what is wrong with one is noted."""
        point, presses = outcome.job.contact_point, []
        for i, member in enumerate(self._members):
            one = outcome if i == self._leader else self._beside[self._at(point, i)]
            assert one is not None  # all that was asked for has arrived
            press, reason = press_arrays(*member, one, self._mesh)
            presses.append(press)
            if reason:
                failure = {"reason": f"{self._told(i)}: {reason}", "hash": one.key}
                self.failures.append({"tool": self.tool.name, "contact_point": list(point), **failure})
        return presses


def mean_press(presses: Sequence[PressArrays]) -> PressArrays:
    """The mean of presses at one place, as deep as all of them came: energies and forces of a potential that is the
    mean of theirs.  The hash names all.
    """
    first = presses[0]
    if len(presses) == 1:
        return first
    count = min(len(press.depth) for press in presses)
    if any(not np.array_equal(press.depth[:count], first.depth[:count]) for press in presses):
        raise ValueError("presses at other depths have no mean; the same ladder is right")
    return replace(
        first,
        depth=first.depth[:count],
        force=np.mean([press.force[:count] for press in presses], axis=0),
        energy=np.mean([press.energy[:count] for press in presses], axis=0),
        lateral=mean_ladders(presses, count),
        friction_coefficient=mean_friction(presses, first.depth[1:count]),
        hash="+".join(press.hash for press in presses),
    )


def mean_friction(presses: Sequence[PressArrays], depths: np.ndarray) -> np.ndarray:
    """Rows (depth m, coefficient) of the mean at `depths` (m)."""
    each = [friction_at(press.friction_coefficient, depths) for press in presses]
    return np.stack([depths, np.mean(each, axis=0)], axis=1)


def mean_ladders(presses: Sequence[PressArrays], count: int) -> list[LateralLadder]:
    """The means of ladders at depths (the first `count`) where every one of `presses` has one, moved alike."""
    known = [{ladder.depth: ladder for ladder in press.lateral} for press in presses]
    shared = [d for d in known[0] if d <= presses[0].depth[count - 1] and all(d in own for own in known)]
    return [
        LateralLadder(
            d,
            known[0][d].deflection,
            np.mean([own[d].force_change for own in known], axis=0),
            np.mean([own[d].energy_change for own in known], axis=0),
        )
        for d in shared
    ]
